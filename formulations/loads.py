"""Loads: dead and follower pressure on the inner face, couples that follow the director, dead nodal forces.

A load is a frozen record; it never sees a measure. Pressure is positive when it pushes outwards (along +e3).

Along grid lines dead tractions have consistent nodal forces; lines may be curved and unequally divided. Those forces
are data, (N, 6) in the local frames.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from formulations.discretisation import Discretisation
from formulations.element.strain_operator import N_DOF, N_GAUSS, ElementGeometry
from formulations.geometry.grid import Grid, QuadGrid
from formulations.strains.quantities import N_Q, QUANTITIES, displacement_index

PRESSURE_AREAS = ("mid", "face")
_SLOPES = ("l1", "w1", "t1", "l2", "w2", "t2")
_OF_FACES = np.array([[QUANTITIES.index(name + face) for face in "-+"] for name in _SLOPES])
SIMPSON = ((0.0, 1 / 6), (0.5, 4 / 6), (1.0, 1 / 6))  # places on a way of length 1, the end last, and weights
_INNER = np.array([[6 * r + displacement_index(i, 0) for i in range(3)] for r in range(4)])  # (node, component)


@dataclass(frozen=True)
class Pressure:
    """Pressure [MPa] on the inner face.

    follower=False: the force keeps its reference components (dead); True: p n dA of the deformed inner face.
    area "mid" weights it with mubar (the paper's), "face" with the true area of the inner face; by default "face" for a
    follower, which is not a p n dA of the inner face on another area, and "mid" for a dead load.
    middle: a follower is p n dA of the deformed middle surface, one half on either face, as that of a membrane. On the
    inner face alone it presses on the wall. Where that is very thin against the elements, -p/2 across it is more than
    bending has to hold directors that turn to and fro from node to node, which meet no shear.
    """

    value: float
    follower: bool = False
    area: str = ""
    middle: bool = False

    def __post_init__(self) -> None:
        if self.middle and not (self.follower and self.area in ("", "mid")):
            raise ValueError("pressure on the middle surface is that of a follower, on its own area")
        if not self.area:
            object.__setattr__(self, "area", "face" if self.follower and not self.middle else "mid")
        if self.area not in PRESSURE_AREAS:
            raise ValueError(f"pressure area {self.area!r} is not one of {', '.join(PRESSURE_AREAS)}")

    @property
    def faces(self) -> tuple[int, ...]:
        """Those that a follower acts on: the inner one, or both alike."""
        return (0, 1) if self.middle else (0,)

    def scaled(self, factor: float) -> Pressure:
        """The same pressure times ``factor``."""
        return replace(self, value=factor * self.value)

    def weights(self, geometry: ElementGeometry) -> np.ndarray:
        """Area carried by each Gauss point, (E, 4), or (E, 1) where all carry the same."""
        return geometry.point_areas("mid" if self.area == "mid" else "inner")

    def dead_force(self, geometry: ElementGeometry) -> np.ndarray:
        """Element forces (E, 24) in the reference frame: F_r = p int N_r dA along e3."""
        force = np.zeros((len(geometry.Q), N_DOF))
        weights = self.value * self.weights(geometry)
        along_normal = geometry.value[:, :, :, 2]  # (1 or E, Gauss point, node, component)
        if weights.shape[1] == 1:
            force[:, _INNER] = weights[..., None] * along_normal.sum(axis=1)
        else:
            force[:, _INNER] = np.einsum("eg,egrj->erj", weights, along_normal)
        return force

    def follower_force(
        self, geometry: ElementGeometry, v: np.ndarray, force: np.ndarray, tangent: np.ndarray | None = None
    ) -> None:
        """Add p n dA of the deformed surface to ``force`` (E, 24), take its derivative off ``tangent`` (E, 24, 24).

        With g1 = (1 + l1, w1, -t1), g2 = (w2, 1 + l2, -t2) the area vector is their component cross product times the
        reference area, whatever the handedness of (e1, e2, e3).
        """
        weights = self.value * self.weights(geometry)
        for part in geometry.chunks():
            Q, weight = geometry.Q[part], weights[part]
            q = np.matmul(Q, v[part, :, None]).reshape(-1, N_GAUSS, N_Q)
            if geometry.offset is not None:
                q += geometry.offset[part]
            normal, slope = _area_vector(q, self.faces)
            spread = _displacement(geometry.value if len(geometry.value) == 1 else geometry.value[part], self.faces)
            if weight.shape[1] > 1:  # else once, below
                normal, slope, weight = normal * weight[..., None], slope * weight[..., None, None], np.ones((1, 1))
            force[part] += weight * np.matmul(normal.reshape(-1, 1, 3 * N_GAUSS), spread)[:, 0]
            if tangent is None:
                continue
            turning = np.matmul(slope, Q.reshape(-1, N_GAUSS, N_Q, N_DOF)).reshape(-1, 3 * N_GAUSS, N_DOF)
            tangent[part] -= np.matmul(spread.swapaxes(1, 2), turning) * weight[..., None]

    def work(self, geometry: ElementGeometry, v: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Work W [N mm] of a follower on the straight way from rest to v (E, 24), its force F and dW/dv (E, 24) there.

        W = int_0^1 F(s v).v ds is p times the volume that the face sweeps. F is quadratic in v, so Simpson's rule is
        exact. Where the edges of the surface sweep nothing, the sums of dW/dv over the elements are those of F.
        """
        mean, slope = np.zeros_like(v), np.zeros((len(v), N_DOF, N_DOF))
        for at, weight in SIMPSON:
            force, turned = np.zeros_like(v), np.zeros_like(slope)
            self.follower_force(geometry, at * v, force, turned)
            mean += weight * force
            slope -= weight * at * turned
        return float(np.sum(mean * v)), force, mean + np.einsum("eij,ei->ej", slope, v)


def _displacement(value: np.ndarray, faces: tuple[int, ...]) -> np.ndarray:
    """Mean displacement of the faces at the Gauss points from the element vector, (e, 12, 24)."""
    spread = np.zeros((len(value), N_GAUSS, 3, N_DOF))
    for face in faces:
        spread[..., _INNER + face] = value.swapaxes(2, 3) / len(faces)  # (e, g, i, node, component)
    return spread.reshape(len(value), 3 * N_GAUSS, N_DOF)


def _area_vector(q: np.ndarray, faces: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Area vector (..., 3) of the deformed mean of the faces per reference area, its derivative by q (..., 3, 15)."""
    l1, w1, t1, l2, w2, t2 = (q[..., of].mean(axis=-1) for of in _OF_FACES[:, faces])
    normal = np.stack([t1 * (1 + l2) - w1 * t2, t2 * (1 + l1) - t1 * w2, (1 + l1) * (1 + l2) - w1 * w2], axis=-1)
    slope = np.zeros((*q.shape[:-1], 3, N_Q))
    for L1, W1, T1, L2, W2, T2 in _OF_FACES[:, faces].T:
        slope[..., 0, T1], slope[..., 0, L2], slope[..., 0, W1], slope[..., 0, T2] = 1 + l2, t1, -t2, -w1
        slope[..., 1, T2], slope[..., 1, L1], slope[..., 1, T1], slope[..., 1, W2] = 1 + l1, t2, -w2, -t1
        slope[..., 2, L1], slope[..., 2, L2], slope[..., 2, W1], slope[..., 2, W2] = 1 + l2, 1 + l1, -w2, -w1
    return normal, slope / len(faces)


@dataclass(frozen=True, eq=False)
class Couples:
    """Couples on nodes that follow the director: opposite forces on the two faces, at right angles to it.

    With the deformed director d = x+ - x- of the node and the unit axis a (components in the local frame of the node)
    the outer face carries F = M (a x d)/|d|^2 and the inner face -F, so that d x F = M a while d stays normal to a,
    whatever the stretch of d. The power is M times the spin of d about a.

    nodes (m,): node numbers.  moments (m,): M [N mm].  axes (m, 3): a.  thickness: h [mm].
    """

    nodes: np.ndarray
    moments: np.ndarray
    axes: np.ndarray
    thickness: float

    def scaled(self, factor: float) -> Couples:
        """The same couples times ``factor``."""
        return replace(self, moments=factor * self.moments)

    def follower_force(self, grid: Grid, v: np.ndarray, force: np.ndarray, tangent: np.ndarray | None = None) -> None:
        """Add the forces to ``force`` (E, 24) and take their derivative off ``tangent`` (E, 24, 24), at v (E, 24).

        dF/dd = M ([a x] - 2 (a x d) d^T/|d|^2)/|d|^2. Each node acts through the first element that has it.
        """
        first = np.unique(grid.elements, return_index=True)[1][self.nodes]
        element, corner = divmod(first, 4)
        inner = _INNER[corner]  # (m, 3) columns of the element vector
        outer = inner + 1
        each = element[:, None]
        d = v[each, outer] - v[each, inner]
        d[:, 2] += self.thickness
        square = np.sum(d * d, axis=-1)[:, None]
        lever = np.cross(self.axes, d)
        F = self.moments[:, None] * lever / square
        np.add.at(force, (each, outer), F)
        np.add.at(force, (each, inner), -F)
        if tangent is None:
            return
        spin = np.cross(self.axes[:, None, :], np.eye(3)).swapaxes(1, 2)  # [a x], a x d = spin @ d
        turning = spin - 2 * lever[:, :, None] * d[:, None, :] / square[:, :, None]
        slope = (self.moments[:, None] / square)[:, :, None] * turning
        both = np.concatenate([outer, inner], axis=1)
        sign = np.repeat([1.0, -1.0], 3)
        block = np.tile(slope, (1, 2, 2)) * sign[:, None] * sign
        np.add.at(tangent, (element[:, None, None], both[:, :, None], both[:, None, :]), -block)


Traction = Callable[[np.ndarray, np.ndarray], np.ndarray]
_POINTS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
_SHAPE = 0.5 * np.stack([1 - _POINTS, 1 + _POINTS], axis=-1)  # (point, end)


def edge_force(
    discretisation: Discretisation,
    axis: int,
    value: float,
    traction: Traction,
    shares: tuple[float, float] = (0.5, 0.5),
) -> np.ndarray:
    """Nodal forces (N, 6) of a dead traction on the line a_{axis+1} = value: F^r = int N_r t ds.

    ``traction(a1, a2)``: force per length of the mid surface t (..., 3) [N/mm] in Cartesian components. ``shares`` go
    to the inner and to the outer face; (-1, 1) with a tangential t is a dead couple of t h. Two Gauss points an
    element. A curvilinear element interpolates components in the turning frame, so t is taken in the frame at every
    Gauss point; an isoparametric one interpolates Cartesian components, so the nodal sum is. Raises ValueError when
    the grid has no such line.
    """
    ends, a1, a2, length = _segments(discretisation, axis, value)
    t = np.broadcast_to(traction(a1, a2), (*a1.shape, 3))
    surface, nodes = discretisation.surface, discretisation.grid.nodes
    if discretisation.geometry.interpolation != "curvilinear":
        at_ends = surface.frame(nodes[ends, 0], nodes[ends, 1])
        nodal = np.einsum("eg,gr,erix,egx->eri", length, _SHAPE, at_ends, t)
    else:
        nodal = np.einsum("eg,gr,egix,egx->eri", length, _SHAPE, surface.frame(a1, a2), t)
    forces = np.zeros((len(nodes), 6))
    for face, share in enumerate(shares):
        np.add.at(forces[:, face::2], ends, share * nodal)
    return forces


def edge_lengths(discretisation: Discretisation, axis: int, value: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (m,) of the line a_{axis+1} = value and the lengths int N_r ds (m,) of the mid surface they carry.

    A couple of M per length is ``Couples(nodes, M * lengths, axes, h)``. Raises ValueError when there is no such line.
    """
    ends, _, _, length = _segments(discretisation, axis, value)
    full = np.bincount(ends.ravel(), weights=(length @ _SHAPE).ravel(), minlength=discretisation.grid.n_nodes)
    nodes = np.unique(ends)
    return nodes, full[nodes]


def _segments(
    discretisation: Discretisation, axis: int, value: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Nodes (s, 2) of the line's element sides; a1, a2 (s, 2) of their Gauss points and lengths (s, 2) of these.

    Of an inner line the sides of the elements before it, so that every side counts once. ds = A_g (1 + k_g dbar) da_g.
    """
    grid, laminate = discretisation.grid, discretisation.laminate
    along = 1 - axis
    slack = 1e-9 * float(np.ptp(grid.nodes[:, axis]))
    after, before = (np.abs(grid.centre[:, axis] + s * grid.half[:, axis] - value) <= slack for s in (-1, 1))
    which, corners = (before, ((1, 2), (3, 2))) if before.any() else (after, ((0, 3), (0, 1)))
    if not which.any():
        raise ValueError(f"the grid has no line a{axis + 1} = {value:g}")
    a = np.full((2, int(which.sum()), 2), value)
    middle, half = grid.centre[which, along], grid.half[which, along]
    if isinstance(grid, QuadGrid):  # the rectangle around an element is longer than its side
        ends = grid.corners[which][:, corners[axis], along]
        middle, half = ends.mean(axis=1), 0.5 * np.abs(ends[:, 1] - ends[:, 0])
    a[along] = middle[:, None] + half[:, None] * _POINTS
    geometry = discretisation.surface.geometry(a[0], a[1])
    d_bar = 0.5 * (laminate.d_minus + laminate.d_plus)
    stretch = geometry.A[..., along] * (1 + geometry.k[..., along] * d_bar)
    return grid.elements[which][:, corners[axis]], a[0], a[1], half[:, None] * stretch

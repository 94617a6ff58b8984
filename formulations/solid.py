"""The 3D judge: the same body as a shell, meshed with triquadratic hexahedra between its two faces.

Total Lagrangian St. Venant-Kirchhoff with the plies' own law and angles, Cartesian displacements, isoparametric
geometry (so every rigid motion is exact). It shares surfaces, plies and loads with the shell but no kinematic
assumption; no shell element and no contact may enter here. Meshes and numbering are scikit-fem's.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse
from scipy.linalg import norm

from formulations.element.sparsity import Pattern
from formulations.geometry.surfaces import Surface
from formulations.loads.pressure import Pressure
from formulations.section.laminate import Laminate
from formulations.shell import Linearisation

CHUNK = 16  # elements a pass
_THIRDS = (0.0, 0.5, 1.0)
_NODES = np.stack(np.meshgrid(_THIRDS, _THIRDS, _THIRDS, indexing="ij"), axis=-1).reshape(27, 3)  # of the unit cube
_SQUARE = np.stack(np.meshgrid(_THIRDS, _THIRDS, indexing="ij"), axis=-1).reshape(9, 2)
_VOIGT = ((0, 0), (1, 1), (0, 1), (2, 2), (0, 2), (1, 2))  # order of Ply.stiffness


def _gauss() -> tuple[np.ndarray, np.ndarray]:
    """Three Gauss points and weights on [0, 1]."""
    points, weights = np.polynomial.legendre.leggauss(3)
    return 0.5 * (points + 1), 0.5 * weights


def _quadratic(x: np.ndarray, node: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Value and slope at x (g,) of the 1D quadratics that are one at the nodes 0, 1/2 or 1; both (g, n)."""
    x = x[:, None]
    at = [np.isclose(node, value) for value in (0.0, 0.5, 1.0)]
    value = np.select(at, [(1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)])
    slope = np.select(at, [4 * x - 3, 4 - 8 * x, 4 * x - 1])
    return value, slope


def _shape(points: np.ndarray, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """N (g, n) and dN (g, n, dim) at points (g, dim) for tensor-product nodes (n, dim) of the unit square or cube."""
    parts = [_quadratic(points[:, d], nodes[:, d]) for d in range(points.shape[1])]
    value = np.prod([v for v, _ in parts], axis=0)
    slope = [np.prod([s if i == d else v for i, (v, s) in enumerate(parts)], axis=0) for d in range(len(parts))]
    return value, np.stack(slope, axis=-1)


def _tensor_gauss(dim: int) -> tuple[np.ndarray, np.ndarray]:
    points, weights = _gauss()
    grids = np.meshgrid(*[points] * dim, indexing="ij")
    products = np.meshgrid(*[weights] * dim, indexing="ij")
    return np.stack([g.ravel() for g in grids], axis=-1), np.prod([p.ravel() for p in products], axis=0)


@dataclass(frozen=True, eq=False)
class SolidMesh:
    """Nodes and hexahedra of a shell-like body.

    x (N, 3): Cartesian nodes; parameter (N, 3): their (a1, a2, a3).  elements (E, 27): nodes in the order of _NODES.
    frame (E, 27, 3, 3): rows e1, e2, e3 at the Gauss points; ply (E,): ply of each element.  inner, outer: face
    quadrilaterals (F, 9) in the order of _SQUARE.  orientation: +1 or -1, handedness of (a1, a2, a3) on the body.
    """

    x: np.ndarray
    parameter: np.ndarray
    elements: np.ndarray
    frame: np.ndarray
    ply: np.ndarray
    inner: np.ndarray
    outer: np.ndarray
    orientation: float

    @classmethod
    def build(
        cls,
        surface: Surface,
        lines1: np.ndarray,
        lines2: np.ndarray,
        laminate: Laminate,
        *,
        per_ply: int = 1,
        periodic: bool = False,
    ) -> SolidMesh:
        """Hexahedra over the tensor grid of the lines, ``per_ply`` through each ply; nodes on the true geometry."""
        tops = laminate.d_minus + np.cumsum([ply.thickness for ply in laminate.plies])
        bottoms = np.append(laminate.d_minus, tops[:-1])
        layers = np.concatenate([np.linspace(b, t, per_ply + 1)[:-1] for b, t in zip(bottoms, tops, strict=True)])
        lines3 = np.append(layers, tops[-1])
        from skfem import Basis, ElementHex2, MeshHex  # slow to load, and shells have no need of it

        basis = Basis(MeshHex.init_tensor(lines1, lines2, lines3), ElementHex2(), intorder=1)
        parameter, elements = basis.doflocs.T.copy(), basis.element_dofs.T.astype(np.intp)
        low = parameter[elements].min(axis=1)
        size = np.ptp(parameter[elements], axis=1)
        halves = np.rint(2 * (parameter[elements] - low[:, None, :]) / size[:, None, :]).astype(int)
        elements = np.take_along_axis(elements, np.argsort(halves @ (9, 3, 1), axis=1), axis=1)
        points, _ = _tensor_gauss(3)
        at_gauss = low[:, None, :] + size[:, None, :] * points
        inner = elements[np.isclose(low[:, 2], lines3[0])][:, 0::3]
        outer = elements[np.isclose(low[:, 2] + size[:, 2], lines3[-1])][:, 2::3]
        if periodic:
            seam = np.isclose(parameter[:, 1], lines2[-1])
            moved = parameter.copy()
            moved[seam, 1] = lines2[0]
            _, first, number = np.unique(np.round(moved, 9), axis=0, return_index=True, return_inverse=True)
            number = number.ravel()
            parameter, elements, inner, outer = moved[first], number[elements], number[inner], number[outer]
        a1, a2 = parameter[:, 0], parameter[:, 1]
        frame = surface.frame(at_gauss[..., 0], at_gauss[..., 1])
        x = surface.position(a1, a2) + parameter[:, 2:] * surface.frame(a1, a2)[:, 2]
        middle = low[:, 2] + 0.5 * size[:, 2]
        ply = np.searchsorted(tops, middle)
        return cls(x, parameter, elements, frame, ply, inner, outer, float(np.sign(np.linalg.det(frame[0, 0]))))

    def on(self, axis: int, value: float) -> np.ndarray:
        """Nodes with a_{axis+1} = value."""
        return np.flatnonzero(np.isclose(self.parameter[:, axis], value, atol=1e-9))

    def face_areas(self, face: np.ndarray) -> np.ndarray:
        """Nodal areas (N,) of a reference face (F, 9): int N_r dA, all positive."""
        value, normal, weights = _face_vectors(self.x, face, self.orientation)
        shares = np.einsum("g,fg,gn->fn", weights, np.linalg.norm(normal, axis=-1), value)
        return np.bincount(face.ravel(), weights=shares.ravel(), minlength=len(self.x))

    def face_mass(self, face: np.ndarray) -> sparse.csr_matrix:
        """Consistent matrix (N, N) of int N_r N_s dA on a reference face (F, 9); its row sums are the nodal areas."""
        value, normal, weights = _face_vectors(self.x, face, self.orientation)
        area = weights * np.linalg.norm(normal, axis=-1)
        blocks = np.einsum("fg,gm,gn->fmn", area, value, value)
        rows, columns = np.repeat(face, 9, axis=1), np.tile(face, (1, 9))
        shape = (len(self.x), len(self.x))
        return sparse.coo_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=shape).tocsr()


def _face_vectors(x: np.ndarray, face: np.ndarray, orientation: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """N (g, 9), outward area vectors (F, g, 3) per reference square, and weights (g,) of a face."""
    points, weights = _tensor_gauss(2)
    value, slope = _shape(points, _SQUARE)
    tangents = np.einsum("gnd,fnx->fgdx", slope, x[face])
    return value, orientation * np.cross(tangents[..., 0, :], tangents[..., 1, :]), weights


@dataclass(frozen=True, eq=False)
class SolidModel:
    """A loaded body with the same ``linearise`` as the shell; ``fixed`` (N, 3) bool holds Cartesian displacements.

    Pressure must be on the true face ("face"): there is no mid surface to weight it with; raises ValueError otherwise.
    """

    mesh: SolidMesh
    laminate: Laminate
    fixed: np.ndarray
    pressure: Pressure | None = None
    forces: np.ndarray | None = None
    _geometry: tuple[np.ndarray, np.ndarray] = field(init=False, repr=False)
    _pattern: Pattern = field(init=False, repr=False)
    free: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if self.pressure is not None and self.pressure.area != "face":
            raise ValueError("a solid carries pressure on its true face only: area 'face'")
        free = np.flatnonzero(~self.fixed.ravel())
        number = np.full(self.fixed.size, -1, dtype=np.intp)
        number[free] = np.arange(len(free))
        object.__setattr__(self, "free", free)
        object.__setattr__(self, "_pattern", Pattern.build(number[self._dofs], len(free)))
        object.__setattr__(self, "_geometry", self._reference_gradients())

    @property
    def ordered(self) -> bool:
        """False: the unknowns are numbered as the nodes are, a factorisation has to look for an order."""
        return False

    def scaled(self, factor: float) -> SolidModel:
        """The same body under ``factor`` times its loads; geometry and pattern are shared."""
        pressure = None if self.pressure is None else replace(self.pressure, value=factor * self.pressure.value)
        forces = None if self.forces is None else factor * self.forces
        other = object.__new__(SolidModel)
        for name in ("mesh", "laminate", "fixed", "_geometry", "_pattern", "free"):
            object.__setattr__(other, name, getattr(self, name))
        object.__setattr__(other, "pressure", pressure)
        object.__setattr__(other, "forces", forces)
        return other

    @property
    def n_free(self) -> int:
        """Number of unknowns."""
        return len(self.free)

    def expand(self, u: np.ndarray) -> np.ndarray:
        """All displacements (N, 3) from the free ones."""
        full = np.zeros(self.fixed.size)
        full[self.free] = u
        return full.reshape(-1, 3)

    def displacement_operator(self, nodes: np.ndarray) -> sparse.csr_matrix:
        """Sparse (3m, n): Cartesian displacements of the nodes from the free u."""
        rows = (3 * nodes[:, None] + np.arange(3)).ravel()
        selection = sparse.eye_array(self.fixed.size, format="csr")[rows]
        return sparse.csr_matrix(selection[:, self.free])

    def linearise(self, u: np.ndarray, memory: object = None) -> Linearisation:
        """Residual and tangent at u (n,); ``memory`` is not used."""
        full = self.expand(u)
        force, tangent = self._integrate(full)
        outside = np.zeros(self.fixed.size)
        matrix = self._pattern.assemble(tangent)
        if self.pressure is not None:
            load, load_tangent = self._pressure_load(full)
            outside += load
            if load_tangent is not None:
                matrix = sparse.csc_matrix(matrix - load_tangent)
        internal = np.bincount(self._dofs.ravel(), weights=force.ravel(), minlength=self.fixed.size)[self.free]
        external = outside[self.free] + (0.0 if self.forces is None else self.forces)
        return Linearisation(
            residual=internal - external,
            tangent=matrix,
            scale=float(max(norm(internal, check_finite=False), norm(external, check_finite=False))),
            remember=lambda du: None,
        )

    @property
    def _dofs(self) -> np.ndarray:
        return (3 * self.mesh.elements[:, :, None] + np.arange(3)).reshape(len(self.mesh.elements), -1)

    def _reference_gradients(self) -> tuple[np.ndarray, np.ndarray]:
        """Gradients of N along the local axes (E, 27 points, 27 nodes, 3) and volumes (E, 27 points)."""
        points, weights = _tensor_gauss(3)
        _, slope = _shape(points, _NODES)
        jacobian = np.einsum("gnd,enx->egdx", slope, self.mesh.x[self.mesh.elements])
        along_x = np.einsum("gnd,egxd->egnx", slope, np.linalg.inv(jacobian))
        volume = weights * np.abs(np.linalg.det(jacobian))
        return np.einsum("egnx,egix->egni", along_x, self.mesh.frame), volume

    def _parts(self) -> Iterator[slice]:
        n = len(self.mesh.elements)
        return (slice(start, min(start + CHUNK, n)) for start in range(0, n, CHUNK))

    def _integrate(self, full: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Internal force (E, 81) and tangent (E, 81, 81)."""
        gradients, volumes = self._geometry
        stiffness = np.stack([ply.stiffness() for ply in self.laminate.plies])[self.mesh.ply]
        force, tangent = np.empty((len(volumes), 81)), np.empty((len(volumes), 81, 81))
        for part in self._parts():
            G, volume, C = gradients[part], volumes[part], stiffness[part]
            F = np.einsum("enx,egni->egxi", full[self.mesh.elements[part]], G)
            F += self.mesh.frame[part].swapaxes(-1, -2)  # columns of F along the local axes
            E = 0.5 * (np.einsum("egxi,egxj->egij", F, F) - np.eye(3))
            strain = np.stack([E[..., i, j] * (1 if i == j else 2) for i, j in _VOIGT], axis=-1)
            stress = np.einsum("epq,egq->egp", C, strain) * volume[..., None]
            B = self._strain_gradient(F, G)
            flat = B.reshape(len(C), -1, 81)
            CB = np.matmul(C[:, None], B * volume[..., None, None]).reshape(flat.shape)
            force[part] = np.einsum("egp,egpk->ek", stress, B)
            S = np.empty_like(E)
            for p, (i, j) in enumerate(_VOIGT):
                S[..., i, j] = S[..., j, i] = stress[..., p]
            initial = np.einsum("egni,egij,egmj->enm", G, S, G, optimize=True)
            tangent[part] = np.matmul(flat.transpose(0, 2, 1), CB)
            blocks = tangent[part].reshape(-1, 27, 3, 27, 3)
            for x in range(3):
                blocks[:, :, x, :, x] += initial
        return force, tangent

    @staticmethod
    def _strain_gradient(F: np.ndarray, G: np.ndarray) -> np.ndarray:
        """dE/du (e, g, 6, 81) in Voigt order with engineering shears."""
        rows = []
        for i, j in _VOIGT:
            row = np.einsum("egx,egn->egnx", F[..., i], G[..., j])
            rows.append(row if i == j else row + np.einsum("egx,egn->egnx", F[..., j], G[..., i]))
        return np.stack(rows, axis=2).reshape(*F.shape[:2], 6, 81)

    def _pressure_load(self, full: np.ndarray) -> tuple[np.ndarray, sparse.csc_matrix | None]:
        """Nodal forces (3N,) of p n dA on the inner face; with ``follower`` their derivative on the free unknowns."""
        assert self.pressure is not None
        face = self.mesh.inner
        x = self.mesh.x + full if self.pressure.follower else self.mesh.x
        value, normal, weights = _face_vectors(x, face, self.mesh.orientation)
        shares = self.pressure.value * np.einsum("g,gn,fgx->fnx", weights, value, normal)
        dofs = (3 * face[:, :, None] + np.arange(3)).reshape(len(face), -1)
        load = np.bincount(dofs.ravel(), weights=shares.ravel(), minlength=self.fixed.size)
        if not self.pressure.follower:
            return load, None
        _, slope = _shape(_tensor_gauss(2)[0], _SQUARE)
        tangents = np.einsum("gnd,fnx->fgdx", slope, x[face])
        levi = np.zeros((3, 3, 3))
        levi[0, 1, 2] = levi[1, 2, 0] = levi[2, 0, 1] = 1
        levi[0, 2, 1] = levi[2, 1, 0] = levi[1, 0, 2] = -1
        turn = np.einsum("gm,fgz,xyz->fgmxy", slope[..., 0], tangents[..., 1, :], levi)
        turn += np.einsum("fgy,gm,xyz->fgmxz", tangents[..., 0, :], slope[..., 1], levi)
        factor = self.pressure.value * self.mesh.orientation
        blocks = factor * np.einsum("g,gn,fgmxy->fnxmy", weights, value, turn).reshape(len(face), 27, 27)
        rows, columns = np.repeat(dofs, 27, axis=1), np.tile(dofs, (1, 27))
        shape = (self.fixed.size, self.fixed.size)
        matrix = sparse.coo_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=shape).tocsc()
        return load, matrix[self.free][:, self.free].tocsc()

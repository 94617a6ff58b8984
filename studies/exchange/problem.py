"""A scene in neutral terms: what any other program needs to solve the same body under the same loads.

The body is of quadratic bricks of 20 nodes between the two faces of a shell-like body, as Abaqus, CalculiX and VTK
number them: the triquadratic hexahedra of :mod:`formulations.solid_mesh` without the nodes in the middle of faces and
bodies. Units are mm, N and MPa. How a scene comes to be one is in :mod:`.of_scene` and :mod:`.of_body`; no syntax of a
file and no solution may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from formulations.section.laminate import Laminate, Ply
from formulations.solid_mesh import CUBE, SQUARE, SolidMesh
from studies.ask.request import Request, UsageError
from studies.output.vtu import PLACES_27

PLACES = np.array(PLACES_27[:20])  # of the nodes of a C3D20 along its axes: VTK's corners and edges
SWAPPED = [1, 0, 2]  # axes of a left-handed body, so that a brick has a positive volume
LATTICE = (9, 3, 1)  # number of a place in the order of CUBE
RING = (0, 6, 8, 2, 3, 7, 5, 1)  # of the nine nodes of a face in the order of SQUARE: corners, then edges, as below
INNER, OUTER = 1, 2  # numbers of the faces below and above a brick
ON_FACE = {INNER: (0, 1, 2, 3, 8, 9, 10, 11), OUTER: (4, 5, 6, 7, 12, 13, 14, 15)}  # its nodes there, corners first


def serendipity(s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Shape functions (n, 8) of a face at s, t (n,) in [-1, 1]: corners, then edges, counter-clockwise from (-1, -1).

    Corners: (1 + s s_r)(1 + t t_r)(s s_r + t t_r - 1)/4; edges: (1 - s^2)(1 + t t_r)/2 or (1 - t^2)(1 + s s_r)/2.
    """
    corners = [(1 + s * a) * (1 + t * b) * (s * a + t * b - 1) / 4 for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    along_s, along_t = (1 - s**2) / 2, (1 - t**2) / 2
    edges = [along_s * (1 - t), along_t * (1 + s), along_s * (1 + t), along_t * (1 - s)]
    return np.stack([*corners, *edges], axis=-1)


CENTRE = serendipity(np.zeros(1), np.zeros(1))[0]  # what a node in the middle of a face takes of its eight others


@dataclass(frozen=True, eq=False)
class Bricks:
    """A body of bricks with nodes numbered from 0.

    x (N, 3) [mm]; parameter (N, 3): their (a1, a2, a3).  elements (E, 20).  frame (E, 3, 3): rows e1, e2, e3 at the
    centres.  ply (E,), from inside.  inner, outer: elements (F,) on the faces, whose own faces are INNER and OUTER.
    of_mesh (M,): node of each node of ``mesh``, -1 for those left out.
    """

    mesh: SolidMesh
    x: np.ndarray
    parameter: np.ndarray
    elements: np.ndarray
    frame: np.ndarray
    ply: np.ndarray
    inner: np.ndarray
    outer: np.ndarray
    of_mesh: np.ndarray

    @classmethod
    def of(cls, mesh: SolidMesh) -> Bricks:
        """Without the nodes in the middle of faces and bodies."""
        places = PLACES if mesh.orientation > 0 else PLACES[:, SWAPPED]
        elements = mesh.elements[:, places @ LATTICE]
        kept, numbered = np.unique(elements, return_inverse=True)
        of_mesh = np.full(len(mesh.x), -1)
        of_mesh[kept] = np.arange(len(kept))
        a3 = mesh.parameter[mesh.elements][:, :, 2]
        low, high = a3.min(axis=1), a3.max(axis=1)
        return cls(
            mesh=mesh,
            x=mesh.x[kept],
            parameter=mesh.parameter[kept],
            elements=numbered.reshape(elements.shape),
            frame=mesh.frame[:, len(CUBE.weights) // 2],
            ply=mesh.ply,
            inner=np.flatnonzero(np.isclose(low, a3.min())),
            outer=np.flatnonzero(np.isclose(high, a3.max())),
            of_mesh=of_mesh,
        )

    @cached_property
    def turning(self) -> float:
        """Largest angle [rad] between the axes e1, e2, e3 at a Gauss point of a brick and those at its centre."""
        cosines = np.einsum("egix,eix->egi", self.mesh.frame, self.frame)
        return float(np.arccos(np.clip(cosines.min(), -1.0, 1.0)))

    def face_nodes(self, face: int) -> np.ndarray:
        """Nodes (N,) on the inner or on the outer face."""
        return np.unique(self.elements[self.on(face)][:, ON_FACE[face]])

    def on(self, face: int) -> np.ndarray:
        """Elements (F,) on the inner or on the outer face."""
        return {INNER: self.inner, OUTER: self.outer}[face]

    def without_centres(self, forces: np.ndarray) -> np.ndarray:
        """Nodal forces (N, 3) that do the work of forces (M, 3) on the nodes of the mesh, none of them inside bodies.

        The middle of a face moves as the shape functions of its eight other nodes say. Raises ValueError for a force on
        a node that lies on neither face.
        """
        nodal = np.zeros_like(self.x)
        kept = np.flatnonzero(self.of_mesh >= 0)
        np.add.at(nodal, self.of_mesh[kept], forces[kept])
        faces = np.concatenate([self.mesh.inner, self.mesh.outer])
        middle, ring = faces[:, len(RING) // 2], self.of_mesh[faces[:, RING]]
        np.add.at(nodal, ring, CENTRE[:, None] * forces[middle][:, None, :])
        lost = np.setdiff1d(np.flatnonzero((self.of_mesh < 0) & forces.any(axis=1)), middle)
        if len(lost):
            raise ValueError(f"forces on {len(lost)} nodes inside the body have no place on its bricks")
        return nodal

    def pressure_forces(self, pressure: np.ndarray, u: np.ndarray | None = None) -> np.ndarray:
        """Forces (N, 3) [N]: int N_r p n dA of pressures p (F,) [MPa] over the inner faces, displaced by u (N, 3)."""
        face = self.mesh.elements[self.inner][:, 0::3]
        ring = self.of_mesh[face[:, RING]]
        x = self.mesh.x.copy()
        if u is not None:
            x[face[:, RING]] += u[ring]
        x[face[:, len(RING) // 2]] = np.einsum("r,frx->fx", CENTRE, x[face[:, RING]])
        _, area = self.mesh.area_vectors(x, face)
        value = serendipity(*(2 * SQUARE.points - 1).T)
        forces = np.zeros_like(self.x)
        np.add.at(forces, ring, np.einsum("f,g,gr,fgx->frx", pressure, SQUARE.weights, value, area))
        return forces


ALONG = 1e-12  # what rounding takes off a unit vector along an axis


def isotropic(ply: Ply) -> bool:
    """Whether two constants tell it."""
    E, nu = ply.E_L, ply.nu_LT
    same = (*ply.moduli, *(2 * (1 + nu) * G for G in ply.shears))
    return bool(np.allclose(same, E, rtol=1e-12) and np.allclose(ply.poisson, nu, rtol=1e-12))


def materials(laminate: Laminate) -> tuple[Ply, ...]:
    """The plies from inside, L along axis 1; a shear correction of the section is one of G_LN and G_TN.

    Raises UsageError for a kind of ply that has no such constants.
    """
    correction = float(getattr(laminate, "shear_correction", 1.0))
    for ply in laminate.plies:
        if not isinstance(ply, Ply):
            raise UsageError(f"plies of kind {type(ply).__name__} cannot be exported: they have no moduli along axes")
    return tuple(replace(ply, G_LN=correction * ply.shears[1], G_TT=correction * ply.G_TT) for ply in laminate.plies)


@dataclass(frozen=True, eq=False)
class Supports:
    """nodes (k,), each once; axes (k, 3, 3): rows along which held (k, 3) bool says that a node does not move."""

    nodes: np.ndarray
    axes: np.ndarray
    held: np.ndarray

    @cached_property
    def turned(self) -> np.ndarray:
        """(k,) bool: the nodes that are held along a direction that is no Cartesian axis, and not along all three."""
        straight = np.asarray(np.abs(self.axes).max(axis=-1) > 1 - ALONG)
        return np.asarray(np.any(self.held & ~straight, axis=1) & ~self.held.all(axis=1))

    @cached_property
    def cartesian(self) -> np.ndarray:
        """(k, 3) bool: the Cartesian components that are held; of the nodes that are not ``turned``."""
        along = np.abs(self.axes).argmax(axis=-1)
        held = np.zeros_like(self.held)
        for i in range(3):
            held[np.arange(len(held)), along[:, i]] |= self.held[:, i]
        return held | np.all(self.held, axis=1, keepdims=True)

    def along_axes(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (N, 3) at all nodes, those at ``turned`` ones along their axes."""
        nodes, components = self.nodes[self.turned], vectors.copy()
        components[nodes] = np.einsum("kix,kx->ki", self.axes[self.turned], vectors[nodes])
        return components


@dataclass(frozen=True, eq=False)
class LoadStep:
    """All loads at the end of a step, whole and not added to those before; between two steps they vary linearly.

    load: value of the problem's key, None where no quantity is reported.  pressure (F,) [MPa]: on the inner faces of
    ``bricks.inner``, outwards, on the deformed area where the analysis is nonlinear.  forces (N, 3) [N]: dead.
    offset [mm]: n.x of the plane.
    """

    name: str
    load: float | None
    pressure: np.ndarray
    forces: np.ndarray
    offset: float | None = None


@dataclass(frozen=True, eq=False)
class Plane:
    """A rigid plane without friction: the body stays at n.x <= offset.  start [mm]: its offset at rest."""

    normal: np.ndarray
    start: float


@dataclass(frozen=True, eq=False)
class Problem:
    """Body, plies, supports, steps and plane.

    key: what the steps are counted by, as in the scene's results.  shell (n, 2): nodes on the inner and on the outer
    face at the nodes of the shell's grid; None of a scene that is a solid.  touched [mm]: n.x of the plane that just
    touches after the first step, by our own solution, from which the travel of a tyre counts; else None.  crown: node
    where it touches first.  copies: how often the part lies in the tyre, whose whole force is reported; else 1.
    """

    request: Request
    title: str
    key: str
    bricks: Bricks
    materials: tuple[Ply, ...]
    supports: Supports
    steps: tuple[LoadStep, ...]
    plane: Plane | None = None
    shell: np.ndarray | None = None
    touched: float | None = None
    crown: int | None = None
    copies: int = 1

    @property
    def nonlinear(self) -> bool:
        """Whether displacements are large: the measure is not the linear one."""
        return self.request.measure != "linear"

    def step_at(self, load: float) -> LoadStep | None:
        """The step that ends at a load, if any does."""
        return next((step for step in self.steps if step.load is not None and np.isclose(step.load, load)), None)

    def pressure_forces(self, step: LoadStep, u: np.ndarray | None) -> np.ndarray | None:
        """Forces (N, 3) [N] of the pressure of a step, on the area displaced by u (N, 3) where displacements are large.

        None where u is wanted and not known at all nodes of the inner faces.
        """
        if not self.nonlinear or not step.pressure.any():
            return self.bricks.pressure_forces(step.pressure)
        if u is None or not np.all(np.isfinite(u[self.bricks.face_nodes(INNER)])):
            return None
        return self.bricks.pressure_forces(step.pressure, u)

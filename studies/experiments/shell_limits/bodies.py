"""Linear answers of a shell and of a solid on the same geometry, and what both cost.

Supports are named by the components of the local frame (0 along a1, 1 along a2, 2 along the normal), loads by the face
or the end that carries them. No case and no closed form may enter here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

from contact.solvers.sparse import factorise
from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Surface
from formulations.loads import Pressure
from formulations.section.laminate import BETWEEN_FACES, SECTIONS, Laminate
from formulations.shell import ShellModel
from formulations.solid import SolidDiscretisation, SolidModel
from formulations.solid_mesh import CUBE, SQUARE, SolidMesh
from formulations.strains.measure import StrainMeasure
from studies.scenes.element import PRESETS

Field = Callable[[np.ndarray, np.ndarray], np.ndarray]  # (position (..., 3), parameter (..., 3)) -> vector (..., 3)
POINTS = 8  # of an integral through the wall
REFINEMENTS = 2  # of a solution: thin walls are stiff across by (l/h)^4


@dataclass(frozen=True)
class Answer:
    """Quantities by name, and the unknowns they were solved for."""

    values: dict[str, float]
    unknowns: int


DEFAULT = "default"


@dataclass(frozen=True)
class Variant:
    """Options of the shell that may move its limit; ``surfaces``: how many there are through the wall."""

    name: str = DEFAULT
    section: str = SECTIONS[0]
    shear_correction: float = 1.0
    area: str = "face"
    surfaces: str = BETWEEN_FACES


NONSYMMETRIC, FULL_3D = (Variant(f"section {name}", section=name) for name in SECTIONS[1:])
REISSNER = Variant("shear correction 5/6", shear_correction=5 / 6)
MIDDLE = Variant("pressure area mid", area="mid")
USUAL = Variant()
OF_SURFACES = "surfaces="  # how the variants of more of them begin, and the setting that asks for them
THREE, FIVE, TWO_A_PLY, THREE_A_PLY = (
    Variant(f"{OF_SURFACES}{surfaces}", surfaces=surfaces) for surfaces in ("3", "5", "2/ply", "3/ply")
)


def solved(matrix: sparse.csc_matrix, load: np.ndarray, *, ordered: bool = False) -> np.ndarray:
    """u (n,) of K u = f, refined."""
    factor = factorise(matrix, ordered=ordered)
    u = factor.solve(load)
    for _ in range(REFINEMENTS):
        u = u + factor.solve(load - matrix @ u)
    return u


def body_of(surface: Surface, grid: Grid, laminate: Laminate, supports: Supports, variant: Variant) -> Discretisation:
    """A shell without loads."""
    return Discretisation.build(surface, grid, laminate, *supports.masks, ordered=True, surfaces=variant.surfaces)


def end_forces(
    body: Discretisation,
    nodes: np.ndarray,
    shares: np.ndarray,
    component: int,
    profile: Callable[[np.ndarray], np.ndarray],
) -> np.ndarray:
    """Forces, flat, of a traction on an end: profile(d) [MPa] over the wall, on the nodes (m,) by their shares.

    On every surface what does its work there; between two faces on these alone.
    """
    laminate, wall = body.laminate, body.wall
    unit, weight = np.polynomial.legendre.leggauss(POINTS)
    d = laminate.d_minus + 0.5 * laminate.thickness * (1 + unit)
    outer = 0.5 * (1 + unit)
    displaced = np.stack([1 - outer, outer]) if wall is None else np.array([wall.sampling.displaced(at) for at in d]).T
    on_surfaces = displaced @ (0.5 * laminate.thickness * weight * profile(d))
    forces = np.zeros((body.grid.n_nodes, len(on_surfaces), 3))
    forces[nodes, :, component] = shares[:, None] * on_surfaces
    return np.append(forces[:, [0, -1]].swapaxes(1, 2), forces[:, 1:-1])


def usual_shell(
    body: Discretisation,
    measure: StrainMeasure,
    section: str,
    *,
    forces: np.ndarray | None = None,
    p: float = 0.0,
    area: str = "face",
) -> ShellModel:
    """The shell with the element of the scenes under nodal forces (N, 6) and a dead pressure p [MPa] inside."""
    element: dict[str, Any] = {key: value for key, value in PRESETS["refined"].items() if key != "interpolation"}
    pressure = Pressure(p, area=area) if p else None
    load = None if forces is None else body.reduce(forces)
    return ShellModel(body, measure, section, pressure=pressure, forces=load, **element)


def solved_shell(shell: ShellModel) -> np.ndarray:
    """Unknowns (n,) of the shell under its loads, linear about rest."""
    at_rest = shell.linearise(np.zeros(shell.discretisation.n_free))
    return solved(at_rest.tangent, -at_rest.residual, ordered=shell.ordered)


@dataclass(frozen=True, eq=False)
class Solid:
    """A mesh with its supports; held (N, 3) bool: components of the local frame (e1, e2, e3) at each node."""

    surface: Surface
    mesh: SolidMesh
    laminate: Laminate
    held: np.ndarray

    @classmethod
    def over(
        cls, surface: Surface, lines1: np.ndarray, lines2: np.ndarray, laminate: Laminate, through: int = 1
    ) -> Solid:
        """Free hexahedra between the faces, ``through`` in each ply."""
        mesh = SolidMesh.build(surface, lines1, lines2, laminate, per_ply=through)
        return cls(surface, mesh, laminate, np.zeros((len(mesh.x), 3), bool))

    def hold(self, component: int, nodes: np.ndarray | slice = slice(None)) -> Solid:
        """The same with a component held on nodes, or everywhere."""
        held = self.held.copy()
        held[nodes, component] = True
        return Solid(self.surface, self.mesh, self.laminate, held)

    def solve(
        self,
        forces: np.ndarray | None = None,
        tied: tuple[np.ndarray, ...] = (),
        pressure: float = 0.0,
    ) -> tuple[np.ndarray, int]:
        """Displacements (N, 3) in the local frames, and the number of unknowns.

        forces (N, 3): Cartesian nodal forces; pressure [MPa]: on the true inner face.  tied: patterns (N, 3) of local
        displacements on held components, each with one amplitude as a further unknown: a rigid end.
        """
        mesh = self.mesh
        body = SolidDiscretisation.build(mesh, self.laminate, np.zeros_like(self.held))
        inner = Pressure(pressure, area="face") if pressure else None
        at_rest = SolidModel(body, inner).linearise(np.zeros(body.n_free))
        load = -at_rest.residual + (0.0 if forces is None else forces.ravel())
        turn = self._local()
        free = turn[:, np.flatnonzero(~self.held.ravel())]
        if tied:
            patterns = np.stack([each.ravel() for each in tied], axis=-1)
            free = sparse.hstack([free, turn @ sparse.csc_matrix(patterns)], format="csc")
        u = solved(sparse.csc_matrix(free.T @ at_rest.tangent @ free), free.T @ load)
        return np.asarray(turn.T @ (free @ u)).reshape(-1, 3), len(u)

    def frame(self, parameter: np.ndarray) -> np.ndarray:
        """Rows e1, e2, e3 (..., 3, 3) at parameters (..., 3)."""
        return self.surface.frame(parameter[..., 0], parameter[..., 1])

    def _local(self) -> sparse.csc_array:
        """Cartesian from local displacements (3N, 3N), orthogonal."""
        blocks = self.frame(self.mesh.parameter).swapaxes(-1, -2)
        n = len(blocks)
        return sparse.bsr_array((blocks, np.arange(n), np.arange(n + 1)), shape=(3 * n, 3 * n)).tocsc()

    def traction(self, face: np.ndarray, density: Field) -> np.ndarray:
        """Nodal forces (N, 3): int N_r t dA of a Cartesian traction t [MPa] on quadrilaterals ``face`` (F, 9)."""
        mesh = self.mesh
        area = np.linalg.norm(mesh.area_vectors(mesh.x, face)[1], axis=-1) * SQUARE.weights
        return self._spread(face, SQUARE.value, area, density)

    def body_force(self, density: Field) -> np.ndarray:
        """Nodal forces (N, 3): int N_r b dV of a Cartesian force b [N/mm^3] per volume."""
        mesh = self.mesh
        jacobian = np.einsum("gnd,enx->egdx", CUBE.slope, mesh.x[mesh.elements])
        return self._spread(mesh.elements, CUBE.value, np.abs(np.linalg.det(jacobian)) * CUBE.weights, density)

    def _spread(self, nodes: np.ndarray, value: np.ndarray, weight: np.ndarray, density: Field) -> np.ndarray:
        x, at = (np.einsum("gn,fnx->fgx", value, each[nodes]) for each in (self.mesh.x, self.mesh.parameter))
        shares = np.einsum("fg,gn,fgx->fnx", weight, value, density(x, at))
        forces = np.zeros_like(self.mesh.x)
        np.add.at(forces, nodes, shares)
        return forces

    def end(self, axis: int) -> np.ndarray:
        """Quadrilaterals (F, 9) of the body's last end along a_{axis+1}."""
        mesh, number = self.mesh, np.arange(27).reshape(3, 3, 3)
        local = (number[2] if axis == 0 else number[:, 2]).ravel()
        last = mesh.parameter[:, axis].max()
        on_end = np.isclose(mesh.parameter[mesh.elements][:, local, axis], last).all(axis=1)
        return mesh.elements[on_end][:, local]

    def line(self, a1: float, a2: float) -> np.ndarray:
        """Nodes on the normal through a point of the surface, from the inner face outwards."""
        there = np.intersect1d(self.mesh.on(0, a1), self.mesh.on(1, a2))
        return there[np.argsort(self.mesh.parameter[there, 2])]

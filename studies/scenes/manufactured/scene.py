"""A shell under the loads of a given motion: its errors are known on every mesh, for every measure.

Two edges are held at their given displacements, two carry the edge loads, and the body forces act on both faces.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Self

import numpy as np

from contact.problem import ContactProblem, ContactSolution, without_contact
from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.element.strain_operator import GAUSS, N_GAUSS
from formulations.loads import Traction, edge_force
from formulations.section.laminate import SECTIONS, Laminate
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from studies.ask.declarations import Sheet
from studies.ask.request import Request
from studies.ask.scene import (
    SOLVER,
    Begun,
    Declared,
    Observation,
    SceneModel,
    Setting,
    ShellSceneModel,
    Stage,
)
from studies.scenes.element import TWO_FACES, discretise, even_grid
from studies.scenes.manufactured.solution import Exact, Patch, Solution
from studies.scenes.manufactured.statements import LAYUPS, PIECES, Piece, TurnedWaves, wall
from studies.scenes.statics import area_load, loaded_shell, with_elements

QUANTITIES: Mapping[str, str] = {
    "error_displacement": "relative L2 error of the displacements of both faces",
    "error_resultants": "relative error of the resultants in the elements",
    "error_mean_resultants": "relative error of the mean resultants of the elements",
    "error_energy": "relative error in the norm of energy",
}


def errors(shell: ShellModel, u: np.ndarray, exact: Solution) -> dict[str, float]:
    """Relative errors of a state u (n,), by integrals over the mid surface.

    error_displacement: L2 norm of both faces.  error_resultants: L2 norm of H = D E at the Gauss points;
    error_mean_resultants: of the means of the elements, against the exact values at their centres.  error_energy: the
    energy norm sqrt(int dE D dE/2) of the strains at the Gauss points.
    """
    geometry, grid = shell.discretisation.geometry, shell.discretisation.grid
    points, weight, D = grid.points(GAUSS), geometry.weight[:, None], exact.stiffness
    displacement = interpolated(shell, u), exact.displacement(points)
    strains = shell.gauss_strains(u), exact.strains(points)
    means = shell.mean_strains(u), exact.strains(grid.points(np.zeros((1, 2)))[:, 0])
    return {
        "error_displacement": relative(displacement, lambda u: weight * np.sum(u**2, axis=(-2, -1))),
        "error_resultants": relative(strains, lambda E: weight * np.sum((E @ D.T) ** 2, axis=-1)),
        "error_mean_resultants": relative(means, lambda E: geometry.weight * np.sum((E @ D.T) ** 2, axis=-1)),
        "error_energy": relative(strains, lambda E: weight * np.sum(E * (E @ D.T), axis=-1)),
    }


def relative(pair: tuple[np.ndarray, np.ndarray], square: Callable[[np.ndarray], np.ndarray]) -> float:
    """Norm of the error of computed values, relative to the exact ones; ``square``: the terms of its square."""
    computed, exact = pair
    return float(np.sqrt(np.sum(square(computed - exact)) / np.sum(square(exact))))


def interpolated(shell: ShellModel, u: np.ndarray) -> np.ndarray:
    """Cartesian displacements of both faces at the Gauss points, (E, 4, 2, 3)."""
    discretisation = shell.discretisation
    frame = discretisation.gauss_frames()
    v = shell.displacements(u)[discretisation.grid.elements].reshape(-1, 4, 3, 2)
    value = np.broadcast_to(discretisation.geometry.value, (len(v), N_GAUSS, 4, 3, 3))
    return np.einsum("egrij,erjf,egix->egfx", value, v, frame, optimize=True)


SETTINGS = (
    Setting.one_of("surface", PIECES, "torus", "piece of a surface"),
    Setting.one_of("layup", LAYUPS, "skew", "two plies that are symmetric nowhere, or one isotropic one"),
    Setting.positive("h_mm", 0.18, "thickness; the pieces are about 1 mm long and wide", 0.4),
    Setting("rotation_deg", 30.0, "rotation of the whole piece about a skew axis", low=-180, high=180),
    Setting("stretch", 0.15, "uniform elongation of the piece", low=0, high=1),
    Setting("wave_mm", 0.04, "amplitude of the waves that the piece is bent into", low=0, high=0.2, unit="mm"),
    Setting.one_of("section", SECTIONS, "constant-s33", "law of the section for the thickness stretch"),
    *TWO_FACES,
    SOLVER,
)


def exact_loads(discretisation: Discretisation, exact: Solution, loaded: Mapping[int, float]) -> np.ndarray:
    """Nodal forces (N, 6) of the body forces on both faces and of the loads on the ``loaded`` edges {axis: a_axis}."""
    forces = np.zeros((discretisation.grid.n_nodes, 6))
    for face, shares in enumerate(((1.0, 0.0), (0.0, 1.0))):
        forces += area_load(discretisation, _on_face(exact.body_force, face), shares)
        for axis, end in loaded.items():
            traction = _on_face(partial(exact.edge_force, axis), face)
            forces += edge_force(discretisation, axis, end, traction, shares)
    return forces


def _on_face(force: Callable[[np.ndarray], np.ndarray], face: int) -> Traction:
    return lambda a1, a2: force(np.stack([a1, a2], axis=-1))[..., face, :]


def carrying(shell: ShellModel, exact: Solution, loaded: Mapping[int, float]) -> ShellModel:
    """The shell under the loads of a solution, its held edges where they belong."""
    free = shell.discretisation
    forces = free.reduce(exact_loads(free, exact, loaded))
    return replace(shell, forces=forces, prescribed=np.where(free.map.held, _nodal(free, exact), 0.0))


def unknowns_at(discretisation: Discretisation, exact: Solution) -> np.ndarray:
    """The unknowns (n,) that put the nodes where they belong."""
    held = discretisation.map.held
    return discretisation.map.gather(np.where(held, 0.0, _nodal(discretisation, exact)))


def _nodal(discretisation: Discretisation, exact: Solution) -> np.ndarray:
    """The exact displacements of the nodes in their frames, (N, 6)."""
    nodes = discretisation.grid.nodes
    u = exact.displacement(nodes)
    return np.einsum("nix,nfx->nif", discretisation.surface.frame(*nodes.T), u).reshape(len(nodes), -1)


@dataclass(frozen=True, eq=False)
class ManufacturedModel(ShellSceneModel):
    """One path of the amount t of the motion: at t = 1 the errors are read.

    shell: without loads.  exact_at(t): the solution there.  loaded: the edges that carry their loads {axis: a_axis}.
    """

    shell: ShellModel
    exact_at: Callable[[float], Exact]
    loaded: Mapping[int, float]

    def stages(self) -> Iterator[Stage]:
        """The path from the exact solution at the nodes."""
        yield Stage("motion", self._begin, (1.0,), self._observe)

    def problem_at(self, t: float) -> ContactProblem:
        """Without contact. Energy is not balanced: the straight path from rest with both edges where they are held
        passes through collapsed elements.
        """
        shell = carrying(self.shell, self.exact_at(t), self.loaded)
        problem = without_contact(shell.linearise, self.n_unknowns, ordered=shell.ordered)
        problem = replace(problem, others=shell.left_to_foundation, residual=shell.residual)
        return with_elements(problem, shell)

    def moved(self, t: float) -> Self:
        """With its held edges where they are at t."""
        return replace(self, shell=carrying(self.shell, self.exact_at(t), self.loaded))

    def _begin(self, previous: ContactSolution | None) -> Begun:
        u = unknowns_at(self.shell.discretisation, self.exact_at(1.0))
        return self.problem_at, replace(ContactSolution.at_rest(self.n_unknowns, 0), u=u)

    def _observe(self, problem: ContactProblem, state: ContactSolution, t: float) -> Observation:
        exact = self.exact_at(t)
        norms = errors(carrying(self.shell, exact, self.loaded), state.u, exact)
        return Observation({"motion": t, **norms}, norms)


def held_piece(request: Request) -> tuple[Piece, Laminate, ShellModel, Supports]:
    """The piece asked for, its wall, and the shell on it, held along the first edge of either coordinate."""
    piece, laminate = PIECES[request.choice("surface")], wall(request.choice("layup"), request.number("h_mm"))
    grid = even_grid(request, piece.a1, piece.a2)
    supports = Supports.of_edges(grid, "clamped", "free", "clamped", "free")
    body = discretise(request, piece.surface, grid, laminate, *supports.masks)
    return piece, laminate, loaded_shell(body, request, section=request.choice("section")), supports


class Manufactured(Declared):
    """A piece of a surface that is stretched, bent into waves and turned."""

    name = "manufactured"
    title = "Shell with a given large motion and the loads that it needs (errors known exactly)"
    default_mesh = (16, 16)
    settings = SETTINGS
    quantities = QUANTITIES
    sheet = Sheet("x", 40.0, 28.0)

    def build(self, request: Request) -> SceneModel:
        """The first edge of each coordinate is held and the last one loaded; the exact solution is that of a wall of
        two faces.
        """
        piece, laminate, shell, _ = held_piece(request)
        measure, stiffness = MEASURES[request.measure], laminate.stiffness(request.choice("section"))
        patch = Patch.over(piece.a1, piece.a2)
        angle, stretch = np.deg2rad(request.number("rotation_deg")), request.number("stretch")

        @cache
        def exact_at(t: float) -> Exact:
            field = TurnedWaves(piece.surface, laminate, t * angle, t * stretch, t * request.number("wave_mm"))
            return Exact(piece.surface, laminate, measure, stiffness, patch, field)

        return ManufacturedModel(shell, exact_at, {0: piece.a1[1], 1: piece.a2[1]})


SCENES = (Manufactured(),)

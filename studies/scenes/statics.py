"""A shell under loads that grow with a load fraction: how loads are made and states read, with contact and without."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, TypedDict, Unpack

import numpy as np

from contact.problem import ContactProblem, ContactSolution, without_contact
from formulations.discretisation import Discretisation
from formulations.element.strain_operator import GAUSS, N_GAUSS
from formulations.geometry.grid import Grid
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from studies.ask.scene import SOLVER, Begun, Observation, Request, Setting, ShellSceneModel, Stage
from studies.scenes.element import ELEMENT, bending_of, law_of

if TYPE_CHECKING:  # loaded with a scene that has such loads
    from formulations.element_modes import ElementModes
    from formulations.loads import Couples, Pressure

REPORTED = "fractions of the published load to report"
LOAD_FRACTIONS = Setting.positive("load_fraction", (0.25, 0.5, 0.75, 1.0), REPORTED, 10, kind="floats")
AT = 1e-9  # over half an element: rounding of a place on its edge
LOAD_FRACTION = replace(LOAD_FRACTIONS, default=(1.0,))
SHELL_SETTINGS = (
    Setting.positive("shear_correction", 1.0, "factor on the shear stiffness; 1000: Kirchhoff", 1e4),
    *ELEMENT,
    SOLVER,
)

Reading = Callable[[ShellModel, np.ndarray], dict[str, float]]  # (shell, u) -> {name_unit: value}


def normal_forces(grid: Grid, forces: Mapping[int, float]) -> np.ndarray:
    """(N, 6): normal forces [N] on nodes, half of each on either face."""
    nodal = np.zeros((grid.n_nodes, 6))
    for node, force in forces.items():
        nodal[node, 4:] = 0.5 * force
    return nodal


def normal_at(discretisation: Discretisation, places: Mapping[str, tuple[int | np.ndarray, int]]) -> Reading:
    """Mean normal displacements of both faces by name; places: nodes, and 1 outwards or -1 inwards."""

    def read(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
        v = discretisation.expand(u)
        return {name: float(sign * v[nodes, 4:].mean()) for name, (nodes, sign) in places.items()}

    return read


def elements_at(grid: Grid, a1: float, a2: float) -> np.ndarray:
    """The elements (k,) that hold a point, on their edges included."""
    return np.flatnonzero(np.all(np.abs(grid.centre - [a1, a2]) <= (1 + AT) * grid.half, axis=1))


def area_load(
    discretisation: Discretisation,
    density: Callable[[np.ndarray, np.ndarray], np.ndarray],
    shares: tuple[float, float] = (0.5, 0.5),
) -> np.ndarray:
    """Consistent nodal forces (N, 6) in the local frames: F_i^r = int N_r (p . e_i) dA with the area dA of mubar.

    ``density(a1, a2)``: dead force per area p, (..., 3) or (3,), in Cartesian components. ``shares`` go to the inner
    and to the outer face. p is projected on the frame at every Gauss point and does work on the displacement that the
    element interpolates there; projecting it at the nodes instead would differ by O(l^2).
    """
    grid = discretisation.grid
    a1, a2 = np.moveaxis(grid.points(GAUSS), -1, 0)
    p = np.broadcast_to(density(a1, a2), (*a1.shape, 3))
    local = np.einsum("...ij,...j->...i", discretisation.gauss_frames(), p)
    weight = np.broadcast_to(discretisation.geometry.point_areas("mid"), a1.shape)
    value = np.broadcast_to(discretisation.geometry.value, (len(weight), N_GAUSS, 4, 3, 3))
    nodal = np.einsum("eg,egrij,egi->erj", weight, value, local, optimize=True)
    forces = np.zeros((grid.n_nodes, 6))
    for face, share in enumerate(shares):
        np.add.at(forces[:, face::2], grid.elements, share * nodal)
    return forces


class Loads(TypedDict, total=False):
    """What a shell carries; forces and displacements of supports (N, 6) are in the local frames, forces dead."""

    forces: np.ndarray
    pressure: Pressure
    couples: Couples
    prescribed: np.ndarray


def edge_shares(discretisation: Discretisation, axis: int, value: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (m,) of the line a_{axis+1} = value and their shares of a uniform load on it; the sum of these is 1."""
    from formulations.loads import edge_lengths  # as those

    nodes, lengths = edge_lengths(discretisation, axis, value)
    return nodes, lengths / lengths.sum()


def edge_forces(discretisation: Discretisation, axis: int, value: float, force: float) -> np.ndarray:
    """(N, 6): a uniform normal force [N] in all on the line a_{axis+1} = value, half on either face."""
    nodes, shares = edge_shares(discretisation, axis, value)
    return normal_forces(discretisation.grid, dict(zip(nodes.tolist(), force * shares, strict=True)))


def loaded_shell(
    discretisation: Discretisation, request: Request, *, section: str = "constant-s33", **loads: Unpack[Loads]
) -> ShellModel:
    """The shell that was asked for."""
    return ShellModel(
        discretisation,
        MEASURES[request.measure],
        section=section,
        newton=request.newton,
        pressure=loads.get("pressure"),
        forces=discretisation.reduce(loads["forces"]) if "forces" in loads else None,
        couples=loads.get("couples"),
        prescribed=loads.get("prescribed"),
        law=law_of(request),
        thickness_strain=request.choice("thickness_strain"),
        membrane=request.choice("membrane"),
        bending=bending_of(request),
    )


def with_balances(problem: ContactProblem, shell: ShellModel) -> ContactProblem:
    """The problem with what the judge sees of a shell: energy, where it has one, forces, and its elements."""
    return replace(
        with_elements(problem, shell),
        energy=shell.energy if shell.conservative else None,
        others=shell.left_to_foundation,
        residual=shell.residual,
    )


def with_elements(problem: ContactProblem, shell: ShellModel) -> ContactProblem:
    """The problem with what the judge sees of the elements of a shell: their modes, and which are inside out.

    Surfaces inside the wall have shears that are not looked at.
    """
    volumes = None if shell.linear else shell.volume_ratios
    modes = partial(_element_modes, shell) if shell.discretisation.wall is None else None
    return replace(problem, element_modes=modes, volume_ratios=volumes)


def _element_modes(shell: ShellModel, u: np.ndarray) -> ElementModes:
    from formulations.element_modes import ElementModes  # loaded where something is unstable alone

    return ElementModes(shell, u)


@dataclass(frozen=True, eq=False)
class StaticModel(ShellSceneModel):
    """One path of the load fraction; ``measure_at(shell, u)`` reads the displacements {name_unit: value}."""

    shell: ShellModel
    fractions: Sequence[float]
    measure_at: Reading

    @classmethod
    def of(
        cls, request: Request, discretisation: Discretisation, measure_at: Reading, **loads: Unpack[Loads]
    ) -> StaticModel:
        """The shell under its loads at the load fractions asked for."""
        shell = loaded_shell(discretisation, request, **loads)
        return cls(shell, request.numbers("load_fraction"), measure_at)

    def stages(self) -> Iterator[Stage]:
        """The load path from rest."""
        yield Stage("load", self._begin, tuple(self.fractions), self._observe)

    @property
    def without_rise(self) -> tuple[str, ...]:
        """Names of displacements under point loads less what grows there with every finer mesh."""
        return ()

    def _begin(self, previous: ContactSolution | None) -> Begun:
        return self.problem_at, ContactSolution.at_rest(self.shell.discretisation.n_free, 0)

    def problem_at(self, fraction: float) -> ContactProblem:
        """The shell under a fraction of its load."""
        shell = self.shell.scaled(fraction)
        n = shell.discretisation.n_free
        return with_balances(without_contact(shell.linearise, n, ordered=shell.ordered), shell)

    def _displacements(self, u: np.ndarray, fraction: float) -> dict[str, float]:
        return self.measure_at(self.shell, u)

    def _observe(self, problem: ContactProblem, state: ContactSolution, fraction: float) -> Observation:
        displacements = self._displacements(state.u, fraction)
        return Observation({"load_fraction": fraction, **displacements}, displacements)

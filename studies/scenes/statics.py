"""Scenes without contact: a shell under loads that grow with a load fraction, stepped or traced as a curve."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import TypedDict, Unpack

import numpy as np

from contact.continuation.arc_length import ArcLength
from contact.continuation.equilibrium_curve import ArcPoint
from contact.continuation.series_path import PowerSeries
from contact.problem import ContactProblem, ContactSolution, without_contact
from formulations.discretisation import Discretisation
from formulations.element_modes import ElementModes
from formulations.geometry.grid import Grid
from formulations.loads.lines import edge_lengths
from formulations.loads.pressure import Couples, Pressure
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from studies.ask.request import Request
from studies.ask.scene import ArcStage, Begun, Observation, Setting, ShellSceneModel, Stage, UsageError

REPORTED = "fractions of the published load to report"
LOAD_FRACTIONS = Setting.positive("load_fraction", (0.25, 0.5, 0.75, 1.0), REPORTED, 10, kind="floats")
CURVE_FRACTIONS = replace(LOAD_FRACTIONS, default=(1.0,), help="load fractions to hit; the last ends the curve")
UNTIL = Setting.one_of("until", ("load", "limit"), "load", "end of the curve: the last load, or the first limit point")
ARC_STEP = Setting(
    "arc_step", 0.01, "load fraction of the first step of arc length; --steps divides it", low=1e-6, high=1
)
SERIES, ARC_LENGTH = "series", "arc-length"
PATH = Setting.one_of(
    "path",
    (SERIES, ARC_LENGTH),
    None,
    "how the curve is followed: by power series, itself, or by points at an arc length",
    otherwise="series for a measure quadratic in the displacements, else arc-length",
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


def point_rise(force: float, shear_stiffness: float, thickness: float, size: float) -> float:
    """What elements of a size other than the wall's thickness h add [mm] to the deflection under a point force F [N].

    Under it a shell of the shear stiffness S [N/mm] sinks in by a logarithm without bound, S lap w = -F delta, so
    w = -F/(2 pi S) ln r. Elements of the size l see that at r ~ l: they have F/(2 pi S) ln(h/l) more than those as
    large as the wall is thick, and the deflection without it has a limit. force: of the whole plane around the point,
    of which symmetry may leave a quarter.
    """
    return force / (2 * np.pi * shear_stiffness) * float(np.log(thickness / size))


def element_size(discretisation: Discretisation, node: int) -> float:
    """Geometric mean of the sides [mm] of the elements at a node."""
    elements = discretisation.grid.elements
    corners = discretisation.positions()[0][elements[np.any(elements == node, axis=1)]]
    return float(np.sqrt(np.linalg.norm(corners[:, [1, 3]] - corners[:, [0]], axis=-1).prod(axis=-1).mean()))


class Loads(TypedDict, total=False):
    """What a shell carries; forces (N, 6) are dead and in the local frames."""

    forces: np.ndarray
    pressure: Pressure
    couples: Couples


def edge_shares(discretisation: Discretisation, axis: int, value: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (m,) of the line a_{axis+1} = value and their shares of a uniform load on it; the sum of these is 1."""
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
        thickness_strain=request.choice("thickness_strain"),
        membrane=request.choice("membrane"),
    )


def with_balances(problem: ContactProblem, shell: ShellModel) -> ContactProblem:
    """The problem with what the judge sees of a shell: energy, where it has one, forces, and modes of elements."""
    return replace(
        problem,
        energy=shell.energy if shell.conservative else None,
        others=shell.left_to_foundation,
        residual=shell.residual,
        element_modes=partial(ElementModes, shell),
    )


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


@dataclass(frozen=True, eq=False)
class CurveModel(StaticModel):
    """The same under dead forces only, its curve traced through limit points until its last load fraction or UNTIL.

    rises: of displacements by name under a point load, see :func:`point_rise`, at load fraction 1; what is left without
    them is reported, too: of w_mm as w_even_mm.
    """

    continuation: ArcLength | PowerSeries
    rises: Mapping[str, float]

    @classmethod
    def of(
        cls,
        request: Request,
        discretisation: Discretisation,
        measure_at: Reading,
        rises: Mapping[str, float] = MappingProxyType({}),
        **loads: Unpack[Loads],
    ) -> CurveModel:
        """The first arc step is ``arc_step`` over the number of steps.

        Raises UsageError where power series are asked for and do not apply.
        """
        static = StaticModel.of(request, discretisation, measure_at, **loads)
        return cls(**vars(static), continuation=_continuation(request, static.shell), rises=rises)

    def stages(self) -> Iterator[Stage]:
        """The curve from rest."""
        assert self.shell.forces is not None
        unloaded = self.shell.scaled(0.0)
        path = ("curve", self._begin, self.fractions, self._observe)
        shell = (unloaded.linearise, self.shell.forces, unloaded.series)
        yield ArcStage(*path, self.continuation, self._summarise, *shell)

    def _displacements(self, u: np.ndarray, fraction: float) -> dict[str, float]:
        found = self.measure_at(self.shell, u)
        even = {key.replace("_mm", "_even_mm"): found[key] - fraction * rise for key, rise in self.rises.items()}
        return found | even

    def _summarise(self, points: Sequence[ArcPoint]) -> dict[str, float]:
        """Number of limit points, load and displacements of the first."""
        limits = [point for point in points if point.limit]
        summary = {"limit_points": float(len(limits))}
        if limits:
            summary["limit_load_fraction"] = limits[0].factor
            at_limit = self._displacements(limits[0].u, limits[0].factor)
            summary |= {f"limit_{key}": value for key, value in at_limit.items()}
        return summary


def _continuation(request: Request, shell: ShellModel) -> ArcLength | PowerSeries:
    """What follows the curve: what was asked for, else power series where they apply; raises UsageError."""
    asked, obstacle = request.settings.get("path"), shell.quadratic
    if asked == SERIES and obstacle is not None:
        raise UsageError(f"path = {SERIES} does not apply: {obstacle}; it must be {ARC_LENGTH}")
    solver, tolerance, ordered = request.choice("solver"), request.number("tolerance"), shell.ordered
    to_limit = request.settings.get("until") == "limit"
    if obstacle is None and asked != ARC_LENGTH:
        return PowerSeries(to_limit=to_limit, solver=solver, tolerance=tolerance, ordered=ordered)
    first = request.number("arc_step") / request.steps
    return ArcLength(first, to_limit=to_limit, solver=solver, tolerance=tolerance, ordered=ordered)

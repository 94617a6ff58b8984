"""Shells under dead forces whose equilibrium curve is traced through limit points, by power series or by arc length."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Unpack

import numpy as np

from contact.continuation.arc_length import ArcLength, Trace
from contact.continuation.equilibrium_curve import ArcPoint
from contact.continuation.power_series import Expand
from contact.continuation.series_path import PowerSeries
from contact.problem import ContactAlgorithm, Linearise, Outcome
from formulations.discretisation import Discretisation
from formulations.shell import ShellModel
from formulations.shell_series import ShellSeries
from studies.ask.scene import Begun, CurveStage, Request, Setting, Stage, UsageError
from studies.scenes.statics import LOAD_FRACTIONS, Loads, Reading, StaticModel

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


@dataclass(frozen=True, eq=False)
class ArcStage(CurveStage):
    """The curve of a body without contact from rest, t the factor of its load.

    linearise: the model without its load; load (n,): the dead force at t = 1.  expand: its recurrence for power series.
    """

    linearise: Linearise
    load: np.ndarray
    expand: Expand

    def trace(self, begun: Begun, algorithm: ContactAlgorithm, tell: Callable[[float], None]) -> Trace:
        """Without contact the algorithm is not used. A curve to the first limit point alone has converged there."""
        if isinstance(self.continuation, PowerSeries):
            trace = self.continuation.trace(self.linearise, self.expand, self.load, self.targets, tell)
        else:
            trace = self.continuation.trace(self.linearise, self.load, self.targets, tell)
        at_limit = self.continuation.to_limit and trace.outcome is Outcome.LIMIT_POINT
        return replace(trace, outcome=Outcome.CONVERGED) if at_limit else trace


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

    @property
    def without_rise(self) -> tuple[str, ...]:
        """Those of ``rises``, named as they are reported."""
        return tuple(map(_even, self.rises))

    def stages(self) -> Iterator[Stage]:
        """The curve from rest."""
        assert self.shell.forces is not None
        unloaded = self.shell.scaled(0.0)
        path = ("curve", self._begin, self.fractions, self._observe)
        shell = (unloaded.linearise, self.shell.forces, partial(ShellSeries.of, unloaded))
        yield ArcStage(*path, self.continuation, self._summarise, *shell)

    def _displacements(self, u: np.ndarray, fraction: float) -> dict[str, float]:
        displacements = self.measure_at(self.shell, u)
        return displacements | {_even(key): displacements[key] - fraction * rise for key, rise in self.rises.items()}

    def _summarise(self, points: Sequence[ArcPoint]) -> dict[str, float]:
        """Number of limit points, load and displacements of the first."""
        limits = [point for point in points if point.limit]
        summary = {"limit_points": float(len(limits))}
        if limits:
            summary["limit_load_fraction"] = limits[0].factor
            at_limit = self._displacements(limits[0].u, limits[0].factor)
            summary |= {f"limit_{key}": value for key, value in at_limit.items()}
        return summary


def _even(key: str) -> str:
    return key.replace("_mm", "_even_mm")


def _continuation(request: Request, shell: ShellModel) -> ArcLength | PowerSeries:
    """What follows the curve: what was asked for, else power series where they apply; raises UsageError."""
    method, obstacle = request.settings.get("path"), shell.quadratic
    if method == SERIES and obstacle is not None:
        raise UsageError(f"path = {SERIES} does not apply: {obstacle}; it must be {ARC_LENGTH}")
    solver, tolerance, ordered = request.choice("solver"), request.number("tolerance"), shell.ordered
    to_limit = request.settings.get("until") == "limit"
    if obstacle is None and method != ARC_LENGTH:
        return PowerSeries(to_limit=to_limit, solver=solver, tolerance=tolerance, ordered=ordered)
    first = request.number("arc_step") / request.steps
    return ArcLength(first, to_limit=to_limit, solver=solver, tolerance=tolerance, ordered=ordered)

"""A mesh for an error: a short ladder of adapted grids, extrapolated, up to the first one that is good enough.

The force on a grid of N elements, spaced alike on every rung, is F = L + c/N + noise/N: bilinear elements converge with
the square of their size, and so does what the rim of the patch does between the lines, up and down. L and c are a least
squares fit with the weights N; its standard error covers what the rim leaves of Richardson's smooth law. The error of a
rung is |F - L|/|L|, its band covers both sides by Student's t, and a rung passes by the upper end.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, Self, runtime_checkable

import numpy as np
import pandas as pd
from scipy.special import stdtrit

from studies.request import Request
from studies.scene import Scene, UsageError
from studies.solving import Result, solve

ELEMENTS = tuple(round(400 * 1.5**k) for k in range(8))  # 400 to 6834
FEWEST = 3  # rungs, for two unknowns and a residual
COVER = 0.9  # probability with which the band covers, by Student's t


@runtime_checkable
class AdaptiveScene(Scene, Protocol):
    """A scene that can space its grid by an estimate of the error of its force."""

    def adapted(self, request: Request) -> Self:
        """The scene with the estimate made; raises UsageError where that fails."""

    def mesh_of(self, request: Request, elements: float) -> tuple[int, int]:
        """The best proportions of about so many elements."""


@dataclass(frozen=True)
class Estimate:
    """What a ladder says of the force on its last rung; errors are relative.

    limit [N]: extrapolated, known to +- limit_uncertainty.  error: of the last rung, between low and high.
    """

    limit: float
    limit_uncertainty: float
    error: float
    low: float
    high: float


def parse_error(text: str) -> float:
    """The relative error of "1%" or "0.01"; raises UsageError unless it is in [0.01%, 50%]."""
    try:
        value = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        value = float("nan")
    if not 1e-4 <= value <= 0.5:
        raise UsageError(f"error {text!r} must be a part of the force in [0.01%, 50%], as 1% or 0.01")
    return value


def extrapolate(elements: Sequence[float], forces: Sequence[float]) -> Estimate:
    """Fit F = L + c/N by least squares with the weights N; raises ValueError for fewer than three rungs."""
    n, f = np.asarray(elements, float), np.asarray(forces, float)
    if len(n) < FEWEST:
        raise ValueError(f"a ladder needs {FEWEST} rungs, got {len(n)}")
    weighted = np.stack([n, np.ones_like(n)], axis=-1)  # N times (1, 1/N)
    (limit, slope), *_ = np.linalg.lstsq(weighted, n * f, rcond=None)
    left = n * f - weighted @ (limit, slope)
    variance = float(left @ left) / (len(n) - 2)
    student = float(stdtrit(len(n) - 2, 0.5 + 0.5 * COVER))
    uncertainty = student * float(np.sqrt(variance * np.linalg.inv(weighted.T @ weighted)[0, 0]))
    off, scale = abs(float(f[-1]) - limit), abs(float(limit))
    low, high = max(off - uncertainty, 0.0), off + uncertainty
    return Estimate(float(limit), uncertainty, off / scale, low / scale, high / scale)


def solve_to_error(
    scene: AdaptiveScene,
    request: Request,
    error: float,
    progress: Callable[[str], None] = lambda text: None,
    elements: Sequence[int] = ELEMENTS,
) -> tuple[Result, bool]:
    """The result on the first rung whose error is surely below ``error``, or on the last, and whether it is.

    Its quantities hold the ladder and the estimate, its table ``ladder`` the same in columns. A rung that does not
    converge ends the ladder: its result is returned.
    """
    start = time.perf_counter()
    progress("an estimate on coarse grids")
    scene = scene.adapted(request)
    rungs: list[dict[str, float]] = []
    for count in elements:
        result = solve(scene, replace(request, mesh=scene.mesh_of(request, count)), progress)
        if result.unsupported or not result.outcome.converged:
            return result, False
        rungs.append(_rung(result))
        result.timing["ladder"] = time.perf_counter() - start
        enough = len(rungs) >= FEWEST
        found = extrapolate(*([rung[key] for rung in rungs] for key in ("elements", "force_N"))) if enough else None
        _record(result, rungs, found, error)
        if found is not None and found.high <= error:
            return result, True
    result.reason = f"no mesh of up to {elements[-1]} elements has a force that is surely within {100 * error:g} %"
    return result, False


def _rung(result: Result) -> dict[str, float]:
    """Mesh, unknowns, force at the last travel and seconds of a result."""
    n1, n2 = result.request.mesh
    return {
        "n1": n1,
        "n2": n2,
        "elements": n1 * n2,
        "unknowns": result.counters["dofs"],
        "force_N": float(result.steps[-1]["force_N"]),
        "seconds": result.timing["total"],
    }


def _record(result: Result, rungs: Sequence[dict[str, float]], found: Estimate | None, error: float) -> None:
    """Ladder and estimate as quantities, and the ladder as a table."""
    result.tables["ladder"] = [pd.DataFrame(rungs)]
    for k, rung in enumerate(rungs, 1):
        result.quantities |= {f"ladder_{k}_{key}": rung[key] for key in ("unknowns", "force_N")}
    result.quantities["error_asked"] = error
    if found is not None:
        result.quantities |= {
            "force_limit_N": found.limit,
            "force_limit_uncertainty_N": found.limit_uncertainty,
            "error_estimate": found.error,
            "error_low": found.low,
            "error_high": found.high,
        }

"""What each setting of OSQP is worth, one at a time, on the programme as it is and as we scale it.

Source of the settings: Stellato et al., Math. Program. Comput. 12 (2020) 637-672, sections 3.2, 4 and 5.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
import pandas as pd

from contact.algorithms.qp import Scaled
from contact.interchange.linearised_step import FrozenStep
from contact.solvers.qp_backends import Answer as Found
from studies.arena.solvers.base import Solver
from studies.arena.solvers.catalogue import OURS
from studies.arena.solvers.outside import Condensed, Outside, programme
from studies.arena.solvers.programmes import osqp

NEAR = 0.99  # of the loads and gaps, the step whose answer a warm start sets out from
SETTINGS: dict[str, dict[str, Any]] = {
    "defaults": {},
    "no scaling": {"scaling": 0},
    "scaling 50": {"scaling": 50},
    "rho 1e-3": {"rho": 1e-3},
    "rho 10": {"rho": 10.0},
    "rho 1e3": {"rho": 1e3},
    "rho fixed": {"adaptive_rho": 0},
    "rho adapted every 200": {"adaptive_rho_interval": 200},
    "one rho for all rows": {"rho_is_vec": 0},
    "polished": {"polishing": True},
    "no gap asked for": {"check_dualgap": 0},
    "sigma 1e-9": {"sigma": 1e-9},
    "no relaxation": {"alpha": 1.0},
}


@dataclass(frozen=True)
class WarmOsqp(Outside):
    """OSQP from the exact answer of a step with NEAR of the loads and gaps, which is not timed."""

    def prepare(self, step: FrozenStep) -> None:
        """Find where it starts."""
        super().prepare(step)
        _near(step)

    def _found(self, step: FrozenStep, whole: Scaled | None, tolerance: float) -> Found:
        du, forces = _near(step)
        if whole is not None:
            du, forces = du / (whole.size * whole.stretch), whole.multipliers(forces)
        return osqp(programme(step, whole), tolerance, (du, forces))


@dataclass(frozen=True)
class ReducedOsqp(Outside):
    """Conjugate gradients on the reduced system, (P + sigma I + rho A^T A) x = b, where the wheel has them."""

    def missing(self) -> str | None:
        """Of osqp itself, and of an algebra with that system."""
        return super().missing() or (None if _algebra() else "osqp has only its builtin algebra, which factorises")

    def _found(self, step: FrozenStep, whole: Scaled | None, tolerance: float) -> Found:
        return osqp(programme(step, whole), tolerance, algebra=_algebra())


def _algebra() -> str:
    """The first of those that solve the reduced system, or nothing."""
    available = importlib.import_module("osqp").algebras_available()
    return next((name for name in ("mkl", "cuda") if name in available), "")


@lru_cache(maxsize=2)
def _near(step: FrozenStep) -> tuple[np.ndarray, np.ndarray]:
    """The exact du (n,) and nodal forces (m,) of a step whose loads and gaps are nearly those."""
    found = OURS[0].answer(replace(step, r=NEAR * step.r, gap=NEAR * step.gap), 1e-9)
    return found.du / NEAR**2, step.weights * found.pressure


def _variants(scaled: bool) -> Iterator[Solver]:
    words = ", scaled" if scaled else ""
    for name, settings in SETTINGS.items():
        yield Outside(f"OSQP{words}: {name}", "osqp", call=partial(osqp, **settings), scaled=scaled)
    yield WarmOsqp(f"OSQP{words}: warm start", "osqp", scaled=scaled)
    yield ReducedOsqp(f"OSQP{words}: reduced KKT", "osqp", scaled=scaled)
    if scaled:
        yield Condensed("OSQP, scaled: condensed", "osqp")


ABLATION: tuple[Solver, ...] = (*_variants(scaled=False), *_variants(scaled=True))


def effects(summed: pd.DataFrame) -> pd.DataFrame:
    """What each setting changes against the defaults of the same scale: a row a tolerance, kind, size and variant.

    summed: of :func:`studies.arena.solver_summaries.summary`.  time_ratio: of the shifted means, below 1 where the
    setting is quicker.  more_solved, more_false: of the number of problems.
    """
    places = ["tolerance", "kind", "size", "scale"]
    scale, setting = (summed["solver"].str.split(": ", n=1).str[i] for i in (0, 1))
    table = summed.assign(scale=scale, setting=setting)
    table = table[[*places, "setting", "problems", "mean_s", "solved", "false"]]
    defaults = table[table["setting"] == "defaults"].drop(columns=["setting", "problems"])
    found = table.merge(defaults, on=places, suffixes=("", "_default"))
    found["time_ratio"] = found["mean_s"] / found["mean_s_default"]
    for column in ("solved", "false"):
        found[f"more_{column}"] = found[column] - found[f"{column}_default"]
    return found[[*places, "setting", "problems", "mean_s", "time_ratio", "more_solved", "more_false"]]

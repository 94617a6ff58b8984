"""All solvers of the arena by name, installed or not: the algorithms of this suite and public ones.

Ours solve a frozen step from rest without an initial set, as all others. ABLATION is a separate field: OSQP with one
setting changed at a time, on the programme as it is and as scaled here. Source of the settings: Stellato et al., Math.
Program. Comput. 12 (2020) 637-672, sections 3.2, 4 and 5.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from contact.algorithms.qp import Scaled
from contact.catalogue import ALGORITHMS
from contact.interchange.linearised_step import FrozenStep
from contact.problem import ContactAlgorithm, ContactSolution
from contact.solvers.qp_backends import Answer as QPAnswer
from contact.solvers.sparse import asymmetry, symmetric
from studies.arena.solvers.base import Answer, Solver
from studies.arena.solvers.outside import CONDENSED, OUTSIDE, Condensed, Outside, osqp, programme


@dataclass(frozen=True)
class Ours(Solver):
    """An algorithm of the catalogue with its own settings, enforcing the constraint exactly.

    The tolerance is that of its equilibrium; gaps it closes to rounding whatever is asked.
    """

    algorithm: str = ""
    settings: Mapping[str, object] = field(default_factory=dict)

    def applies(self, step: FrozenStep) -> str | None:
        """As the algorithm, and symmetry of K where it minimises a function."""
        reason = self._made().supports(step.problem())
        minimises = self.algorithm == "qp" or self.settings.get("method") == "nnls"
        if reason is None and minimises and not symmetric(step.K):
            return f"K is not symmetric (to {asymmetry(step.K):.1e}): there is no function to minimise"
        return reason

    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        """Newton on a linear problem: one iteration, and more where rounding requires it."""
        start = ContactSolution.at_rest(len(step.r), len(step.gap))
        solution = self._made(tolerance=tolerance).solve(step.problem(), start)
        events = [str(row["event"]) for row in solution.history if row.get("event")]
        reason = "; ".join([solution.outcome.word, *events])
        return Answer(
            solution.u,
            solution.pressure,
            solution.outcome.converged,
            solution.counters.get("newton_iterations", 0),
            reason=reason,
        )

    def _made(self, **more: object) -> ContactAlgorithm:
        return ALGORITHMS[self.algorithm](**{"epsilon": float("inf"), **self.settings, **more})


def _ours(name: str, algorithm: str, **settings: object) -> Ours:
    module = {"nnls": "scipy.optimize"}.get(str(settings.get("method")), "osqp" if algorithm == "qp" else "")
    return Ours(name, module, algorithm=algorithm, settings=settings)


OURS: tuple[Solver, ...] = (
    _ours("semismooth", "semismooth"),
    _ours("trial-and-error", "trial-and-error"),
    _ours("augmented Lagrangian", "augmented-lagrangian"),
    _ours("Lemke", "lcp", method="lemke"),
    _ours("Lemke, full", "lcp", method="lemke", system="full"),
    _ours("active set", "lcp", method="active-set"),
    _ours("nnls", "lcp", method="nnls"),
    _ours("condensed QP, finished", "qp"),
    _ours("full QP, finished", "qp", system="full"),
)
SOLVERS: dict[str, Solver] = {solver.name: solver for solver in (*OURS, *OUTSIDE, *CONDENSED)}


# --- the settings of OSQP ---------------------------------------------------------------------------------------------

NEAR = 0.99  # of the loads and gaps: the step whose answer is the initial point of a warm start
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
        """Compute the initial point."""
        super().prepare(step)
        _near(step)

    def _solved(self, step: FrozenStep, whole: Scaled | None, tolerance: float) -> QPAnswer:
        du, forces = _near(step)
        if whole is not None:
            du, forces = du / (whole.size * whole.stretch), whole.multipliers(forces)
        return osqp(programme(step, whole), tolerance, (du, forces))


@dataclass(frozen=True)
class ReducedOsqp(Outside):
    """Conjugate gradients on the reduced system, (P + sigma I + rho A^T A) x = b, where the wheel has them."""

    def missing(self) -> str | None:
        """Whether osqp is installed, and has an algebra for that system."""
        return super().missing() or (None if _algebra() else "osqp has only its builtin algebra, which factorises")

    def _solved(self, step: FrozenStep, whole: Scaled | None, tolerance: float) -> QPAnswer:
        return osqp(programme(step, whole), tolerance, algebra=_algebra())


def _algebra() -> str:
    """The first of those that solve the reduced system, or nothing."""
    available = importlib.import_module("osqp").algebras_available()
    return next((name for name in ("mkl", "cuda") if name in available), "")


@lru_cache(maxsize=2)
def _near(step: FrozenStep) -> tuple[np.ndarray, np.ndarray]:
    """The exact du (n,) and nodal forces (m,) of a step whose loads and gaps are nearly those."""
    answer = OURS[0].answer(replace(step, r=NEAR * step.r, gap=NEAR * step.gap), 1e-9)
    return answer.du / NEAR**2, step.weights * answer.pressure


def _variants(scaled: bool) -> Iterator[Solver]:
    suffix = ", scaled" if scaled else ""
    for name, settings in SETTINGS.items():
        yield Outside(f"OSQP{suffix}: {name}", "osqp", call=partial(osqp, **settings), scaled=scaled)
    yield WarmOsqp(f"OSQP{suffix}: warm start", "osqp", scaled=scaled)
    yield ReducedOsqp(f"OSQP{suffix}: reduced KKT", "osqp", scaled=scaled)
    if scaled:
        yield Condensed("OSQP, scaled: condensed", "osqp")


ABLATION: tuple[Solver, ...] = (*_variants(scaled=False), *_variants(scaled=True))

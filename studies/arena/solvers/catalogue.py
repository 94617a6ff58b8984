"""All solvers of the arena by name, one that is not installed, too: the algorithms of the house and public ones.

Ours solve a frozen step from rest and without a set to begin with, as all others.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from contact.catalogue import ALGORITHMS
from contact.interchange.linearised_step import FrozenStep
from contact.problem import ContactAlgorithm, ContactSolution
from contact.solvers.sparse import asymmetry, symmetric
from studies.arena.solvers.base import Answer, Solver
from studies.arena.solvers.outside import CONDENSED, OUTSIDE


@dataclass(frozen=True)
class Ours(Solver):
    """An algorithm of the catalogue with its own settings, enforcing the constraint exactly.

    The tolerance is that of its equilibrium; gaps it closes to rounding whatever is asked.
    """

    algorithm: str = ""
    settings: Mapping[str, object] = field(default_factory=dict)

    def applies(self, step: FrozenStep) -> str | None:
        """What the algorithm says, and symmetry where it needs a function to minimise."""
        reason = self._made().supports(step.problem())
        minimises = self.algorithm == "qp" or self.settings.get("method") == "nnls"
        if reason is None and minimises and not symmetric(step.K):
            return f"K is not symmetric (to {asymmetry(step.K):.1e}): there is no function to minimise"
        return reason

    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        """Newton on a linear problem: one iteration, and what rounding asks for."""
        start = ContactSolution.at_rest(len(step.r), len(step.gap))
        found = self._made(tolerance=tolerance).solve(step.problem(), start)
        events = [str(row["event"]) for row in found.history if row.get("event")]
        reason = "; ".join([found.outcome.word, *events])
        return Answer(
            found.u, found.pressure, found.outcome.converged, found.counters.get("newton_iterations", 0), reason=reason
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

"""Semismooth Newton: a primal-dual active set that settles before the next linearisation.

With friction the states are those that Alart and Curnier's function asks for; who slips on keeps the direction of the
linearisation. States that come back are a cycle: that linearisation is left as it is, and where Newton has been before
the states are changed one at a time there. Where that comes back, too, they are those of the complementarity problem on
a polygon, see :mod:`contact.newton.friction_compliance`, as far as it applies, and the history says so. No rule ends
for every problem: else, or where there is no answer, the outcome is CYCLING, or what Newton's iteration ends with.
mu = 0 gives the iterates of contact alone but for its answer to cycles.
Source: Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353-375.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, ClassVar

from contact.algorithms.base import NewtonAlgorithm
from contact.newton.loop import iterate, settle_most
from contact.parameters import SHARED, Parameter
from contact.problem import ContactProblem, ContactSolution, Outcome

if TYPE_CHECKING:
    from contact.newton.friction_run import FrictionalRun


@dataclass(frozen=True)
class Semismooth(NewtonAlgorithm):
    """A node is in contact when p - c g > 0; one linear step on that set; repeat.

    epsilon [MPa/mm]: infinity enforces the constraint exactly.
    c [-], relative to the stiffness of the candidates per area, weighs pressure against gap. It matters only in the
    first iteration of a step, while both are non-zero: after a full step one of them vanishes at every node.
    settle: the set is updated on the same linearisation until at most this fraction of it changes. At 1 every set has
    its own linearisation, the textbook method: far from the solution it follows meaningless sets and fails on fine
    meshes (tyre 84x80, 20 mm in one step). At 0 each linearised problem is solved completely.
    Swapping all violators can cycle, even on a symmetric positive definite matrix of three unknowns (Curtis, Han,
    Robinson, Comput. Optim. Appl. 60 (2015) 311-341). When a set recurs, the linearised problem is solved by principal
    pivots, which are finite for every P-matrix, and the history records this.
    The rim of contact of a beam or plate carries a line force; like the rim of a membrane, it releases one row of
    elements at a time. A tolerated fraction of the set would allow one row per iteration, and the number of iterations
    would be that of the elements. After two such steps the set is therefore settled completely on one linearisation,
    and the number of iterations does not grow with the mesh (strip, plate and ring of 64 to 1024 elements: within a
    factor of two). It does grow at settle = 1, on an indefinite tangent, which is never settled completely, and in
    trial-and-error and regularised; not in lcp and qp.
    max_iterations: iterations that only release nodes do not count; there are at most as many of them as candidates.
    Source: Hintermüller, Ito, Kunisch, SIAM J. Optim. 13 (2002) 865-888.
    """

    c: float = 1.0
    settle: float = 0.05
    name: ClassVar[str] = "semismooth"
    friction: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (
        *SHARED,
        Parameter("settle", "fraction of the set that may change before the next linearisation", low=0, high=1),
        Parameter(
            "c", "weight of gap against pressure, over stiffness per area", low=0, open_low=True, frictionless=True
        ),
    )

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Iterate from ``start`` until the set, or the states, repeat and the forces balance."""
        if problem.coulomb is not None:
            return self._with_friction(self.rubbing(problem, start))
        step = partial(settle_most, settle=self.settle, c=self.c, most=self.max_updates)
        return iterate(self.run(problem), start, step, self.max_iterations, self.c)

    def _with_friction(self, run: FrictionalRun) -> ContactSolution:
        from contact.newton.friction_compliance import SIDES, by_pivots, no_polygon  # as the run itself
        from contact.newton.friction_loop import approach, finished

        at, outcome = approach(run, run.start(), self.settle, self.max_iterations)
        if outcome is Outcome.CYCLING and no_polygon(SIDES, run.law.mu, "") is None:
            at, outcome = finished(run, at, by_pivots, [], self.max_iterations)
        return run.finish(at, outcome)

"""What the judge of friction says of a state, as it stands in the record of a load. Nothing is solved here."""

from __future__ import annotations

from typing import Any

import numpy as np

from contact.continuation.stability import Stability
from contact.friction.posed import anchors_left, posed
from contact.friction.verify import judge
from contact.problem import ContactProblem, ContactSolution
from contact.verify import claim, gap_residuals

NO_POTENTIAL = "friction has no potential whose second variation would be looked at"
UNTOLD = "friction"  # the failure of an answer that says nothing of its friction although candidates are pressed


def certificate_of_friction(
    problem: ContactProblem,
    state: ContactSolution,
    epsilon: float,
    tolerance: float,
    before: tuple[ContactProblem, ContactSolution],
) -> dict[str, Any]:
    """As :func:`studies.certificate.certificate`, by :mod:`contact.friction.verify`.

    before: problem and state at the last accepted load; where the slip is counted from is worked out anew from it, and
    so is not what the answer says.
    """
    since = anchors_left(problem, *before, epsilon)
    told, m = state.friction, len(problem.weights)
    friction = np.zeros((m, 2)) if told is None else told.force
    forces = problem.nodal_forces(state.pressure)
    verdict = judge(posed(problem, since), state.u, forces, friction, epsilon=epsilon, since=before[1].u)
    found = verdict.certificate
    found["kkt"] |= gap_residuals(problem, state.u, forces, np.inf)
    found["exceeded"] = verdict.exceeded(**claim(tolerance, len(state.u)))
    found["failures"] = list(found["exceeded"])
    if told is None and forces.any():
        found["failures"].append(UNTOLD)
    values = {**verdict.kkt, **verdict.balances}
    found["diagnosis"] = [f"{name}: {values[name]:.2e}" for name in found["failures"] if name in values]
    found["stability"] = Stability(None, why=NO_POTENTIAL).record
    return found

"""Last steps of shells in contact, linearised where they set out from: problems to compare algorithms on, too."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.interchange.linearised_step import FrozenStep, freeze
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.solvers.sparse import symmetric
from studies.complete import complete
from studies.walk import walk

PAPER = {"element": "paper", "delta_mm": "15,20"}  # the tyre's element whose tangent is definite without the foundation


@dataclass(frozen=True, eq=False)
class Linearised:
    """K du - f = G^T W p with g + G du >= 0, in the unknowns du (n,) of one Newton step; no published answer.

    before: the converged state that the step sets out from.
    """

    name: str
    step: FrozenStep
    before: ContactSolution
    answer: np.ndarray | None = None

    @property
    def K(self) -> sparse.csc_matrix:
        """The tangent (n, n), curvature of the gap included."""
        return self.step.K

    @property
    def f(self) -> np.ndarray:
        """What is out of balance without the foundation (n,)."""
        return -self.step.r

    @property
    def start(self) -> np.ndarray:
        """No displacement (n,)."""
        return np.zeros_like(self.step.r)

    @property
    def symmetric(self) -> bool:
        """Whether there is an energy to minimise."""
        return symmetric(self.K)

    def problem(self) -> ContactProblem:
        """The contact problem in du."""
        return self.step.problem()

    def begin(self) -> ContactSolution:
        """The pressures and the set of the state before."""
        return ContactSolution(self.start, self.before.pressure, self.before.active, Outcome.CONVERGED)


def last_step(scene_name: str, mesh: str, **settings: str) -> Linearised:
    """The step to the last target of the last stage of a scene, linearised at the state before."""
    scene, request = complete(scene_name, settings, mesh)
    *_, last = walk(scene.build(request).stages(), ALGORITHMS[request.contact](epsilon=math.inf))
    before = last.before
    name = ", ".join([f"{scene_name} {mesh}", *(f"{key} {value}" for key, value in settings.items())])
    return Linearised(name, freeze(last.problem, before.u, before.pressure, {}), before)


def linearised_steps() -> list[Linearised]:
    """The tyre pressed to 20 mm, from 15 mm, at once, and with the section without symmetry; strips and a plate."""
    tyres = [PAPER, {**PAPER, "delta_mm": "20"}, {**PAPER, "section": "nonsymmetric"}]
    thin = ("strip-contact", "plate-contact", "heavy-strip")
    return [
        *(last_step("tyre", "12x12", **settings) for settings in tyres),
        *(last_step(name, "16x1") for name in thin),
    ]

"""A contact problem with friction as the frictional problem that it is, and algorithms of friction on it.

What load stepping, judge and scenes see is a contact problem and its answer as ever: the friction is in
``problem.coulomb`` and in ``solution.friction``, which goes in with the anchors of the last accepted state and comes
out with those of the new one. Nothing is kept between calls. No stiffness and no scene may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from contact.coulomb import Friction
from contact.friction.algorithms.base import FrictionalAlgorithm
from contact.friction.foundation import Slip
from contact.friction.problem import FrictionalProblem, FrictionalSolution, State
from contact.parameters import Parameter
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution


def slip_of(problem: ContactProblem, anchors: np.ndarray) -> Slip:
    """The slip of the candidates since their anchors (m, 3); raises ValueError where the problem has no friction."""
    if problem.surface is None or problem.coulomb is None:
        raise ValueError("the contact problem has no friction")
    return Slip(problem.surface, problem.surface, problem.coulomb.motion, anchors)


def posed(problem: ContactProblem, anchors: np.ndarray) -> FrictionalProblem:
    """The frictional problem with slips since these anchors (m, 3); raises ValueError where there is none."""
    slip = slip_of(problem, anchors)
    assert problem.surface is not None
    assert problem.coulomb is not None
    mu = np.full(len(problem.weights), problem.coulomb.mu)
    return FrictionalProblem(problem, mu, slip, slip.jacobian, problem.surface.size)


@dataclass(frozen=True)
class WithFriction:
    """An algorithm of friction as load stepping takes it: given and giving contact solutions.

    plain: the algorithm of the catalogue for which it stands; it solves what has no friction.
    """

    plain: ContactAlgorithm
    rubbing: FrictionalAlgorithm
    name: ClassVar[str] = "with-friction"
    parameters: ClassVar[tuple[Parameter, ...]] = ()

    @property
    def epsilon(self) -> float:
        """Of both laws [MPa/mm]: p = epsilon <-g>, and a spring epsilon w [N/mm] along the foundation."""
        return self.plain.epsilon

    def supports(self, problem: ContactProblem) -> str | None:
        """None, or the reason why the algorithm does not apply."""
        if problem.coulomb is None:
            return self.plain.supports(problem)
        try:
            return self.rubbing.supports(posed(problem, np.zeros((len(problem.weights), 3))))
        except ValueError as error:
            return str(error)

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """From ``start``; candidates without anchors have them where they are."""
        if problem.coulomb is None:
            return self.plain.solve(problem, start)
        since = _places(problem, start.u) if start.friction is None else start.friction.anchors
        asked = posed(problem, since)
        found = self.rubbing.solve(asked, _start(problem, start))
        told = found.without_friction(problem.weights)
        return replace(told, friction=self._remembered(problem, asked, found, start))

    def _remembered(
        self, problem: ContactProblem, asked: FrictionalProblem, found: FrictionalSolution, start: ContactSolution
    ) -> Friction:
        """Friction with the anchors that it leaves: where a spring is still stretched, its end on the foundation."""
        slip = asked.slip
        assert isinstance(slip, Slip)
        stretched = _stretched(problem, found.friction, self.epsilon)
        anchors = _anchors(slip, found.u, stretched)
        before = 0.0 if start.friction is None else start.friction.dissipation
        lost = -float(np.sum(found.friction * (slip(found.u) - stretched)))
        return Friction(found.friction, found.state, slip.anchors, anchors, before + lost)


def anchors_left(
    problem: ContactProblem, before: ContactProblem, state: ContactSolution, epsilon: float = np.inf
) -> np.ndarray:
    """Anchors (m, 3) from which ``problem`` counts its slip, worked out anew from the ``state`` accepted before it.

    Where the candidates were on the foundation; with a finite epsilon, where the ends of their springs were.
    """
    if state.friction is None:
        return _places(problem, state.u)
    return _anchors(slip_of(before, state.friction.since), state.u, _stretched(before, state.friction.force, epsilon))


def _places(problem: ContactProblem, u: np.ndarray) -> np.ndarray:
    assert problem.coulomb is not None
    assert problem.surface is not None
    return problem.coulomb.places(problem.surface, u)


def _anchors(slip: Slip, u: np.ndarray, stretched: np.ndarray) -> np.ndarray:
    return np.asarray(slip.places(u) - np.einsum("mk,mki->mi", stretched, slip.directions))


def _stretched(problem: ContactProblem, friction: np.ndarray, epsilon: float) -> np.ndarray:
    """-t/(epsilon w) (m, 2) [mm]: what a spring gives way before it slips; 0 with an infinite epsilon."""
    if np.isinf(epsilon):
        return np.zeros_like(friction)
    return np.asarray(-friction / (epsilon * problem.weights[:, None]))


def _start(problem: ContactProblem, start: ContactSolution) -> FrictionalSolution:
    """As the start of a frictional problem; who is in contact and has never rubbed sticks."""
    m = len(problem.weights)
    friction, state = np.zeros((m, 2)), np.where(start.active, State.STICK, State.OPEN).astype(np.int8)
    if start.friction is not None:
        friction, state = start.friction.force, start.friction.state
    return FrictionalSolution(start.u, problem.nodal_forces(start.pressure), friction, state, start.outcome)

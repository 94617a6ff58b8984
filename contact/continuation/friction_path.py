"""Load steps with friction that are never cut: anchors of slips go in and come out. No scene may enter here."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome


@dataclass(frozen=True, eq=False)
class Stage:
    """A load step: the problem with slips from the anchors of the last one, and the anchors that it leaves.

    anchored(u): places of the candidates on the foundation once u (n,) is accepted, as the next stage wants them.
    """

    problem: ContactProblem
    anchored: Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class PathState:
    """An accepted state: solution, anchors, dissipation -t.s [N mm] of its step, and the load it stands at."""

    load: float
    solution: ContactSolution
    anchors: np.ndarray
    dissipation: float = 0.0


def follow(
    stage_at: Callable[[float, np.ndarray], Stage],
    loads: Iterable[float],
    algorithm: ContactAlgorithm,
    start: PathState,
) -> Iterator[PathState]:
    """One step to each load in turn, from ``start``; ends with the first that is not converged.

    stage_at(load, anchors): the stage. A state that is not converged is yielded with the anchors that it began with,
    and no dissipation: it is none of the path. The first step is an answer by itself, the later ones depend on it.
    """
    at = start
    for load in loads:
        stage = stage_at(load, at.anchors)
        solution = algorithm.solve(stage.problem, at.solution)
        if solution.outcome is not Outcome.CONVERGED:
            yield PathState(load, solution, at.anchors)
            return
        at = PathState(load, solution, stage.anchored(solution.u), dissipation(stage.problem, solution))
        yield at


def dissipation(problem: ContactProblem, solution: ContactSolution) -> float:
    """-sum t.s [N mm] of a step, never negative but for rounding: mu f |s| where a candidate slips, else 0."""
    assert problem.coulomb is not None
    return float(-np.sum(solution.rubbed.force * problem.coulomb.slip(solution.u)))

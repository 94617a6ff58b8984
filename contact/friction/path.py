"""Load steps of a frictional problem: anchors of slips go in and come out. No scene, no algorithm may enter here."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from contact.friction.algorithms.base import FrictionalAlgorithm
from contact.friction.problem import FrictionalProblem, FrictionalSolution
from contact.problem import Outcome


@dataclass(frozen=True, eq=False)
class Stage:
    """A load step: the problem with slips from the anchors of the last one, and the anchors that it leaves.

    anchored(u): places of the candidates on the foundation once u (n,) is accepted, as the next stage wants them.
    """

    problem: FrictionalProblem
    anchored: Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class PathState:
    """An accepted state: solution, anchors, dissipation -t.s [N mm] of its step, and the load it stands at."""

    load: float
    solution: FrictionalSolution
    anchors: np.ndarray
    dissipation: float = 0.0


def follow(
    stage_at: Callable[[float, np.ndarray], Stage],
    loads: Iterable[float],
    algorithm: FrictionalAlgorithm,
    start: PathState,
) -> Iterator[PathState]:
    """One step to each load in turn, from ``start``; ends with the first that is not converged.

    stage_at(load, anchors): the stage. A state that is not converged is yielded with the anchors that it began with,
    and no dissipation: it is none of the path. The first step is an answer by itself, the later ones depend on it.
    """
    at = start
    for load in loads:
        stage = stage_at(load, at.anchors)
        found = algorithm.solve(stage.problem, at.solution)
        if found.outcome is not Outcome.CONVERGED:
            yield PathState(load, found, at.anchors)
            return
        at = PathState(load, found, stage.anchored(found.u), dissipation(stage.problem, found))
        yield at


def dissipation(problem: FrictionalProblem, solution: FrictionalSolution) -> float:
    """-sum t.s [N mm] of a step, never negative but for rounding: mu f |s| where a candidate slips, else 0."""
    return float(-np.sum(solution.friction * problem.slip(solution.u)))

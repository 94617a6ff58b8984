"""Where the path of a member of a sweep sets out from: the paths of solved members beside it, on the same grid.

What a step of a stage has moved there it moves here, nearly. Nothing is solved here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from contact.continuation.candidates import Start, Starts, State
from contact.problem import ContactSolution
from studies.ask.request import Request
from studies.ask.scene import SceneModel, Stage
from studies.ask.settings import rubbing
from studies.scenes.walk import Visited
from studies.solving.solve import StartsOf
from studies.sweeps.members import Place


@dataclass(frozen=True, eq=False)
class Followed:
    """The path of a solved member: by stage and requested point, the states on the way there by their parameters.

    weights (m,) [mm^2]: of its candidates, where they rub.
    """

    place: Place
    request: Request
    ways: Mapping[tuple[str, int], Mapping[float, ContactSolution]]
    weights: np.ndarray | None = None

    @classmethod
    def of(cls, place: Place, request: Request, visits: Sequence[Visited]) -> Followed:
        """Without the problems, which hold on to the model."""
        names = [visited.stage.name for visited in visits]
        ways = {(name, names[:k].count(name)): dict(visits[k].point.way) for k, name in enumerate(names)}
        rubs = visits[-1].point.solution.friction is not None
        return cls(place, request, ways, visits[-1].problem.weights if rubs else None)

    def since(self, behind: Followed | None) -> tuple[bool, float]:
        """Whether it is without one behind, and how far the last state is from that of the one behind."""
        if behind is None:
            return True, 0.0
        here, there = self.end, behind.end
        return False, float(np.linalg.norm(here - there)) if len(here) == len(there) else math.inf

    @property
    def end(self) -> np.ndarray:
        """The displacements (n,) of the last state."""
        *_, states = self.ways.values()
        *_, last = states.values()
        return last.u

    def step(self, point: tuple[str, int], last: State, parameter: float) -> tuple[ContactSolution, np.ndarray] | None:
        """The state at a parameter, and what it has moved by since the last one; None where it has not stood at both.

        last: of the member that sets out, whose unknowns must be as many.
        """
        states = self.ways.get(point, {})
        if last[0] not in states or parameter not in states or len(states[parameter].u) != len(last[1].u):
            return None
        return states[parameter], states[parameter].u - states[last[0]].u


def predicted(neighbours: Sequence[Followed], request: Request) -> StartsOf:
    """Where the steps of a member set out from, by the nearest of its neighbours and the one behind that, if any.

    Of a step that has moved these two by d and d_behind, from the last state u of the member itself::

        u + d + (d - d_behind)

    with pressures that go on alike, on the contact set of the nearest.  request: of the member.
    """

    def start(stage: str, index: int, last: State, parameter: float) -> Start | None:
        nearest, *behind = (each.step((stage, index), last, parameter) for each in neighbours)
        if nearest is None:
            return None
        near, move = nearest
        pressure = near.pressure
        for state, moved in filter(None, behind):
            if len(state.pressure) == len(pressure):
                move, pressure = 2 * move - moved, 2 * pressure - state.pressure
        at = Start(last[1].u + move, np.where(near.active, np.maximum(pressure, 0.0), 0.0), near.active)
        weights = neighbours[0].weights
        if near.friction is None or weights is None:
            return at
        traction = near.friction.force / np.where(weights > 0, weights, 1.0)[:, None]
        return replace(at, traction=traction, state=near.friction.state)

    def of(model: SceneModel) -> Callable[[Stage], Starts]:
        return lambda stage: partial(start, stage.name)

    return of


@dataclass(frozen=True, eq=False)
class Neighbours:
    """The paths that were followed last on a grid, ``most`` of them."""

    most: int
    known: dict[Place, Followed] = field(default_factory=dict)

    def add(self, path: Followed) -> None:
        """One more; the oldest goes."""
        self.known[path.place] = path
        if len(self.known) > self.most:
            del self.known[next(iter(self.known))]

    def of(self, place: Place, request: Request) -> list[Followed]:
        """The nearest, of several one with another behind it, of these that which has changed least since, or the
        latest; then that other one; none where none is known.

        What is behind is as far from the nearest as that is from here. Members of another model are no neighbours, nor
        is one with friction of one without or conversely: without friction there is no state of it to start from.
        """
        alike = {other: path for other, path in self.known.items() if _kind(path.request) == _kind(request)}
        ranked = []
        for age, (other, path) in enumerate(alike.items()):
            behind = alike.get(tuple(2 * b - a for a, b in zip(place, other, strict=True)))
            ranked.append((math.dist(place, other), *path.since(behind), -age, path, behind))
        nearest = min(ranked, key=lambda each: each[:4], default=())
        return [path for path in nearest[4:] if path is not None]


def _kind(request: Request) -> tuple[str, bool]:
    return request.model, rubbing(request.settings)

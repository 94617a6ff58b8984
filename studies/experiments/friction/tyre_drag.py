"""The tyre that is pressed against a plane and dragged, as load steps of a frictional problem."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contact.algorithms.semismooth import Semismooth as Frictionless
from contact.coulomb import Coulomb, Motion
from contact.friction.path import PathState, Stage
from contact.friction.slip import Slip
from contact.obstacles.foundation import Candidates, Foundation
from contact.problem import ContactProblem, ContactSolution
from studies.scenes.complete import complete
from studies.scenes.tyre.foundation import NORMAL
from studies.scenes.tyre.model import TyreModel
from studies.scenes.walk import walk

DELTA, MU = 10.0, 0.5  # mm, -
REACH = 3.0  # times the travel: gaps of the inflated tyre beyond which nobody touches


@dataclass(frozen=True, eq=False)
class TyreDrag:
    """The inflated tyre above a plane that has pressed it by its travel; ``way`` (3,): along which it is dragged."""

    pressed: ContactProblem
    candidates: Candidates
    plane: Foundation
    way: np.ndarray
    mu: float
    begun: np.ndarray

    def stage_at(self, drag: float, anchors: np.ndarray) -> Stage:
        """The plane dragged by so many mm."""
        slip = Slip(self.candidates, self.plane, Motion(drag * self.way, np.zeros(3), np.zeros(3)), anchors)
        size = self.plane.size + float(np.max(np.abs(self.candidates.reference)))
        mu = np.full(len(self.pressed.weights), self.mu)
        return Stage(replace(self.pressed, coulomb=Coulomb(mu, slip, slip.jacobian, size)), slip.places)

    @property
    def rest(self) -> PathState:
        """Inflated, and not touching yet."""
        rest = ContactSolution.at_rest(len(self.begun), len(self.pressed.weights))
        return PathState(0.0, replace(rest, u=self.begun), self.candidates.positions(self.begun))


def tyre_drag(mesh: str) -> TyreDrag:
    """Pressed by DELTA; the candidates are those that the press can reach; dragged at half a right angle."""
    scene, request = complete("tyre", {"delta_mm": DELTA}, mesh, model="full")
    model = scene.build(request)
    assert isinstance(model, TyreModel)
    stages = list(model.stages())
    *_, last = walk(stages[:-1], Frictionless())
    problem_at, begun = stages[-1].begin(last.state)
    chosen = problem_at(0.0).gap(last.state.u) <= REACH * DELTA
    only = problem_at(DELTA).only
    assert only is not None
    plane = model.foundation.moved((float(np.max(model.candidates.positions(last.state.u) @ NORMAL)) - DELTA) * NORMAL)
    points = (3 * np.flatnonzero(chosen)[:, None] + np.arange(3)).ravel()
    held = model.candidates
    candidates = Candidates(held.reference[chosen], held.operator[points], held.weights[chosen])
    way = np.cross(NORMAL, [0.0, 0.0, 1.0]) + np.array([0.0, 0.0, 0.5])
    return TyreDrag(only(chosen), candidates, plane, way / np.linalg.norm(way), MU, begun.u)

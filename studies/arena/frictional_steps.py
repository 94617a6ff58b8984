"""Steps with friction that are made here: random ones with candidates of every state, and a dragged tyre."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.continuation.friction_path import PathState, Stage
from contact.coulomb import Coulomb, Motion, State
from contact.interchange.linearised_step import FrozenFrictionalStep
from contact.obstacles.foundation import Candidates, Foundation
from contact.problem import ContactProblem, ContactSolution
from contact.slip import Slip
from studies.scenes.complete import complete
from studies.scenes.foundations import NORMAL
from studies.scenes.tyre.model import TyreModel
from studies.scenes.walk import walk


def random_step(seed: int) -> FrozenFrictionalStep:
    """4 to 9 candidates with three unknowns each, in skew axes, and up to five unknowns more.

    K is symmetric positive definite with eigenvalues from 1 up to 1 to 1000 in random directions, mu from 0 to 1, every
    ninth 0. The load follows from an answer that is drawn first and has every state; at these mu it need not be
    unique.
    """
    rng = np.random.default_rng([seed, 2026])
    m = int(rng.integers(4, 10))
    n = 3 * m + int(rng.integers(0, 6))
    directions = np.linalg.qr(rng.standard_normal((n, n)))[0]
    K = (directions * 10 ** rng.uniform(0, rng.uniform(0, 3), n)) @ directions.T
    G, S = np.zeros((m, n)), np.zeros((2 * m, n))
    for i in range(m):
        axes = np.linalg.qr(rng.standard_normal((3, 3)))[0]
        G[i, 3 * i : 3 * i + 3], S[2 * i : 2 * i + 2, 3 * i : 3 * i + 3] = axes[0], axes[1:]
    state = rng.permutation(np.append([State.OPEN, State.STICK, State.SLIP], rng.integers(0, 3, m - 3)))
    mu = np.where(rng.uniform(size=m) < 1 / 9, 0.0, rng.uniform(0, 1, m))
    closed, slips = state != State.OPEN, state == State.SLIP
    normal = np.where(closed, 10 ** rng.uniform(-1, 1, m), 0.0)
    angle = rng.uniform(0, 2 * np.pi, m)
    way = np.column_stack([np.cos(angle), np.sin(angle)])
    moved = np.where(slips, 10 ** rng.uniform(-2, 0, m), 0.0)[:, None] * way
    moved = np.where(closed[:, None], moved, rng.standard_normal((m, 2)))
    friction = -(mu * normal * np.where(slips, 1.0, rng.uniform(0, 0.95, m)))[:, None] * way
    u = rng.standard_normal(n)
    r = G.T @ normal + S.T @ friction.ravel() - K @ u
    gap = np.where(closed, 0.0, 10 ** rng.uniform(-2, 0, m)) - G @ u
    return dense_step(K, r, G, gap, S, moved - (S @ u).reshape(m, 2), mu)


def dense_step(
    K: np.ndarray, r: np.ndarray, G: np.ndarray, gap: np.ndarray, S: np.ndarray, slip: np.ndarray, mu: np.ndarray
) -> FrozenFrictionalStep:
    """Of dense matrices, with areas one."""
    scale = float(np.linalg.norm(r))
    contact = sparse.csc_matrix(K), r, sparse.csr_matrix(G), gap, np.ones(len(gap)), scale
    return FrozenFrictionalStep(*contact, S=sparse.csr_matrix(S), slip=slip, mu=mu)


DELTA, MU = 10.0, 0.5  # mm, -
REACH = 3.0  # times the travel: gaps of the inflated tyre beyond which no candidate touches


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
        """Inflated, before contact."""
        rest = ContactSolution.at_rest(len(self.begun), len(self.pressed.weights))
        return PathState(0.0, replace(rest, u=self.begun), self.candidates.positions(self.begun))


def tyre_drag(mesh: str) -> TyreDrag:
    """Pressed by DELTA; the candidates are those that the press can reach; dragged at an angle."""
    scene, request = complete("tyre", {"delta_mm": DELTA}, mesh, model="full")
    model = scene.build(request)
    assert isinstance(model, TyreModel)
    stages = list(model.stages())
    *_, last = walk(stages[:-1], Semismooth())
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

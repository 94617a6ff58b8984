"""A wheel of bars between two plates: sheared by the upper one, it rolls.

A rim of n nodes, spokes and a hub, squeezed and held by friction alone. The upper plate moves by s; the wheel is its
own image about its hub, turned by half a turn with both plates, so that the hub comes by s/2 whatever the wheel is like
and stays in the middle. It turns by s/2 over the radius with which it rolls: n lengths of the bars of the rim as they
lie on a plate, over 2 pi.

A node that lands within a step is held to where it was over the plate when the step began, though it was not on it: by
its own law it has come some way since, which is left in the bars, and vanishes with the steps. Every solve starts from
the wheel rolled on rigidly: from where it was, all nodes on the upper plate are s off it, and are let slide at first.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.coulomb import Coulomb, Motion, State
from contact.friction.path import PathState, Stage, follow
from contact.friction.slip import Slip
from contact.obstacles.foundation import Candidates, RigidPlane
from contact.problem import ContactProblem, ContactSolution
from studies.experiments.friction.truss import Truss
from studies.experiments.rows import Row, tabulated

RADIUS, RIM, SPOKE = 50.0, 1e4, 1e4  # mm, N, N
SQUEEZE, NODES = 3.0, 24  # mm; of the rim of the table
DOWN, UP = np.array([0.0, 0.0, -1.0]), np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Wheel:
    """n nodes of the rim (n, even), the hub the last one; between plates at z = -R and z = R - squeeze [mm]."""

    n: int
    mu: float
    squeeze: float

    @property
    def truss(self) -> Truss:
        """In the plane y = 0, where springs hold it."""
        angle = 2 * math.pi * np.arange(self.n) / self.n
        rim = RADIUS * np.column_stack([np.sin(angle), np.zeros(self.n), -np.cos(angle)])
        nodes = np.vstack([rim, np.zeros(3)])
        around = np.column_stack([np.arange(self.n), np.roll(np.arange(self.n), -1)])
        spokes = np.column_stack([np.arange(self.n), np.full(self.n, self.n)])
        held = np.zeros_like(nodes)
        held[:, 1] = 1.0
        stiffness = np.repeat([RIM, SPOKE], self.n)
        return Truss(nodes, np.vstack([around, spokes]), stiffness, held)

    def stage_at(self, load: float, anchors: np.ndarray) -> Stage:
        """Squeezed by so much of ``squeeze`` up to load 0, from -1 on; then the upper plate moved by ``load`` [mm].

        Anchors (2n, 3): those of the rim on the lower plate, then on the upper one.
        """
        truss, n = self.truss, self.n
        size = truss.nodes.size
        candidates = Candidates(truss.nodes[:n], sparse.csr_matrix(sparse.eye_array(3 * n, size)), np.ones(n))
        lower, upper = RigidPlane(DOWN, RADIUS), RigidPlane(UP, RADIUS - self.squeeze * (1 + min(load, 0.0)))
        moved = Motion(np.array([max(load, 0.0), 0.0, 0.0]), np.zeros(3), np.zeros(3))
        slips = [
            Slip(candidates, plane, motion, own)
            for plane, motion, own in ((lower, Motion.none(), anchors[:n]), (upper, moved, anchors[n:]))
        ]
        nothing, start = np.zeros(size), np.zeros((n + 1, 3))
        along = sparse.csr_matrix(sparse.vstack([slip.jacobian(nothing) for slip in slips]))
        columns = 3 * np.arange(n) + 2
        signs = np.repeat([1.0, -1.0], n)
        across = sparse.csr_matrix((signs, np.tile(columns, 2), np.arange(2 * n + 1)), shape=(2 * n, size))
        law = Coulomb(
            np.full(2 * n, self.mu),
            lambda u: np.concatenate([slip(u) for slip in slips]),
            lambda u: along,
            RADIUS + abs(load),
        )
        problem = ContactProblem(
            lambda u, memory: truss.linearise(u, start, nothing),
            lambda u: np.concatenate([plane.gap(candidates.positions(u)) for plane in (lower, upper)]),
            lambda u: across,
            np.ones(2 * n),
            gap_size=RADIUS,
            coulomb=law,
        )
        return Stage(problem, lambda u: np.concatenate([slip.places(u) for slip in slips]))

    def follow(self, loads: Sequence[float]) -> list[PathState]:
        """The states at these loads in turn, each begun from the last one rolled on by its rigid motion."""
        m, size = 2 * self.n, 3 * (self.n + 1)
        stands = np.isin(np.arange(m), [0, self.n + self.n // 2])
        standing = replace(ContactSolution.at_rest(size, m), active=stands)
        at = PathState(-1.0, standing, np.tile(self.truss.nodes[:-1], (2, 1)))
        states = []
        for load in loads:
            rolled = self.rolled(at.solution.u, max(load, 0.0) - max(at.load, 0.0))
            (at,) = follow(self.stage_at, [load], Semismooth(), replace(at, solution=replace(at.solution, u=rolled)))
            states.append(at)
            if not at.solution.outcome.converged:
                break
        return states

    def rolled(self, u: np.ndarray, way: float) -> np.ndarray:
        """u (3n + 3,) after a rigid wheel has rolled, the upper plate having come by ``way`` [mm]."""
        nodes = self.truss.nodes
        x = nodes + u.reshape(-1, 3)
        turn = Motion(np.array([way / 2, 0.0, 0.0]), np.array([0.0, way / (2 * RADIUS), 0.0]), x[-1])
        return (turn.out(x) - nodes).ravel()


@tabulated
def rolling_path(wheel: Wheel, step: float, way: float) -> Iterator[Row]:
    """Squeezed in two steps, then state by state up to ``way`` [mm] by ``step`` [mm].

    hub_error_mm: of the hub from s/2; middle_error_mm: from the middle between the plates.  turn_rad: of the rim, in
    the mean.  bar_mm: mean length of the bars of the rim that lie on a plate, both ends sticking; else NaN.  press_N,
    drag_N: of the lower plate.  dissipation_N_mm: of the step.
    """
    truss, n = wheel.truss, wheel.n
    for state in wheel.follow([-0.5, 0.0, *(step * k for k in range(1, round(way / step) + 1))]):
        found, s = state.solution, max(state.load, 0.0)
        x = truss.nodes + found.u.reshape(-1, 3)
        friction = found.rubbed
        sticks = (friction.state == State.STICK).reshape(2, n)
        lies = (sticks & np.roll(sticks, -1, axis=1)).any(axis=0)
        bars = np.linalg.norm(np.roll(x[:n], -1, axis=0) - x[:n], axis=1)[lies]
        yield (
            {"way_mm": s, "outcome": found.outcome.word, "iterations": found.counters["newton_iterations"]}
            | {"hub_mm": float(x[-1, 0]), "hub_error_mm": float(x[-1, 0] - s / 2)}
            | {"middle_error_mm": float(x[-1, 2] + wheel.squeeze * (1 + min(state.load, 0.0)) / 2)}
            | {"turn_rad": _turn(truss.nodes, x), "bar_mm": float(np.mean(bars)) if len(bars) else math.nan}
            | {"press_N": float(found.pressure[:n].sum()), "drag_N": float(friction.force[:n, 0].sum())}
            | {"sticking": int(sticks.sum()), "slipping": int(np.sum(friction.state == State.SLIP))}
            | {"dissipation_N_mm": state.dissipation}
        )


@tabulated
def rolling_table(
    coefficients: Sequence[float] = (0.1, 0.5), steps: Sequence[float] = (1.0, 0.5, 0.25)
) -> Iterator[Row]:
    """A wheel rolled by a little more than two of its bars, a row each case: mu and step [mm].

    hub_error_mm, middle_error_mm: the largest.  slips: steps in which a node slips, once it rolls.  dissipated_N_mm: by
    these.  radius_mm: what the hub has come by while the wheel turned from one bar to the next, over that turn;
    bars_mm: n bars as they lie on a plate over 2 pi; radius_error: of the first from the second, relative.
    """
    for mu, step in product(coefficients, steps):
        n, pitch = NODES, 2 * RADIUS * math.sin(math.pi / NODES)
        path = rolling_path(Wheel(n, mu, SQUEEZE), step, 2 * 2.1 * pitch)
        turn, rolls = path["turn_rad"].to_numpy(float), path["way_mm"] > 0
        first, last = np.interp([2 * math.pi / n, 4 * math.pi / n], turn[1:], path["hub_mm"].to_numpy(float)[1:])
        radius, bars = (last - first) * n / (2 * math.pi), float(path["bar_mm"][rolls].mean()) * n / (2 * math.pi)
        yield (
            {"nodes": n, "mu": mu, "step_mm": step, "outcome": path["outcome"].iloc[-1]}
            | {"iterations": path["iterations"].sum(), "turn_rad": float(turn[-1])}
            | {name: float(path[name].abs().max()) for name in ("hub_error_mm", "middle_error_mm")}
            | {"slips": int((path["slipping"] > 0)[rolls].sum())}
            | {"dissipated_N_mm": float(path["dissipation_N_mm"][rolls].sum())}
            | {"radius_mm": radius, "bars_mm": bars, "radius_error": radius / bars - 1}
        )


def _turn(before: np.ndarray, now: np.ndarray) -> float:
    """Mean angle [rad] by which the rim has turned about the hub, forward positive."""
    was, at = ((x[:-1] - x[-1]) @ np.array([1.0, 0.0, 1.0j]) for x in (before, now))
    return float(np.mean(np.angle(was / at)))

"""Trusses on foundations, by any rotation: a pyramid carried along with its ground, and a wheel that rolls.

A pyramid of bars stands with its four feet on a plane; a soft spring holds its top. Its loads and the spring turn with
it. Moved and turned together, far: where only its feet are pressed straight down, no bar is strained, and friction is
none before and after; where its top is pushed aside, too, friction stays as it is seen from the foundation, and nothing
is dissipated. Beside it the foundation moves alone, by less than a hundredth of a millimetre.

A wheel is sheared by the upper one of two plates. A rim of n nodes, spokes and a hub, squeezed and held by friction
alone. The upper plate moves by s; the wheel is its own image about its hub, turned by half a turn with both plates, so
that the hub comes by s/2 whatever the wheel is like and stays in the middle. It turns by s/2 over the radius with which
it rolls: n lengths of the bars of the rim as they lie on a plate, over 2 pi. A node that lands within a step is held to
where it was over the plate when the step began, though it was not on it: by its own law it has come some way since,
which is left in the bars, and vanishes with the steps. Every solve starts from the wheel rolled on rigidly: from where
it was, all nodes on the upper plate are s off it, and are let slide at first.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.continuation.friction_path import PathState, Stage, dissipation, follow
from contact.coulomb import Coulomb, Motion, State
from contact.obstacles.foundation import Candidates, RigidPlane
from contact.problem import ContactProblem, ContactSolution, Linearisation
from contact.slip import Slip
from studies.experiments import Row, tabulated
from studies.experiments.friction.brush import GROUND


@dataclass(frozen=True, eq=False)
class Truss:
    """Nodes (n, 3) [mm] and bars (b, 2) of the stiffnesses (b,) [N]: each carries EA (l/L - 1), L its length at first.

    held (n, 3) [N/mm]: springs of the nodes along the axes.
    """

    nodes: np.ndarray
    bars: np.ndarray
    stiffness: np.ndarray
    held: np.ndarray

    @property
    def lengths(self) -> np.ndarray:
        """L (b,) [mm]."""
        return np.asarray(np.linalg.norm(self._along(self.nodes), axis=1))

    def forces(self, u: np.ndarray) -> np.ndarray:
        """Of the bars at u (3n,), tension positive (b,) [N]."""
        ways = self._along(self.nodes + u.reshape(-1, 3))
        return np.asarray(self.stiffness * (np.linalg.norm(ways, axis=1) / self.lengths - 1))

    def linearise(self, u: np.ndarray, load: np.ndarray, carried: np.ndarray) -> Linearisation:
        """r (3n,) and dr/du under dead loads (n, 3) [N]; carried (3n,) [mm]: displacements to which springs hold."""
        size, lengths = u.size, self.lengths
        ways = self._along(self.nodes + u.reshape(-1, 3))
        now = np.linalg.norm(ways, axis=1)
        e, tension = ways / now[:, None], self.forces(u)
        unknowns = (3 * self.bars[:, :, None] + np.arange(3)).reshape(-1, 6)
        both = np.concatenate([-e, e], axis=1) * tension[:, None]
        internal = np.bincount(unknowns.ravel(), both.ravel(), size) + self.held.ravel() * (u - carried)
        along = e[:, :, None] * e[:, None, :]
        material, turning = self.stiffness / lengths, tension / now
        block = material[:, None, None] * along + turning[:, None, None] * (np.eye(3) - along)
        each = np.block([[block, -block], [-block, block]])
        rows, columns = np.repeat(unknowns, 6, axis=1), np.tile(unknowns, 6)
        bars = sparse.coo_matrix((each.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))
        K = sparse.csc_matrix(bars + sparse.diags_array(self.held.ravel()))
        scale = max(float(np.linalg.norm(both)), float(np.linalg.norm(load)))
        return Linearisation(internal - load.ravel(), K, scale)

    def _along(self, x: np.ndarray) -> np.ndarray:
        """From the first to the second node of each bar (b, 3)."""
        return np.asarray(x[self.bars[:, 1]] - x[self.bars[:, 0]])


MU, EA, SOFT = 0.5, 1e4, 2.0  # -, N, N/mm
BENT = 0.05  # mm
FEET = np.array([[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [30.0, 20.0, 0.0], [0.0, 20.0, 0.0]])  # mm
TOP = np.array([[12.0, 9.0, 25.0]])
ON_FEET = np.array([[0.0, 0.0, -3.0], [0.0, 0.0, -4.0], [0.0, 0.0, -5.0], [0.0, 0.0, -6.0], [0.0, 0.0, 0.0]])  # N
ON_TOP = np.array([[0.0, 0.0, 0.0]] * 4 + [[4.0, -3.0, -20.0]])
LOADS = {"pressed": ON_FEET, "pushed": ON_FEET + ON_TOP}
MOTIONS = (
    Motion(np.array([300.0, -200.0, 150.0]), np.array([0.4, 0.0, 0.0]), np.zeros(3)),
    Motion(np.array([300.0, -200.0, 150.0]), np.array([0.7, 1.4, -0.6]), np.array([5.0, 60.0, -10.0])),
    Motion(np.array([-1e3, 0.0, 2e3]), np.array([0.0, 0.0, 3.0]), np.array([5.0, 60.0, -10.0])),
    Motion(np.zeros(3), np.array([-2.0, 1.0, 0.5]), np.array([400.0, 0.0, 0.0])),
    Motion.none(),
)
ALONE = Motion(np.array([2e-3, 1e-3, 0.0]), np.array([0.0, 0.0, 1e-4]), np.zeros(3))


def pyramid() -> Truss:
    """All bars between five nodes, the last held."""
    nodes = np.concatenate([FEET, TOP])
    bars, held = np.array(list(combinations(range(5), 2))), np.zeros_like(nodes)
    held[-1] = SOFT
    return Truss(nodes, bars, np.full(len(bars), EA), held)


def stage_at(truss: Truss, load: np.ndarray, body: Motion, ground: Motion, anchors: np.ndarray) -> Stage:
    """The truss under loads (n, 3) [N] and springs that turn with the body, on the plane, from anchors (4, 3)."""
    size, feet = truss.nodes.size, len(FEET)
    candidates = Candidates(FEET, sparse.csr_matrix(sparse.eye_array(3 * feet, size)), np.ones(feet))
    push = GROUND.gradient(FEET) @ ground.rotation.T
    starts = np.arange(0, 3 * feet + 1, 3)
    across = sparse.csr_matrix((push.ravel(), np.arange(3 * feet), starts), shape=(feet, size))
    turned, carried = load @ body.rotation.T, (body.out(truss.nodes) - truss.nodes).ravel()
    extent = float(np.max(np.abs(ground.translation)) + np.max(np.abs(ground.centre)) + np.max(truss.nodes))
    slip = Slip(candidates, GROUND, ground, anchors)
    problem = ContactProblem(
        lambda u, memory: truss.linearise(u, turned, carried),
        lambda u: GROUND.gap(ground.into(candidates.positions(u))),
        lambda u: across,
        np.ones(feet),
        gap_size=extent,
        coulomb=Coulomb(np.full(feet, MU), slip, slip.jacobian, extent),
    )
    return Stage(problem, slip.places)


@tabulated
def joint_motion_table() -> Iterator[Row]:
    """Each load, then all motions one after another, and the foundation moved alone from the last.

    A solve starts from the body carried along, its nodes put out of place by ``BENT``; or, where the foundation moves
    alone, left where it is.  turn_rad, way_mm: of the motion.  friction_N: sum of |t|; change_N: largest change of t
    since the load was there, in the frame of the foundation; normal_change_N, bar_change_N: those of normal forces and
    of bars; dissipation_N_mm.
    """
    truss = pyramid()
    rng = np.random.default_rng(0)
    for name in LOADS:
        standing = replace(ContactSolution.at_rest(truss.nodes.size, len(FEET)), active=np.ones(len(FEET), bool))
        was, at = Motion.none(), PathState(0.0, standing, FEET)
        together = [("together", motion, motion) for motion in MOTIONS]
        first = standing
        for index, (step, body, ground) in enumerate([("loaded", was, was), *together, ("alone", MOTIONS[-1], ALONE)]):
            start = at.solution
            if step == "together":
                x = body.out(was.into(truss.nodes + start.u.reshape(-1, 3)))
                start = replace(start, u=(x - truss.nodes).ravel() + rng.uniform(-BENT, BENT, truss.nodes.size))
            stage = stage_at(truss, LOADS[name], body, ground, at.anchors)
            solution = Semismooth().solve(stage.problem, start)
            at, was = PathState(0.0, solution, stage.anchored(solution.u), dissipation(stage.problem, solution)), body
            first = solution if step == "loaded" else first
            yield (
                {"load": name, "index": index, "step": step, "outcome": solution.outcome.word}
                | {"turn_rad": float(np.linalg.norm(ground.turn)), "way_mm": float(np.linalg.norm(ground.translation))}
                | {"iterations": solution.counters["newton_iterations"]}
                | {"friction_N": float(np.sum(np.linalg.norm(solution.rubbed.force, axis=1)))}
                | {"change_N": float(np.max(np.abs(solution.rubbed.force - first.rubbed.force)))}
                | {"normal_change_N": float(np.max(np.abs(solution.pressure - first.pressure)))}
                | {"bar_change_N": float(np.max(np.abs(truss.forces(solution.u) - truss.forces(first.u))))}
                | {"dissipation_N_mm": at.dissipation}
            )


RADIUS = 50.0  # mm
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
        return Truss(nodes, np.vstack([around, spokes]), np.full(2 * self.n, EA), held)

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
        columns, signs = np.tile(3 * np.arange(n) + 2, 2), np.repeat([1.0, -1.0], n)
        across = sparse.csr_matrix((signs, columns, np.arange(2 * n + 1)), shape=(2 * n, size))

        def slipped(u: np.ndarray) -> np.ndarray:
            return np.concatenate([slip(u) for slip in slips])

        problem = ContactProblem(
            lambda u, memory: truss.linearise(u, start, nothing),
            lambda u: np.concatenate([plane.gap(candidates.positions(u)) for plane in (lower, upper)]),
            lambda u: across,
            np.ones(2 * n),
            gap_size=RADIUS,
            coulomb=Coulomb(np.full(2 * n, self.mu), slipped, lambda u: along, RADIUS + abs(load)),
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

    hub_error_mm: of the hub from s/2; middle_error_mm: from the middle between the plates.  turn_rad: of the rim
    about the hub, forward positive, in the mean.  bar_mm: mean length of the bars of the rim that lie on a plate, both
    ends sticking; else NaN.  press_N, drag_N: of the lower plate.  dissipation_N_mm: of the step.
    """
    truss, n = wheel.truss, wheel.n
    for state in wheel.follow([-0.5, 0.0, *(step * k for k in range(1, round(way / step) + 1))]):
        solution, s = state.solution, max(state.load, 0.0)
        x = truss.nodes + solution.u.reshape(-1, 3)
        friction = solution.rubbed
        was, now = ((each[:-1] - each[-1]) @ np.array([1.0, 0.0, 1.0j]) for each in (truss.nodes, x))
        turn = float(np.mean(np.angle(was / now)))
        sticks = (friction.state == State.STICK).reshape(2, n)
        lies = (sticks & np.roll(sticks, -1, axis=1)).any(axis=0)
        bars = np.linalg.norm(np.roll(x[:n], -1, axis=0) - x[:n], axis=1)[lies]
        yield (
            {"way_mm": s, "outcome": solution.outcome.word, "iterations": solution.counters["newton_iterations"]}
            | {"hub_mm": float(x[-1, 0]), "hub_error_mm": float(x[-1, 0] - s / 2)}
            | {"middle_error_mm": float(x[-1, 2] + wheel.squeeze * (1 + min(state.load, 0.0)) / 2)}
            | {"turn_rad": turn, "bar_mm": float(np.mean(bars)) if len(bars) else math.nan}
            | {"press_N": float(solution.pressure[:n].sum()), "drag_N": float(friction.force[:n, 0].sum())}
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

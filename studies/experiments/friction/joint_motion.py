"""A body and its foundation moved and turned together, far: friction is what it was, and nothing is dissipated.

A pyramid of bars stands with its four feet on a plane; a soft spring holds its top. Its loads and the spring turn with
it. Where only its feet are pressed straight down, no bar is strained, and friction is none before and after; where its
top is pushed aside, too, friction stays as it is seen from the foundation. Beside it the foundation moves alone, by
less than a hundredth of a millimetre.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.coulomb import Coulomb, Motion
from contact.friction.path import PathState, Stage, dissipation
from contact.friction.slip import Slip
from contact.obstacles.foundation import Candidates
from contact.problem import ContactProblem, ContactSolution
from studies.experiments.friction.brush import GROUND
from studies.experiments.friction.truss import Truss
from studies.experiments.rows import Row, tabulated

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
        steps = [("loaded", was), *(("together", motion) for motion in MOTIONS), ("alone", ALONE)]
        first = standing
        for index, (step, motion) in enumerate(steps):
            start, body = at.solution, motion
            if step == "together":
                x = motion.out(was.into(truss.nodes + start.u.reshape(-1, 3)))
                start = replace(start, u=(x - truss.nodes).ravel() + rng.uniform(-BENT, BENT, truss.nodes.size))
            elif step == "alone":
                body = was
            stage = stage_at(truss, LOADS[name], body, motion, at.anchors)
            found = Semismooth().solve(stage.problem, start)
            at, was = PathState(0.0, found, stage.anchored(found.u), dissipation(stage.problem, found)), body
            first = found if step == "loaded" else first
            yield (
                {"load": name, "index": index, "step": step, "outcome": found.outcome.word}
                | {"turn_rad": float(np.linalg.norm(motion.turn)), "way_mm": float(np.linalg.norm(motion.translation))}
                | {"iterations": found.counters["newton_iterations"]}
                | {"friction_N": float(np.sum(np.linalg.norm(found.rubbed.force, axis=1)))}
                | {"change_N": float(np.max(np.abs(found.rubbed.force - first.rubbed.force)))}
                | {"normal_change_N": float(np.max(np.abs(found.pressure - first.pressure)))}
                | {"bar_change_N": float(np.max(np.abs(truss.forces(found.u) - truss.forces(first.u))))}
                | {"dissipation_N_mm": at.dissipation}
            )

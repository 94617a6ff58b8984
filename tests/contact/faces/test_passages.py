"""Passages of faces through each other: against half-spaces of a moving box, and a ring thrown through another one."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.continuation.load_stepping import PathPoint, follow
from contact.events import EventKind, events
from contact.faces.pair import Pair, between
from contact.faces.passages import DEEP, Ways
from contact.faces.sampling import areas, at_nodes, mortar
from contact.problem import ContactProblem, ContactSolution, linear_mechanics
from contact.swept import crossings, crossings_along

SURELY = 1e-6  # of a way, or of a length: nearer to the limit of a rule it need not decide as we do
CUT = 6  # patches along the side of a box
BOX = 1.0  # half its side


def box() -> tuple[np.ndarray, np.ndarray]:
    """Points (k, 3) and patches (q, 4) of a cube, each side by itself, which look out of it."""
    line = np.linspace(-BOX, BOX, CUT + 1)
    a, b = (grid.ravel() for grid in np.meshgrid(line, line, indexing="ij"))
    low = (np.arange(CUT)[:, None] * (CUT + 1) + np.arange(CUT)).ravel()
    quads = low[:, None] + np.array([0, CUT + 1, CUT + 2, 1])
    points, patches = list[np.ndarray](), list[np.ndarray]()
    for axis in range(3):
        for side in (-1.0, 1.0):
            patches.append((quads if side > 0 else quads[:, ::-1]) + len(a) * len(points))
            points.append(np.roll(np.stack([np.full(len(a), side * BOX), a, b], axis=-1), axis, axis=1))
    return np.concatenate(points), np.concatenate(patches)


def by_half_spaces(start: np.ndarray, end: np.ndarray, sizes: np.ndarray) -> tuple[str, float]:
    """What a segment does in a cube whose half side grows from one size to the other, and by how much that is sure.

    |x_i(s)| <= BOX size(s) on both sides is linear in s; the normals of two sides are the axes.
    """
    way, growth = end - start, sizes[1] - sizes[0]
    level = np.concatenate([start, -start]) - BOX * sizes[0]  # <= 0 within
    rate = np.concatenate([way, -way]) - BOX * growth
    at = -level / rate
    goes, comes = np.max(at[rate < 0], initial=0.0), np.min(at[rate > 0], initial=1.0)
    if goes >= comes:
        return "misses", comes - goes
    if comes == 1.0:
        depth = BOX * sizes[1] - np.max(np.abs(end))
        return "deep" if depth > DEEP * 2 * BOX * sizes[1] / CUT else "slight", depth / (2 * BOX / CUT) - DEEP
    sides = (np.argmax(np.where(rate < 0, at, -np.inf)), np.argmin(np.where(rate > 0, at, np.inf)))
    return "across" if abs(sides[0] - sides[1]) == 3 else "corner", comes - goes


def test_passages_of_random_segments_through_a_box_that_moves_and_grows(rng: np.random.Generator) -> None:
    x, quads = box()
    m, k = 400, len(x)
    way, begin, sizes = rng.normal(size=3), rng.normal(size=3), np.array([1.0, 1.3])
    start = rng.uniform(-3, 3, (m, 3))
    end = rng.uniform(-2.0, 2.0, (m, 3)) - 0.3 * start
    outside = np.max(np.abs(start), axis=1) > BOX
    ends = [
        np.vstack([start + begin, sizes[0] * x + begin]),
        np.vstack([end + begin + way, sizes[1] * x + begin + way]),
    ]
    slave = np.arange(m).reshape(-1, 4)
    meeting = Ways(lambda u: ends[int(u[0])], slave, quads + m)
    names = {
        each.candidate
        for each in crossings(meeting, np.zeros(1), meeting, np.ones(1))
        if each.kind == "slave point" and each.candidate < m
    }
    values = [by_half_spaces(start[i], end[i], sizes) for i in range(m)]
    for i in np.flatnonzero(outside):
        what, margin = values[i]
        if abs(margin) > SURELY:
            assert (i in names) == (what in ("across", "deep")), (i, what, margin)
    words = [what for (what, _), kept in zip(values, outside, strict=True) if kept]
    assert k == 6 * (CUT + 1) ** 2
    for what in ("misses", "deep", "slight", "across", "corner"):
        assert words.count(what) >= 5, what


def test_corners_of_the_master_are_looked_at_as_well() -> None:
    """A small box thrown through one large patch: no point of the patch passes through the box."""
    x, quads = box()
    plate = np.array([[-1.5, -1.5, 0], [1.5, -1.5, 0], [1.5, 1.5, 0], [-1.5, 1.5, 0]])
    below = [np.vstack([plate, 0.5 * x + [0.1, 0.2, height]]) for height in (3.0, -3.0)]
    meeting = Ways(lambda u: below[int(u[0])], np.array([[0, 1, 2, 3]]), quads + 4)
    actual = crossings(meeting, np.zeros(1), meeting, np.ones(1))
    assert {each.kind for each in actual} == {"master point"}
    assert {each.candidate for each in actual} == set(range(4, 4 + len(x)))


# --- rings on springs -------------------------------------------------------------------------------------------------

AROUND, RADIUS, TRAVEL = 12, 1.0, 6.0
LEAST, BRIEF = 0.1, 10  # of the step; iterations: most attempts start from deep in each other
SIZE = 3 * 2 * (2 * AROUND - 3)  # unknowns of both


def ring(count: int, centre: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (2 count, 3) and patches of a closed ring about the third axis, which look outwards."""
    angle = 2 * np.pi * np.arange(count) / count
    around = np.stack([centre + RADIUS * np.cos(angle), RADIUS * np.sin(angle)], axis=-1)
    points = np.concatenate([np.column_stack([around, np.full(count, z)]) for z in (0.0, 0.3)])
    here, there = np.arange(count), np.roll(np.arange(count), -1)
    return points, np.stack([here, there, there + count, here + count], axis=-1)


def thrown(pairing: str) -> Callable[[float], ContactProblem]:
    """A ring on springs whose other ends travel by TRAVEL past another one: at the end they are far apart again."""

    def problem_at(t: float) -> ContactProblem:
        own, other = ring(AROUND, -TRAVEL / 2 + t * TRAVEL), ring(AROUND - 3, 0.0)
        x = np.vstack([own[0], other[0]])
        nodes, master = np.arange(len(own[0])), other[1] + len(own[0])
        everything = sparse.csr_matrix(sparse.eye_array(x.size, format="csr"))
        points = at_nodes(nodes, len(x), areas(x, own[1])[nodes])
        pair = Pair(x, everything, master, points if pairing == "nodes" else mortar(x, own[1], master, nodes), own[1])
        return between(linear_mechanics(sparse.csc_matrix(everything), np.zeros(x.size), scale=1.0), pair)

    return problem_at


def followed(problem_at: Callable[[float], ContactProblem]) -> PathPoint:
    rest = ContactSolution.at_rest(SIZE, 2 * AROUND)
    (point,) = follow(
        problem_at, 0.0, [1.0], ALGORITHMS["semismooth"](epsilon=math.inf, max_iterations=BRIEF), rest, smallest=LEAST
    )
    return point


@pytest.mark.parametrize("pairing", ["nodes", pytest.param("mortar", marks=pytest.mark.slow)])
def test_a_ring_thrown_through_another_one_is_no_path(pairing: str) -> None:
    """Both ends are equilibria without contact: without the check the one step is taken, with it it is cut."""
    problem_at = thrown(pairing)
    rest = np.zeros(SIZE)
    blind = followed(lambda t: replace(problem_at(t), standing=None))
    assert blind.outcome.converged
    assert blind.substeps == 1
    assert len(crossings_along((problem_at(t).standing, state.u) for t, state in blind.way)) > AROUND
    assert crossings(problem_at(0.0).standing, rest, problem_at(0.16).standing, rest) == []
    seen = followed(problem_at)
    assert "passes through the other face" in str(events(seen.solution.history, EventKind.PASSED)[0])
    assert crossings_along((problem_at(t).standing, state.u) for t, state in seen.way) == []
    assert not seen.outcome.converged

"""The column against a wall: its beam, point contact, and line contact, whose end inertia sees."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse
from scipy.integrate import solve_bvp
from scipy.sparse.linalg import spsolve

from contact.continuation.stability import STABLE, stability
from contact.problem import ContactProblem, ContactSolution
from contact.verify import judge
from studies.scenes.complete import complete
from studies.scenes.contact.walled_column import (
    BENDING,
    CLEARANCE,
    DELTAS,
    EULER,
    EXTENSION,
    LENGTH,
    LINE,
    POINT,
    ColumnModel,
    H,
    bent,
    exact,
    load_at,
)
from support.problems.differences import fitted_order
from support.problems.solved import read, solved

SCENE = "walled-column"
ASKED = ",".join(map(str, DELTAS))
QUANTITIES = ("P_over_PE", "wall_force")


# --- the beam ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("load", [1.0, 1.7, 3.3, 3.9])
def test_the_beam_in_point_contact_is_that_of_its_equation(load: float) -> None:
    """w'''' + k^2 w'' = 0 by collocation; the shortening is one of its unknowns."""
    square = 4 * math.pi**2 * load

    def along(x: np.ndarray, state: np.ndarray) -> np.ndarray:
        _, w1, w2, w3, _ = state
        return np.array([w1, w2, w3, -square * w2, w1**2])

    def ends(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.array([a[0], a[1], a[4], b[0] - 1, b[1]])

    x = np.linspace(0, 0.5, 60)
    k = 2 * math.pi
    bow = [(1 - np.cos(k * x)) / 2, k * np.sin(k * x) / 2, k**2 * np.cos(k * x) / 2, -(k**3) * np.sin(k * x) / 2, x]
    actual = solve_bvp(along, ends, x, np.array(bow), tol=1e-7, max_nodes=20000)
    assert actual.success
    shortening, force = bent(load)
    assert actual.y[4, -1] == pytest.approx(shortening, rel=1e-6)
    assert 2 * actual.y[3, 0] / (4 * math.pi**2) == pytest.approx(force, rel=1e-5, abs=1e-6)


def test_the_beam_passes_from_point_to_line_contact() -> None:
    """Shortenings pi^2/4, 3 and 4.5 clearance^2/L at P_E, 4 P_E and 9 P_E; force k^3/(2 pi) at each end of the flat."""
    assert bent(1.0) == pytest.approx((math.pi**2 / 4, 0), abs=1e-14)
    assert bent(POINT) == pytest.approx((3, 16), rel=1e-12)
    assert bent(LINE)[0] == pytest.approx(4.5, rel=1e-12)
    assert bent(POINT * (1 + 1e-9)) == pytest.approx(bent(POINT), rel=1e-8)
    k = 2 * math.pi * math.sqrt(6.0)
    assert bent(6.0)[1] == pytest.approx(2 * k**3 / (2 * math.pi) / (4 * math.pi**2), rel=1e-12)
    assert load_at(bent(3.0)[0] + 0.1 * 3.0, 0.1) == pytest.approx(3.0, rel=1e-12)
    assert load_at(0.05, 0.1) == 0.5  # not buckled
    with pytest.raises(ValueError, match="at least 1"):
        bent(0.9)
    with pytest.raises(ValueError, match="beyond that at 9 P_E"):
        load_at(7.0, 0.1)


# --- the shell --------------------------------------------------------------------------------------------------------


def test_load_and_force_of_point_contact_converge_to_the_beam() -> None:
    """From 16 to 64 elements on half of the column: by their square, to 0.3 and 0.6 %."""
    meshes = (16, 32, 64)
    values = [solved(SCENE, f"{n}x1", delta_mm=ASKED) for n in meshes]
    assert all(step["stability"]["word"] == STABLE for step in values[-1].steps)
    expected = np.array([exact(delta) for delta in DELTAS])
    off = np.array([[read(each, name) for name in QUANTITIES] for each in values])[:, :, 1:] / expected.T[:, 1:] - 1
    assert np.all(np.abs(off[-1]) <= [[5e-3], [8e-3]])
    for errors in np.abs(off[:, :, -1]).T:
        assert fitted_order([1 / n for n in meshes], errors) >= 1.8
    np.testing.assert_allclose(read(values[-1], "P_over_PE")[0], 1, rtol=1e-3)  # before it touches


@pytest.mark.slow
def test_force_over_shortening() -> None:
    """The other algorithms agree with this one on a coarser column."""
    solution = solved(SCENE, "256x1", delta_mm=ASKED)
    expected = np.array([exact(delta) for delta in DELTAS])
    np.testing.assert_allclose(read(solution, "P_over_PE"), expected[:, 0], rtol=5e-4)
    np.testing.assert_allclose(read(solution, "wall_force"), expected[:, 1], rtol=1e-3)


# --- line contact -----------------------------------------------------------------------------------------------------


def flattened(n: int, load: float) -> tuple[ContactProblem, ContactSolution, float]:
    """The column with a flat part whose first two nodes alone are held at the wall, and its load over P_E.

    Newton's method with an equation for each of their gaps, from the shape of the beam: no algorithm chooses a set, and
    the rest of the flat part, on which there is no pressure, is free.
    """
    scene, request = complete(SCENE, {}, f"{n}x1")
    model = scene.build(request)
    assert isinstance(model, ColumnModel)
    delta = bent(load)[0] * BENDING + load * EXTENSION
    problem, body = model.problem_at(delta), model.shell.discretisation
    x, free = body.grid.nodes[:, 0], LENGTH / math.sqrt(load)
    k = 2 * math.pi / free
    mode = np.zeros((len(x), 6))
    mode[:, 4:] = CLEARANCE * np.where(x < free, x / free - np.sin(k * x) / (2 * math.pi), 1)[:, None]
    mode[:, :2] = np.outer(CLEARANCE / free * np.where(x < free, 1 - np.cos(k * x), 0), [H / 2, -H / 2])
    u, lines = body.map.restrict(mode), np.unique(x)
    for j in np.searchsorted(lines, free) + np.array([-1, 0, -2]):
        start, memory = u, None
        held = np.isin(x[model.nodes], lines[j : j + 2])
        G = problem.gap_jacobian(u)[held]
        for _ in range(40):
            lin = problem.linearise(start, memory)
            whole = sparse.bmat([[lin.tangent, -G.T], [G, None]], format="csc")
            step = spsolve(whole, -np.append(lin.residual, problem.gap(start)[held]))
            memory = lin.remember(step[: len(u)])
            start = start + step[: len(u)]
            if np.abs(step[: len(u)]).max() < 1e-12:
                break
        force = np.zeros(len(held))
        force[held] = step[len(u) :]
        if np.all(force[held] > 0):
            break
    state = replace(
        ContactSolution.at_rest(len(u), len(held)), u=start, pressure=force / problem.weights, active=force > 0
    )
    reaction = float(model.moved(delta).shell.reactions(start)[x == 0, :2].sum())
    return problem, state, reaction / EULER


def test_line_contact_is_that_of_the_beam() -> None:
    """Equilibria of the whole contact problem, stable though nothing presses the flat part."""
    for load in (5.0, 7.0, 8.5):
        problem, state, actual = flattened(128, load)
        assert judge(problem, state.u, state.pressure).failures() == []
        assert stability(problem, state).negative == 0
        assert actual == pytest.approx(load, rel=5e-3)
        force = 2 * problem.nodal_forces(state.pressure).sum() / EULER * LENGTH / CLEARANCE
        assert force == pytest.approx(bent(actual)[1], rel=1e-3)


def test_inertia_alone_sees_the_flat_part_buckle_at_nine_times_the_load() -> None:
    """Between two loads that are 0.6 % apart, on a mesh of 128 elements on one half."""
    *before, below = flattened(128, 8.97)
    *after, above = flattened(128, 9.03)
    assert stability(*before).negative == 0
    assert stability(*after).negative == 1
    assert below < LINE < above
    assert (below, above) == pytest.approx((LINE, LINE), rel=5e-3)

"""Arc length: limit points, snap-back and end point of curves in closed form."""

import math

import numpy as np
import pytest
from scipy import sparse

from contact.continuation.arc_length import ArcLength
from contact.continuation.equilibrium_curve import ArcPoint
from contact.problem import Linearisation, Outcome
from contact.solvers.sparse import SingularMatrixError

ON_CURVE = 1e-8
LIMIT = 1e-4  # of a limit point in displacement: the load is stationary there
LIMIT_LOAD = 1e-8  # and therefore much better in the load
U_LIMITS = (1 - 1 / math.sqrt(3), 1 + 1 / math.sqrt(3))  # of P = u (u - 1)(u - 2)
TARGET = 1.0
U_END = max(np.roots([1, -3, 2, -TARGET]).real)


def load_of(u):
    return u * (u - 1) * (u - 2)


def truss():
    """The shallow truss P = u (u - 1)(u - 2): snap-through."""

    def linearise(u, memory):
        tangent = sparse.csc_matrix(np.diag(3 * u**2 - 6 * u + 2))
        return Linearisation(load_of(u), tangent, float(np.linalg.norm(load_of(u))))

    return linearise, np.ones(1)


def truss_behind_a_spring(k: float = 0.2):
    """The same loaded through a soft spring: w = u + P/k goes backwards, snap-back."""

    def linearise(x, memory):
        u, w = x
        residual = np.array([load_of(u) - k * (w - u), k * (w - u)])
        tangent = sparse.csc_matrix(np.array([[3 * u**2 - 6 * u + 2 + k, -k], [-k, k]]))
        return Linearisation(residual, tangent, float(np.linalg.norm(residual)))

    return linearise, np.array([0.0, 1.0])


@pytest.mark.parametrize("first_factor", [0.02, 0.2])
def test_snap_through(first_factor) -> None:
    linearise, load = truss()
    trace = ArcLength(first_factor).trace(linearise, load, [0.2, TARGET])
    assert trace.outcome is Outcome.CONVERGED
    for point in trace.points:
        assert point.factor == pytest.approx(load_of(point.u[0]), abs=ON_CURVE)
    assert np.all(np.diff([p.u[0] for p in trace.points]) > 0)  # never back on its own trace
    limits = [p for p in trace.points if p.limit]
    assert [p.u[0] for p in limits] == pytest.approx(U_LIMITS, abs=LIMIT)
    assert [p.factor for p in limits] == pytest.approx([load_of(u) for u in U_LIMITS], abs=LIMIT_LOAD)
    assert trace.points[-1].factor == pytest.approx(TARGET, abs=ON_CURVE)
    assert trace.points[-1].u[0] == pytest.approx(U_END, abs=ON_CURVE)
    assert min(abs(p.factor - 0.2) for p in trace.points) <= ON_CURVE


def test_snap_back() -> None:
    linearise, load = truss_behind_a_spring()
    trace = ArcLength(0.05).trace(linearise, load, [TARGET])
    assert trace.outcome is Outcome.CONVERGED
    limits = [p for p in trace.points if p.limit]
    expected = [[u, u + load_of(u) / 0.2] for u in U_LIMITS]
    np.testing.assert_allclose([p.u for p in limits], expected, rtol=0, atol=LIMIT)
    np.testing.assert_allclose(trace.points[-1].u, [U_END, U_END + TARGET / 0.2], rtol=0, atol=ON_CURVE)
    assert np.any(np.diff([p.u[1] for p in trace.points]) < 0)  # the loaded point goes back
    assert np.all(np.diff([p.u[0] for p in trace.points]) > 0)


def test_a_curve_that_never_gets_there_says_so() -> None:
    """P = u exp(-u) has its maximum 1/e at u = 1 and never reaches 1."""

    def linearise(u, memory):
        tangent = sparse.csc_matrix(np.diag((1 - u) * np.exp(-u)))
        return Linearisation(u * np.exp(-u), tangent, float(np.linalg.norm(u * np.exp(-u))))

    trace = ArcLength(0.05, max_points=40).trace(linearise, np.ones(1), [1.0])
    assert not trace.outcome.converged
    assert trace.reason
    (limit,) = [p for p in trace.points if p.limit]
    assert limit.u[0] == pytest.approx(1.0, abs=LIMIT)
    assert limit.factor == pytest.approx(1 / math.e, abs=LIMIT_LOAD)


def test_a_march_without_an_iteration_does_not_leave_rest() -> None:
    linearise, load = truss()
    trace = ArcLength(0.02, max_iterations=0).trace(linearise, load, [TARGET])
    assert trace.outcome is Outcome.STEP_LIMIT
    assert "arc length after t = 0" in trace.reason
    assert len(trace.points) == 1


class Stuck:
    """A curve whose solver takes the guess's beginning for an answer, as a loose tolerance may, or has no tangent."""

    def __init__(self, moves: float) -> None:
        self.moves = moves

    def place(self, point: ArcPoint) -> np.ndarray:
        return np.append(point.u, point.factor)

    def on_plane(self, start: ArcPoint, guess: np.ndarray, normal: np.ndarray, event: str) -> ArcPoint:
        actual = self.place(start) + self.moves * (guess - self.place(start))
        return ArcPoint(actual[:-1], float(actual[-1]))

    def tangent(self, point: ArcPoint, along: np.ndarray) -> np.ndarray:
        raise SingularMatrixError("no tangent")


@pytest.mark.parametrize("moves", [0.0, 0.3, 1.0])
def test_a_point_off_its_plane_or_without_a_tangent_is_none(moves) -> None:
    ahead = np.array([0.6, 0.8])
    actual, onwards = ArcLength(1.0)._advance(Stuck(moves), ArcPoint(np.zeros(1), 0.0), ahead, watchful=False)
    assert actual is None
    np.testing.assert_array_equal(onwards, ahead)

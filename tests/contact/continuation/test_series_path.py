"""Power series: curves in closed form, a shell's coefficients by differences of its path, and arc length."""

import math
from functools import cache, partial

import numpy as np
import pytest
from numpy.polynomial import polynomial
from scipy import sparse

from contact.continuation.arc_length import ArcLength, Trace
from contact.continuation.equilibrium_curve import ArcPoint, Curve
from contact.continuation.power_series import Piece
from contact.continuation.series_path import PowerSeries
from contact.problem import Linearisation, Outcome
from formulations.shell_series import ShellSeries
from studies.scenes.complete import complete as resolve
from studies.scenes.curves import CurveModel

ON_CURVE = 1e-10
CLOSE = 1e-8  # relative, of two limit loads and of two states
U_LIMITS = (1 - 1 / math.sqrt(3), 1 + 1 / math.sqrt(3))  # of P = u (u - 1)(u - 2)
TRUSS = (0.0, 2.0, -3.0, 1.0)


class Polynomials:
    """R_{k+1} of A u + e c(u_1), a polynomial c of the first unknown in the first force: by products of polynomials."""

    def __init__(self, u: np.ndarray, c: tuple[float, ...]) -> None:
        self._first, self._c, self._n = [float(u[0])], c, len(u)

    def add(self, du: np.ndarray) -> np.ndarray:
        self._first.append(float(du[0]))
        value = np.zeros(1)
        for coefficient in self._c[::-1]:
            value = polynomial.polyadd(polynomial.polymul(value, self._first), [coefficient])
        order, left = len(self._first), np.zeros(self._n)
        left[0] = value[order] if len(value) > order else 0.0
        return left


def model(spring: float | None = None):
    """The shallow truss P = u (u - 1)(u - 2), alone or behind a soft spring, which makes it snap back."""

    def linearise(u, memory):
        force, slope = polynomial.polyval(u[:1], TRUSS), polynomial.polyval(u[:1], polynomial.polyder(TRUSS))
        K = np.zeros((len(u), len(u)))
        residual = np.zeros(len(u))
        K[0, 0], residual[0] = slope[0], force[0]
        if spring is not None:
            A = spring * np.array([[1.0, -1.0], [-1.0, 1.0]])
            K, residual = K + A, residual + A @ u
        return Linearisation(residual, sparse.csc_matrix(K), float(np.linalg.norm(residual)))

    load = np.ones(1) if spring is None else np.array([0.0, 1.0])
    return linearise, lambda u, order: Polynomials(u, TRUSS), load


def traced(targets=(0.2, 1.0), spring: float | None = None, **how) -> Trace:
    linearise, expand, load = model(spring)
    return PowerSeries(**how).trace(linearise, expand, load, targets)


def load_of(u):
    return polynomial.polyval(u, TRUSS)


def test_snap_through() -> None:
    trace = traced()
    assert trace.outcome is Outcome.CONVERGED
    ends = np.cumsum([piece.length for piece in trace.curve.pieces])[:-1]
    rest, *events = [point for point in trace.points if point.along not in ends]
    assert len(trace.points) == len(ends) + 5
    assert [point.limit for point in events] == [False, True, True, False]
    limits = [point for point in events if point.limit]
    assert [p.u[0] for p in limits] == pytest.approx(U_LIMITS, abs=ON_CURVE)
    assert [p.factor for p in limits] == pytest.approx([load_of(u) for u in U_LIMITS], abs=ON_CURVE)
    assert [p.factor for p in (rest, events[0], events[-1])] == [0.0, 0.2, 1.0]
    for point in (*trace.points, *trace.curve.sampled(20)):
        assert point.factor == pytest.approx(load_of(point.u[0]), abs=ON_CURVE)
    assert np.all(np.diff([point.along for point in trace.points[1:]]) > 0)
    assert trace.counters["factorisations"] == len(trace.curve.pieces) + 1
    assert trace.counters["newton_iterations"] == 0


def test_snap_back() -> None:
    trace = traced((1.0,), spring=0.2)
    expected = [[u, u + load_of(u) / 0.2] for u in U_LIMITS]
    np.testing.assert_allclose([p.u for p in trace.points if p.limit], expected, rtol=0, atol=1e-8)
    way = np.array([point.u for point in trace.curve.sampled(20)])
    assert np.any(np.diff(way[:, 1]) < 0)  # the loaded point goes back
    assert np.all(np.diff(way[:, 0]) > 0)


def test_the_curve_is_known_wherever_the_load_passes() -> None:
    trace = traced()
    roots = np.sort(np.roots([1, -3, 2, -0.1]).real)
    values = [trace.at(0.1, passage) for passage in range(3)]
    assert [point.u[0] for point in values] == pytest.approx(roots, abs=ON_CURVE)
    assert [point.rising for point in values] == [True, False, True]
    with pytest.raises(LookupError, match="passes 3 times, not 4"):
        trace.at(0.1, 3)
    with pytest.raises(LookupError, match="does not pass the load factor 2"):
        trace.at(2.0)


def test_points_of_arc_length_are_all_that_is_known_of_a_curve() -> None:
    linearise, _, load = model()
    with pytest.raises(LookupError, match="at its points alone"):
        ArcLength(0.05).trace(linearise, load, [1.0]).at(0.1)


def test_it_ends_where_it_is_told_to() -> None:
    first = traced(to_limit=True)
    assert first.outcome is Outcome.LIMIT_POINT
    assert first.points[-1].limit
    short = traced((1e6,), most_pieces=2)
    assert short.outcome is Outcome.ITERATION_LIMIT
    assert "2 series" in short.reason
    assert short.points[-1].factor == pytest.approx(load_of(short.points[-1].u[0]), abs=ON_CURVE)


def test_a_model_that_is_not_what_its_series_says_gets_nowhere() -> None:
    linearise, _, load = model()
    trace = PowerSeries().trace(linearise, lambda u, order: Polynomials(u, (0.0, 2.0, 3.0, 1.0)), load, [1.0])
    assert trace.outcome is Outcome.STEP_LIMIT
    assert "after t = 0" in trace.reason
    assert len(trace.points) == 1


# --- a shell ----------------------------------------------------------------------------------------------------------


def roof(**given: str) -> CurveModel:
    built = resolve("roof-a", {"path": "series", **given}, "4x4")
    actual = built[0].build(built[1])
    assert isinstance(actual, CurveModel)
    return actual


@cache
def both(**given: str) -> tuple[Trace, Trace]:
    """The same curve by series and by arc length."""
    shell = roof(**given).shell
    unloaded = shell.scaled(0.0)
    arc = ArcLength(0.01).trace(unloaded.linearise, shell.forces, [0.5, 1.0])
    return PowerSeries().trace(unloaded.linearise, partial(ShellSeries.of, unloaded), shell.forces, [0.5, 1.0]), arc


@pytest.mark.parametrize("interpolation", [pytest.param("curvilinear", marks=pytest.mark.slow), "isoparametric"])
def test_the_curve_of_a_shell_is_that_of_arc_length(interpolation: str) -> None:
    series, arc = both(interpolation=interpolation)
    limits = [[point.factor for point in trace.points if point.limit] for trace in (series, arc)]
    assert len(limits[0]) == 2
    np.testing.assert_allclose(*limits, rtol=CLOSE)
    for factor in (0.5, 1.0):
        ours, theirs = (next(p for p in trace.points if abs(p.factor - factor) < 1e-12) for trace in (series, arc))
        np.testing.assert_allclose(ours.u, theirs.u, rtol=0, atol=CLOSE * np.abs(theirs.u).max())
    assert series.counters["factorisations"] < 0.15 * arc.counters["factorisations"]


def test_forces_balance_all_along_the_curve() -> None:
    """Between the points that the march has looked at, too."""
    series, _ = both(interpolation="curvilinear")
    shell = roof().shell
    for point in series.curve.sampled(7):
        left = shell.scaled(0.0).residual(point.u) - point.factor * shell.forces
        assert np.linalg.norm(left) <= 1e-9 * max(abs(point.factor), 0.1) * np.linalg.norm(shell.forces)


def test_coefficients_are_derivatives_of_the_path() -> None:
    """Points at the length a along x_1 lie on planes across it, where Newton finds them by itself."""
    series, _ = both(interpolation="curvilinear")
    piece: Piece = series.curve.pieces[1]
    shell = roof().shell
    unloaded = shell.scaled(0.0)
    curve = Curve.at_rest(unloaded.linearise, shell.forces, 20, "auto", 1e-13, shell.ordered)
    x0, x1 = piece.x[:2]
    m = np.sqrt((1 - x1[-1] ** 2) / (x1[:-1] @ x1[:-1]))  # the scale in which |x_1| = 1
    curve = curve.scaled(1.0, m)
    start, weights = ArcPoint(x0[:-1], x0[-1]), np.append(np.full(len(x0) - 1, curve.m), 1.0)
    a = 0.4 * piece.length * np.cos(np.pi * (np.arange(13) + 0.5) / 13)
    points = []
    for length in a:
        guess = weights * (x0 + length * x1)
        actual = curve.on_plane(start, guess, weights * x1, "difference")
        points.append(np.append(actual.u, actual.factor))
    fitted = np.linalg.solve(np.vander(a / a[0], increasing=True), np.array(points))
    for k, tolerance in ((1, 1e-8), (2, 1e-6), (3, 1e-5), (4, 1e-3)):
        expected = piece.x[k] * a[0] ** k
        np.testing.assert_allclose(fitted[k], expected, rtol=0, atol=tolerance * np.abs(expected).max())

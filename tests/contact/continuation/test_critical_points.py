"""Why a path ends: limit points and bifurcations in closed form, and the softest motion there."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.continuation.critical_points import why_it_ends
from contact.continuation.load_stepping import follow
from contact.continuation.spectrum import spectrum
from contact.events import EventKind, PathEnd
from contact.problem import ContactProblem, ContactSolution, Linearisation, Outcome

EXACT = 1e-9
LIMIT = 1e-4  # of the interval, on the limit extrapolated from states within a hundredth of it


def pressed(residual, tangent, sign: float):
    """problem_at(t): two unknowns, the second held by a plane that has gone to sign t; area 1."""

    def at(t: float) -> ContactProblem:
        def linearise(u, memory):
            return Linearisation(residual(*u), sparse.csc_matrix(tangent(*u)), 1.0)

        G = sparse.csr_matrix([[0.0, sign]])
        return ContactProblem(linearise, lambda u: G @ u - t, lambda u: G, np.ones(1))

    return at


def in_contact(u, p: float) -> ContactSolution:
    return ContactSolution(np.array(u), np.array([p]), np.array([True]), Outcome.CONVERGED)


H, A, C = 1.0, 2.0, 0.5  # height of the truss, a, spring: C < A H^2, or the plane would take it through


def truss():
    """A shallow truss of energy a/4 ((h + w)^2 - h^2)^2 under a spring c that a plane presses down by t."""

    def residual(w, d):
        return np.array([A * ((H + w) ** 2 - H**2) * (H + w) + C * (w - d), C * (d - w)])

    def tangent(w, d):
        return np.array([[A * (3 * (H + w) ** 2 - H**2) + C, -C], [-C, C]])

    return pressed(residual, tangent, -1.0)


def truss_state(w: float) -> tuple[float, ContactSolution]:
    """The plane and the state at the deflection w of the apex."""
    force = A * ((H + w) ** 2 - H**2) * (H + w)
    d = w + force / C
    return -d, in_contact([w, d], -force)


W_LIMIT = np.sqrt((H**2 - C / A) / 3) - H
T_LIMIT = truss_state(W_LIMIT)[0]


def test_a_truss_ends_at_its_limit_point() -> None:
    for nearness in (0.1, 0.05, 0.02):
        states = [truss_state(W_LIMIT * (1 - part)) for part in (1.0, 3 * nearness, 2 * nearness, nearness)]
        actual = why_it_ends(truss(), states)
        assert actual.kind is PathEnd.LIMIT_POINT
        assert actual.sentence.startswith("limit point")
        # the next term of the law is of third order in the deflection, of order 3/2 in the parameter
        assert actual.limit == pytest.approx(T_LIMIT, abs=3 * nearness**3 * T_LIMIT)
        assert f"{actual.limit:.7g}" in actual.sentence


def test_the_softest_motion_of_the_truss() -> None:
    t, state = truss_state(-0.2)
    actual = spectrum(truss()(t), state)
    assert actual.eigenvalues == pytest.approx(A * (3 * 0.8**2 - H**2) + C, rel=EXACT)
    assert np.abs(actual.modes) == pytest.approx(np.array([[1.0], [0.0]]), abs=EXACT)
    assert actual.negative == 0
    t, state = truss_state(-0.8)  # on the way back
    assert spectrum(truss()(t), state).negative == 1


K_LINK, LENGTH, C_LINK = 3.0, 2.0, 5.0
T_BUCKLING = K_LINK / (C_LINK * LENGTH)


def link():
    """An upright link on a spiral spring k, pressed by a plane through a spring c: it buckles at t = k/(c l)."""

    def residual(th, d):
        N = C_LINK * (d - LENGTH * (1 - np.cos(th)))
        return np.array([K_LINK * th - N * LENGTH * np.sin(th), N])

    def tangent(th, d):
        s, N = LENGTH * np.sin(th), C_LINK * (d - LENGTH * (1 - np.cos(th)))
        return np.array([[K_LINK + C_LINK * s**2 - N * LENGTH * np.cos(th), -C_LINK * s], [-C_LINK * s, C_LINK]])

    return pressed(residual, tangent, 1.0)


def test_a_link_ends_at_its_bifurcation() -> None:
    times = [part * T_BUCKLING for part in (0.0, 0.9, 0.95, 0.99)]
    actual = why_it_ends(link(), [(t, in_contact([0.0, t], C_LINK * t)) for t in times])
    assert actual.kind is PathEnd.BIFURCATION
    assert actual.sentence.startswith("bifurcation near 0.297: ")
    assert "1 % of that at 0," in actual.sentence
    assert actual.limit is None


def test_branches_that_cross_are_no_limit_point_even_along_the_mode() -> None:
    """-x^2 + t x = 0 with a second unknown in contact: on x = t the tangent is -t, and the path moves on at speed 1."""
    at = pressed(lambda x, d: np.array([x * (d - x), d + 9]), lambda x, d: [[d - 2 * x, x], [0, 1]], 1.0)
    states = [(t, in_contact([t, t], t + 9)) for t in (-1.0, -0.03, -0.02, -0.01)]
    actual = why_it_ends(at, states)
    assert actual.limit is None
    assert actual.sentence.startswith("bifurcation near -0.01: ")


def test_a_limit_point_is_told_from_a_bifurcation_just_before_it() -> None:
    """The truss with a third unknown, whose stiffness is gone at w = 0.9 of the limit and negative from there on."""
    nearly, at_truss = 0.9 * W_LIMIT, truss()

    def at(t: float) -> ContactProblem:
        inner = at_truss(t)

        def linearise(u, memory):
            lin, stiff = inner.linearise(u[:2], memory), u[0] - nearly
            aside = np.array([u[2], 0.0])
            tangent = np.block([[lin.tangent.toarray(), aside[:, None]], [aside[None, :], np.array([[stiff]])]])
            force = np.append(lin.residual + np.array([u[2] ** 2 / 2, 0.0]), stiff * u[2])
            return Linearisation(force, sparse.csc_matrix(tangent), 1.0)

        G = sparse.csr_matrix([[0.0, -1.0, 0.0]])
        return ContactProblem(linearise, lambda u: G @ u - t, lambda u: G, np.ones(1))

    truss_states = [truss_state(part * W_LIMIT) for part in (0.0, 0.86, 0.91, 0.94)]
    states = [(t, in_contact([*state.u, 0.0], state.pressure[0])) for t, state in truss_states]
    actual = why_it_ends(at, states)
    assert actual.limit == pytest.approx(T_LIMIT, rel=1e-3)
    assert "1 eigenvalue is negative, none at 0: it has passed branches" in actual.sentence


@pytest.mark.slow
def test_a_chain_that_can_carry_no_more_ends_at_its_limit() -> None:
    """Followed by the program: w - w^2/2 carries at most 1/2, and a spring c = 1/2 gives way at w = 1 + c."""

    def residual(w, d):
        return np.array([w - w**2 / 2 + C * (w - d), C * (d - w)])

    at = pressed(residual, lambda w, d: np.array([[1 - w + C, -C], [-C, C]]), 1.0)
    limit = 1.5 + (1.5 - 1.5**2 / 2) / C
    points = list(follow(at, 0.0, [1.0, 4.0], ALGORITHMS["semismooth"](settle=1.0), ContactSolution.at_rest(2, 1)))
    assert [point.outcome for point in points] == [Outcome.CONVERGED, Outcome.GIVEN_UP]
    assert points[0].end is None
    end = points[1].end
    assert points[1].reached <= limit
    assert end.limit == pytest.approx(limit, abs=LIMIT * (4.0 - 1.0))
    assert str(points[1].solution.history[-1]["event"]).endswith(end.sentence)


def test_a_solver_that_fails_is_not_taken_for_the_end_of_the_path() -> None:
    states = [truss_state(w) for w in (-0.01, -0.05, -0.06, -0.07)]
    actual = why_it_ends(truss(), states)
    assert actual.sentence.startswith("no limit point: ")
    assert actual.limit is None


def test_two_states_tell_nothing() -> None:
    assert "too few" in why_it_ends(truss(), [truss_state(w) for w in (-0.1, -0.2)]).sentence


@pytest.mark.parametrize(("stiffness", "turns"), [(-1.0, True), (1.0, False)])
@pytest.mark.parametrize("epsilon", [np.inf, 10.0])
def test_a_path_turns_back_where_a_candidate_lifts_off_a_softening_body(stiffness, turns, epsilon) -> None:
    """-u = t - 1, u >= 0: p = 1 - t until t = 1, and u = 1 - t only before it; with u = t - 1 the path goes on."""

    def at(t: float) -> ContactProblem:
        K = sparse.csc_matrix([[stiffness]])
        G = sparse.csr_matrix([[1.0]])
        return ContactProblem(
            lambda u, memory: Linearisation(K @ u - (t - 1.0), K, 1.0), lambda u: G @ u, lambda u: G, np.ones(1)
        )

    def state(t: float) -> ContactSolution:
        u = (t - 1.0) / (stiffness + (0.0 if np.isinf(epsilon) else epsilon))
        return in_contact([0.0 if np.isinf(epsilon) else u], 1.0 - t if np.isinf(epsilon) else -epsilon * u)

    actual = why_it_ends(at, [(t, state(t)) for t in (0.0, 0.95, 0.97, 0.98)], epsilon)
    assert (actual.kind is PathEnd.LIMIT_POINT) == turns
    if turns:
        assert actual.limit == pytest.approx(1.0, rel=EXACT)
        assert "turns back where candidate 0 lifts off, 0 negative eigenvalues" in actual.sentence


def test_a_path_is_followed_through_a_bifurcation_and_the_history_says_so() -> None:
    """The upright link goes on, unstable, where its step was cut before; what has jumped is left out (below)."""

    class Startled:  # fails once, so that steps are cut
        epsilon, max_iterations, failed = np.inf, 40, False

        def solve(self, problem, start):
            solution = ALGORITHMS["semismooth"]().solve(problem, start)
            self.failed, failing = True, not self.failed
            return replace(solution, outcome=Outcome.ITERATION_LIMIT) if failing else solution

    (point,) = follow(link(), 0.0, [0.5], Startled(), in_contact([0.0, 0.0], 0.0), smallest=2.0**-6)
    assert point.outcome is Outcome.CONVERGED
    assert point.reached == 0.5
    assert point.solution.u == pytest.approx([0.0, 0.5], abs=EXACT)
    rows = [
        row for row in point.solution.history if EventKind.BIFURCATION & getattr(row.get("event"), "kind", EventKind(0))
    ]
    assert len(rows) == 1
    assert T_BUCKLING <= rows[0]["parameter"] <= T_BUCKLING + 2.0**-6
    assert "0.5 of the way with half the step" in str(rows[0]["event"])


@pytest.mark.slow
def test_a_state_beyond_the_path_is_no_state_of_it() -> None:
    """r = u - u^3/3 ends at u = 1, r = 2/3; above it Newton finds u < -2, where the tangent 1 - u^2 is negative.

    Beside it a spring that a load of 1 presses on a wall at 0.5.
    """

    def at(load: float) -> ContactProblem:
        def linearise(u, memory):
            residual = np.array([u[0] - u[0] ** 3 / 3 - load, u[1] - 1.0])
            return Linearisation(residual, sparse.csc_matrix(np.diag([1.0 - u[0] ** 2, 1.0])), 1.0)

        G = sparse.csr_matrix([[0.0, -1.0]])
        return ContactProblem(linearise, lambda u: 0.5 + G @ u, lambda u: G, np.ones(1))

    beyond = ALGORITHMS["semismooth"]().solve(at(0.8), in_contact([0.5, 0.5], 0.5))
    assert beyond.outcome is Outcome.CONVERGED  # must fail beside must pass: by itself it is an equilibrium
    assert beyond.u[0] < -2
    (point,) = follow(at, 0.0, [1.0], ALGORITHMS["semismooth"](), in_contact([0.0, 0.5], 0.5))
    assert point.outcome is Outcome.GIVEN_UP
    assert point.reached <= 2 / 3
    assert any("a state beyond the path" in str(row.get("event", "")) for row in point.solution.history)
    assert point.end.limit == pytest.approx(2 / 3, abs=1e-3)

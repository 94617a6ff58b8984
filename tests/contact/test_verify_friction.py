"""The judge of friction: the right answer passes, every wrong one is refused by the name of what it breaks."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from contact.coulomb import State
from contact.verify import judge
from contact.verify_friction import CHORD, CONE
from support.problems.frictional import Answer, balanced, in_units, manufactured

STATES = np.array([State.OPEN, State.OPEN, State.STICK, State.STICK, State.SLIP, State.SLIP])
OPEN, STICK, SLIP = 1, 3, 5  # the candidate that is spoilt
ROUNDING = 1e-12
SPRINGS = (0.1, 1e4)  # MPa/mm
UNITS = [(1.0, 1.0), (4.0**10, 1.0), (4.0**-10, 1.0), (1.0, 4.0**10), (4.0**10, 4.0**-10)]  # a factor of 1.0e6


def made(seed: int = 3):
    return manufactured(np.random.default_rng(seed), len(STATES), STATES)


def with_energy(step):
    """Its problem with the energy that a frozen step does not state."""
    return replace(step.problem(), energy=lambda u: float(u @ (step.K @ u / 2 + step.r)))


def judged(step, answer, **options):
    return judge(with_energy(step), answer.u, answer.normal, answer.friction, **options)


def turned(t: np.ndarray, degrees: float) -> np.ndarray:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return t @ np.array([[c, s], [-s, c]])


def test_the_right_answer_passes() -> None:
    for seed in range(30):
        rng = np.random.default_rng(seed)
        verdict = judged(*manufactured(rng, int(rng.integers(1, 8))))
        assert verdict.failures() == []
        assert max(verdict.kkt.values()) <= ROUNDING / CHORD  # a direction known to ROUNDING
        assert verdict.balances["work"] <= ROUNDING
        assert verdict.certificate["failures"] == []


# --- one candidate spoilt, and the load changed so that forces balance all the same: the law alone is broken ----------


def friction_of(which: int, change):
    def spoil(step, answer):
        friction = answer.friction.copy()
        friction[which] = change(friction[which], step.mu[which] * answer.normal[which])
        return step, replace(answer, friction=friction)

    return spoil


def slip_of(which, by: float):
    """The slip told from another anchor, so far away in mm along the first tangent."""

    def spoil(step, answer):
        slip = step.slip.copy()
        slip[which, 0] += by
        return replace(step, slip=slip), answer

    return spoil


MUTANTS = {
    "wrong sign": (friction_of(SLIP, lambda t, bound: -t), {"direction", "generated"}),
    "wrong sign everywhere": (lambda s, a: (s, replace(a, friction=-a.friction)), {"direction", "generated"}),
    "mu twice": (friction_of(SLIP, lambda t, bound: 2 * t), {"cone"}),
    "mu forgotten": (friction_of(SLIP, lambda t, bound: 0 * t), {"stick"}),
    "slightly outside the cone": (friction_of(SLIP, lambda t, bound: (1 + 1e-6) * t), {"cone"}),
    "slightly inside the cone": (friction_of(SLIP, lambda t, bound: (1 - 1e-6) * t), {"stick"}),
    "stuck beyond the cone": (friction_of(STICK, lambda t, bound: (1 + 1e-6) * bound * np.array([0.6, 0.8])), {"cone"}),
    "a degree off": (friction_of(SLIP, lambda t, bound: turned(t, 1.0)), {"direction"}),
    "a thousandth of a degree off": (friction_of(SLIP, lambda t, bound: turned(t, 1e-3)), {"direction"}),
    "on an open candidate": (friction_of(OPEN, lambda t, bound: np.array([1e-6, 0.0])), {"cone", "open"}),
    "stick that drifts": (slip_of(STICK, 1e-8), {"stick"}),
    "an anchor beside a slip": (slip_of(SLIP, 1e-2), {"direction"}),
    "all anchors shifted": (slip_of(slice(None), 1e-2), {"stick", "direction"}),
    "not a number": (friction_of(SLIP, lambda t, bound: math.nan * t), {"cone", "equilibrium"}),
}


def test_a_broken_law_is_named_in_any_units() -> None:
    for (spoil, names), (length, force) in product(MUTANTS.values(), UNITS):
        step, answer = spoil(*made())
        if not np.isnan(answer.friction).any():
            step = balanced(step, answer)
        there = Answer(length * answer.u, force * answer.normal, force * answer.friction, answer.state)
        failures = set(judged(in_units(step, length, force), there).failures())
        if np.isnan(answer.friction).any():
            assert names <= failures
        else:
            assert failures == names


def on_springs(step, answer, epsilon):
    """The step whose gaps and slips have given way under the answer, so that it obeys the law of that epsilon."""
    gap = step.gap - answer.normal / epsilon
    return replace(step, slip=step.slip - answer.friction / epsilon, gap=gap)


def test_a_broken_law_is_named_on_springs() -> None:
    for (spoil, names), epsilon in product(MUTANTS.values(), SPRINGS):
        step, answer = spoil(*made())
        if np.isnan(answer.friction).any():
            assert names <= set(judged(on_springs(step, answer, epsilon), answer, epsilon=epsilon).failures())
        else:
            sprung = on_springs(balanced(step, answer), answer, epsilon)
            assert set(judged(sprung, answer, epsilon=epsilon).failures()) == names


def test_springs_are_judged_with_their_epsilon_alone() -> None:
    for epsilon in SPRINGS:
        step, answer = made()
        sprung = on_springs(step, answer, epsilon)
        assert judged(sprung, answer, epsilon=epsilon).failures() == []
        for other in (1.01 * epsilon, math.inf):
            assert {"complementarity", "stick"} <= set(judged(sprung, answer, epsilon=other).failures())
        assert {"complementarity", "stick"} <= set(judged(step, answer, epsilon=epsilon).failures())


def test_units_change_no_residual() -> None:
    for length, force in UNITS:
        step, answer = made()
        spoilt = replace(answer, friction=1.1 * answer.friction)
        there = Answer(length * spoilt.u, force * spoilt.normal, force * spoilt.friction, spoilt.state)
        at_home, abroad = judged(step, spoilt), judged(in_units(step, length, force), there)
        assert abroad.law.by_name == pytest.approx(at_home.law.by_name, rel=1e-9)
        assert abroad.failures() == at_home.failures()
        assert abroad.law.length == pytest.approx(length * at_home.law.length)
        assert judged(in_units(step, length, force), replace(there, friction=there.friction / 1.1)).failures() == []


def test_forces_out_of_balance_are_named() -> None:
    step, answer = made()
    for spoilt in (
        replace(answer, friction=-answer.friction),
        replace(answer, friction=(1 + 1e-6) * answer.friction),
        replace(answer, normal=(1 + 1e-6) * answer.normal),
        replace(answer, u=answer.u + 1e-6),
    ):
        assert "equilibrium" in judged(step, spoilt).failures()


def test_contact_is_judged_as_without_friction() -> None:
    step, answer = made()
    shifted = replace(step, gap=step.gap - 1e-6)
    assert "penetration" in judged(shifted, answer).failures()
    shifted = replace(step, gap=step.gap + 1e-6)
    assert "complementarity" in judged(shifted, answer).failures()
    pulling = replace(answer, normal=np.where(answer.state == State.OPEN, -1e-9, answer.normal))
    assert "tension" in judged(step, pulling).failures()
    smooth = replace(step, mu=0 * step.mu)
    rubbed = judged(balanced(smooth, alone := replace(answer, friction=0 * answer.friction)), alone)
    contact = judge(replace(balanced(smooth, alone).problem(), coulomb=None), alone.u, alone.normal)
    assert rubbed.failures() == contact.failures() == []
    assert rubbed.kkt | contact.kkt == rubbed.kkt


def test_an_infinite_coefficient_ties() -> None:
    step, answer = manufactured(np.random.default_rng(1), 4, np.array([0, 1, 1, 1]))
    tied = replace(step, mu=np.full(4, math.inf))
    assert judged(tied, answer).failures() == []
    far = slip_of(2, 1e-8)(tied, answer)
    assert judged(*far).failures() == ["stick"]


@pytest.mark.parametrize("share", [0.3, 30.0])
def test_bounds_are_where_they_are_said_to_be(share) -> None:
    """Friction beyond its disc by a share of CONE, and slips shorter than can be told, are none."""
    step, answer = made()
    largest = max(answer.normal.max(), np.linalg.norm(answer.friction, axis=1).max())
    beyond = friction_of(SLIP, lambda t, bound: t * (1 + share * CONE * largest / np.linalg.norm(t)))(step, answer)
    assert ("cone" in judged(*beyond).failures()) == (share > 1)
    degrees = math.degrees(share * CHORD)
    off = friction_of(SLIP, lambda t, bound: turned(t, degrees))(step, answer)
    assert ("direction" in judged(*off).failures()) == (share > 1)
    length = judged(step, answer).law.length
    assert ("stick" in judged(*slip_of(STICK, share * 2e-12 * length)(step, answer)).failures()) == (share > 1)


def test_forces_that_do_not_fit_are_refused() -> None:
    step, answer = made()
    with pytest.raises(ValueError, match="candidates"):
        judge(step.problem(), answer.u, answer.normal[:-1], answer.friction)
    with pytest.raises(ValueError, match="candidates"):
        judge(step.problem(), answer.u, answer.normal, answer.friction.ravel())


# --- work -------------------------------------------------------------------------------------------------------------


def test_a_slip_that_is_not_what_its_derivative_says_upsets_the_balance_of_work() -> None:
    step, answer = made()
    problem = with_energy(step)
    law = replace(problem.coulomb, slip=lambda u: step.slip + 1.001 * (step.S @ u).reshape(-1, 2))
    longer = replace(problem, coulomb=law)
    assert "work" in judge(longer, answer.u, answer.normal, answer.friction).failures()
    energy = problem.energy
    stiffer = replace(problem, energy=lambda u: 1.001 * energy(u))
    assert judge(stiffer, answer.u, answer.normal, answer.friction).failures() == ["work"]


def test_work_of_one_step_is_balanced_from_any_state(rng) -> None:
    step, answer = made()
    since = answer.u + rng.normal(size=len(answer.u))
    assert judged(step, answer, since=since).failures() == []
    assert "work" not in judge(step.problem(), answer.u, answer.normal, answer.friction).balances

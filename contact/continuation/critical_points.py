"""Why a path of contact problems ends: what its tangent says, on the motions that the contact set leaves free.

The tangent K at a state u(t) has the eigenvalues mu of least size and their modes phi, see
:mod:`contact.continuation.spectrum`. With v = du/dt and f = phi.K v, the work of the rate of load on a mode,
phi.v = f/mu but for the part that the foundation prescribes. So, where a mu -> 0::

    limit point    f stays:    v grows like 1/mu and turns into phi;  mu^2 falls linearly in t, and is zero where the
                               path turns back
    bifurcation    f -> 0:     v has no more to do with phi than before, often nothing, and the path passes

A path also turns back where the contact set changes, with a regular tangent on both sets: where its sense, the sign of
det K on what a set leaves free, is not the same on both, that is where their numbers of negative eigenvalues differ.

Several modes are looked at because a bifurcation may hide the limit point that follows: with the path near its limit
everything goes like the square root, and the eigenvalue of least size need not be that of the path.
Sources: Wriggers, Simo, Int. J. Numer. Meth. Engng 30 (1990) 155-176; Seydel, Practical Bifurcation and Stability
Analysis (2010), chapter 5; piecewise smooth paths: Kojima, Saigal, Math. Programming 21 (1981) 300-318. No algorithm
may enter here.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from contact.continuation.candidates import State
from contact.continuation.spectrum import Spectrum, cosines, negative_eigenvalues, spectrum
from contact.events import Ending, PathEnd
from contact.problem import ContactProblem
from contact.solvers.sparse import SingularMatrixError

NEAR = 0.1  # of the way from the first state: a limit point further ahead is not why the path ends
NEARLY_SINGULAR = 0.3  # of the eigenvalue at the first state: what is left at NEAR by the law of a limit point
ALONG = 0.1  # cosine of path and mode below which the path has no part in it
SAME_MODE = 0.7  # cosine of two modes that are one
FOLD_LAW = 0.5  # half-way between the exponents of the speed along the mode at a bifurcation, 0, and at a fold, 1


def why_it_ends(
    problem_at: Callable[[float], ContactProblem], states: Sequence[State], epsilon: float = np.inf
) -> Ending:
    """The verdict on the last of the converged ``states`` (parameter, solution), in order; the first is the yardstick.

    Four are best: the yardstick and three near the end, two secants to see the law by.
    """
    if len(states) < 3:
        t, state = states[-1]
        unstable = negative_eigenvalues(problem_at(t), state, epsilon)
        since = f": {_many(unstable)} negative at {t + 0.0:g}" if unstable else ""
        return Ending(PathEnd.NEITHER, f"too few converged steps to tell why{since}")
    try:
        spectra = [spectrum(problem_at(t), state, epsilon) for t, state in states]
    except (SingularMatrixError, ValueError) as error:
        return Ending(PathEnd.NEITHER, f"the tangent gives no reason: {error}")
    (first, _), (last, _) = states[0], states[-1]
    free = all(len(each.eigenvalues) for each in spectra)
    limit = _limit_point(states, spectra) if free else None
    passed = _passed(first, spectra)
    if limit is not None:
        at, signs, mode = limit
        return Ending(PathEnd.LIMIT_POINT, f"limit point of the path at about {at:.7g}: {signs}{passed}", at, mode)
    turned = _turned_at_a_change(problem_at, states, epsilon)
    if turned is not None:
        return turned
    if not free:
        return Ending(PathEnd.NEITHER, "no limit point: nothing is free to move")
    least, before = (abs(each.eigenvalues[0]) for each in (spectra[-1], spectra[0]))
    how_small = f"the eigenvalue of least magnitude is {100 * least / before:.3g} % of that at {first + 0.0:g}"
    if least <= NEARLY_SINGULAR * before:
        sentence = f"bifurcation near {last:.7g}: {how_small}, and the path does not speed up along its mode{passed}"
        return Ending(PathEnd.BIFURCATION, sentence)
    sentence = f"no limit point: {how_small}{passed}; the solver fails, and the tangent gives no reason"
    return Ending(PathEnd.NEITHER, sentence)


def _limit_point(states: Sequence[State], spectra: Sequence[Spectrum]) -> tuple[float, str, np.ndarray] | None:
    """Parameter, signs and mode of the limit point just ahead, or None.

    Mode, speed and eigenvalue must all three behave as at a fold. Its mode is the one along which the path accelerates.
    The secant of a parabola between two states is f over the mean of their mu, which says how much faster the last
    secant must be than the one before.
    """
    (t0, a), (t1, b), (t2, c) = states[-3:]
    before, after = (b.u - a.u) / (t1 - t0), (c.u - b.u) / (t2 - t1)
    mode = spectra[-1].modes[:, int(np.argmax(np.abs((after - before) @ spectra[-1].modes)))]
    mu, likeness = np.array([each.like(mode) for each in spectra[-3:]]).T
    cosine = float(cosines(after, mode[:, None])[0])
    if cosine < ALONG or likeness.min() < SAME_MODE or not 0 < mu[2] / mu[1] < 1:
        return None
    expected = (mu[0] + mu[1]) / (mu[1] + mu[2])
    if not abs(mode @ after) >= abs(mode @ before) * expected**FOLD_LAW:
        return None
    limit = t2 + (t2 - t1) * mu[2] ** 2 / (mu[1] ** 2 - mu[2] ** 2)  # where mu^2, linear by the last two, is zero
    if not abs(limit - t2) <= NEAR * abs(t2 - states[0][0]):
        return None
    falls = f"falls to zero like a square root, from {mu[0]:.3g} to {mu[2]:.3g} N/mm in the last {abs(t2 - t0):.2g}"
    message = f"an eigenvalue of the tangent {falls}, and the path speeds up along its mode (cosine {cosine:.2f})"
    return float(limit), message, mode


def _passed(first: float, spectra: Sequence[Spectrum]) -> str:
    """What the number of negative eigenvalues adds."""
    before, now = spectra[0].negative, spectra[-1].negative
    if not now or before is None:
        return ""
    return f"; {_many(now)} negative, {before or 'none'} at {first + 0.0:g}" + (
        ": it has passed branches" if now > before else ""
    )


def _many(negative: int) -> str:
    return f"{negative} eigenvalues are" if negative > 1 else "1 eigenvalue is"


def _turned_at_a_change(
    problem_at: Callable[[float], ContactProblem], states: Sequence[State], epsilon: float
) -> Ending | None:
    """The limit point where a candidate just ahead lifts off or touches, if the path turns back there.

    Pressures of the set and gaps out of it are continued along the last secant.
    """
    (t0, before), (t1, last) = states[-2:]
    same = before.active == last.active
    left, since = (
        np.where(last.active, state.pressure, problem_at(t).gap(state.u)) for t, state in ((t1, last), (t0, before))
    )
    rate = (left - since) / (t1 - t0)
    falling = same & (rate * (t1 - t0) < 0)
    if not falling.any():
        return None
    ahead = np.where(falling, np.maximum(left, 0.0) / np.where(falling, np.abs(rate), 1.0), np.inf)
    changes = int(np.argmin(ahead))
    if ahead[changes] > NEAR * abs(t1 - states[0][0]):
        return None
    changed = last.active.copy()
    changed[changes] ^= True
    counts = [negative_eigenvalues(problem_at(t1), replace(last, active=a), epsilon) for a in (last.active, changed)]
    if None in counts or counts[0] == counts[1]:
        return None
    limit = float(t1 + np.copysign(ahead[changes], t1 - t0))
    does = "lifts off" if last.active[changes] else "touches"
    message = f"limit point of the path at about {limit:.7g}: it turns back where candidate {changes} {does}, "
    message += f"{counts[0]} negative eigenvalues of the tangent before and {counts[1]} after it"
    return Ending(
        PathEnd.LIMIT_POINT, message, limit, (last.u - before.u) / (float(np.linalg.norm(last.u - before.u)) or 1.0)
    )


def branches_passed(problem_at: Callable[[float], ContactProblem], before: State, after: State, epsilon: float) -> int:
    """How many more eigenvalues of the tangent are negative after than before; 0 where that cannot be told.

    A large step may find an equilibrium beyond the end of its path, which is not stable where the path was.
    """
    counts = [negative_eigenvalues(problem_at(t), state, epsilon) for t, state in (before, after)]
    return max(0, counts[1] - counts[0]) if counts[0] is not None and counts[1] is not None else 0

"""What spoilt a contact answer: the corruption that explains its residuals, by name, from raw fields alone.

The forces that the mechanics asks of the foundation are worked out first, by least squares on the candidates that carry
or are closed: r(u) = G^T W q + rest. What the pressures p and the gaps have to do with q tells one mistake from
another::

    rest > 0,  no q, |rest| = |G^T W p|       swapped face          the forces act on other unknowns of the same size
    rest > 0   otherwise                      unconverged equilibrium
    p = -q                                    sign flip
    p = W q  or  W p = q                      missing weight        nodal forces for pressures, or the area twice
    p = c q,  one c for all                   wrong units           c is given
    p = q  but at one node, or at two         one wrong node        numbers are given
    p no multiple of q                        stale pressure        u is in equilibrium, under other pressures
    p = q, one gap at all carrying nodes      shifted gap           it is given
    |rest| as large as the rounding of u's    last digit            what it still asks for is given

Where several fit, the first is named; where none fits, the violated conditions are. A missing weight with equal areas
looks like a unit, and an equilibrium that is only wrong at closed nodes like stale pressures.
"""

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import lsqr

from contact.problem import ContactProblem
from contact.verify import ROUNDING_ALONE, judge

SWAPPED_FACE = "swapped face"
UNCONVERGED = "unconverged equilibrium"
SIGN_FLIP = "sign flip"
MISSING_WEIGHT = "missing weight"
WRONG_UNITS = "wrong units"
ONE_WRONG_NODE = "one wrong node"
STALE_PRESSURE = "stale pressure"
SHIFTED_GAP = "shifted gap"
LAST_DIGIT = "last digit"  # no corruption: the answer is as good as its numbers, and that is not good enough
CORRUPTIONS = (
    *(SWAPPED_FACE, UNCONVERGED, SIGN_FLIP, MISSING_WEIGHT, WRONG_UNITS, ONE_WRONG_NODE, STALE_PRESSURE, SHIFTED_GAP),
)

ALIKE = 1e-6  # relative difference of two forces, pressures or gaps that counts as none


def diagnose(problem: ContactProblem, u: np.ndarray, pressure: np.ndarray, *, epsilon: float = np.inf) -> list[str]:
    """Nothing for a sound answer; else one line a finding, "name: detail", see above.

    epsilon: as for :func:`contact.verify.judge`. Raises ValueError when the pressures do not fit the candidates.
    """
    verdict = judge(problem, u, pressure, epsilon=epsilon)
    failed = verdict.failures()
    if not failed:
        return []
    violated = f"violated: {', '.join(failed)}"
    if not (np.all(np.isfinite(pressure)) and np.all(np.isfinite(u)) and np.isfinite(verdict.equilibrium)):
        return [f"not a number in the answer; {violated}"]
    if failed == ["equilibrium"] and np.isfinite(verdict.correction):
        return [
            f"{LAST_DIGIT}: the rounding of u leaves {verdict.equilibrium:.1e} of the forces out of balance, "
            f"which still asks for {verdict.correction:.1e} of all displacement"
        ]
    lin = problem.linearise(u, None)
    gap = problem.gap(u) if np.isinf(epsilon) else problem.gap(u) + pressure / epsilon
    closed = verdict.gap_bound()
    asked, rest = _asked(problem, u, lin.residual, (pressure != 0) | (gap <= closed))
    scale = max(lin.scale, float(np.linalg.norm(problem.contact_force(u, pressure)))) or 1.0
    tolerance = max(1e-8, min(verdict.rounding, ROUNDING_ALONE))
    if float(np.linalg.norm(rest)) > tolerance * scale:
        return [_rest_named(problem, u, pressure, lin.residual, rest, scale)]
    named = _pressure_named(problem, pressure, asked) if "equilibrium" in failed else ""
    shift = _shift(gap[asked > ALIKE * np.max(np.abs(asked), initial=0.0)], closed)
    findings = [named, shift if {"penetration", "complementarity"} & set(failed) else ""]
    return [finding for finding in findings if finding] or [violated]


def _asked(
    problem: ContactProblem, u: np.ndarray, residual: np.ndarray, may_carry: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Pressures q (m,) that balance r best, zero where a candidate may not carry, and what they leave of it (n,)."""
    push = sparse.csc_matrix(problem.gap_jacobian(u).T @ problem.weight_matrix)[:, np.flatnonzero(may_carry)]
    q = np.zeros(len(may_carry))
    if push.shape[1]:
        size = np.sqrt(np.asarray(push.multiply(push).sum(axis=0)).ravel())
        size[size == 0] = 1.0
        unit = push @ sparse.diags_array(1 / size)
        y = np.zeros(push.shape[1])
        for _ in range(2):  # the second corrects what the stopping of the first has left
            y += lsqr(unit, residual - unit @ y, atol=1e-15, btol=1e-15, iter_lim=20 * push.shape[1])[0]
        q[may_carry] = y / size
    return q, residual - problem.contact_force(u, q)


def _rest_named(
    problem: ContactProblem, u: np.ndarray, pressure: np.ndarray, r: np.ndarray, rest: np.ndarray, scale: float
) -> str:
    """Forces that no pressure of these candidates can balance."""
    push, left = float(np.linalg.norm(problem.contact_force(u, pressure))), float(np.linalg.norm(rest))
    reached = float(np.linalg.norm(r - rest))
    if reached <= ALIKE * left and abs(push - left) <= ALIKE * push:
        return f"{SWAPPED_FACE}: the forces in balance are {left:.6g} N on unknowns that no candidate touches"
    return f"{UNCONVERGED}: a part {left / scale:.2e} of the forces has no pressure to balance it"


def _pressure_named(problem: ContactProblem, p: np.ndarray, q: np.ndarray) -> str:
    """How the pressures p differ from those the mechanics asks for."""
    if _alike(-p, q):
        return f"{SIGN_FLIP}: the pressures balance with the other sign"
    if _alike(p, problem.nodal_forces(q)):
        return f"{MISSING_WEIGHT}: the pressures are the nodal forces"
    if _alike(problem.nodal_forces(p), q):
        return f"{MISSING_WEIGHT}: the pressures are divided by the areas twice"
    wrong = np.flatnonzero(np.abs(p - q) > ALIKE * np.max(np.abs(q), initial=0.0))
    carrying = int(np.sum(np.abs(q) > ALIKE * np.max(np.abs(q), initial=0.0)))
    factor = float(p @ q) / (float(q @ q) or 1.0)
    if factor > 0 and carrying > 1 and _alike(p, factor * q):
        return f"{WRONG_UNITS}: the pressures are {factor:.6g} times those that balance"
    if 1 <= len(wrong) <= 2 and carrying > len(wrong):
        return f"{ONE_WRONG_NODE}: candidate {' and '.join(map(str, wrong))} of {carrying} under pressure"
    return f"{STALE_PRESSURE}: u is in equilibrium, but under other pressures at {len(wrong)} candidates"


def _shift(gap: np.ndarray, closed: float) -> str:
    """The gap that all carrying candidates share, one above ``closed`` [mm]."""
    if not len(gap) or not np.max(np.abs(gap)) > closed:
        return ""
    middle = float(np.mean(gap))
    if np.ptp(gap) > max(ALIKE * abs(middle), closed):
        return ""
    return f"{SHIFTED_GAP}: the foundation is {middle:.6g} mm off where it carries"


def _alike(a: np.ndarray, b: np.ndarray) -> bool:
    return bool(np.linalg.norm(a - b) <= ALIKE * max(float(np.linalg.norm(b)), np.finfo(float).tiny))

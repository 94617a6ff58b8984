"""The balances of a contact answer: work against the change of energy, and all forces on the body; the judge's.

No algorithm may enter here.
"""

from functools import cache

import numpy as np

from contact.problem import ContactProblem, Faces, Linearised

BALANCE = 1e-8
_INNER = float(np.sqrt(3 / 7)) / 2
PANELS = (1, 2, 4, 8, 16)
SAME = 1e-12  # sines squared between normals of planes that are one
UNRESOLVED = 0.5  # change of a mismatch with the panels, over it: of the rule then, and not of the answer
SIMPSON = ((0.0, 1 / 6), (0.5, 2 / 3), (1.0, 1 / 6))
LOBATTO = ((0.0, 1 / 20), (0.5 - _INNER, 49 / 180), (0.5, 16 / 45), (0.5 + _INNER, 49 / 180), (1.0, 1 / 20))


def last_digits(lin: Linearised, u: np.ndarray, forces: float = 0.0) -> float:
    """Size [N] that rounding alone gives the residual at u: machine epsilon times | |K| |u| | and ``forces`` [N]."""
    return float(np.finfo(float).eps * (np.linalg.norm(abs(lin.tangent) @ np.abs(u)) + forces))


def energy_balance(
    problem: ContactProblem, since: np.ndarray, u: np.ndarray, contact: np.ndarray, at_end: Linearised
) -> tuple[float | None, float]:
    """Change of the potential less the work of the forces on the straight way from a to u, relative, and its rounding.

    P(u) - P(a) = int r.du by Simpson's rule, the last point of which is u: there the force is taken from the pressures,
    not from r. Exact up to the fourth degree of P, which strains quadratic in u make. Others may need Lobatto's rule
    with five points, up to the eighth, and more panels: a mismatch of the rule changes with them, one of the answer
    does not. Where the rule resolves no way, as through elements that turn inside out, there is no balance to tell.
    Relative to the largest part, but to no less than forces known to their last digit can tell: where nothing moves but
    by rounding, a frozen step at its own answer, there is no work to balance.
    """
    if problem.energy is None:
        return None, 0.0
    du = u - since
    forces = max(at_end.scale, float(np.linalg.norm(contact)))
    last_digit = float(np.finfo(float).eps) * forces * float(np.linalg.norm(du))
    ends = [problem.energy(u), -problem.energy(since)]
    # what the pressures say less what the model says, with the same weight whatever the rule and the panels
    refined = LOBATTO[-1][1] * float((contact - at_end.residual) @ du)
    noise = last_digits(at_end, u) * float(np.linalg.norm(du))

    @cache
    def power(t: float) -> float:
        if t == 1.0:
            return float(at_end.residual @ du)
        at = since + t * du
        residual = problem.linearise(at, None).residual if problem.residual is None else problem.residual(at)
        return float(residual @ du)

    mismatches = []
    for rule, panels in ((SIMPSON, 1), *((LOBATTO, panels) for panels in PANELS)):
        works = [weight / panels * power((panel + t) / panels) for panel in range(panels) for t, weight in rule]
        size = max(sum(map(abs, works + ends)), last_digit / BALANCE) or 1.0
        mismatches.append(abs(sum(ends) - sum(works) - refined) / size)
        if mismatches[-1] <= BALANCE:
            return mismatches[-1], noise / size
    unresolved = np.ptp(mismatches[-3:]) >= UNRESOLVED * mismatches[-1]
    return None if unresolved else mismatches[-1], noise / size


def force_balance(
    problem: ContactProblem, lin: Linearised, u: np.ndarray, pressure: np.ndarray
) -> tuple[float | None, float]:
    """Relative mismatch of all forces on the body, and its rounding: errors of a sum add up, so eps sum |K||u|."""
    if problem.directions is None or problem.others is None:
        return None, 0.0
    nodal = problem.nodal_forces(pressure)
    size = max(lin.scale, float(np.sum(np.abs(nodal)))) or 1.0
    noise = float(np.finfo(float).eps * np.sum(abs(lin.tangent) @ np.abs(u)))
    return float(np.linalg.norm(nodal @ problem.directions(u) + problem.others(u))) / size, noise / size


def pair_balance(problem: ContactProblem, u: np.ndarray, pressure: np.ndarray) -> tuple[float | None, float | None]:
    """Resultant of the forces of two faces on each other over their sum, and their moment over that times their size.

    Both are zero where the forces come from a gap that no rigid motion of both changes. A plane of symmetry that it
    knows of stays where it is, and carries moments but for that about its normal, the one looked at; planes that cross
    carry all, and there is none. Of several pairs that of the worst one, each by itself. None before a foundation.
    """
    if problem.faces is None:
        return None, None
    nodal = problem.nodal_forces(pressure)
    sums = [_of_pair(faces, u, nodal[own]) for faces, own in problem.faces.parts]
    moments = [moment for _, moment in sums if moment is not None]
    return float(np.max([force for force, _ in sums])), float(np.max(moments)) if moments else None


def _of_pair(faces: Faces, u: np.ndarray, nodal: np.ndarray) -> tuple[float, float | None]:
    forces, x = faces.forces(u, nodal), faces.positions(u)
    arm = x - x.mean(axis=0)
    size = float(np.sum(np.linalg.norm(forces, axis=1))) or 1.0
    length = float(np.max(np.linalg.norm(arm, axis=1), initial=0.0)) or 1.0
    left, moment = _left_by(faces.mirrors), np.cross(arm, forces).sum(axis=0)
    turned = None if left is None else float(np.linalg.norm(left @ moment)) / (size * length)
    return float(np.linalg.norm(forces.sum(axis=0))) / size, turned


def _left_by(mirrors: np.ndarray) -> np.ndarray | None:
    """The projection (3, 3) on the axes that rotate planes with the normals (r, 3) into themselves, if any."""
    if not len(mirrors):
        return np.eye(3)
    sizes, axes = np.linalg.eigh(mirrors.T @ mirrors)
    return np.outer(axes[:, 2], axes[:, 2]) if sizes[1] <= SAME * sizes[2] else None

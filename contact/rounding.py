"""What algorithms take for rounding: how far from balance forces may be that no digit of u can bring nearer.

The judge has bounds of its own (:mod:`contact.verify`) and imports none of these. No algorithm may enter here.
"""

import numpy as np

from contact.problem import Linearised

ROUNDING_ALONE = 1e-6  # relative residual up to which rounding is an excuse by itself
WORST_ROUNDING = 1e-2  # up to which it is one if it moves nothing, and beyond which it never is
SLIGHT = 1e-5  # forces of the foundation below this share of those in balance must be met themselves
NEGLIGIBLE = 1e-9  # of all displacement: what a residual may still ask for that moves nothing


def rounding_floor(lin: Linearised, u: np.ndarray, forces: float = 0.0) -> float:
    """Size [N] that rounding alone gives the residual at u: machine epsilon times | |K| |u| | and ``forces`` [N].

    Thin shells reach it long before 1e-9 of the load (measured: residuals stagnate at 0.1 to 0.2 of this estimate). Of
    a few unknowns the last digit of the loads, the forces in balance, is as large.
    """
    return float(np.finfo(float).eps * (np.linalg.norm(abs(lin.tangent) @ np.abs(u)) + forces))


def excused(residual: float, rounding: float, correction: float) -> bool:
    """True when a relative residual is rounding and does not matter.

    In face displacements rounding makes pairs of forces across the thickness, of the size eps E l^2 |u|/h, that move
    nothing: a plate 300 times thinner than it is lifted keeps a residual of 1e-5, a strip twisted by 90 degrees and
    3,750 times as long as it is thick one of 6e-3, and both are right to 1e-9 and better (measured).
    """
    harmless = residual <= WORST_ROUNDING and correction <= NEGLIGIBLE
    return residual <= rounding and (residual <= ROUNDING_ALONE or harmless)


def met(tolerance: float, push: float, rounding: float) -> float:
    """The relative residual that ``tolerance`` asks for, where the foundation's own share of the forces is ``push``.

    A foundation that has only just come carries next to nothing of an inflated body: what balances to 1e-9 of all
    forces may have its force all wrong. So its share counts below SLIGHT, down to what is ``rounding``.
    """
    slight = tolerance * min(1.0, push / SLIGHT) if push > 0 else tolerance
    return max(slight, min(rounding, tolerance))


def decides(residual: float, rounding: float) -> bool:
    """True when a relative residual is excused or not by its correction alone."""
    return ROUNDING_ALONE < residual <= min(rounding, WORST_ROUNDING)

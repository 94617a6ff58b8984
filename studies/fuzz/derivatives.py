"""Derivatives of a contact problem against central differences, at a state: each an independent statement of the next.

The gap against its jacobian, the jacobian against its curvature, the residual against its tangent, the energy against
the residual. A difference must fall with its step, c t^2 down to rounding: the least of several steps is taken.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contact.problem import ContactProblem

STEPS = (1e-3, 1e-5)
BOUND = 1e-4  # relative; a wrong term, wherever it matters, is of the order of one


def mismatches(problem: ContactProblem, u: np.ndarray, p: np.ndarray, rng: np.random.Generator) -> dict[str, float]:
    """Relative mismatch of each derivative along a random direction; only those above BOUND."""
    size = float(np.max(np.abs(u), initial=0.0))
    if size == 0.0 or not len(u):
        return {}
    v = rng.normal(size=len(u)) * size / np.sqrt(len(u))
    lin, force = problem.linearise(u, None), problem.nodal_forces(p)
    alone = problem.residual or (lambda x: problem.linearise(x, None).residual)
    found = {"tangent": _apart(alone, lin.tangent @ v, u, v, lin.scale)}
    if len(p):
        G = problem.gap_jacobian(u)
        found["gap jacobian"] = _apart(problem.gap, G @ v, u, v, float(np.max(np.abs(G @ v))))
        bent = 0 * v if problem.gap_curvature is None else problem.gap_curvature(u, force) @ v
        pushed = float(np.linalg.norm(G.T @ force))
        if pushed > 0:
            found["gap curvature"] = _apart(lambda x: problem.gap_jacobian(x).T @ force, bent, u, v, pushed * 1e-3)
    return {name: value for name, value in found.items() if not value <= BOUND}


def _apart(
    f: Callable[[np.ndarray], np.ndarray], slope: np.ndarray, u: np.ndarray, v: np.ndarray, least: float
) -> float:
    """The least mismatch of all steps, over the slope or what stands for it where that vanishes."""
    size = max(float(np.linalg.norm(slope)), least) or 1.0
    each = [float(np.linalg.norm((f(u + t * v) - f(u - t * v)) / (2 * t) - slope)) / size for t in STEPS]
    return min(each) if np.all(np.isfinite(each)) else float("nan")

"""Derivatives of a contact problem against central differences, at a state: each an independent statement of the next.

The gap against its jacobian, the jacobian against its curvature, the residual against its tangent. A difference must
fall with its step, c t^2 down to rounding: the least of several steps is taken, and steps are so small that no force
changes by more than a thousandth of the forces in balance. What rounding may do to a difference is allowed beside it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.problem import ContactProblem
from contact.rounding import rounding_floor

STEPS = (1e-3, 1e-5)
BOUND = 1e-4  # relative; a wrong term, wherever it matters, is of the order of one
ROUNDING = 10.0  # times machine precision of the terms that a difference is made of


def mismatches(problem: ContactProblem, u: np.ndarray, p: np.ndarray, rng: np.random.Generator) -> dict[str, float]:
    """Relative mismatch of each derivative along a random direction; only those above BOUND and rounding."""
    size = float(np.max(np.abs(u), initial=0.0))
    if size == 0.0 or not len(u):
        return {}
    lin, force = problem.linearise(u, None), problem.nodal_forces(p)
    v = rng.normal(size=len(u)) * size / np.sqrt(len(u))
    v *= min(1.0, lin.scale / (float(np.linalg.norm(lin.tangent @ v)) or 1.0))  # elements may be slivers
    alone = problem.residual or (lambda x: problem.linearise(x, None).residual)
    checks = {"tangent": Difference(alone, lin.tangent @ v, 0.0, rounding_floor(lin, u))}
    if len(p):
        G, eps = problem.gap_jacobian(u), float(np.finfo(float).eps)
        gaps = (problem.gap_size + float(np.max(np.abs(problem.gap(u)) + abs(G) @ np.abs(u)))) * np.sqrt(len(p))
        checks["gap jacobian"] = Difference(problem.gap, G @ v, 0.0, eps * gaps)
        bent = 0 * v if problem.gap_curvature is None else problem.gap_curvature(u, force) @ v
        pushed = float(np.linalg.norm(G.T @ force))
        if pushed > 0:
            checks["gap curvature"] = Difference(
                lambda x: problem.gap_jacobian(x).T @ force, bent, pushed * 1e-3, eps * pushed
            )
    found = {name: check.excess(u, v) for name, check in checks.items()}
    return {name: value for name, value in found.items() if not value <= BOUND}


@dataclass(frozen=True, eq=False)
class Difference:
    """f and its slope along v; least: what stands for the slope where it vanishes; rounding: of f."""

    f: Callable[[np.ndarray], np.ndarray]
    slope: np.ndarray
    least: float
    rounding: float

    def excess(self, u: np.ndarray, v: np.ndarray) -> float:
        """The least relative mismatch of all steps, less what rounding explains of it."""
        size = max(float(np.linalg.norm(self.slope)), self.least) or 1.0
        off = [np.linalg.norm((self.f(u + t * v) - self.f(u - t * v)) / (2 * t) - self.slope) / size for t in STEPS]
        excess = [float(each) - ROUNDING * self.rounding / (t * size) for each, t in zip(off, STEPS, strict=True)]
        return min(excess) if np.all(np.isfinite(excess)) else float("nan")

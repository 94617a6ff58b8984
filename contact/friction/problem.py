"""The contact problem with Coulomb friction and its answer; no algorithm and no mechanics may enter here.

One step of a quasi-static path, implicit in time. Find u (n,), normal forces f (m,) and friction t (m, 2) [N] with::

    r(u) = G(u)^T f + S(u)^T t,    g(u) >= 0,    f >= 0,    f g = 0
    |t_i| <= mu_i f_i,    s_i(u) = 0  or  t_i = -mu_i f_i s_i/|s_i|

s (m, 2) is the slip [mm]: how far a candidate has come relative to the foundation, in its tangent plane, since the last
accepted state; S = ds/du. The foundation may have moved in its own plane in the meantime: that is part of s. What a
path remembers are the anchors, the points of the foundation where the candidates were, and they are in the slip of the
next step: states go in and come out, nothing is kept between calls. Forces are those of the foundation on the body, so
that friction opposes the slip and its power is never positive.

mu = 0 is the problem without friction; an infinite one ties every candidate that touches. Normal forces are each a
candidate's own: f = w p with the areas w of the contact problem, lumped.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy import sparse

from contact.problem import ContactProblem, ContactSolution, Outcome


class State(enum.IntEnum):
    """What a candidate does."""

    OPEN = 0
    STICK = 1
    SLIP = 2


@dataclass(frozen=True, eq=False)
class FrictionalProblem:
    """A contact problem, coefficients mu (m,) in [0, inf], and the slip; all callables are pure.

    slip(u) -> (m, 2) [mm];  slip_jacobian(u) -> (2m, n) CSR, rows 2i and 2i + 1 of candidate i.
    slip_size: size [mm] of what a slip is a difference of; it has the rounding of it.
    Raises ValueError for consistent coupling, for a foundation that is an unknown, and for mu out of its range.
    """

    contact: ContactProblem
    mu: np.ndarray
    slip: Callable[[np.ndarray], np.ndarray]
    slip_jacobian: Callable[[np.ndarray], sparse.csr_matrix]
    slip_size: float = 0.0

    def __post_init__(self) -> None:
        if self.contact.coupling is not None:
            raise ValueError("friction needs lumped coupling: each normal force a candidate's own")
        if self.contact.driven:
            raise ValueError("friction needs a foundation whose travel is given")
        if self.mu.shape != self.contact.weights.shape or not np.all(self.mu >= 0):
            raise ValueError(f"mu must be {len(self.contact.weights)} numbers in [0, inf]")

    def force(self, u: np.ndarray, normal: np.ndarray, friction: np.ndarray) -> np.ndarray:
        """G^T f + S^T t (n,): the force of the foundation on the unknowns."""
        pushed = self.contact.gap_jacobian(u).T @ normal
        return np.asarray(pushed + self.slip_jacobian(u).T @ friction.ravel())

    def bound(self, normal: np.ndarray) -> np.ndarray:
        """mu f (m,) [N]: the radii of the discs; infinite where mu is and the candidate is pressed."""
        pressed = normal > 0
        return np.where(pressed, self.mu, 0.0) * np.where(pressed, normal, 0.0)


@dataclass(frozen=True, eq=False)
class FrictionalSolution:
    """u (n,), normal (m,) [N], friction (m, 2) [N], state (m,) of :class:`State`, outcome, counters, history."""

    u: np.ndarray
    normal: np.ndarray
    friction: np.ndarray
    state: np.ndarray
    outcome: Outcome
    counters: Mapping[str, float] = field(default_factory=dict)
    history: tuple[Mapping[str, Any], ...] = ()

    @classmethod
    def at_rest(cls, n: int, m: int) -> FrictionalSolution:
        """The unloaded state: the start of every path."""
        nothing = np.zeros(m), np.zeros((m, 2)), np.full(m, State.OPEN, dtype=np.int8)
        return cls(np.zeros(n), *nothing, Outcome.CONVERGED)

    def without_friction(self, weights: np.ndarray) -> ContactSolution:
        """The same as an answer of the contact problem with areas ``weights`` (m,) [mm^2]."""
        pressure = np.divide(self.normal, weights, out=np.zeros_like(self.normal), where=weights > 0)
        active = np.asarray(self.state != State.OPEN)
        return ContactSolution(self.u, pressure, active, self.outcome, self.counters, self.history)

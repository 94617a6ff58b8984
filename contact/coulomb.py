"""What Coulomb friction adds to a contact problem and to its answer: records alone; no algorithm may enter here.

One step of a quasi-static path, implicit in time. Beside the normal forces f (m,) there is friction t (m, 2) [N]::

    r(u) = G(u)^T f + S(u)^T t,    |t_i| <= mu_i f_i,    s_i(u) = 0  or  t_i = -mu_i f_i s_i/|s_i|

s (m, 2) is the slip [mm]: how far a candidate has come relative to the foundation, in its tangent plane, since the last
accepted state; S = ds/du. The foundation may have moved in its own plane in the meantime: that is part of s. What a
path remembers are the anchors, the points of the foundation where the candidates were, and they are in the slip of the
next step: states go in and come out, nothing is kept between calls. Forces are those of the foundation on the body, so
that friction opposes the slip and its power is never positive.

mu = 0 is contact without friction; an infinite one ties every candidate that touches. Normal forces are each a
candidate's own: f = w p with the areas w of the contact problem, lumped.
"""

from __future__ import annotations

import enum
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Protocol, Self

import numpy as np
from scipy import sparse


class State(enum.IntEnum):
    """What a candidate does."""

    OPEN = 0
    STICK = 1
    SLIP = 2


@dataclass(frozen=True, eq=False)
class Motion:
    """Translation d (3,) [mm]; turn (3,) [rad], rotation vector, about an axis through centre c (3,) [mm]."""

    translation: np.ndarray
    turn: np.ndarray
    centre: np.ndarray

    @classmethod
    def none(cls) -> Motion:
        """At rest."""
        return cls(np.zeros(3), np.zeros(3), np.zeros(3))

    @property
    def rotation(self) -> np.ndarray:
        """R (3, 3) = 1 + sin a N + (1 - cos a) N N, a = |turn| and N x = turn/a x x (Rodrigues)."""
        angle = float(np.linalg.norm(self.turn))
        if angle == 0:
            return np.eye(3)
        x, y, z = self.turn / angle
        N = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        return np.asarray(np.eye(3) + np.sin(angle) * N + 2 * np.sin(angle / 2) ** 2 * (N @ N))

    def into(self, x: np.ndarray) -> np.ndarray:
        """Places X (m, 3) in the moving frame of places x (m, 3) in space."""
        return np.asarray((x - self.centre - self.translation) @ self.rotation + self.centre)

    def out(self, X: np.ndarray) -> np.ndarray:
        """Places x (m, 3) in space of places X (m, 3) in the moving frame."""
        return np.asarray((X - self.centre) @ self.rotation.T + self.centre + self.translation)


class Sliding(Protocol):
    """The slip since anchors (m, 3), which tell points of a foundation by their places, of a face by patch and xi.

    :class:`contact.slip.Slip`, :class:`contact.faces.rubbing.Rubbing`, :class:`contact.faces.rubbings.Rubbings`.
    """

    @property
    def each(self) -> tuple[Sliding, ...]:
        """That of each pair of faces by itself."""

    def __call__(self, u: np.ndarray) -> np.ndarray:
        """s (m, 2) [mm]."""

    def jacobian(self, u: np.ndarray) -> sparse.csr_matrix:
        """ds/du (2m, n)."""

    @property
    def anchors(self) -> np.ndarray:
        """(m, 3)."""

    def since(self, anchors: np.ndarray) -> Self:
        """The slip from other anchors (m, 3)."""

    def places(self, u: np.ndarray) -> np.ndarray:
        """Where the candidates (m, 3) are, as anchors tell it."""

    def curvature(self, u: np.ndarray, friction: np.ndarray) -> sparse.csc_matrix | None:
        """sum t . d2s/du2 (n, n) of t (m, 2); None where the slip is linear in u."""

    def measured(self, u: np.ndarray) -> np.ndarray:
        """s (m, 2) [mm] as the judge has it."""

    def in_space(self, u: np.ndarray, friction: np.ndarray) -> np.ndarray:
        """Friction (m, 3) [N] on the candidates of t (m, 2)."""

    def forces(self, u: np.ndarray, friction: np.ndarray) -> np.ndarray:
        """The same (k, 3) on all points whose ways the slip depends on."""

    def left(self, u: np.ndarray, stretched: np.ndarray) -> np.ndarray:
        """The anchors (m, 3) of the next step, where springs are ``stretched`` (m, 2) [mm]."""


@dataclass(frozen=True, eq=False)
class Coulomb:
    """The law of one step: coefficients mu (m,), pure numbers in [0, inf], and the slip; all callables are pure.

    slip(u) -> (m, 2) [mm];  slip_jacobian(u) -> (2m, n) CSR, rows 2i and 2i + 1 of candidate i.
    slip_size: size [mm] of what a slip is a difference of; it has the rounding of it.
    sliding: the slip where anchors are kept from step to step; None where it is given.
    """

    mu: np.ndarray
    slip: Callable[[np.ndarray], np.ndarray]
    slip_jacobian: Callable[[np.ndarray], sparse.csr_matrix]
    slip_size: float = 0.0
    sliding: Sliding | None = None

    def __post_init__(self) -> None:
        if not np.all(self.mu >= 0):
            raise ValueError("mu must be numbers in [0, inf]")

    def bound(self, normal: np.ndarray) -> np.ndarray:
        """mu f (m,) [N]: the radii of the discs."""
        return radii(self.mu, normal)

    def on_tangent(self, K: sparse.csc_matrix, u: np.ndarray, friction: np.ndarray) -> sparse.csc_matrix:
        """K (n, n) less sum t . d2s/du2 of friction (m, 2)."""
        bent = None if self.sliding is None else self.sliding.curvature(u, friction)
        return K if bent is None else sparse.csc_matrix(K - bent)

    def since(self, anchors: np.ndarray) -> Coulomb:
        """The law with slips from other anchors (m, 3)."""
        assert self.sliding is not None
        slip = self.sliding.since(anchors)
        return replace(self, slip=slip, slip_jacobian=slip.jacobian, sliding=slip)


def radii(mu: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """mu f (m,) [N], 0 where a candidate is not pressed; infinite where mu is and it is."""
    pressed = normal > 0
    return np.where(pressed, mu, 0.0) * np.where(pressed, normal, 0.0)


NO_PLACES = np.zeros((0, 3))


@dataclass(frozen=True, eq=False)
class Friction:
    """Friction of an accepted state, and what its path remembers.

    force (m, 2) [N]: along the tangents at ``since``.  state (m,) of :class:`State`.
    since, anchors (m, 3): as :class:`Sliding` has them, from which the slip of this step has been counted, and from
    which that of the next one is; none where slips are given.
    dissipation [N mm]: of the whole path up to here.
    """

    force: np.ndarray
    state: np.ndarray
    since: np.ndarray = field(default_factory=lambda: NO_PLACES)
    anchors: np.ndarray = field(default_factory=lambda: NO_PLACES)
    dissipation: float = 0.0

    def only(self, chosen: np.ndarray) -> Friction:
        """That of the chosen candidates (m,) bool."""
        return replace(
            self,
            force=self.force[chosen],
            state=self.state[chosen],
            since=self.since[chosen],
            anchors=self.anchors[chosen],
        )

    def of_all(self, chosen: np.ndarray, anchors: np.ndarray) -> Friction:
        """That of all candidates where only the chosen (m,) bool have been looked at; the others are open.

        anchors (m, 3): where all are now, from which those who have no others slip.
        """
        m = len(chosen)
        whole = Friction(np.zeros((m, 2)), np.zeros(m, self.state.dtype), anchors.copy(), anchors.copy())
        for mine, part in (
            (whole.force, self.force),
            (whole.state, self.state),
            (whole.since, self.since),
            (whole.anchors, self.anchors),
        ):
            mine[chosen] = part
        return replace(whole, dissipation=self.dissipation)

"""What Coulomb friction adds to a contact problem and to its answer: records alone.

They name a coefficient, a moving foundation and what a path remembers; who solves with them is in
:mod:`contact.friction`, which is not imported where they are not set. No algorithm and no scene may enter here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

if TYPE_CHECKING:
    from contact.problem import ContactProblem


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


@dataclass(frozen=True, eq=False)
class Surface:
    """The surface of a rigid foundation and the candidates before it, in a frame that is shifted with the foundation.

    positions(u) -> y (m, 3) [mm] of the candidates there;  operator (3m, n): dy/du, rows 3i to 3i + 2 of candidate i.
    gap(y) -> (m,) [mm], gradient(y) -> (m, 3): signed distance and unit normal.  size [mm]: of what y is a difference.
    """

    positions: Callable[[np.ndarray], np.ndarray]
    operator: sparse.csr_matrix
    gap: Callable[[np.ndarray], np.ndarray]
    gradient: Callable[[np.ndarray], np.ndarray]
    size: float


@dataclass(frozen=True, eq=False)
class Coulomb:
    """Coefficient mu in [0, inf] [-], and how the foundation has slid along itself: its motion in its shifted frame."""

    mu: float
    motion: Motion

    def places(self, surface: Surface, u: np.ndarray) -> np.ndarray:
        """Where the candidates are (m, 3) on the moving foundation."""
        return self.motion.into(surface.positions(u))


@dataclass(frozen=True, eq=False)
class Friction:
    """Friction of an accepted state, and what its path remembers.

    force (m, 2) [N]: along the tangents at ``since``.  state (m,) of :class:`contact.friction.problem.State`.
    since, anchors (m, 3) [mm]: places on the foundation from which the slip of this step has been counted, and from
    which that of the next one is.  dissipation [N mm]: of the whole path up to here.
    """

    force: np.ndarray
    state: np.ndarray
    since: np.ndarray
    anchors: np.ndarray
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


def with_friction(problem: ContactProblem, mu: float, motion: Motion) -> ContactProblem:
    """The same problem with friction; its path is not followed by arc length, which friction leaves no curve to.

    Raises ValueError where the problem does not know the surface of its foundation.
    """
    if problem.surface is None:
        raise ValueError("friction needs a foundation that is known as a surface")
    only = problem.only

    def chosen(which: np.ndarray) -> ContactProblem:
        assert only is not None
        return with_friction(only(which), mu, motion)

    coulomb = Coulomb(mu, motion)
    return replace(problem, coulomb=coulomb, only=None if only is None else chosen, travel=None)

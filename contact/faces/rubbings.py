"""Friction between several pairs of faces: candidates, anchors and points of one pair after those of the other.

Each pair rubs by itself, see :mod:`contact.faces.rubbing`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.coulomb import Coulomb
from contact.faces.pair import Pair
from contact.faces.rubbing import Rubbing
from contact.faces.several import Several
from contact.problem import ContactProblem


@dataclass(frozen=True, eq=False)
class Rubbings:
    """The slips of all pairs, as :class:`contact.faces.rubbing.Rubbing` is that of one."""

    each: tuple[Rubbing, ...]

    @property
    def anchors(self) -> np.ndarray:
        """(m, 3): patches are numbered pair by pair."""
        return np.concatenate([one.anchors for one in self.each])

    def _with(self, values: np.ndarray) -> Iterator[tuple[Rubbing, np.ndarray]]:
        ends = np.cumsum([len(one.nodes) for one in self.each])[:-1]
        return zip(self.each, np.split(values, ends), strict=True)

    def _gathered(self, what: Callable[[Rubbing, np.ndarray], np.ndarray], values: np.ndarray) -> np.ndarray:
        return np.concatenate([what(one, own) for one, own in self._with(values)])

    def since(self, anchors: np.ndarray) -> Rubbings:
        """The slips from other anchors (m, 3)."""
        return Rubbings(tuple(one.since(own) for one, own in self._with(anchors)))

    def places(self, u: np.ndarray) -> np.ndarray:
        """Where the candidates (m, 3) are on their masters."""
        return np.concatenate([one.places(u) for one in self.each])

    def left(self, u: np.ndarray, stretched: np.ndarray) -> np.ndarray:
        """The anchors (m, 3) that a step leaves where springs are still ``stretched`` (m, 2) by [mm]."""
        return self._gathered(lambda one, own: one.left(u, own), stretched)

    def __call__(self, u: np.ndarray) -> np.ndarray:
        """s (m, 2) [mm]."""
        return np.concatenate([one(u) for one in self.each])

    def measured(self, u: np.ndarray) -> np.ndarray:
        """s (m, 2) [mm] by another way, for the judge."""
        return np.concatenate([one.measured(u) for one in self.each])

    def on_faces(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where the candidates are, and the normals of their masters at their anchors, (m, 3) each."""
        places, normals = zip(*(one.on_faces(u) for one in self.each), strict=True)
        return np.concatenate(places), np.concatenate(normals)

    def in_space(self, u: np.ndarray, friction: np.ndarray) -> np.ndarray:
        """Vectors (m, 3) of t (m, 2)."""
        return self._gathered(lambda one, own: one.in_space(u, own), friction)

    def forces(self, u: np.ndarray, friction: np.ndarray) -> np.ndarray:
        """S^T t (k, 3) [N] on the points of all faces."""
        return self._gathered(lambda one, own: one.forces(u, own), friction)

    def jacobian(self, u: np.ndarray) -> sparse.csr_matrix:
        """ds/du (2m, n)."""
        return sparse.csr_matrix(sparse.vstack([one.jacobian(u) for one in self.each], format="csr"))

    def curvature(self, u: np.ndarray, friction: np.ndarray) -> sparse.csc_matrix:
        """sum_ia t_ia d2s_ia/du2 (n, n)."""
        n = len(u)
        return sum((one.curvature(u, own) for one, own in self._with(friction)), start=sparse.csc_matrix((n, n)))


def rubbed(problem: ContactProblem, mu: float) -> ContactProblem:
    """The same problem of pairs with friction, slips counted from where they are undeformed until anchors are given.

    There is none between those that are smooth. Raises ValueError where there is no pair of faces.
    """
    faces = problem.faces
    if not isinstance(faces, Pair | Several):
        raise ValueError("friction between faces needs pairs of them")
    each = tuple(Rubbing.at_rest(pair) for pair, _ in faces.parts)
    slip = each[0] if len(each) == 1 else Rubbings(each)
    coefficients = [np.full(len(one.nodes), 0.0 if one.pair.smooth else mu) for one in each]
    law = Coulomb(np.concatenate(coefficients), slip, slip.jacobian, faces.size, slip)
    return replace(problem, coulomb=law, travel=None)

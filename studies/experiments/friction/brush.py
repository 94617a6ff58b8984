"""Springs that stand on a plane by themselves, as bristles of a brush; the plane moves under them.

Each point of the patch has three unknowns and a stiffness k (3, 3) of its own, by area [N/mm^3]. It is pressed by how
far its springs are approached, so that pressures are those of the solve; a stiffness that couples lets them depend on
friction. The plane z = 0 is dragged along itself and turned about z, by any amount: :mod:`contact.friction.slip`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.coulomb import Coulomb, Motion
from contact.friction.path import PathState, Stage, follow
from contact.friction.slip import Slip
from contact.obstacles.foundation import Candidates, RigidPlane
from contact.problem import ContactProblem, ContactSolution, linear_mechanics

GROUND = RigidPlane(np.array([0.0, 0.0, -1.0]), 0.0)


@dataclass(frozen=True, eq=False)
class Brush:
    """Points at ``places`` (m, 2) [mm] with areas (m,) [mm^2], stiffness (3, 3) [N/mm^3] and the coefficient mu.

    approach(load) -> (m,) [mm]: by which springs are pressed; moved(load): how far the plane has moved from rest.
    """

    places: np.ndarray
    areas: np.ndarray
    stiffness: np.ndarray
    mu: float
    approach: Callable[[float], np.ndarray]
    moved: Callable[[float], Motion]

    @property
    def candidates(self) -> Candidates:
        """The ends of the springs, on the plane where they are not approached."""
        m = len(self.areas)
        at = np.column_stack([self.places, np.zeros(m)])
        return Candidates(at, sparse.csr_matrix(sparse.eye_array(3 * m)), self.areas)

    def stage_at(self, load: float, anchors: np.ndarray) -> Stage:
        """The step to ``load`` from anchors (m, 3)."""
        m, candidates = len(self.areas), self.candidates
        K = sparse.csc_matrix(sparse.kron(sparse.diags_array(self.areas), self.stiffness))
        across = sparse.csr_matrix((np.ones(m), np.arange(2, 3 * m, 3), np.arange(m + 1)), shape=(m, 3 * m))
        near = self.approach(load)
        mechanics = linear_mechanics(
            K, np.zeros(3 * m), float(np.linalg.norm(self.areas * near * self.stiffness[2, 2]))
        )
        motion = self.moved(load)
        slip = Slip(candidates, GROUND, motion, anchors)
        size = float(np.max(np.abs(candidates.reference), initial=0.0) + np.linalg.norm(motion.translation))
        slips = slip.jacobian(np.zeros(3 * m))  # the same everywhere
        law = Coulomb(np.full(m, self.mu), slip, lambda u: slips, size)
        problem = ContactProblem(mechanics, lambda u: across @ u - near, lambda u: across, self.areas, coulomb=law)
        return Stage(problem, slip.places)

    def follow(self, loads: Sequence[float]) -> list[PathState]:
        """The states at these loads in turn, from rest."""
        m = len(self.areas)
        rest = PathState(0.0, ContactSolution.at_rest(3 * m, m), self.candidates.reference)
        return list(follow(self.stage_at, loads, Semismooth(), rest))

    def friction(self, state: PathState) -> np.ndarray:
        """Forces (m, 3) [N] of the plane on the points along itself, in space."""
        anchored = Slip(self.candidates, GROUND, self.moved(state.load), state.anchors)
        own = np.einsum("mk,mki->mi", state.solution.rubbed.force, anchored.directions)
        return np.asarray(own @ anchored.motion.rotation.T)

    def moment(self, state: PathState) -> float:
        """Of friction about the z axis [N mm], where the points are now."""
        x, t = self.candidates.positions(state.solution.u), self.friction(state)
        return float(np.sum(x[:, 0] * t[:, 1] - x[:, 1] * t[:, 0]))


def spun(load: float) -> Motion:
    """The plane turned by the load [rad] about z."""
    return Motion(np.zeros(3), np.array([0.0, 0.0, load]), np.zeros(3))

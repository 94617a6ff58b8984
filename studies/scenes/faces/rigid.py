"""What is rigid among bodies whose faces meet: a body without unknowns, which is carried as the others are.

No pressure on a rigid foundation alone is solved here, see :mod:`contact.obstacles`.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy import sparse

from contact.faces.sampling import areas
from contact.problem import Linearisation, Linearised
from studies.ask.layers import Layer


@dataclass(frozen=True, eq=False)
class Floor:
    """A rigid face, the master of what meets it: points x (k, 3) [mm] and its patches (F, 4), turned outwards."""

    x: np.ndarray
    patches: np.ndarray

    @classmethod
    def square(cls, half: float, height: float, *, facing: int) -> Self:
        """|x|, |y| <= half [mm] at z = height [mm], its outside along ``facing`` z, +1 or -1."""
        corners = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        quad = np.arange(4)[None] if facing > 0 else np.arange(4)[None, ::-1]
        return cls(np.column_stack([corners, np.full(4, height)]), quad)

    @property
    def n_free(self) -> int:
        """None."""
        return 0

    @property
    def conservative(self) -> bool:
        """It stores nothing."""
        return True

    def linearise(self, u: np.ndarray, memory: object = None) -> Linearised:
        """Nothing (0,), (0, 0)."""
        return Linearisation(np.zeros(0), sparse.csc_matrix((0, 0)), 0.0, lambda du: None)

    def residual(self, u: np.ndarray) -> np.ndarray:
        """Nothing (0,)."""
        return np.zeros(0)

    def energy(self, u: np.ndarray) -> float:
        """None [N mm]."""
        return 0.0

    def face(self, face: int) -> tuple[np.ndarray, sparse.csr_matrix, np.ndarray]:
        """Points (k, 3), displacements (3k, 0), patches (F, 4)."""
        return self.x, sparse.csr_matrix((self.x.size, 0)), self.patches

    def held(self, face: int) -> list[sparse.csr_matrix]:
        """Nothing moves."""
        return [self.face(face)[1]]

    def areas(self, face: int) -> np.ndarray:
        """Shares (k,) [mm^2]."""
        return areas(self.x, self.patches)

    def points_of(self, face: int) -> np.ndarray:
        """None: it is the master."""
        return self.nodes

    @property
    def nodes(self) -> np.ndarray:
        """None (0,): what is rigid is not drawn."""
        return np.zeros(0, np.intp)

    def layer(self, u: np.ndarray, pressure: np.ndarray) -> Layer:
        """Neither points nor cells."""
        return Layer(np.zeros((0, 3)), np.zeros((0, 8), np.intp), {}, {})

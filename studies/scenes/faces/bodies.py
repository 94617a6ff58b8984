"""What a body must say of itself for its faces to meet others: shells and solids alike.

Points and patches of a face are its own, and positions are linear in the unknowns. A shell in space is in
:mod:`studies.scenes.faces.model`, a solid in :mod:`studies.scenes.faces.solids`.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from scipy import sparse

from contact.problem import Linearised
from studies.output.vtu import Layer


class Body(Protocol):
    """A loaded body in space with n unknowns; a face is asked for by its number, 0 inner or 1 outer."""

    @property
    def n_free(self) -> int:
        """Number of unknowns n."""

    @property
    def conservative(self) -> bool:
        """Whether :meth:`energy` is the potential of the residual."""

    def linearise(self, u: np.ndarray, memory: object = None) -> Linearised:
        """Residual [N] and tangent [N/mm] at u (n,)."""

    def residual(self, u: np.ndarray) -> np.ndarray:
        """That of :meth:`linearise` alone (n,)."""

    def energy(self, u: np.ndarray) -> float:
        """Potential [N mm]."""

    def face(self, face: int) -> tuple[np.ndarray, sparse.csr_matrix, np.ndarray]:
        """Points (k, 3) at rest [mm], their displacements (3k, n), and bilinear patches (F, 4) turned outwards."""

    def areas(self, face: int) -> np.ndarray:
        """Shares (k,) [mm^2] of the points in the area of a face."""

    def points_of(self, face: int) -> np.ndarray:
        """Where the points of a face (k,) are among those of :meth:`layer`."""

    @property
    def nodes(self) -> np.ndarray:
        """Which node of its mesh each point of :meth:`layer` is."""

    def layer(self, u: np.ndarray, pressure: np.ndarray) -> Layer:
        """What a file has of it, with the pressure (P,) [MPa] at its points."""

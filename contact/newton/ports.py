"""What is asked of a contact set in a tangent, whether its forces are unknowns or not. No set is chosen here."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy import sparse


@dataclass(frozen=True, eq=False)
class Ports:
    """The d ways of all candidates: inputs are forces where ``forced`` (d,) bool, ways where the candidate is held.

    rows, acting: J (d, n), and the same by which forces act.
    to_slack (a, d): slacks of the held rows of unit ways; multiplied (d, a): forces along the ways of unit multipliers.
    """

    rows: sparse.csr_matrix
    acting: sparse.csr_matrix
    forced: np.ndarray
    to_slack: sparse.csr_matrix
    multiplied: sparse.csr_matrix

    @property
    def free(self) -> sparse.dia_array:
        """1 on the diagonal (d, d) where the input is a force."""
        return sparse.diags_array(self.forced.astype(float))


class Bound(Protocol):
    """The step K du - G_A^T f = -r, G_A du + E f = s - g of a set A with slacks s (a,), in unknowns y of its own."""

    @property
    def matrix(self) -> sparse.csc_matrix:
        """Of y."""

    @property
    def multipliers(self) -> int:
        """How many unknowns are forces: as many negative eigenvalues belong to no motion."""

    def load(self, force: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """The right-hand side of y for forces (n,) and slacks s - g (a,)."""

    def motion(self, y: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """du (n,)."""

    def forces(self, y: np.ndarray, du: np.ndarray, residual: np.ndarray) -> np.ndarray:
        """f (a,) [N]; residual (n,): r."""

    def sides(self, ports: Ports) -> tuple[sparse.csc_matrix, sparse.csc_matrix]:
        """What there is of y in outputs, and what inputs put on the right-hand side of y, a column (d of them) each."""

    def direct(self, ports: Ports, places: np.ndarray) -> np.ndarray:
        """Outputs (d, p) of unit inputs at the ``places`` (p,) that do not go by way of y."""

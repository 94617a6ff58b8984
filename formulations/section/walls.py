"""Walls that differ from element to element, and from node to node. No geometry and no element may enter here.

D of a laminate whose plies keep their shares of it grows with its thickness: strains are those of its faces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formulations.section.laminate import Laminate


@dataclass(frozen=True, eq=False)
class Walls:
    """laminates: those that there are.  kind (E,): which of them an element has.  thickness (E, 4): at its corners.

    The reference surface divides all of them in the same ratio. Where elements that meet differ, their walls step: each
    has its own thickness about the reference surface, and all follow the one director of the node.
    """

    laminates: tuple[Laminate, ...]
    kind: np.ndarray
    thickness: np.ndarray

    def stiffness(self, section: str) -> np.ndarray:
        """D (k, 11, 11) of the laminates, each in its own thickness."""
        return np.array([laminate.stiffness(section) for laminate in self.laminates])

    @property
    def growth(self) -> np.ndarray:
        """(E, 4) thickness at the corners over that of the laminate."""
        return self.thickness / np.array([laminate.thickness for laminate in self.laminates])[self.kind][:, None]

    def at_nodes(self, elements: np.ndarray, n_nodes: int) -> np.ndarray:
        """Distance (N,) between the faces of the nodes: the mean over the elements (E, 4) around."""
        corners = elements.ravel()
        total = np.bincount(corners, weights=self.thickness.ravel(), minlength=n_nodes)
        return np.asarray(total / np.bincount(corners, minlength=n_nodes))

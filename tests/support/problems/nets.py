"""Square sheets of patches.

Two sheets of points one above the other as a pair of faces; every coordinate is an unknown.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from contact.faces.pair import Pair
from contact.faces.sampling import areas, at_nodes, mortar


def sheet(n1: int, n2: int, side: float, height: float, bent: float, *, up: bool) -> tuple[np.ndarray, np.ndarray]:
    """Points (k, 3) and patches (q, 4) of a square sheet z = height + bent (x^2 + y^2/2), which looks up or down."""
    x, y = (grid.ravel() for grid in np.meshgrid(*(np.linspace(-side, side, n + 1) for n in (n1, n2)), indexing="ij"))
    low = (np.arange(n1)[:, None] * (n2 + 1) + np.arange(n2)).ravel()
    quads = low[:, None] + np.array([0, n2 + 1, n2 + 2, 1])
    return np.stack([x, y, height + bent * (x**2 + y**2 / 2)], axis=-1), quads if up else quads[:, ::-1]


def pair(pairing: str, bent: float = 0.1, noise: float = 0.02, apart: float = 0.1, side: float = 1.2) -> Pair:
    """A sheet of 3 x 4 above one of 5 x 3 with another side; every coordinate is an unknown."""
    above, below = sheet(3, 4, 1.0, apart, bent, up=False), sheet(5, 3, side, 0.0, -bent, up=True)
    reference = np.vstack([above[0], below[0]])
    reference += noise * np.random.default_rng(1).normal(size=reference.shape)
    nodes, master = np.arange(len(above[0])), below[1] + len(above[0])
    everything = sparse.csr_matrix(sparse.eye_array(reference.size, format="csr"))
    if pairing == "nodes":
        return Pair(reference, everything, master, at_nodes(nodes, len(reference), areas(reference, above[1])[nodes]))
    return Pair(reference, everything, master, mortar(reference, above[1], master, nodes))


def are_derivatives(one: Pair, u: np.ndarray, force: np.ndarray, ways: np.ndarray, step: float, bound: float) -> None:
    """Asserts that rows are those of the gaps at u (n,), and the curvature under ``force`` (m,) that of the rows.

    Along ``ways`` (k, n) by central differences of a step [mm]; bound: of gaps, and of the size of the curvature.
    """
    at, sides = one.at(u), [(one.at(u + step * way), one.at(u - step * way)) for way in ways]
    rows = np.array([(more.gap - less.gap) / (2 * step) for more, less in sides]).T
    bent = np.array([(more.rows.T @ force - less.rows.T @ force) / (2 * step) for more, less in sides]).T
    np.testing.assert_allclose(at.rows @ ways.T, rows, rtol=0, atol=bound)
    np.testing.assert_allclose(at.curvature(force) @ ways.T, bent, rtol=0, atol=bound * np.max(np.abs(bent)))

"""The linearised step with friction on a polygon: a dense linear complementarity problem, by Lemke's pivots.

Friction t = D b, b >= 0, is a sum along the corners D of a polygon in the disc; with l the size of the slip::

    0 <= f  _|_  g >= 0,    0 <= b  _|_  D^T s + l >= 0,    0 <= l  _|_  mu f - sum b >= 0

with v = (g, s) of the condensed linearisation. The matrix is copositive, so that Lemke's pivots end for every mu, after
up to 2^n of them: they are bounded.
Sources: Stewart, Trinkle, Int. J. Numer. Methods Eng. 39 (1996) 2673-2691; Anitescu, Potra, Nonlinear Dyn. 14 (1997)
231-247.
"""

from __future__ import annotations

import numpy as np

from contact.coulomb import State
from contact.friction.compliance import Block, Chosen
from contact.solvers.lcp_pivoting import lemke

PIVOTS_EACH = 20  # allowed per unknown: far more than are needed where there is an end; the worst cases take 2^n
SIDES = 8  # of a polygon, unless asked for otherwise; friction is up to 1 - cos(pi/sides) short


def by_pivots(block: Block, sides: int = SIDES) -> Chosen:
    """Forces and states of the candidates of a condensed linearisation; raises LcpError."""
    c, (rubs, D) = len(block.mu), corners(block, sides)
    owners, which = np.unique(rubs, return_inverse=True)
    b, e = len(rubs), len(owners)
    length = float(np.max(np.abs(block.v), initial=0.0)) or 1.0
    give = float(np.mean(np.diag(block.W)[::3])) or 1.0
    acting = np.hstack([np.eye(3 * c)[:, ::3], D])
    M = np.zeros((c + b + e, c + b + e))
    M[: c + b, : c + b] = acting.T @ (block.W / give) @ acting
    M[c + np.arange(b), c + b + which] = 1.0
    M[c + b + which, c + np.arange(b)] = -1.0
    M[c + b + np.arange(e), owners] = block.mu[owners]
    q = np.append(acting.T @ block.v / length, np.zeros(e))
    z = lemke(M, q, most=PIVOTS_EACH * len(q)).z
    forces = (acting @ z[: c + b]).reshape(c, 3) * (length / give)
    moves = np.zeros(c)
    moves[owners] = z[c + b :]
    slips = (moves > 0) | (block.mu == 0)
    state = np.where(z[:c] > 0, np.where(slips, State.SLIP, State.STICK), State.OPEN).astype(np.int8)
    return Chosen(forces, state)


def corners(block: Block, sides: int) -> tuple[np.ndarray, np.ndarray]:
    """The candidates (b,) and columns (3c, b) of the corners of their polygons: two where a slip has one way."""
    rubs, columns = [np.zeros(0, int)], [np.zeros((3 * len(block.mu), 0))]
    for i in np.flatnonzero(block.mu > 0).tolist():
        one, two = block.own[i, 1:]
        directions = (
            polygon(sides) if one and two else polygon(2)[:, :: 1 if one else -1] if one or two else np.zeros((0, 2))
        )
        found = np.zeros((3 * len(block.mu), len(directions)))
        found[3 * i + 1 : 3 * i + 3] = directions.T
        rubs.append(np.full(len(directions), i))
        columns.append(found)
    return np.concatenate(rubs), np.hstack(columns)


def polygon(sides: int) -> np.ndarray:
    """Unit vectors (sides, 2) to the corners of a polygon in the disc of radius 1."""
    angle = 2 * np.pi * np.arange(sides) / sides
    return np.column_stack([np.cos(angle), np.sin(angle)])


def no_polygon(sides: int, mu: np.ndarray, unbounded: str) -> str | None:
    """Why friction on a polygon of so many sides does not apply, or None; unbounded: what an infinite mu (m,) is."""
    if sides < 4 or sides % 2:
        return f"a polygon of {sides} sides: an even number from 4 on is needed"
    return f"an infinite coefficient {unbounded}" if np.any(np.isinf(mu)) else None

"""The accuracy of an answer worked out once more, in dense numpy and from the definition alone."""

from __future__ import annotations

import numpy as np

from contact.interchange.linearised_step import FrozenStep


def residuals_by_hand(step: FrozenStep, du: np.ndarray, p: np.ndarray) -> dict[str, float]:
    """The four residuals, see :mod:`studies.arena.answers`, of which no line is used here."""
    eps, K, G, g, r = np.finfo(float).eps, step.K.toarray(), step.G.toarray(), step.gap, step.r
    nodal, held = step.weights * p, max(1 / sum(G[i] ** 2 / abs(np.diag(K))) for i in range(len(g)) if G[i].any())
    f = nodal if step.coupling is None else step.coupling.toarray() @ p
    i, deepest = np.argmin(g), max(-g.min(), 0.0)
    compliance = G[i] @ np.linalg.solve(K, G[i])
    pushed = np.linalg.norm(G[i]) * deepest / compliance if deepest and compliance > 0 else 0.0
    F = max(step.scale, np.linalg.norm(r), pushed)
    L = max(deepest, F / held, min(max(abs(G @ du)), max(abs(g))))
    balance, terms = K @ du + r - G.T @ f, abs(K) @ abs(du) + abs(r) + abs(G).T @ abs(f)
    s, rounding = g + G @ du, eps * (abs(g) + abs(G) @ abs(du))
    return {
        "equilibrium": max(np.linalg.norm(balance) - eps * np.linalg.norm(terms), 0.0) / F,
        "penetration": max(max(-s - rounding), 0.0) / L,
        "tension": max(max(-nodal), 0.0) / F,
        "complementarity": sum(abs(nodal) * np.maximum(abs(s) - rounding, 0.0)) / (F * L),
    }

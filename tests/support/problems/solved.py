"""Scenes solved once for all tests that ask for the same, and what is read off their results and references.

Curves of displacements over loads, as points (n, 2).
"""

from __future__ import annotations

from functools import cache

import numpy as np

from studies.ask.scene import has_contact
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.solving.result import Result
from studies.solving.solve import solve

OPTIONS = ("measure", "contact", "newton", "model", "steps")


@cache
def ended(scene: str, mesh: str | None = None, **asked: str | int) -> Result:
    """The result, converged or not; asked: options and settings of a solve alike."""
    options = {name: asked.pop(name) for name in OPTIONS if name in asked}
    return solve(*complete(scene, asked, mesh, **options))


def solved(scene: str, mesh: str | None = None, **asked: str | int) -> Result:
    """The result, which has converged, with states in which the judge finds no fault."""
    result = ended(scene, mesh, **asked)
    assert result.outcome.converged, result.reason
    assert all(step["failures"] == [] for step in result.steps)
    most = 1e-8 if has_contact(SCENES[scene]) else 1e-9
    assert all(step["kkt"]["equilibrium"] <= max(most, step["rounding"]) for step in result.steps)
    return result


def read(result: Result, name: str) -> np.ndarray:
    """A quantity at every step."""
    return np.array([step[name] for step in result.steps])


def at(result: Result, fraction: float, *quantities: str) -> np.ndarray:
    """Quantities at a load fraction."""
    step = next(step for step in result.steps if step["load_fraction"] == fraction)
    return np.array([step[quantity] for quantity in quantities])


def referenced(scene: str, kind: str, *quantities: str, **where: float | str) -> np.ndarray:
    """Values of the scene's own references of a kind, where these hold."""
    known = {
        each.quantity: each.value
        for each in SCENES[scene].references
        if each.kind == kind and all(each.at.get(key) == value for key, value in where.items())
    }
    return np.array([known[quantity] for quantity in quantities])


def extrapolated(coarse: np.ndarray, fine: np.ndarray, ratio: float = 2.0) -> np.ndarray:
    """Limit of a sequence whose error is of the order 2 in the element size; ``ratio``: coarse over fine size."""
    return fine + (fine - coarse) / (ratio**2 - 1)


def distances(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Distance of each point (p, 2) from the polyline (n, 2)."""
    chord = np.diff(line, axis=0)
    from_start = points[:, None] - line[:-1]
    part = np.clip(np.sum(from_start * chord, axis=-1) / np.sum(chord**2, axis=-1), 0, 1)
    return np.min(np.linalg.norm(from_start - part[..., None] * chord, axis=-1), axis=1)

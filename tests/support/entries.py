"""The algorithms that enter through the open door: their files, and what counts the steps of their own."""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).parents[2] / "studies/arena/solvers"
FILES = {name: FOLDER / f"{name}.py" for name in ("barrier", "interior_point", "proximal")}
SPENT = {
    "barrier": "barrier_iterations",
    "interior-point": "interior_point_iterations",
    "proximal": "proximal_iterations",
}
NAMES = tuple(SPENT)
EXACT_ONLY = ("barrier", "proximal")  # epsilon must be infinite

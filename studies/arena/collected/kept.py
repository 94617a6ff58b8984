"""What of the collection is kept with the suite as arrays, because another machine would not make it again.

Whole files, where the last digit of a path grows to more than 1e-8 on the way; and for each touching form which
candidates of its step are pressed and raised, as a step that is not convex has several answers, and rounding decides
which one is found. No step is chosen or solved here.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path

import numpy as np

from studies.store.atomic import write_by

FOLDER, RAISED_IN = "kept", "raised.npz"
HERE = files("studies.arena.collected")


def kept_names() -> set[str]:
    """Of the problems whose files are kept."""
    return {path.name.removesuffix(".npz") for path in HERE.joinpath(FOLDER).iterdir() if path.name.endswith(".npz")}


def copy_kept(name: str, directory: Path) -> None:
    """The file of a problem as it is kept."""
    data = HERE.joinpath(FOLDER, f"{name}.npz").read_bytes()
    write_by(directory / f"{name}.npz", lambda path: path.write_bytes(data))


def raised_states() -> dict[str, np.ndarray]:
    """Of each touching form which candidates of its step are PRESSED and RAISED."""
    with HERE.joinpath(RAISED_IN).open("rb") as file, np.load(file) as arrays:
        return {name: arrays[name] for name in arrays.files}


def write_states(directory: Path, states: Mapping[str, np.ndarray]) -> None:
    """Those of a new choice."""

    def write(path: Path) -> None:
        with path.open("wb") as file:
            np.savez_compressed(file, **states)  # type: ignore[arg-type]

    write_by(directory / RAISED_IN, write)

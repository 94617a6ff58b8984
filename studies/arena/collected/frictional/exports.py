"""Frozen steps with friction in FCLib's terms, for other programs.

M v = H r + f, u = H^T v + w, contact by contact the normal first, 0 <= u_n, r_n >= 0, u_n r_n = 0 and Coulomb's law
with mu: the global form of FCLib, whose own files, HDF5, are not written. v is du.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy import io, sparse

from contact.interchange.linearised_step import FrozenFrictionalStep
from studies.arena.collected.exports import written
from studies.request import UsageError
from studies.store.atomic import write_json

SPACE = 3


def matrix_market(path: Path, step: FrozenFrictionalStep) -> None:
    """Into a directory: M, H, f, w and mu as .mtx, and problem.json."""
    for name, matrix in (("M", step.K), ("H", step.H)):
        io.mmwrite(path / f"{name}.mtx", sparse.coo_matrix(matrix), precision=17, symmetry="general")
    for name, vector in (("f", -step.r), ("w", step.w), ("mu", step.mu)):
        io.mmwrite(path / f"{name}.mtx", vector[:, None], precision=17)
    write_json(path / "problem.json", {**step.meta, "spacedim": SPACE, "form": "global problem of FCLib"})


def arrays(path: Path, step: FrozenFrictionalStep) -> None:
    """One .npz: M and H by compressed columns (x, i, p as CSparse has them), f, w, mu, spacedim."""
    told = {"f": -step.r, "w": step.w, "mu": step.mu, "spacedim": np.array(SPACE)}
    for name, matrix in (("M", sparse.csc_matrix(step.K)), ("H", step.H)):
        told |= {f"{name}_x": matrix.data, f"{name}_i": matrix.indices, f"{name}_p": matrix.indptr}
    with path.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **told)


FORMATS: dict[str, tuple[Callable[[Path, FrozenFrictionalStep], None], str]] = {
    "mtx": (matrix_market, "a directory of Matrix Market files and a JSON head, in FCLib's terms"),
    "fclib": (arrays, "the arrays of FCLib's global problem in a .npz"),
}


def export_frictional(step: FrozenFrictionalStep, form: str, path: Path) -> None:
    """Write a problem; raises UsageError for a format that is none, or has no friction."""
    if form not in FORMATS:
        raise UsageError(f"with friction, format {form!r} must be one of {', '.join(FORMATS)}")
    write = FORMATS[form][0]
    written(path, lambda place: write(place, step), directory=form == "mtx")

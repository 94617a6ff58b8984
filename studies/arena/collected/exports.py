"""Frozen problems in the formats of other programs; reading their answers is :mod:`studies.arena.answers`.

``qp`` in the names: min 1/2 x.K.x + r.x subject to G x >= -gap; x is du, the multipliers are the nodal forces W p.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy import io, sparse

from contact.interchange.linearised_step import FrozenStep
from contact.solvers.sparse import SingularMatrixError, symmetric
from studies.arena.collected.candidates import condensed
from studies.request import UsageError
from studies.store.atomic import PART, write_by, write_json

DENSE = 3000  # unknowns whose matrix may be written full: 72 MB


def _programme(step: FrozenStep) -> sparse.csc_matrix:
    """K of the quadratic programme; raises UsageError where there is none."""
    if step.coupling is not None:
        raise UsageError(
            "consistent coupling: pressures are no multipliers of the gaps, there is no quadratic programme"
        )
    if not symmetric(step.K):
        raise UsageError(
            "K is not symmetric: there is no quadratic programme; mtx and siconos write the problem as it is"
        )
    return sparse.csc_matrix((step.K + step.K.T) / 2)


def maros_meszaros(path: Path, step: FrozenStep) -> None:
    """The arrays P, q, r, A, l, u, n, m of min 1/2 x.P.x + q.x + r, l <= A x <= u, as qpbenchmark reads that set."""
    above = np.full(len(step.gap), np.inf)
    told = {"P": _programme(step), "q": step.r, "r": 0.0, "A": sparse.csc_matrix(step.G), "l": -step.gap, "u": above}
    sizes = {"n": len(step.r), "m": len(step.gap)}
    io.savemat(path, {**told, **sizes}, appendmat=False, do_compression=True, oned_as="column")


def qpsolvers(path: Path, step: FrozenStep) -> None:
    """What qpsolvers.Problem.load reads: P, q, G x <= h, full; nothing else is constrained.

    Its reader takes an array of None for what is not there, and for nothing else.
    """
    n = len(step.r)
    if n > DENSE:
        raise UsageError(f"{n} unknowns: qpsolvers reads full matrices, at most {DENSE} are written")
    nothing: Any = np.array(None)
    none = dict.fromkeys(("A", "b", "lb", "ub"), nothing)
    with path.open("wb") as file:
        np.savez(file, P=_programme(step).toarray(), q=step.r, G=-step.G.toarray(), h=step.gap, **none)


def mps(path: Path, step: FrozenStep) -> None:
    """Free MPS with the section QUADOBJ, as CUTEst's tools and HiGHS read it: the lower triangle of K, x free."""
    with path.open("w", encoding="ascii") as file:
        file.writelines(f"{line}\n" for line in _mps(step))


def _mps(step: FrozenStep) -> Iterator[str]:
    K, G = sparse.tril(_programme(step), format="coo"), sparse.csc_matrix(step.G)
    n, m = len(step.r), len(step.gap)
    yield from ("NAME FOOTPRINT", "ROWS", " N obj", *(f" G c{i}" for i in range(m)), "COLUMNS")
    for j in range(n):
        yield f" x{j} obj {_word(step.r[j])}"
        for k in range(G.indptr[j], G.indptr[j + 1]):
            yield f" x{j} c{G.indices[k]} {_word(G.data[k])}"
    yield "RHS"
    yield from (f" rhs c{i} {_word(-step.gap[i])}" for i in range(m))
    yield "BOUNDS"
    yield from (f" FR bnd x{j}" for j in range(n))
    yield "QUADOBJ"
    yield from (f" x{j} x{i} {_word(value)}" for i, j, value in zip(K.row, K.col, K.data, strict=True))
    yield "ENDATA"


def matrix_market(path: Path, step: FrozenStep) -> None:
    """Into a directory: K, G, r, gap, weights, and W where the coupling is consistent, as .mtx, and problem.json."""
    vectors = {"r": step.r, "gap": step.gap, "weights": step.weights}
    matrices = {"K": step.K, "G": step.G} | ({} if step.coupling is None else {"W": step.coupling})
    for name, matrix in matrices.items():
        io.mmwrite(path / f"{name}.mtx", sparse.coo_matrix(matrix), precision=17, symmetry="general")
    for name, vector in vectors.items():
        io.mmwrite(path / f"{name}.mtx", vector[:, None], precision=17)
    write_json(path / "problem.json", {**step.meta, "scale": step.scale})


def siconos(path: Path, step: FrozenStep) -> None:
    """The linear complementarity problem of the forces, as text of Siconos; M = G K^-1 G^T, q = g - G K^-1 r.

    Raises UsageError where there is none: consistent coupling, a singular K, too many candidates.
    """
    try:
        dual = condensed(step)
    except SingularMatrixError:
        raise UsageError("K is singular: the forces alone do not say the problem") from None
    if dual is None:
        raise UsageError("the forces alone need lumped coupling, areas above 0 and 2 to 300 candidates")
    M, q, n = dual.K.toarray(), dual.r, len(dual.r)
    rows = "\n".join(" ".join(map(_word, row)) for row in (*M, q))
    path.write_text(f"{n}\n0\n{n}\n{n}\n{n} {n}\n{rows}\n\n{json.dumps(dict(step.meta))}\n", encoding="utf-8")


def _word(value: float) -> str:
    return repr(float(value))


FORMATS: dict[str, tuple[Callable[[Path, FrozenStep], object], str]] = {
    "mat": (maros_meszaros, "quadratic programme as qpbenchmark reads the Maros-Meszaros set"),
    "qpsolvers": (qpsolvers, "quadratic programme, full, for qpsolvers.Problem.load"),
    "mps": (mps, "quadratic programme in free MPS with QUADOBJ: HiGHS, tools of CUTEst"),
    "mtx": (matrix_market, "a directory of Matrix Market files and a JSON head"),
    "siconos": (siconos, "linear complementarity problem of the forces, text of Siconos"),
}


def export(step: FrozenStep, form: str, path: Path) -> None:
    """Write a problem; raises UsageError for a format that is none, or cannot have it."""
    if form not in FORMATS:
        raise UsageError(f"format {form!r} must be one of {', '.join(FORMATS)}")
    write = FORMATS[form][0]
    written(path, lambda place: write(place, step), directory=form == "mtx")


def written(path: Path, write: Callable[[Path], object], *, directory: bool) -> None:
    """A file, or a directory of them, whole or not at all; raises UsageError where there is one already."""
    if path.exists():
        raise UsageError(f"--out {path} is there already")
    if not directory:
        write_by(path, write)
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=PART) as aside:
        whole = Path(aside) / "whole"
        whole.mkdir()
        write(whole)
        whole.rename(path)

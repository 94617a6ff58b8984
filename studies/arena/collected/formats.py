"""Frozen problems in the formats of other programs; reading their answers is :mod:`studies.arena.answers`.

A quadratic programme is min 1/2 x.K.x + r.x subject to G x >= -gap; x is du, the multipliers are the nodal forces W p.
With friction problems are in FCLib's terms: M v = H r + f, u = H^T v + w, contact by contact the normal first,
0 <= u_n, r_n >= 0, u_n r_n = 0 and Coulomb's law with mu: the global form of FCLib, whose own files, HDF5, are not
written; v is du. Of the text format of Siconos (numerics, LCP) problems are read, too: n, the kind of storage (0:
dense), twice the shape, the rows of M, q, and optional text.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy import io, sparse

from contact.interchange.linearised_step import FrozenFrictionalStep, FrozenStep
from contact.interchange.untrusted import MOST, read_bytes
from contact.solvers.sparse import SingularMatrixError, symmetric
from studies.arena.collected.candidates import condensed, has_dual
from studies.ask.request import UsageError
from studies.output.atomic import PART, write_by, write_json

DENSE = 3000  # unknowns whose matrix may be written full: 72 MB
SPACE = 3  # of contacts with friction


def _programme(step: FrozenStep) -> sparse.csc_matrix:
    """K of the quadratic programme; raises UsageError where the problem is none."""
    if step.coupling is not None:
        raise UsageError(
            "consistent coupling: pressures are not multipliers of the gaps, there is no quadratic programme"
        )
    if not symmetric(step.K):
        raise UsageError(
            "K is not symmetric: there is no quadratic programme; mtx and siconos write the problem as it is"
        )
    return sparse.csc_matrix((step.K + step.K.T) / 2)


def maros_meszaros(path: Path, step: FrozenStep) -> None:
    """The arrays P, q, r, A, l, u, n, m of min 1/2 x.P.x + q.x + r, l <= A x <= u, as qpbenchmark reads that set."""
    above = np.full(len(step.gap), np.inf)
    arrays = {"P": _programme(step), "q": step.r, "r": 0.0, "A": sparse.csc_matrix(step.G), "l": -step.gap, "u": above}
    sizes = {"n": len(step.r), "m": len(step.gap)}
    io.savemat(path, {**arrays, **sizes}, appendmat=False, do_compression=True, oned_as="column")


def qpsolvers(path: Path, step: FrozenStep) -> None:
    """The file for qpsolvers.Problem.load: P, q, G x <= h as full matrices, without other constraints.

    Its reader requires an array of None for each absent constraint.
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
    matrices = {"K": step.K, "G": step.G} | ({} if step.coupling is None else {"W": step.coupling})
    _market(path, matrices, {"r": step.r, "gap": step.gap, "weights": step.weights})
    write_json(path / "problem.json", {**step.meta, "scale": step.scale})


def _market(path: Path, matrices: Mapping[str, Any], vectors: Mapping[str, np.ndarray]) -> None:
    for name, matrix in matrices.items():
        io.mmwrite(path / f"{name}.mtx", sparse.coo_matrix(matrix), precision=17, symmetry="general")
    for name, vector in vectors.items():
        io.mmwrite(path / f"{name}.mtx", vector[:, None], precision=17)


def siconos(path: Path, step: FrozenStep) -> None:
    """The linear complementarity problem of the forces, as text of Siconos; M = G K^-1 G^T, q = g - G K^-1 r.

    Raises UsageError where there is none: consistent coupling, a singular K, too many candidates.
    """
    if not has_dual(step):
        raise UsageError("the forces alone need lumped coupling, areas above 0 and 2 to 300 candidates")
    try:
        dual = condensed(step)
    except SingularMatrixError:
        raise UsageError("K is singular: the forces alone do not say the problem") from None
    M, q, n = dual.K.toarray(), dual.r, len(dual.r)
    rows = "\n".join(" ".join(map(_word, row)) for row in (*M, q))
    path.write_text(f"{n}\n0\n{n}\n{n}\n{n} {n}\n{rows}\n\n{json.dumps(dict(step.meta))}\n", encoding="utf-8")


def _word(value: float) -> str:
    return repr(float(value))


def read_lcp(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """M (n, n) and q (n,) of Siconos: z >= 0, M z + q >= 0, z.(M z + q) = 0; raises UsageError, and OSError."""
    try:
        text = read_bytes(path).decode("utf-8", "replace")
        tokens = text.split(maxsplit=MOST)
        n, storage = int(tokens[0]), int(tokens[1])
        shapes = [int(word) for word in tokens[2:6]]
        if n < 1 or storage != 0:
            raise ValueError(f"n = {n}, storage {storage}: only dense matrices (0) are read")
        if shapes != [n] * 4:
            raise ValueError(f"shapes {shapes}, not {n} x {n}")
        if n * n + n > MOST:
            raise ValueError(f"{n * n + n} numbers, more than {MOST}")
        numbers = np.array([float(word) for word in tokens[6 : 6 + n * n + n]])
        if len(numbers) < n * n + n or not np.all(np.isfinite(numbers)):
            raise ValueError(f"{len(numbers)} of {n * n + n} finite numbers")
    except (ValueError, IndexError) as error:
        reason = str(error)[:200]
        raise UsageError(f"{path} is not a linear complementarity problem of Siconos: {reason}") from None
    return numbers[: n * n].reshape(n, n), numbers[n * n :]


def fclib_market(path: Path, step: FrozenFrictionalStep) -> None:
    """Into a directory: M, H, f, w and mu as .mtx, and problem.json."""
    _market(path, {"M": step.K, "H": step.H}, {"f": -step.r, "w": step.w, "mu": step.mu})
    write_json(path / "problem.json", {**step.meta, "spacedim": SPACE, "form": "global problem of FCLib"})


def fclib_arrays(path: Path, step: FrozenFrictionalStep) -> None:
    """One .npz: M and H by compressed columns (x, i, p as CSparse has them), f, w, mu, spacedim."""
    arrays = {"f": -step.r, "w": step.w, "mu": step.mu, "spacedim": np.array(SPACE)}
    for name, matrix in (("M", sparse.csc_matrix(step.K)), ("H", step.H)):
        arrays |= {f"{name}_x": matrix.data, f"{name}_i": matrix.indices, f"{name}_p": matrix.indptr}
    with path.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)


FORMATS: Mapping[str, Callable[[Path, Any], object]] = {
    "mat": maros_meszaros,
    "qpsolvers": qpsolvers,
    "mps": mps,
    "mtx": matrix_market,
    "siconos": siconos,
}
WITH_FRICTION: Mapping[str, Callable[[Path, Any], object]] = {"mtx": fclib_market, "fclib": fclib_arrays}
DIRECTORIES = ("mtx",)  # formats of several files


def export(step: FrozenStep | FrozenFrictionalStep, form: str, path: Path) -> None:
    """Write a problem, a file or a directory of them, whole or not at all.

    Raises UsageError for an unknown format, one that cannot represent the problem, and where the path exists.
    """
    rubs = isinstance(step, FrozenFrictionalStep)
    formats = WITH_FRICTION if rubs else FORMATS
    if form not in formats:
        raise UsageError(f"{'with friction, ' if rubs else ''}format {form!r} must be one of {', '.join(formats)}")
    if path.exists():
        raise UsageError(f"--out {path} is there already")
    if form not in DIRECTORIES:
        write_by(path, lambda place: formats[form](place, step))
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=PART) as aside:
        whole = Path(aside) / "whole"
        whole.mkdir()
        formats[form](whole, step)
        whole.rename(path)

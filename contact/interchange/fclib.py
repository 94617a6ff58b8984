"""Problems with friction in HDF5 files of FCLib: read where h5py is installed, never written.

A file has a group of one kind, with a matrix in the arrays of CSparse (p, i, x; nz = -1 by columns, -2 by rows, else so
many triplets) and vectors::

    fclib_local     u = W r + q                           spacedim, W, vectors q and mu
    fclib_global    M v = H r + f,    u = H^T v + w       spacedim, M, H, vectors f, w and mu

What else is in it, guesses and solutions, is not read.
Source: Acary, Brémond, Huber, RT-444, INRIA (2014); Acary, Brémond, Huber, Lect. Notes Appl. Comput. Mech. 82 (2018).
"""

import importlib
from pathlib import Path
from typing import Any

from scipy import sparse

from contact.interchange.siconos import SiconosError, SiconosProblem

BY_COLUMNS, BY_ROWS = -1, -2


def read_fclib(path: Path) -> SiconosProblem:
    """The problem in a file; raises SiconosError for whatever else is in it and where h5py is missing, and OSError."""
    try:
        h5py: Any = importlib.import_module("h5py")
    except ImportError:
        raise SiconosError(f"{path} is an HDF5 file of FCLib, and h5py is not installed") from None
    with h5py.File(path) as file:
        try:
            return _problem(file)
        except (KeyError, ValueError) as error:
            raise SiconosError(f"{path} is not a frictional problem of FCLib: {str(error).splitlines()[0]}") from None


def _problem(file: Any) -> SiconosProblem:
    kind = next((name for name in ("fclib_local", "fclib_global") if name in file), "")
    if not kind:
        raise ValueError("it has neither a local nor a global problem")
    group = file[kind]
    vectors, d = group["vectors"], int(group["spacedim"][0])
    if kind == "fclib_local":
        return SiconosProblem(d, vectors["mu"][()], vectors["q"][()], W=_matrix(group["W"]))
    if "G" in group:
        raise ValueError("equations between bodies are not read")
    M, H = _matrix(group["M"]), _matrix(group["H"])
    return SiconosProblem(d, vectors["mu"][()], vectors["w"][()], M=M, H=H, q=vectors["f"][()])


def _matrix(group: Any) -> sparse.csc_matrix:
    p, i, x = (group[name][()] for name in "pix")
    shape = int(group["m"][0]), int(group["n"][0])
    storage = int(group["nz"][0])
    if storage == BY_COLUMNS:
        return sparse.csc_matrix((x, i, p), shape=shape)
    if storage == BY_ROWS:
        return sparse.csc_matrix(sparse.csr_matrix((x, i, p), shape=shape))
    places = i[:storage].astype(int), p[:storage].astype(int)
    return sparse.csc_matrix((x[:storage], places), shape=shape)

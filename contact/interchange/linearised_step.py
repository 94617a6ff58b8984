"""One linearised contact problem, taken out of its model: to be re-solved alone, sent around, and kept.

Find du (n,) and p (m,) with::

    K du + r = G^T W p,    g + G du >= 0,    p >= 0,    p (g + G du) = 0

The file is one .npz (a zip of .npy arrays, no pickles) with the arrays

    K_data, K_indices, K_indptr       K (n, n) in CSC [N/mm], curvature of the gap included
    G_data, G_indices, G_indptr       G (m, n) in CSR [-]
    r (n,) [N], gap (m,) [mm], weights (m,) [mm^2], scale () [N], the size of the forces in balance
    W_data, W_indices, W_indptr       only with consistent coupling: W (m, m) in CSR; else W = diag(weights)
    meta ()                           a JSON object as text: format and format_version, and where the problem is from
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse

from contact.interchange.untrusted import parsed_object, read_arrays, text_of
from contact.problem import ContactProblem, linear_mechanics
from contact.solvers.sparse import symmetric

FORMAT, VERSION = "footprint contact step", 1
PARTS = ("data", "indices", "indptr")  # of a sparse matrix
ARRAYS = ("meta", "r", "gap", "weights", "scale", *(f"{name}_{part}" for name in "KG" for part in PARTS))
COUPLED = tuple(f"W_{part}" for part in PARTS)


class FrozenStepError(ValueError):
    """A file that is no frozen step, or a damaged one; the message is one line."""


@dataclass(frozen=True, eq=False)
class FrozenStep:
    """K (n, n), r (n,), G (m, n), gap (m,), weights (m,), scale, W (m, m) or None, and what is known of its origin."""

    K: sparse.csc_matrix
    r: np.ndarray
    G: sparse.csr_matrix
    gap: np.ndarray
    weights: np.ndarray
    scale: float
    coupling: sparse.csr_matrix | None = None
    meta: Mapping[str, Any] = field(default_factory=dict)

    def problem(self) -> ContactProblem:
        """The same as a contact problem in du; its energy is known when K is symmetric."""

        def energy(du: np.ndarray) -> float:
            return float(du @ (self.K @ du / 2 + self.r))

        return ContactProblem(
            linear_mechanics(self.K, -self.r, self.scale),
            lambda du: self.gap + self.G @ du,
            lambda du: self.G,
            self.weights,
            self.coupling,
            energy=energy if symmetric(self.K) else None,
        )

    def write(self, path: Path) -> None:
        """Write the file described above; any suffix."""
        matrices = {"K": self.K, "G": self.G} | ({} if self.coupling is None else {"W": self.coupling})
        arrays: dict[str, Any] = {"r": self.r, "gap": self.gap, "weights": self.weights, "scale": self.scale}
        for name, matrix in matrices.items():
            arrays |= {f"{name}_data": matrix.data, f"{name}_indices": matrix.indices, f"{name}_indptr": matrix.indptr}
        meta = json.dumps({**self.meta, "format": FORMAT, "format_version": VERSION}, allow_nan=False)
        with path.open("wb") as file:
            np.savez_compressed(file, meta=np.array(meta), **arrays)

    @classmethod
    def read(cls, path: Path) -> FrozenStep:
        """The step in a file; raises FrozenStepError for whatever else is in it, OSError when it cannot be opened."""
        try:
            return cls._checked(read_arrays(path, ARRAYS, COUPLED))
        except (ValueError, KeyError, TypeError) as error:
            reason = (
                f"{error} is missing" if isinstance(error, KeyError) else (str(error).splitlines() or ["damaged"])[0]
            )
            raise FrozenStepError(f"{path} is no frozen contact step: {reason}") from None

    @classmethod
    def _checked(cls, arrays: dict[str, np.ndarray]) -> FrozenStep:
        """Raises ValueError or KeyError naming the array."""
        meta = dict(parsed_object(text_of(arrays["meta"], "meta"), "meta"))
        if (meta.pop("format", None), meta.pop("format_version", None)) != (FORMAT, VERSION):
            raise ValueError(f"it is not of the format {FORMAT!r}, version {VERSION}")
        n, m = len(_numbers(arrays, "r")), len(_numbers(arrays, "gap"))
        weights, scale = _numbers(arrays, "weights"), np.atleast_1d(arrays["scale"])
        if weights.shape != (m,) or np.any(weights < 0):
            raise ValueError(f"weights must be {m} areas")
        if scale.shape != (1,) or scale.dtype.kind == "U" or not 0 <= float(scale[0]) < np.inf:
            raise ValueError("scale must be one force")
        coupling = sparse.csr_matrix(_matrix(arrays, "W", sparse.csr_matrix, (m, m))) if "W_data" in arrays else None
        return cls(
            _matrix(arrays, "K", sparse.csc_matrix, (n, n)),
            arrays["r"],
            _matrix(arrays, "G", sparse.csr_matrix, (m, n)),
            arrays["gap"],
            weights,
            float(scale[0]),
            coupling,
            meta,
        )


def freeze(problem: ContactProblem, u: np.ndarray, pressure: np.ndarray, meta: Mapping[str, Any]) -> FrozenStep:
    """The problem linearised at u, the curvature of the gap weighed by the pressures there; meta: what JSON knows."""
    lin = problem.linearise(u, None)
    K, G = problem.stiffness(lin, u, pressure), sparse.csr_matrix(problem.gap_jacobian(u))
    return FrozenStep(K, lin.residual, G, problem.gap(u), problem.weights, lin.scale, problem.coupling, dict(meta))


def _numbers(arrays: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """A vector of finite numbers."""
    found = arrays[name]
    if found.ndim != 1 or found.dtype != np.float64 or not np.all(np.isfinite(found)):
        raise ValueError(f"{name} must be a vector of finite numbers")
    return found


def _matrix(arrays: Mapping[str, np.ndarray], name: str, kind: Any, shape: tuple[int, int]) -> Any:
    """A compressed sparse matrix of finite numbers and the right shape."""
    data, indices, indptr = _numbers(arrays, f"{name}_data"), arrays[f"{name}_indices"], arrays[f"{name}_indptr"]
    if not (np.issubdtype(indices.dtype, np.integer) and np.issubdtype(indptr.dtype, np.integer)):
        raise ValueError(f"the indices of {name} must be whole numbers")
    try:
        found = kind((data, indices, indptr), shape=shape)
        found.check_format(full_check=True)
    except (ValueError, IndexError) as error:
        raise ValueError(f"{name} is no {shape[0]} x {shape[1]} matrix: {error}") from None
    return found

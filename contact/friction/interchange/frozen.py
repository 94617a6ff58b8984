"""One linearised step with friction, taken out of its model: to be solved alone, sent around, and kept. No model.

Find du (n,), f (m,) and t (m, 2) with::

    K du + r = G^T f + S^T t,    g + G du >= 0,    f >= 0,    f (g + G du) = 0
    |t_i| <= mu_i f_i,    s_i = s0_i + S_i du:    s_i = 0  or  t_i = -mu_i f_i s_i/|s_i|

The file is that of :mod:`contact.interchange.linearised_step` with more arrays: who reads it as one has the
same step without friction::

    S_data, S_indices, S_indptr       S (2m, n) in CSR [-], rows 2i and 2i + 1 of candidate i
    slip (m, 2) [mm], mu (m,) [-]     s0, and the coefficients; infinite ones tie
    meta                              has "friction": "coulomb" as well

In FCLib's global form (Acary, Brémond, Huber 2018), M v = H r + f, u = H^T v + w, candidates one after another, the
normal first: M = K, v = du, f = -r, H = [G^T S^T], w = [g s0], r = [f t] and u = [gap slip].
"""

from __future__ import annotations

import json
import zipfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy import sparse

from contact.friction.problem import FrictionalProblem
from contact.interchange.linearised_step import FrozenStep, FrozenStepError, freeze
from contact.interchange.untrusted import read_arrays

MARK = {"friction": "coulomb"}
MORE = ("S_data", "S_indices", "S_indptr", "slip", "mu")


@dataclass(frozen=True, eq=False)
class FrozenFrictionalStep:
    """The contact ``step`` with lumped coupling, S (2m, n), slip s0 (m, 2) [mm] and mu (m,)."""

    step: FrozenStep
    S: sparse.csr_matrix
    slip: np.ndarray
    mu: np.ndarray

    def problem(self) -> FrictionalProblem:
        """The same as a problem in du; its energy is known when K is symmetric."""
        return FrictionalProblem(
            self.step.problem(),
            self.mu,
            lambda du: self.slip + (self.S @ du).reshape(-1, 2),
            lambda du: self.S,
        )

    @property
    def H(self) -> sparse.csc_matrix:
        """H (n, 3m) [-] of FCLib."""
        m = len(self.mu)
        stacked = sparse.csr_matrix(sparse.vstack([self.step.G, self.S]))
        rows = np.column_stack([np.arange(m), m + 2 * np.arange(m), m + 2 * np.arange(m) + 1]).ravel()
        return sparse.csc_matrix(stacked[rows].T)

    @property
    def w(self) -> np.ndarray:
        """w (3m,) [mm] of FCLib."""
        return np.column_stack([self.step.gap, self.slip]).ravel()

    def write(self, path: Path) -> None:
        """Write the file described above; any suffix."""
        replace(self.step, meta={**self.step.meta, **MARK}).write(path)
        arrays = (self.S.data, self.S.indices, self.S.indptr, self.slip, self.mu)
        with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive:
            for name, array in zip(MORE, arrays, strict=True):
                with archive.open(f"{name}.npy", "w") as file:
                    np.lib.format.write_array(file, array, allow_pickle=False)

    @classmethod
    def read(cls, path: Path) -> FrozenFrictionalStep:
        """The step in a file; raises FrozenStepError for whatever else is in it, OSError when it cannot be opened."""
        try:
            step = FrozenStep.read(path)
            if {key: step.meta.get(key) for key in MARK} != MARK:
                raise ValueError(f"its meta has no {json.dumps(MARK)}: it is a step without friction")
            found = cls._checked(step, read_arrays(path, MORE))
            found.problem()  # which refuses what is no problem with friction
        except FrozenStepError:
            raise
        except (ValueError, KeyError, TypeError) as error:
            raise FrozenStepError(f"{path} is no frozen step with friction: {str(error).splitlines()[0]}") from None
        meta = {key: value for key, value in step.meta.items() if key not in MARK}
        return replace(found, step=replace(step, meta=meta))

    @classmethod
    def _checked(cls, step: FrozenStep, arrays: dict[str, np.ndarray]) -> FrozenFrictionalStep:
        """Raises ValueError naming the array."""
        n, m = len(step.r), len(step.gap)
        data, indices, indptr, slip, mu = (arrays[name] for name in MORE)
        for name, array, shape in (("S_data", data, data.shape[:1]), ("slip", slip, (m, 2)), ("mu", mu, (m,))):
            finite = array.dtype == np.float64 and (name == "mu" or np.all(np.isfinite(array)))
            if array.shape != shape or not finite:
                raise ValueError(f"{name} must be finite numbers of the shape {shape}")
        if not (np.issubdtype(indices.dtype, np.integer) and np.issubdtype(indptr.dtype, np.integer)):
            raise ValueError("the indices of S must be whole numbers")
        try:
            S = sparse.csr_matrix((data, indices, indptr), shape=(2 * m, n))
            S.check_format(full_check=True)
        except (ValueError, IndexError) as error:
            raise ValueError(f"S is no {2 * m} x {n} matrix: {error}") from None
        return cls(step, S, slip, mu)


def frozen(
    problem: FrictionalProblem, u: np.ndarray, normal: np.ndarray, meta: dict[str, object]
) -> FrozenFrictionalStep:
    """The problem linearised at u, the curvature of the gap weighed by the normal forces (m,) there.

    The curvature of the slip is left out: slips are short against the radius of a foundation.
    """
    weights = problem.contact.weights
    pressure = np.divide(normal, weights, out=np.zeros_like(normal), where=weights > 0)
    step = freeze(problem.contact, u, pressure, meta)
    return FrozenFrictionalStep(step, sparse.csr_matrix(problem.slip_jacobian(u)), problem.slip(u), problem.mu)

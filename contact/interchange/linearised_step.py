"""One linearised contact problem, taken out of its model: to be re-solved alone, sent around, and kept.

Find du (n,) and p (m,) with::

    K du + r = G^T W p,    g + G du >= 0,    p >= 0,    p (g + G du) = 0

The file is one .npz (a zip of .npy arrays, no pickles) with the arrays

    K_data, K_indices, K_indptr       K (n, n) in CSC [N/mm], curvature of the gap included
    G_data, G_indices, G_indptr       G (m, n) in CSR [-]
    r (n,) [N], gap (m,) [mm], weights (m,) [mm^2], scale () [N], the size of the forces in balance
    W_data, W_indices, W_indptr       only with consistent coupling: W (m, m) in CSR; else W = diag(weights)
    meta ()                           a JSON object as text: format and format_version, and where the problem is from

With friction there is t (m, 2) [N] beside, and S^T t beside G^T W p, each candidate's normal force f = w p::

    |t_i| <= mu_i f_i,    s_i = s0_i + S_i du:    s_i = 0  or  t_i = -mu_i f_i s_i/|s_i|

    S_data, S_indices, S_indptr       S (2m, n) in CSR [-], rows 2i and 2i + 1 of candidate i
    slip (m, 2) [mm], mu (m,) [-]     s0, and the coefficients; infinite ones tie
    meta                              has "friction": "coulomb" as well: who does not look has the step without friction
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Self

import numpy as np
from scipy import sparse

from contact.coulomb import Coulomb
from contact.interchange.untrusted import parsed_object, read_arrays, text_of
from contact.problem import ContactProblem, linear_mechanics

FORMAT, VERSION = "footprint contact step", 1
PARTS = ("data", "indices", "indptr")  # of a sparse matrix
ARRAYS = ("meta", "r", "gap", "weights", "scale", *(f"{name}_{part}" for name in "KG" for part in PARTS))
COUPLED = tuple(f"W_{part}" for part in PARTS)
FRICTION = {"friction": "coulomb"}  # in meta
RUBBED = (*(f"S_{part}" for part in PARTS), "slip", "mu")


class FrozenStepError(ValueError):
    """A file that is not a frozen step, or a damaged one; the message is one line."""


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
        """The same as a contact problem in du.

        It has no energy: the work of a linear step balances identically, but for the imbalance of forces. That is
        judged as such, and has no measure in a work that is zero, as that of a step frozen at its own answer.
        """
        return ContactProblem(
            linear_mechanics(self.K, -self.r, self.scale),
            lambda du: self.gap + self.G @ du,
            lambda du: self.G,
            self.weights,
            self.coupling,
        )

    def write(self, path: Path) -> None:
        """Write the file described above; any suffix."""
        meta = json.dumps({**self.meta, **self._head(), "format": FORMAT, "format_version": VERSION}, allow_nan=False)
        with path.open("wb") as file:
            np.savez_compressed(file, meta=np.array(meta), **self._arrays())

    def _head(self) -> dict[str, str]:
        """What the format adds to meta."""
        return {}

    def _arrays(self) -> dict[str, Any]:
        arrays: dict[str, Any] = {"r": self.r, "gap": self.gap, "weights": self.weights, "scale": self.scale}
        coupled = {} if self.coupling is None else parts("W", self.coupling)
        return arrays | parts("K", self.K) | parts("G", self.G) | coupled

    @classmethod
    def read(cls, path: Path) -> Self:
        """The step in a file, with the friction that it has; raises OSError when it cannot be opened.

        Raises FrozenStepError for whatever else is in it.
        """
        try:
            arrays = read_arrays(path, ARRAYS, (*COUPLED, *RUBBED))
            result: FrozenStep = FrozenStep._checked(arrays)
            if FRICTION.items() <= result.meta.items():
                result = FrozenFrictionalStep.of(result, arrays)
            if not isinstance(result, cls):
                raise ValueError(f"its meta has no {json.dumps(FRICTION)}: it is a step without friction")
        except (ValueError, KeyError, TypeError) as error:
            reason = (
                f"{error} is missing" if isinstance(error, KeyError) else (str(error).splitlines() or ["damaged"])[0]
            )
            raise FrozenStepError(f"{path} is not a frozen contact step: {reason}") from None
        return result

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


@dataclass(frozen=True, eq=False)
class FrozenFrictionalStep(FrozenStep):
    """A step with lumped coupling and friction: S (2m, n), slip s0 (m, 2) [mm] and mu (m,).

    In FCLib's global form (Acary, Brémond, Huber 2018), M v = H r + f, u = H^T v + w, candidates one after another, the
    normal first: M = K, v = du, f = -r, H = [G^T S^T], w = [g s0], r = [f t] and u = [gap slip].
    """

    S: sparse.csr_matrix = field(kw_only=True)
    slip: np.ndarray = field(kw_only=True)
    mu: np.ndarray = field(kw_only=True)

    def problem(self) -> ContactProblem:
        """The same as a problem in du."""
        law = Coulomb(self.mu, lambda du: self.slip + (self.S @ du).reshape(-1, 2), lambda du: self.S)
        return replace(super().problem(), coulomb=law)

    @property
    def H(self) -> sparse.csc_matrix:
        """H (n, 3m) [-] of FCLib."""
        m = len(self.mu)
        stacked = sparse.csr_matrix(sparse.vstack([self.G, self.S]))
        rows = np.column_stack([np.arange(m), m + 2 * np.arange(m), m + 2 * np.arange(m) + 1]).ravel()
        return sparse.csc_matrix(stacked[rows].T)

    @property
    def w(self) -> np.ndarray:
        """w (3m,) [mm] of FCLib."""
        return np.column_stack([self.gap, self.slip]).ravel()

    def _head(self) -> dict[str, str]:
        return FRICTION

    def _arrays(self) -> dict[str, Any]:
        return super()._arrays() | parts("S", self.S) | {"slip": self.slip, "mu": self.mu}

    @classmethod
    def of(cls, step: FrozenStep, arrays: Mapping[str, Any]) -> FrozenFrictionalStep:
        """The step with the arrays of its friction; raises ValueError or KeyError naming the array."""
        n, m = len(step.r), len(step.gap)
        S, slip, mu = _matrix(arrays, "S", sparse.csr_matrix, (2 * m, n)), arrays["slip"], arrays["mu"]
        for name, array, shape in (("slip", slip, (m, 2)), ("mu", mu, (m,))):
            finite = array.dtype == np.float64 and (name == "mu" or np.all(np.isfinite(array)))
            if array.shape != shape or not finite:
                raise ValueError(f"{name} must be finite numbers of the shape {shape}")
        meta = {key: value for key, value in step.meta.items() if key not in FRICTION}
        frictional = cls.beside(replace(step, meta=meta), sparse.csr_matrix(S), slip, mu)
        unfit = frictional.problem().unfit_for_friction
        if unfit is not None:
            raise ValueError(unfit)
        return frictional

    @classmethod
    def beside(cls, step: FrozenStep, S: sparse.csr_matrix, slip: np.ndarray, mu: np.ndarray) -> FrozenFrictionalStep:
        """The step with friction beside it."""
        contact = {each.name: getattr(step, each.name) for each in fields(FrozenStep)}
        return cls(**contact, S=S, slip=slip, mu=mu)


def freeze(problem: ContactProblem, u: np.ndarray, pressure: np.ndarray, meta: Mapping[str, Any]) -> FrozenStep:
    """The problem linearised at u, the curvature of the gap weighed by the pressures there; meta: what JSON knows.

    The curvature of a slip is left out: slips are short against the radius of a foundation.
    """
    lin, law = problem.linearise(u, None), problem.coulomb
    K, G = problem.stiffness(lin, u, pressure), sparse.csr_matrix(problem.gap_jacobian(u))
    step = FrozenStep(K, lin.residual, G, problem.gap(u), problem.weights, lin.scale, problem.coupling, dict(meta))
    if law is None:
        return step
    return FrozenFrictionalStep.beside(step, sparse.csr_matrix(law.slip_jacobian(u)), law.slip(u), law.mu)


def parts(name: str, matrix: sparse.csc_matrix | sparse.csr_matrix) -> dict[str, np.ndarray]:
    """The arrays of a sparse matrix."""
    return {f"{name}_{part}": getattr(matrix, part) for part in PARTS}


def _numbers(arrays: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """A vector of finite numbers."""
    values = arrays[name]
    if values.ndim != 1 or values.dtype != np.float64 or not np.all(np.isfinite(values)):
        raise ValueError(f"{name} must be a vector of finite numbers")
    return values


def _matrix(arrays: Mapping[str, np.ndarray], name: str, kind: Any, shape: tuple[int, int]) -> Any:
    """A compressed sparse matrix of finite numbers and the right shape."""
    data, indices, indptr = _numbers(arrays, f"{name}_data"), arrays[f"{name}_indices"], arrays[f"{name}_indptr"]
    if not (np.issubdtype(indices.dtype, np.integer) and np.issubdtype(indptr.dtype, np.integer)):
        raise ValueError(f"the indices of {name} must be whole numbers")
    try:
        sparse_matrix = kind((data, indices, indptr), shape=shape)
        sparse_matrix.check_format(full_check=True)
    except (ValueError, IndexError) as error:
        raise ValueError(f"{name} is not a {shape[0]} x {shape[1]} matrix: {error}") from None
    return sparse_matrix

"""The strain-measure protocol, and the measure as data: a table of constants over the quantities q.

No particular measure may enter here; they live in :mod:`formulations.strains.catalogue`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Protocol

import numpy as np

from formulations.strains.quantities import BETA, E33, FACES, FULL, N_E, N_Q, QUANTITIES, STRAINS, Kinematics

Terms = Mapping[str, Mapping[str, float]]


def _none(amount: float, zeta: float) -> float:
    """0."""
    return 0.0


@dataclass(frozen=True)
class RigidBodyLaw:
    """The strain E_aa that a rigid motion leaves on a face, declared as closed forms; 0 where the measure is exact.

    Each law is a function of the amount of motion and of the stretch zeta = 1 + k d of the face:
    translation: of a cylinder, E22 for the amount (U . e2)/R;  out_of_plane: of a plate, the angle theta [rad] about a
    tangent, E_aa normal to it;  drilling: of a plate, theta about its normal;  axis: of a cylinder, theta about its
    own axis, E22. The first line of the docstring of a law is its formula. A measure that passes where it should fail
    is as wrong as one that fails where it should pass.
    """

    translation: Callable[[float, float], float] = _none
    out_of_plane: Callable[[float, float], float] = _none
    drilling: Callable[[float, float], float] = _none
    axis: Callable[[float, float], float] = _none

    @property
    def turns(self) -> bool:
        """Whether a plate may turn about a tangent without a strain."""
        return self.out_of_plane(0.5, 1.0) == 0.0


class StrainFunction(Protocol):
    """Strains E (..., n) of quantities q (..., m), and what their work needs of them."""

    def strain(self, q: np.ndarray) -> np.ndarray:
        """E(q), (..., n), before the shear row factors of the geometry."""
        ...

    def gradient(self, q: np.ndarray) -> np.ndarray:
        """dE/dq, (..., n, m)."""
        ...

    def contract(self, q: np.ndarray, resultants: np.ndarray) -> np.ndarray:
        """Sum over n of H_n d2E_n/dq2, (..., m, m), for resultants H (..., n)."""
        ...


class StrainMeasure(StrainFunction, Protocol):
    """Everything the element needs of a measure: the 11 strains of the 15 quantities, and what is known of them."""

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        ...

    @property
    def reference(self) -> str:
        """The source of the measure."""
        ...

    @property
    def rigid_body_law(self) -> RigidBodyLaw:
        """The strains it is known to leave under rigid motions."""
        ...

    @property
    def kinematics(self) -> Kinematics:
        """What the gradients q leave out for this measure."""
        ...


EXACT_LAW = RigidBodyLaw()


@dataclass(frozen=True, eq=False)
class QuadraticMeasure:
    """E_n = L_n . q + 1/2 q . Q_n . q with constant L (11, 15) and Q (11, 15, 15), symmetric in its last two axes.

    ``reference``: the source of the measure.  ``kinematics``: what its gradients q leave out.  ``meaning``: what it
    assumes or neglects, one line for people.
    """

    name: str
    linear: np.ndarray
    quadratic: np.ndarray
    reference: str
    rigid_body_law: RigidBodyLaw
    kinematics: Kinematics = FULL
    meaning: str = ""

    @cached_property
    def formulas(self) -> dict[str, str]:
        """Each strain, without its face, as a sum of monomials in l, w, t and beta."""
        names = [quantity.rstrip("-+") for quantity in QUANTITIES]
        return {
            strain.rstrip("+"): _polynomial(names, self.linear[row], self.quadratic[row])
            for row, strain in enumerate(STRAINS)
            if not strain.endswith("-")
        }

    def strain(self, q: np.ndarray) -> np.ndarray:
        """E = L q + 1/2 q Q q = (L + dE/dq) q/2, (..., 11)."""
        return 0.5 * np.matmul(self.linear + self.gradient(q), q[..., None])[..., 0]

    def gradient(self, q: np.ndarray) -> np.ndarray:
        """dE/dq = L + Q q, (..., 11, 15)."""
        slope = q.reshape(-1, len(self._table)) @ self._table
        slope += self.linear.ravel()
        return slope.reshape(*q.shape[:-1], *self.linear.shape)

    def contract(self, q: np.ndarray, resultants: np.ndarray) -> np.ndarray:
        """H_n Q_n, (..., 15, 15); constant in q, which only says the batch here."""
        n_e, n_q = self.linear.shape
        flat = resultants.reshape(-1, n_e) @ self.quadratic.reshape(n_e, n_q * n_q)
        return flat.reshape(*q.shape[:-1], n_q, n_q)

    @cached_property
    def _table(self) -> np.ndarray:
        return np.ascontiguousarray(self.quadratic.reshape(self.linear.size, -1).T)


def _polynomial(names: list[str], linear: np.ndarray, quadratic: np.ndarray) -> str:
    """L . q + 1/2 q . Q . q as text, e.g. "l1 + 1/2 l1² + w1 w2"."""
    terms = [(float(linear[i]), names[i]) for i in np.flatnonzero(linear)]
    terms.sort(key=lambda term: term[0] < 0)
    for i, j in zip(*np.nonzero(np.triu(quadratic)), strict=True):
        once = float(quadratic[i, j])
        terms.append((once / 2, f"{names[i]}²") if i == j else (once, f"{names[i]} {names[j]}"))
    text = " ".join(f"{'-' if c < 0 else '+'} {_factor(abs(c))}{monomial}" for c, monomial in terms)
    return text.removeprefix("+ ") or "0"


def _factor(coefficient: float) -> str:
    fraction = Fraction(coefficient).limit_denominator(1000)
    return "" if coefficient == 1 else f"{fraction} " if float(fraction) == coefficient else f"{coefficient:.6g} "


def strain_and_gradient(
    measure: StrainFunction, q: np.ndarray, start: np.ndarray | None = None, at_start: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """E(start + q) - E(start), (..., 11), and dE/dq at start + q, (..., 11, 15); start 0 unless given.

    at_start: dE/dq at ``start``, where that is known.

    Of a quadratic measure the mean of dE/dq at both ends times q, which costs next to nothing beside dE/dq and loses no
    digits where q is far smaller than ``start``; of any other measure the difference.
    """
    at = q if start is None else start + q
    gradient = measure.gradient(at)
    if isinstance(measure, QuadraticMeasure):
        if at_start is not None:
            return 0.5 * np.einsum("...ni,...i->...n", at_start + gradient, q), gradient
        before = measure.linear if start is None else measure.gradient(start)
        return 0.5 * (_times(before, q) + _times(gradient, q)), gradient
    return measure.strain(at) - (0.0 if start is None else measure.strain(start)), gradient


def _times(gradient: np.ndarray, q: np.ndarray) -> np.ndarray:
    return q @ gradient.T if gradient.ndim == 2 else np.matmul(gradient, q[..., None])[..., 0]


def through_thickness(measure: StrainMeasure) -> StrainFunction:
    """E33 (..., 1) of beta (..., 3) at a node, where the measure knows of no other quantity."""
    return restricted(measure, np.array([E33]), np.arange(N_Q)[BETA])


def restricted(measure: StrainMeasure, rows: np.ndarray, quantities: np.ndarray) -> StrainFunction:
    """The strains of these rows by these quantities, where all others are zero."""
    if isinstance(measure, QuadraticMeasure):
        linear = measure.linear[np.ix_(rows, quantities)]
        return replace(measure, linear=linear, quadratic=measure.quadratic[np.ix_(rows, quantities, quantities)])
    return _Restricted(measure, rows, quantities)


@dataclass(frozen=True, eq=False)
class _Restricted:
    """The same by any measure, which works out all strains for it."""

    measure: StrainMeasure
    rows: np.ndarray
    quantities: np.ndarray

    def strain(self, q: np.ndarray) -> np.ndarray:
        return self.measure.strain(_alone(q, self.quantities, N_Q))[..., self.rows]

    def gradient(self, q: np.ndarray) -> np.ndarray:
        return self.measure.gradient(_alone(q, self.quantities, N_Q))[..., self.rows, :][..., self.quantities]

    def contract(self, q: np.ndarray, resultants: np.ndarray) -> np.ndarray:
        among = self.measure.contract(_alone(q, self.quantities, N_Q), _alone(resultants, self.rows, N_E))
        return among[..., self.quantities, :][..., self.quantities]


def _alone(values: np.ndarray, places: np.ndarray, n: int) -> np.ndarray:
    """(..., n) with the values in their places and zeros elsewhere."""
    among = np.zeros((*values.shape[:-1], n))
    among[..., places] = values
    return among


def quadratic_measure(
    name: str,
    terms: Terms,
    *,
    reference: str,
    rigid_body_law: RigidBodyLaw,
    kinematics: Kinematics = FULL,
    meaning: str = "",
) -> QuadraticMeasure:
    """Build a measure from its formulas written as data.

    ``terms`` maps each strain ("E11", "2E12", ..., without face) to {monomial: coefficient}; a monomial is one or two
    quantity names separated by a space ("l1", "l1 w2", "beta3 t1"). l, w and t take the face of the strain.
    Raises ValueError naming the strain or the monomial that does not exist.
    """
    linear, quadratic = np.zeros((N_E, N_Q)), np.zeros((N_E, N_Q, N_Q))
    faceless = {strain.rstrip("-+") for strain in STRAINS}
    for strain, polynomial in terms.items():
        if strain not in faceless:
            raise ValueError(f"measure {name}: unknown strain {strain!r}, choose from {sorted(faceless)}")
        for face in FACES if strain != "E33" else ("",):
            row = STRAINS.index(strain + face)
            for monomial, coefficient in polynomial.items():
                indices = [_quantity(name, factor, face) for factor in monomial.split()]
                if len(indices) == 1:
                    linear[row, indices[0]] += coefficient
                elif len(indices) == 2:
                    quadratic[row, indices[0], indices[1]] += coefficient
                    quadratic[row, indices[1], indices[0]] += coefficient
                else:
                    raise ValueError(f"measure {name}: {monomial!r} is not a monomial of degree 1 or 2")
    for table in (linear, quadratic):
        table.setflags(write=False)
    return QuadraticMeasure(name, linear, quadratic, reference, rigid_body_law, kinematics, meaning)


def _quantity(name: str, factor: str, face: str) -> int:
    for candidate in (factor, factor + face):
        if candidate in QUANTITIES:
            return QUANTITIES.index(candidate)
    raise ValueError(f"measure {name}: unknown quantity {factor!r}, choose from l, w, t with 1 or 2, and beta1..3")

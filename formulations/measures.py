"""The catalogue of strain measures: each a few lines of coefficients beside its equation.

A new quadratic measure is one more table and one more line in :data:`MEASURES`.
"""

from __future__ import annotations

import math

from formulations.measure import QuadraticMeasure, StrainMeasure, Terms, quadratic_measure

# Exact (Green-Lagrange at the faces): vanishes under any rigid motion, to rounding.
#   E_aa  = l_a + (l_a^2 + w_a^2 + t_a^2)/2
#   2E_12 = w1 + w2 + l1 w2 + l2 w1 + t1 t2
#   2E_a3 = beta_a - t_a + beta_a l_a + beta_g w_a - beta3 t_a          (times zeta_a/zbar_a, the geometry's)
#   E_33  = beta3 + (beta1^2 + beta2^2 + beta3^2)/2
EXACT_TERMS: Terms = {
    "E11": {"l1": 1, "l1 l1": 1 / 2, "w1 w1": 1 / 2, "t1 t1": 1 / 2},
    "E22": {"l2": 1, "l2 l2": 1 / 2, "w2 w2": 1 / 2, "t2 t2": 1 / 2},
    "2E12": {"w1": 1, "w2": 1, "l1 w2": 1, "l2 w1": 1, "t1 t2": 1},
    "2E13": {"beta1": 1, "t1": -1, "beta1 l1": 1, "beta2 w1": 1, "beta3 t1": -1},
    "2E23": {"beta2": 1, "t2": -1, "beta2 l2": 1, "beta1 w2": 1, "beta3 t2": -1},
    "E33": {"beta3": 1, "beta1 beta1": 1 / 2, "beta2 beta2": 1 / 2, "beta3 beta3": 1 / 2},
}

# Linear: the same without its quadratic terms.
LINEAR_TERMS: Terms = {
    strain: {monomial: c for monomial, c in polynomial.items() if " " not in monomial}
    for strain, polynomial in EXACT_TERMS.items()
}

EXACT: QuadraticMeasure = quadratic_measure(
    "exact",
    EXACT_TERMS,
    reference="Kulikov and Plotnikova, CMAME 192 (2003) 851-875; Grigolyuk et al. (2004), eqs 2-3",
    rotation_law=lambda theta: 0.0,
)
LINEAR: QuadraticMeasure = quadratic_measure(
    "linear",
    LINEAR_TERMS,
    reference="Grigolyuk et al. (2004), eq. 3, e-terms only",
    rotation_law=lambda theta: math.cos(theta) - 1.0,
)

MEASURES: dict[str, StrainMeasure] = {measure.name: measure for measure in (EXACT, LINEAR)}

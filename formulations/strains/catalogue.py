"""The catalogue of strain measures: each a few lines of coefficients beside its equation.

A new quadratic measure is one more table and one more name in :data:`MEASURES`. All E_a3 rows are multiplied by
zeta_a/zbar_a, which belongs to the geometry. Sources that were not at hand when a table was written say "recalled".
"""

import math

from formulations.strains.elongation import ElongationMeasure
from formulations.strains.measure import EXACT_LAW, RigidBodyLaw, StrainMeasure, Terms, quadratic_measure
from formulations.strains.quantities import Kinematics


def _cosine(theta: float, zeta: float) -> float:
    """Cosine of theta less 1, about -theta^2/2: the linear law."""
    return math.cos(theta) - 1.0


def _quartic(theta: float, zeta: float) -> float:
    """-(1 - cos theta)^2/2, about -theta^4/8: the linear law and half the square of the sine of the rotation."""
    return -((1.0 - math.cos(theta)) ** 2) / 2


def _slope(amount: float, zeta: float) -> float:
    """(amount/zeta)^2/2: a displacement across the normal counts as a slope."""
    return (amount / zeta) ** 2 / 2


def _thin(theta: float, zeta: float) -> float:
    """zeta (zeta - 1)(1 - cos theta): the stretch of the faces is missing."""
    return zeta * (zeta - 1) * (1 - math.cos(theta))


# Exact (Green-Lagrange at the faces): vanishes under any rigid motion, to rounding.
#   E_aa  = l_a + (l_a^2 + w_a^2 + t_a^2)/2
#   2E_12 = w1 + w2 + l1 w2 + l2 w1 + t1 t2
#   2E_a3 = beta_a - t_a + beta_a l_a + beta_g w_a - beta3 t_a
#   E_33  = beta3 + (beta1^2 + beta2^2 + beta3^2)/2
EXACT_TERMS: Terms = {
    "E11": {"l1": 1, "l1 l1": 1 / 2, "w1 w1": 1 / 2, "t1 t1": 1 / 2},
    "E22": {"l2": 1, "l2 l2": 1 / 2, "w2 w2": 1 / 2, "t2 t2": 1 / 2},
    "2E12": {"w1": 1, "w2": 1, "l1 w2": 1, "l2 w1": 1, "t1 t2": 1},
    "2E13": {"beta1": 1, "t1": -1, "beta1 l1": 1, "beta2 w1": 1, "beta3 t1": -1},
    "2E23": {"beta2": 1, "t2": -1, "beta2 l2": 1, "beta1 w2": 1, "beta3 t2": -1},
    "E33": {"beta3": 1, "beta1 beta1": 1 / 2, "beta2 beta2": 1 / 2, "beta3 beta3": 1 / 2},
}
EXACT = quadratic_measure(
    "exact",
    EXACT_TERMS,
    meaning="Green-Lagrange strain of both faces; neglects nothing",
    reference="Kulikov and Plotnikova, CMAME 192 (2003) 851-875; Grigolyuk et al. (2004), eqs 2-3",
    rigid_body_law=EXACT_LAW,
)


def _keeping(*quantities: str) -> Terms:
    """The linear terms of the exact measure, and its products of two of the quantities."""
    kept = set(quantities)
    return {
        strain: {
            monomial: c for monomial, c in terms.items() if " " not in monomial or kept.issuperset(monomial.split())
        }
        for strain, terms in EXACT_TERMS.items()
    }


# Linear: the same without its quadratic terms.
LINEAR_TERMS = _keeping()
LINEAR = quadratic_measure(
    "linear",
    LINEAR_TERMS,
    meaning="small strains and rotations; neglects all products of gradients",
    reference="Grigolyuk et al. (2004), eq. 3, e-terms only",
    rigid_body_law=RigidBodyLaw(out_of_plane=_cosine, drilling=_cosine, axis=_cosine),
)

# Von Karman: t_a^2 and t1 t2 in the tangential strains, everything else linear.
#   E_aa  = l_a + t_a^2/2
#   2E_12 = w1 + w2 + t1 t2
VON_KARMAN_TERMS = _keeping("t1", "t2")
VON_KARMAN = quadratic_measure(
    "von-karman",
    VON_KARMAN_TERMS,
    meaning="moderate slopes of a thin plate or shell; neglects all products but those of the slopes t",
    reference="von Kármán (1910), with the full slope t of the curved shell",
    rigid_body_law=RigidBodyLaw(out_of_plane=_quartic, drilling=_cosine, axis=_quartic),
)

# Donnell: von Karman with th_a = -v3,a/A_a. Even a translation strains a curved shell, because U . e3 has a slope.
DONNELL = quadratic_measure(
    "donnell",
    VON_KARMAN_TERMS,
    meaning="von Kármán for shallow shells; neglects tangential displacements in the slopes, too",
    reference="Donnell, NACA Report 479 (1933); Mushtari (1938)",
    rigid_body_law=RigidBodyLaw(translation=_slope, out_of_plane=_quartic, drilling=_cosine, axis=_cosine),
    kinematics=Kinematics(shallow=True),
)

# Sanders: von Karman and half the square of the rotation about the normal, (w1 - w2)/2.
DRILLING = {"w1 w1": 1 / 8, "w1 w2": -1 / 4, "w2 w2": 1 / 8}
SANDERS = quadratic_measure(
    "sanders",
    {
        **VON_KARMAN_TERMS,
        "E11": {"l1": 1, "t1 t1": 1 / 2, **DRILLING},
        "E22": {"l2": 1, "t2 t2": 1 / 2, **DRILLING},
    },
    meaning="von Kármán and the rotation about the normal; neglects products with elongations",
    reference="Sanders, Q. Appl. Math. 21 (1963) 21-36; Nemeth, NASA/TP-2013-218025 (recalled)",
    rigid_body_law=RigidBodyLaw(out_of_plane=_quartic, drilling=_quartic, axis=_quartic),
)

# Novozhilov, small elongations: l_a and beta3 dropped beside 1 in the products, rotations kept.
#   E_aa  = l_a + (w_a^2 + t_a^2)/2
#   2E_12 = w1 + w2 + t1 t2
#   2E_a3 = beta_a - t_a + beta_g w_a
#   E_33  = beta3 + (beta1^2 + beta2^2)/2
NOVOZHILOV = quadratic_measure(
    "novozhilov",
    _keeping("w1", "w2", "t1", "t2", "beta1", "beta2"),
    meaning="small elongations, large rotations; neglects l and beta3 compared with 1",
    reference="Novozhilov, Foundations of the Nonlinear Theory of Elasticity (1953), small elongations (recalled)",
    rigid_body_law=RigidBodyLaw(out_of_plane=_quartic, drilling=_quartic, axis=_quartic),
)

# Moderate rotations of a shear-deformable shell: the director's products with the gradients kept, but beta3 t_a.
#   E_aa, 2E_12 of von Karman
#   2E_a3 = beta_a - t_a + beta_a l_a + beta_g w_a
#   E_33  = beta3 + (beta1^2 + beta2^2)/2
_DIRECTOR = _keeping("l1", "l2", "w1", "w2", "beta1", "beta2")
MODERATE_ROTATION = quadratic_measure(
    "moderate-rotation",
    {
        **VON_KARMAN_TERMS,
        **{strain: _DIRECTOR[strain] for strain in ("2E13", "2E23", "E33")},
    },
    meaning="moderate rotations of a director; neglects beta3 t and tangential products but those of t",
    reference="Schmidt and Reddy, J. Appl. Mech. 55 (1988) 611-617; Librescu and Schmidt (1988) (recalled)",
    rigid_body_law=RigidBodyLaw(out_of_plane=_quartic, drilling=_cosine, axis=_quartic),
)

# Thin-shell Green-Lagrange: the exact terms with zeta = 1. A turning cylinder strains where its faces are stretched.
THIN_GREEN_LAGRANGE = quadratic_measure(
    "thin-green-lagrange",
    EXACT_TERMS,
    meaning="Green-Lagrange strain of a thin shell; neglects the stretch of the faces by the curvature",
    reference="the exact measure in the limit k d -> 0, Grigolyuk et al. (2004), eq. 3 with zeta = 1",
    rigid_body_law=RigidBodyLaw(axis=_thin),
    kinematics=Kinematics(thin=True),
)

MEASURES: dict[str, StrainMeasure] = {
    measure.name: measure
    for measure in (
        EXACT,
        LINEAR,
        VON_KARMAN,
        DONNELL,
        SANDERS,
        NOVOZHILOV,
        MODERATE_ROTATION,
        THIN_GREEN_LAGRANGE,
        ElongationMeasure(EXACT),
    )
}

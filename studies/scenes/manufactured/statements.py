"""Pieces of surfaces, the fields that move them, and what each measure states of these, in vectors.

Every coordinate system of the catalogue of surfaces is here, with curvatures of either sign. No mesh enters.

Six strains of one face follow from the gradient of its displacement, H (..., 3, 3) in the frame (e1, e2, e3): columns
du/ds1 and du/ds2 along the face and beta = (u+ - u-)/h across it. They are E11, E22, 2E12, 2E13, 2E23, E33. No table of
coefficients may enter here: these formulas are what the tables of :mod:`formulations.strains.catalogue` are judged by.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from formulations.geometry import surfaces
from formulations.section.laminate import Laminate, Ply
from formulations.strains.measure import QuadraticMeasure, StrainMeasure
from formulations.strains.quantities import N_Q, QUANTITIES, STRAINS
from studies.scenes.element import Span

_AXIS = np.array([0.6, -0.5, 0.8]) / np.sqrt(1.25)
SPIN = np.cross(np.eye(3), -_AXIS)  # SPIN @ x = axis x x
_WAVES = np.array([[1.1, 0.4, -0.6], [-0.5, 1.3, 0.7], [0.8, -0.9, 1.0]])  # no two alike, none along an axis
_PHASES = np.array([0.3, 1.1, 2.0])


@dataclass(frozen=True)
class Piece:
    """A rectangle in the coordinates of a surface; lengths are about 1 [mm]."""

    surface: surfaces.Surface
    a1: Span
    a2: Span

    def distance(self, a: np.ndarray) -> np.ndarray:
        """r^2 (...) of points (..., 2): the sum of both squared distances from the middle, each 1 at the edges."""
        ends = np.array([self.a1, self.a2])
        return np.asarray(np.sum(((a - ends.mean(axis=1)) / (0.5 * np.ptp(ends, axis=1))) ** 2, axis=-1))


PIECES: Mapping[str, Piece] = {
    "plate": Piece(surfaces.Plate(), (-0.4, 0.6), (-0.3, 0.5)),
    "annulus": Piece(surfaces.annulus(), (0.6, 1.4), (0.0, 0.8)),
    "cylinder": Piece(surfaces.cylinder(1.0), (0.0, 0.8), (0.2, 1.0)),
    "cone": Piece(surfaces.cone(0.5), (1.0, 1.8), (0.0, 1.0)),
    "sphere": Piece(surfaces.sphere(1.0), (-0.3, 0.5), (0.2, 1.0)),
    "torus": Piece(surfaces.elliptic_torus(2.0, 1.0, 0.7), (0.1, 0.9), (0.0, 0.4)),
    "inner-torus": Piece(surfaces.torus(2.0, 1.0), (2.6, 3.5), (0.0, 0.6)),  # saddle-shaped
    "hyperboloid": Piece(surfaces.hyperboloid(1.0, 1.0), (-0.3, 0.6), (0.0, 0.8)),
}
LAYUPS = ("skew", "isotropic")


def wall(layup: str, h: float) -> Laminate:
    """A wall of thickness h [mm]: two unequal plies that are symmetric nowhere, or one isotropic one, nu = 0.3."""
    if layup == "isotropic":
        return Laminate((Ply.isotropic(10.0, 0.3, h),), -0.4 * h)
    plies = (Ply(30.0, 8.0, 4.0, 3.0, 0.3, 0.4, angle, share * h) for angle, share in ((0.6, 0.6), (-0.9, 0.4)))
    return Laminate(tuple(plies), -0.4 * h)


@dataclass(frozen=True, eq=False)
class TurnedWaves:
    """x = R ((1 + s) X + w sin(K X + c)): a stretch s and waves of amplitude w [mm], turned by R about a skew axis.

    Both faces X = x + d e3 of a shell move so. The stretch keeps what measures see of a rotation, cos(theta) - 1, from
    pressing the shell into waves of its own.
    """

    surface: surfaces.Surface
    laminate: Laminate
    angle: float
    stretch: float
    wave: float

    def __call__(self, a: np.ndarray) -> np.ndarray:
        """u (..., 2, 3) at points a (..., 2)."""
        a1, a2 = np.moveaxis(a, -1, 0)
        X = faces(self.surface, self.laminate, a1, a2)
        return np.asarray(waved(X, self.stretch, self.wave) @ expm(self.angle * SPIN).T - X)


def waved(X: np.ndarray, stretch: float, wave: float) -> np.ndarray:
    """(1 + s) X + w sin(K X + c), (..., 3)."""
    return np.asarray((1 + stretch) * X + wave * np.sin(X @ _WAVES.T + _PHASES))


def faces(surface: surfaces.Surface, laminate: Laminate, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
    """Positions (..., 2, 3) on the inner and on the outer face."""
    x, normal = surface.position(a1, a2), surface.frame(a1, a2)[..., 2, :]
    return np.stack([x + d * normal for d in (laminate.d_minus, laminate.d_plus)], axis=-2)


Statement = Callable[[np.ndarray], np.ndarray]  # H (..., 3, 3) -> strains (..., 6)
SAMPLES = 400  # of random gradients
STEP = 0.02  # of H: exact to rounding for products of two, to 1e-12 for stretches
CENTRAL_8 = ((1, 4 / 5), (2, -1 / 5), (3, 4 / 105), (4, -1 / 280))


def strains_of(E: np.ndarray) -> np.ndarray:
    """The six strains (..., 6) of a tensor E (..., 3, 3)."""
    shears = [2 * E[..., a, b] for a, b in ((0, 1), (0, 2), (1, 2))]
    return np.stack([E[..., 0, 0], E[..., 1, 1], *shears, E[..., 2, 2]], axis=-1)


def symmetric(H: np.ndarray) -> np.ndarray:
    """(H + H^T)/2."""
    return 0.5 * (H + H.swapaxes(-1, -2))


def products(H: np.ndarray) -> np.ndarray:
    """H^T H/2."""
    return 0.5 * np.einsum("...ka,...kb->...ab", H, H)


def linear(H: np.ndarray) -> np.ndarray:
    """The symmetric part of H."""
    return strains_of(symmetric(H))


def green_lagrange(H: np.ndarray) -> np.ndarray:
    """(F^T F - 1)/2 with F = 1 + H."""
    return strains_of(symmetric(H) + products(H))


def von_karman(H: np.ndarray) -> np.ndarray:
    """Products of the slopes e3 . du/ds_a alone."""
    slopes = np.zeros_like(H)
    slopes[..., 2, :2] = H[..., 2, :2]
    return strains_of(symmetric(H) + products(slopes))


def sanders(H: np.ndarray) -> np.ndarray:
    """Von Karman and half the square of the rotation (H21 - H12)/2 about the normal, in both elongations."""
    turn = 0.5 * (H[..., 1, 0] - H[..., 0, 1])
    strains = von_karman(H)
    strains[..., :2] += 0.5 * turn[..., None] ** 2
    return strains


def novozhilov(H: np.ndarray) -> np.ndarray:
    """Elongations left out beside 1: products of H without its diagonal."""
    return strains_of(symmetric(H) + products(H * (1 - np.eye(3))))


def moderate_rotation(H: np.ndarray) -> np.ndarray:
    """Von Karman along the face; across it the products of H without its slopes and beta3."""
    in_plane = H.copy()
    in_plane[..., 2, :] = 0.0
    strains = von_karman(H)
    strains[..., 3:] = strains_of(symmetric(H) + products(in_plane))[..., 3:]
    return strains


def elongation(H: np.ndarray) -> np.ndarray:
    """Stretches of three fibres less 1, and by how much the angles between them have closed."""
    F = np.eye(3) + H
    stretch = np.sqrt(np.einsum("...ka,...ka->...a", F, F))
    angles = [
        np.arcsin(np.einsum("...k,...k->...", F[..., a], F[..., b]) / (stretch[..., a] * stretch[..., b]))
        for a, b in ((0, 1), (0, 2), (1, 2))
    ]
    return np.stack([stretch[..., 0] - 1, stretch[..., 1] - 1, *angles, stretch[..., 2] - 1], axis=-1)


STATEMENTS: Mapping[str, Statement] = {
    "exact": green_lagrange,
    "linear": linear,
    "von-karman": von_karman,
    "donnell": von_karman,  # of slopes without the turning of the frame
    "sanders": sanders,
    "novozhilov": novozhilov,
    "moderate-rotation": moderate_rotation,
    "thin-green-lagrange": green_lagrange,  # of gradients by the lengths of the reference surface
    "elongation": elongation,
}


def statement_of(measure: StrainMeasure) -> Statement:
    """What a measure of the catalogue states; of any other, what its own strains are: then they are not judged."""
    return STATEMENTS.get(measure.name) or own_statement(measure)


def own_statement(measure: StrainMeasure) -> Statement:
    """The strains that a measure itself finds on the inner face where both faces move alike."""
    rows = [i for i, name in enumerate(STRAINS) if not name.endswith("+")]

    def statement(H: np.ndarray) -> np.ndarray:
        return measure.strain(quantities(H))[..., rows]

    return statement


def quantities(H: np.ndarray) -> np.ndarray:
    """q (..., 15) of a gradient H (..., 3, 3) that both faces have: l and w along the face, t = -H3a, beta."""
    by_name = {f"beta{i + 1}": H[..., i, 2] for i in range(3)}
    for a in (0, 1):
        parts = {"l": H[..., a, a], "w": H[..., 1 - a, a], "t": -H[..., 2, a]}
        by_name |= {f"{name}{a + 1}{face}": part for name, part in parts.items() for face in "-+"}
    return np.stack([by_name[name] for name in QUANTITIES], axis=-1)


def work_gradient(statement: Statement, H: np.ndarray, resultants: np.ndarray) -> np.ndarray:
    """P_ia = sum over n of S_n dE_n/dH_ia, (..., 3, 3), for S (..., 6), by 8th-order differences."""
    P = np.zeros(H.shape)
    for i, a in np.ndindex(3, 3):
        step = np.zeros((3, 3))
        step[i, a] = STEP
        for j, weight in CENTRAL_8:
            change = statement(H + j * step) - statement(H - j * step)
            P[..., i, a] += weight / STEP * np.sum(resultants * change, axis=-1)
    return P


@dataclass(frozen=True)
class WrongCoefficient:
    """A coefficient of a table that is not what the measure states; monomial: of q, e.g. "l1+ w2+"."""

    strain: str
    monomial: str
    found: float
    stated: float

    def __str__(self) -> str:
        return f"{self.strain}: coefficient of {self.monomial} is {self.found:.6g}, stated {self.stated:.6g}"


def wrong_coefficients(measure: QuadraticMeasure, statement: Statement) -> list[WrongCoefficient]:
    """The coefficients of a table that differ from its statement, by least squares over random gradients of both faces.

    E_n - E_n(stated) is a sum of monomials of q of degree 1 and 2; on more samples than the 135 monomials its
    coefficients are unique. Those below 1e-6 are rounding.
    """
    rng = np.random.default_rng(2004)
    H = rng.uniform(-0.5, 0.5, (SAMPLES, 2, 3, 3))
    H[:, 1, :, 2] = H[:, 0, :, 2]  # one beta
    inner, outer = (quantities(H[:, face]) for face in (0, 1))
    q = np.where([name.endswith("+") for name in QUANTITIES], outer, inner)
    stated = statement(H)
    pairs = [(i, j) for i in range(N_Q) for j in range(i, N_Q)]
    monomials = [(name,) for name in QUANTITIES] + [(QUANTITIES[i], QUANTITIES[j]) for i, j in pairs]
    table = np.concatenate([q, np.stack([q[:, i] * q[:, j] for i, j in pairs], axis=-1)], axis=1)
    rows = [(name, int(name.endswith("+"))) for name in STRAINS]
    six = [name.rstrip("-+") for name in STRAINS if not name.endswith("+")]
    off = measure.strain(q) - np.stack([stated[:, face, six.index(name.rstrip("-+"))] for name, face in rows], axis=-1)
    excess, *_ = np.linalg.lstsq(table, off, rcond=None)
    wrong = []
    for m, n in zip(*np.nonzero(np.abs(excess) > 1e-6), strict=True):
        indices = [QUANTITIES.index(name) for name in monomials[m]]
        terms = measure.linear if len(indices) == 1 else measure.quadratic
        coefficient = float(terms[(n, *indices)]) / (2 if len(indices) == 2 and indices[0] == indices[1] else 1)
        stated_value = round(coefficient - float(excess[m, n]), 9) + 0.0
        wrong.append(WrongCoefficient(STRAINS[n], " ".join(monomials[m]), coefficient, stated_value))
    return wrong

"""Exact solutions by themselves, without a mesh: strains against the tables, loads in balance, spectral derivatives."""

from collections.abc import Callable

import numpy as np
import pytest

from formulations.section.laminate import Laminate
from formulations.strains.catalogue import MEASURES
from formulations.strains.quantities import gradient_coefficients, shear_row_factors
from studies.scenes.manufactured.contact_scene import OntoBall, Touching
from studies.scenes.manufactured.solution import Chebyshev, Exact, Patch
from studies.scenes.manufactured.statements import PIECES, TurnedWaves, faces, wall
from support.problems.differences import central_difference

POINTS = np.array([[0.2, 0.7], [0.55, 0.31], [0.9, 0.05]])  # shares of the sides


def at(piece: str) -> np.ndarray:
    low, high = np.array([PIECES[piece].a1, PIECES[piece].a2]).T
    return low + POINTS * (high - low)


def exact(piece: str, measure: str = "exact", angle: float = 0.5) -> Exact:
    surface, laminate = PIECES[piece].surface, wall("skew", 0.18)
    field = TurnedWaves(surface, laminate, angle, 0.15, 0.04)
    patch = Patch.over(PIECES[piece].a1, PIECES[piece].a2)
    return Exact(surface, laminate, MEASURES[measure], laminate.stiffness(), patch, field)


def components(solution: Exact, a: np.ndarray) -> np.ndarray:
    """The six face displacements (p, 6) in the local frames."""
    return np.einsum("pix,pfx->pif", solution.surface.frame(*a.T), solution.displacement(a)).reshape(len(a), 6)


@pytest.mark.parametrize(
    ("piece", "measure"), [*((piece, "exact") for piece in PIECES), *(("inner-torus", each) for each in MEASURES)]
)
def test_strains_are_those_of_the_gradients_of_components(piece: str, measure: str) -> None:
    """Two ways that share neither frame derivatives, nor curvatures, nor coefficients."""
    solution, a, own = exact(piece, measure), at(piece), MEASURES[measure]
    geometry = solution.surface.geometry(*a.T)
    d = solution.laminate.d_minus, solution.laminate.d_plus
    v = [components(solution, a)]
    for axis in (0, 1):
        v.append(central_difference(lambda t, i=axis: components(solution, a + t * np.eye(2)[i]), 5e-3))
    C = gradient_coefficients(geometry, *d, own.kinematics)
    q = sum(np.einsum("pqv,pv->pq", c, each) for c, each in zip(C, v, strict=True))
    rows = shear_row_factors(geometry, *d, own.kinematics)
    np.testing.assert_allclose(solution.strains(a), rows * own.strain(q), atol=1e-10)


def over(
    patch: Patch, density: Callable[[np.ndarray], np.ndarray], axis: int | None = None, end: int = 0
) -> np.ndarray:
    """Integral over the rectangle, or along the edge a_axis = its first (0) or last (1) value, by Gauss points."""
    x, w = np.polynomial.legendre.leggauss(24)
    sides = [(each.points[0], each.points[-1]) for each in patch.axes]
    lines = [0.5 * (high - low) * x + 0.5 * (high + low) for low, high in sides]
    weights = [0.5 * (high - low) * w for low, high in sides]
    if axis is not None:
        lines[axis], weights[axis] = np.array([sides[axis][end]]), np.ones(1)
    a = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)
    return np.einsum("i,j,ijx->x", *weights, density(a))


def lengths(laminate: Laminate, piece: str, a: np.ndarray) -> np.ndarray:
    """|Gbar_a| (..., 2), by the geometry of the surface."""
    g = PIECES[piece].surface.geometry(a[..., 0], a[..., 1])
    return g.A * (1 + g.k * 0.5 * (laminate.d_minus + laminate.d_plus))


def resultant(solution: Exact | Touching, laminate: Laminate, piece: str, moment: bool) -> tuple[np.ndarray, float]:
    """Sum of all forces, or of their moments about the origin in the deformed state, and the size of the largest."""
    patch = Patch.over(PIECES[piece].a1, PIECES[piece].a2)

    def summed(force: Callable[[np.ndarray], np.ndarray], measure: Callable[[np.ndarray], np.ndarray]) -> Callable:
        def density(a: np.ndarray) -> np.ndarray:
            f = force(a)
            x = faces(PIECES[piece].surface, laminate, a[..., 0], a[..., 1]) + solution.displacement(a)
            return (np.cross(x, f) if moment else f).sum(axis=-2) * measure(a)[..., None]

        return density

    parts = [over(patch, summed(solution.body_force, lambda a: np.prod(lengths(laminate, piece, a), axis=-1)))]
    for axis in (0, 1):
        for end, sign in ((0, -1.0), (1, 1.0)):
            edge = summed(
                lambda a, i=axis: solution.edge_force(i, a), lambda a, i=axis: lengths(laminate, piece, a)[..., 1 - i]
            )
            parts.append(sign * over(patch, edge, axis, end))
    return np.sum(parts, axis=0), max(np.abs(part).max() for part in parts)


@pytest.mark.parametrize("piece", PIECES)
@pytest.mark.parametrize("moment", [False, True], ids=["forces", "moments"])
def test_loads_are_in_balance(piece: str, moment: bool) -> None:
    """Forces of every measure with full gradients; moments about the deformed shell of an objective one alone."""
    solution = exact(piece)
    total, size = resultant(solution, solution.laminate, piece, moment)
    np.testing.assert_allclose(total, 0, atol=1e-9 * size)


@pytest.mark.parametrize("measure", ["linear", "von-karman", "sanders", "novozhilov", "moderate-rotation"])
def test_moments_balance_for_objective_measures_only(measure: str) -> None:
    solution = exact("torus", measure)
    total, size = resultant(solution, solution.laminate, "torus", moment=False)
    np.testing.assert_allclose(total, 0, atol=1e-9 * size)
    total, size = resultant(solution, solution.laminate, "torus", moment=True)
    assert np.abs(total).max() > 1e-3 * size


def test_a_motion_without_strain_needs_no_load() -> None:
    """A turn of 150 degrees."""
    surface, laminate = PIECES["torus"].surface, wall("skew", 0.18)
    field = TurnedWaves(surface, laminate, np.deg2rad(150), 0.0, 0.0)
    patch = Patch.over(PIECES["torus"].a1, PIECES["torus"].a2)
    turned = Exact(surface, laminate, MEASURES["exact"], laminate.stiffness(), patch, field)
    assert np.abs(turned.body_force(at("torus"))).max() < 1e-7 * np.abs(exact("torus").body_force(at("torus"))).max()


def test_both_sides_of_the_edge_of_contact_agree_on_it() -> None:
    """Displacements and strains; body forces do not, for the curvature has a jump there."""
    piece, laminate = PIECES["torus"], wall("skew", 0.1)
    field = OntoBall(piece, laminate, 0.5, 0.15, 0.04, 2.0, 0.5)
    touching = Touching.on(field, MEASURES["exact"], laminate.stiffness())
    middle, half = np.mean([piece.a1, piece.a2], axis=1), 0.5 * np.ptp([piece.a1, piece.a2], axis=1)
    angle = np.linspace(0, 6, 9)
    edge = middle + 0.5 * half * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    for of in ("displacement", "strains"):
        inside, outside = (getattr(side, of)(edge) for side in (touching.inside, touching.outside))
        np.testing.assert_allclose(inside, outside, atol=1e-10)
    np.testing.assert_allclose(touching.pressure(edge), 0, atol=1e-15)
    x = faces(piece.surface, laminate, *edge.T)[:, 1] + touching.displacement(edge)[:, 1]
    np.testing.assert_allclose(np.linalg.norm(x - field.centre, axis=1), 2.0, atol=1e-14)
    out = middle + 0.6 * half * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    x = faces(piece.surface, laminate, *out.T)[:, 1] + touching.displacement(out)[:, 1]
    np.testing.assert_allclose(np.linalg.norm(x - field.centre, axis=1) - 2.0, 0.1 * 0.11**2, rtol=1e-9)


def test_chebyshev_derivatives_and_values_are_exact_to_rounding() -> None:
    line = Chebyshev.between(-0.3, 0.9)
    np.testing.assert_allclose(line.derivative @ np.sin(3 * line.points), 3 * np.cos(3 * line.points), atol=1e-11)
    x = np.array([-0.3, 0.123, line.points[4], 0.9])
    np.testing.assert_allclose(line.basis(x) @ np.exp(line.points), np.exp(x), rtol=1e-14)

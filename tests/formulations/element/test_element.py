"""The element: its strain modes, its own error under rigid motion, objectivity, zero-energy modes."""

import math

import numpy as np
import pytest
from scipy.linalg import null_space, subspace_angles

from formulations.element.mixed import MEMBRANES, N_M, THICKNESS_STRAINS
from formulations.element.strain_operator import INTERPOLATIONS, ON_LINES
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import SECTIONS
from formulations.strains.quantities import N_E
from support.problems.differences import fitted_order, rotation
from support.problems.shells import PATCHES, SKEW_LAMINATE, make_shell, nodal_components

ROUNDING = 1e-12  # relative to the largest entry of the quantity
ELEMENT_ERROR = (1.8, 2.3)  # order of the element's own error under rigid motion
GAP = 1e6  # between the smallest elastic and the largest zero singular value
ELEMENTS = {
    f"{t}-{m}-{i}": {"thickness_strain": t, "membrane": m, "interpolation": i}
    for t in THICKNESS_STRAINS
    for m in MEMBRANES
    for i in INTERPOLATIONS
} | {
    f"arc-{m}-{i}": {"thickness_strain": "nodal", "membrane": m, "interpolation": i, "bending": "arc"}
    for m in MEMBRANES
    for i in ON_LINES
}

each_section = pytest.mark.parametrize("section", SECTIONS)
each_element = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS)


def largest(array) -> float:
    return float(np.max(np.abs(array)))


# --- the strain modes of the element ------------------------------------------------------------------------------

# xi1^r1 xi2^r2: which of E11-, E11+, E22-, E22+, 2E12-, 2E12+, 2E13-, 2E13+, 2E23-, 2E23+, E33 it carries (the paper)
PAPER_MODES = {(0, 0): range(11), (0, 1): (0, 1, 6, 7, 10), (1, 0): (2, 3, 8, 9, 10), (1, 1): (10,)}


def plate_element_strains(v: np.ndarray, sides: np.ndarray, h: float, points: np.ndarray, measure: str) -> np.ndarray:
    """Strains (points, 11) of a bilinear plate element from base vectors; v (2, 2, 3, 2): corner, corner, i, face."""
    xi, one = points.T, np.ones(len(points))
    N = [np.stack([1 - x, 1 + x]) / 2 for x in xi]
    dN = [np.stack([-one, one]) / side for side in sides]  # d/dx of (1 -+ xi)/2 with x = side xi/2
    gradient = np.stack(
        [np.einsum("ap,bp,abif->pif", dN[0], N[1], v), np.einsum("ap,bp,abif->pif", N[0], dN[1], v)], axis=2
    )
    director = np.einsum("ap,bp,abif->pif", *N, v) @ [-1 / h, 1 / h]
    strains = np.empty((len(points), 11))
    for face in (0, 1):
        H = np.concatenate([gradient[..., face], director[..., None]], axis=2)  # displacement gradient (p, 3, 3)
        E = H + H.swapaxes(1, 2) + (H.swapaxes(1, 2) @ H if measure == "exact" else 0.0)
        for first, i, j in ((0, 0, 0), (2, 1, 1), (4, 0, 1), (6, 0, 2), (8, 1, 2)):
            strains[:, first + face] = E[:, i, j] / (2 if i == j else 1)
        strains[:, 10] = E[:, 2, 2] / 2
    return strains


@each_section
@pytest.mark.parametrize("measure", ["linear", "exact"])
def test_energy_of_a_plate_element_is_that_of_its_projected_strains(rng, measure, section) -> None:
    """1/2 int E.D.E of the strains projected on the modes of the paper, all by a 5 x 5 quadrature of its own."""
    sides = np.array([0.7, 0.4])
    shell = make_shell(Plate(), Grid.tensor([0.0, 0.7], [0.0, 0.4]), measure=measure, section=section)
    v = 0.1 * rng.normal(size=(2, 2, 3, 2))
    t, weight = np.polynomial.legendre.leggauss(5)
    points = np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2)
    weights = np.outer(weight, weight).ravel() / 4
    strains = plate_element_strains(v, sides, SKEW_LAMINATE.thickness, points, measure)
    projected = np.zeros_like(strains)
    for (r1, r2), rows in PAPER_MODES.items():
        mode = points[:, 0] ** r1 * points[:, 1] ** r2
        share = (weights * mode) @ strains[:, rows] / (weights @ mode**2)
        projected[:, rows] += mode[:, None] * share
    density = np.einsum("pi,ij,pj->p", projected, SKEW_LAMINATE.stiffness(section), projected) / 2
    assert shell.energy(v.ravel()) == pytest.approx(sides.prod() * weights @ density, rel=ROUNDING)


def test_relaxed_membrane_shrinks_the_face_mean_of_two_modes_only(curved_patch, rng) -> None:
    """E11 on xi2 and E22 on xi1: the mean over the faces by sqrt(s_a), s_a = 1/(1 + (k_a l_a^2/h)^2), nothing else."""
    grid = curved_patch.grid(1, 1, 0.5)
    u = 0.1 * rng.normal(size=24)
    D = SKEW_LAMINATE.stiffness()
    strains = {}
    for membrane in MEMBRANES:
        H = make_shell(curved_patch.surface, grid, membrane=membrane).resultants(u)[0]
        pieces, start = {}, 0
        for mode, rows in PAPER_MODES.items():
            pieces[mode] = np.linalg.solve(D[np.ix_(rows, rows)], H[start : start + len(rows)])
            start += len(rows)
        strains[membrane] = pieces
    geometry = curved_patch.surface.geometry(*grid.centre.T)
    length = 2 * grid.half[0] * geometry.A[0]
    share = 1 / np.sqrt(1 + (geometry.k[0] * length**2 / SKEW_LAMINATE.thickness) ** 2)
    for mode, rows in PAPER_MODES.items():
        expected = strains["compatible"][mode].copy()
        direction = {(0, 1): 0, (1, 0): 1}.get(mode)
        if direction is not None:
            expected[:2] += (share[direction] - 1) * expected[:2].mean()
        np.testing.assert_allclose(strains["relaxed"][mode], expected, rtol=0, atol=10 * ROUNDING, err_msg=str(rows))
    assert share.min() < 0.99


# --- rigid motion -------------------------------------------------------------------------------------------------


def rigidly(axis, angle: float, shift):
    """Displacement field of a rigid motion."""
    R = rotation(np.asarray(axis, float), angle)
    return lambda x: x @ (R - np.eye(3)).T + shift


def test_element_error_under_rigid_rotation_is_of_second_order(curved_patch) -> None:
    """The measure is exact, the interpolation of components in a turning frame is not."""
    motion = rigidly([0.3, -0.7, 0.5], 1.0, [0.1, 0.2, 0.3])
    counts, errors = np.array([4, 8, 16]), []
    for n in counts:
        grid = curved_patch.grid(n, n, graded=False)
        u = nodal_components(curved_patch.surface, grid, SKEW_LAMINATE, motion)
        errors.append(largest(make_shell(curved_patch.surface, grid).resultants(u)[:, :N_E]))
    assert ELEMENT_ERROR[0] <= fitted_order(1 / counts, errors) <= ELEMENT_ERROR[1]


@each_element
@pytest.mark.parametrize("angle", [2.0, math.pi])
def test_elements_that_turn_without_strain(angle, element) -> None:
    """Flat ones, and those of every surface with interpolated positions: resultants and forces vanish to rounding."""
    size = largest(SKEW_LAMINATE.stiffness())
    for patch in PATCHES.values() if element["interpolation"] != "curvilinear" else [PATCHES["plate"]]:
        grid = patch.grid(3, 4)
        shell = make_shell(patch.surface, grid, **element)
        motion = rigidly([0.3, -0.7, 0.5], angle, [1.0, 2.0, 3.0])
        u = nodal_components(patch.surface, grid, SKEW_LAMINATE, motion)
        assert largest(shell.resultants(u)) <= ROUNDING * size
        assert largest(shell.linearise(u).residual) <= ROUNDING * size


def test_internal_forces_of_a_strained_plate_turn_with_it(rng) -> None:
    """Objectivity: f(R(x + u) - x) = R f(u) and the energy stays, at strains of order one."""
    grid = PATCHES["plate"].grid(3, 2)
    shell = make_shell(Plate(), grid)
    x = np.stack(shell.discretisation.positions(), axis=1)  # (N, face, 3)
    u = 0.2 * rng.normal(size=x.shape)
    R, c = rotation(np.array([0.2, 0.9, -0.4]), 2.3), np.array([1.0, -2.0, 0.5])

    def vector(field: np.ndarray) -> np.ndarray:
        return field.swapaxes(1, 2).ravel()  # (N, face, i) to v1-, v1+, v2-, ...

    before, after = (vector(field) for field in (u, (x + u) @ R.T + c - x))
    force = shell.linearise(before).residual.reshape(-1, 3, 2).swapaxes(1, 2)
    turned = shell.linearise(after).residual
    np.testing.assert_allclose(turned, vector(force @ R.T), rtol=0, atol=10 * ROUNDING * largest(turned))
    assert shell.energy(after) == pytest.approx(shell.energy(before), rel=10 * ROUNDING)


# --- zero-energy modes --------------------------------------------------------------------------------------------


ONE_ELEMENT = [
    *((patch, section, "projected-compatible-curvilinear") for patch in PATCHES for section in SECTIONS),
    *(("wavy", "constant-s33", element) for element in ELEMENTS),
]


@pytest.mark.parametrize(("patch", "section", "element"), dict.fromkeys(ONE_ELEMENT))
def test_one_free_element_has_exactly_six_zero_modes(patch, section, element) -> None:
    patch, element = PATCHES[patch], ELEMENTS[element]
    shell = make_shell(patch.surface, patch.grid(1, 1, size=0.3), section=section, **element)
    values = np.linalg.svd(shell.linearise(np.zeros(24)).tangent.toarray(), compute_uv=False)
    assert values[17] > GAP * values[18]
    assert values[17] > 1e-4 * values[0]  # and none of the 18 is almost zero


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
def test_zero_modes_are_the_rigid_motions(patch, interpolation) -> None:
    """To rounding on a plate and where positions are interpolated; else their angle falls as the size squared."""
    basis = np.eye(3)
    motions = [lambda x, c=c: np.broadcast_to(c, x.shape) for c in basis]
    motions += [lambda x, c=c: np.cross(c, x) for c in basis]
    sizes, angles = (0.4, 0.2, 0.1, 0.05), []
    for size in sizes:
        grid = patch.grid(1, 1, size)
        rigid = [nodal_components(patch.surface, grid, SKEW_LAMINATE, motion) for motion in motions]
        tangent = make_shell(patch.surface, grid, interpolation=interpolation).linearise(np.zeros(24)).tangent.toarray()
        angles.append(np.sin(subspace_angles(null_space(tangent), np.stack(rigid, axis=1))).max())
    if interpolation != "curvilinear" or isinstance(patch.surface, Plate):
        assert max(angles) <= 100 * ROUNDING
    else:
        assert ELEMENT_ERROR[0] <= fitted_order(sizes, angles) <= ELEMENT_ERROR[1]


def test_strains_at_gauss_points_are_those_of_their_modes(rng) -> None:
    """Projected again on a plate, whose rows have no factors, they are what they came from."""
    shell = make_shell(Plate(), Grid.tensor(np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0])))
    geometry, element = shell.discretisation.geometry, shell._element
    modes = rng.normal(size=(2, N_M))
    actual = element.on_modes(geometry, element.at_gauss(geometry, modes), None)
    np.testing.assert_allclose(actual, modes, rtol=0, atol=ROUNDING * 10)

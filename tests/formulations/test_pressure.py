"""Pressure: areas, resultants on deformed surfaces, inflation of cylinder and sphere against closed forms."""

import math

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from formulations.element.strain_operator import INTERPOLATIONS
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate, cylinder, sphere
from formulations.loads import PRESSURE_AREAS, Pressure
from formulations.section.laminate import Laminate, Ply
from support.problems.differences import fitted_order, rotation
from support.problems.shells import PATCHES, SKEW_LAMINATE, make_shell, nodal_components

ROUNDING = 1e-12  # relative
SECOND_ORDER = (1.8, 2.3)
FIRST_ORDER = (0.8, 1.4)
E, NU, R = 210.0, 0.3, 2.0

each_area = pytest.mark.parametrize("area", PRESSURE_AREAS)


def pressure_forces(
    surface, grid: Grid, u: np.ndarray | None = None, interpolation: str = "curvilinear", **pressure
) -> np.ndarray:
    """Local nodal forces (N, 6) of a pressure alone: the difference of two residuals."""
    loaded = make_shell(surface, grid, interpolation=interpolation, pressure=Pressure(**pressure))
    if u is None:
        u = np.zeros(loaded.discretisation.n_free)
    return (loaded.scaled(0.0).linearise(u).residual - loaded.linearise(u).residual).reshape(-1, 6)


def closed_areas(patch_low, patch_high, name: str, d: float) -> float:
    """Area of a patch of the table at the distance d from its surface."""
    (a, c), (b, e) = patch_low, patch_high
    zone = math.sin(b) - math.sin(a)
    return (e - c) * {
        "plate": b - a,
        "cylinder": (2 + d) * (b - a),
        "sphere": (1.5 + d) ** 2 * zone,
        "torus": (1 + d) * (3 * (b - a) + (1 + d) * zone),
    }[name]


@each_area
@pytest.mark.parametrize("follower", [False, True])
@pytest.mark.parametrize("name", ["plate", "cylinder", "sphere", "torus"])
def test_pressure_at_rest_carries_the_area(area, follower, name) -> None:
    """Sum of the forces along e3 = p times the area of the middle surface or of the inner face, by closed form."""
    patch, p = PATCHES[name], 0.7
    d = SKEW_LAMINATE.d_minus if area == "face" else (SKEW_LAMINATE.d_minus + SKEW_LAMINATE.d_plus) / 2
    errors, counts = [], np.array([3, 6, 12])
    for n in counts:
        force = pressure_forces(patch.surface, patch.grid(n, n), value=p, area=area, follower=follower)
        assert np.max(np.abs(force[:, [0, 1, 2, 3, 5]])) <= ROUNDING  # inner face only, along e3 only
        errors.append(abs(force[:, 4].sum() / p / closed_areas(patch.low, patch.high, name, d) - 1))
    if name in ("plate", "cylinder"):
        assert max(errors) <= ROUNDING
    else:
        assert SECOND_ORDER[0] <= fitted_order(1 / counts, errors) <= SECOND_ORDER[1]


@each_area
def test_follower_pressure_on_a_homogeneously_deformed_plate(rng, area) -> None:
    """Nanson: every node of the inner face carries p N_r dA times F e1 x F e2; a rotation turns the dead force."""
    grid, p = PATCHES["plate"].grid(3, 2), -0.7
    turn = rotation(np.array([0.3, -0.7, 0.5]), 2.5)
    for F in (turn, np.eye(3) + 0.5 * rng.normal(size=(3, 3))):
        u = nodal_components(Plate(), grid, SKEW_LAMINATE, lambda x, F=F: x @ (F - np.eye(3)).T)
        force = pressure_forces(Plate(), grid, u, value=p, follower=True, area=area)
        dead = pressure_forces(Plate(), grid, value=p, area=area)
        expected = dead[:, [4]] * np.cross(F[:, 0], F[:, 1])
        np.testing.assert_allclose(force[:, 0::2], expected, rtol=0, atol=10 * ROUNDING)
        assert np.all(force[:, 1::2] == 0)


def swirl(x: np.ndarray) -> np.ndarray:
    """A smooth displacement field with stretches and rotations of order one, nowhere aligned."""
    a, b, c = np.moveaxis(x, -1, 0)
    return 0.4 * np.stack(
        [np.sin(b + a) + 0.3 * c, np.sin(a - 0.5 * b) + 0.5 * a * c, np.cos(a * b) - 0.6 * b], axis=-1
    )


def vector_area(patch, d: float, field) -> np.ndarray:
    """Half the contour integral of x cross dx along the edges of the deformed face at d: the integral of n dA."""
    t, weights = np.polynomial.legendre.leggauss(60)
    corners = np.array([patch.low, (patch.high[0], patch.low[1]), patch.high, (patch.low[0], patch.high[1])])
    total = np.zeros(3)
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):

        def curve(s, start=start, end=end):
            a1, a2 = (start + np.multiply.outer((s + 1) / 2, end - start)).T
            x = patch.surface.position(a1, a2) + d * patch.surface.frame(a1, a2)[:, 2]
            return x + field(x)

        step = 1e-3
        tangent = (8 * (curve(t + step) - curve(t - step)) - curve(t + 2 * step) + curve(t - 2 * step)) / (12 * step)
        total += 0.5 * weights @ np.cross(curve(t), tangent)
    handedness = np.sign(np.linalg.det(patch.surface.frame(*np.array(patch.low))))
    return handedness * total


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
def test_follower_pressure_on_a_deformed_patch_has_the_resultant_of_its_boundary(patch, interpolation) -> None:
    """The resultant of p n dA depends on the edge of the deformed face alone; the error falls with h^2."""
    p, counts, errors = 0.7, np.array([4, 8, 16]), []
    exact = p * vector_area(patch, SKEW_LAMINATE.d_minus, swirl)
    for n in counts:
        grid = patch.grid(n, n, graded=False)
        u = nodal_components(patch.surface, grid, SKEW_LAMINATE, swirl)
        pressure = {"value": p, "follower": True, "area": "face"}
        force = pressure_forces(patch.surface, grid, u, interpolation, **pressure)
        resultant = np.einsum("ni,nix->x", force[:, 0::2], patch.surface.frame(*grid.nodes.T))
        errors.append(np.linalg.norm(resultant - exact) / np.linalg.norm(exact))
    assert errors[-1] < 0.02
    assert SECOND_ORDER[0] <= fitted_order(1 / counts, errors) <= SECOND_ORDER[1]


def test_follower_pressure_of_interpolated_positions_turns_with_the_body(curved_patch, rng) -> None:
    """F(R (x + u)) = R f(x + u) to rounding on every mesh, however coarse: the deformed face is that of the nodes."""
    grid, R = curved_patch.grid(2, 2), rotation(np.array([0.3, -0.7, 0.5]), 2.5)
    shell = make_shell(curved_patch.surface, grid, interpolation="isoparametric")
    x, frame = np.stack(shell.discretisation.positions(), axis=1), curved_patch.surface.frame(*grid.nodes.T)
    u = 0.1 * rng.normal(size=x.shape)  # (N, face, 3)
    spatial = []
    for field in (u, (x + u) @ R.T - x):
        local = np.einsum("nix,nfx->nif", frame, field).ravel()
        force = pressure_forces(curved_patch.surface, grid, local, "isoparametric", value=0.7, follower=True)
        spatial.append(np.einsum("nif,nix->nfx", force.reshape(-1, 3, 2), frame))
    np.testing.assert_allclose(spatial[1], spatial[0] @ R.T, rtol=0, atol=10 * ROUNDING)


def test_unknown_area_is_refused_with_the_choices() -> None:
    with pytest.raises(ValueError, match="'inner' is not one of " + ", ".join(PRESSURE_AREAS)):
        Pressure(1.0, area="inner")


def test_a_follower_acts_on_the_inner_face_unless_it_is_told_otherwise() -> None:
    assert (Pressure(1.0).area, Pressure(1.0, follower=True).area) == ("mid", "face")
    assert Pressure(1.0, follower=True, area="mid").scaled(2.0) == Pressure(2.0, follower=True, area="mid")
    assert Pressure(1.0, follower=True).scaled(2.0) == Pressure(2.0, follower=True)


# --- inflation ----------------------------------------------------------------------------------------------------

SHAPES = {"sphere": sphere, "cylinder": cylinder, "open cylinder": cylinder}


def inflate(shape: str, ply: Ply, d_minus: float, radius: float, mesh: tuple[int, int], **model) -> np.ndarray:
    """Radial displacements (N, 2) of both faces of a symmetric sector; edges slide, an open cylinder is free ahead."""
    grid = Grid.tensor(np.linspace(0, 1.0, mesh[0] + 1), np.linspace(0, 0.6, mesh[1] + 1))
    fixed = np.zeros((grid.n_nodes, 6), bool)
    edges = [(0, 0.0), (1, 0.0), (1, 0.6)] + ([] if shape == "open cylinder" else [(0, 1.0)])
    for axis, value in edges:
        fixed[grid.on_line(axis, value), 2 * axis : 2 * axis + 2] = True
    shell = make_shell(SHAPES[shape](radius), grid, Laminate((ply,), d_minus), fixed=fixed, **model)
    u, memory = np.zeros(shell.discretisation.n_free), None
    for _ in range(12):
        lin = shell.linearise(u, memory)
        du = spsolve(lin.tangent, -lin.residual)
        u, memory = u + du, lin.remember(du)
        if np.linalg.norm(du) <= 1e-9 * np.linalg.norm(u):
            return shell.discretisation.expand(u)[:, 4:]
    raise AssertionError("Newton did not converge")


def lame(shape: str, a: float, b: float, p: float) -> np.ndarray:
    """Radial displacements of the faces a, b of a thick wall under the pressure p inside (Lame; plane strain)."""
    r = np.array([a, b])
    if shape == "sphere":
        return p * a**3 / (E * (b**3 - a**3)) * ((1 - 2 * NU) * r + (1 + NU) * b**3 / (2 * r**2))
    return (1 + NU) * p * a**2 / (E * (b**2 - a**2)) * ((1 - 2 * NU) * r + b**2 / r)


@pytest.mark.parametrize("shape", ["sphere", "cylinder"])
@pytest.mark.parametrize("offset", [-0.5, 0.2])
@pytest.mark.parametrize(
    ("section", "area", "order"),
    [
        ("constant-s33", "face", SECOND_ORDER),
        ("full-3d", "face", SECOND_ORDER),
        ("constant-s33", "mid", FIRST_ORDER),
        ("nonsymmetric", "face", FIRST_ORDER),
    ],
)
def test_thick_walls_against_lame(shape, offset, section, area, order) -> None:
    """Both faces and the change of thickness: of second order in h/R with the true area of the inner face and a
    symmetric section; the area of the middle surface or the nonsymmetric section leave an error of first order."""
    ratios, errors = np.array([0.1, 0.05, 0.025]), []
    for ratio in ratios:
        h = ratio * R
        a, p = R + offset * h, 1.0
        model = {"measure": "linear", "section": section, "pressure": Pressure(p, area=area)}
        w = inflate(shape, Ply.isotropic(E, NU, h), offset * h, R, (32, 1), **model)
        exact = lame(shape, a, a + h, p)
        faces = np.max(np.abs(w / exact - 1))
        thinning = np.max(np.abs((w[:, 1] - w[:, 0]) / (exact[1] - exact[0]) - 1))
        errors.append(max(faces, thinning))
    assert order[0] <= fitted_order(ratios, errors) <= order[1]


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
def test_work_of_a_follower_has_its_gradient_where_edges_are_open(patch, interpolation, rng) -> None:
    """Central differences at two steps: dW/du is what they say, and the force is not, for the edges sweep volume, too.

    W is of the third degree, so the difference is off by the square of the step alone.
    """
    grid = patch.grid(2, 2)
    shell = make_shell(patch.surface, grid, interpolation=interpolation, pressure=Pressure(0.7, follower=True))
    u, along = (0.1 * rng.normal(size=shell.discretisation.n_free) for _ in range(2))
    _, force, gradient = shell.work_of_pressure(u)
    np.testing.assert_allclose(force, shell.scaled(0.0).residual(u) - shell.residual(u), rtol=0, atol=1e-9)

    def slope(step: float) -> float:
        ends = [shell.work_of_pressure(u + sign * step * along)[0] for sign in (1, -1)]
        return (ends[0] - ends[1]) / (2 * step)

    extrapolated = (4 * slope(0.5) - slope(1.0)) / 3
    assert gradient @ along == pytest.approx(extrapolated, rel=1e-9)
    assert abs(force @ along - extrapolated) > 1e-4 * abs(extrapolated)


def test_work_of_a_follower_is_the_volume_that_a_sphere_gains() -> None:
    """A piece of a sphere that grows from r to s: p (s^3 - r^3)/3 times its solid angle, to the second order."""
    patch, p, grown, errors, counts = PATCHES["sphere"], 0.7, 0.8, [], np.array([4, 8, 16])
    (a, c), (b, e) = patch.low, patch.high
    inner = 1.5 + SKEW_LAMINATE.d_minus
    exact = p * ((inner + grown) ** 3 - inner**3) / 3 * (e - c) * (math.sin(b) - math.sin(a))
    for n in counts:
        shell = make_shell(patch.surface, patch.grid(n, n), pressure=Pressure(p, follower=True))
        v = np.zeros((shell.discretisation.grid.n_nodes, 6))
        v[:, 4:] = grown
        errors.append(abs(shell.work_of_pressure(v.ravel())[0] / exact - 1))
    assert SECOND_ORDER[0] <= fitted_order(1 / counts, errors) <= SECOND_ORDER[1]


def test_pressure_on_a_homogeneously_deformed_middle_surface(rng) -> None:
    """Nanson: p N_r dA times F e1 x F e2 of the middle, one half on either face."""
    grid, p = PATCHES["plate"].grid(3, 2), -0.7
    F = np.eye(3) + 0.5 * rng.normal(size=(3, 3))
    u = nodal_components(Plate(), grid, SKEW_LAMINATE, lambda x: x @ (F - np.eye(3)).T)
    force = pressure_forces(Plate(), grid, u, value=p, follower=True, middle=True)
    dead = pressure_forces(Plate(), grid, value=p)
    expected = dead[:, [4]] * np.cross(F[:, 0], F[:, 1]) / 2
    for face in (0, 1):
        np.testing.assert_allclose(force[:, face::2], expected, rtol=0, atol=10 * ROUNDING)


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
def test_tangent_of_a_pressed_middle_surface(patch, interpolation, rng) -> None:
    """The force is quadratic in the displacements, so that central differences have no error but rounding."""
    pressure = Pressure(0.7, follower=True, middle=True)
    shell = make_shell(patch.surface, patch.grid(2, 2), interpolation=interpolation, pressure=pressure)
    without = shell.scaled(0.0)
    u, along = (0.1 * rng.normal(size=shell.discretisation.n_free) for _ in range(2))
    ends = [without.residual(v) - shell.residual(v) for v in (u + along, u - along)]
    tangent = without.linearise(u).tangent - shell.linearise(u).tangent
    np.testing.assert_allclose(tangent @ along, (ends[0] - ends[1]) / 2, rtol=0, atol=1e-9)


@pytest.mark.parametrize("other", [{"follower": False}, {"follower": True, "area": "face"}])
def test_only_a_follower_on_its_own_area_presses_the_middle_surface(other) -> None:
    with pytest.raises(ValueError, match="pressure on the middle surface is that of a follower, on its own area"):
        Pressure(1.0, middle=True, **other)

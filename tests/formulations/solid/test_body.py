"""The 3D judge against closed forms: rigid motion, Lamé's thick tubes and spheres, ply axes."""

import numpy as np
import pytest

from formulations.geometry.surfaces import cylinder, sphere, torus
from formulations.loads import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.solid import SolidDiscretisation, SolidModel
from formulations.solid_mesh import SolidMesh
from support.problems.differences import fitted_order, rotation

ROUNDING = 1e-11
SKEW = Laminate(
    (Ply(30.0, 8.0, 4.0, 3.0, 0.3, 0.4, 0.6, 0.11), Ply(25.0, 9.0, 5.0, 2.5, 0.25, 0.45, -0.9, 0.07)), -0.05
)


def small_body(laminate: Laminate = SKEW, pressure: Pressure | None = None) -> SolidModel:
    mesh = SolidMesh.build(torus(3.0, 1.0), np.linspace(-0.2, 0.5, 3), np.linspace(0.3, 0.9, 2), laminate)
    return SolidModel(SolidDiscretisation.build(mesh, laminate, np.zeros((len(mesh.x), 3), bool)), pressure)


def test_rigid_motion_leaves_no_force(rng) -> None:
    body = small_body()
    R, c = rotation(rng.normal(size=3), 2.0), rng.normal(size=3)
    moved = (body.discretisation.mesh.x @ (R - np.eye(3)).T + c).ravel()
    stiffness = abs(body.linearise(np.zeros(body.discretisation.n_free)).tangent).max()
    assert np.max(np.abs(body.linearise(moved).residual)) <= ROUNDING * stiffness


@pytest.mark.parametrize("follower", [False, True])
def test_tangent_is_the_derivative_of_the_residual(rng, follower) -> None:
    body = small_body(pressure=Pressure(0.7, follower=follower, area="face"))
    u, du = 0.03 * rng.normal(size=(2, body.discretisation.n_free))
    exact = body.linearise(u).tangent @ du
    steps = 2.0 ** -np.arange(4)
    errors = [
        np.linalg.norm((body.linearise(u + t * du).residual - body.linearise(u - t * du).residual) / (2 * t) - exact)
        for t in steps
    ]
    assert abs(fitted_order(steps, errors) - 2) <= 0.01


def test_homogeneous_deformation_stores_the_energy_of_the_ply_law(rng) -> None:
    """The work of the internal forces over u = (F - I) x is the volume integral of S : (F^T F - F^T sym)."""
    body = small_body()
    F = np.eye(3) + 0.1 * rng.normal(size=(3, 3))
    u = (body.discretisation.mesh.x @ (F - np.eye(3)).T).ravel()
    work = body.linearise(u).residual @ u
    E = 0.5 * (F.T @ F - np.eye(3))
    expected = 0.0
    volumes = body.discretisation.volumes
    for element, ply in enumerate(body.discretisation.mesh.ply):
        b = SKEW.plies[ply].stiffness()
        for frame, volume in zip(body.discretisation.mesh.frame[element], volumes[element], strict=True):
            local = frame @ E @ frame.T
            strain = [local[0, 0], local[1, 1], 2 * local[0, 1], local[2, 2], 2 * local[0, 2], 2 * local[1, 2]]
            s = b @ strain
            S = frame.T @ np.array([[s[0], s[2], s[4]], [s[2], s[1], s[5]], [s[4], s[5], s[3]]]) @ frame
            expected += volume * np.sum(F @ S * (F - np.eye(3)))
    assert work == pytest.approx(expected, rel=1e-10)


def lame(inner: float, outer: float, r: float, nu: float, E: float, dim: int) -> float:
    """Radial displacement per unit inner pressure: plane-strain tube (dim 2) or sphere (dim 3)."""
    ratio = inner**dim / (outer**dim - inner**dim)
    if dim == 2:
        return (1 + nu) / E * ratio * ((1 - 2 * nu) * r + outer**2 / r)
    return ratio / E * ((1 - 2 * nu) * r + (1 + nu) * outer**3 / (2 * r**2))


@pytest.mark.parametrize(("surface", "dim"), [(cylinder(1.0), 2), (sphere(1.0), 3)], ids=["tube", "sphere"])
def test_thick_walls_under_pressure_are_lames(surface, dim) -> None:
    E, nu, h, p = 1000.0, 0.3, 0.2, 1e-6
    laminate = Laminate.single(Ply.isotropic(E, nu, h))
    lines1 = np.linspace(0, 0.3, 2) if dim == 2 else np.linspace(0, 0.5, 4)
    lines2 = np.linspace(0, 0.5, 4)
    mesh = SolidMesh.build(surface, lines1, lines2, laminate, per_ply=3)
    # the exact displacement is radial and the same all over a level: one unknown a level, tied by T
    radial = mesh.x / np.linalg.norm(mesh.x[:, :dim] if dim == 2 else mesh.x, axis=1)[:, None]
    radial[:, 2] *= dim == 3
    free = SolidDiscretisation.build(mesh, laminate, np.zeros((len(mesh.x), 3), bool))
    body = SolidModel(free, Pressure(p, area="face"))
    lin = body.linearise(np.zeros(body.discretisation.n_free))
    levels, level = np.unique(np.round(mesh.parameter[:, 2], 9), return_inverse=True)
    T = np.zeros((3 * len(mesh.x), len(levels)))
    for axis in range(3):
        T[3 * np.arange(len(mesh.x)) + axis, level] = radial[:, axis]
    amplitude = np.linalg.solve(T.T @ (lin.tangent @ T), -T.T @ lin.residual)
    exact = [p * lame(0.9, 1.1, 1.0 + z, nu, E, dim) for z in levels]
    assert amplitude == pytest.approx(exact, rel=2e-4)
    assert exact[0] == pytest.approx(p * {2: 4.48695e-3, 3: 1.72936e-3}[dim], rel=1e-5)


def test_the_mass_of_a_face_adds_up_to_its_areas() -> None:
    mesh = small_body().discretisation.mesh
    areas, mass = mesh.face_areas(mesh.outer), mesh.face_mass(mesh.outer)
    assert np.ravel(mass.sum(axis=1)) == pytest.approx(areas, rel=1e-12, abs=1e-15)
    assert abs(mass - mass.T).max() <= 1e-15
    assert np.linalg.eigvalsh(mass.toarray()[np.ix_(areas > 0, areas > 0)]).min() > 0
    tube = 1.0 + SKEW.d_plus
    exact = 0.6 * tube * (3.0 * 0.7 + tube * (np.sin(0.5) + np.sin(0.2)))  # int r ds dphi over the patch of the torus
    assert areas.sum() == pytest.approx(exact, rel=3e-4)  # quadratic edges for arcs of 0.6 rad


def test_a_solid_has_no_middle_surface() -> None:
    with pytest.raises(ValueError, match="true face"):
        small_body(pressure=Pressure(1.0))

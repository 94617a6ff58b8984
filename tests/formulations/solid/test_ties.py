"""Solids with a straight face: a uniform pressure of bilinear patches to the last digit, derivatives, plane strain."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import spsolve

from contact.faces.sampling import areas
from formulations.geometry.surfaces import Plate, cylinder, sphere
from formulations.loads import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.section.laws import LAWS
from formulations.solid import SolidModel
from formulations.solid.ties import TiedSolid, straight_face
from formulations.solid_mesh import SolidMesh
from support.problems.differences import fitted_order

E, NU, H = 100.0, 0.3, 1.5
WALL = Laminate((Ply.isotropic(E, NU, H),), -H)
LAST_DIGITS = 1e-12


def block(*, law: str = "svk", plane_strain: bool = False) -> TiedSolid:
    """On rollers below, at the first a1 and at the first a2, or wherever a1 is; its outer face may meet others."""
    lines = np.array([0.0, 0.4, 1.1, 1.5]), np.array([0.0, 0.7, 1.2])
    mesh = SolidMesh.build(Plate(), *lines, WALL, per_ply=2)
    fixed = np.zeros((len(mesh.x), 3), bool)
    fixed[slice(None) if plane_strain else mesh.on(0, 0.0), 0] = True
    fixed[mesh.on(1, 0.0), 1] = True
    fixed[np.unique(mesh.inner), 2] = True
    return TiedSolid.build(mesh, WALL, fixed, mesh.outer, uniform=plane_strain, law=LAWS[law])


def untied(body: TiedSolid) -> TiedSolid:
    """All nodes of its face for themselves."""
    n = body.solid.discretisation.n_free
    return replace(body, operator=sparse.csr_matrix(sparse.eye_array(n, format="csr")))


def off_uniform(body: TiedSolid, strain: np.ndarray) -> float:
    """Largest distance of small displacements from the field ``strain * x`` under a pressure 1 on patches, relative."""
    mesh, free, patches = body.solid.discretisation.mesh, body.solid.discretisation.free, body.patches
    nodes, forces = np.unique(patches), np.zeros((len(body.solid.discretisation.mesh.x), 3))
    forces[nodes, 2] = -areas(mesh.x, patches)[nodes]
    stiffness = body.linearise(np.zeros(body.n_free)).tangent
    actual = body.expand(spsolve(stiffness, body.operator.T @ forces.ravel()[free]))
    exact = mesh.x * strain + [0.0, 0.0, strain[2] * H]
    return float(np.max(np.abs(actual - exact)) / np.max(np.abs(exact)))


def test_a_uniform_pressure_on_patches_is_a_uniform_stress_to_the_last_digit() -> None:
    """With a quadratic face it is not, by far."""
    strain = np.array([NU, NU, -1.0]) / E
    assert off_uniform(block(), strain) <= LAST_DIGITS
    assert off_uniform(untied(block()), strain) > 0.05


def test_in_plane_strain_one_node_stands_for_its_line_along_a1() -> None:
    body = block(plane_strain=True)
    assert off_uniform(body, np.array([0.0, NU * (1 + NU), NU**2 - 1]) / E) <= LAST_DIGITS
    of_face = 4 * (3 + 2)  # on each of four lines three that move up and two that move aside, too
    behind = 4 * 4 + 3 * 5  # four levels with four that move aside, the lowest without five that move up
    assert body.n_free == of_face + behind


@pytest.mark.parametrize("across", [1, 3])
def test_a_section_has_residual_tangent_and_energy_of_the_whole(rng, across: int) -> None:
    """Of a mesh that is not a grid any more, of two plies, whatever the elements across."""
    plies = Laminate((Ply.isotropic(E, NU, H / 2), Ply.isotropic(3 * E, NU, H / 2)), -H)
    mesh = SolidMesh.build(Plate(), np.linspace(0.0, 1.5, across + 1), np.array([0.0, 0.7, 1.2]), plies)
    x, z = mesh.x[:, 1], mesh.x[:, 2]
    mesh = replace(mesh, x=mesh.x + 0.1 * np.stack([0 * x, x * z, x**2], axis=1))
    fixed = np.zeros((len(mesh.x), 3), bool)
    fixed[:, 0] = fixed[np.unique(mesh.inner)] = True
    body = TiedSolid.build(mesh, plies, fixed, mesh.outer, plane=True, law=LAWS["neo-hooke"])
    u = 0.03 * rng.normal(size=body.n_free)
    section, whole = body.linearise(u), replace(body, section=None).linearise(u)
    for mine, its in ((section.residual, whole.residual), (section.tangent.toarray(), whole.tangent.toarray())):
        np.testing.assert_allclose(mine, its, rtol=0, atol=LAST_DIGITS * np.max(np.abs(its)))
    np.testing.assert_allclose(body.residual(u), section.residual, rtol=0, atol=LAST_DIGITS)
    assert body.energy(u) == pytest.approx(replace(body, section=None).energy(u), rel=LAST_DIGITS)
    across_z = body.expand(u)[np.lexsort(mesh.parameter.T)].reshape(-1, 2 * across + 1, 3)
    np.testing.assert_allclose(across_z, across_z[:, :1] + np.zeros_like(across_z), atol=LAST_DIGITS)


@pytest.mark.parametrize("law", LAWS)
def test_residual_and_tangent_are_derivatives_of_the_energy(rng, law: str) -> None:
    body = block(law=law)
    u, du = 0.03 * rng.normal(size=(2, body.n_free))
    lin, steps = body.linearise(u), 2.0 ** -np.arange(2, 6)
    ends = [(u + t * du, u - t * du) for t in steps]
    slopes = [
        abs((body.energy(a) - body.energy(b)) / (2 * t) - lin.residual @ du)
        for (a, b), t in zip(ends, steps, strict=True)
    ]
    bent = [
        np.linalg.norm((body.residual(a) - body.residual(b)) / (2 * t) - lin.tangent @ du)
        for (a, b), t in zip(ends, steps, strict=True)
    ]
    assert abs(fitted_order(steps, slopes) - 2) <= 0.05
    assert abs(fitted_order(steps, bent) - 2) <= 0.05
    np.testing.assert_allclose(body.residual(u), lin.residual, rtol=0, atol=1e-12 * np.max(np.abs(lin.residual)))


@pytest.mark.parametrize("follower", [False, True])
def test_the_residual_of_a_loaded_solid_is_that_of_its_linearisation(rng, follower: bool) -> None:
    """And its energy the potential of a pressure that does not follow it."""
    free = block().solid.discretisation
    body = SolidModel(free, Pressure(0.7, follower=follower, area="face"), rng.normal(size=free.n_free))
    u, du = 0.03 * rng.normal(size=(2, free.n_free))
    residual = body.linearise(u).residual
    np.testing.assert_allclose(body.residual(u), residual, rtol=0, atol=LAST_DIGITS * np.max(np.abs(residual)))
    assert body.conservative != follower
    if not follower:
        steps = 2.0 ** -np.arange(2, 6)
        off = [abs((body.energy(u + t * du) - body.energy(u - t * du)) / (2 * t) - residual @ du) for t in steps]
        assert abs(fitted_order(steps, off) - 2) <= 0.05


def test_a_face_that_leaves_elements_inside_out_is_refused() -> None:
    wall = Laminate((Ply.isotropic(E, NU, 0.1),), -0.1)
    mesh = SolidMesh.build(cylinder(10.0), np.array([0.0, 1.0]), np.array([0.0, 1.5]), wall)
    with pytest.raises(ValueError, match="inside out"):
        TiedSolid.build(mesh, wall, np.zeros((len(mesh.x), 3), bool), mesh.outer)


def test_axes_turned_about_z_leave_a_wedge_its_planes_of_symmetry_and_its_way_out() -> None:
    angle, wall = np.radians(20.0), Laminate((Ply.isotropic(E, NU, 0.5),), -0.25)
    mesh = SolidMesh.build(sphere(2.0), np.array([0.0, 0.2, 0.5]), np.array([0.0, angle]), wall)
    around = mesh.parameter[:, 1]
    sides = np.concatenate([mesh.on(1, 0.0), mesh.on(1, angle)])
    fixed = np.zeros((len(mesh.x), 3), bool)
    fixed[sides, 1] = True
    body = TiedSolid.build(mesh, wall, fixed, mesh.outer, back=mesh.inner, turned=around)
    across = np.column_stack([-np.sin(around), np.cos(around), 0 * around])
    for each in np.eye(body.n_free):
        assert np.max(np.abs(np.sum(body.expand(each) * across, axis=1)[sides])) <= 1e-15
    faces = np.concatenate([body.face, body.back])
    out = straight_face(len(around), faces) @ np.column_stack([np.cos(around), np.sin(around), 0 * around])
    free = body.solid.discretisation.free
    P = body.operator.toarray()
    u = np.linalg.lstsq(P, out.ravel()[free], rcond=None)[0]
    np.testing.assert_allclose(body.expand(u), out, rtol=0, atol=1e-13)


def test_a_solid_has_a_face_on_both_sides_turned_outwards() -> None:
    wall = Laminate((Ply.isotropic(E, NU, 0.5),), -0.25)
    mesh = SolidMesh.build(sphere(2.0), np.array([0.0, 0.2, 0.5]), np.array([0.0, 0.3]), wall)
    body = TiedSolid.build(mesh, wall, np.zeros((len(mesh.x), 3), bool), mesh.outer, back=mesh.inner)
    x = body.solid.discretisation.mesh.x
    for quads, sign in ((body.patches, 1.0), (body.behind, -1.0)):
        corners = x[quads]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0])
        assert len(quads) == 2
        assert np.all(sign * np.sum(corners.mean(axis=1) * normal, axis=1) > 0)

"""Patch tests: states of constant strain or curvature on an irregular plate, and uniaxial stretch in closed form."""

import math

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from formulations.element.mixed import THICKNESS_STRAINS
from formulations.geometry.grid import Grid, graded_lines
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import SECTIONS, Laminate, Ply
from formulations.strains.quantities import N_E
from support.problems.shells import SKEW_LAMINATE, make_shell

E, NU, H = 210.0, 0.3, 0.25
PATCH = 1e-10  # relative error of a patch test: rounding times the condition number
CLOSED = 1e-9  # relative error of a nonlinear solution that the element can represent

LINES = graded_lines([0.0, 0.7, 2.0], [2, 2]), graded_lines([-0.5, 0.1, 0.9], [1, 3])
ISOTROPIC = Laminate.single(Ply.isotropic(E, NU, H))
# strains (e11, e22, 2e12) and curvatures (k11, k22, 2k12) of the plane midway between the faces; a linear solution
STATE = ((1e-3, -2e-3, 3e-3), (2e-2, -1e-2, 3e-2))


def face_strains(state, h: float) -> np.ndarray:
    """E11-, E11+, E22-, E22+, 2E12-, 2E12+ of a state."""
    membrane, curvature = (np.array(part, float) for part in state)
    return np.stack([membrane - h / 2 * curvature, membrane + h / 2 * curvature], axis=1).ravel()


def plate_field(grid: Grid, state, h: float, stretch: float) -> np.ndarray:
    """Six face displacements (N, 6): u = e x on each face, w = -(k11 x^2 + k22 y^2 + 2k12 xy)/2, and a stretch."""
    x, y = grid.nodes.T
    e = face_strains(state, h).reshape(3, 2)
    (_, _, _), (k11, k22, k12) = state
    w = -(k11 * x**2 + k22 * y**2 + k12 * x * y) / 2
    v = np.empty((grid.n_nodes, 6))
    for face, sign in enumerate((-1, 1)):
        e11, e22, e12 = e[:, face]
        v[:, face] = e11 * x + e12 / 2 * y
        v[:, 2 + face] = e22 * y + e12 / 2 * x
        v[:, 4 + face] = w + sign * h / 2 * stretch
    return v


@pytest.mark.parametrize("section", SECTIONS)
@pytest.mark.parametrize(
    ("laminate", "thickness_strain"),
    [*((SKEW_LAMINATE, each) for each in THICKNESS_STRAINS), (ISOTROPIC, "projected")],
    ids=[*THICKNESS_STRAINS, "isotropic"],
)
def test_linear_patch(laminate, section, thickness_strain) -> None:
    """Edge values of the state given, the inside is found; strains and resultants are the state's in every element.

    The thickness stretch is the one that leaves E33 without a resultant.
    """
    grid, state = Grid.tensor(*LINES), STATE
    shell = make_shell(Plate(), grid, laminate, measure="linear", section=section, thickness_strain=thickness_strain)
    D = laminate.stiffness(section)
    tangential = face_strains(state, laminate.thickness)
    stretch = -D[10, :6] @ tangential / D[10, 10]
    exact = plate_field(grid, state, laminate.thickness, stretch)
    first, second = (np.isin(grid.nodes[:, a], LINES[a][[0, -1]]) for a in (0, 1))
    inside = np.repeat(~(first | second), 6)
    assert inside.sum() == 6 * 3 * 3
    tangent = shell.linearise(np.zeros(exact.size)).tangent
    u = np.where(inside, 0.0, exact.ravel())
    u[inside] = spsolve(tangent[inside][:, inside], -(tangent @ u)[inside])
    np.testing.assert_allclose(u, exact.ravel(), rtol=0, atol=PATCH * np.max(np.abs(exact)))
    expected = D @ np.concatenate([tangential, np.zeros(4), [stretch]])
    actual = shell.resultants(u)
    size = np.max(np.abs(expected))
    np.testing.assert_allclose(
        actual[:, :N_E], np.broadcast_to(expected, (len(actual), N_E)), rtol=0, atol=PATCH * size
    )
    assert np.max(np.abs(actual[:, N_E:])) <= PATCH * size  # the higher modes are silent


@pytest.mark.parametrize("section", SECTIONS)
@pytest.mark.parametrize(("newton", "axis"), [("plain", 0), ("mixed", 1)])
def test_uniaxial_stretch_of_saint_venant_kirchhoff(section, newton, axis) -> None:
    """Dead edge force N = lambda E h (lambda^2 - 1)/2 per width; across and through, 1 - nu (lambda^2 - 1) squared."""
    stretch = 1.4
    across = math.sqrt(1 - NU * (stretch**2 - 1))
    grid = Grid.tensor(*LINES)
    length, width = np.ptp(grid.nodes, axis=0)[[axis, 1 - axis]]
    start = grid.nodes.min(axis=0)
    fixed = np.zeros((grid.n_nodes, 6), bool)
    for a in (0, 1):
        fixed[grid.on_line(a, start[a]), 2 * a : 2 * a + 2] = True  # symmetry
    corners = [grid.node_at(*start), grid.node_at(2.0, start[1]), grid.node_at(start[0], 0.9)]
    fixed[corners, 4] = True
    edge = grid.on_line(axis, start[axis] + length)
    spacing = np.diff(grid.nodes[edge, 1 - axis])
    forces = np.zeros((grid.n_nodes, 6))
    shares = (np.append(0, spacing) + np.append(spacing, 0)) / 2
    force = stretch * E * H * (stretch**2 - 1) / 2
    forces[edge, 2 * axis : 2 * axis + 2] = force * shares[:, None] / 2
    shell = make_shell(Plate(), grid, ISOTROPIC, fixed=fixed, section=section, newton=newton, forces=forces[~fixed])
    u, memory = np.zeros(shell.discretisation.n_free), None
    for _ in range(20):
        lin = shell.linearise(u, memory)
        du = spsolve(lin.tangent, -lin.residual)
        u, memory = u + du, lin.remember(du)
    x = grid.nodes - start
    v = shell.discretisation.expand(u)
    expected = np.empty_like(v)
    expected[:, 2 * axis : 2 * axis + 2] = (stretch - 1) * x[:, [axis]]
    expected[:, 2 - 2 * axis : 4 - 2 * axis] = (across - 1) * x[:, [1 - axis]]
    expected[:, 4], expected[:, 5] = 0.0, (across - 1) * H
    np.testing.assert_allclose(v, expected, rtol=0, atol=CLOSED)
    assert width * force == pytest.approx(forces.sum(), rel=CLOSED)

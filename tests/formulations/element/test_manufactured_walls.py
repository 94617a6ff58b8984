"""Walls with surfaces inside them converge with the square of the mesh to a given large motion, whatever the law.

A bubble of displacements is the solution under the forces that its first Piola-Kirchhoff stresses do work with: F S of
three-dimensional elasticity on the true surface, integrated on shape functions here and not by the element. Strains are
taken at the surfaces and are polynomials between them: what they are not on three, where stresses are not polynomials
either, is left when the mesh is fine. So the bubble is linear through three surfaces, and through five it is quadratic.
"""

from itertools import product

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.geometry.grid import CORNERS
from formulations.section.laminate import Laminate, Ply
from formulations.section.laws import LAWS
from formulations.section.material import VOIGT
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from support.problems.differences import fitted_order
from support.problems.shells import PATCHES

WALL = Laminate((Ply.isotropic(3.0, 0.3, 0.18), Ply.isotropic(1.0, 0.4, 0.12)), -0.12)
CORDED = Laminate(tuple(Ply(20.0, 2.0, 0.8, 0.6, 0.35, 0.5, angle, 0.15) for angle in (0.9, -0.9)), -0.12)
THROUGH = {  # by 1, d and d^2, Cartesian
    "3": np.array([[0.02, -0.03, 0.12], [0.03, 0.02, 0.012]]),
    "5": np.array([[0.02, -0.03, 0.12], [0.1, 0.06, 0.04], [0.2, -0.1, 0.3]]),
}
IN_PLANE, ACROSS = np.polynomial.legendre.leggauss(4), np.polynomial.legendre.leggauss(6)
MESHES = 10, 15, 22


class Bubble:
    """u = b(s) c(d) on a piece, with b = 0 on its edges."""

    def __init__(self, piece, through: np.ndarray) -> None:
        self.surface, self.through = piece.surface, through
        self.start, self.size = np.array(piece.low), np.array(piece.high) - piece.low

    def shape(self, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """b (...) and its derivatives (..., 2)."""
        s = (a - self.start) / self.size
        one, slope = np.sin(np.pi * s), np.pi * np.cos(np.pi * s) / self.size
        return one[..., 0] * one[..., 1], slope * one[..., ::-1]

    def at(self, a: np.ndarray, d: np.ndarray) -> np.ndarray:
        """(..., d, 3), Cartesian."""
        return self.shape(a)[0][..., None, None] * (d[:, None] ** np.arange(len(self.through)) @ self.through)

    def gradient(self, a: np.ndarray, d: float, frame: np.ndarray, stretched: np.ndarray) -> np.ndarray:
        """(..., 3, 3) along e1, e2, n: derivatives stand in columns; stretched (..., 2): A (1 + k d)."""
        b, slope = self.shape(a)
        along = (slope / stretched)[..., None] * (d ** np.arange(len(self.through)) @ self.through)
        across = b[..., None] * (np.array([0.0, 1.0, 2 * d])[: len(self.through)] @ self.through)
        columns = np.concatenate([along, across[..., None, :]], axis=-2)
        return np.einsum("...ic,...bc->...ib", frame, columns)


def lagrange(nodes: np.ndarray) -> list[np.polynomial.Polynomial]:
    """1 at one node, 0 at the others."""
    others = [np.delete(nodes, k) for k in range(len(nodes))]
    return [np.polynomial.Polynomial.fromroots(r) / np.prod(x - r) for x, r in zip(nodes, others, strict=True)]


def forces(body: Discretisation, bubble: Bubble, law: str) -> np.ndarray:
    """int P : grad(N_r L_s e_j) dV on the unknowns."""
    grid, at = body.grid, body.wall.sampling.at
    basis = lagrange(at)
    xi, w = np.array(list(product(IN_PLANE[0], repeat=2))), np.outer(IN_PLANE[1], IN_PLANE[1]).ravel()
    N = np.prod(0.5 * (1 + xi[:, None] * CORNERS), axis=2)
    dN = 0.25 * CORNERS * (1 + xi[:, None] * CORNERS)[..., ::-1]
    a = grid.points(xi)
    half = 0.5 * (grid.nodes[grid.elements[:, 2]] - grid.nodes[grid.elements[:, 0]])
    geometry, frame = bubble.surface.geometry(*np.moveaxis(a, -1, 0)), bubble.surface.frame(*np.moveaxis(a, -1, 0))
    actual, voigt = np.zeros((grid.n_nodes, len(at), 3)), tuple(np.array(VOIGT).T)
    for ply, (low, high) in zip(body.laminate.plies, body.wall.sampling.ends, strict=True):
        for x, weight in zip(*ACROSS, strict=True):
            d = 0.5 * (low + high) + 0.5 * (high - low) * x
            stretched = geometry.A * (1 + geometry.k * d)
            F = np.eye(3) + bubble.gradient(a, d, frame, stretched)
            E = 0.5 * (np.swapaxes(F, -1, -2) @ F - np.eye(3))
            S6, _ = LAWS[law](ply).response(E[(..., *voigt)] * np.array([1, 1, 2, 1, 2, 2]))
            S = np.empty_like(E)
            S[(..., *voigt)] = S[(..., *voigt[::-1])] = S6
            volume = 0.5 * (high - low) * weight * w * np.prod(stretched, axis=-1) * np.prod(half, axis=-1)[:, None]
            P = volume[..., None, None] * np.einsum("egji,egjb->egib", frame, F @ S)  # Cartesian by local
            in_plane = np.einsum("egib,egrb->egri", P[..., :2], dN / (half[:, None, None] * stretched[:, :, None]))
            normal = np.einsum("egi,gr->egri", P[..., 2], N)
            for s, L in enumerate(basis):
                np.add.at(actual[:, s], grid.elements, np.sum(L(d) * in_plane + L.deriv()(d) * normal, axis=1))
    actual = np.einsum("nix,nsx->nsi", body.surface.frame(*grid.nodes.T), actual)
    faces = np.stack([actual[:, 0], actual[:, -1]], axis=-1).reshape(-1, 6)
    return body.map.gather(np.append(faces, actual[:, 1:-1]))


def error(
    patch: str, n: int, surfaces: str, law: str, wall: Laminate = WALL, interpolation: str = "isoparametric"
) -> float:
    """Of the displacements of all surfaces in the middles of the elements, root mean square, over theirs."""
    piece = PATCHES[patch]
    grid, bubble = piece.grid(n, n), Bubble(piece, THROUGH[surfaces])
    held = Supports.of_edges(grid, *["clamped"] * 4).masks
    kinds = MEASURES["exact"].kinematics, interpolation
    body = Discretisation.build(piece.surface, grid, wall, *held, *kinds, ordered=True, surfaces=surfaces)
    options = {"thickness_strain": "balanced", "membrane": "relaxed", "law": law, "newton": "plain"}
    shell = ShellModel(body, MEASURES["exact"], forces=forces(body, bubble, law), **options)
    frame = piece.surface.frame(*grid.nodes.T)
    v = np.einsum("nix,nsx->nsi", frame, bubble.at(grid.nodes, body.wall.sampling.at))
    faces = np.stack([v[:, 0], v[:, -1]], axis=-1).reshape(-1, 6)
    u = body.map.restrict(np.append(faces, v[:, 1:-1]))  # where the iteration starts
    for _ in range(12):
        lin = shell.linearise(u)
        du = spsolve(lin.tangent, lin.residual, permc_spec="NATURAL")
        u -= du
        if np.abs(du).max() <= 1e-10 * np.abs(u).max():
            break
    else:
        pytest.fail("Newton's iteration has not converged")
    v = shell.nodal_displacements(u)
    faces, inside = v[:, :6].reshape(-1, 3, 2), v[:, 6:].reshape(grid.n_nodes, -1, 3)
    local = np.concatenate([faces[:, None, :, 0], inside, faces[:, None, :, 1]], axis=1)
    actual = np.einsum("nix,nsi->nsx", piece.surface.frame(*grid.nodes.T), local)[grid.elements].mean(axis=1)
    exact = bubble.at(grid.centre, body.wall.sampling.at)
    return float(np.linalg.norm(actual - exact) / np.linalg.norm(exact))


CASES = [
    pytest.param(surfaces, patch, law, marks=[] if law == "neo-hooke" else pytest.mark.slow)
    for (surfaces, patch), law in product((("3", "plate"), ("5", "sphere")), LAWS)
]


@pytest.mark.slow
@pytest.mark.parametrize(("surfaces", "patch", "law"), CASES)
def test_order_of_every_law(surfaces, patch, law) -> None:
    errors = [error(patch, n, surfaces, law) for n in MESHES]
    assert fitted_order([1 / n for n in MESHES], errors) >= 1.9
    assert errors[-1] <= 0.01


@pytest.mark.slow
def test_order_on_quadrilaterals() -> None:
    errors = [error("sphere", n, "5", "neo-hooke", interpolation="quads") for n in MESHES]
    assert fitted_order([1 / n for n in MESHES], errors) >= 1.9
    assert errors[-1] <= 0.01


@pytest.mark.slow
def test_order_of_cords_in_rubber() -> None:
    errors = [error("plate", n, "3", "neo-hooke", CORDED) for n in MESHES]
    assert fitted_order([1 / n for n in MESHES], errors) >= 1.9
    assert errors[-1] <= 0.01

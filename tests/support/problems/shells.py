"""Patches of surfaces, a laminate that is nowhere symmetric, small shells on them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import spsolve

from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid, QuadGrid
from formulations.geometry.surfaces import (
    MeridianPoint,
    NodalSurface,
    Plate,
    Surface,
    SurfaceOfRevolution,
    cylinder,
    sphere,
    torus,
)
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES


def wavy_meridian(a1: np.ndarray) -> MeridianPoint:
    """A meridian with nothing constant: A1, k1, k2 and B1 all vary, and a1 is not an arc length."""
    return MeridianPoint(
        r=2 + 0.4 * np.sin(a1),
        z=1.4 * a1 + 0.2 * a1**2,
        dr=0.4 * np.cos(a1),
        dz=1.4 + 0.4 * a1,
        ddr=-0.4 * np.sin(a1),
        ddz=np.full_like(a1, 0.4),
    )


def off_the_axis(x: np.ndarray) -> np.ndarray:
    return x * [1, 1, 0]


def off_the_tube(x: np.ndarray) -> np.ndarray:
    radial = off_the_axis(x)
    return x - 3.0 * radial / np.linalg.norm(radial, axis=-1, keepdims=True)


@dataclass(frozen=True, eq=False)
class Patch:
    """A piece low <= (a1, a2) <= high of a surface; ``outwards(x)`` points away from the inside of the body."""

    surface: Surface
    low: tuple[float, float]
    high: tuple[float, float]
    outwards: Callable[[np.ndarray], np.ndarray]

    def points(self, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
        a = rng.uniform(self.low, self.high, (n, 2))
        return a[:, 0], a[:, 1]

    def grid(self, n1: int, n2: int, size: float = 1.0, *, graded: bool = True) -> Grid:
        """n1 x n2 elements over the fraction ``size`` of the patch, with unequal spacing when ``graded``."""
        lines = []
        for low, high, n in zip(self.low, self.high, (n1, n2), strict=True):
            t = np.linspace(0, 1, n + 1)
            lines.append(low + size * (high - low) * (t + 0.3 * t * (1 - t) if graded else t))
        return Grid.tensor(*lines)


PATCHES = {
    "plate": Patch(Plate(), (-1.0, 0.5), (1.0, 1.7), lambda x: np.broadcast_to([0.0, 0.0, 1.0], x.shape)),
    "cylinder": Patch(cylinder(2.0), (-1.0, 0.2), (1.5, 1.1), off_the_axis),
    "sphere": Patch(sphere(1.5), (-0.9, -0.4), (1.1, 1.0), lambda x: x),
    "torus": Patch(torus(3.0, 1.0), (-2.2, 0.3), (1.2, 1.1), off_the_tube),
    "wavy": Patch(SurfaceOfRevolution(wavy_meridian), (-0.9, -0.7), (1.0, 0.4), off_the_axis),
}

# two unequal plies that are nowhere symmetric: inside to outside, cord angles, offset from the reference surface
SKEW_LAMINATE = Laminate(
    (Ply(30.0, 8.0, 4.0, 3.0, 0.3, 0.4, 0.6, 0.11), Ply(25.0, 9.0, 5.0, 2.5, 0.25, 0.45, -0.9, 0.07)), d_minus=-0.05
)


def make_shell(
    surface: Surface,
    grid: Grid,
    laminate: Laminate = SKEW_LAMINATE,
    *,
    fixed: np.ndarray | None = None,
    hinged: np.ndarray | None = None,
    interpolation: str = "curvilinear",
    measure: str = "exact",
    **model: object,
) -> ShellModel:
    """A shell on the grid, free everywhere unless ``fixed`` (N, 6) or ``hinged`` (N, 3) say otherwise."""
    if fixed is None:
        fixed = np.zeros((grid.n_nodes, 6), bool)
    discretisation = Discretisation.build(surface, grid, laminate, fixed, hinged, interpolation=interpolation)
    return ShellModel(discretisation, MEASURES[measure], **model)


def newton(model: ShellModel, u: np.ndarray, within: float = 1e-13) -> np.ndarray:
    """Newton from u until the last correction is within rounding of u."""
    memory = None
    for _ in range(40):
        lin = model.linearise(u, memory)
        du = spsolve(lin.tangent, -lin.residual)
        u, memory = u + du, lin.remember(du)
        if np.max(np.abs(du)) <= within * np.max(np.abs(u)):
            return u
    raise AssertionError("Newton did not converge")


def nodal_components(
    surface: Surface, grid: Grid, laminate: Laminate, motion: Callable[[np.ndarray], np.ndarray]
) -> np.ndarray:
    """Six local components (6 N,) at the nodes of the displacement field ``motion(x)`` (..., 3) on both faces."""
    a1, a2 = grid.nodes.T
    x, frame = surface.position(a1, a2), surface.frame(a1, a2)
    v = np.empty((grid.n_nodes, 6))
    for face, d in enumerate((laminate.d_minus, laminate.d_plus)):
        v[:, face::2] = np.einsum("...ij,...j->...i", frame, motion(x + d * frame[:, 2]))
    return v.ravel()


def everywhere(body: Discretisation, field: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """The unknowns of a Cartesian displacement field(x (..., 3)) at every surface of every node."""
    frame = body.surface.frame(*body.grid.nodes.T)
    x = body.surface.position(*body.grid.nodes.T)[:, None] + body.wall.sampling.at[:, None] * frame[:, None, 2]
    v = np.einsum("nix,nsx->nsi", frame, field(x))
    faces = np.stack([v[:, 0], v[:, -1]], axis=-1).reshape(-1, 6)
    return body.map.restrict(np.append(faces, v[:, 1:-1]))


QUADRILATERALS = {
    "rhomb of 30 degrees": [[0, 0, 0], [1, 0, 0], [1.866, 0.5, 0], [0.866, 0.5, 0]],
    "trapezoid": [[0, 0, 0], [1, 0, 0], [0.55, 1, 0], [0.45, 1, 0]],
    "kite": [[0, 0, 0], [1, 0.1, 0], [0.6, 0.6, 0], [0.1, 1, 0]],
    "warped": [[0, 0, 0.3], [1, 0, -0.3], [1, 1, 0.3], [0, 1, -0.3]],
}


def quadrilateral(name: str, surfaces: str = "2") -> Discretisation:
    """A free element by itself, thin and isotropic."""
    x = np.array(QUADRILATERALS[name], float)
    normals = np.tile(np.cross(x[2] - x[0], x[3] - x[1]), (4, 1))
    surface = NodalSurface.of(x, normals / np.linalg.norm(normals[0]), np.tile(x[1] - x[0], (4, 1)))
    wall, free = Laminate.single(Ply.isotropic(1.0, 0.3, 0.05)), np.zeros((4, 6), bool)
    grid = QuadGrid.over(np.arange(4)[None])
    return Discretisation.build(surface, grid, wall, free, interpolation="quads", surfaces=surfaces)

"""Shared by the tests of formulations and contact: derivatives, fitted orders, surfaces, small shells and contacts."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import nnls

from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem, ContactSolution
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import MeridianPoint, Plate, Surface, SurfaceOfRevolution, cylinder, sphere, torus
from formulations.section.laminate import Laminate, Ply
from formulations.shell import Discretisation, ShellModel
from formulations.strains.catalogue import MEASURES

CENTRAL_8 = ((1, 4 / 5), (2, -1 / 5), (3, 4 / 105), (4, -1 / 280))  # weights of the 8th-order central difference


def central_difference(f: Callable[[float], np.ndarray], step: float) -> np.ndarray:
    """df/dt at t = 0, error of the order step^8."""
    return sum(weight * (f(j * step) - f(-j * step)) for j, weight in CENTRAL_8) / step


def fitted_order(sizes: Sequence[float], errors: Sequence[float]) -> float:
    """Slope of log(error) over log(size) by least squares; every error must be positive and finite."""
    errors = np.asarray(errors, float)
    assert np.all(errors > 0)
    assert np.all(np.isfinite(errors))
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotation matrix about the axis (Rodrigues)."""
    x, y, z = axis / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def wavy_meridian(a1: np.ndarray) -> MeridianPoint:
    """A meridian with nothing constant: A1, k1, k2 and B1 all vary, and a1 is no arc length."""
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


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(2004)


@pytest.fixture(name="central_difference")
def central_difference_fixture() -> Callable:
    return central_difference


@pytest.fixture(name="fitted_order")
def fitted_order_fixture() -> Callable:
    return fitted_order


@pytest.fixture(name="rotation")
def rotation_fixture() -> Callable:
    return rotation


@pytest.fixture(name="make_shell")
def make_shell_fixture() -> Callable:
    return make_shell


@pytest.fixture(name="nodal_components")
def nodal_components_fixture() -> Callable:
    return nodal_components


@pytest.fixture(name="skew_laminate")
def skew_laminate_fixture() -> Laminate:
    return SKEW_LAMINATE


@pytest.fixture
def patches() -> dict[str, Patch]:
    return PATCHES


@pytest.fixture(params=PATCHES)
def patch(request: pytest.FixtureRequest) -> Patch:
    return PATCHES[request.param]


@pytest.fixture(params=[name for name in PATCHES if name != "plate"])
def curved_patch(request: pytest.FixtureRequest) -> Patch:
    return PATCHES[request.param]


# --- contact ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Linear:
    """A linearisation as the contact package asks for it."""

    residual: np.ndarray
    tangent: sparse.csc_matrix
    scale: float

    def remember(self, du: np.ndarray) -> None:
        return None


def linear_mechanics(K: np.ndarray | sparse.sparray, f: np.ndarray) -> Callable[[np.ndarray, object], Linear]:
    """linearise(u, memory) of r = K u - f."""
    K = sparse.csc_matrix(K)

    def linearise(u: np.ndarray, memory: object) -> Linear:
        internal = K @ u
        return Linear(internal - f, K, max(np.linalg.norm(internal), np.linalg.norm(f)))

    return linearise


@dataclass(frozen=True, eq=False)
class Quadratic:
    """min 1/2 u.K.u - f.u under g0 + G u >= 0, with contact areas w; (n,), (m,), dense matrices."""

    K: np.ndarray
    f: np.ndarray
    G: np.ndarray
    g0: np.ndarray
    w: np.ndarray

    def problem(self, coupling: np.ndarray | None = None) -> ContactProblem:
        G = sparse.csr_matrix(self.G)
        return ContactProblem(
            linear_mechanics(self.K, self.f),
            lambda u: self.g0 + G @ u,
            lambda u: G,
            self.w,
            None if coupling is None else sparse.csr_matrix(coupling),
        )


def stieltjes(rng: np.random.Generator, n: int) -> np.ndarray:
    """Symmetric, diagonally dominant, no positive entry off the diagonal: active sets converge monotonically."""
    links = np.triu(rng.random((n, n)) * (rng.random((n, n)) < 0.5), 1)
    links = links + links.T
    return np.diag(links.sum(axis=1) + rng.uniform(0.1, 1, n)) - links


def definite(rng: np.random.Generator, n: int) -> np.ndarray:
    """Symmetric and positive definite, otherwise arbitrary."""
    root = rng.normal(size=(n, n))
    return root @ root.T / n + 0.2 * np.eye(n)


def random_quadratic(rng: np.random.Generator, kind: str, m: int = 6) -> Quadratic:
    """``obstacle``: M-matrix, one unknown a row; ``definite``: any SPD matrix; ``inclined``: three unknowns a row."""
    per_row = 3 if kind == "inclined" else 1
    n = per_row * m + 2
    K = stieltjes(rng, n) if kind == "obstacle" else definite(rng, n)
    unknowns = rng.permutation(n)[: per_row * m].reshape(m, per_row)
    G = np.zeros((m, n))
    slopes = rng.uniform(0.5, 2, (m, per_row))
    G[np.arange(m)[:, None], unknowns] = -slopes if kind == "obstacle" else slopes * rng.choice([-1, 1], slopes.shape)
    return Quadratic(K, rng.normal(size=n), G, rng.uniform(-0.3, 0.6, m), rng.uniform(0.5, 2, m))


def solve(name: str, problem: ContactProblem, n: int, epsilon: float = math.inf, **options) -> ContactSolution:
    """From rest; skips with the algorithm's own reason where it does not apply."""
    algorithm = ALGORITHMS[name](epsilon=epsilon, **options)
    reason = algorithm.supports(problem)
    if reason is not None:
        pytest.skip(f"{name}: {reason}")
    return algorithm.solve(problem, ContactSolution.at_rest(n, len(problem.weights)))


def by_nnls(data: Quadratic, epsilon: float) -> tuple[np.ndarray, np.ndarray]:
    """u and p from the dual: min 1/2 mu.S.mu + c.mu, mu >= 0, S = G K^-1 G^T + 1/(epsilon W)."""
    flexibility = np.linalg.solve(data.K, data.G.T)
    S = data.G @ flexibility + np.diag(1 / (epsilon * data.w))
    c = data.g0 + data.G @ np.linalg.solve(data.K, data.f)
    root_of_S = np.linalg.cholesky(S)
    mu, _ = nnls(root_of_S.T, -np.linalg.solve(root_of_S, c))
    return np.linalg.solve(data.K, data.f) + flexibility @ mu, mu / data.w


class Contacts:
    """Small contact problems and the parts to build others from."""

    Linear = Linear
    Quadratic = Quadratic
    linear_mechanics = staticmethod(linear_mechanics)
    random_quadratic = staticmethod(random_quadratic)
    definite = staticmethod(definite)
    solve = staticmethod(solve)
    by_nnls = staticmethod(by_nnls)


@pytest.fixture(scope="session")
def contacts() -> type[Contacts]:
    return Contacts

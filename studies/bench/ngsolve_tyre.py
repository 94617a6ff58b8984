"""Tyres by NGSolve: hexahedra of any order through the wall, pressed on the rigid plane.

Everything is one energy (St. Venant-Kirchhoff, follower pressure, penalty of the plane), so that the tangent is
symmetric and Newton minimises. NGSolve: J. Schoeberl, TU Wien, https://ngsolve.org.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from time import process_time
from typing import Any

import ngsolve as ng
import numpy as np
from ngsolve.meshes import MakeStructured3DMesh
from ngsolve.nonlinearsolvers import NewtonSolver

from studies.bench.problems import Solved, size
from studies.scenes.tyre.grid_lines import tyre_lines
from studies.scenes.tyre.model import ORTHOTROPIC

RING, INNER, WALL = 200.0, 50.0, 4.8  # mm: centre of the tube from the axis, radius of its inner face, thickness
CROWN = RING + INNER + WALL  # mm, outer equator from the axis
CLAMP_DEG = 120.0
PRESSURE = 0.15  # MPa
PENALTY = 20.0  # MPa/mm, that of the reference; ten times as much adds 0.02 % to the force of 14x12
CURVED = 3  # order of the geometry, at the least
# what MakeStructured3DMesh calls the faces of a box of (phi, psi, z): phi and psi at both ends, both faces of the wall
BEGIN, END, LOW, HIGH, INSIDE, OUTER = "back", "front", "left", "right", "bottom", "top"
# 6 x 6 points: the pressure has a kink inside the faces, so only the points of the energy give the force of the energy
CONTACT = {"definedon": OUTER, "intrules": {ng.QUAD: ng.IntegrationRule(ng.QUAD, 11)}}
WORK = 1e-4  # (N mm)^(1/2): Newton ends where residual times step is its square
ITERATIONS = 60


@dataclass(frozen=True)
class Isotropic:
    """E [MPa], nu; two mirror planes, so that a quarter is solved."""

    E: float = 20.0
    nu: float = 0.45
    layers: int = 1
    share: int = 4  # of the tyre is 1/share

    def energy(self, G: Any) -> Any:
        """lambda/2 (tr G)^2 + mu G:G [MPa]; G Green-Lagrange, Cartesian."""
        lame, mu = self.E * self.nu / ((1 + self.nu) * (1 - 2 * self.nu)), self.E / (2 * (1 + self.nu))
        return 0.5 * lame * ng.Trace(G) ** 2 + mu * ng.InnerProduct(G, G)


@dataclass(frozen=True)
class AnglePlies:
    """Plies at +gamma, -gamma, ... from the inside, gamma from the meridian: no mirror plane, so the whole is solved.

    ply: E_L, E_T, G_LT, G_TT [MPa], nu_LT, nu_TT, transversely isotropic about the cords.
    """

    ply: tuple[float, ...] = tuple(ORTHOTROPIC.values())
    gamma_deg: float = 52.0
    layers: int = 4
    share: int = 1

    def energy(self, G: Any) -> Any:
        """g.C g/2 [MPa], g = (G_LL, G_TT, G_NN, 2 G_LT, 2 G_LN, 2 G_TN) in the axes of the cords.

        The axes follow the torus: L = cos(gamma) e_psi +- sin(gamma) e_phi, N across the wall.
        """
        radius = ng.sqrt(ng.x**2 + ng.y**2)
        depth = ng.sqrt((radius - RING) ** 2 + ng.z**2)
        c1, s1, c2, s2 = (radius - RING) / depth, ng.z / depth, ng.x / radius, ng.y / radius  # of psi and phi
        e1, e2 = ng.CF((-s1 * c2, -s1 * s2, c1)), ng.CF((-s2, c2, 0))
        N = ng.CF((c1 * c2, c1 * s2, s1))
        sign: Any = ng.CF((-1.0) ** (self.layers - 1))
        for k in reversed(range(1, self.layers)):
            sign = ng.IfPos(depth - INNER - k * WALL / self.layers, sign, (-1.0) ** (k - 1))
        c, s = math.cos(math.radians(self.gamma_deg)), math.sin(math.radians(self.gamma_deg))
        L, T = c * e1 + s * sign * e2, c * e2 - s * sign * e1
        pairs = ((L, L, 1), (T, T, 1), (N, N, 1), (L, T, 2), (L, N, 2), (T, N, 2))
        g = [factor * ng.InnerProduct(a, G * b) for a, b, factor in pairs]
        C = self.stiffness()
        return 0.5 * sum(float(C[i, j]) * g[i] * g[j] for i in range(6) for j in range(6) if C[i, j])

    def stiffness(self) -> np.ndarray:
        """C (6, 6) [MPa]: inverse of the compliance in the axes L, T, N, engineering shears LT, LN, TN."""
        E_L, E_T, G_LT, G_TT, nu_LT, nu_TT = self.ply
        S = np.diag([1 / E_L, 1 / E_T, 1 / E_T, 1 / G_LT, 1 / G_LT, 1 / G_TT])
        S[0, 1] = S[1, 0] = S[0, 2] = S[2, 0] = -nu_LT / E_L
        S[1, 2] = S[2, 1] = -nu_TT / E_T
        C = np.linalg.inv(S)
        return np.where(np.abs(C) > 1e-12 * np.abs(C).max(), C, 0.0)


Wall = Isotropic | AnglePlies


@dataclass
class _Timed:
    """Newton, and the seconds and number of its factorisations."""

    newton: Any
    factorisation: float = 0.0
    iterations: int = 0
    update: Callable[[], None] = field(init=False)

    def __post_init__(self) -> None:
        self.update, self.newton._UpdateInverse = self.newton._UpdateInverse, self._factorise

    def _factorise(self) -> None:
        start = process_time()
        self.update()
        self.factorisation += process_time() - start
        self.iterations += 1

    def converges(self) -> bool:
        """Plain steps: they converge here, and a line search takes a tenth more."""
        failed, _ = self.newton.Solve(maxit=ITERATIONS, maxerr=WORK)
        return not failed


def tyre(mesh: str, delta_mm: float, wall: Wall, order: int) -> Solved:
    """Force of the whole tyre [N].

    mesh: N1xN2 elements over psi and phi, of the quarter psi in [0, clamp], phi in [0, 180 deg] or of the whole.
    delta_mm: travel from first touch when inflated.
    """
    ng.SetNumThreads(1)  # as the shells have
    begun = process_time()
    quarter = wall.share == 4
    solid = torus(size(mesh), wall.layers, order, quarter)
    space = ng.VectorH1(solid, order=order, **held(quarter))
    space = space if quarter else ng.Periodic(space)
    u, plane = ng.GridFunction(space), ng.Parameter(2 * CROWN)  # far away
    energy = total_energy(space, plane, wall)
    start = process_time() - begun
    newton = _Timed(NewtonSolver(energy, u, inverse="sparsecholesky"))
    inflated = newton.converges()
    crown = next(vertex for vertex in solid.vertices if np.allclose(vertex.point, (0, 0, WALL)))
    plane.Set(CROWN + u.vec[space.GetDofNrs(ng.NodeId(ng.VERTEX, crown.nr))[0]] - delta_mm)
    reached = inflated and newton.converges()
    contact = PENALTY * _positive(ng.x + u[0] - plane)
    force = wall.share * float(ng.Integrate(contact * ng.ds(**CONTACT), solid)) if reached else math.nan
    seconds = process_time() - begun
    rest = seconds - start - newton.factorisation
    return Solved(force, space.ndof, newton.iterations, seconds, start, rest, newton.factorisation)


def held(quarter: bool) -> dict[str, str]:
    """Boundary conditions: a quarter between two mirror planes, or both edges of the whole."""
    if not quarter:
        return {"dirichlet": f"{LOW}|{HIGH}"}
    return {"dirichletx": HIGH, "dirichlety": f"{HIGH}|{BEGIN}|{END}", "dirichletz": f"{HIGH}|{LOW}"}


def torus(mesh: tuple[int, int], layers: int, order: int, quarter: bool) -> Any:
    """The parameters (phi [rad], psi [rad], z [mm]) as a box, deformed onto the torus by cubics or better.

    Lines as of :func:`tyre_lines` on the whole tyre.
    """
    psi, phi = tyre_lines((2 * mesh[0], 2 * mesh[1]) if quarter else mesh, CLAMP_DEG)
    if quarter:
        psi, phi = psi[len(psi) // 2 :], phi[len(phi) // 2 :]
    placed = _placed(phi, psi)
    box = MakeStructured3DMesh(nx=len(phi) - 1, ny=len(psi) - 1, nz=layers, mapping=placed, periodic_x=not quarter)
    a2, a1, z = ng.x, ng.y, ng.z
    ring = RING + (INNER + z) * ng.cos(a1)
    exact = ng.CF((ring * ng.cos(a2), ring * ng.sin(a2), (INNER + z) * ng.sin(a1)))
    deformation = ng.GridFunction(ng.VectorH1(box, order=max(order, CURVED)))
    deformation.Interpolate(exact - ng.CF((a2, a1, z)))
    box.SetDeformation(deformation)
    return box


def _placed(phi: np.ndarray, psi: np.ndarray) -> Callable[[float, float, float], tuple[float, float, float]]:
    """Nodes of the unit cube on the lines."""
    at1, at2 = np.linspace(0.0, 1.0, len(phi)), np.linspace(0.0, 1.0, len(psi))
    return lambda x, y, z: (float(np.interp(x, at1, phi)), float(np.interp(y, at2, psi)), WALL * z)


def total_energy(space: Any, plane: Any, wall: Wall) -> Any:
    """Sum [N mm] of the wall's energy, -p V and int penalty/2 <x - plane>^2 dA.

    V = -1/3 int x.cof(F) N dA over the inner face is the cavity, N out of the wall; the cones from its edges to the
    origin lie in mirror planes or are held with the clamps, so its variation is that of the follower pressure.
    """
    u = space.TrialFunction()
    F = ng.Id(3) + ng.Grad(u)
    G = 0.5 * (F.trans * F - ng.Id(3))
    face, at = u.Trace(), ng.CF((ng.x, ng.y, ng.z))
    turned = ng.Cof(ng.Id(3) + ng.Grad(face)) * ng.specialcf.normal(3)
    total = ng.BilinearForm(space, symmetric=True)
    total += ng.Variation(wall.energy(G).Compile() * ng.dx)
    total += ng.Variation((PRESSURE / 3 * ng.InnerProduct(at + face, turned)).Compile() * ng.ds(INSIDE))
    over = _positive(ng.x + face[0] - plane)
    total += ng.Variation((0.5 * PENALTY * over * over).Compile() * ng.ds(**CONTACT))
    return total


def _positive(value: Any) -> Any:
    return ng.IfPos(value, value, 0)

"""The isotropic tyre by NGSolve: a quarter of cubic hexahedra, one through the wall, pressed on the rigid plane.

Everything is one energy (St. Venant-Kirchhoff, follower pressure, penalty of the plane), so that the tangent is
symmetric and Newton minimises with a line search. NGSolve: J. Schoeberl, TU Wien, https://ngsolve.org.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import ngsolve as ng
import numpy as np
from ngsolve.meshes import MakeStructured3DMesh
from ngsolve.nonlinearsolvers import NewtonSolver

from studies.scenes.tyre.grid_lines import tyre_lines

E, NU = 20.0, 0.45  # MPa, 1
RING, INNER, WALL = 200.0, 50.0, 4.8  # mm: centre of the tube from the axis, radius of its inner face, thickness
CROWN = RING + INNER + WALL  # mm, outer equator from the axis
CLAMP_DEG = 120.0
PRESSURE = 0.15  # MPa
PENALTY = 20.0  # MPa/mm, that of the reference; ten times as much adds 0.02 % to the force of 14x12
ORDER = 3
# what MakeStructured3DMesh calls the faces of a box of (phi, psi, z): phi = 0 and pi, psi = 0 and clamp, both faces
MIRROR_Y, MIRROR_Z, CLAMP, INSIDE, OUTER = "back|front", "left", "right", "bottom", "top"
# 6 x 6 points: the pressure has a kink inside the faces, so only the points of the energy give the force of the energy
CONTACT = {"definedon": OUTER, "intrules": {ng.QUAD: ng.IntegrationRule(ng.QUAD, 11)}}
WORK = 1e-4  # (N mm)^(1/2): Newton ends where residual times step is its square
ITERATIONS = 60


def quarter(mesh: tuple[int, int], delta_mm: float) -> tuple[float, int]:
    """Force of the whole tyre [N], nan where Newton fails, and number of unknowns (prescribed ones included).

    mesh: elements over psi in [0, clamp] and phi in [0, 180 deg]; delta_mm: travel from first touch when inflated.
    """
    ng.SetNumThreads(1)  # as the shells have
    solid = torus(mesh)
    held = {"dirichletx": CLAMP, "dirichlety": f"{CLAMP}|{MIRROR_Y}", "dirichletz": f"{CLAMP}|{MIRROR_Z}"}
    space = ng.VectorH1(solid, order=ORDER, **held)
    u, plane = ng.GridFunction(space), ng.Parameter(2 * CROWN)  # far away
    newton = NewtonSolver(energy(space, plane), u, inverse="sparsecholesky")
    inflated = _converges(newton)
    crown = next(vertex.nr for vertex in solid.vertices if np.allclose(vertex.point, (0, 0, WALL)))
    plane.Set(CROWN + u.components[0].vec[crown] - delta_mm)
    if not (inflated and _converges(newton)):
        return math.nan, space.ndof
    contact = PENALTY * _positive(ng.x + u.components[0] - plane)
    return 4 * float(ng.Integrate(contact * ng.ds(**CONTACT), solid)), space.ndof


def torus(mesh: tuple[int, int]) -> Any:
    """The quarter: a box of the parameters (phi [rad], psi [rad], z [mm]), deformed onto the torus by cubics.

    Lines as of :func:`tyre_lines` on the whole tyre.
    """
    psi, phi = (line[len(line) // 2 :] for line in tyre_lines((2 * mesh[0], 2 * mesh[1]), CLAMP_DEG))
    box = MakeStructured3DMesh(nx=mesh[1], ny=mesh[0], nz=1, mapping=_placed(phi, psi))
    a2, a1, z = ng.x, ng.y, ng.z
    ring = RING + (INNER + z) * ng.cos(a1)
    exact = ng.CF((ring * ng.cos(a2), ring * ng.sin(a2), (INNER + z) * ng.sin(a1)))
    deformation = ng.GridFunction(ng.VectorH1(box, order=ORDER))
    deformation.Interpolate(exact - ng.CF((a2, a1, z)))
    box.SetDeformation(deformation)
    return box


def _placed(phi: np.ndarray, psi: np.ndarray) -> Callable[[float, float, float], tuple[float, float, float]]:
    """Nodes of the unit cube on the lines."""
    at1, at2 = np.linspace(0.0, 1.0, len(phi)), np.linspace(0.0, 1.0, len(psi))
    return lambda x, y, z: (float(np.interp(x, at1, phi)), float(np.interp(y, at2, psi)), WALL * z)


def energy(space: Any, plane: Any) -> Any:
    """Sum [N mm] of int lambda/2 (tr G)^2 + mu G:G dV, -p V and int penalty/2 <x - plane>^2 dA; G Green-Lagrange.

    V = -1/3 int x.cof(F) N dA over the inner face is the cavity, N out of the wall; the cones from its edges to the
    origin lie in the mirror planes or are held with the clamp, so its variation is that of the follower pressure.
    """
    u = space.TrialFunction()
    lame, mu = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
    F = ng.Id(3) + ng.Grad(u)
    G = 0.5 * (F.trans * F - ng.Id(3))
    face, at = u.Trace(), ng.CF((ng.x, ng.y, ng.z))
    turned = ng.Cof(ng.Id(3) + ng.Grad(face)) * ng.specialcf.normal(3)
    total = ng.BilinearForm(space, symmetric=True)
    total += ng.Variation((0.5 * lame * ng.Trace(G) ** 2 + mu * ng.InnerProduct(G, G)).Compile() * ng.dx)
    total += ng.Variation((PRESSURE / 3 * ng.InnerProduct(at + face, turned)).Compile() * ng.ds(INSIDE))
    over = _positive(ng.x + face[0] - plane)
    total += ng.Variation((0.5 * PENALTY * over * over).Compile() * ng.ds(**CONTACT))
    return total


def _positive(value: Any) -> Any:
    return ng.IfPos(value, value, 0)


def _converges(newton: Any) -> bool:
    failed, _ = newton.Solve(maxit=ITERATIONS, maxerr=WORK, linesearch=True)
    return not failed

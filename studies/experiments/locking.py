"""Locking, measured: shell problems with known answers, solved on fixed meshes while the shell gets thinner.

Every function solves its problems anew and returns one flat table. A ratio found/exact that stays where it is while
h/R falls by orders of magnitude is the absence of locking; its distance from 1 is the ordinary error of the mesh.

All problems are linear. Those of thin shells are solved in director-scaled unknowns, because in face displacements
double precision ends first: see :func:`director_scaled`.

Trapezoidal locking proper (in-plane trapezoids bent about their own plane) cannot arise on a tensor grid; its curved
relative, nodal directors that fan out along the element, is in every curved problem here.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from scipy import sparse

from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate, Surface, cylinder, hyperboloid
from formulations.section.laminate import SECTIONS, Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import LINEAR
from studies.experiments import Row, tabulated
from studies.experiments.shell_limits.bodies import solved
from studies.scenes.closed_forms.harmonic import HarmonicShell
from studies.scenes.statics import area_load, edge_shares, normal_forces

UNMET = 1e-2  # of the largest nodal force
THINNESS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)
MESHES = (8, 16, 32)
UNIT = np.array([0.0, 1.0])  # the two lines of a strip of width 1

# Energy-norm errors sqrt|1 - U_h/U| of bilinear elements on 8, 16, 32, 64, 128 elements around a quadrant at t/R = 1e-2
# with and without strain reduction. Read in ElmerCSC/elmerfem, fem/tests/Shell_BenchmarkCase[12]_Quad/Readme.txt; the
# number of elements around is that of the stored third mesh, those along the axis are not stated there. A later
# version of these files prints .294 .145 .0726 .0364 .0182 (free, reduced) and .0852 .0479 .0269 .0157 .0097 (clamped).
YARDSTICK_MESHES, YARDSTICK_THINNESS = (8, 16, 32, 64, 128), 1e-2
YARDSTICK = {  # (reduced, unreduced)
    ("cylinder", "free"): ((0.285, 0.140, 0.0703, 0.0352, 0.0176), (0.99897, 0.99574, 0.98314, 0.93712, 0.80190)),
    ("cylinder", "clamped"): ((0.149, 0.0757, 0.0396, 0.0214, 0.0122), (0.519, 0.301, 0.163, 0.0846, 0.0432)),
}

SURFACES: dict[str, Surface] = {"cylinder": cylinder(1.0), "hyperboloid": hyperboloid(1.0, 1.0)}


def director_scaled(discretisation: Discretisation) -> Discretisation:
    """The same shell in the unknowns (m_i, beta_i) in place of (v_i-, v_i+): v-+ = m -+ (h/2) beta.

    In face displacements the stiffness against thickness stretch, E l^2/h, stands beside that of bending, E h^3/L^2, in
    the same matrix entries: rounding the first loses the second when (L/h)^4 approaches 1e16. The mean m and the
    director beta keep them apart (Gee, Ramm, Wall, CMAME 194 (2005) 2513, scaled director; recalled). Supports must
    hold both faces of a component or none. Forces go along: on m their sum, on beta h/2 times their difference.
    """
    turn = np.kron(np.eye(3), _director_turn(discretisation.laminate.thickness))
    geometry = discretisation.geometry
    scaled = replace(geometry, Q=geometry.Q @ np.kron(np.eye(4), turn), director=geometry.director @ turn)
    return replace(discretisation, geometry=scaled)


def _director_turn(h: float) -> np.ndarray:
    return np.array([[1.0, -h / 2], [1.0, h / 2]])


def _solve(
    discretisation: Discretisation,
    forces: np.ndarray,
    unknowns: str = "director",
    section: str = "constant-s33",
    membrane: str = "compatible",
) -> np.ndarray:
    """Face displacements (N, 6) of the linear shell under nodal forces (N, 6); NaN where rounding has taken them."""
    turn = np.eye(6)
    if unknowns == "director":
        turn = np.kron(np.eye(3), _director_turn(discretisation.laminate.thickness))
        discretisation = director_scaled(discretisation)
    reduced = discretisation.reduce(forces @ turn)
    shell = ShellModel(discretisation, LINEAR, section, forces=reduced, membrane=membrane)
    at_rest = shell.linearise(np.zeros(discretisation.n_free))
    u = _refined(at_rest.tangent, -at_rest.residual)
    return discretisation.expand(u) @ turn.T


def _refined(A: sparse.csc_matrix, b: np.ndarray) -> np.ndarray:
    """The x with A x = b, always refined: the stiff directions of a thin shell need it at any backward error.

    NaN when the residual still exceeds a hundredth of the load: that is the end of double precision, not an answer.
    """
    x = solved(A, b)
    met = np.max(np.abs(b - A @ x)) <= UNMET * np.max(np.abs(b))
    return x if met else np.full_like(x, np.nan)


@tabulated
def thickness_locking(
    nus: Sequence[float] = (0.0, 0.3, 0.45),
    meshes: Sequence[int] = MESHES,
    sections: Sequence[str] = SECTIONS,
    h_over_L: float = 0.01,
) -> Iterator[Row]:
    """Poisson thickness locking: bending stiffness found over that of plane stress through the thickness.

    load: "moment" and "pressure" bend a cantilever strip that cannot move across (cylindrical bending), "equibiaxial"
    a square by moments on its edges. law: 1, and for full-3d (1 - nu)^2/(1 - 2 nu) in cylindrical and
    (1 - nu)/((1 + nu)(1 - 2 nu)) in equibiaxial bending. No refinement and no thinness makes it go away.
    """
    for load, section, nu, n in product(("moment", "pressure", "equibiaxial"), sections, nus, meshes):
        excess = (1 - nu) / ((1 + nu) * (1 - 2 * nu)) if load == "equibiaxial" else (1 - nu) ** 2 / (1 - 2 * nu)
        law = excess if section == "full-3d" else 1.0
        ratio = _bending_stiffness(load, section, nu, n, h_over_L)
        yield {"load": load, "section": section, "nu": nu, "elements": n, "stiffness_ratio": ratio, "law": law}


def _bending_stiffness(load: str, section: str, nu: float, n: int, h: float) -> float:
    """Bending stiffness found over E h^3/(12 (1 - nu^2)), on the length 1, with E = 1."""
    square, lines = load == "equibiaxial", np.linspace(0, 1, n + 1)
    grid = Grid.tensor(lines, lines if square else UNIT)
    supports, start = Supports.none(grid), grid.on_line(0, 0.0)
    if square:
        supports = supports.symmetric(start, 0).symmetric(grid.on_line(1, 0.0), 1).hold(grid.node_at(0.0, 0.0), (2,))
    else:
        supports = supports.symmetric(np.arange(grid.n_nodes), 1).clamped(start)
    discretisation = _discretised(Plate(), grid, h, nu, supports)
    if load == "pressure":
        forces = area_load(discretisation, lambda a1, a2: np.broadcast_to([0.0, 0.0, -1.0], (*a1.shape, 3)))
    else:
        forces = np.zeros((grid.n_nodes, 6))
        for a in (0, 1) if square else (0,):
            edge, share = edge_shares(discretisation, a, 1.0)
            forces[edge, 2 * a], forces[edge, 2 * a + 1] = -share / h, share / h  # the moment 1 per width
    v = _solve(discretisation, forces, section=section)
    deflection = -float(v[grid.node_at(1.0, 1.0), 4:].mean())
    shear = 1 / (2 * h / (2 * (1 + nu)))  # of the strip under pressure, p L^2/(2 G h)
    stiffness = {
        "moment": 1 / (2 * deflection),
        "pressure": 1 / (8 * (deflection - shear)),
        "equibiaxial": 1 / ((1 + nu) * deflection),
    }[load]
    return stiffness / (h**3 / (12 * (1 - nu**2)))


def _discretised(surface: Surface, grid: Grid, h: float, nu: float, supports: Supports) -> Discretisation:
    """A shell of one isotropic layer with E = 1."""
    return Discretisation.build(surface, grid, Laminate.single(Ply.isotropic(1.0, nu, h)), *supports.masks)


@tabulated
def shear_locking(elements: int = 8) -> Iterator[Row]:
    """Straight cantilever under end shear, elements of increasing length over thickness l/h; nu = 0.

    ratio: tip deflection over Timoshenko's P L^3/(3 E I) + P L/(G A). two_node: 1 - 1/(4 n^2) in the bending part, of a
    linear element without shear locking. fully_integrated: 1/(1 + (5/12)(l/h)^2 ...), what a fully integrated linear
    element (S l^2/(12 D) = (l/h)^2/2 without shear correction) would leave; a yardstick that must fail.
    """
    for aspect in (1, 10, 100, 1e3, 1e4):
        h = 1.0 / (aspect * elements)
        tip = _tip_deflection(Plate(), 0, np.linspace(0, 1.0, elements + 1), h)
        bending, shear = 4 / h**3, 2 / h
        softening = (bending * (1 - 1 / (4 * elements**2)) + shear) / (bending + shear)
        row = {"l_over_h": aspect, "elements": elements, "ratio": tip / (bending + shear), "two_node": softening}
        yield row | {"fully_integrated": 1 / (1 + 5 / 12 * aspect**2)}


@tabulated
def curved_beam(
    thinness: Sequence[float] = THINNESS, meshes: Sequence[int] = MESHES, unknowns: str = "director"
) -> Iterator[Row]:
    """Quarter of a ring, clamped at one end, radial force at the other: membrane and trapezoidal locking; nu = 0.

    ratio: end deflection over the closed form of the curved Timoshenko beam, pi/4 P R (c . C c + 1/(G A)), c = (1, -R)
    the normal force and moment over P sin, C the flexibility of the section whose fibres have the lengths 1 + z/R
    (Winkler, Bach). The element's linear variation of strain between the faces differs from it by O(h/R)^2.
    """
    for h in thinness:
        logarithm = math.log1p(h / (1 - h / 2))
        J0 = logarithm if h > 1e-3 else h * (1 + h**2 / 12)
        J1 = h - J0 if h > 1e-3 else -(h**3) / 12  # int z/(1 + z) dz; the difference cancels in thin beams
        C = np.linalg.inv([[J0, J1], [J1, -J1]])
        c = np.array([1.0, -1.0])
        exact = np.pi / 4 * (c @ C @ c + 2 / h)
        for n in meshes:
            tip = _tip_deflection(cylinder(1.0), 1, np.linspace(0, np.pi / 2, n + 1), h, unknowns)
            yield {"h_over_R": h, "elements": n, "unknowns": unknowns, "ratio": tip / exact}


def _tip_deflection(surface: Surface, axis: int, lines: np.ndarray, h: float, unknowns: str = "director") -> float:
    """Of a strip of width 1 along an axis, nu = 0: clamped where the lines begin, a normal force 1 where they end."""
    grid = Grid.tensor(*((lines, UNIT) if axis == 0 else (UNIT, lines)))
    tip, supports = grid.on_line(axis, lines[-1]), Supports.none(grid).clamped(grid.on_line(axis, lines[0]))
    forces = normal_forces(grid, dict.fromkeys(tip.tolist(), 0.5))
    return float(_solve(_discretised(surface, grid, h, 0.0, supports), forces, unknowns)[tip, 4:].mean())


@tabulated
def membrane_locking(
    surfaces: Sequence[str] = tuple(SURFACES),
    ends: Sequence[str] = ("free", "clamped"),
    thinness: Sequence[float] = THINNESS,
    meshes: Sequence[int] = MESHES,
    membranes: Sequence[str] = ("compatible", "relaxed"),
) -> Iterator[Row]:
    """Shells of revolution under p cos 2 a2: the cylinder of Pitkaranta et al., the hyperboloid of Lee and Bathe.

    R = 1 and |a1| <= 1, an octant of n x n elements; nu = 1/3. Free ends let the shell bend without stretching,
    clamped ones do not. energy_ratio: U_h/U by :class:`studies.scenes.closed_forms.harmonic.HarmonicShell`.
    energy_norm_error: sqrt|1 - U_h/U|; the yardsticks are bilinear elements with and without strain reduction where
    they were printed. The free hyperboloid locks on coarse meshes all the same: U/U_h - 1 grows as (l^3/h)^2, a
    membrane strain of third order in the element length l that neither membrane removes. Source: Pitkaranta, Leino,
    Ovaskainen, Piila, CMAME 128 (1995) 81; Lee, Bathe, Comput. Struct. 82 (2004) 945.
    """
    for name, end, h in product(surfaces, ends, thinness):
        laminate = Laminate.single(Ply.isotropic(1.0, 1 / 3, h))
        exact = HarmonicShell(SURFACES[name], laminate, 2, 1.0, 1.0, end == "clamped").energy()
        for membrane, n in product(membranes, meshes):
            ratio = _energy(SURFACES[name], h, end, n, membrane) / exact
            reduced, unreduced = _yardstick(name, end, h, n)
            row = {"surface": name, "end": end, "membrane": membrane, "h_over_R": h, "elements": n}
            row |= {"energy_ratio": ratio, "energy_norm_error": math.sqrt(abs(1 - ratio))}
            yield row | {"yardstick_reduced": reduced, "yardstick_unreduced": unreduced}


def _energy(surface: Surface, h: float, end: str, n: int, membrane: str) -> float:
    right = np.pi / 2
    grid = Grid.tensor(np.linspace(0, 1, n + 1), np.linspace(0, right, n + 1))
    supports = Supports.none(grid).symmetric(grid.on_line(0, 0.0), 0)
    for plane in (0.0, right):
        supports = supports.symmetric(grid.on_line(1, plane), 1)
    if end == "clamped":
        supports = supports.clamped(grid.on_line(0, 1.0))
    discretisation = _discretised(surface, grid, h, 1 / 3, supports)
    forces = area_load(discretisation, lambda a1, a2: np.cos(2 * a2)[..., None] * surface.frame(a1, a2)[..., 2, :])
    return float(0.5 * np.sum(forces * _solve(discretisation, forces, membrane=membrane)))


def _yardstick(surface: str, end: str, h: float, n: int) -> tuple[float, float]:
    """Printed errors (reduced, unreduced), NaN where nothing was printed."""
    if (surface, end) not in YARDSTICK or h != YARDSTICK_THINNESS or n not in YARDSTICK_MESHES:
        return math.nan, math.nan
    reduced, unreduced = YARDSTICK[surface, end]
    return reduced[YARDSTICK_MESHES.index(n)], unreduced[YARDSTICK_MESHES.index(n)]

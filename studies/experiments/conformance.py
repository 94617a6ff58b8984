"""The conformance kit: what every measure and every element option must do, measured beside what is expected.

``conformance(measure)`` serves a measure of the catalogue and one of your own; every entry is a number found, the
interval it must lie in, and the law in words. Laws a measure declares not to obey must fail, by the amount it declares.

The shells are small, skew laminates on a torus or an irregular plate; only the ring and the manufactured motion are
problems with a solution.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from contact.solvers.sparse import factorise
from formulations.conditions.boundary import Supports
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate, Surface, cylinder, torus
from formulations.loads import Pressure
from formulations.section.laminate import SECTIONS, Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.measure import QuadraticMeasure, StrainMeasure
from studies.experiments.rigid_body import CASES, central_difference, left_by, rotation
from studies.experiments.specimens import ELEMENTS, Element, Swapped, layup
from studies.scenes.manufactured.scene import carrying, errors, unknowns_at
from studies.scenes.manufactured.solution import Exact, Patch
from studies.scenes.manufactured.statements import PIECES, STATEMENTS, TurnedWaves, wall, wrong_coefficients
from studies.scenes.statics import area_load
from studies.solving.refinement.richardson import correction, order_of

RIGID = 1e-10  # of a strain under rigid motion against its closed form
INVARIANCE = 1e-9  # relative
DIFFERENCE = 1e-8  # relative, of an 8th-order difference
PATCH = 1e-10  # relative
NOTICED = 1e-3  # relative: what a measure that is not objective must show
SLOPE = (1.95, 2.05)  # of the remainder of the linearisation
ORDER = (1.8, 4.0)  # of the deflection of a ring; 2 in the end, above where E33 of short chords still locks (l^4/h^2)
LIMIT = 1e-3  # of the extrapolated deflection of a ring of h/R = 0.01
FEW, SECOND = (5, 10), (1.9, 2.1)  # elements along a side, and the order of the error between them
NEWTON, BALANCED = 12, 1e-9
THETAS = (0.3, 1.7, math.pi, 5.0, 2 * math.pi)
TORUS, LINES1, LINES2 = torus(3.0, 1.0), np.array([-0.3, 0.1, 0.4]), np.array([0.2, 0.5, 0.7, 1.0])
SEED = 2004


@dataclass(frozen=True)
class Check:
    """One law: the number found and the interval [low, high] that it must lie in.

    refused: why the law does not apply, if so.  said: what was worst, or failed.
    """

    law: str
    found: float
    low: float = 0.0
    high: float = 0.0
    refused: str = ""
    said: str = ""

    @property
    def passed(self) -> bool:
        """False for NaN, too; what is refused is not broken."""
        return bool(self.refused) or self.low <= self.found <= self.high


def conformance(measure: StrainMeasure, element: Element = ELEMENTS[0]) -> list[Check]:
    """Every check of a measure on an element; raises ValueError for a pair that does not exist."""
    if not element.suits(measure):
        raise ValueError(f"{measure.name} leaves gradients out: not for {element.interpolation} elements")
    return [check for law in LAWS for check in law(measure, element)]


def _largest(array: np.ndarray) -> float:
    return float(np.max(np.abs(array)))


# --- the measure alone --------------------------------------------------------------------------------------------


def _rigid_body(measure: StrainMeasure, element: Element) -> Iterator[Check]:
    """Strains that rigid motions leave, against the declared closed forms, up to a full turn on four surfaces."""
    off, said = 0.0, ""
    for case, theta in product(CASES, THETAS):
        row = left_by(measure, *case, theta, 0.1 * theta)
        if row["declared"] is not None and not math.isnan(off) and not abs(row["strain"] - row["declared"]) <= off:
            off = abs(row["strain"] - row["declared"])
            motion = " ".join([*case, f"by {theta:.3g}"])
            said = f"{motion} leaves {row['strain']:.3g}, declared {row['declared']:.3g}"
    yield Check("rigid motions leave the declared strains", off, 0.0, RIGID, said=said)


# --- derivatives --------------------------------------------------------------------------------------------------


def _derivatives(measure: StrainMeasure, element: Element) -> Iterator[Check]:
    """|r(u + t du) - r(u) - t K du| falls as t^2; dW = r.du under dead loads."""
    rng, grid = np.random.default_rng(SEED), Grid.tensor(LINES1, LINES2)
    n = 6 * grid.n_nodes
    u, du = 1e-3 * rng.normal(size=(2, n))
    follower = Pressure(0.3, follower=True, area="face")
    shell = element.shell(measure, TORUS, grid, layup(), pressure=follower, initial=rng.normal(size=11))
    lin = shell.linearise(u)
    steps = 2.0 ** -np.arange(5)
    errors = [
        np.linalg.norm(shell.linearise(u + t * du).residual - lin.residual - t * (lin.tangent @ du)) for t in steps
    ]
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    yield Check("remainder of the tangent is of second order", float(slope), *SLOPE)
    dead = element.shell(measure, TORUS, grid, layup(), pressure=Pressure(0.3), forces=rng.normal(size=n))
    work = float(dead.linearise(u).residual @ du)
    slope = central_difference(lambda t: dead.energy(u + t * du), 0.1)
    free = element.shell(measure, TORUS, grid, layup())
    strained = float(free.linearise(u).residual @ du)  # work of the strains, a 256th of that of the loads
    yield Check("residual is the gradient of the energy", abs((float(slope) - work) / strained), 0.0, DIFFERENCE)
    asymmetry = abs(dead.linearise(u).tangent - dead.linearise(u).tangent.T).max() / abs(lin.tangent).max()
    yield Check("tangent of dead loads is symmetric", float(asymmetry), 0.0, INVARIANCE)


# --- objectivity --------------------------------------------------------------------------------------------------


def claims_objectivity(measure: StrainMeasure) -> bool:
    """True when the measure declares no strain of a turning plate; on curved shells its gradients must be full, too."""
    law = measure.rigid_body_law
    return law.out_of_plane(1.0, 1.0) == 0 and law.drilling(1.0, 1.0) == 0


def _objectivity(measure: StrainMeasure, element: Element) -> Iterator[Check]:
    """Forces of a strained body turn with it, f(R (x + u) - x) = R f(u), and where a measure does not claim it not.

    On curved surfaces only isoparametric elements can, see the tests of the element for the others.
    """
    surfaces: dict[str, Surface] = {"plate": Plate()}
    if element.interpolation == "isoparametric":
        surfaces["torus"] = TORUS
    interval = (0.0, INVARIANCE) if claims_objectivity(measure) else (NOTICED, math.inf)
    R = rotation(np.array([1.0, 2.0, -0.5]) / math.sqrt(5.25), 1.1)
    for name, surface in surfaces.items():
        grid = Grid.tensor(LINES1, LINES2)
        shell = element.shell(measure, surface, grid, layup())
        frame = surface.frame(*grid.nodes.T)
        x = np.stack(shell.discretisation.positions())
        u = 0.003 * np.random.default_rng(SEED).normal(size=x.shape)
        still, turned = (_cartesian_force(shell, frame, v) for v in (u, (x + u) @ R.T - x))
        mismatch = _largest(turned - still @ R.T) / _largest(still)
        yield Check(f"forces of a strained {name} turn with it", mismatch, *interval)


def _cartesian_force(shell: ShellModel, frame: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Nodal forces (2, N, 3) of Cartesian face displacements (2, N, 3)."""
    v = np.stack([np.einsum("nij,nj->ni", frame, face) for face in u], axis=-1)
    r = shell.linearise(v.ravel()).residual.reshape(v.shape)
    return np.stack([np.einsum("ni,nij->nj", r[..., face], frame) for face in (0, 1)])


# --- patch tests --------------------------------------------------------------------------------------------------


def _patches(measure: StrainMeasure, element: Element) -> Iterator[Check]:
    """On an irregular plate, u = (F - I) x asks of the inner nodes the same traction everywhere, opposite on the faces;
    any curvature at rest asks for none.
    """
    grid = Grid.tensor(np.array([0.0, 0.35, 0.7, 1.3, 2.0]), np.array([-0.5, 0.1, 0.4, 0.9]))
    shell = element.shell(measure, Plate(), grid, layup())
    outer = np.any([np.isin(a, (a.min(), a.max())) for a in grid.nodes.T], axis=0)
    rng = np.random.default_rng(SEED)
    G = 0.05 * rng.normal(size=(3, 3))
    v = np.stack([x @ G.T for x in shell.discretisation.positions()], axis=-1)
    r = shell.linearise(v.ravel()).residual.reshape(v.shape)
    traction = r[~outer] / shell.discretisation.nodal_areas("mid")[~outer, None, None] * [-1, 1]
    uneven = _largest(traction - traction.mean(axis=(0, 2), keepdims=True)) / _largest(traction)
    yield Check("homogeneous deformation needs one traction", uneven, 0.0, PATCH)
    h, D = shell.discretisation.laminate.thickness, shell.discretisation.laminate.stiffness()
    k = np.array([[0.02, 0.015], [0.015, -0.01]])
    bent = np.empty((grid.n_nodes, 3, 2))
    strains = np.kron([k[0, 0], k[1, 1], 2 * k[0, 1]], [-h / 2, h / 2])
    stretch = -D[10, :6] @ strains / D[10, 10]
    for face, z in enumerate((-h / 2, h / 2)):
        bent[:, :2, face] = z * grid.nodes @ k
        bent[:, 2, face] = z * stretch - np.einsum("na,ab,nb->n", grid.nodes, k, grid.nodes) / 2
    r = (shell.linearise(np.zeros(bent.size)).tangent @ bent.ravel()).reshape(bent.shape)
    yield Check("constant curvature is in balance at rest", _largest(r[~outer]) / _largest(r), 0.0, PATCH)


# --- axes and units -----------------------------------------------------------------------------------------------


def _axes(measure: StrainMeasure, element: Element) -> Iterator[Check]:
    """The coordinates exchanged: residual and tangent are the same numbers in other places."""
    load, turned = Pressure(0.3, follower=True, area="face"), layup(swapped=True)
    grids = Grid.tensor(LINES1, LINES2), Grid.tensor(LINES2, LINES1)
    v = 0.003 * np.random.default_rng(SEED).normal(size=(len(LINES1), len(LINES2), 6))

    def exchange(w: np.ndarray) -> np.ndarray:
        return w.swapaxes(0, 1)[..., [2, 3, 0, 1, 4, 5]].ravel()

    number = exchange(np.arange(v.size).reshape(v.shape))
    for section in SECTIONS:
        one = element.shell(measure, TORUS, grids[0], layup(), pressure=load, section=section)
        two = element.shell(measure, Swapped(TORUS), grids[1], turned, pressure=load, section=section)
        first, second = one.linearise(v.ravel()), two.linearise(exchange(v))
        force = _largest(second.residual - exchange(first.residual.reshape(v.shape))) / first.scale
        slope = abs(second.tangent - first.tangent[number][:, number]).max() / abs(first.tangent).max()
        yield Check(f"the axes may be exchanged, {section}", max(force, float(slope)), 0.0, INVARIANCE)


def _units(measure: StrainMeasure, element: Element) -> Iterator[Check]:
    """mm, N, MPa against m, N, Pa: forces are the same numbers, stiffnesses a thousand times larger."""
    milli, mega = 1e-3, 1e6
    grid = Grid.tensor(LINES1, LINES2)
    mm = element.shell(measure, TORUS, grid, layup(), pressure=Pressure(0.3, follower=True))
    load = Pressure(0.3 * mega, follower=True)
    m = element.shell(measure, torus(3.0 * milli, milli), grid, layup(length=milli, stress=mega), pressure=load)
    u = 0.003 * np.random.default_rng(SEED).normal(size=mm.discretisation.n_free)
    first, second = mm.linearise(u), m.linearise(milli * u)
    force = _largest(second.residual - first.residual) / first.scale
    slope = abs(milli * second.tangent - first.tangent).max() / abs(first.tangent).max()
    yield Check("the units may be changed", max(force, float(slope)), 0.0, INVARIANCE)


# --- convergence --------------------------------------------------------------------------------------------------


def _ring(measure: StrainMeasure, element: Element) -> Iterator[Check]:
    """A ring under p cos 2 a2, small strains, nu = 0: w = p R^4/9 D at a2 = 0, of second order in the mesh.

    Energy over D w^2/R^4: curvature squared, 3^2, or 4^2 without the turning k v of the frame (Donnell). Where either
    zeta or k v is left out, and not both, director and slope cannot agree on both faces: 2E23 = -+ h beta/2R of the
    rotation beta w/R adds beta^2/2 in any thin ring, beta = 3/2, or 2 without k v.
    """
    k = measure.kinematics
    curvature, beta = (4.0, 2.0) if k.shallow else (3.0, 1.5)
    law = 9 / (curvature**2 + (beta**2 / 2 if k.shallow != k.thin else 0.0))
    h, meshes, w, surface = 0.01, (8, 16, 32), [], cylinder(1.0)
    ring = Laminate.single(Ply.isotropic(12 / h**3, 0.0, h))
    for n in meshes:
        grid = Grid.tensor(np.array([0.0, 0.2]), np.linspace(0, math.pi / 2, n + 1))
        supports = Supports.none(grid).hold(np.arange(grid.n_nodes), (0,))
        for plane in (0.0, math.pi / 2):
            supports = supports.symmetric(grid.on_line(1, plane), 1)
        shell = element.shell(measure, surface, grid, ring, supports)
        forces = area_load(
            shell.discretisation, lambda a1, a2: np.cos(2 * a2)[..., None] * surface.frame(a1, a2)[..., 2, :]
        )
        at_rest = shell.linearise(np.zeros(shell.discretisation.n_free))
        u = factorise(at_rest.tangent).solve(shell.discretisation.reduce(forces))
        w.append(float(9 * shell.discretisation.expand(u)[grid.on_line(1, 0.0), 4:].mean()))
    sizes = [1 / n for n in meshes]
    yield Check("deflection of a ring converges with the order", order_of(sizes, w), *ORDER)
    limit = w[-1] + correction(sizes, w)
    yield Check("extrapolated deflection of a ring over the closed form", limit / law, 1 - LIMIT, 1 + LIMIT)


# --- manufactured solutions ---------------------------------------------------------------------------------------


def _manufactured(measure: StrainMeasure, element: Element) -> Iterator[Check]:
    """Under the loads of a given motion the error of the displacement falls with the second order; a measure of the
    catalogue has the coefficients that it states. Any other is taken at its own word for its strains.
    """
    errors = [manufactured_error(measure, element, n) for n in FEW]
    order = math.log(errors[0] / errors[1]) / math.log(FEW[1] / FEW[0])
    yield Check("error of a manufactured solution falls with the order", order, *SECOND)
    if isinstance(measure, QuadraticMeasure) and measure.name in STATEMENTS:
        wrong = wrong_coefficients(measure, STATEMENTS[measure.name])
        law = "coefficients are those that the measure states"
        yield Check("; ".join([law, *map(str, wrong)]), len(wrong), 0, 0)


def manufactured_error(measure: StrainMeasure, element: Element, n: int) -> float:
    """Relative L2 error of the displacement of a manufactured solution on n x n elements; NaN where none is found."""
    piece, laminate = PIECES["torus"], wall("skew", 0.18)
    field = TurnedWaves(piece.surface, laminate, 0.5, 0.15, 0.04)
    patch = Patch.over(piece.a1, piece.a2)
    exact = Exact(piece.surface, laminate, measure, laminate.stiffness(), patch, field)
    grid = Grid.tensor(np.linspace(*piece.a1, n + 1), np.linspace(*piece.a2, n + 1))
    held = Supports.of_edges(grid, "clamped", "free", "clamped", "free")
    shell = carrying(
        element.shell(measure, piece.surface, grid, laminate, held), exact, {0: piece.a1[1], 1: piece.a2[1]}
    )
    u = unknowns_at(shell.discretisation, exact)
    for _ in range(NEWTON):
        lin = shell.linearise(u)
        if np.linalg.norm(lin.residual) <= BALANCED * lin.scale:
            return errors(shell, u, exact)["error_displacement"]
        u = u - factorise(lin.tangent).solve(lin.residual)
    return math.nan


LAWS: tuple[Callable[[StrainMeasure, Element], Iterator[Check]], ...] = (
    _rigid_body,
    _derivatives,
    _objectivity,
    _patches,
    _axes,
    _units,
    _ring,
    _manufactured,
)

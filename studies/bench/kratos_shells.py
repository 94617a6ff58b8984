"""Shells by Kratos: large rotations by its corotational elements under Newton-Raphson, and linear shells of scenes.

Kratos Multiphysics: CIMNE, https://github.com/KratosMultiphysics/Kratos. Each nonlinear solve takes the fewest equal
load steps from which Newton arrives, found by attempts that are not counted. Its thick quadrilateral ties shears along
its sides (MITC4) and enhances the membrane.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from time import process_time
from typing import Any

import KratosMultiphysics as kratos
import KratosMultiphysics.LinearSolversApplication  # its sparse LU
import KratosMultiphysics.StructuralMechanicsApplication as structural
import numpy as np
from KratosMultiphysics import python_linear_solver_factory

from studies.bench.problems import LinearShell, Solved, size
from studies.output.stopwatch import timed
from studies.scenes.benchmarks import cantilever, hemisphere
from studies.scenes.benchmarks.snapping import PullOut
from studies.scenes.complete import complete
from studies.scenes.statics import StaticModel

STEPS = (1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 20, 30, 40, 80)  # numbers of equal load steps that are tried
ITERATIONS = 40  # of a step
RESIDUAL = 1e-6  # over the first one of the step
UNDER_LOAD = 1e-9  # N, absolute
LINEAR_SOLVER = '{"solver_type": "LinearSolversApplication.sparse_lu"}'
SHELL_LAW, PLANE_LAW = "ReissnerMindlinShellElasticConstitutiveLaw", "LinearElasticPlaneStress2DLaw"
ELEMENTS = {  # name: of the element and of its law
    "thick quadrilaterals": ("ShellThickElementCorotational3D4N", SHELL_LAW),
    "thin quadrilaterals": ("ShellThinElementCorotational3D4N", PLANE_LAW),
    "thick triangles": ("CSDSG3ThickShellCorotationalElement3D3N", SHELL_LAW),
    "thin triangles": ("ShellThinElementCorotational3D3N", PLANE_LAW),
    "linear": ("ShellThickElement3D4N", SHELL_LAW),
}
MOVES = (kratos.DISPLACEMENT_X, kratos.DISPLACEMENT_Y, kratos.DISPLACEMENT_Z)
TURNS = (kratos.ROTATION_X, kratos.ROTATION_Y, kratos.ROTATION_Z)
REACTIONS = (kratos.REACTION_X, kratos.REACTION_Y, kratos.REACTION_Z)
MOMENTS = (kratos.REACTION_MOMENT_X, kratos.REACTION_MOMENT_Y, kratos.REACTION_MOMENT_Z)
VARIABLES = (
    *(kratos.DISPLACEMENT, kratos.ROTATION, kratos.REACTION, kratos.REACTION_MOMENT),
    *(structural.POINT_LOAD, kratos.VOLUME_ACCELERATION),
)
LOADS = (structural.POINT_LOAD_X, structural.POINT_LOAD_Y, structural.POINT_LOAD_Z)


@dataclass(frozen=True, eq=False)
class Shell:
    """A patch of (n1 + 1) x (n2 + 1) nodes at x (n1 + 1, n2 + 1, 3) [mm].

    forces: (node, component, force [N]) at full load.  read(displacements (n, 3)) -> the quantity.  planes: nodes on a
    plane of symmetry and its normal's number.  held: nodes and the displacement that is none.  clamped: nodes.
    Nodes are numbered as in x.reshape(-1, 3).
    """

    x: np.ndarray
    E: float
    nu: float
    thickness: float
    forces: tuple[tuple[int, int, float], ...]
    read: Callable[[np.ndarray], float]
    planes: tuple[tuple[np.ndarray, int], ...] = ()
    held: tuple[tuple[int, int], ...] = ()
    clamped: Iterable[int] = ()


def _grid(first: float, second: float, n1: int, n2: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Both coordinates from 0 to these ends, and the numbers of the nodes, each (n1 + 1, n2 + 1)."""
    a1, a2 = np.meshgrid(np.linspace(0, first, n1 + 1), np.linspace(0, second, n2 + 1), indexing="ij")
    return a1, a2, np.arange(a1.size).reshape(a1.shape)


def _hemisphere(n1: int, n2: int) -> Shell:
    polar, around, at = _grid(np.pi / 2 - hemisphere.HOLE, np.pi / 2, n1, n2)
    flat = np.cos(polar)
    x = hemisphere.RADIUS * np.stack([flat * np.cos(around), flat * np.sin(around), np.sin(polar)], axis=-1)
    pulled, pushed, half = int(at[0, 0]), int(at[0, -1]), hemisphere.P_MAX / 2
    return Shell(
        *(x, hemisphere.E, hemisphere.NU, hemisphere.H),
        planes=((at[:, 0], 1), (at[:, -1], 0)),
        held=((pulled, 2),),
        forces=((pulled, 0, half), (pushed, 1, -half)),
        read=lambda u: float(-u[pushed, 1]),
    )


def _pull_out(n1: int, n2: int) -> Shell:
    along, around, at = _grid(PullOut.LENGTH / 2, np.pi / 2, n1, n2)
    x = np.stack([PullOut.RADIUS * np.cos(around), PullOut.RADIUS * np.sin(around), along], axis=-1)
    return Shell(
        *(x, PullOut.E, PullOut.NU, PullOut.H),
        planes=((at[:, 0], 1), (at[:, -1], 0), (at[0], 2)),
        forces=((int(at[0, 0]), 0, PullOut.P_MAX / 4),),
        read=lambda u: float(u[at[0, 0], 0]),
    )


def _cantilever(n1: int, n2: int) -> Shell:
    along, across, at = _grid(cantilever.L, cantilever.B, n1, n2)
    tip, shares = at[-1], np.ones(n2 + 1)
    shares[[0, -1]] = 0.5
    return Shell(
        *(np.stack([along, across, np.zeros_like(along)], axis=-1), cantilever.E, 0.0, cantilever.H),
        clamped=at[0],
        forces=tuple((int(k), 2, cantilever.P_MAX * share / n2) for k, share in zip(tip, shares, strict=True)),
        read=lambda u: float(u[tip, 2].mean()),
    )


def _of_scene(each: LinearShell, mesh: str) -> Shell:
    """The middle surface, supports and dead forces of a scene of quadrilaterals with one isotropic ply."""
    entry, request = complete(each.scene, each.settings, mesh, measure="linear")
    model = entry.build(request)
    assert isinstance(model, StaticModel)
    body, ply = model.shell.discretisation, model.shell.discretisation.laminate.plies[0]
    frame, held = body.surface.frame(*body.grid.nodes.T), body.map.held.reshape(-1, 3, 2)
    assert model.shell.forces is not None
    assert np.array_equal(frame, np.broadcast_to(np.eye(3), frame.shape))
    both, nodal = np.asarray(held.all(axis=2)), body.map.placed(model.shell.forces).reshape(-1, 3, 2).sum(axis=2)
    clamped = both.all(axis=1)
    middle = (body.map.held_middle | np.asarray(held.any(axis=2))) & ~both
    return Shell(
        np.mean(body.positions(), axis=0).reshape(*(n + 1 for n in request.mesh), 3),
        *(ply.E_L, ply.nu_LT, body.laminate.thickness),
        planes=tuple((np.flatnonzero(both[:, i] & ~clamped), i) for i in range(3)),
        held=tuple((int(k), int(i)) for k, i in np.argwhere(middle)),
        clamped=np.flatnonzero(clamped).tolist(),
        forces=tuple((int(k), int(i), float(nodal[k, i])) for k, i in np.argwhere(nodal)),
        read=lambda u: model.measure_at(model.shell, body.map.restrict(np.repeat(u, 2, axis=1)))[each.quantity],
    )


SHELLS = {"hemisphere": _hemisphere, "sze-pullout": _pull_out, "cantilever": _cantilever}


def shell(problem: str, kind: str, mesh: str) -> Solved:
    """The quantity of the problem at full load [mm], nan where no number of steps gets there."""
    sizes = size(mesh)
    return _solved(problem, kind, sizes, fewest_steps(problem, kind, sizes) or STEPS[-1])


@cache
def fewest_steps(problem: str, kind: str, mesh: tuple[int, int]) -> int:
    """Equal load steps that Newton needs at the least, 0 where STEPS are not enough."""
    return next((steps for steps in STEPS if np.isfinite(_solved(problem, kind, mesh, steps).value)), 0)


def linear(each: LinearShell, mesh: str) -> Solved:
    """One linear solve."""
    return _of_patch(lambda: _of_scene(each, mesh), "linear", 1)


def _solved(problem: str, kind: str, mesh: tuple[int, int], steps: int) -> Solved:
    return _of_patch(lambda: SHELLS[problem](*mesh), kind, steps)


def _of_patch(made: Callable[[], Shell], kind: str, steps: int) -> Solved:
    kratos.ParallelUtilities.SetNumThreads(1)
    kratos.Logger.GetDefaultOutput().SetSeverity(kratos.Logger.Severity.WARNING)
    begun = process_time()
    patch = made()
    model = kratos.Model()
    part = _part(model, patch, kind)
    solver = python_linear_solver_factory.ConstructSolver(kratos.Parameters(LINEAR_SOLVER))
    strategy = _once(part, solver) if kind == "linear" else _newton(part, solver)
    start, iterations, arrived = process_time() - begun, 0, True
    for step in range(1, steps + 1):
        arrived = arrived and _step(part, strategy, patch, step, steps)
        iterations += part.ProcessInfo[kratos.NL_ITERATION_NUMBER]
    u = np.array([[node.GetSolutionStepValue(move) for move in MOVES] for node in part.Nodes])
    value = patch.read(u) if arrived else math.nan
    seconds, once = process_time() - begun, _elimination(strategy, solver)
    elements = seconds - start - iterations * once
    return Solved(value, 6 * len(u), iterations, seconds, start, elements, iterations * once)


def _part(model: Any, patch: Shell, kind: str) -> Any:
    """Nodes, elements, supports and loads; the model owns them."""
    part = model.CreateModelPart("shell", 2)
    part.ProcessInfo[kratos.DOMAIN_SIZE] = 3
    for variable in VARIABLES:
        part.AddNodalSolutionStepVariable(variable)
    element, law = ELEMENTS[kind]
    wall = part.CreateNewProperties(1)
    for variable, value in (
        *((kratos.YOUNG_MODULUS, patch.E), (kratos.POISSON_RATIO, patch.nu)),
        *((kratos.THICKNESS, patch.thickness), (kratos.DENSITY, 1.0)),  # of no body force
    ):
        wall.SetValue(variable, value)
    wall.SetValue(kratos.CONSTITUTIVE_LAW, kratos.KratosGlobals.GetConstitutiveLaw(law).Clone())
    nodes = [part.CreateNewNode(k, *at) for k, at in enumerate(patch.x.reshape(-1, 3).tolist(), 1)]
    for k, corners in enumerate(_corners(patch.x.shape[:2], 3 if element.endswith("3N") else 4), 1):
        part.CreateNewElement(element, k, corners, wall)
    for unknown, reaction in zip((*MOVES, *TURNS), (*REACTIONS, *MOMENTS), strict=True):
        kratos.VariableUtils().AddDof(unknown, reaction, part)
    for on_plane, normal in patch.planes:
        for fixed in (MOVES[normal], *(turn for i, turn in enumerate(TURNS) if i != normal)):
            for k in on_plane:
                nodes[k].Fix(fixed)
    for k, component in patch.held:
        nodes[k].Fix(MOVES[component])
    for k in patch.clamped:
        for fixed in (*MOVES, *TURNS):
            nodes[k].Fix(fixed)
    for number, k in enumerate(dict.fromkeys(k for k, _, _ in patch.forces), 1):
        part.CreateNewCondition("PointLoadCondition3D1N", number, [k + 1], wall)
    return part


def _corners(shape: tuple[int, ...], corners: int) -> list[list[int]]:
    """Numbers from 1 of the nodes of each element; triangles are quadrilaterals cut along one diagonal."""
    at = 1 + np.arange(shape[0] * shape[1]).reshape(shape)
    a, b, c, d = (x.ravel() for x in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    cut = ((a, b, c, d),) if corners == 4 else ((a, b, c), (a, c, d))
    return [element for each in cut for element in np.stack(each, axis=1).tolist()]


def _newton(part: Any, solver: Any) -> Any:
    """Newton-Raphson on moving nodes, as corotational elements need it."""
    settled = kratos.ResidualCriteria(RESIDUAL, UNDER_LOAD)
    settled.SetEchoLevel(0)
    scheme, builder = (
        kratos.ResidualBasedIncrementalUpdateStaticScheme(),
        kratos.ResidualBasedEliminationBuilderAndSolver(solver),
    )
    reactions, new_unknowns, moving = False, False, True
    strategy = kratos.ResidualBasedNewtonRaphsonStrategy(
        *(part, scheme, settled, builder, ITERATIONS, reactions, new_unknowns, moving)
    )
    return _ready(strategy)


def _once(part: Any, solver: Any) -> Any:
    """One linear solve on nodes that stay."""
    scheme = kratos.ResidualBasedIncrementalUpdateStaticScheme()
    builder = kratos.ResidualBasedBlockBuilderAndSolver(solver)
    reactions, new_unknowns, size_of_step, moving = False, False, False, False
    return _ready(
        kratos.ResidualBasedLinearStrategy(part, scheme, builder, reactions, new_unknowns, size_of_step, moving)
    )


def _ready(strategy: Any) -> Any:
    strategy.SetEchoLevel(0)
    strategy.Initialize()
    strategy.Check()
    return strategy


def _step(part: Any, strategy: Any, patch: Shell, step: int, steps: int) -> bool:
    """One load step; whether Newton has arrived."""
    part.CloneTimeStep(float(step))
    part.ProcessInfo[kratos.STEP] = step
    for k, component, force in patch.forces:
        part.GetNode(k + 1).SetSolutionStepValue(LOADS[component], force * step / steps)
    strategy.InitializeSolutionStep()
    strategy.Predict()
    arrived = bool(strategy.SolveSolutionStep())
    strategy.FinalizeSolutionStep()
    return arrived


def _elimination(strategy: Any, solver: Any) -> float:
    """Processor time [s] of one linear solve with the last tangent; the strategy does not count its own."""
    A, b = strategy.GetSystemMatrix(), strategy.GetSystemVector()
    x = kratos.Vector(b.Size(), 0.0)
    return timed(lambda: solver.Solve(A, x, b))[0]

"""What each element adds to the error of a quantity, by its dual problem: displacements that weigh the residuals.

Where x = (u, p) solves F(x) = (r(u) - G^T W p, -W g(u)) = 0 on the contact set and J(x) is the quantity::

    F'(x)^T y = J'(x),    J(x) - J(x_h) = -y . F(x_h) + higher order

(Becker, Rannacher, Acta Numerica 10 (2001) 1-102). J' is taken by differences: a quantity is whatever a scene reads off
a state. Of a limit load the dual displacements are the mode of the limit point. With dE the strains on the next finer
grid less those here, dE_z those of the dual displacements, w areas, and the pressures p, p_z and gaps g, g_z of both
problems::

    J - J_h = sum over parts of w (dE . D dE_z + p_z dg + p dg_z),    eta: the same with |dE|_D |dE_z|_D and |..|

the dual-weighted residual, with the finer grid for the truth: pressures of one grid meet gaps of the other where the
rim of the patch moves. So it is where strains are those of the displacements. Projected ones depend on the grid in
other ways, too, and so do surfaces: the sum is 1.9 (J' - J) on Pagano's plate, and 0.12 (J' - J) on Scordelis and Lo's
roof. It says where to cut, and falls as the error does; how large that is, it does not say. No scene may enter here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.continuation.equilibrium_curve import ArcPoint
from contact.newton.step import NewtonRun
from contact.solvers.sparse import factorise
from formulations.element.mixed import MODE_ROWS
from formulations.geometry.grid import CORNERS
from formulations.shell import Linearisation, ShellModel
from formulations.strains.quantities import N_E
from studies.ask.scene import ShellSceneModel
from studies.scenes.curves import ArcStage
from studies.scenes.walk import Visited
from studies.solving.result import Result

STEP = 1e-6  # of the largest unknown, for differences
SEED = 20  # of the directions that find what a quantity depends on


@dataclass(frozen=True, eq=False)
class OnGrid:
    """A state of a shell and the dual displacements z (n,) of a quantity [its unit/N].

    contact (4, N), at the nodes of the grid: pressure, gap, dual pressure, and the change of the gap along z.
    """

    shell: ShellModel
    u: np.ndarray
    z: np.ndarray
    contact: np.ndarray


def on_grid(result: Result, quantity: str) -> OnGrid:
    """The last state of a path.

    Raises KeyError for a quantity that the stage does not have, ArithmeticError where the tangent is singular.
    """
    model, visited = result.model, result.end
    assert isinstance(model, ShellSceneModel)
    assert visited is not None
    shell = model.shell
    at_nodes = np.zeros((4, shell.discretisation.grid.n_nodes))
    if visited.trace is not None and quantity.startswith("limit_"):
        assert isinstance(visited.stage, ArcStage)
        return OnGrid(shell, *_at_limit(visited.stage, visited.trace.points), at_nodes)
    problem, state = visited.problem, visited.point.solution
    z, pressure = dual(visited, quantity)
    if len(state.pressure):
        touched = np.stack([state.pressure, problem.gap(state.u), pressure, problem.gap_jacobian(state.u) @ z])
        at_nodes = np.append(touched, np.zeros((4, 1)), axis=1)[:, model.candidate_of_node]
    return OnGrid(shell, state.u, z, shell.discretisation.grid.carried(at_nodes.T).T)


def dual(visited: Visited, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """y: the dual displacements z (n,) and pressures (m,), 0 out of contact.

    The quantity is a function of displacements and of the pressures of the nodes in contact.
    """
    problem, state = visited.problem, visited.point.solution
    active, n = np.flatnonzero(state.active), len(state.u)

    def at(x: np.ndarray) -> float:
        pressure = state.pressure.copy()
        pressure[active] = x[n:]
        there = replace(state, u=x[:n], pressure=pressure)
        return visited.stage.observe(problem, there, visited.point.requested).quantities[quantity]

    groups = np.arange(n), n + np.arange(len(active))
    slope = gradient(at, np.concatenate([state.u, state.pressure[active]]), groups)
    by_force = np.zeros(len(state.active))
    by_force[active] = slope[n:]
    lin = problem.linearise(state.u, None)
    adjoint = Linearisation(-slope[:n], sparse.csc_matrix(lin.tangent.T), lin.scale, lin.remember)
    opened = by_force / problem.weights
    run = NewtonRun(replace(problem, gap=lambda u: opened), np.inf, tolerance=1.0)
    return run.step(adjoint, state.u, state.pressure, state.active)


def gradient(function: Callable[[np.ndarray], float], x: np.ndarray, groups: Sequence[np.ndarray]) -> np.ndarray:
    """dJ/dx (n,) by differences; unknowns of one group have one size, and a part that changes nothing is left out."""
    rng = np.random.default_rng(SEED)
    here, slope = function(x), np.zeros(len(x))
    for group in groups:
        step = STEP * float(np.max(np.abs(x[group]), initial=0.0)) or STEP
        parts = [group] if len(group) else []
        while parts:
            part = parts.pop()
            moved = x.copy()
            moved[part] += step * (rng.uniform(0.5, 1.0, len(part)) if len(part) > 1 else 1.0)
            change = function(moved) - here
            if len(part) == 1:
                slope[part] = change / step
            elif change != 0.0:
                parts += np.array_split(part, 2)
    return slope


def _at_limit(stage: ArcStage, points: Sequence[ArcPoint]) -> tuple[np.ndarray, np.ndarray]:
    """u at the first limit point of a curve, and the dual displacements of its load factor: -m/(f . m) of its mode m.

    The tangent there is all but singular: the displacements that it gives for the load f are the mode, by one step of
    inverse iteration. Raises KeyError when there is no limit point.
    """
    point = next((point for point in points if point.limit), None)
    if point is None:
        raise KeyError("the curve has no limit point")
    tangent = sparse.csc_matrix(stage.linearise(point.u, None).tangent)
    mode = factorise(tangent, ordered=stage.continuation.ordered).solve(stage.load)
    return point.u, -mode / float(stage.load @ mode)


def indicators(coarse: OnGrid, fine: OnGrid, parents: np.ndarray) -> tuple[np.ndarray, float]:
    """eta (E,) of the coarse elements [unit of J], and what the rim of the patch has of their sum.

    parents: the coarse element that each fine one is a part of.
    """
    grid, parts = coarse.shell.discretisation.grid, fine.shell.discretisation.grid
    xi = (parts.centre - grid.centre[parents]) / grid.half[parents]
    D = fine.shell.discretisation.laminate.stiffness(fine.shell.section)
    norms = []
    for here, there in zip(_strains(coarse), _strains(fine), strict=True):
        d = there[:, :N_E] - _at(here[parents], xi)
        norms.append(np.sqrt(np.maximum(np.einsum("ei,ij,ej->e", d, 0.5 * (D + D.T), d), 0.0)))
    weight, rim = fine.shell.discretisation.geometry.weight, np.abs(_at_rim(coarse, fine, parents))
    eta = np.bincount(parents, weights=weight * (norms[0] * norms[1] + rim), minlength=len(grid.elements))
    return eta.astype(float), float(weight @ rim)


def _at_rim(coarse: OnGrid, fine: OnGrid, parents: np.ndarray) -> np.ndarray:
    """p_z dg + p dg_z (e,) of the fine elements [unit of J/mm^2]."""
    grid, parts = coarse.shell.discretisation.grid, fine.shell.discretisation.grid
    xi = (parts.points(CORNERS) - grid.centre[parents][:, None]) / grid.half[parents][:, None]
    shares = 0.25 * np.prod(1 + xi[:, :, None] * CORNERS, axis=-1)  # (e, corner, corner of the parent)
    pressure, gap, dual_pressure, dual_gap = (
        (there, here)
        for there, here in zip(
            np.einsum("ecr,ker->kec", shares, coarse.contact[:, grid.elements[parents]]),
            fine.contact[:, parts.elements],
            strict=True,
        )
    )
    met = dual_pressure[1] * (gap[0] - gap[1]) + pressure[0] * (dual_gap[1] - dual_gap[0])
    return np.asarray(met.mean(axis=-1))


def _strains(at: OnGrid) -> tuple[np.ndarray, np.ndarray]:
    """Mode strains (E, 22) of the displacements, and their change along the dual ones."""
    return at.shell.mode_strains(at.u), at.shell.strain_change(at.u, at.z)


def _at(modes: np.ndarray, xi: np.ndarray) -> np.ndarray:
    """The strains (k, 11) at the points xi (k, 2) of elements with the mode strains (k, 22)."""
    strains = np.zeros((len(modes), N_E))
    for m, ((r1, r2), row) in enumerate(MODE_ROWS):
        strains[:, row] += modes[:, m] * xi[:, 0] ** r1 * xi[:, 1] ** r2
    return strains

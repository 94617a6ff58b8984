"""The dual problem of a quantity: displacements that weigh the residuals of a grid for it.

Where x = (u, p) solves F(x) = (r(u) - G^T W p, -W g(u)) = 0 on the contact set and J(x) is the quantity::

    F'(x)^T y = J'(x),    J(x) - J(x_h) = -y . F(x_h) + higher order

(Becker, Rannacher, Acta Numerica 10 (2001) 1-102). J' is taken by differences: a quantity is whatever a scene reads off
a state. Of a limit load the dual displacements are the mode of the limit point. How elements are marked does not enter.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.continuation.equilibrium_curve import ArcPoint
from contact.newton.step import NewtonRun
from contact.problem import ContactProblem
from contact.solvers.sparse import factorise
from formulations.shell import Linearisation, ShellModel
from studies.scenes.curves import ArcStage
from studies.scenes.walk import Visited

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


def on_grid(visited: Visited, quantity: str, shell: ShellModel, nodes: np.ndarray) -> OnGrid:
    """The last state of a path; nodes (N,): the candidate whose values each node of the grid has, -1 for none.

    Raises KeyError for a quantity that the stage does not have, ArithmeticError where the tangent is singular.
    """
    at_nodes = np.zeros((4, shell.discretisation.grid.n_nodes))
    if visited.trace is not None and quantity.startswith("limit_"):
        assert isinstance(visited.stage, ArcStage)
        return OnGrid(shell, *_at_limit(visited.stage, visited.trace.points), at_nodes)
    problem, state = visited.problem, visited.point.solution
    z, pressure = dual(visited, quantity)
    if len(state.pressure):
        touched = np.stack([state.pressure, problem.gap(state.u), pressure, problem.gap_jacobian(state.u) @ z])
        at_nodes = np.append(touched, np.zeros((4, 1)), axis=1)[:, nodes]
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
    run = NewtonRun(_with_gap(problem, by_force / problem.weights), np.inf, tolerance=1.0)
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


def _with_gap(problem: ContactProblem, gap: np.ndarray) -> ContactProblem:
    return replace(problem, gap=lambda u: gap)


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

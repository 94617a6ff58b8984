"""Results of another program, compared with our solution, the references of the scene, and the balances of forces
and energy that it must keep by itself.

Quantities are read from a field as the scene reads its own: the displacements of both faces at the nodes of the shell
are put into the shell. Our solution is computed at the loads of the other program.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from formulations.shell import ShellModel
from studies.exchange.problem import LoadStep, Problem
from studies.exchange.results import GROWTH, PLANE_FORCE, REACTION, STRAIN_ENERGY, Found
from studies.scenes import SCENES
from studies.scenes.complete import complete, holding
from studies.scenes.statics import StaticModel
from studies.scenes.tyre.press import PressedTyre
from studies.solving.result import Result
from studies.solving.solve import solve

Reader = Callable[[float, np.ndarray], dict[str, float]]  # (load, u (N, 3)) -> quantities of the scene
OURS, WORK, NOTHING = "ours", "half of the work of the loads", "balance of forces"


@dataclass(frozen=True)
class Comparison:
    """A value from outside beside one that it should have.

    allowed: relative difference, the tolerance and what the value itself is known to.  scale: what the difference is
    relative to, the value unless given.
    """

    load: float
    quantity: str
    found: float
    against: str
    value: float
    allowed: float
    scale: float | None = None

    @property
    def difference(self) -> float:
        """Relative, with its sign."""
        return (self.found - self.value) / abs(self.value if self.scale is None else self.scale)

    @property
    def within(self) -> bool:
        """Whether it is as small as allowed; what is not a number is not."""
        return abs(self.difference) <= self.allowed


def our_solution(
    problem: Problem, loads: Sequence[float], given: Mapping[str, object], mesh: str | None = None, **options: Any
) -> Result:
    """Solved at these loads; raises UsageError for loads out of the scene's range.

    given, options: as the problem was asked for.  mesh: of our solution, that of the bricks unless given.
    """
    size = problem.request.mesh if mesh is None else mesh
    settings = {**given, problem.key: tuple(loads)}
    return solve(*complete(problem.request.scene, settings, size, **options))


def compared(problem: Problem, results: Sequence[Found], ours: Result, tolerance: float) -> list[Comparison]:
    """All that can be compared."""
    read = _reader(problem)
    per_plane = _per_plane_force(problem, ours)
    rows: list[Comparison] = []
    for each in results:
        quantities = dict(each.quantities)
        if each.u is not None and read is not None:
            quantities |= read(each.load, each.u)
        if PLANE_FORCE in quantities:
            quantities |= {name: factor * quantities[PLANE_FORCE] for name, factor in per_plane.items()}
        rows += _against_ours(each.load, quantities, ours, tolerance)
        rows += _against_references(problem, each.load, quantities, tolerance)
        rows += _balances(problem, each, tolerance)
    return rows + list(_energy(problem, results[-1], ours, tolerance))


def _against_ours(load: float, quantities: Mapping[str, float], ours: Result, tolerance: float) -> Iterator[Comparison]:
    known = {GROWTH: ours.quantities.get(GROWTH), **_at(ours, load)}
    for name, value in quantities.items():
        if isinstance(known.get(name), int | float) and known[name] != 0:
            yield Comparison(load, name, value, OURS, float(known[name]), tolerance)


def _at(ours: Result, load: float) -> dict[str, Any]:
    return next((dict(s.quantities) for s in ours.loads if np.isclose(next(iter(s.load.values())), load)), {})


def _against_references(
    problem: Problem, load: float, quantities: Mapping[str, float], tolerance: float
) -> Iterator[Comparison]:
    request = problem.request
    there = {**request.settings, "measure": request.measure, problem.key: load}
    for known in holding(request.scene, there):
        # what a reference of large displacements says of small ones is the error of the measure, not of a program
        fits = problem.nonlinear or known.at.get("measure") == request.measure
        if fits and known.quantity in quantities:
            allowed = tolerance + known.uncertainty
            yield Comparison(load, known.quantity, quantities[known.quantity], known.source, known.value, allowed)


def _balances(problem: Problem, result: Found, tolerance: float) -> Iterator[Comparison]:
    step = problem.step_at(result.load)
    if step is None and problem.touched is not None:  # its travel is that of the other program
        step = min(problem.steps[1:], key=lambda each: abs((each.load or 0.0) - result.load))
    if step is None:
        return
    forces = force_balance(problem, step, result)
    if forces is not None:
        yield Comparison(result.load, "unbalanced_N", forces[0], NOTHING, 0.0, tolerance, scale=forces[1])
    energies = energy_balance(problem, step, result)
    if energies is not None:
        yield Comparison(result.load, STRAIN_ENERGY, energies[0], WORK, energies[1], tolerance)


def force_balance(problem: Problem, step: LoadStep, result: Found) -> tuple[float, float] | None:
    """What supports, plane and loads leave over, and the largest of the three [N]; None where one is not given.

    R + sum F + int p n dA - F_n n = 0 with the reactions R of the supports and the force F_n of the body on the plane.
    """
    quantities = result.quantities
    pressure = problem.pressure_forces(step, result.u)
    if pressure is None or not set(REACTION) <= quantities.keys():
        return None
    parts = [np.array([quantities[name] for name in REACTION]), step.forces.sum(axis=0), pressure.sum(axis=0)]
    if problem.plane is not None:
        if PLANE_FORCE not in quantities:
            return None
        parts.append(-quantities[PLANE_FORCE] * problem.plane.normal)
    size = max(np.linalg.norm(step.forces, axis=1).max(initial=0.0), *(float(np.linalg.norm(each)) for each in parts))
    return float(np.linalg.norm(np.sum(parts, axis=0))), float(size)


def energy_balance(problem: Problem, step: LoadStep, result: Found) -> tuple[float, float] | None:
    """Strain energy and half of the work of the loads on the final displacements [N mm]: equal where all is linear.

    None for large displacements, with a plane or a pressure, and where the displacement of a loaded node is not given.
    """
    if problem.nonlinear or problem.plane is not None or step.pressure.any() or STRAIN_ENERGY not in result.quantities:
        return None
    loaded = step.forces.any(axis=1)
    if result.u is None or not np.all(np.isfinite(result.u[loaded])):
        return None
    return result.quantities[STRAIN_ENERGY], 0.5 * float(np.sum(step.forces[loaded] * result.u[loaded]))


def _energy(problem: Problem, result: Found, ours: Result, tolerance: float) -> Iterator[Comparison]:
    """Strain energy at the last load, of the same part."""
    shell = getattr(ours.model, "shell", None)
    same = ours.request.model == problem.request.model and ours.outcome.converged
    if STRAIN_ENERGY not in result.quantities or not isinstance(shell, ShellModel) or ours.last is None or not same:
        return
    value = shell.scaled(0.0).energy(ours.last.u)
    yield Comparison(result.load, STRAIN_ENERGY, result.quantities[STRAIN_ENERGY], OURS, value, tolerance)


def _reader(problem: Problem) -> Reader | None:
    """What reads as the scene does; None where that reads more than displacements."""
    model = SCENES[problem.request.scene].build(problem.request)
    if not isinstance(model, StaticModel) or problem.shell is None:
        return None
    shell = model.shell.discretisation
    frame, nodes = shell.surface.frame(*shell.grid.nodes.T), problem.shell

    def read(load: float, u: np.ndarray) -> dict[str, float]:
        v = np.empty((len(nodes), 6))
        for face in (0, 1):
            v[:, face::2] = np.einsum("nix,nx->ni", frame, u[nodes[:, face]])
        if not np.all(np.isfinite(v)):
            return {}
        return dict(model.measure_at(model.shell.scaled(load), shell.map.restrict(v)))

    return read


def _per_plane_force(problem: Problem, ours: Result) -> dict[str, float]:
    """What a quantity that is a force is per force on the plane of the part that is modelled, by our last state."""
    if problem.plane is None or ours.end is None or not ours.loads:
        return {}
    force = float(np.sum(ours.end.problem.nodal_forces(ours.end.point.solution.pressure)))
    parts = problem.copies / (ours.model.wall.part.copies if isinstance(ours.model, PressedTyre) else 1)
    quantities = ours.loads[-1].quantities
    names = (name for name in quantities if name.removesuffix("_N").endswith("force"))
    return {name: parts * float(quantities[name]) / force for name in names if force != 0}

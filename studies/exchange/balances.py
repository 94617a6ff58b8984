"""Balances of forces and of energy that results from outside must keep by themselves, whoever has found them."""

from __future__ import annotations

import numpy as np

from studies.exchange.pressure import pressure_forces
from studies.exchange.problem import LoadStep, Problem
from studies.exchange.results import PLANE_FORCE, REACTION, STRAIN_ENERGY, Found


def force_balance(problem: Problem, step: LoadStep, found: Found) -> tuple[float, float] | None:
    """What supports, plane and loads leave over, and the largest of the three [N]; None where one is not told.

    R + sum F + int p n dA - F_n n = 0 with the reactions R of the supports and the force F_n of the body on the plane.
    """
    told = found.quantities
    pressure = pressure_forces(problem, step, found.u)
    if pressure is None or not set(REACTION) <= told.keys():
        return None
    parts = [np.array([told[name] for name in REACTION]), step.forces.sum(axis=0), pressure.sum(axis=0)]
    if problem.plane is not None:
        if PLANE_FORCE not in told:
            return None
        parts.append(-told[PLANE_FORCE] * problem.plane.normal)
    size = max(np.linalg.norm(step.forces, axis=1).max(initial=0.0), *(float(np.linalg.norm(each)) for each in parts))
    return float(np.linalg.norm(np.sum(parts, axis=0))), float(size)


def energy_balance(problem: Problem, step: LoadStep, found: Found) -> tuple[float, float] | None:
    """Strain energy and half of the work of the loads on the final displacements [N mm]: equal where all is linear.

    None for large displacements, with a plane or a pressure, and where the displacement of a loaded node is not told.
    """
    if problem.nonlinear or problem.plane is not None or step.pressure.any() or STRAIN_ENERGY not in found.quantities:
        return None
    loaded = step.forces.any(axis=1)
    if found.u is None or not np.all(np.isfinite(found.u[loaded])):
        return None
    return found.quantities[STRAIN_ENERGY], 0.5 * float(np.sum(step.forces[loaded] * found.u[loaded]))

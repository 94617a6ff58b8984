"""What a change of its data does to the tyre of the paper; these derivatives at work: the least pressure on the ground.

Derivatives are those of :mod:`studies.solving.derivatives`, at two travels on two meshes, by which one sees how well
they are known: those of the mean pressure and of the half width with the lengths of the tyre, which move the mesh under
the rim of the patch, differ by half of themselves, and are left out. The paper prints its data with as many digits as
PRINTED has; what half a unit of the last one changes is the part of a difference from its table that rounding can
explain.

The design problem: cord angle and inflation pressure within BOUNDS, the least mean of the contact pressure, weighted by
its own force, at TRAVEL, while the tyre carries no less than a force and inflation takes no more than a length off its
outer radius (LEAST). It is solved by scipy's SLSQP with these derivatives on several meshes, and on the first of them
by every combination of a grid, which knows no derivative. The spread of the pressure about that mean is not a goal: a
quarter of it is the mesh at the rim of the patch, and optima move from mesh to mesh (measured on 28x26 to 84x80).
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import product

import numpy as np
import pandas as pd
from scipy.optimize import NonlinearConstraint, minimize

from studies.scenes.complete import complete
from studies.solving.derivatives.gradient import gradients
from studies.solving.result import Result
from studies.solving.solve import solve

PRINTED = {
    "gamma_deg": "52",
    "p0_MPa": "0.15",
    "delta_mm": "20",
    "ply_thickness_mm": "1.2",
    "E_L_MPa": "510.45",
    "E_T_MPa": "6.91",
    "G_LT_MPa": "2.33",
    "G_TT_MPa": "1.77",
    "nu_LT": "0.46",
    "nu_TT": "0.95",
    "R1_mm": "50",
    "R0_mm": "250",
    "clamp_deg": "120",
}
TRAVELS, BOTH = ("5", "20"), ("42x40", "84x80")
READ = {"rim": "pressure"}  # extents of the patch by pressures, which have derivatives
SEEN = ("force_N", "centre_pressure_MPa", "half_length_mm", "inflated_equator_outer_mm")

BOUNDS = {"gamma_deg": (40.0, 56.0), "p0_MPa": (0.1, 0.26)}
GOAL, LEAST = "mean_pressure_MPa", {"inflated_equator_outer_mm": -0.5, "force_N": 1900.0}
TRAVEL, MESHES = "20", ("28x26", "42x40", "56x52")
SIZES = np.abs([1.0, *LEAST.values()])
COUNT = 17  # values of each setting on the grid
DIGITS, CLOSE = 9, 1e-9  # of these values; of the goal, to which the optimiser goes


def half_a_unit(printed: str) -> float:
    """Of the last digit of a number in print."""
    return 0.5 * 10.0 ** -len(printed.partition(".")[2])


def what_if() -> pd.DataFrame:
    """A row a mesh, travel, quantity and setting: per cent for a per cent, and the part for half a unit in print."""
    rows = []
    for mesh, travel in product(BOTH, TRAVELS):
        scene, request = complete("tyre", {**READ, "delta_mm": travel}, mesh)
        for each in gradients(scene, solve(scene, request), tuple(PRINTED)):
            if each.quantity in SEEN:
                given = travel if each.setting == "delta_mm" else PRINTED[each.setting]
                unit = half_a_unit(given)
                here = {"mesh": mesh, "delta_mm": float(travel), "quantity": each.quantity, "value": each.value}
                relative = {"relative": each.relative, "rounding": abs(each.above * unit / each.value)}
                rows.append({**here, "setting": each.setting, "printed": float(given), "half_a_unit": unit, **relative})
    return pd.DataFrame(rows)


@dataclass(frozen=True)
class Design:
    """The goal and what is kept over (cord angle, pressure), both in parts of their bounds, on a mesh.

    seen: every pair that was asked for, with what was solved there.
    """

    mesh: str
    seen: dict[tuple[float, ...], tuple[Result, np.ndarray]] = field(default_factory=dict)

    def at(self, x: np.ndarray) -> tuple[Result, np.ndarray]:
        """The answer, and the derivatives of goal and what is kept with both parts (3, 2); ValueError without one."""
        given = dict(zip(BOUNDS, self.settings(x), strict=True))
        key = tuple(given.values())
        if key not in self.seen:
            scene, request = complete("tyre", {"delta_mm": TRAVEL, **given}, self.mesh)
            result = solve(scene, request)
            if not result.outcome.converged:
                raise ValueError(f"no answer at {given}: {result.reason or result.outcome.value}")
            rates = {(each.quantity, each.setting): each.above for each in gradients(scene, result, tuple(BOUNDS))}
            names, spans = (GOAL, *LEAST), {key: high - low for key, (low, high) in BOUNDS.items()}
            slopes = [[rates[name, key] * span for key, span in spans.items()] for name in names]
            self.seen[key] = result, np.array(slopes)
        return self.seen[key]

    def settings(self, x: np.ndarray) -> list[float]:
        """The values of both settings."""
        return [low + float(part) * (high - low) for part, (low, high) in zip(x, BOUNDS.values(), strict=True)]

    def values(self, x: np.ndarray) -> np.ndarray:
        """Goal and what is kept, by the sizes of their limits."""
        return np.array([self.at(x)[0].quantities[name] for name in (GOAL, *LEAST)]) / SIZES

    def slopes(self, x: np.ndarray) -> np.ndarray:
        """The derivatives (3, 2) of these."""
        return self.at(x)[1] / SIZES[:, None]

    def optimum(self) -> tuple[float, ...] | None:
        """Of the optimiser that sets out from the tyre of the paper; None where it gives up."""

        def goal(x: np.ndarray) -> float:
            return float(self.values(x)[0])

        def slope(x: np.ndarray) -> np.ndarray:
            return self.slopes(x)[0]

        start = [(float(PRINTED[key]) - low) / (high - low) for key, (low, high) in BOUNDS.items()]
        least = np.sign([*LEAST.values()])
        kept = NonlinearConstraint(lambda x: self.values(x)[1:], least, math.inf, jac=lambda x: self.slopes(x)[1:])
        inside = [(0.0, 1.0)] * len(BOUNDS)
        result = minimize(goal, np.array(start), jac=slope, method="SLSQP", bounds=inside, constraints=kept, tol=CLOSE)
        return tuple(self.settings(result.x)) if result.success else None


def even_footprint() -> pd.DataFrame:
    """Every answer that the optimiser has asked for, mesh by mesh."""
    return pd.DataFrame([row for mesh in MESHES for row in _asked_for(Design(mesh))])


def _asked_for(design: Design) -> Iterator[dict[str, object]]:
    optimum = design.optimum()
    posed = {"delta_mm": float(TRAVEL), **{f"least_{name}": least for name, least in LEAST.items()}}
    for key, (result, _) in design.seen.items():
        read = {name: result.quantities[name] for name in (GOAL, *LEAST)}
        yield {"mesh": design.mesh, **posed, **dict(zip(BOUNDS, key, strict=True)), **read, "optimum": key == optimum}


def every_footprint() -> pd.DataFrame:
    """All combinations of COUNT values of both settings, on the first mesh."""
    rows = []
    for values in product(*(np.linspace(*ends, COUNT).round(DIGITS) for ends in BOUNDS.values())):
        given = dict(zip(BOUNDS, map(float, values), strict=True))
        result = solve(*complete("tyre", {"delta_mm": TRAVEL, **given}, MESHES[0]))
        rows.append(
            {**given, "verdict": result.verdict, **{name: result.quantities.get(name) for name in (GOAL, *LEAST)}}
        )
    return pd.DataFrame(rows)

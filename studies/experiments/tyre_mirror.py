"""How far the pressure under a tyre is from its mirror image, over the cord angle: zero at 0 and 90 degrees only.

Plies at +-gamma have no mirror plane, but a half turn about the normal, so both mirrors are off alike. Near 0 and 90
degrees the inflated tyre is not stable: its tangent has negative eigenvalues before anything touches it, and which of
several states a solver then finds is a matter of its steps. Such angles are told by their number of negative
eigenvalues. The maximum is searched for in one dimension among the stable ones, around the largest value on the grid.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.optimize import minimize_scalar

from contact.continuation.critical_points import negative_eigenvalues
from formulations.strains.catalogue import MEASURES
from studies.ask.settings import configured
from studies.experiments import Row
from studies.scenes.complete import Cell, complete
from studies.scenes.tyre.readings import central_asymmetry, mirror_asymmetry
from studies.scenes.tyre.scene import Tyre
from studies.scenes.walk import walk

NEAR = 1.0  # deg, how near the search comes to the angle of the maximum
ANGLES = (0.0, 2.0, 5.0, *range(10, 50, 5), 52.0, *range(55, 90, 5), 88.0, 90.0)
FEW = (0.0, 5.0, 15.0, 30.0, 45.0, 52.0, 60.0, 75.0, 85.0, 90.0)


@dataclass(frozen=True)
class Sweep:
    """The tyre of the paper by one measure on one mesh, over the angles [deg]."""

    measure: str
    mesh: str
    angles: tuple[float, ...]
    delta_mm: str = "10,20"

    def at(self, gamma: float, kind: str) -> Row:
        """One angle: the largest difference of the pressure from its mirror image, all in MPa.

        mirror_MPa counts no contact as zero pressure, mirror_both_MPa only pairs of nodes that both touch.
        central_MPa: from the image under the half turn.
        """
        settings = {"gamma_deg": f"{gamma:.6g}", "delta_mm": self.delta_mm, "element": "paper"}
        cell = Cell("", "tyre", {"measure": self.measure, "mesh": self.mesh, "model": "half"}, settings)
        _, request = complete(cell.scene, cell.settings, **cell.options)
        row: Row = {"measure": self.measure, "mesh": self.mesh, "gamma_deg": gamma, "kind": kind}
        row["command"] = cell.command
        model = Tyre().build(request)
        *_, last = walk(model.stages(), configured(request.contact, request.settings), request.steps)
        if not last.converged:
            return row | {"outcome": last.point.outcome.word}
        state = last.state
        row |= {"outcome": "converged", "delta_mm": last.point.requested}
        row["negative"] = negative_eigenvalues(last.problem, state, np.inf)
        own, touching = (model.wall.spread(v).reshape(model.wall.part.shape) for v in (state.pressure, state.active))
        row |= {"peak_MPa": float(own.max()), "contact_nodes": int(touching.sum())}
        row |= {"mirror_MPa": mirror_asymmetry(own), "mirror_both_MPa": mirror_asymmetry(own, touching)}
        return row | {"central_MPa": central_asymmetry(own)}


def all_sweeps() -> tuple[Sweep, ...]:
    """The exact measure on a fine mesh, and each of the catalogue on a coarse one."""
    return (Sweep("exact", "42x40", ANGLES), *(Sweep(measure, "14x20", FEW, "12") for measure in MEASURES))


def mirror_table(sweeps: Sequence[Sweep] = ()) -> pd.DataFrame:
    """One row an angle: those of the grid, then those of the search for the largest ``mirror_both_MPa``."""
    rows = []
    for sweep in sweeps or all_sweeps():
        own = [sweep.at(gamma, "grid") for gamma in sweep.angles]
        rows += own + _searched(sweep, own)
    return pd.DataFrame(rows).sort_values(["mesh", "measure", "gamma_deg"], kind="stable", ignore_index=True)


def _searched(sweep: Sweep, own: Sequence[Row]) -> list[Row]:
    """Brent's search between the neighbours of the largest value of a stable state on the grid."""
    value = np.array([_stable_value(row) for row in own])
    if not value.any():
        return []
    top = int(np.argmax(value))
    low, high = (sweep.angles[min(max(i, 0), len(own) - 1)] for i in (top - 1, top + 1))
    found: list[Row] = []

    def asymmetry(gamma: float) -> float:
        found.append(sweep.at(float(gamma), "search"))
        return -_stable_value(found[-1])

    minimize_scalar(asymmetry, bounds=(low, high), method="bounded", options={"xatol": NEAR})
    return found


def _stable_value(row: Row) -> float:
    """The asymmetry of a row, 0 where its state is none or is not stable."""
    return float(row["mirror_both_MPa"]) if row.get("negative") == 0 else 0.0

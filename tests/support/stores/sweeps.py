"""Tables of crossed sweeps made up here, as a campaign would collect them; nothing is solved."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import pandas as pd

from studies.ask.request import Request, Settings
from studies.scenes import SCENES

EXACT = 6.69964  # mm, the cantilever's tip deflection under the whole load, as its scene says
SIZES = (8, 16, 32, 64)


def cells(
    scene: str = "cantilever",
    quantity: str = "tip_deflection_mm",
    truth: float = EXACT,
    setting: str = "load_fraction=1",
    *,
    measures: dict[str, float] | None = None,
    contacts: dict[str, float] | None = None,
    tolerances: dict[float, float] | None = None,
    mesh_error: Callable[[int], float] = lambda n: 2.0 / n**2,
    sizes: tuple[int, ...] = SIZES,
) -> pd.DataFrame:
    """A crossed sweep of one scene: value = truth (1 + mesh + measure + solver), cost = that of the mesh times factors.

    measures: relative error of each; contacts: factor of the cost of each; tolerances: relative error of each.
    """
    rows = []
    for (measure, model), (contact, factor), (tolerance, solver), n in itertools.product(
        (measures or {"exact": 0.0}).items(),
        (contacts or {"semismooth": 1.0}).items(),
        (tolerances or {1e-10: 0.0}).items(),
        sizes,
    ):
        key, _, text = setting.partition("=")
        known = {each.key: each for each in SCENES[scene].settings}
        settings = {key: known[key].parse(text) if key in known else text, "tolerance": tolerance}
        request = Request(scene, measure, contact, mesh=(n, 1), model="full", settings=Settings(settings))
        value = truth * (1 + mesh_error(n) + model + solver)
        operations = 1e3 * factor * n**1.5 * (1 - 0.02 * math.log10(tolerance))
        rows.append(
            {
                "label": f"{scene} {measure} {contact} {n} {tolerance:g}",
                "scene": scene,
                "measure": measure,
                "contact": contact,
                "newton": "mixed",
                "element": "refined",
                "model": "full",
                "mesh": f"{n}x1",
                "n1": n,
                "n2": 1,
                "tolerance": tolerance,
                "outcome": "converged",
                "command": f"footprint solve {scene} --mesh {n}x1 --out DIR",
                "request": request,
                f"q.{quantity}": value,
                "c.dofs": 12 * n,
                "c.newton_iterations": 5 - round(math.log10(tolerance)),
                "c.factorisations": 5 - round(math.log10(tolerance)),
                "c.operations": operations,
                "t.seconds": 1e-6 * operations,
            }
        )
    return pd.DataFrame(rows)

"""Made-up errors whose orders are chosen: of manufactured solutions, and of crossed sweeps.

Made-up errors of manufactured solutions: exponents are chosen.

Tables of crossed sweeps made up here, as a campaign would collect them; nothing is solved.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import pandas as pd

from formulations.strains.catalogue import MEASURES
from studies.ask.request import Request, Settings
from studies.experiments.manufactured import DEFAULT, OPTIONS, ways
from studies.scenes import SCENES

NAMES = ("displacement", "resultants", "mean_resultants", "energy")
THEORY = (2.0, 1.0, 2.0, 1.0)


def errors(n: int, orders: tuple[float, ...] = THEORY) -> dict[str, float]:
    """8 n^-order of each."""
    return {f"error_{name}": 8.0 * n**-order for name, order in zip(NAMES, orders, strict=True)}


def made_up_manufactured(displacement: float = 2.0) -> pd.DataFrame:
    """All measures on a torus, and the last one on a cylinder with another order of the displacement."""
    case = {"group": "measures", "element": "refined", "settings": "", "class": "converged"}
    pieces = [(measure, "torus", 2.0) for measure in MEASURES] + [(list(MEASURES)[-1], "cylinder", displacement)]
    return pd.DataFrame(
        {**case, "measure": measure, "surface": surface, "n": n, **errors(n, (order, 1.0, 2.0, 1.0))}
        for measure, surface, order in pieces
        for n in (8, 16, 32)
    )


def made_up_distortion() -> pd.DataFrame:
    """Nodes that are moved by a share make the error larger by it; means are of the first order then."""
    return pd.DataFrame(
        {"measure": measure, "distortion": kind, "amount": amount, "n": n, "class": "converged"}
        | {name: (1 + amount) * error for name, error in errors(n, (2.0, 1.0, 1.0 if amount else 2.0, 1.0)).items()}
        for measure in MEASURES
        for kind, amount in ways((0.2,))
        for n in (16, 32)
    )


def made_up_shells() -> pd.DataFrame:
    """Two shells, of which the second loses twice as much; with the default element a quarter of that when finer."""
    cases = [(DEFAULT, 1), (DEFAULT, 2), *((options, 1) for options in OPTIONS if options != DEFAULT)]
    return pd.DataFrame(
        {"scene": scene, "mesh": f"{8 * finer}x8", "finer": finer, **options, "distortion": kind, "amount": amount}
        | {"change": -lost * amount / finer**2, "class": "converged"}
        for scene, lost in (("hypar", 0.01), ("cantilever", 0.02))
        for options, finer in cases
        for kind, amount in ways((0.1, 0.2) if options == DEFAULT else (0.1,))
    )


def made_up_touching() -> pd.DataFrame:
    """A plate at two radii: pressure and edge of the first order, the edge off by 0.4 elements."""
    return pd.DataFrame(
        {"measure": "exact", "surface": "plate", "radius": radius, "n": n, **errors(n)}
        | {"error_pressure": 1 / n, "error_edge": 0.8 / n / radius, "newton_iterations": n, "class": "converged"}
        for n in (8, 16)
        for radius in (0.25, 0.5)
    )


def made_up_statements(wrong: str = "") -> pd.DataFrame:
    """Two measures, of which the first has what is ``wrong``."""
    return pd.DataFrame([{"measure": "exact", "wrong": wrong}, {"measure": "linear", "wrong": ""}])


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

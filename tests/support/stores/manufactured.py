"""Made-up errors of manufactured solutions: exponents are chosen."""

from __future__ import annotations

import pandas as pd

from formulations.strains.catalogue import MEASURES
from studies.experiments.manufactured import DEFAULT, OPTIONS, ways

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

"""A made-up table of walls: errors of 1, 0.1 and 0 times h^2, known to a ten-thousandth of a per cent."""

from __future__ import annotations

import pandas as pd

from studies.experiments.shell_limits.bodies import DEFAULT, FULL_3D, THREE
from studies.experiments.shell_limits.ladder import COLUMNS

FACTORS = {"bad": 1.0, "better": 0.1, "best": 0.0}


def made_up_walls() -> pd.DataFrame:
    """Three cases, their shells of two laws and a straight solid; the solid costs seven times the shell."""
    rows = []
    for case, factor in FACTORS.items():
        for ratio in (0.01, 0.03, 0.1, 0.5):
            own = {"case": case, "scene": "", "quantity": "w", "thickness": "h/R", "ratio": ratio, "known_to": 1e-6}
            own |= {"exact": 1.0, "solid_against_exact": 1e-5, "fails": f"why it is {case}", "shell_unknowns": 10}
            own |= {"solid_unknowns": 50, "shell_seconds": 1.0, "solid_seconds": 7.0}
            rows += [{**own, "variant": name, "error": factor * ratio**2} for name in (DEFAULT, FULL_3D.name)]
            rows += [{**own, "variant": THREE.name, "error": factor * ratio**3, "shell_seconds": 2.0}]
    return pd.DataFrame(rows, columns=list(COLUMNS))

"""What a law that is linear in Green's strain changes, beside the largest strain: a number for "small strain".

To first order S = E (e - k e^2): the strain of a membrane under a given load differs by k e of itself, k = 3 between
St. Venant-Kirchhoff and Hencky (:mod:`formulations.solid.laws`). In bending the two sides of the wall cancel that.
"""

from __future__ import annotations

import math

import pandas as pd

from studies.analysis.richardson import power_of

REFERENCE, OTHERS = "svk", {"hencky": "off_hencky", "neo-hooke": "off_neo_hooke"}
ONE_PERCENT = 0.01
SPAN = 2.0  # largest over least strain from which on a power is fitted


def law_offsets(study: pd.DataFrame) -> pd.DataFrame:
    """A row for each specimen and load: value and strain with svk, off_hencky, off_neo_hooke and factor.

    off: of the value with svk over that with the other law, less 1; factor: |off_hencky| over the strain.
    """
    own = study[study["law"] == REFERENCE].drop(columns="law").reset_index(drop=True)
    for law, column in OTHERS.items():
        other = study[study["law"] == law].reset_index(drop=True)
        if not other[["specimen", "load"]].equals(own[["specimen", "load"]]):
            raise ValueError(f"the loads with {law} are not those with {REFERENCE}")
        own[column] = own["value"] / other["value"] - 1
    return own.assign(factor=own["off_hencky"].abs() / own["strain"])


def law_rules(study: pd.DataFrame) -> pd.DataFrame:
    """A row for each specimen: factor, its largest; percent_at, the strain at which that makes 1 %; power, fitted.

    percent_at: NaN beyond the strains that were reached.  power: of |off_hencky| over the strain, by least squares; NaN
    where strains span less than a factor of two.
    """
    rows = []
    for _, own in law_offsets(study).groupby("specimen", sort=False):
        factor = float(own["factor"].max())
        row = {name: own[name].iloc[0] for name in ("specimen", "carries", "quantity")}
        least, largest = float(own["strain"].min()), float(own["strain"].max())
        at = ONE_PERCENT / factor if ONE_PERCENT / factor <= largest else math.nan
        row |= {"least_strain": least, "largest_strain": largest, "factor": factor, "percent_at": at}
        rows.append(
            {**row, "power": power_of(own["strain"], own["off_hencky"]) if largest >= SPAN * least else math.nan}
        )
    return pd.DataFrame(rows)

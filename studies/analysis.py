"""All tables of the analysis of a campaign, from its collected table into STORE/tables; the reports only read them."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from studies.advise import advice_table
from studies.attribution import attribution
from studies.detectors import flags
from studies.held_out import held_out, summary
from studies.profiles import profiles
from studies.rows import reference_rows
from studies.scene import UsageError
from studies.store import write_table
from studies.table import collect
from studies.tradeoff import family_fronts, fronts
from studies.verification import verified


def analyse(store: Path, campaign: str) -> list[Path]:
    """Write the tables of a campaign; returns their paths. Raises UsageError when it has no cell with an answer."""
    tables = analysed(collect(store, campaign))
    paths = []
    for name, table in tables.items():
        path = store / "tables" / f"{name}.csv"
        write_table(path, table.assign(campaign=campaign))
        paths.append(path)
    return paths


def analysed(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """All tables by name, from a collected one; raises UsageError when no cell of it has an answer."""
    if table.empty or not (table["outcome"] == "converged").any():
        raise UsageError("nothing to analyse: no cell of the campaign has converged")
    references = reference_rows(table)
    split = verified(table, references)
    scenes = fronts(table, split)
    profile, pairs, flips = profiles(scenes)
    cases = held_out(table, split)
    return {
        "verified": split,
        "flags": flags(table, references),
        "fronts": scenes,
        "family_fronts": family_fronts(scenes),
        "profiles": profile,
        "pairs": pairs,
        "flips": flips,
        "attribution": attribution(table, scenes),
        "advice": advice_table(table, split),
        "held_out": cases,
        "held_out_summary": summary(cases),
    }

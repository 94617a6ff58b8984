"""All tables of the analysis of a campaign, from its collected table into STORE/tables; the reports only read them."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from studies.analysis.advise import advice_table
from studies.analysis.attribution import attribution
from studies.analysis.collect import collect
from studies.analysis.fronts import family_fronts, fronts
from studies.analysis.held_out import held_out, summary
from studies.analysis.profiles import profiles, solved
from studies.analysis.rows import reference_rows
from studies.analysis.suspicious import flags
from studies.analysis.verify import verified
from studies.scene import UsageError
from studies.store.atomic import write_table


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
        "fronts": scenes.drop(columns="request"),
        "family_fronts": family_fronts(scenes),
        "profiles": profile,
        "pairs": pairs,
        "flips": flips,
        "solved": solved(scenes),
        "attribution": attribution(table, scenes),
        "advice": advice_table(table, split),
        "held_out": cases,
        "held_out_summary": summary(cases),
    }

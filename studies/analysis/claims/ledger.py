"""The table of claims of a campaign: what each declaration of claims.toml comes to, from all tables of the campaign."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pandas as pd

from studies.analysis.claims import judges
from studies.analysis.claims.record import UNTESTED, Verdict, always, banded, counted
from studies.analysis.evidence import Evidence, NothingError, Tables, Value, read_declarations, read_values

FILE = Path(__file__).with_name("claims.toml")
CAMPAIGN = "footprint run standard"  # that makes the tables of experiments
COLUMNS = (
    *("claim", "subject", "sentence", "source", "regime", "status", "measured", "low", "high", "unit", "problems"),
    *("machine", "command"),
)


def read_claims() -> dict[str, dict[str, Any]]:
    """All declarations by name, each with its subject, its command, and what it shares with another one."""
    found: dict[str, dict[str, Any]] = {}
    for subject, claim in read_declarations(FILE):
        command = CAMPAIGN if "measured" in claim or "judge" in claim else ""
        found[claim["name"]] = {"machine": False, "command": command, **claim, "subject": subject}
    return found


def claims_table(store: Path, campaign: str) -> dict[str, pd.DataFrame]:
    """``claims`` with COLUMNS, a row a claim; its tables are written already."""
    evidence = Evidence(store, campaign)
    rows = []
    for name, claim in read_claims().items():
        if "judge" in claim:
            judge = getattr(judges, claim["judge"])
            given = evidence.given(judge)
            verdict = None if given is None else judge(**given)
        else:
            verdict = judged(claim, evidence.table)
        found = Verdict(UNTESTED, "", math.nan, math.nan, "", 0) if verdict is None else verdict
        measured = re.sub(r"(?<=[0-9])%", " %", found.measured)
        rows.append({**claim, "claim": name, **asdict(found), "measured": measured})
    return {"claims": pd.DataFrame(rows, columns=list(COLUMNS))}


def judged(claim: Mapping[str, Any], tables: Tables) -> Verdict | None:
    """What a declaration comes to; None where nothing tests it."""
    if "measured" not in claim:
        return None
    try:
        known = _numbers_of(claim["statement"], tables) if "statement" in claim else {}
        values = read_values(claim, tables, known)
    except NothingError:
        return None
    text, of = str(claim["measured"]).format(**values), int(values["of"])
    if "exceptions" in values:
        return always(int(values["exceptions"]), of, text)
    if "right" in values:
        return counted(int(values["right"]), of, text)
    low, high = (values[end] if isinstance(end, str) else end for end in claim["band"])
    interval = float(values["low"]), float(values["high"])
    return banded(interval, (float(low), float(high)), claim["unit"], text, of)


def _numbers_of(statement: str, tables: Tables) -> dict[str, Value]:
    """The numbers of a sentence of conclusion by their names; raises NothingError where it is not said."""
    table = tables("statement_values")
    own = pd.DataFrame() if table is None else table[table["statement"] == statement]
    if own.empty:
        raise NothingError(statement)
    return dict(zip(own["field"], own["number"].astype(float), strict=True))

"""The table of claims of a campaign, from all of its tables."""

from __future__ import annotations

import re
from pathlib import Path

import pandas as pd

from studies.analysis.claims import contact, elements, friction, measures, tyre
from studies.analysis.claims.record import COLUMNS, UNTESTED, Claim
from studies.analysis.statements.record import Evidence

CLAIMS: tuple[Claim, ...] = tuple(
    claim for subject in (measures, tyre, elements, contact, friction) for claim in subject.claim.made
)


def claims_table(store: Path, campaign: str) -> dict[str, pd.DataFrame]:
    """``claims`` with COLUMNS, a row a claim; its tables are written already."""
    evidence = Evidence(store, campaign)
    rows = []
    for claim in CLAIMS:
        given = evidence.given(claim.judge) if claim.judge else None
        verdict = claim.judge(**given) if claim.judge and given is not None else None
        row = {"claim": claim.name, **{name: getattr(claim, name) for name in COLUMNS if hasattr(claim, name)}}
        row |= {"status": UNTESTED, "measured": "", "unit": "", "problems": 0} if verdict is None else vars(verdict)
        row["measured"] = re.sub(r"(?<=[0-9])%", " %", row["measured"])
        rows.append(row)
    return {"claims": pd.DataFrame(rows, columns=list(COLUMNS))}

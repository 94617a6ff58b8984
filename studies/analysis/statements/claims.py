"""Sentences that are repeated in print and in manuals, each held against the tables of a campaign.

A claim of claims.toml is confirmed, qualified, refuted, or untested where a table is missing or nothing was counted. A
verdict rests on an interval, of one number with its uncertainty or of one number over many problems. Inside the band
that the claim allows it is confirmed, outside refuted, and else qualified: true of some, or not decided. Tables come in
as they are written; nothing may be solved here, and no claim may be judged by a number typed here.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import pandas as pd

from studies.analysis.evidence import Evidence, NothingError, Tables, Value, given_to, read_declarations, read_values
from studies.analysis.friction import public_answers
from studies.analysis.statements.record import Values
from studies.solving.refinement.richardson import holds_from

CONFIRMED, QUALIFIED, REFUTED, UNTESTED = "confirmed", "qualified", "refuted", "untested"
CLOSE = 0.002  # of a published value
WITHIN = 0.01  # error of the force
FILE = Path(__file__).with_name("claims.toml")
CAMPAIGN = "footprint run standard"  # that makes the tables of experiments
COLUMNS = (
    *("claim", "subject", "sentence", "source", "regime", "status", "measured", "low", "high", "unit", "problems"),
    *("machine", "command"),
)


@dataclass(frozen=True)
class Verdict:
    """What was measured: a sentence, the interval low to high of its number in a unit, and how many problems it is of.

    number: of a share, low = high.
    """

    status: str
    measured: str
    low: float
    high: float
    unit: str
    problems: int


def banded(
    interval: tuple[float, float], band: tuple[float, float], unit: str, measured: str, problems: int
) -> Verdict:
    """By where the interval lies to the band."""
    low, high = interval
    if band[0] <= low and high <= band[1]:
        status = CONFIRMED
    elif high < band[0] or low > band[1]:
        status = REFUTED
    else:
        status = QUALIFIED
    return Verdict(status, measured, low, high, unit, problems)


def counted(right: int, of: int, measured: str) -> Verdict:
    """Of a tendency: confirmed where it is true of all problems, refuted where of fewer than half."""
    status = CONFIRMED if right == of else QUALIFIED if 2 * right >= of else REFUTED
    return Verdict(status, measured, right / of, right / of, "share of problems", of)


def always(exceptions: int, of: int, measured: str) -> Verdict:
    """Of a law without exception, which one exception refutes."""
    return Verdict(REFUTED if exceptions else CONFIRMED, measured, exceptions / of, exceptions / of, "exceptions", of)


def read_claims() -> dict[str, dict[str, Any]]:
    """All declarations by name, each with its subject, its command, and what it shares with another one."""
    found: dict[str, dict[str, Any]] = {}
    for subject, claim in read_declarations(FILE):
        command = CAMPAIGN if "measured" in claim else ""
        found[claim["name"]] = {"machine": False, "command": command, **claim, "subject": subject}
    return found


def claims_table(store: Path, campaign: str) -> dict[str, pd.DataFrame]:
    """``claims`` with COLUMNS, a row a claim; its tables are written already."""
    evidence = Evidence(store, campaign)
    rows = []
    for name, claim in read_claims().items():
        verdict = judged(claim, evidence.table) or Verdict(UNTESTED, "", math.nan, math.nan, "", 0)
        measured = re.sub(r"(?<=[0-9])%", " %", verdict.measured)
        rows.append({**claim, "claim": name, **asdict(verdict), "measured": measured})
    return {"claims": pd.DataFrame(rows, columns=list(COLUMNS))}


def judged(claim: Mapping[str, Any], tables: Tables) -> Verdict | None:
    """What a declaration comes to; None where nothing tests it."""
    values = _values(claim, tables) if "measured" in claim else None
    if values is None or not values["of"]:
        return None
    text, of = str(claim["measured"]).format(**values), int(values["of"])
    if "exceptions" in values:
        return always(int(values["exceptions"]), of, text)
    if "right" in values:
        return counted(int(values["right"]), of, text)
    low, high = (values[end] if isinstance(end, str) else end for end in claim["band"])
    interval = float(values["low"]), float(values["high"])
    return banded(interval, (float(low), float(high)), claim["unit"], text, of)


def _values(claim: Mapping[str, Any], tables: Tables) -> Values | None:
    """Those that a claim declares, or that its judge finds; None where nothing bears them."""
    if "judge" in claim:
        judge = JUDGES[claim["judge"]]
        given = given_to(judge, tables)
        return None if given is None else judge(**given)
    try:
        known = _numbers_of(claim["statement"], tables) if "statement" in claim else {}
        return read_values(claim, tables, known)
    except NothingError:
        return None


def _numbers_of(statement: str, tables: Tables) -> dict[str, Value]:
    """The numbers of a sentence of conclusion by their names; raises NothingError where it is not said."""
    table = tables("statement_values")
    own = pd.DataFrame() if table is None else table[table["statement"] == statement]
    if own.empty:
        raise NothingError(statement)
    return dict(zip(own["field"], own["number"].astype(float), strict=True))


# --- judges: values that take more than numbers which are read off one table ------------------------------------------


def _published(errors: pd.DataFrame, ladders: pd.DataFrame, source: str, ladder: str = "") -> pd.DataFrame:
    """Limits beside published values, a row a quantity: of the default element, with a limit."""
    names = ladders[ladders["element"] == "refined"].drop_duplicates("sequence")
    found = errors[errors["kind"].isin(("read", "exact")) & errors["source"].str.contains(source, regex=False)]
    found = found.merge(names[["sequence", "ladder", "quantity"]], on="sequence")
    found = found[found["ladder"].eq(ladder)] if ladder else found[found["ladder"].notna()]
    found = found.dropna(subset=["model_part"])
    return found.drop_duplicates(["ladder", "quantity", "value"], keep="last")


def sze_tables(convergence_errors: pd.DataFrame, convergence: pd.DataFrame) -> Values:
    """How many of their values may be right, within what the limits are uncertain by?"""
    own = _published(convergence_errors, convergence, "Sze, Liu, Lo")
    size, known = own["model_part"].abs(), own["limit_uncertainty"]
    values: Values = {"right": int((size - known <= CLOSE).sum()), "of": len(own), "close": CLOSE, "most": size.max()}
    return values | {"ladder": own["ladder"].iloc[int(size.argmax())] if len(own) else ""}


def scordelis_lo(convergence_errors: pd.DataFrame, convergence: pd.DataFrame) -> Values:
    """The limit beside the usual target."""
    own = _published(convergence_errors, convergence, "", "scordelis-lo")
    last = own[own["value"] == 0.3024].iloc[-1:]
    off, known = last["model_part"].sum(), last["limit_uncertainty"].sum()
    return {"off": off, "known": known, "low": off - known, "high": off + known, "of": len(last)}


def pagano(convergence_errors: pd.DataFrame, convergence: pd.DataFrame) -> Values:
    """Deflection and stresses beside the exact plate."""
    off = _published(convergence_errors, convergence, "Pagano", "pagano-S10")["model_part"]
    return {"low": off.min(), "high": off.max(), "of": len(off)}


def _uniform_errors(work_precision: pd.DataFrame) -> list[float]:
    """Of the default element, coarse to fine."""
    own = work_precision[(work_precision["family"] == "uniform") & (work_precision["element"] == "refined")]
    return own.sort_values("unknowns")["error"].abs().to_list()


def one_grid(work_precision: pd.DataFrame) -> Values:
    """Is a grid that is within 1 % followed by one that is not?"""
    errors = _uniform_errors(work_precision)
    near = [error <= WITHIN for error in errors]
    return {"exceptions": sum(near[: holds_from(near)]), "of": sum(near), "within": WITHIN}


def finer_is_better(work_precision: pd.DataFrame) -> Values:
    """How often does the error grow?"""
    steps = list(pairwise(_uniform_errors(work_precision)))
    return {"exceptions": sum(after > before for before, after in steps), "of": len(steps)}


def refine_the_patch(work_precision: pd.DataFrame) -> Values | None:
    """Grids refined at the patch beside uniform ones of as many elements."""
    own = work_precision[work_precision["element"] == "refined"]
    wide = own.pivot_table(index="mesh", columns="family", values="error", aggfunc="first", sort=False).abs()
    if not {"patch", "uniform"} <= set(wide):
        return None
    pairs = wide[["patch", "uniform"]].dropna()
    return {"right": int((pairs["patch"] < pairs["uniform"]).sum()), "of": len(pairs)}


def one_step(friction_steps: pd.DataFrame) -> Values:
    """The errors of force and dissipation in the fewest load steps."""
    row = friction_steps.iloc[int(friction_steps["steps"].argmin())]
    force, lost = abs(float(row["friction_N_error"])), abs(float(row["dissipation_N_mm_error"]))
    return {"force": force, "lost": lost, "low": min(force, lost), "high": max(force, lost), "of": 1}


def public_friction(friction_public: pd.DataFrame) -> Values | None:
    """Of how many problems has the best algorithm an answer that the judge takes?"""
    _, counts = public_answers(friction_public)
    if counts.empty:
        return None
    of = friction_public.dropna(subset=["algorithm"])["problem"].nunique()
    return {"best": counts.index[0], "right": int(counts.iloc[0]), "of": of}


JUDGES: Mapping[str, Callable[..., Values | None]] = {
    judge.__name__: judge
    for judge in (
        *(sze_tables, scordelis_lo, pagano, one_grid, finer_is_better, refine_the_patch, one_step, public_friction),
    )
}

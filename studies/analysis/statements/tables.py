"""The tables of statements of a campaign: all sentences of sentences.toml, and the questions of questions.toml.

And a ledger of claims: sentences that are repeated in print and in manuals, each held against the tables of a campaign.

A claim of claims.toml is confirmed, qualified, refuted, or untested where a table is missing or nothing was counted. A
verdict rests on an interval, of one number with its uncertainty or of one number over many problems. Inside the band
that the claim allows it is confirmed, outside refuted, and else qualified: true of some, or not decided. Tables come in
as they are written; nothing may be solved here, and no claim may be judged by a number typed here.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from studies.analysis.evidence import Evidence, NothingError, Tables, Value, given_to, read_declarations, read_values
from studies.analysis.statements import choices, contact
from studies.analysis.statements.record import DEFAULTS, Statement, Values, as_tables, worded

SENTENCES, QUESTIONS = Path(__file__).with_name("sentences.toml"), Path(__file__).with_name("questions.toml")
Maker = Callable[..., Iterator[Values]]
MAKERS = {"choices": choices, "contact": contact}


def read_sentences() -> list[dict[str, Any]]:
    """All declarations of sentences, in the order of the file."""
    return [declaration for _, declaration in read_declarations(SENTENCES)]


def statements(store: Path, campaign: str) -> list[Statement]:
    """All that the tables of a campaign in its store allow to be said, in the order of the file."""
    evidence = Evidence(store, campaign)
    sentences = [each for declaration in read_sentences() for each in said_by(declaration, evidence.get)]
    names = [each.name for each in sentences]
    if len(set(names)) < len(names):
        twice = sorted({name for name in names if names.count(name) > 1})
        raise ValueError(f"said twice: {', '.join(twice)}")
    return sentences


def said_by(declaration: dict[str, Any], tables: Callable[[str], Any]) -> Iterator[Statement]:
    """What a declaration says, by values of its own or of its maker; nothing where its tables do not bear it."""
    if "maker" not in declaration:
        with suppress(NothingError):
            yield worded(declaration, read_values(declaration, tables, DEFAULTS))
        return
    maker = maker_of(declaration)
    if (given := given_to(maker, tables)) is not None:
        yield from (worded(declaration, values) for values in maker(**given))


def maker_of(declaration: dict[str, Any]) -> Maker:
    """The function that a declaration names."""
    module, _, name = declaration["maker"].partition(".")
    maker: Maker = getattr(MAKERS[module], name)
    return maker


def statement_tables(store: Path, campaign: str) -> dict[str, pd.DataFrame]:
    """``statements``, ``statement_values`` and ``asks``, of the tables that are written already."""
    sentences = statements(store, campaign)
    return {**as_tables(sentences), "asks": asks({each.name for each in sentences})}


def read_questions() -> list[dict[str, Any]]:
    """The questions of users."""
    return list(tomllib.loads(QUESTIONS.read_text(encoding="utf-8"))["ask"])


def asks(said: Collection[str]) -> pd.DataFrame:
    """A row a question; answers: the names of its statements that are in ``said``."""
    table = pd.DataFrame(read_questions())[["question", "threads", "answers", "command", "missing"]].fillna("")
    there = [", ".join(each for each in answers if each in said) for answers in table["answers"]]
    return table.assign(answers=there, answered=[bool(each) for each in there])


CONFIRMED, QUALIFIED, REFUTED, UNTESTED = "confirmed", "qualified", "refuted", "untested"
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
    claims: dict[str, dict[str, Any]] = {}
    for subject, claim in read_declarations(FILE):
        command = CAMPAIGN if "measured" in claim else ""
        claims[claim["name"]] = {"machine": False, "command": command, **claim, "subject": subject}
    return claims


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
    """Those that a claim declares; None where nothing bears them."""
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

"""What sentences rest on: the tables of a campaign, and numbers that are read off them by declarations of one line.

A declaration (a table of TOML) names its table and reads its ``values`` one after another::

    from = "tyre_budget"                        the table; its rows are those of ``where``, one each of ``once``
    columns.part = "change / within"            columns that are added to it
    where = 'changed == "linear"'               a query of pandas, or several, one after another
    cases = "count"                             rows
    off = "max abs(change)"                     an aggregate of an expression of columns
    mesh = "first change where part == 'mesh'"  over some of the rows; @name is a value that is known
    locks = "min ratio from shear_locking"      of another table, all of it
    share = "= off / locks"                     of values that are known
    level = 0.05                                as it stands
    told = {form = "{measure} {change:.1%}", sort = "-change", most = 6, join = "and", empty = "none"}
    told = {by = "measure", each."low#" = "min change", text = "{low#:.1%}", number = "mesh", join = "; "}

The last one reads values of each group of rows (without ``by``: of each row), numbered by a column or from 0, and puts
their texts in place of <told>: what not every campaign has is said in this way.

What has no row to rest on is not said: a missing table, rows of which none is left, an aggregate of nothing.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from inspect import signature
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pandas as pd

from studies.run.answers import Answers
from studies.solving.result import SOLVED

ANSWERS = "answers"  # the parameter of a function that reads solved cells, not a table
CONSTANTS = {"SOLVED": list(SOLVED)}  # that queries may name, after an @
Tables = Callable[[str], pd.DataFrame | None]
Value = float | str
VALUE = re.compile(r"(?P<take>\w+)(?: (?P<of>.+?))??(?: from (?P<table>\w+))?(?: where (?P<where>.+))?")
COUNTS: Mapping[str, Callable[[pd.Series], Any]] = {  # aggregates that nothing has, too
    "count": len,
    "sum": pd.Series.sum,
    "distinct": pd.Series.nunique,
    "words": lambda words: ", ".join(dict.fromkeys(map(str, words))),
    "names": lambda names: ", ".join(f"`{name}`" for name in dict.fromkeys(names)) or "none",
}
AGGREGATES: Mapping[str, Callable[[pd.Series], Any]] = {
    "first": lambda values: values.iloc[0],
    "name": lambda names: f"`{names.iloc[0]}`",
    "last": lambda values: values.iloc[-1],
    "min": pd.Series.min,
    "max": pd.Series.max,
    "median": pd.Series.median,
    "tenth": lambda values: values.quantile(0.1),
    "nine_tenths": lambda values: values.quantile(0.9),
}


class NothingError(Exception):
    """What a declaration asks for is not there."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """The tables of a campaign in the folder of a store, those of experiments among them, and its solved cells."""

    store: Path
    campaign: str

    @cached_property
    def answers(self) -> Answers:
        """The solved cells."""
        return Answers.of(self.store, self.campaign)

    @cached_property
    def _read(self) -> dict[str, pd.DataFrame | None]:
        return {}

    def table(self, name: str) -> pd.DataFrame | None:
        """A table that is of this campaign, or of none; None where it is missing or empty."""
        if name not in self._read:
            path = self.store / "tables" / f"{name}.csv"
            rows = pd.read_csv(path) if path.exists() and path.stat().st_size > 1 else pd.DataFrame()
            own = "campaign" not in rows or bool((rows["campaign"] == self.campaign).all())
            self._read[name] = rows if own and len(rows) else None
        return self._read[name]

    def get(self, name: str) -> Any:
        """A table, or the solved cells as ANSWERS."""
        return self.answers if name == ANSWERS else self.table(name)


def given_to(function: Callable[..., Any], tables: Callable[[str], Any]) -> dict[str, Any] | None:
    """What a function asks for: its parameters are the names of the tables it reads. None where one is missing."""
    arguments = {name: tables(name) for name in signature(function).parameters}
    return arguments if all(value is not None for value in arguments.values()) else None


def read_declarations(path: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    """The tables of each array of a TOML file with its name, each with what it shares with the one it is ``like``."""
    known: dict[str, dict[str, Any]] = {}
    for array, declarations in tomllib.loads(path.read_text(encoding="utf-8")).items():
        for declared in declarations:
            like = known[declared["like"]] if "like" in declared else {}
            whole = {**like, **declared, "values": {**like.get("values", {}), **declared.get("values", {})}}
            known[whole.get("name", "")] = whole
            yield array, whole


def read_values(
    declaration: Mapping[str, Any], tables: Tables, known: Mapping[str, Value] = MappingProxyType({})
) -> dict[str, Value]:
    """The values of a declaration, after those that are known and the number of its rows, which is ``_rows``.

    Raises NothingError where there is nothing to say.
    """
    rows = _rows(declaration, pd.DataFrame(), tables, known)
    values: dict[str, Value] = {**known, "_rows": len(rows)}
    if rows.empty and "from" in declaration:
        raise NothingError(f"no row of {declaration['from']}")
    for name, declared in declaration["values"].items():
        if isinstance(declared, Mapping) and "each" in declared:
            values |= _numbered(name, declared, rows, tables, values)
        else:
            values[name] = _value(declared, rows, tables, values)
    if "need" in declaration and not evaluated(declaration["need"], values):
        raise NothingError(declaration["need"])
    return values


def _rows(
    declaration: Mapping[str, Any], rows: pd.DataFrame, tables: Tables, values: Mapping[str, Value]
) -> pd.DataFrame:
    """The rows that a declaration is of, or of these those that it asks for."""
    if "from" in declaration:
        table = tables(declaration["from"])
        if table is None:
            raise NothingError(f"no table {declaration['from']}")
        rows = table
    for name, expression in declaration.get("columns", {}).items():
        rows = rows.assign(**{name: _column(rows, expression)})
    queries = declaration.get("where") or ()
    for query in [queries] if isinstance(queries, str) else queries:
        rows = rows.query(query, engine="python", local_dict={**CONSTANTS, **values})
    if "sort" in declaration:
        rows = rows.iloc[np.argsort(np.asarray(_column(rows, declaration["sort"])), kind="stable")]
    return rows.drop_duplicates(declaration["once"]) if "once" in declaration else rows


def _value(declared: Any, rows: pd.DataFrame, tables: Tables, values: Mapping[str, Value]) -> Value:
    if isinstance(declared, Mapping):
        return _formed(declared, _rows(declared, rows, tables, values))
    if not isinstance(declared, str):
        return float(declared)
    if declared.startswith("= "):
        return evaluated(declared[2:], values)
    match = VALUE.fullmatch(declared)
    assert match is not None, declared
    asked = {"where": match["where"], **({"from": match["table"]} if match["table"] else {})}
    rows = _rows(asked, rows, tables, values)
    take = COUNTS.get(match["take"])
    if take is None:
        take = AGGREGATES[match["take"]]
        if rows.empty:
            raise NothingError(declared)
    taken: Any = _column(rows, match["of"]) if match["of"] else rows
    return take(taken)


def _column(rows: pd.DataFrame, expression: str) -> Any:
    """A column by its name, which costs nothing, or what is made of columns."""
    if expression in rows:
        return rows[expression]
    return rows.eval(expression, engine="python", local_dict=CONSTANTS)


def evaluated(expression: str, values: Mapping[str, Value]) -> Any:
    """An expression of values that are known."""
    return pd.eval(expression, engine="python", local_dict=dict(values))


def _formed(declared: Mapping[str, Any], rows: pd.DataFrame) -> str:
    """A form filled from each row."""
    records = ({str(name): value for name, value in row.items()} for row in rows.to_dict("records"))
    return _joined([declared["form"].format(**record) for record in records], declared)


def _numbered(
    name: str, declared: Mapping[str, Any], rows: pd.DataFrame, tables: Tables, values: Mapping[str, Value]
) -> dict[str, Value]:
    """The values of each row, or of each group of rows, and under _name their texts, joined."""
    rows = _rows(declared, rows, tables, values)
    groups = rows.groupby(declared["by"] if "by" in declared else np.arange(len(rows)), sort=False)
    declared_values: dict[str, Value] = {}
    texts = []
    for n, (_, own) in enumerate(groups):
        number = own[declared["number"]].iloc[0] if "number" in declared else n
        number = number if isinstance(number, str) else f"{number:g}"
        declared_values |= {
            key.replace("#", number): _value(each, own, tables, values) for key, each in declared["each"].items()
        }
        texts.append(declared["text"].replace("#", number))
    return {**declared_values, f"_{name}": _joined(texts, declared)}


def _joined(words: list[str], declared: Mapping[str, Any]) -> str:
    """Words that differ, as many as are asked for; by "and": as a list in words."""
    words, join = list(dict.fromkeys(words))[: declared.get("most")], declared.get("join", ", ")
    return (listed(words) if join == "and" else join.join(words)) or declared.get("empty", "")


def listed(words: Sequence[str]) -> str:
    """Words in a list."""
    return " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))

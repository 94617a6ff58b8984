"""The tables of limits on the page of extremes: how far each measure and each algorithm goes, and how right it is."""

from __future__ import annotations

import pandas as pd

from reports.chapters.limits.causes import cause
from reports.formats import code, formatted, share
from reports.markdown import Part, commands, fold, joined, listing, machine, prose, table
from reports.store.tables import Store

HOW = """## Limits

Each limit is the last value of a setting, on the way from an ordinary one to a bound, at which a solve converges, is
certified by the judge and is stable. The way goes in six equal steps of the logarithm up to the first failure; between
it and the last success it is halved until the two are at most a factor of 1.26 (a tenth of a decade) apart. Where
nothing fails, the bound is all that is known, and a + stands behind it. The error is relative, of the result and not of
a residual. It is taken from what stands above each table of the fold: where that is a closed form it counts the mesh
and the assumptions of a measure, too, so that the error at the ordinary value, *at first*, stands beside it there.
*Right to* is the last value on the way up to which the error stays within 1 %. Measures are solved by `semismooth`
(`regularised` for ε), algorithms with `exact`. A rotation is made in one step that is not cut; all other steps may be
cut as in any solve."""
HEADS = "of | name | last certified | error there | error at first | right to | fails at"
LINE = "{part} | {name:code} | {value} | {error:off} | {error_ordinary:off} | {right:.3g} | {fails:.3g}"


def limit_tables(store: Store) -> Part:
    """All limits at a glance, then one table for each kind."""
    limits = store.table("extremes_limits")
    parts = [_table(str(name), own) for name, own in limits.groupby("limit", sort=False)]
    glances = [_glance(str(part), own) for part, own in limits.groupby("part", sort=False)]
    glance = machine(*filter(None, (*glances, _false(limits))))
    full = fold("Each limit in full, with where it fails and why", *parts, commands(limits["command"].astype(str)))
    return joined(prose(HOW), glance, full)


def _glance(part: str, own: pd.DataFrame) -> str:
    """How far each goes and the error there: a line a limit and a column an algorithm, or a line a measure."""
    cells = {
        (row["limit"], row["name"]): f"{_number(row['value'])}{' +' if row['bound'] else ''} ({_off(row['error'])})"
        for _, row in own.iterrows()
    }
    names, limits = (
        list(dict.fromkeys(own["name"])),
        own.drop_duplicates("limit")[["limit", "symbol"]].to_numpy().tolist(),
    )
    title = f"How far each {part} goes: last certified value (error there)"
    if part == "measure":
        header = [part, *(f"{limit}, {symbol}" for limit, symbol in limits)]
        measured = [[code(name), *(cells[limit, name] for limit, _ in limits)] for name in names]
        return table(title, header, measured, words=len(header))
    rows = [[f"{limit}, {symbol}", *(cells[limit, name] for name in names)] for limit, symbol in limits]
    return table(title, ["limit", *map(code, names)], rows, words=1 + len(names))


def _table(name: str, own: pd.DataFrame) -> Part:
    parts = own.groupby("part", sort=False)
    ways = "; ".join(f"{part}s from {_way(rows)}, errors against: {rows['reference'].iloc[0]}" for part, rows in parts)
    head = prose(f"### {name[0].upper()}{name[1:]}\n\n{own['symbol'].iloc[0]}: {ways}.")
    last = [f"{_number(row['value'])}{' (bound)' if row['bound'] else ''}" for _, row in own.iterrows()]
    figures = listing(name, own.assign(value=last), HEADS, LINE, words=2, off=_off)
    beyond = own[~own["bound"].astype(bool)]
    causes = beyond.groupby([beyond["kind"], beyond["reason"].map(cause)], sort=False)["name"]
    told = [f"- *{kind}* where {_names(names)} fails: {why}." for (kind, why), names in causes]
    return joined(head, machine(figures, *(["\n".join(told)] if told else [])))


def _names(names: pd.Series) -> str:
    return ", ".join(map(code, names))


def _number(value: float) -> str:
    return formatted(value, ".3g")


def _way(rows: pd.DataFrame) -> str:
    return f"{_number(rows['ordinary'].iloc[0])} to {_number(rows['searched_to'].iloc[0])}"


def _off(error: float) -> str:
    """In per cent, by powers of ten where that is small."""
    return f"{100 * error:.0e} %" if 0 < error < 1e-4 else share(error, 2)


def _false(limits: pd.DataFrame) -> str:
    """Certified and yet far from right, at an end of a way that begins right."""
    false = limits[(limits["error"] > 0.5) & (limits["error_ordinary"] < 0.01)]
    if false.empty:
        return ""
    names = "; ".join(f"{name} ({_names(own['name'])})" for name, own in false.groupby("limit", sort=False))
    return f"Certified there and half of the result off or more, though right at first: {names}."

"""Part of the page of algorithms: do all of them give the same contact set and force, whatever the case?"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

from reports.chapters.tyre.cells import change, sets_unlike
from reports.formats import NOTHING, code, fixed, scientific
from reports.markdown import Part, commands, joined, listing, machine, prose, table
from reports.store.cells import Cell
from reports.store.reading import StoreError
from reports.store.tables import Store

SAME = 1e-7  # relative difference of forces below which two algorithms agree
STUDY = {"scene": "tyre", "model": "half", "delta_mm": (5, 10, 15, 20)}
REFUSAL = " does not apply: "  # before its reason


@dataclass(frozen=True, eq=False)
class Entry:
    """One algorithm on one case, beside the reference of that case."""

    cell: Cell
    reference: Cell
    own: tuple[str, ...]  # what of its settings, other than epsilon, is not its default

    @property
    def case(self) -> tuple[str, str]:
        """Load and section."""
        return str(self.cell.settings["load"]), str(self.cell.settings["section"])

    @property
    def exact(self) -> bool:
        """Was the contact condition itself asked for, and not its regularisation?"""
        return bool(self.cell.settings["epsilon"] == "inf")

    @property
    def way(self) -> str:
        """The algorithm with what distinguishes it from its defaults, for a table."""
        return ", ".join([code(self.cell.result["contact"]), *self.own])

    @property
    def travels(self) -> list[float]:
        """Those of the reference [mm]."""
        return [float(step["delta_mm"]) for step in self.reference.steps]

    @cached_property
    def difference(self) -> float:
        """The largest of the forces over all travels, relative to the reference; NaN when a travel is missing."""
        found = [abs(change(self.cell, self.reference, delta=delta)) for delta in self.travels]
        return math.nan if any(map(math.isnan, found)) else max(found, default=math.nan)

    @cached_property
    def nodes_unlike(self) -> int | None:
        """In contact in only one of both sets, the most over all travels; None when a travel is missing."""
        known = [n for n in sets_unlike(self.cell, self.reference, self.travels) if n is not None]
        return max(known) if known and len(known) == len(self.travels) else None

    @property
    def penetration(self) -> float:
        """The largest of all travels [mm]."""
        return max((float(step["kkt"]["penetration"]) for step in self.cell.steps), default=math.nan)

    @property
    def agrees(self) -> bool:
        """Same contact set and same force at every travel?"""
        return self.nodes_unlike == 0 and self.difference <= SAME


def unusual(cell: Cell, usual: Cell) -> tuple[str, ...]:
    """The settings of a cell, other than epsilon, that another one has otherwise: "settle 1"."""
    own = {key: value for key, value in cell.settings.items() if usual.settings.get(key) != value}
    own.pop("epsilon", None)
    return tuple(f"{key} {value:g}" if isinstance(value, float) else f"{key} {value}" for key, value in own.items())


def entries(store: Store) -> Iterator[Entry]:
    """Every cell of the study, in the order of the campaign; raises StoreError when a reference is missing.

    The first cell of an algorithm on a case is that with its defaults.
    """
    for cell in store.select(**STUDY):
        case = {key: cell.settings[key] for key in ("load", "section")}
        usual = store.select(**STUDY, **case, contact=cell.result["contact"])[0]
        references = store.select(**STUDY, **case, contact="semismooth", epsilon=math.inf)
        if not references:
            raise StoreError(f"{store.path}: no reference by semismooth with the exact condition for {case}")
        yield Entry(cell, references[0], unusual(cell, usual))


def agreement_part(store: Store) -> Part:
    """The pressed tyre by every algorithm, a line each, and problems of the campaign with several answers."""
    found = list(entries(store))
    put = [entry for entry in found if entry.exact and entry.cell is not entry.reference]
    solved = [entry for entry in put if not entry.cell.unsupported]
    cases = len({entry.case for entry in found})
    text = prose(f"""## Do they agree?

The paper's tyre, mesh {found[0].reference.result["mesh"]}, pressed by {max(found[0].travels, default=0):g} mm in
{len(found[0].travels)} travels: {cases} cases, a dead and a follower pressure with a symmetric and the paper's
non-symmetric section. `semismooth` with exact contact is the reference. Two solves agree when every node is in contact
in both or in neither and forces differ by at most {scientific(SAME, 0)} of their value, at every travel:
{sum(entry.agrees for entry in solved)} of {len(solved)} do, and {len(put) - len(solved)} requests were refused.
{_finite(found)}""")
    ways = dict.fromkeys(entry.way for entry in put)
    heads = ["algorithm", "cases", "agree", "force differs by at most", "nodes in one set only", "refused"]
    rows = [_row(way, [entry for entry in put if entry.way == way]) for way in ways]
    made = machine(table("Against the reference, exact contact", heads, rows))  # the differences are rounding
    told = commands(entry.cell.command for entry in found if not entry.own and entry.case == found[0].case)
    return joined(text, made, _refused(put), _odd(solved), told, _answers(store))


def _row(way: str, own: list[Entry]) -> list[object]:
    solved = [entry for entry in own if not entry.cell.unsupported]
    reached = [entry for entry in solved if entry.nodes_unlike is not None]
    off = scientific(max((entry.difference for entry in reached), default=math.nan))
    nodes = fixed(max((float(entry.nodes_unlike or 0) for entry in reached), default=math.nan))
    agree = f"{sum(entry.agrees for entry in solved)} of {len(solved)}" if solved else NOTHING
    return [way, len(own), agree, off, nodes, len(own) - len(solved) or NOTHING]


def _refused(put: list[Entry]) -> str:
    """Who refuses what, the first reason of each."""
    ways: dict[str, list[Entry]] = {}
    for entry in put:
        if entry.cell.unsupported:
            ways.setdefault(str(entry.cell.result["contact"]), []).append(entry)
    told = [f"- {code(name)} refuses {len(own)}: {_reason(own)}." for name, own in ways.items()]
    return "\n".join(["Refused, with the first reason of each:", "", *told]) if told else "No request is refused."


def _reason(own: Iterable[Entry]) -> str:
    reason = next(iter(own)).cell.reason
    return reason.partition(REFUSAL)[2] or reason


def _odd(solved: list[Entry]) -> str:
    """Who does not agree, and why."""
    odd = [entry for entry in solved if not entry.agrees]
    heads, line = (
        "algorithm | load | section | outcome | reason",
        "{way} | {case[0]} | {case[1]} | {cell.result[outcome]} | {cell.reason}",
    )
    return listing("Solves that do not agree", odd, heads, line, words=5) if odd else ""


def _finite(found: list[Entry]) -> str:
    """What a finite epsilon, the default of some algorithms, changes."""
    soft = [entry for entry in found if not entry.exact and not entry.cell.unsupported]
    if not soft:
        return ""
    stiffness = ", ".join(dict.fromkeys(f"{entry.cell.settings['epsilon']:g}" for entry in soft))
    off = max((entry.difference for entry in soft if entry.nodes_unlike is not None), default=math.nan)
    depth = max(entry.penetration for entry in soft)
    return f"""A finite ε of {stiffness} MPa/mm is another problem: {len(soft)} solves differ by at most
{scientific(off)} in the force and penetrate by at most {scientific(depth)} mm."""


def _answers(store: Store) -> Part:
    """Problems of the whole campaign to which it has more than one certified answer."""
    if not store.has_analysis("disagreements"):
        return Part("")
    found = store.analysis("disagreements")
    text = prose(f"""Agreement is no law: a problem may have several equilibria. Over all cells of the campaign that ask
the same problem, solved to the default tolerance, {len(found)} answers differ from that of most cells by more than the
certificates leave. The table `disagreements` has each with its commands.""")
    rows = [
        [why, len(own), ", ".join(map(code, dict.fromkeys(own["scene"]))), scientific(own["difference"].max())]
        for why, own in found.groupby("why", sort=False)
    ]
    heads = ["why", "answers", "scenes", "differ by at most"]
    return joined(text, table("Further answers to the same problem", heads, rows) if rows else "")

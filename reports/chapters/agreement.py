"""Part of the page of algorithms: do all of them give the same contact set and force, whatever the case?"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from reports.cells import Cell
from reports.figures.tyre import at_delta, different_nodes
from reports.formats import code
from reports.markdown import Part, Template, commands
from reports.reading import StoreError
from reports.store import Store

TEXT = Template("algorithms")
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
        forces = [[each.value("force_N", delta_mm=delta) for delta in self.travels] for each in self._both]
        found = [abs(own / other - 1.0) for own, other in zip(*forces, strict=True)]
        return math.nan if any(map(math.isnan, found)) else max(found, default=math.nan)

    @cached_property
    def nodes_unlike(self) -> int | None:
        """In contact in only one of both sets, the most over all travels; None when a travel is missing."""
        reached = [each.find_step(delta_mm=delta) for each in self._both for delta in self.travels]
        if not reached or None in reached:
            return None
        own, other = (each.table("contact") for each in self._both)
        unlike = [different_nodes(at_delta(own, delta), at_delta(other, delta)) for delta in self.travels]
        known = [count for count in unlike if count is not None]
        return max(known) if len(known) == len(unlike) else None

    @property
    def _both(self) -> tuple[Cell, Cell]:
        return self.cell, self.reference

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
    first = found[0]
    told = {
        "mesh": first.reference.result["mesh"],
        "travel": max(first.travels, default=0),
        "travels": len(first.travels),
        "cases": len({entry.case for entry in found}),
        "same": SAME,
        "agree": sum(entry.agrees for entry in solved),
        "solved": len(solved),
        "refused": len(put) - len(solved),
        "commands": commands(entry.cell.command for entry in found if not entry.own and entry.case == first.case),
    }
    rows = {
        "ways": [_row(way, [entry for entry in put if entry.way == way]) for way in dict.fromkeys(e.way for e in put)],
        "odd": [entry for entry in solved if not entry.agrees],
    }
    return TEXT("agreement", **told, **rows, finite=_finite(found), refusals=_refused(put), answers=_answers(store))


def _row(way: str, own: list[Entry]) -> dict[str, Any]:
    solved = [entry for entry in own if not entry.cell.unsupported]
    reached = [entry for entry in solved if entry.nodes_unlike is not None]
    agree = f"{sum(entry.agrees for entry in solved)} of {len(solved)}" if solved else ""
    off = max((entry.difference for entry in reached), default=math.nan)
    nodes = max((float(entry.nodes_unlike or 0) for entry in reached), default=math.nan)
    counts = {"cases": len(own), "refused": len(own) - len(solved)}
    return {"way": way, "agree": agree, "off": off, "nodes": nodes, **counts}


def _refused(put: list[Entry]) -> Part:
    """Who refuses what, the first reason of each."""
    ways: dict[str, list[Entry]] = {}
    for entry in put:
        if entry.cell.unsupported:
            ways.setdefault(str(entry.cell.result["contact"]), []).append(entry)
    rows = []
    for name, own in ways.items():
        reason = own[0].cell.reason
        rows.append({"name": name, "count": len(own), "reason": reason.partition(REFUSAL)[2] or reason})
    return TEXT("refusals", rows=rows) if rows else Part("No request is refused.")


def _finite(found: list[Entry]) -> Part:
    """What a finite epsilon, the default of some algorithms, changes."""
    soft = [entry for entry in found if not entry.exact and not entry.cell.unsupported]
    if not soft:
        return Part()
    stiffness = ", ".join(dict.fromkeys(f"{entry.cell.settings['epsilon']:g}" for entry in soft))
    off = max((entry.difference for entry in soft if entry.nodes_unlike is not None), default=math.nan)
    depth = max(entry.penetration for entry in soft)
    return TEXT("finite", stiffness=stiffness, count=len(soft), off=off, depth=depth)


def _answers(store: Store) -> Part:
    """Problems of the whole campaign to which it has more than one certified answer."""
    if not store.has("disagreements"):
        return Part()
    found = store.table("disagreements")
    rows = [
        {"why": why, "answers": len(own), "scenes": dict.fromkeys(own["scene"]), "difference": own["difference"].max()}
        for why, own in found.groupby("why", sort=False)
    ]
    return TEXT("answers", count=len(found), rows=rows)

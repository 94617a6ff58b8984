"""The tyre by every algorithm under every load and section: the cells of the study, and what they are compared with."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from reports.chapters.tyre.cells import change, sets_unlike
from reports.formats import code
from reports.markdown import listing
from reports.store.cells import Cell
from reports.store.reading import StoreError
from reports.store.tables import Store

SAME = 1e-7  # relative difference of forces below which two algorithms agree

STUDY = {"scene": "tyre", "model": "half", "delta_mm": (5, 10, 15, 20)}


@dataclass(frozen=True, eq=False)
class Entry:
    """One algorithm on one case, beside the reference of that case."""

    cell: Cell
    reference: Cell
    own: tuple[str, ...]  # what of its settings, other than epsilon, is not its default

    @property
    def contact(self) -> str:
        """Name of the algorithm."""
        return str(self.cell.result["contact"])

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
        finite = () if self.exact else (f"ε = {self.cell.settings['epsilon']:g}",)
        return ", ".join([code(self.contact), *self.own, *finite])

    @property
    def travels(self) -> list[float]:
        """Those of the reference [mm]."""
        return [float(step["delta_mm"]) for step in self.reference.steps]

    @property
    def differences(self) -> list[float]:
        """Of the forces at each travel, relative to the reference; NaN where one of both did not get there."""
        return [abs(change(self.cell, self.reference, delta=delta)) for delta in self.travels]

    @cached_property
    def unlike(self) -> list[int | None]:
        """Contact nodes in only one of both sets at each travel; None where one did not get there."""
        return sets_unlike(self.cell, self.reference, self.travels)

    @property
    def largest_difference(self) -> float:
        """Of the forces over all travels; NaN when a travel is missing, or there is none."""
        found = self.differences
        return float("nan") if any(map(math.isnan, found)) else max(found, default=float("nan"))

    @property
    def most_nodes_unlike(self) -> int | None:
        """Over all travels; None when one is missing, or there is none."""
        known = [n for n in self.unlike if n is not None]
        return max(known) if known and len(known) == len(self.travels) else None

    @property
    def penetration(self) -> float | None:
        """The largest of all travels [mm]."""
        return max((step["kkt"]["penetration"] for step in self.cell.steps), default=None)

    @property
    def agrees(self) -> bool:
        """Same contact set and same force at every travel?"""
        return self.most_nodes_unlike == 0 and self.largest_difference <= SAME


CASE, OF_CASE = "algorithm | load | section", "{way} | {case[0]} | {case[1]}"  # heads and line of an entry


def refusals(refused: list[Entry]) -> str:
    """What an algorithm does not do, and why."""
    return listing("Refused", refused, f"{CASE} | reason", f"{OF_CASE} | {{cell.reason}}", words=4)


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

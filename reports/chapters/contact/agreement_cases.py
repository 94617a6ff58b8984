"""The tyre by every algorithm under every load and section: the cells of the study, and what they are compared with."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from reports import labels
from reports.maps import at_delta, different_nodes
from reports.tables import Cell, Store

SAME = 1e-7  # relative difference of forces below which two algorithms agree


@dataclass(frozen=True, eq=False)
class Entry:
    """One algorithm on one case, beside the reference of that case."""

    cell: Cell
    reference: Cell

    @property
    def contact(self) -> str:
        """Name of the algorithm."""
        return str(self.cell.result["contact"])

    @property
    def case(self) -> tuple[str, str]:
        """Load and section."""
        settings = self.cell.result["settings"]
        return str(settings["load"]), str(settings["section"])

    @property
    def exact(self) -> bool:
        """Was the contact condition itself asked for, and not its regularisation?"""
        return bool(self.cell.result["settings"]["epsilon"] == "inf")

    @property
    def way(self) -> str:
        """The algorithm with what distinguishes it from its defaults, for a table."""
        name, comma, setting = self._words.partition(",")
        finite = "" if self.exact else f", ε = {self.cell.result['settings']['epsilon']:g}"
        return f"`{name}`{comma}{setting}{finite}"

    @property
    def as_it_is(self) -> bool:
        """Has the algorithm its own settings, but for epsilon?"""
        return self._words == self.contact

    @property
    def _words(self) -> str:
        return self.cell.label.removeprefix("agreement ").rsplit(" ", 3)[0]

    @property
    def travels(self) -> list[float]:
        """Those of the reference [mm]."""
        return [float(step["delta_mm"]) for step in self.reference.steps]

    def force_difference(self, delta: float) -> float:
        """Relative to the reference; NaN when one of both did not get there."""
        return self.cell.value("force_N", delta_mm=delta) / self.reference.value("force_N", delta_mm=delta) - 1.0

    def nodes_unlike(self, delta: float) -> int | None:
        """Contact nodes in only one of both sets; None when one did not get there."""
        if self.cell.find_step(delta_mm=delta) is None or self.reference.find_step(delta_mm=delta) is None:
            return None
        return different_nodes(*(at_delta(cell.table("contact"), delta) for cell in (self.cell, self.reference)))

    @property
    def largest_difference(self) -> float:
        """Of the forces over all travels; NaN when a travel is missing, or there is none."""
        found = [abs(self.force_difference(delta)) for delta in self.travels]
        return float("nan") if not found or any(map(math.isnan, found)) else max(found)

    @property
    def most_nodes_unlike(self) -> int | None:
        """Over all travels; None when one is missing, or there is none."""
        found = [self.nodes_unlike(delta) for delta in self.travels]
        known = [n for n in found if n is not None]
        return max(known) if known and len(known) == len(found) else None

    @property
    def agrees(self) -> bool:
        """Same contact set and same force at every travel?"""
        return self.most_nodes_unlike == 0 and self.largest_difference <= SAME


def entries(store: Store) -> Iterator[Entry]:
    """Every cell of the study, in the order of the campaign; raises StoreError when a reference is missing."""
    for cell in store.matching(labels.AGREEMENT):
        settings = cell.result["settings"]
        wanted = labels.AGREEMENT_REFERENCE.format(load=settings["load"], section=settings["section"])
        yield Entry(cell, store.cell(wanted))

"""The tyre by every algorithm under every load and section: the cells of the study, and what they are compared with."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from reports.maps import at_delta, different_nodes
from reports.tables import Cell, Store, StoreError

SAME = 1e-7  # relative difference of forces below which two algorithms agree

STUDY = {"scene": "tyre", "model": "half", "delta_mm": (5, 10, 15, 20)}


@dataclass(frozen=True, eq=False)
class Entry:
    """One algorithm on one case, beside the reference of that case."""

    cell: Cell
    reference: Cell
    own: tuple[str, ...]  # what of its settings is not its default

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
        finite = () if self.exact else (f"ε = {self.cell.result['settings']['epsilon']:g}",)
        return ", ".join([f"`{self.contact}`", *self.own, *finite])

    @property
    def as_it_is(self) -> bool:
        """Has the algorithm its own settings, but for epsilon?"""
        return not self.own

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


def unusual(cell: Cell, usual: Cell) -> tuple[str, ...]:
    """The settings of a cell, other than epsilon, that another one has otherwise: "settle 1"."""
    there = usual.result["settings"]
    own = (
        (key, value) for key, value in cell.result["settings"].items() if key != "epsilon" and there.get(key) != value
    )
    return tuple(f"{key} {value:g}" if isinstance(value, float) else f"{key} {value}" for key, value in own)


def entries(store: Store) -> Iterator[Entry]:
    """Every cell of the study, in the order of the campaign; raises StoreError when a reference is missing.

    The first cell of an algorithm on a case is that with its defaults.
    """
    for cell in store.select(**STUDY):
        case = {key: cell.result["settings"][key] for key in ("load", "section")}
        usual = store.select(**STUDY, **case, contact=cell.result["contact"])[0]
        references = store.select(**STUDY, **case, contact="semismooth", epsilon=math.inf)
        if not references:
            raise StoreError(f"{store.path}: no reference by semismooth with the exact condition for {case}")
        yield Entry(cell, references[0], unusual(cell, usual))

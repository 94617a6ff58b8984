"""Ladders read from a store: a quantity of a scene on its meshes, with its orders and the references that apply."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from reports import labels
from reports.orders import MeshSequence
from reports.tables import Cell, Store

STEP_KEYS = ("load_fraction", "delta_mm")  # what grows along a path; all else that a reference names is a setting


@dataclass(frozen=True, eq=False)
class Rung:
    """One quantity of one ladder; ``at``: the step it is read at, empty for the last one."""

    ladder: str
    family: str
    quantity: str
    meshes: tuple[str, ...]
    cells: tuple[Cell, ...]
    at: Mapping[str, float]
    references: tuple[Mapping[str, Any], ...]

    @property
    def sequence(self) -> MeshSequence:
        """Values over the sizes 1/n1, NaN where a mesh was not solved."""
        sizes = tuple(1 / int(mesh.split("x")[0]) for mesh in self.meshes)
        return MeshSequence(sizes, tuple(_value(cell, self.quantity, self.at) for cell in self.cells))


def read_ladders(store: Store, element: str = labels.LADDER_ELEMENT, *, finest: bool = True) -> list[Rung]:
    """Every quantity of every ladder, without its ``finest`` mesh if so asked; raises StoreError for a missing cell."""
    table = store.table("ladders")
    found = []
    for (ladder, quantity), rows in table.fillna({"at": ""}).groupby(["ladder", "quantity"], sort=False):
        first, meshes = rows.iloc[0], tuple(rows["mesh"])[: None if finest else -1]
        cells = tuple(
            store.cell(labels.CONVERGENCE.format(ladder=ladder, mesh=mesh, element=element)) for mesh in meshes
        )
        key, _, value = str(first["at"]).partition("=")
        at = {key: float(value)} if key else {}
        known = [row for row in store.references if row["scene"] == first["scene"] and row["quantity"] == quantity]
        # no error is relative to zero
        apply = tuple(row for row in known if float(row["value"]) != 0 and applies(row["at"], cells[-1], at))
        found.append(Rung(str(ladder), first["family"], str(quantity), meshes, cells, at, apply))
    return found


def families(rungs: list[Rung]) -> Iterator[tuple[str, list[Rung]]]:
    """The rungs by the picture they are in."""
    for family in dict.fromkeys(rung.family for rung in rungs):
        yield family, [rung for rung in rungs if rung.family == family]


def _value(cell: Cell, quantity: str, at: Mapping[str, float]) -> float:
    """At a step, or what the whole path has left in the result; NaN when the path did not get to its end."""
    if at:
        return cell.value(quantity, **at)
    return float(cell.result["quantities"].get(quantity, "nan")) if cell.converged else float("nan")


def applies(where: Mapping[str, float | str], cell: Cell, at: Mapping[str, float]) -> bool:
    """Does a reference hold for what was solved? Every key it names must have its value there."""
    there = {**cell.result["settings"], "measure": cell.result["measure"]}
    last = cell.steps[-1] if cell.steps else {}
    there |= {key: at.get(key, last.get(key)) for key in STEP_KEYS}
    return all(there.get(key) == value for key, value in where.items())

"""Section of the tyre page: every error of the force at 20 mm, those of the mesh beside those of the model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from reports.chapters.tyre.cells import DELTA
from reports.formats import NOTHING, code, formatted
from reports.markdown import Part
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("tyre")
WORDS = {
    "follower": "pressure that follows the inner face, over dead pressure on the mid-surface",
    "full-3d": "full three-dimensional law (`full-3d`), over constant S33",
    "nonsymmetric": "`nonsymmetric`, over constant S33",
}


def budget_part(store: Store) -> Part:
    """The whole section."""
    found = store.analysis("tyre_budget").to_dict("records")
    early = {row["changed"]: row for row in found if row["delta_mm"] != DELTA}
    rows = [{**row, "early": _change(early.get(row["changed"]))} for row in _at_delta(found)]
    other = next((f"{row['delta_mm']:g}" for row in early.values()), "")
    return TEXT("budget", delta=DELTA, other=other, rows=rows)


def model_table(store: Store) -> Part:
    """The same of the mesh, the load, the section and the shell; nothing where the campaign does not have them."""
    found = _at_delta(store.rows("tyre_budget").to_dict("records"))
    return TEXT("model", delta=DELTA, rows=[row for row in found if row["part"] != "measure"])


def _at_delta(found: list[dict[Any, Any]]) -> list[dict[Any, Any]]:
    """The rows of the last travel, with words for what is changed and by how much that changes the force."""
    return [{**row, "name": _name(row), "now": _change(row)} for row in found if row["delta_mm"] == DELTA]


def _name(row: Mapping[Any, Any]) -> str:
    return code(row["changed"]) if row["part"] == "measure" else WORDS.get(row["changed"], row["changed"])


def _change(row: Mapping[Any, Any] | None) -> str:
    """A change with its interval."""
    if row is None:
        return NOTHING
    if row["change"] == 0.0:
        return f"± {formatted(row['within'], '.1%')}"
    told = f"{formatted(row['change'], '+.1%')} ± {formatted(row['within'], '.1%')}"
    return told if str(row["settled"]) == "True" else f"{told}, not settled"

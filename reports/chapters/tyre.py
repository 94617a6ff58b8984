"""The page of the tyre: its load and patch, what its force is worth, and what the paper's printed table can mean."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd

from reports.chapter import chapter
from reports.figures.tyre import Developed, at_delta, pressure_map, pressures_of
from reports.formats import NOTHING, code, fixed, formatted
from reports.markdown import Part, Template, commands, filled
from reports.store import Cell, Store

TEXT = Template("tyre")
PRINTED_DIGIT = 0.001  # MPa, one unit of its last digit
HALF, LITERAL = 0.5, 1.0  # phi in degrees per unit of row label
WORDS = {
    "follower": "pressure that follows the inner face, over dead pressure on the mid-surface",
    "full-3d": "full three-dimensional law (`full-3d`), over constant S33",
    "nonsymmetric": "`nonsymmetric`, over constant S33",
}
DELTA = 20.0  # mm, the travel of the printed table
CURVES = (10.0, 15.0, DELTA)  # mm, travels of the cell PAPER that are drawn; without them there is no page
PAPER = "paper"  # labels of cells
BODIES = {"tyre": "solid 56x72", "shell": "isotropic fine", "soft": "solid penalty"}  # soft: the plane is NGSolve's


def tyre_page(store: Store) -> Part:
    """The whole page."""
    cell = store.cell(PAPER)
    for delta in CURVES:  # without these travels there is no page
        cell.step(delta_mm=delta)
    crown = cell.result["quantities"]["inflated_equator_outer_mm"]
    own = {"tyre": cell.settings, "mesh": cell.result["mesh"], "crown": crown, "steps": cell.steps}
    parts = {"budget": _budget(store), "printed": _printed(store), "solid": solid_part(store)}
    shown = {"patch": patch_picture(store), "commands": commands([cell.command])}
    return TEXT("page", **own, **parts, **shown)


def patch_picture(store: Store) -> Part:
    """The contact pressure of the paper's tyre over the patch, in millimetres."""
    cell = store.cell(PAPER)
    pressures = pressures_of(at_delta(cell.table("contact"), DELTA))
    drawn = pressure_map(pressures, Developed.of(cell.table("profile")))
    return TEXT("patch", {"tyre-pressure-map.svg": drawn})


def _budget(store: Store) -> Part:
    """Every error of the force at 20 mm, those of the mesh beside those of the model."""
    budget = store.table("tyre_budget").to_dict("records")
    early = {row["changed"]: row for row in budget if row["delta_mm"] != DELTA}
    rows = [{**row, "early": _change(early.get(row["changed"]))} for row in _at_delta(budget)]
    other = next((f"{row['delta_mm']:g}" for row in early.values()), "")
    return TEXT("budget", delta=DELTA, other=other, rows=rows)


def model_table(store: Store) -> Part:
    """The same of the mesh, the load, the section and the shell; nothing where the campaign does not have them."""
    budget = _at_delta(store.rows("tyre_budget").to_dict("records"))
    return TEXT("model", delta=DELTA, rows=[row for row in budget if row["part"] != "measure"])


def _at_delta(rows: list[dict[Any, Any]]) -> list[dict[Any, Any]]:
    """The rows of the last travel, with words for what is changed and by how much that changes the force."""
    return [{**row, "name": _name(row), "now": _change(row)} for row in rows if row["delta_mm"] == DELTA]


def _name(row: Mapping[Any, Any]) -> str:
    return code(row["changed"]) if row["part"] == "measure" else WORDS.get(row["changed"], row["changed"])


def _change(row: Mapping[Any, Any] | None) -> str:
    """A change with its interval."""
    if row is None:
        return NOTHING
    if row["change"] == 0.0:
        return f"± {formatted(row['within'], '.1%')}"
    worded = f"{formatted(row['change'], '+.1%')} ± {formatted(row['within'], '.1%')}"
    return worded if str(row["settled"]) == "True" else f"{worded}, not settled"


def _printed(store: Store) -> Part:
    """What the printed table can mean, and which readings need no table."""
    cell, compared = store.cell(PAPER), store.table("tyre_comparison")
    readings = _at_delta_and_best(store.table("tyre_readings"))
    first, literal = (
        compared[(compared["delta_mm"] == DELTA) & (compared["phi_per_label"] == per_label)].to_dict("records")[0]
        for per_label in (HALF, LITERAL)
    )
    kinds = {kind: readings[readings["kind"] == kind] for kind in ("model", "data")}
    values = {"rules": store.rules(), "first": first, "literal": literal, "commands": commands(readings["command"])}
    return TEXT("printed", delta=DELTA, **values, **kinds, **_crown(cell), **_symmetry(store, cell))


def _at_delta_and_best(readings: pd.DataFrame) -> pd.DataFrame:
    """A row a reading: its values at the stated travel, and those of the travel of best fit as ``best_``."""
    stated, best = (readings[readings[name].astype(str) == "True"] for name in ("stated", "best"))
    names = {"delta_mm": "best_mm", "force_N": "best_N", "core_rms": "best_rms", "in_one_only": "best_nodes"}
    return stated.merge(best[["reading", *names]].rename(columns=names), on="reading")


def _crown(cell: Cell) -> dict[str, Any]:
    """The radius of the inflated crown, how far a plane inside it reaches, and what another origin of travel does."""
    profile = cell.table("profile")
    crown = float(profile.loc[profile["state"] == "inflated", "outer_radial_mm"].max())
    reach = math.degrees(math.acos(1.0 - DELTA / crown))
    moved = cell.result["quantities"]["inflated_equator_outer_mm"]
    whither = "farther from" if moved < 0 else "nearer to"
    origin = TEXT("origin", moved=moved, delta=DELTA, travel=DELTA + moved, whither=whither)
    return {"crown": crown, "reach": reach, "origin": origin}


def _symmetry(store: Store, cell: Cell) -> dict[str, Any]:
    """What a half turn and a reflection change in print and in ours."""
    data = store.table("tyre_symmetry")
    ours, printed = data[(data["who"] != "printed") & (data["delta_mm"] == DELTA)], data[data["who"] == "printed"]
    central, mirror = (float(value) for value in printed["both_touch_MPa"].iloc[:2])
    to_what = "to its last digit" if central < PRINTED_DIGIT / 2 else f"to {fixed(central, 3)} MPa"
    off = float(ours["both_touch_MPa"].iloc[1:].max())
    peak = float(at_delta(cell.table("contact"), DELTA)["pressure_MPa"].max())
    turned = cell.step(delta_mm=DELTA)["central_asymmetry"]
    return {"central": to_what, "turned": turned, "mirror": mirror, "off": off, "off_share": off / peak}


def solid_part(store: Store) -> Part:
    """The isotropic tyre as a shell and as a solid, split into mesh parts and a model part."""
    data = store.table("solid_shell")
    forces, growth = data[data["quantity"] == "force_N"], data[data["quantity"].str.startswith("inflated")]
    order = data["body"].map({"solid": 0, "shell": 2}).fillna(1).argsort(kind="stable")  # the soft plane between them
    cells = {name: store.cell(label).result for name, label in BODIES.items()}
    values = {
        "rules": store.rules(),
        "finest": forces["mesh"].iloc[-1],
        "changes": ", ".join(filled("{value:+.2%} at {at} mm", data[data["quantity"] == "penalty"])),
        "parts": " and ".join(filled("{model_part:+.2%} ({at})", growth.drop_duplicates("at"))),
        "cancellation": float(growth["cancellation"].iloc[0]),
        "commands": commands(data["command"].iloc[order]),
    }
    return TEXT("solid", **cells, **values, forces=_both(forces), growth=_both(growth))


def _both(data: pd.DataFrame) -> Iterator[dict[Any, Any]]:
    """The row of the solid with that of the shell in it."""
    for _, rows in data.groupby("at", sort=False):
        solid, shell = rows.drop_duplicates("body").to_dict("records")
        yield {**solid, "shell": shell}


CHAPTER = chapter(
    TEXT,
    tyre_page,
    needs=("rules", "tyre_comparison", "tyre_readings", "tyre_budget", "tyre_symmetry", "solid_shell"),
    always=True,
)

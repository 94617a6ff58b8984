"""Section of the tyre page: the printed pressures beside ours, reading by reading, and the symmetries of both."""

from __future__ import annotations

import math
from typing import Any

import pandas as pd

from reports.chapters.tyre.cells import DELTA, PAPER
from reports.figures.maps import at_delta
from reports.formats import fixed
from reports.markdown import Part, commands
from reports.store.cells import Cell
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("tyre")
PRINTED_DIGIT = 0.001  # MPa, one unit of its last digit
HALF, LITERAL = 0.5, 1.0  # phi in degrees per unit of row label


def printed_part(store: Store) -> Part:
    """What the printed table can mean, and which readings need no table."""
    cell, compared = store.find(**PAPER), store.table("tyre_comparison")
    readings = at_delta_and_best(store.table("tyre_readings"))
    first, literal = (
        compared[(compared["delta_mm"] == DELTA) & (compared["phi_per_label"] == per_label)].to_dict("records")[0]
        for per_label in (HALF, LITERAL)
    )
    kinds = {kind: readings[readings["kind"] == kind] for kind in ("model", "data")}
    told = {"rules": store.rules(), "first": first, "literal": literal, "commands": commands(readings["command"])}
    return TEXT("printed", delta=DELTA, **told, **kinds, **_crown(cell), **_symmetry(store, cell))


def at_delta_and_best(found: pd.DataFrame) -> pd.DataFrame:
    """A row a reading: its values at the stated travel, and those of the travel of best fit as ``best_``."""
    stated, best = (found[found[name].astype(str) == "True"] for name in ("stated", "best"))
    names = {"delta_mm": "best_mm", "force_N": "best_N", "core_rms": "best_rms", "in_one_only": "best_nodes"}
    return stated.merge(best[["reading", *names]].rename(columns=names), on="reading")


def _crown(cell: Cell) -> dict[str, Any]:
    """The radius of the inflated crown, how far a plane inside it reaches, and what another origin of travel does."""
    profile = cell.table("profile")
    crown = float(profile.loc[profile["state"] == "inflated", "outer_radial_mm"].max())
    reach = math.degrees(math.acos(1.0 - DELTA / crown))
    moved = cell.result["quantities"].get("inflated_equator_outer_mm")
    if moved is None:
        return {"crown": crown, "reach": reach, "origin": ""}
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

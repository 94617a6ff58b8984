"""Section of the tyre page: the printed pressures beside ours, reading by reading, and the symmetries of both."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import pandas as pd

from reports.chapters.tyre.cells import DELTA, PAPER
from reports.figures.maps import at_delta
from reports.formats import fixed, scientific, share
from reports.markdown import Part, commands, folded, joined, listing, prose
from reports.store.tables import Store

PRINTED_DIGIT = 0.001  # MPa, one unit of its last digit
HALF, LITERAL = 0.5, 1.0  # phi in degrees per unit of row label
HEADS = (
    "reading | force [N] | centre [MPa] | core rms | in one only | best at [mm] | force [N] | core rms | in one only"
)
LINE = "{reading} | {force_N:.0f} | {centre_MPa:.3f} | {core_rms:.1%} | {in_one_only} | {best_mm:g} | {best_N:.0f} | "
LINE += "{best_rms:.1%} | {best_nodes:.0f}"


def printed_part(store: Store) -> Part:
    """What the printed table can mean."""
    found, compared = store.analysis("tyre_readings"), store.analysis("tyre_comparison")
    own = at_delta_and_best(found)
    first, literal = (reading(compared, DELTA, per_label) for per_label in (HALF, LITERAL))
    model, data = (own[own["kind"] == kind] for kind in ("model", "data"))
    text = prose(f"""## The printed table

The paper prints one table of contact pressures, for Δ = {DELTA:g} mm. Its columns are ψ in degrees; its row labels are
read as 2 φ. Each line changes one thing of the paper's tyre; on the left it is compared at the stated travel, on the
right at the one of the travels tried, in whole millimetres, at which it fits best.

- *core rms*: root mean square of (ours - printed) / printed over printed entries with at least
  {store.rules()["core_depth"]:g} printed neighbours on each side and in contact in ours.
- *in one only*: nodes in contact in exactly one of the two patches, of {first["printed_nodes"]} printed ones.
- Printed: {fixed(first["printed_centre_MPa"], 3)} MPa in the centre; times the areas of its nodes the table adds up to
  {fixed(first["printed_sum_N"], 1)} N. The same sum over our own pressures gives {fixed(first["own_sum_N"], 1)} N, our
  force {fixed(first["force_N"], 1)} N.""")
    return joined(
        text,
        listing("The printed table against ours: what the model may be", model, HEADS, LINE),
        listing("The same with data changed within their rounding", data, HEADS, LINE) if len(data) else "",
        _excluded(store, literal),
        _symmetry(store, first),
        commands(own["command"]),
    )


def at_delta_and_best(found: pd.DataFrame) -> pd.DataFrame:
    """A row a reading: its values at the stated travel, and those of the travel of best fit as ``best_``."""
    stated, best = (found[found[name].astype(str) == "True"] for name in ("stated", "best"))
    names = {"delta_mm": "best_mm", "force_N": "best_N", "core_rms": "best_rms", "in_one_only": "best_nodes"}
    return stated.merge(best[["reading", *names]].rename(columns=names), on="reading")


def reading(found: pd.DataFrame, delta: float, per_label: float = HALF) -> Mapping[str, Any]:
    """The comparison of one travel under one reading of the row labels."""
    own = found[(found["delta_mm"] == delta) & (found["phi_per_label"] == per_label)]
    return {str(key): value for key, value in own.iloc[0].items()}


def _excluded(store: Store, row: Mapping[str, Any]) -> str:
    """Readings that need no table, and those that were not tried."""
    cell = store.find(**PAPER)
    profile = cell.table("profile")
    crown = float(profile.loc[profile["state"] == "inflated", "outer_radial_mm"].max())
    reach = math.degrees(math.acos(1.0 - DELTA / crown))
    moved = cell.result["quantities"].get("inflated_equator_outer_mm")
    origin = ""
    if moved is not None:
        origin = f"""Counted from the crown before inflation, which moves by {fixed(moved, 2, sign=True)} mm, a travel
of {DELTA:g} mm is one of {fixed(DELTA + moved, 1)} mm from first touch, and """
        origin += "farther from the best fit." if moved < 0 else "nearer to the best fit."
    return prose(f"""Row labels cannot be φ itself: {row["outside"]} of the {row["printed_nodes"]} printed entries would
then lie off our patch, and a plane {DELTA:g} mm inside the inflated crown circle of radius {fixed(crown, 1)} mm reaches
no farther than φ = ±{fixed(reach, 1)} deg. {origin} Not tried: an inflation that enters as initial stress alone,
edges clamped at another angle, moduli within their rounding, and two changes at once.""")


def _symmetry(store: Store, own: Mapping[str, Any]) -> str:
    cell = store.find(**PAPER)
    data = store.analysis("tyre_symmetry")
    ours, printed = data[(data["who"] != "printed") & (data["delta_mm"] == DELTA)], data[data["who"] == "printed"]
    central, mirror = (float(value) for value in printed["both_touch_MPa"].iloc[:2])
    to_what = "to its last digit" if central < PRINTED_DIGIT / 2 else f"to {fixed(central, 3)} MPa"
    off = float(ours["both_touch_MPa"].iloc[1:].max())
    peak = float(at_delta(cell.table("contact"), DELTA)["pressure_MPa"].max())
    turned = scientific(cell.step(delta_mm=DELTA)["central_asymmetry"])
    return folded(
        "Symmetry of both tables",
        prose(f"""Alternating plies make the tyre symmetric under a half turn about the contact normal, but not under
reflections. The printed table is symmetric under the half turn {to_what}, ours to {turned} of its peak. Mirror images
differ, over pairs of nodes that both touch, by up to {fixed(mirror, 3)} MPa in print and by up to {fixed(off, 3)} MPa,
{share(off / peak, 1)} of the peak, in ours. The parts that change under reflection correlate with
{fixed(own["handedness"], 2, sign=True)}; the opposite sign of the cord angle would change this sign, too."""),
    )

"""Sections of the tyre page: the printed pressures beside ours under stated readings, and the symmetries of both."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import pandas as pd

from reports.chapters.tyre import figures_patch
from reports.chapters.tyre.cells import DELTA, PAPER
from reports.figures.maps import at_delta
from reports.formats import fixed, scientific, share
from reports.markdown import Part, commands, folded, joined, listing, picture, prose, table
from reports.store.cells import Cell
from reports.store.tables import Store

PRINTED_FACTOR = 10.0  # the table gives -10 q
PRINTED_DIGIT = 0.001  # MPa, one unit of its last digit
HALF, LITERAL = 0.5, 1.0  # phi in degrees per unit of row label
COMPARED = "centre ours [MPa] | printed [MPa] | core rms | core nodes | nodes ours | printed | both | in one only"
COMPARISON = (
    "{centre_MPa:.4f} | {printed_centre_MPa:.3f} | {core_rms:.2%} | {core_nodes} | "
    "{nodes} | {printed_nodes} | {both} | {in_one_only}"
)


def printed_part(store: Store) -> Part:
    """The printed table and ours."""
    cell, found = store.find(**PAPER), store.analysis("tyre_comparison")
    best = float(found.loc[found["best"], "delta_mm"].iloc[0])
    sections = _readings(store, cell, found, best), _tables(store, best), _symmetry(store, cell, best)
    return joined(*sections, commands([cell.command]))


def reading(found: pd.DataFrame, delta: float, per_label: float = HALF) -> Mapping[str, Any]:
    """The comparison of one travel under one reading of the row labels."""
    own = found[(found["delta_mm"] == delta) & (found["phi_per_label"] == per_label)]
    return {str(key): value for key, value in own.iloc[0].items()}


def _readings(store: Store, cell: Cell, found: pd.DataFrame, best: float) -> Part:
    first, literal = reading(found, DELTA), reading(found, DELTA, LITERAL)
    readings = [
        {"reading": f"(a) Δ = {DELTA:g} mm, φ = row label / 2", **first},
        {"reading": f"(b) Δ = {best:g} mm, φ = row label / 2", **reading(found, best)},
        {"reading": f"(c) Δ = {DELTA:g} mm, φ = row label", **literal},
    ]
    heads, line = f"reading | {COMPARED} | P ours [N] | P printed [N]", f"{{reading}} | {COMPARISON}"
    line += " | {force_N:.1f} | {printed_sum_N:.1f}"
    text = prose(f"""## The printed table

The paper prints one table of contact pressures, for Δ = {DELTA:g} mm. Its columns are ψ in degrees; what its
rows and its Δ mean has to be read into it, so every number below is given under a stated reading. Reading (b) takes the
travel of the cell `{cell.label}` that has the smallest core rms; where the paper counts Δ from is not known.

- *core*: printed entries with at least {store.rules()["core_depth"]:g} printed neighbours on each side along ψ and
  along φ, and in contact in our answer, too; *core rms* is the root mean square of (ours - printed) / printed there.
- *nodes*: places of the printed table in contact in ours, in print, in both, and in exactly one of them.
- *P printed*: the printed pressures times the mid-surface areas of their nodes. The same sum over our own pressures of
  reading (a) gives {fixed(first["own_sum_N"], 1)} N.""")
    body = listing("The printed pressure table against ours, by reading", readings, heads, line)
    own, title = found[found["phi_per_label"] == HALF], "The same for every travel, φ = row label / 2"
    by_delta = listing(title, own, f"Δ [mm] | {COMPARED}", f"{{delta_mm:g}} | {COMPARISON}")
    return joined(text, body, _literal(store, cell, literal), by_delta)


def _literal(store: Store, cell: Cell, row: Mapping[str, Any]) -> str:
    """Why row labels are not phi in degrees."""
    profile, contact = cell.table("profile"), at_delta(cell.table("contact"), DELTA)
    crown = float(profile.loc[profile["state"] == "inflated", "outer_radial_mm"].max())
    reach = math.degrees(math.acos(1.0 - DELTA / crown))
    nodes = store.analysis("tyre_printed_nodes").dropna(subset="printed_MPa")
    patch = float(contact.loc[contact["active"] == 1, "phi_deg"].abs().max())
    return (
        f"Reading (c) cannot be meant: {row['outside']} of the {row['printed_nodes']} printed entries lie off our "
        f"patch, which ends at φ = ±{patch:g} deg. A plane {DELTA:g} mm inside the inflated crown circle of "
        f"radius {fixed(crown, 1)} mm does not even reach beyond φ = ±{fixed(reach, 1)} deg, but pressures are printed "
        f"up to the row label {nodes['row_label'].abs().max():g}."
    )


def _tables(store: Store, best: float) -> Part:
    nodes = store.analysis("tyre_printed_nodes")
    maps = {}
    for delta in dict.fromkeys((DELTA, best)):
        grid = nodes[nodes["delta_mm"] == delta].set_index(["row_label", "psi_deg"]).sort_index()
        maps[delta] = [grid[f"{who}_MPa"].unstack() for who in ("pressure", "printed")]
    ours, printed = maps[DELTA]
    title = f"{PRINTED_FACTOR:g} p [MPa]; rows: printed label = 2 φ; columns: ψ [deg]"
    tables = [_table(f"Printed: {title}", printed), _table(f"Ours, Δ = {DELTA:g} mm: {title}", ours)]
    drawn = figures_patch.table_differences({f"Δ = {delta:g} mm": both for delta, both in maps.items()})
    return joined(
        picture("tyre-printed-difference.svg", "Relative difference from the printed table", drawn),
        folded("Both tables in full", "\n\n".join(tables)),
    )


def _table(title: str, pressures: pd.DataFrame) -> str:
    rows = [
        [f"{label:g}", *("" if math.isnan(p) else fixed(PRINTED_FACTOR * p, 2) for p in row)]
        for label, row in zip(pressures.index, pressures.to_numpy(dtype=float), strict=True)
    ]
    return table(title, ["", *(f"{psi:g}" for psi in pressures.columns)], rows)


def _symmetry(store: Store, cell: Cell, best: float) -> Part:
    data, own = store.analysis("tyre_symmetry"), reading(store.analysis("tyre_comparison"), DELTA)
    ours = {delta: data[data["delta_mm"] == delta] for delta in (DELTA, best)}
    print_ = data[data["who"] == "printed"]
    maps = {**{f"ours, Δ = {delta:g} mm": rows for delta, rows in ours.items()}, "printed": print_}
    shown = print_[["image"]].reset_index(drop=True)
    for name, each in maps.items():
        shown[f"{name}, blank = 0"] = each["blank_is_zero_MPa"].to_numpy()
        shown[f"{name}, both touch"] = each["both_touch_MPa"].to_numpy()
    heads = " | ".join(["largest difference [MPa]", *shown.columns[1:]])
    line = "{image}" + "".join(f" | {{{name}:small}}" for name in shown.columns[1:])
    central, mirror = (float(value) for value in print_["both_touch_MPa"].iloc[:2])
    to_what = "to its last digit" if central < PRINTED_DIGIT / 2 else f"to {fixed(central, 3)} MPa"
    off = float(ours[DELTA]["blank_is_zero_MPa"].iloc[1:].max())
    peak = float(at_delta(cell.table("contact"), DELTA)["pressure_MPa"].max())
    turned = cell.step(delta_mm=DELTA)["central_asymmetry"]
    text = prose(f"""## Symmetry

Alternating plies make the tyre symmetric under a half turn about the contact normal, but not under reflections. A node
out of contact counts as zero pressure (*blank = 0*), or the pair is left out unless both nodes touch (*both touch*).
The printed table is symmetric under the half turn {to_what}; its mirror images differ by up to {fixed(mirror, 3)} MPa.
Ours at Δ = {DELTA:g} mm differs by {_small(turned)} of its peak under the half turn, over all nodes, and by up
to {fixed(off, 3)} MPa or {share(off / peak, 1)} of its peak between mirror images. The parts
that change under reflection correlate between ours and the printed table with {fixed(own["handedness"], 2, sign=True)};
the opposite sign of the cord angle would change this sign, too.""")
    return joined(text, listing("Central and mirror asymmetry", shown, heads, line, small=_small))


def _small(value: float) -> str:
    return scientific(value) if abs(value) < 1e-6 else fixed(value, 3)

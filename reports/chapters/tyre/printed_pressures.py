"""Sections of the tyre page: the printed pressures beside ours under stated readings, and the symmetries of both."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from reports import labels
from reports.chapters.tyre import figures as figures_tyre
from reports.chapters.tyre.paper_table import (
    DEPTH,
    FILE,
    HALF,
    IMAGES,
    LITERAL,
    PRINTED_DIGIT,
    PRINTED_FACTOR,
    Comparison,
    asymmetry,
    compare,
    force,
    handedness,
    on_printed_nodes,
    printed_map,
)
from reports.maps import at_delta, deltas, pressure_map
from reports.markdown import Part, commands, fixed, folded, joined, percent, picture, prose, scientific, table
from reports.tables import Cell, Store


def printed_part(store: Store) -> Part:
    """The printed table and ours."""
    cell = store.cell(labels.PAPER)
    printed, contact = printed_map(store.reference_table(FILE, ["row_label"])), cell.table("contact")
    best = best_delta(contact, printed)
    parts = [
        _readings(cell, contact, printed, best),
        _travels(contact, printed),
        _tables(contact, printed, best),
        _symmetry(cell, contact, printed, best),
    ]
    return joined([*parts, Part(commands([cell.command]))])


def best_delta(contact: pd.DataFrame, printed: pd.DataFrame) -> float:
    """The travel with the smallest core rms."""

    def misfit(delta: float) -> float:
        rms = compare(on_printed_nodes(at_delta(contact, delta), printed, HALF), printed).core_rms
        return math.inf if rms is None else rms

    return min(deltas(contact), key=misfit)


def _readings(cell: Cell, contact: pd.DataFrame, printed: pd.DataFrame, best: float) -> Part:
    readings = (
        (f"(a) Δ = {labels.DELTA:g} mm, φ = row label / 2", labels.DELTA, HALF),
        (f"(b) Δ = {best:g} mm, φ = row label / 2", best, HALF),
        (f"(c) Δ = {labels.DELTA:g} mm, φ = row label", labels.DELTA, LITERAL),
    )
    settings, rows = cell.result["settings"], []
    for words, delta, scale in readings:
        ours = on_printed_nodes(at_delta(contact, delta), printed, scale)
        forces = cell.step(delta_mm=delta)["force_N"], force(printed, scale, settings)
        rows.append([words, *_comparison(compare(ours, printed)), *(fixed(f, 1) for f in forces)])
    header = [
        "reading",
        "centre ours [MPa]",
        "printed [MPa]",
        "core rms",
        "core nodes",
        "nodes ours",
        "printed",
        "both",
    ]
    header += ["in one only", "P ours [N]", "P printed [N]"]
    text = prose(f"""## The printed table

The paper prints one table of contact pressures, for Δ = {labels.DELTA:g} mm. Its columns are ψ in degrees; what its
rows and its Δ mean has to be read into it, so every number below is given under a stated reading. Reading (b) takes the
travel of the cell `{cell.label}` that has the smallest core rms; where the paper counts Δ from is not known.

- *core*: printed entries with at least {DEPTH} printed neighbours on each side along ψ and along φ, and in contact in
  our answer, too; *core rms* is the root mean square of (ours - printed) / printed there.
- *nodes*: places of the printed table in contact in ours, in print, in both, and in exactly one of them.
- *P printed*: the printed pressures times the mid-surface areas of their nodes. The same sum over our own pressures of
  reading (a) gives {fixed(_own_sum(cell, contact, printed), 1)} N.""")
    body = table("The printed pressure table against ours, by reading", header, rows)
    return joined([Part(text), Part(body), Part(_literal(cell, contact, printed))])


def _own_sum(cell: Cell, contact: pd.DataFrame, printed: pd.DataFrame) -> float:
    ours = on_printed_nodes(at_delta(contact, labels.DELTA), printed, HALF)
    return force(ours, HALF, cell.result["settings"])


def _comparison(c: Comparison) -> list[str]:
    rms = percent(c.core_rms, sign=False)
    centre = [fixed(c.centre, 4), fixed(c.printed_centre, 3), rms]
    return centre + [str(n) for n in (c.core_nodes, c.nodes, c.printed_nodes, c.both, c.symmetric_difference)]


def _literal(cell: Cell, contact: pd.DataFrame, printed: pd.DataFrame) -> str:
    """Why row labels are not phi in degrees."""
    at_20 = at_delta(contact, labels.DELTA)
    c = compare(on_printed_nodes(at_20, printed, LITERAL), printed)
    profile = cell.table("profile")
    crown = float(profile.loc[profile["state"] == "inflated", "outer_radial_mm"].max())
    reach = math.degrees(math.acos(1.0 - labels.DELTA / crown))
    last = float(np.max(np.abs(printed.dropna(how="all").index.to_numpy(dtype=float))))
    patch = float(at_20.loc[at_20["active"] == 1, "phi_deg"].abs().max())
    return (
        f"Reading (c) cannot be meant: {c.outside} of the {c.printed_nodes} printed entries lie off our patch, which "
        f"ends at φ = ±{patch:g} deg. A plane {labels.DELTA:g} mm inside the inflated crown circle of radius "
        f"{fixed(crown, 1)} mm does not even reach beyond φ = ±{fixed(reach, 1)} deg, but pressures are printed up to "
        f"the row label {last:g}."
    )


def _travels(contact: pd.DataFrame, printed: pd.DataFrame) -> Part:
    rows = []
    for delta in deltas(contact):
        c = compare(on_printed_nodes(at_delta(contact, delta), printed, HALF), printed)
        rows.append([f"{delta:g}", *_comparison(c)])
    header = ["Δ [mm]", "centre ours [MPa]", "printed [MPa]", "core rms", "core nodes", "nodes ours", "printed"]
    return Part(table("The same for every travel, φ = row label / 2", [*header, "both", "in one only"], rows))


def _tables(contact: pd.DataFrame, printed: pd.DataFrame, best: float) -> Part:
    maps = {delta: on_printed_nodes(at_delta(contact, delta), printed, HALF) for delta in (labels.DELTA, best)}
    name = "tyre-printed-difference.svg"
    panels = {f"Δ = {delta:g} mm": (ours, printed) for delta, ours in maps.items()}
    title = f"{PRINTED_FACTOR:g} p [MPa]; rows: printed label = 2 φ; columns: ψ [deg]"
    tables = [
        _table(f"Printed: {title}", printed),
        _table(f"Ours, Δ = {labels.DELTA:g} mm: {title}", maps[labels.DELTA]),
    ]
    text = [
        picture(name, "Relative difference from the printed table"),
        folded("Both tables in full", "\n\n".join(tables)),
    ]
    return Part("\n\n".join(text), {name: figures_tyre.table_differences(panels)})


def _table(title: str, pressures: pd.DataFrame) -> str:
    rows = [
        [f"{label:g}", *("" if math.isnan(p) else fixed(PRINTED_FACTOR * p, 2) for p in row)]
        for label, row in zip(pressures.index, pressures.to_numpy(dtype=float), strict=True)
    ]
    return table(title, ["", *(f"{psi:g}" for psi in pressures.columns)], rows)


def _symmetry(cell: Cell, contact: pd.DataFrame, printed: pd.DataFrame, best: float) -> Part:
    maps = {
        f"ours, Δ = {delta:g} mm": on_printed_nodes(at_delta(contact, delta), printed, HALF)
        for delta in dict.fromkeys((labels.DELTA, best))
    } | {"printed": printed}
    rows = [
        [image, *(_small(value) for pressures in maps.values() for value in asymmetry(pressures, image))]
        for image in IMAGES
    ]
    header = ["largest difference [MPa]", *(f"{name}, {over}" for name in maps for over in ("blank = 0", "both touch"))]
    central, mirror, _ = (asymmetry(printed, image)[1] for image in IMAGES)
    to_what = "to its last digit" if central < PRINTED_DIGIT / 2 else f"to {fixed(central, 3)} MPa"
    ours = maps[f"ours, Δ = {labels.DELTA:g} mm"]
    peak = float(pressure_map(at_delta(contact, labels.DELTA)).max().max())
    own = max(asymmetry(ours, image)[0] for image in list(IMAGES)[1:])
    odd = handedness(ours, printed)
    turned = cell.step(delta_mm=labels.DELTA)["central_asymmetry"]
    text = prose(f"""## Symmetry

Alternating plies make the tyre symmetric under a half turn about the contact normal, but not under reflections. A node
out of contact counts as zero pressure (*blank = 0*), or the pair is left out unless both nodes touch (*both touch*).
The printed table is symmetric under the half turn {to_what}; its mirror images differ by up to {fixed(mirror, 3)} MPa.
Ours at Δ = {labels.DELTA:g} mm differs by {_small(turned)} of its peak under the half turn, over all nodes, and by up
to {fixed(own, 3)} MPa or {percent(own / peak, 1, sign=False)} of its peak between mirror images. The parts
that change under reflection correlate between ours and the printed table with {fixed(odd, 2, sign=True)}; the opposite
sign of the cord angle would change this sign, too.""")
    return Part(f"{text}\n\n{table('Central and mirror asymmetry', header, rows)}")


def _small(value: float) -> str:
    return scientific(value) if abs(value) < 1e-6 else fixed(value, 3)

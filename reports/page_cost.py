"""The page of cost: what a smaller model saves, and that it changes nothing."""

from __future__ import annotations

import re

import numpy as np

from reports import labels
from reports.maps import at_delta
from reports.markdown import Part, commands, fixed, joined, machine, percent, prose, scientific, table
from reports.navigation import links
from reports.schema import Cell, Store

SAME = 1e-9  # relative difference below which a part of the tyre gives the whole
TIMES = ("total", "build", "assembly", "factorisation", "solve", "contact")


def cost_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose(f"""# What it costs

{links("cost.md")}

Times are wall times of one run each, on the machine of the [overview](index.md); what is compared is their ratio.""")
    return joined([Part(introduction), _models(store)])


def _models(store: Store) -> Part:
    """Parts of the tyre beside the whole."""
    cells = store.matching(labels.MODEL)
    rows, times, same = [], [], 0
    for cell in cells:
        model, plies = _words(cell)
        whole = store.cell(f"model full {plies}")
        counters = cell.result["counters"]
        counts = [str(counters[name]) for name in ("dofs", "newton_iterations", "factorisations")]
        off = differences(cell, whole)
        rows.append([plies, f"`{model}`", *counts, *map(_difference, off)])
        same += max(off) <= SAME
        share = cell.result["timing_s"]["total"] / whole.result["timing_s"]["total"]
        spent = [fixed(cell.result["timing_s"].get(name, 0.0), 2) for name in TIMES]
        times.append([plies, f"`{model}`", *spent, percent(share, 0, sign=False)])
    delta = fixed(labels.DELTA, 0)
    text = prose(f"""## Do less: a part of the tyre

Inflation is the same all around and is solved on one column of elements; pressed to {delta} mm on a mesh of
{cells[0].result["mesh"]}, a tyre with angle plies is a half under a turn by 180° about the contact normal, one without
is a quarter between two mirror planes. {same} of {len(cells)} models give the force, the pressures and the contact set
of the whole to {scientific(SAME, 0)} of their value. `--model auto` takes the smallest valid one; a mirror is refused
for angle plies.""")
    header = ["plies", "model", "unknowns", "iterations", "factorisations", "force off", "pressure off"]
    spent_on = ["plies", "model", *(f"{name} [s]" for name in TIMES), "of the whole"]
    steady = table(f"Inflation and {delta} mm, against the whole", header, rows, words=2)
    timed = machine(table("Wall times", spent_on, times, words=2))
    return Part("\n\n".join([text, steady, timed, commands(cell.command for cell in cells)]))


def _words(cell: Cell) -> tuple[str, str]:
    found = re.fullmatch(labels.MODEL, cell.label)
    assert found is not None
    return found["model"], found["plies"]


def differences(cell: Cell, whole: Cell) -> tuple[float, float]:
    """Force and largest nodal pressure relative to the whole; infinite for another contact set, NaN where unreached."""
    if any(each.find_step(delta_mm=labels.DELTA) is None for each in (cell, whole)):
        return float("nan"), float("nan")
    force = abs(cell.value("force_N", delta_mm=labels.DELTA) / whole.value("force_N", delta_mm=labels.DELTA) - 1)
    own, other = (at_delta(each.table("contact"), labels.DELTA) for each in (cell, whole))
    if not np.array_equal(own["active"], other["active"]):
        return force, float("inf")
    pressures = own["pressure_MPa"].to_numpy(), other["pressure_MPa"].to_numpy()
    return force, float(np.max(np.abs(pressures[0] - pressures[1])) / np.max(pressures[1]))


def _difference(value: float) -> str:
    return f"under {scientific(SAME, 0)}" if value <= SAME else scientific(value)

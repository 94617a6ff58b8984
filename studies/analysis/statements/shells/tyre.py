"""What is said of the tyre: the paper's table, linear strains, mesh, load and solids."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from studies.analysis.cells.answers import Answers
from studies.analysis.comparisons.printed_pressures import DELTA, HALF
from studies.analysis.statements.record import LIMIT, OPENING, Statement

PAGE = "tyre"
BASE = "exact semismooth mixed exact"  # labels of cells
FIRST = 5.0  # mm
OURS = "the element and the mesh of the paper, dead load; another origin of the travel would change it"


def printed(tyre_comparison: pd.DataFrame) -> Iterator[Statement]:
    """The paper's table, at the travel that it states and at the one that fits best."""
    half = tyre_comparison[tyre_comparison["phi_per_label"] == HALF].set_index("delta_mm")
    if DELTA not in half.index or not half["best"].any():
        return
    at, best = half.loc[DELTA], half[half["best"].astype(bool)].iloc[0]
    values = {
        **{"delta": DELTA, "off": at["force_N"] / at["printed_sum_N"] - 1, "rms": at["core_rms"]},
        **{"best": float(half.index[int(half["best"].astype(bool).argmax())]), "best_rms": best["core_rms"]},
        "best_off": best["force_N"] / best["printed_sum_N"] - 1,
    }
    text = (
        "The paper's table of contact pressures is not reproduced at the travel that it states: at {delta:g} mm the "
        "force is {off:+.0%} off what the printed pressures add up to, and pressures in the core of the patch differ "
        "by {rms:.1%} (rms). It fits best at {best:g} mm, with {best_off:+.0%} and {best_rms:.1%}."
    )
    yield Statement("printed-table", PAGE, text, values, len(half), f"{OURS}; row label = 2 φ", OPENING)
    values = {"delta": DELTA, "centre": at["centre_MPa"], "printed": at["printed_centre_MPa"], "rms": at["core_rms"]}
    values |= {"outside": at["outside"], "nodes": at["printed_nodes"]}
    text = (
        "The origin of the plane's travel in the paper is not known. Counted from first touch, at {delta:g} mm the "
        "centre pressure is {centre:.3f} MPa (printed: {printed:.3f}), but {outside:.0f} of the {nodes:.0f} printed "
        "nodes are not in contact, and in the core of the patch pressures differ by {rms:.1%} (rms)."
    )
    yield Statement("origin-of-travel", PAGE, text, values, 1, OURS, LIMIT)


def linear(answers: Answers) -> Iterator[Statement]:
    """Linear against exact strains."""
    pairs = [_forces(answers, label) for label in ("linear", "paper")]
    if not all(DELTA in each and FIRST in each for each in pairs):
        return
    low, high = pairs
    values = {"delta": DELTA, "linear": low[DELTA], "exact": high[DELTA], "ratio": low[DELTA] / high[DELTA]}
    values |= {"first": FIRST, "ratio_first": low[FIRST] / high[FIRST]}
    text = (
        "At a travel of {delta:g} mm linear strains give {linear:.1f} N and exact ones {exact:.1f} N: {ratio:.2f} "
        'times as much, where the paper says "about two"; at {first:g} mm it is {ratio_first:.2f} times as much.'
    )
    yield Statement("tyre-linear", PAGE, text, values, 2, OURS, OPENING)


def _forces(answers: Answers, label: str) -> dict[float, float]:
    found = answers.get(label)
    return {} if found is None else {step["delta_mm"]: step["force_N"] for step in found.steps}


def assumptions(answers: Answers) -> Iterator[Statement]:
    """What the mesh and the load of the paper change."""
    base, fine, follower = (_forces(answers, label).get(DELTA, math.nan) for label in (BASE, "fine", "follower"))
    values = {"mesh": fine / base - 1, "follower": follower / base - 1, "delta": DELTA}
    if any(map(math.isnan, values.values())):
        return
    text = (
        "The paper's mesh is coarse: halving its elements changes the force at {delta:g} mm by {mesh:+.2%}. Its dead "
        "load is a model: a pressure that follows the wall changes the force by {follower:+.2%}."
    )
    yield Statement("tyre-mesh-and-load", PAGE, text, values, 3, OURS, LIMIT)


def solids(solid_shell: pd.DataFrame) -> Iterator[Statement]:
    """The shell beside solids."""
    off = solid_shell[(solid_shell["quantity"] == "force_N") & (solid_shell["body"] != "solid")]
    if off.empty or off["model_part"].isna().all():
        return
    worst = off["model_part"].abs().max()
    text = (
        "Against solids of the same law the force of the isotropic tyre is off by up to {off:.2%} once both are "
        "extrapolated over their meshes."
    )
    scope = "isotropic tyre, follower load on the true face; an angle-ply solid is not computed"
    yield Statement("tyre-solid", PAGE, text, {"off": worst}, len(off), scope, LIMIT)


MAKERS = (printed, linear, assumptions, solids)

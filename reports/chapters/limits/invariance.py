"""The page of what must not matter: rigid motions by measure, symmetries and units, random cases and planted faults."""

from __future__ import annotations

import re
from collections.abc import Iterator
from textwrap import wrap

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reports.chapter import Chapter
from reports.figures.drawing import BLACK, canvas, looks, svg
from reports.formats import NOTHING, code, digits, fixed, number, scientific
from reports.markdown import Part, commands, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

NOTHING_LEFT = 1e-12  # a strain below this is rounding
MOTIONS = ("translation", "out of plane", "drilling", "about the axis")
SAME = 1e-9  # measures this close all the way share a curve
WIDTH = 63  # letters in a line of a panel's legend, its comma included
ACCIDENT, DESIGN, APART = "broken by accident", "broken by design", "does not apply"
RANDOM = ("fuzz", "fuzz_faults")


def invariance_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose(f"""# {CHAPTER.title}

A rigid motion strains nothing, and an answer must not depend on axes, numbering, units, load steps or the place of a
body. What each measure leaves under rigid motions is declared as a law beforehand: a Donnell measure without its
strain would fail here, as would an exact one with any.""")
    drawn = _random(store) if all(map(store.has_table, RANDOM)) else ""
    return joined(introduction, _motions(store), _symmetries(store), drawn)


def _motions(store: Store) -> Part:
    """What each measure leaves under rigid motions, and how it begins."""
    data, powers, sweep = store.table("rigid_body"), store.analysis("rigid_body_powers"), store.table("rotation_sweep")
    begins = powers.set_index(["measure", "surface", "motion"])
    rows = []
    for name, own in data.groupby("measure", sort=False):
        told = own.dropna(subset=["declared"])
        largest = own.groupby("motion")["largest"].max().reindex(MOTIONS)
        keys = [(name, "plate", motion) for motion in MOTIONS[1:3]]
        known = begins.to_dict("index")
        plate = [_power(pd.Series(known[key])) if key in known else NOTHING for key in keys]
        laws = [f"{len(told)} of {len(own)}", scientific(_miss(told))]
        rows.append([code(name), *map(_size, largest), *plate, *laws])
    theta, slide = float(data["theta_rad"].max()), float(data["slide"].max())
    text = prose(f"""## Rigid motions

The exact displacements of a small piece of a shell, moved as a whole, are sent through the formulas of each measure; no
mesh is in the table. It shows the largest of eleven strains on plate, cylinder, sphere and torus after a translation by
{slide:g} of the size of the piece and rotations by {theta:g} rad; then how the membrane strain of the plate begins
under a small angle a; then for how many of the cases a law is declared, and the largest difference from it. 0 is below
{NOTHING_LEFT:g}. A linear measure errs by -a²/2; half the square of the rotation, where a measure adds it, leaves
-a⁴/8. Donnell's slopes omit the turning of the frame, so that a translated cylinder strains.{_panel(store)}""")
    header = ["measure", *MOTIONS, *(f"{motion}, plate" for motion in MOTIONS[1:3]), "laws", "off the law"]
    shown = table("Largest strain left by rigid motions [-]", header, rows)
    words = "Strain left by a rigid rotation over a full turn, by measure, with the declared laws"
    miss = scientific(_miss(sweep.dropna(subset=["declared"])))
    below = prose(f"""Over the full turn the largest distance from a declared curve (dotted) is {miss}. At 180 degrees a
measure with the square of the rotation added errs as much as the linear one.""")
    return joined(text, shown, picture("rigid-body-turn.svg", words, full_turn(sweep)), below)


def _panel(store: Store) -> str:
    """What the element adds, as its own rotations one after another show; nothing where they were not made."""
    if not store.has_table("rotations"):
        return ""
    data = store.table("rotations")
    there = data[
        (data["measure"] == "exact") & (data["body"] == "free") & (data["path"] == "back") & (data["leg"] == 3)
    ]
    left = ", ".join(f"{_size(row['strain'])} ({row['interpolation']})" for row in there.to_dict("records"))
    return (
        f""" The element may add an error of its own, which falls with the
square of its size: in a panel of 4 by 4 elements turned about Z, Y and X the exact
measure leaves a strain of {left}."""
        if left
        else ""
    )


def _miss(told: pd.DataFrame) -> float:
    """The largest distance from a declared law."""
    return float((told["strain"] - told["declared"]).abs().max())


def _size(value: float) -> str:
    return "0" if abs(value) < NOTHING_LEFT else f"{value:.3g}"


def _power(row: pd.Series) -> str:
    rate = float(row["strain_rate"])
    return "0" if np.isnan(rate) else f"{fixed(row['strain_coefficient'], 3)} a^{fixed(rate, 2)}"


def shared_curves(rows: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """The measures of one case grouped by equal strains: their names and one of their tables."""
    groups: list[tuple[list[str], pd.DataFrame]] = []
    for name, own in rows.groupby("measure", sort=False):
        same = (names for names, first in groups if np.allclose(first["strain"], own["strain"], rtol=0, atol=SAME))
        names = next(same, None)
        if names is None:
            groups.append(([str(name)], own))
        else:
            names.append(str(name))
    for names, own in groups:
        yield ", ".join(names), own


@svg
def full_turn(sweep: pd.DataFrame) -> Figure:
    """Strain over the angle of a rigid rotation, a panel a case; the exact answer is zero."""
    cases, drawn = sweep.groupby(["surface", "motion"], sort=False), looks(sweep["measure"])
    figure, panels = canvas(len(cases), columns=2, width=9.0, height=4.2)
    for axes, ((surface, motion), rows) in zip(panels, cases, strict=True):
        for names, own in shared_curves(rows):
            colour, angle = drawn[own["measure"].iloc[0]].colour, np.degrees(own["theta_rad"])
            label = "\n".join(wrap(names, WIDTH, break_long_words=False, break_on_hyphens=False))
            axes.plot(angle, own["strain"], color=colour, linewidth=3.5, alpha=0.7, label=label)
            axes.plot(angle, own["declared"], color=BLACK, linestyle=":", linewidth=1.2)
        axes.set(title=f"{surface}, {motion}", xlabel="rotation [deg]", ylabel="strain [-]", xlim=(0, 360))
        axes.set_xticks([0, 90, 180, 270, 360])
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=8, frameon=False)
    declared = Line2D([], [], color=BLACK, linestyle=":", linewidth=1.2, label="declared law")
    figure.legend(handles=[declared], loc="outside upper center")
    return figure


def accidents(store: Store) -> tuple[int, int]:
    """How many checks are broken by accident, and of how many."""
    data = store.table("symmetry")
    return int((data["class"] == ACCIDENT).sum()), len(data)


def _symmetries(store: Store) -> Part:
    """A row a check: what is unchanged, and what breaks by design."""
    data = store.table("symmetry")
    wrong, whole = accidents(store)
    rows = [[check, *_check(own)] for check, own in data.groupby("check", sort=False)]
    text = prose(f"""## Symmetries and units

{data["measure"].nunique()} measures by {data["algorithm"].nunique()} contact algorithms, {whole} checks, {wrong} broken
by accident. Each compares two answers that ought to be one, or an answer with its own image, on small clamped laminated
panels pressed by a plane or a ball, and on the paper's whole tyre on a coarse mesh. The deviation is the largest
difference of pressures over the peak, or of displacements over the largest. *Unchanged*: below what rounding or the
tolerance of Newton's iteration allows. *By design*: a measure declares the deviation, or cords at an angle leave no
mirror plane; its absence would count as a failure.""")
    heads = ["check", "checks", "unchanged", "by design", "by accident", "does not apply", "largest unless by design"]
    shown = table("What must not matter, and what breaks by design", [*heads, "deviation by design"], rows)
    line = "{check} | {measure} | {algorithm} | {deviation:.1e} | {reason}"
    bad = data[data["class"] == ACCIDENT]
    broken = (
        listing("Broken by accident", bad, "check | measure | algorithm | deviation | why", line, words=3)
        if len(bad)
        else ""
    )
    return joined(text, machine(shown), machine(broken) if broken else "")


def _check(own: pd.DataFrame) -> list[object]:
    """Counts of a check, its largest deviation, and that of each measure that breaks it by design."""
    counts = {name: int((own["class"] == name).sum()) for name in (DESIGN, ACCIDENT, APART)}
    largest = own[own["class"] != DESIGN]["deviation"].max()
    design = own[own["class"] == DESIGN].groupby("measure", sort=False)["deviation"].max()
    told = ", ".join(f"{code(name)} {digits(value, 2)}" for name, value in design.items())
    return [len(own), len(own) - sum(counts.values()), *counts.values(), scientific(largest), told or NOTHING]


def _random(store: Store) -> Part:
    """Requests that nobody has written down, what they broke, and how soon planted faults are seen."""
    cases, faults = store.table("fuzz"), store.table("fuzz_faults").fillna("")
    cases = cases.fillna(dict.fromkeys(("kind", "word", "law", "said", "about"), ""))
    counts = {name: int((cases["verdict"] == name).sum()) for name in ("agrees", "explained", "not compared", "broken")}
    alone = cases[cases["verdict"] == "not compared"]["word"]
    refused, solved = int((alone == "refused").sum()), int((alone == "converged").sum())
    own = cases[cases["verdict"] == "explained"]["said"].map(lambda text: re.split(r"[:,]", text)[0]).value_counts()
    why = f" ({', '.join(f'{count} {reason}' for reason, count in own.items())})" if len(own) else ""
    lost = int((faults["cases"] == 0).sum())
    text = prose(f"""## Random cases and planted faults

Scene, measure, algorithm, grid and settings are drawn at random, near their defaults and on the bounds of their
ranges. Every case must converge, be refused in one line or give a cause; a converged one is judged, and one law more is
drawn: another algorithm, solver or Newton iteration, more load steps, other units or axes, a part for the whole. Of
{len(cases)} cases {counts["agrees"]} satisfy their law to 1e-6, {counts["explained"]} differ for a computed
reason{why}, and in {counts["broken"]} a law is violated. {len(alone)} give nothing to compare: {refused} are refused
and {len(alone) - refused - solved} do not converge, with their cause, and {solved} converge where the other way does
not. {len(faults)} faults were planted one at a time; {lost} were not detected, the others by case
{number(float(faults["cases"].max()))} at the latest.""")
    broken = cases[cases["verdict"] == "broken"].assign(said=lambda rows: rows["said"].str.slice(0, 200))
    made = listing("Cases that violate a law", broken, "case | law | what is said", "{seed} | {law} | {said}", words=3)
    line = "{fault} | {law:said} | {found}"
    named = faults.assign(found=[number(float(n)) if n else "not detected" for n in faults["cases"]])
    return joined(
        text,
        machine(made, commands(broken["command"])) if len(broken) else "",
        listing("Planted faults", named, "fault | detected by | cases until detected", line, words=2),
    )


CHAPTER = Chapter(
    "invariance",
    "What must not matter",
    "rigid motions by measure, symmetries and units, random cases and planted faults.",
    invariance_page,
    needs=("rigid_body", "rigid_body_powers", "rotation_sweep", "symmetry"),
    always=True,
)

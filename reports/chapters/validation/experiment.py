"""The page of the experiment: forces computed beside measured, the difference split, and whether the test objects."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.chapter import Chapter
from reports.chapters.validation.law_part import law_part
from reports.figures.drawing import BLACK, COLOURS, canvas, looks, svg
from reports.formats import digits, fixed, percent, share
from reports.markdown import Part, commands, filled, joined, listing, picture, prose, table
from reports.store.tables import Store

PARTS = ("mesh", "shell", "law", "friction", "reading", "remainder")
BUDGETS = ("solid hencky", "shell exact", "shell von-karman", "shell exact, ν = 0", "shell von-karman, ν = 0")
DRAWN = (BUDGETS[1], BUDGETS[-1])
LAW = "solid hencky"


def experiment_page(store: Store) -> Part:
    """The whole page."""
    data = store.analysis("ring_budget")
    data["approach"] = 2 * data["delta_mm"]
    return joined(
        _introduction(data, store.analysis("ring_inputs")),
        picture("experiment.svg", "Forces over the approach, and two budgets of the difference", draw_budget(data)),
        _forces(data),
        _budgets(data),
        _reasons(data),
        _statements(data, store.analysis("ring_inputs")),
        _states(store.analysis("ring_states")),
        law_part(store),
        commands([*data["command"].drop_duplicates(), *store.analysis("ring_states")["command"].drop_duplicates()]),
    )


@svg
def draw_budget(data: pd.DataFrame) -> Figure:
    """Left: forces, measured dots and computed lines. Right: stacked parts with their signs, the dot is their sum."""
    figure, (forces, *budgets) = canvas(1 + len(DRAWN), width=13.0, height=5.0)
    names = list(dict.fromkeys(data["body"]))
    for name, look in looks(names).items():
        own = data[data["body"] == name]
        line = "-" if own["kind"].iloc[0] == "solid" else "--"
        forces.plot(own["approach"], own["force_N"], color=look.colour, linestyle=line, label=name)
    measured = data.drop_duplicates("approach")
    forces.plot(measured["approach"], measured["measured_N"], "o", color=BLACK, markersize=7, label="measured")
    forces.set(xlabel="approach of the plates [mm]", ylabel="force on half a plate [N]")
    forces.legend()
    ends = [_stacked(axes, data[data["body"] == name], name) for axes, name in zip(budgets, DRAWN, strict=True)]
    for axes in budgets:
        axes.set(ylim=(1.1 * min(low for low, _ in ends), 1.1 * max(high for _, high in ends)))
    budgets[-1].legend()
    return figure


def _stacked(axes: Axes, own: pd.DataFrame, name: str) -> tuple[float, float]:
    """Positive parts above zero and negative ones below; returns both ends."""
    places = np.arange(len(own))
    above, below = np.zeros(len(own)), np.zeros(len(own))
    for part, colour in zip(PARTS, COLOURS, strict=False):
        value = own[part].to_numpy()
        axes.bar(places, value, 0.6, bottom=np.where(value > 0, above, below), color=colour, label=part)
        above, below = above + np.maximum(value, 0), below + np.minimum(value, 0)
    axes.errorbar(
        places,
        own["difference_N"],
        own["u_val"],
        fmt="D",
        color=BLACK,
        capsize=4,
        label="computed less measured, ± u_val",
    )
    axes.axhline(0.0, color=BLACK, linewidth=0.8)
    axes.set_xticks(places, [f"{value:g}" for value in own["approach"]])
    axes.set(xlabel="approach of the plates [mm]", ylabel="parts of the difference [N]", title=name)
    return float(below.min()), float(above.max())


def _introduction(data: pd.DataFrame, inputs: pd.DataFrame) -> str:
    end = {str(row["body"]): row for row in data[data["delta_mm"] == data["delta_mm"].max()].to_dict("records")}
    thick, soft, shell = end[LAW], end["solid svk"], end["shell exact"]
    known = {str(key): float(value) for key, value in zip(inputs["input"], inputs["value"], strict=True)}
    outer, inner = known["outer_mm"], known["inner_mm"]
    return prose(f"""# An experiment

A polyurethane ring, outer radius {outer:g} mm, inner {inner:g} mm, E = {known["E_MPa"]:g} MPa, ν = {known["nu"]:g}, is
crushed between rigid plates by {thick["approach"]:g} mm (Saleeb, Chen, Chang 1994; read off their curve by Code_Aster,
SSNP501). The wall is {fixed(2 * (outer - inner) / (outer + inner), 2)} of its radius thick and its stretches reach from
{fixed(thick["least_stretch"], 2)} to {fixed(thick["largest_stretch"], 2)}: too thick for a shell and too strained for
its law, so that both show. The same ring is computed as a solid in plane strain with three laws and as a shell, whose
law is that of St. Venant and Kirchhoff (svk).

At the end the force is {fixed(thick["measured_N"], 3)} N. Hencky's solid has {fixed(thick["limit_N"], 2)} N in the
limit of its meshes, {percent(thick["limit_N"] / thick["measured_N"] - 1, 1)}; the svk solid
{fixed(soft["limit_N"], 2)} N, {percent(soft["limit_N"] / soft["measured_N"] - 1, 1)}; the shell of the exact measure
{fixed(shell["limit_N"], 2)} N, {percent(shell["limit_N"] / soft["limit_N"] - 1, 1)} against the solid of its own law.

The four readings are one: they lie on a line through the origin to their last digit, which no curve computed here does.
They give the slope of that line; the bend of the curve was not read.""")


def _forces(data: pd.DataFrame) -> str:
    """A line a body, a column an approach."""
    approaches = list(dict.fromkeys(data["approach"]))
    measured = data.drop_duplicates("approach")["measured_N"]
    lines = [["measured", "", *(fixed(value, 3) for value in measured), "", ""]]
    for body, own in data.groupby("body", sort=False):
        last = own.iloc[-1]
        lines.append([str(body), last["grid"], *(fixed(value, 3) for value in own["force_N"])])
        lines[-1] += [fixed(last["limit_N"], 3), fixed(last["order"], 1)]
    header = ["body", "mesh", *(f"{value:g} mm" for value in approaches), "limit at the end", "order"]
    words = prose("""## Forces

"ν = 0" is the other way to plane strain: E/(1 - ν²) and no contraction instead of sides that are held. A thin shell
has no such difference; here the wall's own normal strain makes one.""")
    return joined(words, table("Force on half a plate, 10 mm wide [N]", header, lines, 2)).text


def _budgets(data: pd.DataFrame) -> str:
    shown = data[data["body"].isin(BUDGETS)].sort_values(
        "body", key=lambda names: names.map(BUDGETS.index), kind="stable"
    )
    heads = "body | approach [mm] | computed - measured | " + " | ".join(PARTS)
    line = "{body} | {approach:g} | {difference_N:+.3f} | " + " | ".join(f"{{{part}:+.3f}}" for part in PARTS)
    words = prose("""## What the difference is made of

- mesh: the finest mesh less the limit of all four.
- shell: the limit of the shell less that of the solid of its law.
- law: the solid of the law less Hencky's.
- friction: what Code_Aster's force grows by from μ = 0 to 0.4, which is missing in all computations here: a bound.
- reading: how far Hencky's curve lies above its own chord, if a straight line was read of a curve.
- remainder: Hencky's solid less the test, without the two above.

The parts add up to the difference.""")
    return joined(words, listing("Computed less measured [N] and its parts", shown, heads, line)).text


def _reasons(data: pd.DataFrame) -> str:
    """Where another measure is nearer to the test than the exact one by a larger error of its own."""
    lines = filled(
        "- {body} at {approach:g} mm: {difference_N:+.2f} N off the test, {shell:+.2f} N off the solid of its law;"
        " this takes back {cancelled:.0%} of the law's part of {law:+.2f} N.",
        data[data["wrong_reason"]],
    )
    if not lines:
        nothing = "No measure is nearer to the test than the exact one by a larger error."
        return f"## Agreement by errors that cancel\n\n{nothing}"
    words = prose("""## Agreement by errors that cancel

A measure that is nearer to the test than the exact one, while farther from the solid of the law that both have, owes it
to two errors of opposite sign:""")
    return "\n\n".join([words, "\n".join(lines)])


def _statements(data: pd.DataFrame, inputs: pd.DataFrame) -> str:
    heads = "body | approach [mm] | E [N] | u_num | u_input | u_D | u_val | absolute E over u_val | E within u_val"
    line = "{body} | {approach:g} | {difference_N:+.3f} | {u_num:.3f} | {u_input:.3f} | {u_D:.3f} | {u_val:.3f} | "
    line += "{ratio:.1f} | {verdict}"
    rows = data.assign(
        ratio=data["difference_N"].abs() / data["u_val"], verdict=data["within"].map({True: "yes", False: "no"})
    )
    largest = inputs.groupby("input", sort=False)[["half", "relative"]].max().reset_index()
    counted = _counted(rows, rows["body"].drop_duplicates())
    words = prose(f"""## Is the difference within the uncertainties?

In the sense of ASME V&V 20: the comparison error E = S - D stands beside u_val = √(u_num² + u_input² + u_D²). u_num is
half of the uncertainty of the meshes' limit; u_input what half of the last digit of each datum changes, and friction up
to its bound; u_D {rows["read_to"].iloc[0]:g} N, a hundredth of the largest force, which is an assumption, and the bend
that was not read. All are standard uncertainties, limits ±a counting as a/√3. Within u_val the test cannot tell the
model's error from none.

{counted}""")
    effects = listing(
        "What the data are known to, and the standard uncertainty of the force by it (the largest of all approaches)",
        largest,
        "datum | half of its last digit | force",
        "{input:code} | {half:g} | {relative:.2%}",
    )
    return joined(words, listing("Statements", rows, heads, line), effects).text


def _counted(rows: pd.DataFrame, bodies: Iterable[str]) -> str:
    """In how many of its approaches each body is within."""
    found = [(body, rows[rows["body"] == body]) for body in bodies]
    told = [f"{body} in {int(own['within'].sum())} of {len(own)}" for body, own in found]
    return f"Within u_val: {', '.join(told)}."


def _states(states: pd.DataFrame) -> str:
    end = states[states["delta_mm"] == states["delta_mm"].max()]
    words = prose(f"""## Plane strain is part of the model

A ring as wide as the force is given for, 10 mm, with free sides, carries
{share(-float(end.loc[end["state"] == "3d", "off"].iloc[0]), 1)} less than plane strain and is all but in plane stress
({digits(float(end["force_N"].max() / end["force_N"].min() - 1) * 100, 2)} % between the two). The test agrees with
plane strain alone, so its force must be that of a ring much longer than its wall is thick, given by the width.""")
    heads, line = "state | mesh | approach [mm] | force [N] | against plane strain", ""
    line = "{state} | {mesh} | {approach:g} | {force_N:.3f} | {off:+.1%}"
    rows = states.assign(approach=2 * states["delta_mm"])
    return joined(words, listing("Hencky's solid in other states along its axis", rows, heads, line, words=2)).text


CHAPTER = Chapter(
    "experiment",
    "An experiment",
    "forces that were measured beside computed ones, the difference split into law, shell, mesh, friction and reading.",
    experiment_page,
    needs=("ring_budget", "ring_inputs", "ring_states", "law_offsets", "law_rules"),
    always=True,
)

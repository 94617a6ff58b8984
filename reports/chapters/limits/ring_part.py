"""Part of "When is a shell not enough": a measured ring, the difference split, and what small strain is worth."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, COLOURS, canvas, looks, svg
from reports.formats import digits, fixed, percent, share
from reports.markdown import Part, commands, filled, joined, listing, picture, prose
from reports.store.tables import Store

PARTS = ("mesh", "shell", "law", "friction", "reading", "remainder")
DRAWN = ("shell exact", "shell von-karman, ν = 0")
LAW = "solid hencky"


def ring_part(store: Store) -> Part:
    """Forces computed beside measured ones."""
    data, states = store.analysis("ring_budget"), store.analysis("ring_states")
    data["approach"] = 2 * data["delta_mm"]
    end = data[data["delta_mm"] == data["delta_mm"].max()]
    thick = end[end["body"] == LAW].iloc[0]
    widest = states[(states["state"] == "3d") & (states["delta_mm"] == states["delta_mm"].max())]["off"].iloc[0]
    known = {str(row["input"]): float(row["value"]) for row in store.analysis("ring_inputs").to_dict("records")}
    outer, inner = known["outer_mm"], known["inner_mm"]
    text = prose(f"""## A measured ring

A polyurethane ring, outer radius {outer:g} mm, inner {inner:g} mm, E = {known["E_MPa"]:g} MPa, ν = {known["nu"]:g},
crushed between rigid plates by {thick["approach"]:g} mm (Saleeb, Chen, Chang 1994; read by Code_Aster, SSNP501): its
wall is {fixed(2 * (outer - inner) / (outer + inner), 2)} of its radius thick, its stretches reach from
{fixed(thick["least_stretch"], 2)} to {fixed(thick["largest_stretch"], 2)}, too much for a shell and for its law (St.
Venant, Kirchhoff: svk). Solids and shells are in plane strain; "ν = 0" replaces it by E/(1 - ν²) without contraction.
The four readings lie on one line through the origin, so the bend of the curve was not read. A ring with free sides
carries {share(-float(widest), 0)} less than plane strain, which the test contradicts.""")
    parts = prose("""*Shell*: less the solid of its law; *law*: that solid less Hencky's; *friction*: what it may add,
missing here, a bound; *reading*: Hencky's curve above its chord; *remainder*: not explained. The parts add up to the
difference. Within u_val (ASME V&V 20: mesh, last digits of the data, friction, reading) the test cannot tell the error
of the model from none.""")
    counts = data.groupby("body", sort=False)["within"].agg(["sum", "size"]).reset_index()
    shown = end.merge(counts, on="body")
    heads = f"body | force [N] | computed - measured | {' | '.join(PARTS)} | u_val | within u_val, of its readings"
    line = f"{{body}} | {{force_N:.2f}} | {{difference_N:+.2f}} | {' | '.join(f'{{{part}:+.2f}}' for part in PARTS)}"
    measured = f"At {thick['approach']:g} mm, where {thick['measured_N']:.3f} N were measured [N]"
    return joined(
        text,
        picture("experiment.svg", "Forces over the approach, and two budgets of the difference", draw_budget(data)),
        listing(measured, shown, heads, line + " | {u_val:.2f} | {sum} of {size}"),
        parts,
        _cancelling(data, thick),
        commands(data["command"]),
    )


def _cancelling(data: pd.DataFrame, thick: pd.Series) -> str:
    """Agreement that is owed to errors of opposite sign."""
    lines = filled(
        "- {body} at {approach:g} mm: {difference_N:+.2f} N from the test, {shell:+.2f} N from the solid of its law,"
        " against {law:+.2f} N of the law.",
        data[data["wrong_reason"]],
    )
    if thick["friction"] * thick["remainder"] < 0:
        off = percent(thick["limit_N"] / thick["measured_N"] - 1, 1)
        lines = [
            f"- {LAW} at {thick['approach']:g} mm: {off} in the limit of its meshes, where {thick['friction']:+.2f} N "
            f"of friction are missing and {thick['remainder']:+.2f} N are not explained.",
            *lines,
        ]
    return "\n\n".join(["Agreement by errors that cancel:", "\n".join(lines)]) if lines else ""


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


def law_part(store: Store) -> Part:
    """Laws beside one another on bodies that carry in different ways."""
    rules = store.analysis("law_rules")
    worst = rules.groupby("carries")["factor"].max()
    membrane, bending = float(worst["membrane"]), float(worst["bending"])
    words = prose(f"""## What small strain in the law is worth

The law of a shell is linear in Green's strain. In {len(rules)} cases solids with it and with Hencky's law are compared
on one mesh: with the largest logarithmic strain e in the body the law changes the result by at most
{digits(membrane, 2)} e where a wall carries by stretching, and {digits(bending, 2)} e where it bends, so 1 % is not
exceeded below strains of {share(0.01 / membrane, 1)} and {share(0.01 / bending, 1)}.""")
    heads = "body | carries by | strains | largest change over the strain | 1 % at a strain of"
    line = "{specimen} | {carries} | {least_strain:.3f} … {largest_strain:.3f} | {factor:.2g} | {percent_at:.1%}"
    return joined(words, listing("From Hencky's law to that of the shell", rules, heads, line, words=2))

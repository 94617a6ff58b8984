"""Part of "When is a shell not enough": a measured ring, the difference split, and what small strain is worth."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, COLOURS, canvas, looks, svg
from reports.markdown import Part, commands
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("shell-limits")
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
    known = dict(store.analysis("ring_inputs")[["input", "value"]].to_numpy())
    outer, inner = known["outer_mm"], known["inner_mm"]
    counts = data.groupby("body", sort=False)["within"].agg(["sum", "size"]).reset_index()
    told = {
        **{
            "known": known,
            "thick": thick,
            "over_radius": 2 * (outer - inner) / (outer + inner),
            "less": -float(widest),
        },
        **{"bodies": end.merge(counts, on="body"), "cancelling": _cancelling(data, thick)},
        "commands": commands(data["command"]),
    }
    return TEXT("ring", {"experiment.svg": draw_budget(data)}, **told)


def _cancelling(data: pd.DataFrame, thick: pd.Series) -> Part:
    """Agreement that is owed to errors of opposite sign."""
    others = data[data["wrong_reason"]]
    cancels = thick["friction"] * thick["remainder"] < 0
    first = [{**thick, "off": thick["limit_N"] / thick["measured_N"] - 1}] if cancels else []
    return TEXT("cancelling", thick=first, others=others) if first or len(others) else Part()


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
    worst = {str(kind): float(factor) for kind, factor in rules.groupby("carries")["factor"].max().items()}
    strains = {"stretched": 0.01 / worst["membrane"], "bent": 0.01 / worst["bending"]}
    return TEXT("law", cases=len(rules), **worst, **strains, rules=rules)

"""The page of derivatives: what settings do to the tyre of the paper, what rounding explains, and a design by them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.chapter import chapter
from reports.figures.drawing import BLACK, VERMILION, canvas, shades, svg
from reports.figures.result_figures import tornado
from reports.formats import quantity
from reports.markdown import Part, Template, commands
from reports.store import Store

TEXT = Template("what-if")
DRAWN = ("force_N", "centre_pressure_MPa")
PAIR, GOAL = ("gamma_deg", "p0_MPa"), "mean_pressure_MPa"
ENDS = {"low": "min", "high": "max"}
COMMANDS = (
    "footprint run what-if --store store  # the three tables of this page",
    "footprint solve tyre --set delta_mm=20 --set rim=pressure --gradient force_N --gradient half_length_mm --out out",
    "footprint sweep tyre --set delta_mm=20 --over gamma_deg=40:56:17 --over p0_MPa=0.1:0.26:17 --mesh 28x26 --out all",
)
KEPT = ("inflated_equator_outer_mm", "force_N")


def what_if_page(store: Store) -> Part:
    """The whole page."""
    derivatives, asked, every = (store.table(name) for name in ("what_if", "even_footprint", "every_footprint"))
    early, late = derivatives["delta_mm"].min(), derivatives["delta_mm"].max()
    meshes = list(dict.fromkeys(derivatives["mesh"]))
    own = derivatives[(derivatives["delta_mm"] == late) & (derivatives["mesh"] == meshes[-1])]
    drawn = {"what-if.svg": tornado(own[own["quantity"].isin(DRAWN)], f"{late:g} mm")}
    values = {"meshes": " and ".join(meshes), "early": early, "late": late, **_sums(own), **_rounded(own)}
    values |= {"rows": list(_rates(derivatives)), "growth": own.loc[own["quantity"] == KEPT[0], "value"].iloc[0]}
    drawn["even-footprint.svg"] = design(every, asked)
    return TEXT("page", drawn, **values, **_designed(asked, every), commands=commands(COMMANDS))


def _rates(derivatives: pd.DataFrame) -> Iterator[dict[str, str]]:
    """A row a setting, the strongest first: what it does on the finer mesh, and by how much that differs from the
    coarser one, by quantity and travel.
    """
    keys = ["setting", "quantity", "delta_mm"]
    both = derivatives.fillna({"relative": 0.0}).groupby(keys, sort=False)["relative"]
    rates = pd.DataFrame({"last": both.last(), "apart": (both.last() - both.first()).abs()})
    late = derivatives["delta_mm"].max()
    order = rates["last"].xs(("force_N", late), level=("quantity", "delta_mm")).abs()
    for setting in order.sort_values(ascending=False).index:
        own = rates.loc[setting]
        row = {"setting": str(setting)}
        for (name, at), rate in own.iterrows():
            row[f"{name}_{'late' if at == late else 'early'}"] = f"{rate['last']:+.2f} ± {rate['apart']:.2f}"
        yield row


def _sums(own: pd.DataFrame) -> dict[str, float]:
    """What the force changes by when all that has the dimension of a stress is scaled, or all lengths."""
    force = own[own["quantity"] == "force_N"].set_index("setting")["relative"]
    moduli = [key for key in force.index if key.endswith("_MPa")]
    lengths = [key for key in force.index if key.endswith("_mm")]
    return {"moduli": float(force[moduli].sum()), "lengths": float(force[lengths].sum())}


def _rounded(own: pd.DataFrame) -> dict[str, Any]:
    """A row a setting, and the sums."""
    by = own.pivot(index="setting", columns="quantity", values="rounding")
    by = by.join(own.drop_duplicates("setting").set_index("setting")[["printed", "half_a_unit"]])
    by = by.sort_values("force_N", ascending=False)
    worst = {"force": "force_N", "centre": "centre_pressure_MPa", "length": "half_length_mm"}
    sums = {f"{word}_worst": float(by[name].sum()) for word, name in worst.items()}
    return {"roundings": by.reset_index().to_dict("records"), **sums}


def _designed(asked: pd.DataFrame, every: pd.DataFrame) -> dict[str, Any]:
    """The optima by mesh, and the best of all combinations on the first mesh."""
    optima = list(_optima(asked))
    limits = asked[[f"least_{name}" for name in KEPT]].iloc[0].tolist()
    allowed = every[_allowed(every, limits)]
    best = allowed.sort_values(GOAL).iloc[0]
    ends = {f"{key.split('_')[0]}_{end}": getattr(every[key], how)() for key in PAIR for end, how in ENDS.items()}
    spread = pd.DataFrame(optima)[["gamma_deg", GOAL]]
    apart = {
        "angle_apart": float(np.ptp(spread["gamma_deg"])),
        "goal_apart": float(np.ptp(spread[GOAL]) / spread[GOAL].min()),
    }
    values = {"members": len(every), "allowed": len(allowed), "best": best.to_dict(), "first": optima[0]["mesh"]}
    above = best[GOAL] / optima[0][GOAL] - 1
    return {**ends, **values, **apart, "optima": optima, "above": above, "travel": asked["delta_mm"].iloc[0]} | {
        "force": limits[1],
        "shrinks": -limits[0],
    }


def _optima(asked: pd.DataFrame) -> Iterator[dict[str, Any]]:
    for _, own in asked.groupby("mesh", sort=False):
        for row in own[own["optimum"].astype(bool)].to_dict("records"):
            yield {**{str(key): value for key, value in row.items()}, "answers": len(own)}


def _allowed(every: pd.DataFrame, limits: list[float]) -> pd.Series:
    """Which of the combinations keep what is to be kept."""
    return (every["verdict"] == "converged") & (every[KEPT[0]] >= limits[0]) & (every[KEPT[1]] >= limits[1])


@svg
def design(every: pd.DataFrame, asked: pd.DataFrame) -> Figure:
    """The goal over both settings, white where it is not allowed; the answers that the optimiser asked for, in turn."""
    figure, (axes,) = canvas(width=7.5, height=5.2)
    limits = [asked[f"least_{name}"].iloc[0] for name in KEPT]
    shape = every.pivot(index=PAIR[1], columns=PAIR[0], values=GOAL)
    colours = axes.contourf(shape.columns, shape.index, shape.to_numpy(), levels=12, cmap=shades("viridis"))
    figure.colorbar(colours, ax=axes, label=quantity(GOAL))
    for name, least, style in zip(KEPT, limits, ("--", "-."), strict=True):
        kept = every.pivot(index=PAIR[1], columns=PAIR[0], values=name)
        axes.contour(kept.columns, kept.index, kept.to_numpy(), levels=[least], colors=BLACK, linestyles=style)
        axes.plot([], [], style, color=BLACK, label=f"{quantity(name)} = {least:g}")
    own = asked[asked["mesh"] == asked["mesh"].iloc[0]]
    axes.plot(*own[[*PAIR]].to_numpy().T, "o-", color=VERMILION, label="path of the optimiser, from the paper's tyre")
    axes.set(xlabel=quantity(PAIR[0]), ylabel=quantity(PAIR[1]))
    axes.grid(visible=False)
    figure.legend(loc="outside upper center", ncols=2)
    return figure


CHAPTER = chapter(TEXT, what_if_page, needs=("what_if", "even_footprint", "every_footprint"))

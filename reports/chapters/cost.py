"""The page of cost: what a smaller model and a better grid save, and what one Newton step costs.

And the page of other programs: the same problems solved by them, from our decks or their own, values and times.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from reports.chapter import chapter
from reports.chapters.tyre import DELTA
from reports.figures.drawing import BLACK, BLUE, VERMILION, canvas, legend_above, lines, looks, svg, ticks
from reports.formats import NOTHING, bound, scientific, share
from reports.markdown import Part, Template, commands
from reports.store import Store

STATEMENTS = "footprint run statements"
DEAR = 1.5  # times the least cost: what advice aims to stay below
LEAST = 1e-5  # below it an error is chance


TEXT = Template("cost")


def cost_page(store: Store) -> Part:
    """The whole page."""
    needed, grids = store.table("grids_reaching"), store.table("work_precision")
    errors = list(dict.fromkeys(needed["within"]))
    values = {"delta": DELTA, "rules": store.rules(), **_models(store), **_precision(needed, grids.iloc[0], errors)}
    parts = {"statements": statements_part(store), "advice": advice_part(store)}
    return TEXT("page", {"cost-precision.svg": precision(grids, errors)}, **values, **parts)


def _models(store: Store) -> dict[str, Any]:
    """Parts of the tyre beside the whole."""
    models, same_at = store.table("tyre_models"), store.rules()["same_model"]

    def off(value: float) -> str:
        return f"under {scientific(same_at, 0)}" if value <= same_at else scientific(value)

    models = models.assign(**{name: models[name].map(off) for name in ("force_off", "pressure_off")})
    records = [{**row, **store.cell(row["label"]).result["counters"]} for row in models.to_dict("records")]
    parts = models[models["model"] != "full"]
    counts = {"parts": len(parts), "same": parts["same"].sum(), "mesh": models["mesh"].iloc[0]}
    return {"models": records, **counts, "commands": commands(models["command"])}


def _precision(needed: pd.DataFrame, against: pd.Series, errors: list[float]) -> dict[str, Any]:
    """Force against unknowns on tensor grids and on locally refined ones."""
    unsure = [bound(error) for error in errors if error < against["known"]]
    doubt = TEXT("doubt", errors=" or ".join(unsure)) if unsure else Part()
    rows = {"needed": needed, "reached": needed[needed["unknowns"].notna()]}
    return {"against": against, "asked": " and ".join(map(bound, errors)), "doubt": doubt, **rows}


@svg
def precision(data: pd.DataFrame, errors: Sequence[float]) -> Figure:
    """Error of the force over the unknowns, a panel an element, a colour a family of grids.

    A line is the largest error of a grid and all finer ones of its family. Dotted lines at ``errors``; grey where the
    reference is not known.
    """
    elements = data.groupby("element", sort=False)
    drawn = looks(data["family"])
    figure, panels = canvas(len(elements), width=10.0, height=4.2, sharey=True)
    for axes, (element, own) in zip(panels, elements, strict=True):
        for family, grids in own.sort_values("unknowns").groupby("family", sort=False):
            error = grids["error"].abs().clip(lower=LEAST).to_numpy(float)
            worst, look = np.maximum.accumulate(error[::-1])[::-1], drawn[family]
            axes.step(grids["unknowns"], worst, where="post", linewidth=1.1, **look.dashes)
            axes.plot(grids["unknowns"], error, linestyle="none", markersize=4.5, **look.points)
            axes.plot([], [], label=family, **look.whole)
        for level in errors:
            axes.axhline(level, color=BLACK, linewidth=1, linestyle=":")
        axes.axhspan(LEAST / 2, own["known"].iloc[0], color=BLACK, alpha=0.08, linewidth=0)
        axes.set(title=f"element {element}", xlabel="unknowns", xscale="log", yscale="log", ylim=(LEAST / 2, None))
        axes.tick_params(axis="x", which="minor", labelbottom=False)
    panels[0].set_ylabel("relative error of the force")
    legend_above(figure, panels[0], columns=5)
    return figure


def statements_part(store: Store) -> Part:
    """Does what ``--error`` states hold, how wide is it, what does it cost? No campaign measures it by itself."""
    if not (store.has("error_coverage") and store.has("error_statements")):
        return Part()
    data, stated = store.table("error_coverage"), store.table("stated_errors")
    statements = store.table("error_statements")
    rows = {
        "errors": statements[statements["asked"].notna()],
        "wrong": stated[stated["value_inside"].eq(False) | stated["inside"].eq(False)],
        "missed": data[data["reached"].eq(False)],
    }
    drawn = {"cost-statements.svg": errors_stated(stated)}
    values = {
        "rules": store.rules(),
        "whole": statements[statements["asked"].isna()].iloc[0],
        "commands": commands([STATEMENTS]),
    }
    return TEXT("statements", drawn, **values, **rows)


@svg
def errors_stated(data: pd.DataFrame) -> Figure:
    """What each decided error is over the most that is stated of it; on the line both are the same."""
    decided = data[data["value_decided"].eq(True)]
    figure, (axes,) = canvas(1, width=6.0, height=5.0)
    for asked, each in looks(sorted(map(float, decided["asked"].unique()), reverse=True)).items():
        own = decided[decided["asked"] == asked]
        axes.plot(own["high"], own["value_error"], linestyle="none", label=share(asked, 1), **each.points)
    ends = np.array([decided["high"].min(), decided["high"].max()]) if len(decided) else np.ones(2)
    axes.plot(ends, ends, color=BLACK, linewidth=1, linestyle=":")
    axes.set(xscale="log", yscale="log", xlabel="stated upper bound", ylabel="relative error")
    legend_above(figure, axes)
    return figure


def advice_part(store: Store) -> Part:
    """Scenes that were left out, one after the other; nothing where a campaign has too few."""
    cases, headline = store.rows("held_out"), store.rows("held_out_summary", quantities="headline")
    if cases.empty or headline.empty:
        return Part()
    missed = cases[(cases["advised"] != "") & (cases["met"] == 0.0)]
    drawn = {"advice-held-out.svg": held_out(cases)}
    return TEXT("advice", drawn, **headline.iloc[0], missed=missed)


@svg
def held_out(cases: pd.DataFrame) -> Figure:
    """Advice for scenes left out: true error over tolerance, and how often the regret is below a value."""
    given = cases[cases["advised"] != ""]
    figure, (left, right) = canvas(2, width=10.0, height=4.0)
    for tolerance in sorted(set(given["tolerance"].astype(float))):
        own = given[given["tolerance"] == tolerance]
        own = own.assign(ratio=(own["true_error"] / tolerance).clip(lower=1e-3)).sort_values("ratio")
        ratio = own["ratio"].to_numpy(float)
        apart = 100 * tolerance * (1 + 0.4 * np.linspace(-0.5, 0.5, len(own)))  # beside one another, by size
        for far, colour, marker in ((False, BLUE, "o"), (True, VERMILION, "s")):
            shown = (ratio > 1) == far
            left.scatter(apart[shown], ratio[shown], s=16, color=colour, marker=marker, linewidths=0)
    left.axhline(1.0, color=BLACK, linewidth=1, linestyle=":")
    left.set(xscale="log", yscale="log", xlabel="tolerance [%]", ylabel="true error over tolerance")
    left.scatter([], [], s=16, color=BLUE, marker="o", label="tolerance met")
    left.scatter([], [], s=16, color=VERMILION, marker="s", label="tolerance missed")
    ticks(left, sorted(set(100 * given["tolerance"])))
    _regret(right, np.sort(given["regret"].dropna().to_numpy(float)))
    left.legend(loc="lower left", fontsize=8)
    return figure


def _regret(axes: Axes, regret: np.ndarray) -> None:
    """How often the cost of the advice is at most a multiple of the least one."""
    if len(regret):
        share = np.arange(1, len(regret) + 1) / len(regret)
        axes.step([*regret, max(10.0, 1.2 * regret[-1])], [*share, 1.0], where="post", color=BLUE)
        below = float((regret <= DEAR).mean())
        axes.plot([DEAR, DEAR, axes.get_xlim()[0]], [0, below, below], color=BLACK, linewidth=1, linestyle=":")
        axes.annotate(
            f"{100 * below:.0f} % of the cases cost\nat most {DEAR:g} times the best",
            (0.97, 0.3),
            xycoords="axes fraction",
            ha="right",
            fontsize=9,
        )
    axes.set(xscale="log", xlabel="cost of the advice over that of the best", ylabel="share of cases", ylim=(0, 1.03))
    ticks(axes, (0.5, 1, 2, 5, 10, 20, 50, 100))
    low, high = (min(0.9, regret[0]), 1.2 * regret[-1]) if len(regret) else (0.9, 10.0)
    axes.set_xlim(low, max(high, 10.0))
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))


CHAPTER = chapter(TEXT, cost_page, needs=("rules", "work_precision", "grids_reaching", "tyre_models"), always=True)


OURS = "footprint"
MEASURED = "footprint bench peers --table .footprint/store/tables/peers.csv"
DECKS = "footprint bench programs --store .footprint/store"
WHY = {"mesh": "mesh", "plies": "one direction of plies a brick", "open": "open"}  # reasons, as the table has them


def _why(value: object) -> str:
    return WHY.get(str(value), NOTHING)


BESIDE = Template("programs", why=_why)


def programs_page(store: Store) -> Part:
    """The whole page: of the tables that were made, which take those programs."""
    return BESIDE("page", peers=_peers(store), programs=_programs(store))


def _peers(store: Store) -> Part:
    """Work to an equal error beside NGSolve and Kratos; nothing where they were not run."""
    if not (store.has("peers") and store.has("peer_factors")):
        return Part()
    data, factors = store.table("peers"), store.table("peer_factors")
    linear = data["linear"].astype(bool)
    others = factors[~factors["problem"].isin(data["problem"][linear])]
    drawn = {"cost-peers.svg": work_precision(data[~linear])}
    beside = BESIDE("linear", rows=list(_beside(data[linear]))) if linear.any() else Part()
    return BESIDE("peers", drawn, factors=others, linear=beside, commands=commands([MEASURED]))


def _beside(linear: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """A line a problem and mesh with the errors of both programs."""
    for (problem, mesh), own in linear.groupby(["problem", "mesh"], sort=False):
        errors = dict(zip(own["program"], own["error"], strict=True))
        known = {"problem": problem, "mesh": mesh, "uncertainty": own["uncertainty"].iloc[0]}
        yield known | {"ours": errors[OURS], "theirs": errors["kratos"]}


@svg
def work_precision(data: pd.DataFrame) -> Figure:
    """Error over units, a panel a problem; dotted what is asked for, grey below what the reference is known to."""
    groups = data.groupby("problem", sort=False)
    figure, panels = canvas(len(groups), columns=2, width=11.0, height=4.6)
    for axes, (problem, own) in zip(panels, groups, strict=True):
        own = own.assign(error=own["error"].abs().clip(lower=LEAST))
        named = own.groupby(["program", "family"], sort=False)
        lines(axes, {", ".join(map(str, key)): (each["units"], each["error"]) for key, each in named})
        axes.axhline(own["within"].iloc[0], color=BLACK, linewidth=1, linestyle=":")
        axes.axhspan(LEAST / 2, max(own["uncertainty"].iloc[0], LEAST / 2), color=BLACK, alpha=0.08, linewidth=0)
        axes.set(title=str(problem), xlabel="processor time [factorisations of 9840 unknowns]", ylabel="relative error")
        axes.set(xscale="log", yscale="log", ylim=(LEAST / 2, None))
        axes.legend(fontsize="small")
    return figure


def _programs(store: Store) -> Part:
    """Scenes in other programs from our decks, without an edit; nothing where they were not run."""
    if not (store.has("programs") and store.has("program_agreement")):
        return Part()
    return BESIDE("programs", finest=store.table("program_agreement"), commands=commands([DECKS]))


PROGRAMS = chapter(BESIDE, programs_page, needs=("programs", "program_agreement"))

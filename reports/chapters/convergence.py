"""The page of verification: limits against references by family, orders, manufactured solutions, options, locking."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.chapter import chapter
from reports.chapters.locking import distortion_part, locking_part
from reports.chapters.measures import options_part
from reports.figures.drawing import BLACK, canvas, legend_above, lines, svg, ticks
from reports.formats import NOTHING, fixed, quantity, share
from reports.markdown import Part, Template, commands, joined
from reports.store import Store

TEXT = Template("convergence")
DEFAULT = "refined"  # the element of the page
KINDS = ("exact", "computed", "printed", "read")  # of references; the first there is stands in the table
SHARES = ("projected", "balanced", "nodal")  # of the thickness strain that is taken from the nodes: none, half, all
EQUILIBRIUM = 1e-8  # relative residual that passes without a look at rounding
HEMISPHERE = {"mixed": "hemisphere one step mixed", "plain": "hemisphere twenty steps plain"}  # labels of cells
COMMANDS = ("footprint run truth", "footprint solve manufactured --measure sanders --mesh 32x32")
NORMS = ("displacement", "resultants", "mean_resultants", "energy")
OF_MEASURES = {"exact": "exact", "linear": "linear"}  # kinds; the others are nonlinear approximations
OTHER = "nonlinear approximations"
DRAWN = ("torus", "refined")  # surface and element of the picture


def convergence_page(store: Store) -> Part:
    """The whole page."""
    data = sequences(store)
    parts = {
        "manufactured": manufactured_part(store),
        "elements": elements_part(store),
        "options": options_part(store),
        "locking": locking_part(store),
        "distortion": distortion_part(store),
        "commands": commands(data.drop_duplicates("family", keep="last")["command"]),
    }
    limits = {**_families(store, data), **_unsteady(data)}
    values = {"rules": store.rules(), "summary": store.table("convergence_summary"), "kinds": ", ".join(KINDS)}
    return TEXT("page", **values, **limits, **parts, **_certificates(store), **_newton(store))


def sequences(store: Store) -> pd.DataFrame:
    """The ladders of the default element, a row a mesh."""
    data = store.table("convergence")
    return data[(data["element"] == DEFAULT) & (data["ladder"] != "")]


def _families(store: Store, data: pd.DataFrame) -> dict[str, Any]:
    """A table a family of scenes, and what does not agree."""
    errors = store.table("convergence_errors")
    other = errors[errors["sequence"].isin(data["sequence"]) & errors["kind"].isin(KINDS)]
    ranked = other.assign(rank=other["kind"].map(KINDS.index)).sort_values(["rank", "uncertainty"], kind="stable")
    by = {row["sequence"]: row for row in ranked.drop_duplicates("sequence").to_dict("records")}
    finest = data.drop_duplicates("sequence", keep="last")
    families = (
        TEXT("family", family=str(family).capitalize(), rows=_limits(finest[finest["family"] == family], by))
        for family in dict.fromkeys(data["family"])
    )
    beyond = other[other["verdict"].str.startswith("beyond")]
    counts = {"differ": len(beyond), "compared": int(other["model_part"].notna().sum())}
    return {"families": joined(*families), "beyond": beyond, **counts}


def _limits(finest: pd.DataFrame, references: dict[Any, dict[Any, Any]]) -> Iterator[dict[Any, Any]]:
    """The row of the finest mesh of each sequence, with the reference that it is held against."""
    for row in finest.to_dict("records"):
        known = references.get(row["sequence"], {"kind": "", "model_part": None})
        sure = f"{known['value']:g} ± {share(known['uncertainty'])}" if "value" in known else NOTHING
        order = fixed(row["order"], 2) if row["asymptotic"] else f"({fixed(row['order'], 2)})"
        within = abs(row["uncertainty"] / row["limit"])
        held = {"reference": sure, "kind": known["kind"], "model_part": known["model_part"]}
        yield {**row, "order": order, "within": within, **held}


def _unsteady(data: pd.DataFrame) -> dict[str, Any]:
    """Why sequences are not asymptotic, by cause."""
    own = data[~data["asymptotic"].astype(bool)].drop_duplicates("sequence")
    causes = own["cause"].where(own["cause"] != "", "the cause is not known")
    named = own["ladder"] + own["quantity"].map(lambda name: f" ({quantity(name)})")
    rows = [{"cause": cause, "names": ", ".join(names)} for cause, names in named.groupby(causes, sort=False)]
    return {"causes": rows, "unsteady": len(own), "sequences": data["sequence"].nunique()}


def elements_part(store: Store) -> Part:
    """Which option of the element, over all scenes, as advice."""
    choice, shares = store.table("element_choice"), store.table("thickness_share")
    nearer = int((choice["default"].abs() < choice["paper"].abs()).sum())
    counts = choice["verdict"].value_counts()
    better, equal, larger = (counts.get(verdict, 0) for verdict in ("better", "equal", "worse"))
    values = {"count": len(choice), "better": better, "equal": equal, "larger": larger, "nearer": nearer}
    rows = {
        "worse": choice[choice["verdict"] == "worse"],
        "shares": [counted(shares, n) for n in SHARES],
    }
    return TEXT("elements", rules=store.rules(), scenes=shares["ladder"].nunique(), **values, **rows)


def counted(verdicts: pd.DataFrame, name: str) -> dict[str, Any]:
    """Of a share: on the coarser and on the default mesh, in how many scenes it is best and alone best; early ends."""
    counts: dict[str, Any] = {"share": name}
    for mesh, coarse in (("coarse", True), ("fine", False)):
        own = verdicts[(verdicts["coarse"].astype(bool) == coarse) & verdicts["nearest"].astype(bool)]
        best = own.groupby("ladder")["share"].agg(set)
        counts |= {mesh: sum(name in names for names in best), f"{mesh}_alone": sum(names == {name} for names in best)}
    wrong = verdicts[verdicts["confirmed"].eq(False) & (verdicts["share"] == name)]["ladder"]
    return {**counts, "wrong": len(wrong), "wrong_in": ", ".join(wrong) or "none"}


def _certificates(store: Store) -> dict[str, Any]:
    """How many reported states, of this page and all others, the judge certifies."""
    steps = [(cell.scene, step) for cell in store.cells for step in cell.steps]
    failed = {scene: step["failures"] for scene, step in steps if step["failures"]}
    lost = sum(bool(step["failures"]) for _, step in steps)
    rounded = sum(step["kkt"]["equilibrium"] > EQUILIBRIUM for _, step in steps)
    uncertified = ""
    if failed:
        names = dict.fromkeys(name for _, step in steps for name in step["failures"])
        uncertified = f"Not certified, for {', '.join(names)}: states of {', '.join(failed)}."
    counts = {"states": len(steps), "certified": len(steps) - lost, "rounded": rounded}
    return {**counts, "equilibrium": EQUILIBRIUM, "uncertified": uncertified}


def _newton(store: Store) -> dict[str, Any]:
    """Iterations to the hemisphere's whole load by mixed Newton in one step, and by plain Newton in twenty."""
    iterations = {}
    for newton, label in HEMISPHERE.items():
        cell = store.cell(label)
        iterations[newton] = cell.result["counters"]["newton_iterations"] if cell.converged else NOTHING
    return {**iterations, "steps": cell.settings["steps"]}


def manufactured_part(store: Store) -> Part:
    """The whole section."""
    orders, rules, data = store.table("manufactured_orders"), store.rules(), store.table("manufactured")
    far = len(orders[~orders["near"]])
    values = {
        "count": len(orders),
        "far": f"{far} lie" if far else "none lies",
        "coarse": orders["coarse"].astype(bool).sum(),
        "rising": orders["rising"].astype(bool).sum(),
        "below": rules["theory_mean_resultants"] - rules["coarse_below"],
        "finest": orders["n"].max(),
        "statements": _statements(store),
        "spans": list(_spans(orders)),
    }
    surface, element = DRAWN
    own = data[(data["group"] == "measures") & (data["surface"] == surface) & (data["element"] == element)]
    drawn = {"manufactured.svg": errors(own)}
    return TEXT("manufactured", drawn, rules=rules, **values, **_contact(store), commands=commands(COMMANDS))


def _statements(store: Store) -> Part:
    """Are the tables of the measures what these state?"""
    data = store.table("manufactured_statements")
    wrong = data[data["wrong"].notna()]
    if wrong.empty:
        return TEXT("coefficients-kept", judged=data["measure"].nunique())
    return TEXT("coefficients-wrong", rows=wrong)


def _spans(fitted: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """The lowest and the highest order in each norm, by element and kind of measure."""
    kinds = fitted["measure"].map(OF_MEASURES).fillna(OTHER)
    for (element, kind), own in fitted.groupby(["element", kinds], sort=False):
        orders = {norm: own[f"order_{norm}"] for norm in NORMS}
        spans = {norm: f"{fixed(order.min(), 2)} to {fixed(order.max(), 2)}" for norm, order in orders.items()}
        yield {"element": element, "kind": kind, "cases": len(own), **spans}


def _contact(store: Store) -> dict[str, Any]:
    """Orders of displacement, pressure and edge with contact, and how far the edge is off."""
    orders, data = store.table("manufactured_contact_orders"), store.table("manufactured_contact")
    spans = {name: orders[f"order_{name}"] for name in ("displacement", "pressure", "edge")}
    away, unsolved = orders["edge_elements"], data[~data["class"].isin(("converged", "unstable"))]["measure"]
    return {
        "measures": orders["measure"].nunique(),
        "unsolved": unsolved.nunique() or "none",
        "touching": len(orders),
        "of": {n: f"{fixed(s.median(), 1)} ({fixed(s.min(), 1)} to {fixed(s.max(), 1)})" for n, s in spans.items()},
        "least": orders.sort_values("order_displacement").iloc[0],
        "nearest": away.min(),
        "farthest": away.max(),
    }


@svg
def errors(data: pd.DataFrame) -> Figure:
    """Errors of the displacement and of the resultants over the number of elements, with the slopes of theory."""
    figure, panels = canvas(2, width=9.0, height=4.4)
    for axes, norm, slope in zip(panels, ("displacement", "resultants"), (2, 1), strict=True):
        own = {m: (g["n"], g[f"error_{norm}"]) for m, g in data.groupby("measure", sort=False)}
        lines(axes, own)
        _finished(axes, data, norm, slope)
    legend_above(figure, panels[0], columns=5)
    return figure


def _finished(axes: Axes, data: pd.DataFrame, norm: str, slope: int) -> None:
    """Logarithmic axes, and a line of the slope below the curves."""
    n = np.array(sorted(data["n"].unique()), float)
    first = data[data["n"] == n[0]][f"error_{norm}"].min()
    axes.plot(n, 0.5 * first * (n[0] / n) ** slope, color=BLACK, linewidth=1, linestyle=":")
    axes.set(xscale="log", yscale="log", xlabel="elements along a side", title=f"error: {norm}; dotted: order {slope}")
    ticks(axes, n)


CHAPTER = chapter(
    TEXT,
    convergence_page,
    needs=(
        *("rules", "convergence", "convergence_errors", "convergence_summary", "element_choice", "thickness_share"),
        *("manufactured", "manufactured_contact", "manufactured_statements"),
        *("thickness_locking", "shear_locking", "curved_beam", "membrane_locking"),
        *("distortion", "distorted_shells", "distortion_orders"),
    ),
    always=True,
)

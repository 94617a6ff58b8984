"""The page of symmetry and invariance: what must not change an answer, and what each pair makes of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.chapter import Chapter
from reports.drawing import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, canvas, looks, svg
from reports.formats import code, fixed, scientific
from reports.markdown import Part, commands, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

LOOKS: dict[str, dict[str, Any]] = {  # of the classes
    "exactly zero": {"color": BLUE, "marker": "o"},
    "rounding": {"color": SKY, "marker": "o"},
    "solver tolerance": {"color": GREEN, "marker": "^"},
    "broken by design": {"color": ORANGE, "marker": "s"},
    "broken by accident": {"color": VERMILION, "marker": "X"},
    "does not apply": {"color": PURPLE, "marker": "|"},
}
ZERO = 1e-17  # where an exact zero is drawn
INTRODUCTION = prose("""# Symmetry

An answer must not depend on the order of the nodes, on which coordinate is called the first, on the units, on the
number of load steps, or on where in space the body is. Each check compares two answers that ought to be one, or an
answer with its own image. The deviation is the largest difference of pressures over the peak, or of displacements over
the largest, whichever is more. It belongs to one of five classes: *exactly zero*; *rounding*, below what machine
precision explains of a nodal pressure; *solver tolerance*, below what the residual tolerance of Newton's iteration
allows; *broken by design*, where a measure or a structure declares that it must be; and *broken by accident*, which is
a failure. What is declared to be broken and is not is an accident, too, and so is an answer that does not pass the
judge of contact.""")
ACCIDENT, DESIGN = "broken by accident", "broken by design"
PRINTED_ANGLE, PRINTED_MESH, PRINTED_MEASURE = 52.0, "42x40", "exact"


def symmetry_page(store: Store) -> Part:
    """The whole page."""
    return joined(INTRODUCTION, _overview(store), _design(store), _pairs(store), _mirror(store))


def accidents(store: Store) -> tuple[int, int]:
    """How many checks are broken by accident, and of how many."""
    data = store.table("symmetry")
    return int((data["class"] == ACCIDENT).sum()), len(data)


def _overview(store: Store) -> Part:
    """One row a check."""
    data = store.table("symmetry")
    rows = []
    for check, own in data.groupby("check", sort=False):
        counts = own["class"].value_counts().reindex(list(LOOKS), fill_value=0)
        largest = own[own["class"] != DESIGN]["deviation"].max()
        rows.append([check, *counts, scientific(largest), scientific(own["rounding"].median())])
    wrong, whole = accidents(store)
    measures, algorithms = data["measure"].nunique(), data["algorithm"].nunique()
    designed = data[data["class"] == DESIGN]
    again = data[data["class"].isin(("rounding", "solver tolerance", "exactly zero"))]
    worst = again.iloc[int((again["deviation"] / again["tolerance"]).argmax())]
    nearest = prose(f"""What is not broken comes nearest to the tolerance of the solver in *{worst["check"]}* by
`{worst["measure"]}` and `{worst["algorithm"]}`, with {scientific(worst["deviation"])} where
{scientific(worst["tolerance"])} is allowed.""")
    text = prose(f"""## What holds

{measures} measures by {algorithms} contact algorithms: {whole} checks, of which {wrong} are broken by accident and
{len(designed)} by design. Panels are small laminated shells, clamped all around, under a load
and pressed by a plane or a ball; the tyre is that of the paper on a coarse mesh, the whole of it. Algorithms keep their
own defaults, in the units of the problem.""")
    header = ["check", *LOOKS, "largest unless by design", "rounding explains"]
    grid = table("Checks by class: number of pairs of measure and algorithm", header, rows)
    words = "Deviation of every pair of measure and algorithm, by check, coloured by class"
    shown = picture("symmetry-deviations.svg", words, deviations(data))
    caption = prose("""A point is a pair of a measure and an algorithm; the grey bar ends where rounding does, in the
median. Exact zeros are drawn at the left edge.""")
    heads = "check | measure | algorithm | deviation | why"
    line = "{check} | {measure} | {algorithm} | {deviation:.1e} | {reason}"
    bad = data[data["class"] == ACCIDENT]
    broken = listing("Broken by accident", bad, heads, line, words=3) if len(bad) else ""
    return joined(text, machine(grid, nearest), shown, caption, broken)


def _design(store: Store) -> Part:
    """What is broken by design, with the reason."""
    data = store.table("symmetry")
    own = data[data["class"] == DESIGN]
    each = own.groupby(["check", "reason", "measure"])["deviation"].agg(["min", "max"]).reset_index()
    heads = "check | measure | reason | smallest | largest"
    line = "{check} | `{measure}` | {reason} | {min:.4g} | {max:.4g}"
    text = prose("""## What is broken by design

A measure that strains under a rigid motion says so in its declared law, and a structure without a mirror plane has no
mirrored answer. Such deviations are demanded: one that were missing would be an accident. They do not depend on the
algorithm, so the smallest and the largest of all algorithms are given.""")
    return joined(text, listing("Deviations that must be there", each, heads, line, words=3))


def _pairs(store: Store) -> Part:
    """Measures by algorithms: the largest deviation that is not by design."""
    data = store.table("symmetry")
    healthy = data[data["class"] != DESIGN]
    ratio = (healthy["deviation"] / healthy["tolerance"]).groupby([healthy["measure"], healthy["algorithm"]]).max()
    measures, algorithms = data["measure"].unique(), data["algorithm"].unique()
    grid = ratio.unstack().reindex(index=measures, columns=algorithms)
    rows = [[code(measure), *map(scientific, line)] for measure, line in zip(measures, grid.to_numpy(), strict=True)]
    text = prose("""## Measure by algorithm

The largest deviation of each pair over all checks that are not broken by design, over what the tolerance of the solver
allows: below 1 nothing is broken.""")
    title = "Largest deviation over the tolerance of the solver"
    return joined(text, machine(table(title, ["measure", *map(code, algorithms)], rows)))


def _mirror(store: Store) -> Part:
    """The mirror asymmetry over gamma, with the printed value."""
    every = store.table("mirror")
    data = every.dropna(subset=["mirror_both_MPa"])
    symmetry = store.analysis("tyre_symmetry")
    mirrors = symmetry[(symmetry["who"] == "printed") & symmetry["image"].str.startswith("mirror")]
    told = float(mirrors["both_touch_MPa"].max())
    sweeps = {
        f"{measure}, {mesh}": group.sort_values("gamma_deg")
        for (mesh, measure), group in data.groupby(["mesh", "measure"], sort=False)
    }
    own = f"{PRINTED_MEASURE}, {PRINTED_MESH}"
    one = sweeps[own]
    here = one[one["gamma_deg"] == PRINTED_ANGLE]
    top = _top(one)
    zeros = float(data[data["gamma_deg"].isin((0.0, 90.0))]["mirror_MPa"].max())
    unstable = one[one["negative"] > 0]["gamma_deg"]
    shaky = f"{', '.join(f'{angle:.3g}°' for angle in unstable)}" if len(unstable) else "none of the angles"
    rows = []
    for name, sweep in sweeps.items():
        at = (sweep[sweep["gamma_deg"] == gamma]["mirror_both_MPa"] for gamma in (0.0, PRINTED_ANGLE, 90.0))
        zero, middle, right = (float(value.iloc[0]) if len(value) else None for value in at)
        best, (measure, _, mesh) = _top(sweep), name.partition(", ")
        planned = every[(every["measure"] == measure) & (every["mesh"] == mesh) & (every["kind"] == "grid")]
        stable = int(((planned["negative"] == 0) & planned["mirror_MPa"].notna()).sum())
        line = [f"{float(sweep['delta_mm'].iloc[0]):g}", scientific(zero), fixed(middle, 4), scientific(right)]
        line += [fixed(float(best["mirror_both_MPa"]), 4), fixed(float(best["gamma_deg"]), 1)]
        rows.append([code(measure), mesh, *line, f"{stable} of {len(planned)}"])
    text = prose(f"""## Mirror asymmetry over the cord angle

Plies at ±γ leave a half turn about the contact normal, but no mirror plane, except at 0 and 90 degrees, where the
largest difference over all measures and meshes is {scientific(zeros)} MPa. At {PRINTED_ANGLE:g}° and
{float(one["delta_mm"].iloc[0]):g} mm the printed table differs from its mirror image by {fixed(told, 3)} MPa where both
nodes touch; ours, on the paper's mesh, by {fixed(float(here["mirror_both_MPa"].iloc[0]), 3)} MPa, and by
{fixed(float(here["mirror_MPa"].iloc[0]), 3)} MPa when a node that does not touch counts as zero. The largest among
stable states is {fixed(float(top["mirror_both_MPa"]), 3)} MPa at {fixed(float(top["gamma_deg"]), 1)}°, found by a
search in one dimension around the largest value of the grid.

Not all angles make a stable tyre: on the paper's mesh the tangent has negative eigenvalues at {shaky}. There several
states satisfy all conditions, which of them is found is a matter of the steps, and their asymmetry says little; they
are drawn with open marks and left out of the maximum.""")
    header = ["measure", "mesh", "travel [mm]", "at 0°", f"at {PRINTED_ANGLE:g}°", "at 90°"]
    header += ["largest stable", "at [deg]", "angles stable"]
    grid = table("Largest difference of the pressure from a mirror image, both touching [MPa]", header, rows, words=2)
    words = "Mirror asymmetry of the pressure over the cord angle, with the printed value at 52 degrees"
    shown = picture("symmetry-mirror.svg", words, mirror(sweeps, own, (PRINTED_ANGLE, told)))
    return joined(text, grid, shown, commands([str(top["command"]), str(here["command"].iloc[0])]))


def _top(sweep: pd.DataFrame) -> pd.Series:
    """The row of the largest asymmetry of a stable state, of any state where none is stable."""
    stable = sweep[sweep["negative"] == 0]
    return (stable if len(stable) else sweep).sort_values("mirror_both_MPa").iloc[-1]


@svg
def deviations(table: pd.DataFrame) -> Figure:
    """All measures and algorithms as points, a row a check; the grey bar is what rounding explains."""
    checks = list(dict.fromkeys(table["check"]))
    rng = np.random.default_rng(0)
    figure, (axes,) = canvas(width=9.0, height=0.36 * len(checks) + 1.7)
    for row, check in enumerate(checks):
        rounding = table[table["check"] == check]["rounding"].median()
        axes.barh(row, rounding, left=ZERO / 3, height=0.72, color="#DDDDDD", zorder=0)
    for name, look in LOOKS.items():
        own = table[table["class"] == name].dropna(subset=["deviation"])
        if len(own):
            places = own["check"].map(checks.index).to_numpy() + rng.uniform(-0.25, 0.25, len(own))
            axes.scatter(np.maximum(own["deviation"], ZERO), places, s=16, label=name, linewidths=0.8, **look)
    axes.set(xscale="log", xlim=(ZERO / 3, 2.0), xlabel="largest deviation over the largest value [-]")
    axes.set_yticks(range(len(checks)), checks)
    axes.invert_yaxis()
    figure.legend(loc="outside upper center", ncols=4)
    return figure


@svg
def mirror(sweeps: Mapping[str, pd.DataFrame], own: str, printed: tuple[float, float]) -> Figure:
    """Over the cord angle: the sweep ``own`` beside the printed table, and every measure on a coarse mesh.

    Full marks are stable states, open ones have negative eigenvalues; printed: angle [deg] and asymmetry [MPa].
    """
    figure, (left, right) = canvas(2, width=9.0, height=4.6)
    _curve(left, sweeps[own], {"color": BLUE, "marker": "o"}, "ours")
    left.plot(printed[0], 1e3 * printed[1], color=VERMILION, marker="D", linestyle="none", label="printed")
    left.plot([], [], color=BLACK, marker="o", fillstyle="none", linestyle="none", label="not stable")
    left.set_title(own)
    left.legend(loc="upper center")
    others = {name.partition(", ")[::2]: sweep for name, sweep in sweeps.items() if name != own}
    drawn = looks(measure for measure, _ in others)
    for (measure, mesh), sweep in others.items():
        _curve(right, sweep, drawn[measure].points, measure)
        right.set_title(f"all measures, {mesh}")
    right.legend(fontsize=8)
    for axes in (left, right):
        axes.set(xlabel="cord angle γ [deg]", ylabel="largest difference from a mirror image [10⁻³ MPa]")
        axes.set(xlim=(-2, 92), ylim=(0, None), xticks=range(0, 91, 15))
    return figure


def _curve(axes: Axes, sweep: pd.DataFrame, look: Mapping[str, Any], label: str) -> None:
    angle, value, stable = sweep["gamma_deg"], 1e3 * sweep["mirror_both_MPa"], sweep["negative"] == 0
    axes.plot(angle, value, color=look["color"], linewidth=0.8, alpha=0.5)
    axes.plot(angle[stable], value[stable], linestyle="none", label=label, markersize=4, **look)
    axes.plot(angle[~stable], value[~stable], linestyle="none", fillstyle="none", markersize=4, **look)


CHAPTER = Chapter(
    "symmetry",
    "Symmetry",
    "axes, numbering, units, load steps and rigid motions, which must not matter, and the mirrored tyre.",
    symmetry_page,
    needs=("symmetry", "mirror", "tyre_symmetry"),
    always=True,
)

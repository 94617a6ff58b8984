"""The page of symmetry and invariance: what must not change an answer, and what each pair makes of it."""

from __future__ import annotations

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.limits.figures_symmetry import LOOKS, deviations, mirror
from reports.formats import code, fixed, scientific
from reports.markdown import Part, commands, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

INTRODUCTION = prose("""# Symmetry

An answer must not depend on the order of the nodes, on which coordinate is called the first, on the units, on the
number of load steps, or on where in space the body is. Each check compares two answers that ought to be one, or an
answer with its own image. The deviation is the largest difference of pressures over the peak, or of displacements over
the largest, whichever is more. It belongs to one of these classes:""")
CLASSES = (
    ("exactly zero", "not a digit differs"),
    ("rounding", "below what machine precision explains of a nodal pressure"),
    ("solver tolerance", "below what the residual tolerance of Newton's iteration allows"),
    ("broken by design", "a measure or a structure declares that it must deviate, and it does"),
    ("broken by accident", "a failure: anything more, a declared deviation that is missing, an answer not certified"),
    ("does not apply", "the algorithm refuses the problem, or there is nothing to compare"),
)
ACCIDENT, DESIGN = "broken by accident", "broken by design"
PRINTED_ANGLE, PRINTED_MESH, PRINTED_MEASURE = 52.0, "42x40", "exact"


def symmetry_page(store: Store) -> Part:
    """The whole page."""
    classes = table("Classes of deviations", ["class", "what belongs to it"], CLASSES, words=2)
    return joined(INTRODUCTION, classes, _overview(store), _design(store), _pairs(store), _mirror(store))


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

A measure that strains under a rigid motion declares that as a law, and a structure without a mirror plane has no
mirrored answer. The checks require such a deviation, and its absence would count as a failure. It does not depend on
the algorithm, so the smallest and the largest of all algorithms are given.""")
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
    tables: dict[str, list[list[str]]] = {}
    for name, sweep in sweeps.items():
        at = (sweep[sweep["gamma_deg"] == gamma]["mirror_both_MPa"] for gamma in (0.0, PRINTED_ANGLE, 90.0))
        zero, middle, right = (float(value.iloc[0]) if len(value) else None for value in at)
        best, (measure, _, mesh) = _top(sweep), name.partition(", ")
        planned = every[(every["measure"] == measure) & (every["mesh"] == mesh) & (every["kind"] == "grid")]
        stable = int(((planned["negative"] == 0) & planned["mirror_MPa"].notna()).sum())
        line = [scientific(zero), fixed(middle, 4), scientific(right)]
        line += [fixed(float(best["mirror_both_MPa"]), 4), fixed(float(best["gamma_deg"]), 1)]
        where = f"mesh {mesh}, travel {float(sweep['delta_mm'].iloc[0]):g} mm"
        tables.setdefault(where, []).append([code(measure), *line, f"{stable} of {len(planned)}"])
    text = prose(f"""## Mirror asymmetry over the cord angle

Plies at ±γ leave a half turn about the contact normal, but no mirror plane, except at 0 and 90 degrees, where the
largest difference over all measures and meshes is {scientific(zeros)} MPa. At {PRINTED_ANGLE:g}° and
{float(one["delta_mm"].iloc[0]):g} mm the printed table differs from its mirror image by {fixed(told, 3)} MPa where both
nodes touch; ours, on the paper's mesh, by {fixed(float(here["mirror_both_MPa"].iloc[0]), 3)} MPa, and by
{fixed(float(here["mirror_MPa"].iloc[0]), 3)} MPa when a node that does not touch counts as zero. The largest among
stable states is {fixed(float(top["mirror_both_MPa"]), 3)} MPa at {fixed(float(top["gamma_deg"]), 1)}°, found by a
search in one dimension around the largest value of the grid.

Not all angles make a stable tyre: on the paper's mesh the tangent has negative eigenvalues at {shaky}. There several
states satisfy all conditions, which of them is found is a matter of the steps, and their asymmetry means little; they
are drawn with open marks and left out of the maximum. Other meshes and travels have tables of their own: a difference
between those is not one of the measures.""")
    header = ["measure", "at 0°", f"at {PRINTED_ANGLE:g}°", "at 90°", "largest stable", "at [deg]", "angles stable"]
    title = "Largest difference of the pressure from a mirror image, both touching [MPa]"
    grids = [table(f"{title}, {where}", header, rows) for where, rows in tables.items()]
    words = "Mirror asymmetry of the pressure over the cord angle, with the printed value at 52 degrees"
    shown = picture("symmetry-mirror.svg", words, mirror(sweeps, own, (PRINTED_ANGLE, told)))
    return joined(text, *grids, shown, commands([str(top["command"]), str(here["command"].iloc[0])]))


def _top(sweep: pd.DataFrame) -> pd.Series:
    """The row of the largest asymmetry of a stable state, of any state where none is stable."""
    stable = sweep[sweep["negative"] == 0]
    return (stable if len(stable) else sweep).sort_values("mirror_both_MPa").iloc[-1]


CHAPTER = Chapter(
    "symmetry",
    "Symmetry",
    "axes, numbering, units, load steps and rigid motions, which must not matter, and the mirrored tyre.",
    symmetry_page,
    needs=("symmetry", "mirror", "tyre_symmetry"),
    always=True,
)

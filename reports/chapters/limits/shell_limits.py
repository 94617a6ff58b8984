"""The page "When is a shell not enough": from which thickness on, in which scene, why, and beside a measured ring."""

from __future__ import annotations

import math

import pandas as pd
from matplotlib.figure import Figure

from reports.chapter import Chapter
from reports.chapters.limits.ring_part import law_part, ring_part
from reports.figures.drawing import BLACK, canvas, looks, svg
from reports.formats import digits, scientific, share
from reports.markdown import Part, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

DEFAULT = "default"
PASSED = {"boundary_1": 0.01, "boundary_5": 0.05}
SMALLEST = 1e-5  # of an error that is drawn


def limits_page(store: Store) -> Part:
    """The whole page."""
    found = store.analysis("shell_boundaries")
    usual = found[(found["variant"] == DEFAULT) & found["headline"]]
    points = store.table("shell_limits")
    drawn = picture("shell-limits.svg", "Error of the shell over its thickness, a line a scene", errors(points, usual))
    return joined(
        _opening(usual),
        drawn,
        _boundaries(usual),
        _costs(usual),
        _known(found),
        _options(found),
        law_part(store),
        ring_part(store),
    )


def _opening(usual: pd.DataFrame) -> str:
    """What was compared, and what the sentence above leaves out."""
    far = usual[usual["boundary_5"] < math.inf]
    never = usual[usual["boundary_1"] == math.inf]["case"]
    rest = f"; within what was solved the error stays below 1 % in: {', '.join(never)}" if len(never) else ""
    return prose(f"""# {CHAPTER.title}

The same body as a shell and as a solid of quadratic hexahedra, with the same St. Venant-Kirchhoff law, supports and
loads; linear but for the three with contact. Both are extrapolated over their meshes, so that what is left is the
error of the model. It exceeds 5 % in {len(far)} of {len(usual)} scenes{rest}. h is the thickness, R the radius of the
middle surface (of the tyre's tube inside), L the length of the cantilever, a the span of the plate and half of that of
the strip. The shell has the section constant-s33, no shear correction, and the pressure on its true face.""")


@svg
def errors(points: pd.DataFrame, usual: pd.DataFrame) -> Figure:
    """|error| over thickness, both logarithmic, with the levels of 1 and 5 per cent."""
    figure, (axes,) = canvas(width=8.5, height=5.5)
    chosen = points[points["variant"] == DEFAULT].merge(usual[["case", "quantity"]])
    for name, look in looks(usual["case"]).items():
        own = chosen[(chosen["case"] == name) & (chosen["error"].abs() > chosen["known_to"])]
        axes.loglog(own["ratio"], own["error"].abs(), **look.points, linestyle=look.line, label=name)
    for level in PASSED.values():
        axes.axhline(level, color=BLACK, linewidth=0.8, linestyle="--")
        axes.annotate(
            share(level, 0),
            (1.0, level),
            xycoords=("axes fraction", "data"),
            xytext=(3, -3),
            textcoords="offset points",
        )
    axes.set(xlabel="thickness over radius or span [-]", ylabel="error of the shell [-]", ylim=(SMALLEST, 1.0))
    figure.legend(loc="outside upper center", ncols=3)
    return figure


def _boundaries(usual: pd.DataFrame) -> Part:
    heads = "scene | quantity | thickness | 1 % at | 5 % at | grows as h to the | judged by | known to"
    heads += " | unknowns of the solid over the shell's | what the kinematics lack"
    line = "{case} | {quantity} | {thickness} | {boundary_1} | {boundary_5} | {order:.1f} | {judge} | {known_to:.2%}"
    line += " | {unknowns_ratio:.1f} | {fails}"
    text = prose("""## From which thickness on

*Known to*: what the finest meshes leave, at the worst thickness. An error of a displacement or strain that is linear
through the wall grows with h², one of the load or a support with h. A dash in the order: fewer than three errors differ
from zero for certain, or they change their sign, and the boundary is later than either of two errors alone would have
it. Unknowns are those of meshes equally good.""")
    return joined(text, listing("Boundaries of the usual shell", _worded(usual), heads, line, words=3))


def _worded(rows: pd.DataFrame) -> pd.DataFrame:
    """Boundaries as words: not passed, passed from the thinnest on, or the thickness."""
    shown = rows.copy()
    for name in PASSED:
        shown[name] = [_boundary(at, row) for at, row in zip(rows[name], rows.to_dict("records"), strict=True)]
    return shown


def _boundary(at: float, row: dict) -> str:
    if at == math.inf:
        return f"not up to {row['thickest']:g}"
    return f"below {row['thinnest']:g}" if at == 0 else digits(at, 2)


def _options(found: pd.DataFrame) -> Part:
    """The same boundary with other options of the shell."""
    own = found[found["headline"] & ~found["variant"].str.startswith("solid")]
    variants = [name for name in dict.fromkeys(own["variant"]) if name != DEFAULT]
    rows = []
    for case, of_case in own.groupby("case", sort=False):
        by = {row["variant"]: _boundary(row["boundary_1"], row) for row in of_case.to_dict("records")}
        rows.append([str(case), *(by.get(name, "–") for name in (DEFAULT, *variants))])
    text = prose("""## What the options of the shell change

*Full-3d* locks in bending at any thickness. *Nonsymmetric* leaves the pressure out of the tangential law, an error
with h under pressure. The *shear correction* of Reissner is right where a homogeneous wall bends, and not enough for
plies. A dash: the option has no effect there, or was not tried.""")
    return joined(text, table("1 % is passed at, by option", ["scene", "usual", *variants], rows))


def _costs(usual: pd.DataFrame) -> Part:
    """Seconds, which are of the machine."""
    times = usual["seconds_ratio"]
    text = prose(f"""On meshes equally good, the coarsest ones within 0.5 % of their own limit, the solid takes
{times.min():.0f} to {times.max():.0f} times the seconds of the shell, {times.median():.0f} times in the median of
{times.count()} scenes.""")
    return Part(machine(text))


def _known(found: pd.DataFrame) -> Part:
    """The solid against closed forms."""
    exact = found[(found["judge"] == "closed form") & (found["variant"] == DEFAULT) & found["headline"]]
    worst = exact.sort_values("solid_off").iloc[-1]
    doubtful = found[~found["decided"].astype(bool) & (found["variant"] == DEFAULT)]
    told = ", ".join(f"{row['case']}, {row['quantity']}" for row in doubtful.to_dict("records")) or "none"
    return Part(
        prose(f"""From h/R = 0.01 on the solid is within {scientific(float(worst["solid_off"]))} of the closed form in
all {len(exact)} scenes that have one (Lamé, Golovin, Michell, Pagano), worst in the {worst["case"]}. Not decided by
the meshes, because a neighbouring point is too near the level: {told}.""")
    )


CHAPTER = Chapter(
    "shell-limits",
    "When is a shell not enough",
    "from which thickness on, scene by scene, what a solid costs, the law at large strains, and a measured ring.",
    limits_page,
    needs=("shell_limits", "shell_boundaries", "ring_budget", "ring_inputs", "ring_states", "law_rules"),
    always=True,
)

"""The page "When is a shell not enough": from which thickness on, in which scene, why, and what a solid costs."""

from __future__ import annotations

import math

import pandas as pd
from matplotlib.figure import Figure

from reports.chapter import Chapter
from reports.figures.drawing import BLACK, canvas, looks, svg
from reports.formats import digits, scientific, share
from reports.markdown import Part, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

DEFAULT = "default"
PASSED = {"boundary_1": 0.01, "boundary_5": 0.05}
SMALLEST = 1e-5  # of an error that is drawn
SHOWN = 0.1  # thickness at which an error is taken apart


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
        _why(usual, store.analysis("shell_parts")),
        _options(found),
        _costs(usual),
        _known(found),
    )


def _opening(usual: pd.DataFrame) -> str:
    """What was compared, and what the sentence above leaves out."""
    far = usual[usual["boundary_5"] < math.inf]
    never = usual[usual["boundary_1"] == math.inf]["case"]
    rest = f", 1 % within what was solved not in {', '.join(never)}" if len(never) else ""
    return prose(f"""# When is a shell not enough

The same body as a shell and as a solid of quadratic hexahedra, with the same St. Venant-Kirchhoff law, supports and
loads; linear but for the three with contact. Where elasticity has a closed form, it is the judge and the solid
stands beside it. Both are extrapolated over their meshes first, so that what is left is the model. 5 % of error are
passed in {len(far)} of {len(usual)} scenes{rest}. h is the thickness,
R the radius of the middle surface (of the tyre's tube inside), L the length of the cantilever, a the span of the plate
and half of that of the strip. The shell has the section constant-s33, no shear correction, and the pressure on the area
of its true face.""")


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
    heads = "scene | quantity | thickness | 1 % at | 5 % at | error grows as h to the | judge | known to"
    line = "{case} | {quantity} | {thickness} | {boundary_1} | {boundary_5} | {order:.1f} | {judge} | {known_to:.2%}"
    text = prose("""## From which thickness on

Between the thicknesses that were solved the error is interpolated as a power of h. *Known to*: what the finest meshes
leave, at the worst thickness; the picture leaves out errors smaller than that. A dash in the order: fewer than three
errors differ from zero for certain, or they change their sign: then two errors partly cancel, and the boundary is later
than either alone would have it.""")
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


def _why(usual: pd.DataFrame, parts: pd.DataFrame) -> Part:
    text = prose("""## Which part of the kinematics fails

An error of a displacement or of a strain that is linear through the wall grows with h², as the terms do that it leaves
out. One that grows with h is of the load or of a support: a pressure on the area of the middle surface instead of the
face's, or a clamp.""")
    listed = "\n".join(f"- *{row['case']}*: {row['fails']}." for row in usual.to_dict("records"))
    told = prose("""Under pressure the error can be taken apart: a solid whose displacement is held linear through the
wall has the shell's displacement and nothing else of it. The shell full-3d has that and the same law; what it is off
beyond is due to its strain, linear between the faces, and its area, constant through the wall.""")
    heads = "scene | h/R | usual shell | shell, full-3d | solid, displacement linear through the wall | strain and area"
    line = "{case} | {ratio:g} | {usual:+.2%} | {full_3d:+.2%} | {straight:+.2%} | {through_wall:+.2%}"
    shown = parts[(parts["ratio"] - SHOWN).abs() < 1e-9]
    return joined(text, listed, told, listing("Errors of the growth and their parts", shown, heads, line))


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
    heads = "scene | unknowns of the shell | of the solid | ratio"
    line = "{case} | {shell_unknowns:.0f} | {solid_unknowns:.0f} | {unknowns_ratio:.1f}"
    of_time = "{case} | {seconds_ratio:.0f}"
    text = prose("""## What the solid costs

Both on the coarsest mesh that is within 0.5 % of its own limit; medians over the thicknesses at which both have one.
Tube, bar, rings, strip and cantilever are solved as one line of elements and torus and wall as one sector; where two
directions count, as in roof, plate and tyre, the ratio is that of a structure.""")
    times = listing("Seconds of the solid over those of the shell", usual, "scene | seconds, ratio", of_time)
    return joined(text, listing("Unknowns of meshes equally good", usual, heads, line), machine(times))


def _known(found: pd.DataFrame) -> Part:
    """The solid against closed forms."""
    exact = found[(found["judge"] == "closed form") & (found["variant"] == DEFAULT) & found["headline"]]
    worst = exact.sort_values("solid_off").iloc[-1]
    doubtful = found[~found["decided"].astype(bool) & (found["variant"] == DEFAULT)]
    told = ", ".join(f"{row['case']}, {row['quantity']}" for row in doubtful.to_dict("records")) or "none"
    return joined(
        prose(f"""## How well this is known

From h/R = 0.01 on the solid is within {scientific(float(worst["solid_off"]))} of the closed form in all {len(exact)}
scenes that have one (the most in: {worst["case"]}). These are the solutions of Lamé, Golovin,
Michell and Pagano. Scenes whose boundary the meshes do not decide, because a neighbouring point is too near the level:
{told}.""")
    )


CHAPTER = Chapter(
    "shell-limits",
    "When is a shell not enough",
    "from which thickness on, scene by scene, which part of the kinematics fails, and what a solid costs.",
    limits_page,
    needs=("shell_limits", "shell_boundaries", "shell_parts"),
    always=True,
)

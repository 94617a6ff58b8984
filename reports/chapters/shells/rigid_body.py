"""The page of rigid motions: what every measure leaves, its declared law beside it, rates, and a full turn."""

from __future__ import annotations

import math
from collections.abc import Iterator
from textwrap import wrap

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reports.chapter import Chapter
from reports.figures.drawing import BLACK, canvas, looks, svg
from reports.formats import NOTHING, code, fixed, scientific
from reports.markdown import Part, folded, joined, listing, picture, prose, table
from reports.store.tables import Store

INTRODUCTION = prose("""# Rigid motions

A rigid motion strains nothing. Whether a measure has that property is decided by its formulas alone: no mesh and no
element is on this page. The exact displacements of a small piece of a shell, moved as a whole, are sent through the
displacement gradients of each measure, and whatever strain comes out is the measure's own. Every measure declares what
it leaves as a closed form; a Donnell measure that passed would be as wrong as an exact one that failed.""")
NOTHING_LEFT = 1e-12  # a strain below this is rounding
MOTIONS = ("translation", "out of plane", "drilling", "about the axis")
SAME = 1e-9  # measures this close all the way share a curve
WIDTH = 63  # letters in a line of a panel's legend, its comma included


def rigid_body_page(store: Store) -> Part:
    """The whole page."""
    successive = [_successive(store)] if store.has_table("rotations") else []  # older stores have none
    points = joined(INTRODUCTION, _overview(store), *_rates(store), _donnell(store), _turn(store))
    return joined(points, *successive, _everything(store))


def _overview(store: Store) -> Part:
    """Which measure keeps which motion free of strain."""
    data = store.table("rigid_body")
    rows, free = [], []
    for name, own in data.groupby("measure", sort=False):
        told = own.dropna(subset=["declared"])
        largest = own.groupby("motion")["largest"].max().reindex(MOTIONS)
        strained = [motion for motion in MOTIONS if largest[motion] >= NOTHING_LEFT]
        if not strained:
            free.append(code(name))
        said = f"strains under {', '.join(strained)}" if strained else "free of strain"
        rows.append([name, said, *map(_size, largest), f"{len(told)} of {len(own)}", scientific(_miss(told))])
    theta, slide = float(data["theta_rad"].max()), float(data["slide"].max())
    text = prose(f"""## Which measure is free of strain under which motion

{len(free)} of {len(rows)} measures leave no strain under any of the motions: {", ".join(free) or "none"}.

The largest of all eleven strains at the sample point of any of the four surfaces (plate, cylinder, sphere, torus),
after a translation by {slide:g} of the size of the sample along x and after rotations by {theta:g} rad: *out of plane*
about the tangent e2, *drilling* about the normal e3, *about the axis* about z, which is the axis of revolution of the
curved surfaces and the normal of the plate. 0 is less than {NOTHING_LEFT:g}. The last columns say for how many of the
cases a law is declared, and how far the measured strain is from it at most. Laws are those of a membrane strain: a
measure that corrects its membrane strains alone still shows here what its linear shears and its linear E33 leave.""")
    header = ["measure", "in words", *MOTIONS, "laws", "off the law by at most"]
    return joined(text, table("Largest strain left by rigid motions [-]", header, rows, words=2))


def _miss(told: pd.DataFrame) -> float:
    """The largest distance from a declared law."""
    return float((told["strain"] - told["declared"]).abs().max())


def _size(value: float) -> str:
    return "0" if abs(value) < NOTHING_LEFT else f"{value:.3g}"


def _strain(value: float) -> str:
    if math.isnan(value):
        return NOTHING
    return "0" if abs(value) < NOTHING_LEFT else f"{value + 0.0:.6e}"


def _rates(store: Store) -> tuple[str, ...]:
    """Leading terms of the strains under small motions, by surface."""
    found = store.analysis("rigid_body_powers")
    surfaces = list(dict.fromkeys(found["surface"]))
    rows = []
    for (measure, motion), group in found.groupby(["measure", "motion"], sort=False):
        if group["strain_rate"].notna().any():
            cells = group.set_index("surface")
            rows.append([measure, motion, *(_power(cells.loc[surface], "strain") for surface in surfaces)])
    both = found.dropna(subset=["strain_rate", "declared_rate"])
    rate = float((both["strain_rate"] - both["declared_rate"]).abs().max())
    coefficient = float((both["strain_coefficient"] / both["declared_coefficient"] - 1).abs().max())
    text = prose(f"""## Rates: how the strain begins

Under small motions the strain begins as c aⁿ, a being the angle in rad or the share of the size of the sample. Rate
and coefficient are fitted to motions that halve. A linear measure makes the error -θ²/2 in any rotation; half the
square of the rotation, where a measure adds it, leaves -θ⁴/8, less by the factor θ²/4. Laws that are declared begin
with the same rates and coefficients: over {len(both)} cases fitted rates differ by at most {scientific(rate)},
coefficients by {scientific(coefficient)} of their value. Motions that leave nothing on any surface have no row.""")
    header = ["measure", "motion", *surfaces]
    kinds = "Leading term of the strain E11 or E22 on the outer face, fitted"
    return text, table(kinds, header, rows, words=2), _karman(store)


def _power(row: pd.Series, name: str) -> str:
    rate, coefficient = row[f"{name}_rate"], row[f"{name}_coefficient"]
    return "0" if math.isnan(rate) else f"{fixed(coefficient, 4)} a^{fixed(rate, 2)}"


def _karman(store: Store) -> str:
    """The fourth power, number by number."""
    data = _case(store.table("small_motions"), "von-karman", "plate", "out of plane")
    heads = "θ [rad] | measured | declared, -(1 - cos θ)²/2 | -θ⁴/8 | measured over -θ⁴/8"
    line = "{amount:g} | {strain:strain} | {declared:strain} | {leading:strain} | {over:.5f}"
    leading = -(data["amount"] ** 4) / 8
    told = data.assign(leading=leading, over=data["strain"] / leading)
    return listing("Von Kármán's plate turned out of its plane", told, heads, line, strain=_strain)


def _case(data: pd.DataFrame, measure: str, surface: str, motion: str) -> pd.DataFrame:
    return data[(data["measure"] == measure) & (data["surface"] == surface) & (data["motion"] == motion)]


def _donnell(store: Store) -> Part:
    """The translation of a cylinder, for teaching."""
    heads = "U over the size of the sample | E22, outer face | declared | largest of all strains"
    line = "{amount:g} | {strain:strain} | {declared:strain} | {largest:strain}"
    data, found = store.table("small_motions"), store.analysis("rigid_body_powers")
    cylinder, plate = (_case(found, "donnell", name, "translation").iloc[0] for name in ("cylinder", "plate"))
    text = prose(f"""## Why Donnell's measure fails

Move a cylinder of radius R as a whole by U along x. At the angle φ from x the frame of the shell sees the components
v3 = U cos φ along its normal and v2 = -U sin φ along its circumference. Both change along the circumference, though
nothing is deformed: it is the frame that turns, by one radian for every radian of arc. The rotation of the normal is
therefore the sum of two terms,

θ2 = -v3,φ/R + v2/R = U sin φ/R - U sin φ/R = 0,

and they cancel. Donnell's shallow-shell theory keeps the first term only, as if the frame did not turn, so the
translated cylinder seems to have the slope U sin φ/R. The slope enters twice. Squared and halved it is a membrane
strain, (U sin φ/R)²/(2 ζ²) on a face stretched by ζ = 1 + d/R: fitted rate {fixed(cylinder["strain_rate"], 2)},
coefficient {fixed(cylinder["strain_coefficient"], 4)}, declared {fixed(cylinder["declared_coefficient"], 4)}. To the
first power it is a transverse shear, since the director has not moved: the largest strain falls with the rate
{fixed(cylinder["largest_rate"], 2)} only. On a plate the frame does not turn and Donnell leaves
{_power(plate, "largest")}.

The theory was made for shells that buckle in many small waves, where v3,φ is much larger than v2; it must not be used
where a shell moves far compared with its buckles.""")
    moved = _case(data, "donnell", "cylinder", "translation")
    return joined(text, listing("Donnell's cylinder, translated", moved, heads, line, strain=_strain))


def _turn(store: Store) -> Part:
    """A full turn, the declared curves over the measured ones."""
    sweep = store.table("rotation_sweep")
    end = float(sweep[sweep["theta_rad"] == sweep["theta_rad"].max()]["strain"].abs().max())
    text = prose(f"""## A full turn

The measured strain in colour, the declared one in black dots on top of it; measures whose strains are the same share a
curve. After a full turn all strains are back at zero; the largest is {scientific(end)}. Half-way, at 180 degrees, a
measure with the square of the rotation added is as wrong as the linear one: the square of a sine cannot tell half a
turn from none. Over the whole turn and all measures the largest distance from a declared curve is
{scientific(_miss(sweep.dropna(subset=["declared"])))}.""")
    words = "Strain left by a rigid rotation over a full turn, by measure, with the declared laws"
    return joined(text, picture("rigid-body-turn.svg", words, full_turn(sweep)))


def _successive(store: Store) -> Part:
    """Rotations about Z, Y and X, and back, of a panel of elements."""
    data = store.table("rotations")
    places = [("free", "back", 3), ("strained", "back", 3), ("strained", "astray", 6)]
    home = [("free", "back", 6), ("strained", "back", 6)]
    rows = []
    for (measure, interpolation), own in data.groupby(["measure", "interpolation"], sort=False):
        found = own.set_index(["body", "path", "leg"]).reindex([*places, *home])
        changes, left = found["energy_change"].loc[places[1:]], found["off"].loc[home]
        shown = found["strain"].loc[places[0]], found["off"].loc[places[0]], *changes, *left
        rows.append([measure, interpolation, *(NOTHING if math.isnan(value) else _size(value) for value in shown)])
    text = prose("""## Rotations one after another

A panel of 4 by 4 elements, a piece of a cylinder, is turned by its edge in load steps about Z, Y and X, then back about
X, Y and Z; all other nodes are found by Newton's iteration. *Free*: the first edge is held, the panel may follow
without strain. *Strained*: the second edge is held, too, pulled and bent before the first rotation, and its energy must
stay. *Six astray*: after the first three the panel is turned back in the order Z, Y, X, and arrives elsewhere, for
rotations may not be exchanged; the energy must be there all the same. *Off* is the distance from where the rotation of
the edge takes a node, over the panel's length. Every measure comes back, as its energy is a function of where it is;
what it costs is left on the way. With components interpolated in the turning frame even an exact measure strains, by
the second order of the mesh. A dash stands where the path ended before.""")
    heads = ["measure", "interpolation", "free, Z Y X: strain", "free, Z Y X: off", "strained, Z Y X: energy"]
    heads += ["strained, six astray: energy", "free, back: off", "strained, back: off"]
    return joined(
        text, table("Left by rotations one after another; energies as changes, over the first", heads, rows, 2)
    )


def _everything(store: Store) -> Part:
    """All cases, a table for each surface."""
    data = store.table("rigid_body")
    text = prose(f"""## All cases

{len(data)} cases in a fold, by surface: the strain named in the third column, on the outer face; *largest* is that of
all eleven strains on both faces. A dash stands where no law is declared: with Donnell's slopes or thin-shell gradients
the strain depends on more than the stretch of the face.""")
    heads = "motion | measure | strain | measured | declared | difference | largest"
    line = "{motion} | {measure} | {component} | {strain:strain} | {declared:strain} | {off:.1e} | {largest:size}"
    order = {motion: i for i, motion in enumerate(MOTIONS)}
    told = data.assign(off=(data["strain"] - data["declared"]).abs())
    told = told.sort_values("motion", key=lambda motions: motions.map(order), kind="stable")
    tables = (
        listing(f"Rigid motions of the {surface}", own, heads, line, words=3, strain=_strain, size=_size)
        for surface, own in told.groupby("surface", sort=False)
    )
    return joined(text, folded("All cases by surface", "\n\n".join(tables)))


def shared_curves(rows: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """The measures of one case grouped by equal strains: their names and one of their tables."""
    groups: list[tuple[list[str], pd.DataFrame]] = []
    for name, own in rows.groupby("measure", sort=False):
        same = (names for names, first in groups if np.allclose(first["strain"], own["strain"], rtol=0, atol=SAME))
        names = next(same, None)
        if names is None:
            groups.append(([str(name)], own))
        else:
            names.append(str(name))
    for names, own in groups:
        yield ", ".join(names), own


@svg
def full_turn(sweep: pd.DataFrame) -> Figure:
    """Strain over the angle of a rigid rotation, a panel a case; the exact answer is zero."""
    cases, drawn = sweep.groupby(["surface", "motion"], sort=False), looks(sweep["measure"])
    figure, panels = canvas(len(cases), columns=2, width=9.0, height=4.2)
    for axes, ((surface, motion), rows) in zip(panels, cases, strict=True):
        for names, own in shared_curves(rows):
            colour, angle = drawn[own["measure"].iloc[0]].colour, np.degrees(own["theta_rad"])
            label = "\n".join(wrap(names, WIDTH, break_long_words=False, break_on_hyphens=False))
            axes.plot(angle, own["strain"], color=colour, linewidth=3.5, alpha=0.7, label=label)
            axes.plot(angle, own["declared"], color=BLACK, linestyle=":", linewidth=1.2)
        axes.set(title=f"{surface}, {motion}", xlabel="rotation [deg]", ylabel="strain [-]", xlim=(0, 360))
        axes.set_xticks([0, 90, 180, 270, 360])
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=8, frameon=False)
    declared = Line2D([], [], color=BLACK, linestyle=":", linewidth=1.2, label="declared law")
    figure.legend(handles=[declared], loc="outside upper center")
    return figure


CHAPTER = Chapter(
    "rigid-body",
    "Rigid motions",
    "what they leave in each measure, against its declared law.",
    rigid_body_page,
    needs=("rigid_body", "small_motions", "rigid_body_powers", "rotation_sweep"),
    always=True,
)

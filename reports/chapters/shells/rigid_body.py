"""The page of rigid motions: what every measure leaves, its declared law beside it, rates, and a full turn."""

from __future__ import annotations

import math

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.shells import figures_rigid_body
from reports.markdown import NOTHING, Part, fixed, joined, picture, prose, scientific, table
from reports.tables import Store

INTRODUCTION = prose("""# Rigid motions

A rigid motion strains nothing. Whether a measure knows that is a question to its formulas alone: no mesh and no element
is on this page. The exact displacements of a small piece of a shell, moved as a whole, are sent through the
displacement gradients of each measure, and whatever strain comes out is the measure's own. Every measure declares what
it leaves as a closed form; a Donnell that passes would be as wrong as an exact measure that fails.""")
NOTHING_LEFT = 1e-12  # a strain below this is rounding
MOTIONS = ("translation", "out of plane", "drilling", "about the axis")
KEYS = ["measure", "surface", "motion"]


def rigid_body_page(store: Store) -> Part:
    """The whole page."""
    return joined(
        [Part(INTRODUCTION), _overview(store), _rates(store), _donnell(store), _turn(store), _everything(store)]
    )


def _overview(store: Store) -> Part:
    """Which measure survives which motion."""
    data = store.table("rigid_body")
    rows = []
    for name in dict.fromkeys(data["measure"]):
        own = data[data["measure"] == name]
        told = own.dropna(subset=["declared"])
        largest = [float(own[own["motion"] == motion]["largest"].max()) for motion in MOTIONS]
        miss = float((told["strain"] - told["declared"]).abs().max())
        rows.append([name, *(_size(value) for value in largest), f"{len(told)} of {len(own)}", scientific(miss)])
    theta, slide = float(data["theta_rad"].max()), float(data["slide"].max())
    text = prose(f"""## Who survives what

The largest of all eleven strains at the sample point of any of the four surfaces (plate, cylinder, sphere, torus),
after a translation by {slide:g} of the size of the sample along x and after rotations by {theta:g} rad: *out of plane*
about the tangent e2, *drilling* about the normal e3, *about the axis* about z, which is the axis of revolution of the
curved surfaces and the normal of the plate. 0 is less than {NOTHING_LEFT:g}. The last columns say for how many of the
cases a law is declared, and how far the measured strain is from it at most. Laws are those of a membrane strain: a
measure that mends its membrane strains alone still shows here what its linear shears and its linear E33 leave.""")
    header = ["measure", *MOTIONS, "laws", "off the law by at most"]
    return Part("\n\n".join([text, table("Largest strain left by rigid motions [-]", header, rows)]))


def _size(value: float) -> str:
    return "0" if abs(value) < NOTHING_LEFT else f"{value:.3g}"


def _strain(value: float) -> str:
    if math.isnan(value):
        return NOTHING
    return "0" if abs(value) < NOTHING_LEFT else f"{value + 0.0:.6e}"


def _rates(store: Store) -> Part:
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
    return Part("\n\n".join([text, table(kinds, header, rows, words=2), _karman(store)]))


def _power(row: pd.Series, name: str) -> str:
    rate, coefficient = row[f"{name}_rate"], row[f"{name}_coefficient"]
    return "0" if math.isnan(rate) else f"{fixed(coefficient, 4)} a^{fixed(rate, 2)}"


def _karman(store: Store) -> str:
    """The fourth power, number by number."""
    data = store.table("small_motions")
    rows = []
    for _, row in data[_case(data, "von-karman", "plate", "out of plane")].iterrows():
        theta, strain, declared = (float(row[key]) for key in ("amount", "strain", "declared"))
        leading = -(theta**4) / 8
        rows.append([f"{theta:g}", _strain(strain), _strain(declared), _strain(leading), fixed(strain / leading, 5)])
    header = ["θ [rad]", "measured", "declared, -(1 - cos θ)²/2", "-θ⁴/8", "measured over -θ⁴/8"]
    return table("Von Kármán's plate turned out of its plane", header, rows)


def _case(data: pd.DataFrame, measure: str, surface: str, motion: str) -> pd.Series:
    return (data["measure"] == measure) & (data["surface"] == surface) & (data["motion"] == motion)


def _donnell(store: Store) -> Part:
    """The translation of a cylinder, for teaching."""
    data = store.table("small_motions")
    rows = []
    for _, row in data[_case(data, "donnell", "cylinder", "translation")].iterrows():
        strain, declared, largest = (float(row[key]) for key in ("strain", "declared", "largest"))
        rows.append([f"{row['amount']:g}", _strain(strain), _strain(declared), _strain(largest)])
    found = store.analysis("rigid_body_powers")
    case = found[_case(found, "donnell", "cylinder", "translation")].iloc[0]
    flat = found[_case(found, "donnell", "plate", "translation")].iloc[0]
    text = prose(f"""## Why Donnell fails

Move a cylinder of radius R as a whole by U along x. At the angle φ from x the frame of the shell sees the components
v3 = U cos φ along its normal and v2 = -U sin φ along its circumference. Both change along the circumference, though
nothing is deformed: it is the frame that turns, by one radian for every radian of arc. The rotation of the normal is
therefore the sum of two terms,

θ2 = -v3,φ/R + v2/R = U sin φ/R - U sin φ/R = 0,

and they cancel. Donnell's shallow-shell theory keeps the first term only, as if the frame did not turn, so the
translated cylinder seems to have the slope U sin φ/R. The slope enters twice. Squared and halved it is a membrane
strain, (U sin φ/R)²/(2 ζ²) on a face stretched by ζ = 1 + d/R: fitted rate {fixed(case["strain_rate"], 2)},
coefficient {fixed(case["strain_coefficient"], 4)}, declared {fixed(case["declared_coefficient"], 4)}. To the first
power it is a transverse shear, since the director has not moved: the largest strain falls with the rate
{fixed(case["largest_rate"], 2)} only. On a plate the frame does not turn and Donnell leaves {_power(flat, "largest")}.

The theory was made for shells that buckle in many small waves, where v3,φ is much larger than v2; it must not be used
where a shell moves far compared with its buckles.""")
    header = ["U over the size of the sample", "E22, outer face", "declared", "largest of all strains"]
    return Part("\n\n".join([text, table("Donnell's cylinder, translated", header, rows)]))


def _turn(store: Store) -> Part:
    """A full turn, the declared curves over the measured ones."""
    sweep = store.table("rotation_sweep")
    told = sweep.dropna(subset=["declared"])
    miss = float((told["strain"] - told["declared"]).abs().max())
    end = float(sweep[sweep["theta_rad"] == sweep["theta_rad"].max()]["strain"].abs().max())
    name = "rigid-body-turn.svg"
    text = prose(f"""## A full turn

The measured strain in colour, the declared one in black dots on top of it; measures whose strains are the same share a
curve. After a full turn all strains are back at zero; the largest is {scientific(end)}. Half-way, at 180 degrees, a
measure with the square of the rotation added is as wrong as the linear one: the square of a sine cannot tell half a
turn from none. Over the whole turn and all measures the largest distance from a declared curve is
{scientific(miss)}.""")
    shown = picture(name, "Strain left by a rigid rotation over a full turn, by measure, with the declared laws")
    return Part("\n\n".join([text, shown]), {name: figures_rigid_body.full_turn(sweep)})


def _everything(store: Store) -> Part:
    """All cases, a table for each surface."""
    data = store.table("rigid_body")
    blocks = [
        prose("""## All cases

The strain named in the third column, on the outer face; *largest* is that of all eleven strains on both faces. A dash
stands where no law is declared: with Donnell's slopes or thin-shell gradients the strain depends on more than the
stretch of the face.""")
    ]
    for surface in dict.fromkeys(data["surface"]):
        rows = []
        for motion in MOTIONS:
            for _, row in data[(data["surface"] == surface) & (data["motion"] == motion)].iterrows():
                strain, declared = float(row["strain"]), float(row["declared"])
                values = [_strain(strain), _strain(declared), scientific(abs(strain - declared))]
                rows.append([motion, row["measure"], row["component"], *values, _size(float(row["largest"]))])
        header = ["motion", "measure", "strain", "measured", "declared", "difference", "largest"]
        blocks.append(table(f"Rigid motions of the {surface}", header, rows, words=3))
    return Part("\n\n".join(blocks))


CHAPTER = Chapter(
    "rigid-body",
    "Rigid motions",
    "what they leave in each measure, against its declared law.",
    rigid_body_page,
    needs=("rigid_body", "small_motions", "rigid_body_powers", "rotation_sweep"),
    always=True,
)

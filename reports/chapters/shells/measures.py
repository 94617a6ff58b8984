"""The page of the strain measures: up to which load each is enough, and the options of the element."""

from __future__ import annotations

import math

from reports.chapter import Chapter
from reports.chapters.shells import figures_measures
from reports.markdown import NOTHING, Part, commands, digits, fixed, joined, percent, picture, prose, table
from reports.tables import Store

INTRODUCTION = prose("""# Strain measures

All measures run on the same element, section, loads and solver. Only their coefficients differ, so a difference on this
page is the measure's and nothing else's. What each leaves under [rigid motions](rigid-body.md) has a page of its
own.""")
WORDS = {  # of a scene: what is judged, and over what
    "tyre": ("contact force", "travel of the plane [mm]"),
    "hemisphere": ("inward displacement", "load fraction"),
    "cantilever": ("tip deflection", "load fraction"),
    "sze-pullout": ("deflection under the load", "load fraction"),
    "roof-a": ("deflection of the crown", "load fraction"),
    "shallow-cap": ("deflection of the apex", "load fraction"),
}

WHOLE = {"scene": "hemisphere", "measure": "exact", "newton": "mixed", "steps": 1, "load_fraction": 1}
OPTIONS, MESHES = ("interpolation", "thickness_strain", "membrane"), ("8x8", "16x16", "32x32")


def measures_page(store: Store) -> Part:
    """The whole page."""
    return joined([Part(INTRODUCTION), enough_part(store), element_part(store)])


def enough_part(store: Store) -> Part:
    """Error against the exact measure over the load: where it first passes 1 % and 5 %, and the largest."""
    found, blocks = store.analysis("measure_limits"), []
    for scene, own in found.groupby("scene", sort=False):
        rows = [
            [
                row["measure"],
                percent(row["error"]),
                *(_first(row[level]) for level in ("first_1", "first_5")),
                f"{percent(row['largest'])} at {digits(row['largest_at'], 3)}",
            ]
            for row in own.to_dict("records")
        ]
        what, load = WORDS[str(scene)]
        header = [
            "measure",
            f"error at {digits(own['load'].iloc[0], 3)}",
            "first above 1 %",
            "first above 5 %",
            "largest error",
        ]
        blocks.append(table(f"{scene}: {what} by {load}", header, rows))
    text = prose("""## Which measure is enough

Each scene is solved with every measure on one mesh while its load grows; the error is the difference from the exact
measure on the same mesh, so the mesh is not in it. An error may change its sign on the way, and be small at the last
load after it has been large: so the columns give the load at which it *first* exceeds 1 % and 5 %, interpolated between
two loads, and the largest error up to the last load, with the load where it is that large. A dash: it never does; "from
the start": it does so at the first load already. Curves that coincide cover each other.""")
    name = "measures-enough.svg"
    axes = {scene: load for scene, (_, load) in WORDS.items()}
    drawn = figures_measures.errors_over_load(store.analysis("measure_errors"), axes)
    shown = picture(name, "Error against the exact measure over the load, by scene and measure; dotted: 1 % and 5 %")
    return Part("\n\n".join([text, shown, *blocks, commands(found["command"])]), {name: drawn})


def _first(load: float) -> str:
    """A load at which a level is first exceeded."""
    if math.isnan(load):
        return NOTHING
    return "from the start" if load == 0 else digits(load, 3)


def element_part(store: Store) -> Part:
    """The hemisphere on three meshes by the options of the element."""
    reference = store.reference("hemisphere", "inward_mm", "read", load_fraction=1.0)
    rows, lines = [], []
    for first in store.select(**WHOLE, mesh=MESHES[0]):
        options = {name: first.result["settings"][name] for name in OPTIONS}
        row = list(options.values())
        for mesh in MESHES:
            cell = store.find(**WHOLE, **options, mesh=mesh)
            value = cell.value("inward_mm", load_fraction=1.0)
            row.append(f"{fixed(value, 3)} ({percent(value / float(reference['value']) - 1)})")
            lines.append(cell.command)
        rows.append(row)
    text = prose(f"""## Options of the element

Same unknowns, same measure (`exact`): what is interpolated, where the thickness strain is sampled, and how much of the
linear membrane modes a curved element keeps. The first row is the element of the paper (`element=paper`); the default,
`element=refined`, is curvilinear, nodal and relaxed: [over all scenes](convergence.md#which-element) that is the better
one. Hemisphere with a hole under the whole load, inward displacement in mm; in brackets the difference from the
published {fixed(float(reference["value"]), 3)}, which is itself a finite-element result.""")
    header = ["interpolation", "thickness strain", "membrane", *MESHES]
    return Part(
        "\n\n".join([text, table("Inward displacement of the hemisphere", header, rows, words=3), commands(lines)])
    )


CHAPTER = Chapter(
    "measures",
    "Strain measures",
    "up to which load each is enough.",
    measures_page,
    needs=("measure_errors", "measure_limits"),
    always=True,
)

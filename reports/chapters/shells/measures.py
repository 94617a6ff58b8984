"""The page of the strain measures: up to which load each is enough, and the options of the element."""

from __future__ import annotations

import math

from reports.chapter import Chapter
from reports.chapters.answers.sections import regimes_table
from reports.chapters.shells.figures_measures import errors_over_load
from reports.formats import NOTHING, digits, fixed, percent
from reports.markdown import Part, commands, joined, listing, picture, prose, table
from reports.store.tables import Store

INTRODUCTION = prose("""# Strain measures

All measures run on the same element, section, loads and solver. Only their coefficients differ, so a difference on this
page is the measure's and nothing else's. What each leaves under [rigid motions](rigid-body.md) has a page of its
own.""")
WORDS = {  # of a scene: what is judged, and over what
    "tyre": ("contact force", "travel of the plane [mm]"),
    "hemisphere": ("inward displacement", "load fraction"),
    "cantilever": ("tip deflection", "load fraction"),
    "sze-pullout": ("deflection under the load", "load fraction"),
    "sze-annulus": ("deflection of the outer corner", "load fraction"),
    "ring": ("force of a plate", "travel of a plate [mm]"),
    "roof-a": ("deflection of the crown", "load fraction"),
    "roof-d": ("deflection of the crown", "load fraction"),
    "shallow-cap": ("deflection of the apex", "load fraction"),
}

WHOLE = {"scene": "hemisphere", "measure": "exact", "newton": "mixed", "steps": 1, "load_fraction": 1, "lines": "even"}
OPTIONS, MESHES = ("interpolation", "thickness_strain", "membrane"), ("8x8", "16x16", "32x32")


def measures_page(store: Store) -> Part:
    """The whole page."""
    return joined(INTRODUCTION, regimes_part(store), enough_part(store), element_part(store))


def enough_part(store: Store) -> Part:
    """Error against the exact measure over the load: where it first passes 1 % and 5 %, and the largest."""
    found, blocks = store.analysis("measure_limits"), []
    for scene, own in found.groupby("scene", sort=False):
        what, load = WORDS[str(scene)]
        heads = (
            f"measure | error at {digits(own['load'].iloc[0], 3)} | first above 1 % | first above 5 % | largest error"
        )
        line = "{measure} | {error:+.2%} | {first_1:first} | {first_5:first} | {largest:+.2%} at {largest_at:#.3g}"
        blocks.append(listing(f"{scene}: {what} by {load}", own, heads, line, first=_first))
    text = prose("""## Which measure is enough

Each scene is solved with every measure on one mesh while its load grows; the error is the difference from the exact
measure on the same mesh, so the mesh is not in it. An error may change its sign on the way, and be small at the last
load after it has been large: so the columns give the load at which it *first* exceeds 1 % and 5 %, interpolated between
two loads, and the largest error up to the last load, with the load where it is that large. A dash: it never does; "from
the start": it does so at the first load already. Curves that coincide cover each other.""")
    return joined(text, enough_picture(store), *blocks, commands(found["command"]))


def enough_picture(store: Store) -> Part:
    """Signed errors over the load, scene by scene."""
    words = "Signed error against the exact measure over the load; rings: where 1 % and 5 % are first passed"
    loads = {name: each[1] for name, each in WORDS.items()}
    drawn = errors_over_load(store.analysis("measure_errors"), store.analysis("measure_limits"), loads)
    return picture("measures-enough.svg", words, drawn)


def regimes_part(store: Store) -> Part:
    """What to take: errors and cost by regime."""
    text = prose("""## Which measure to take

Scenes by the way their shells move: shallow ones, a tyre in contact, a ring in contact, and large rotations without
contact. What each measure keeps and drops, its law under rigid motions and its literature stand on its sheet in the
catalogue.""")
    shown = regimes_table(store)
    return joined(text, shown) if shown else Part("")


def _first(load: float) -> str:
    """A load at which a level is first exceeded."""
    if math.isnan(load):
        return NOTHING
    return "from the start" if load == 0 else digits(load, 3)


def element_part(store: Store) -> Part:
    """The hemisphere on three meshes by the options of the element."""
    reference = float(store.reference("hemisphere", "inward_mm", "read", load_fraction=1.0)["value"])
    rows, lines = [], []
    for first in store.select(**WHOLE, mesh=MESHES[0]):
        options = {name: first.settings[name] for name in OPTIONS}
        cells = [store.find(**WHOLE, **options, mesh=mesh) for mesh in MESHES]
        values = [cell.value("inward_mm", load_fraction=1.0) for cell in cells]
        rows.append([*options.values(), *(f"{fixed(v, 3)} ({percent(v / reference - 1)})" for v in values)])
        lines += [cell.command for cell in cells]
    text = prose(f"""## Options of the element

Same unknowns, same measure (`exact`): what is interpolated, where the thickness strain is sampled, and how much of the
linear membrane modes a curved element keeps. The first row is the element of the paper (`element=paper`); the default,
`element=refined`, is curvilinear, balanced and relaxed: [over all scenes](convergence.md#which-element) that is the
better one. Hemisphere with a hole under the whole load, inward displacement in mm; in brackets the difference from the
published {fixed(reference, 3)}, which is itself a finite-element result.""")
    header = ["interpolation", "thickness strain", "membrane", *MESHES]
    return joined(text, table("Inward displacement of the hemisphere", header, rows, words=3), commands(lines))


CHAPTER = Chapter(
    "measures",
    "Strain measures",
    "exact against classical by regime: up to which load each is enough, and what it costs.",
    measures_page,
    needs=("measure_errors", "measure_limits"),
    always=True,
)

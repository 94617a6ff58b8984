"""The page of the strain measures: their errors in the limit of the meshes, and the options of the element."""

from __future__ import annotations

from reports.chapter import Chapter
from reports.chapters.overview.decision import limits_part
from reports.formats import fixed, percent
from reports.markdown import Part, commands, joined, prose, table
from reports.store.tables import Store

INTRODUCTION = prose("""# Strain measures

All measures run on the same element, section, loads and solver: only their coefficients differ. What each leaves under
rigid motions is on [another page](invariance.md#rigid-motions).""")
WHOLE = {"scene": "hemisphere", "measure": "exact", "newton": "mixed", "steps": 1, "load_fraction": 1, "lines": "even"}
OPTIONS, MESHES = ("interpolation", "thickness_strain", "membrane"), ("8x8", "16x16", "32x32")


def measures_page(store: Store) -> Part:
    """The whole page."""
    return joined(INTRODUCTION, "## In the limit of the meshes", limits_part(store), element_part(store))


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
    "exact against classical in the limit of the meshes, and what each costs.",
    measures_page,
    always=True,
)

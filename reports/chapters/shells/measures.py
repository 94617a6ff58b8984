"""The page of the strain measures: their errors in the limit of the meshes, and the options of the element."""

from __future__ import annotations

from reports.chapter import chapter
from reports.chapters.overview.decision import limits_part
from reports.formats import fixed, percent
from reports.markdown import Part, commands, table
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("measures")
WHOLE = {"scene": "hemisphere", "measure": "exact", "newton": "mixed", "steps": 1, "load_fraction": 1, "lines": "even"}
OPTIONS, MESHES = ("interpolation", "thickness_strain", "membrane"), ("8x8", "16x16", "32x32")


def measures_page(store: Store) -> Part:
    """The whole page: the limits, and the hemisphere on three meshes by the options of the element."""
    reference = float(store.reference("hemisphere", "inward_mm", "read", load_fraction=1.0)["value"])
    rows, lines = [], []
    for first in store.select(**WHOLE, mesh=MESHES[0]):
        options = {name: first.settings[name] for name in OPTIONS}
        cells = [store.find(**WHOLE, **options, mesh=mesh) for mesh in MESHES]
        values = [cell.value("inward_mm", load_fraction=1.0) for cell in cells]
        rows.append([*options.values(), *(f"{fixed(v, 3)} ({percent(v / reference - 1)})" for v in values)])
        lines += [cell.command for cell in cells]
    header = ["interpolation", "thickness strain", "membrane", *MESHES]
    options_table = table("Inward displacement of the hemisphere", header, rows, words=3)
    shown = {"limits": limits_part(store), "options": options_table, "commands": commands(lines)}
    return TEXT("page", reference=reference, **shown)


CHAPTER = chapter(
    TEXT,
    measures_page,
    always=True,
)

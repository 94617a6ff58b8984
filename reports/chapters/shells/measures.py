"""The page of the strain measures: up to which load each is enough, and the options of the element."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from reports import labels
from reports.chapter import Chapter
from reports.chapters.shells import figures_measures
from reports.markdown import NOTHING, Part, commands, digits, fixed, joined, percent, picture, prose, table
from reports.tables import Store

INTRODUCTION = prose("""# Strain measures

All measures run on the same element, section, loads and solver. Only their coefficients differ, so a difference on this
page is the measure's and nothing else's. What each leaves under [rigid motions](rigid-body.md) has a page of its
own.""")
LEVELS = (0.01, 0.05)


@dataclass(frozen=True)
class Growing:
    """A scene whose load grows: its name, the key of the load, the quantity that is judged, words for both."""

    scene: str
    load: str
    quantity: str
    load_words: str
    quantity_words: str


SCENES = (
    Growing("tyre", "delta_mm", "force_N", "travel of the plane [mm]", "contact force"),
    Growing("hemisphere", "load_fraction", "inward_mm", "load fraction", "inward displacement"),
    Growing("cantilever", "load_fraction", "tip_deflection_mm", "load fraction", "tip deflection"),
    Growing("sze-pullout", "load_fraction", "w_A_mm", "load fraction", "deflection under the load"),
    Growing("roof-a", "load_fraction", "w_C_mm", "load fraction", "deflection of the crown"),
    Growing("shallow-cap", "load_fraction", "w_apex_mm", "load fraction", "deflection of the apex"),
)


def measures_page(store: Store) -> Part:
    """The whole page."""
    return joined([Part(INTRODUCTION), enough_part(store), element_part(store)])


def enough_part(store: Store) -> Part:
    """Error against the exact measure over the load, and where it passes 1 % and 5 %."""
    errors = {growing.scene: errors_of(store, growing) for growing in SCENES}
    blocks, lines = [], []
    for growing in SCENES:
        error = errors[growing.scene]
        end = error.iloc[-1] if len(error) else pd.Series(np.nan, index=error.columns)  # no load reached: dashes
        rows = [
            [name, percent(float(end[name])), *(crossing(error, name, level) for level in LEVELS)]
            for name in error.columns.drop("load")
        ]
        last = digits(float(end["load"]), 3)
        header = ["measure", f"error at {last}", *(f"above {percent(level, 0, sign=False)} from" for level in LEVELS)]
        blocks.append(table(f"{growing.scene}: {growing.quantity_words} by {growing.load_words}", header, rows))
        lines += [
            cell.command for cell in store.matching(labels.BY_MEASURE.format(scene=growing.scene, measure=r"\S+"))
        ]
    text = prose("""## Which measure is enough

Each scene is solved with every measure on one mesh while its load grows; the error is the difference from the exact
measure on the same mesh, so the mesh is not in it. The last columns give the load from which the error stays above 1 %
and 5 %; a dash means that at the last load it is below. Curves that coincide cover each other.""")
    name = "measures-enough.svg"
    drawn = figures_measures.errors_over_load(errors, {growing.scene: growing.load_words for growing in SCENES})
    shown = picture(name, "Error against the exact measure over the load, by scene and measure; dotted: 1 % and 5 %")
    return Part("\n\n".join([text, shown, *blocks, commands(lines)]), {name: drawn})


def errors_of(store: Store, growing: Growing) -> pd.DataFrame:
    """Columns ``load`` and one for each measure but the exact one: value / exact value - 1, NaN where not reached."""
    exact = store.cell(labels.BY_MEASURE.format(scene=growing.scene, measure="exact"))
    asked = {float(load) for load in exact.result["settings"][growing.load]}  # a traced curve has points between them
    reached = [step for step in exact.steps if min(abs(load - step[growing.load]) for load in asked) < 1e-9]
    loads = [float(step[growing.load]) for step in reached]
    values = np.array([float(step[growing.quantity]) for step in reached])
    columns: dict[str, object] = {"load": loads}
    for cell in store.matching(labels.BY_MEASURE.format(scene=growing.scene, measure=r"(?!exact$)\S+")):
        found = np.array([cell.value(growing.quantity, **{growing.load: load}) for load in loads])
        columns[cell.label.rsplit(" ", 1)[1]] = found / values - 1
    return pd.DataFrame(columns)


def crossing(error: pd.DataFrame, name: str, level: float) -> str:
    """The load from which |error| stays above the level, between two loads by linear interpolation.

    A dash when it ends below the level, or was never found there.
    """
    known = error[["load", name]].dropna()
    load, size = known["load"].to_numpy(), known[name].abs().to_numpy()
    below = np.flatnonzero(size <= level)
    if len(size) == 0 or size[-1] <= level:
        return NOTHING
    if len(below) == 0:
        return f"below {digits(float(load[0]), 3)}"
    last = below[-1]
    return digits(float(np.interp(level, size[last : last + 2], load[last : last + 2])), 3)


def element_part(store: Store) -> Part:
    """The hemisphere on three meshes by the options of the element."""
    reference = store.reference("hemisphere", "inward_mm", "read", load_fraction=1.0)
    rows, lines = [], []
    names = ("interpolation", "thickness", "membrane")
    any_of_them = dict.fromkeys(names, r"\S+")
    for first in store.matching(labels.ELEMENT.format(n=labels.ELEMENT_MESHES[0], **any_of_them)):
        row = first.label.split()[2:]
        options = dict(zip(names, row, strict=True))
        for n in labels.ELEMENT_MESHES:
            cell = store.cell(labels.ELEMENT.format(n=n, **options))
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
    header = ["interpolation", "thickness strain", "membrane", *(f"{n}x{n}" for n in labels.ELEMENT_MESHES)]
    return Part(
        "\n\n".join([text, table("Inward displacement of the hemisphere", header, rows, words=3), commands(lines)])
    )


CHAPTER = Chapter(
    "measures",
    "Strain measures",
    "up to which load each is enough.",
    measures_page,
    always=True,
)

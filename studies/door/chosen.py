"""A choice as files: pictures, tables and choice.json. What is chosen does not enter here."""

from __future__ import annotations

from pathlib import Path

from studies.choosing.choice import Choice

AS_ASKED = "as asked for"  # of the element of the reference
FIGURES = {"measure": "measures.svg", "element": "elements.svg"}


def write_choice(found: Choice, out: Path) -> None:
    """The pictures, the tables, and choice.json, which comes last."""
    from reports.figures.choice import error_over_seconds
    from reports.files import write_texts

    pictures = {}
    for axis, name in FIGURES.items():
        named = [row["name"] for row in found.variants if row["axis"] == axis]
        if found.limit is None or not named:
            continue
        reference = (
            found.verdicts[0].grids
            if axis == "measure"
            else [row | {"name": AS_ASKED} for row in found.verdicts[0].grids]
        )
        others = [row for verdict in found.verdicts[1:] for row in verdict.grids if row["axis"] == axis]
        rows = [*reference, *others]
        pictures[name] = error_over_seconds(rows, found.quantity, found.question.error, found.limit.uncertainty)()
    write_texts(out / "figures", pictures)
    found.write(out, [f"figures/{name}" for name in pictures])

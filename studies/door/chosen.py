"""A choice as files: pictures, tables and choice.json. What is chosen does not enter here."""

from __future__ import annotations

from pathlib import Path

from studies.choosing.choice import Choice

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
        first, *_ = found.variants
        rows = [row for row in found.grids if row["axis"] == axis or row["name"] == first["name"]]
        pictures[name] = error_over_seconds(rows, found.quantity, found.question.error, found.limit.uncertainty)()
    write_texts(out / "figures", pictures)
    found.write(out, [f"figures/{name}" for name in pictures])

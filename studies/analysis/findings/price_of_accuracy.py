"""What an error costs: the fastest way to 5, 2, 1, 0.5 and 0.2 % on scenes that an engineer knows, or the nearest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import pandas as pd

from studies.analysis.advice.choose import advise, words_of
from studies.analysis.advice.questions import Question, questions
from studies.analysis.verify import EXACT, headline

SCENES = ("tyre", "hemisphere", "roof-d")
TOLERANCES = (0.05, 0.02, 0.01, 0.005, 0.002)
PRICE_COLUMNS = (
    *("scene", "quantity", "against", "known", "tolerance", "reached", "configuration", "mesh"),
    *("error", "bound", "seconds", "operations", "unknowns", "cells", "label", "command"),
)


def price_of_accuracy(table: pd.DataFrame, verified: pd.DataFrame) -> pd.DataFrame:
    """PRICE_COLUMNS, a row a scene and tolerance: the cell with fewest seconds whose bound meets it.

    bound: verified error and what its reference is uncertain by.  known: that uncertainty.  reached: False where no
    cell does; then the row is the cell with the smallest bound.  cells: from which it was chosen.
    """
    rows: list[list[object]] = []
    for scene in SCENES:
        for asked in _asked(questions(table, verified, scene, headline(table, scene) or "", "seconds")):
            for tolerance in TOLERANCES:
                advice = advise(asked, tolerance)
                cell = advice.nearest if advice.best is None else advice.best
                rows.append(_row(asked, tolerance, cell, reached=advice.best is not None))
    return pd.DataFrame(rows, columns=list(PRICE_COLUMNS))


def _asked(found: Sequence[Question]) -> Iterator[Question]:
    """The largest question with those of the same answer, by whatever loads it is come to; none where there is none.

    Of measures that approximate those count whose formulation's error is known: on one mesh two errors may cancel. An
    element without a name, one of the options alone, is none to be used.
    """
    for first in found[:1]:
        cells = pd.concat([each.cells for each in found])
        known = (cells["measure"] == EXACT) | cells["formulation_error"].notna()
        same = (cells["reference"] == first.cells["reference"].iloc[0]) & (cells["against"] == first.against)
        known &= cells["element"] != ""
        if (known & same).any():
            yield replace(first, cells=cells[known & same].sort_values("price", kind="stable", ignore_index=True))


def _row(question: Question, tolerance: float, cell: Mapping[str, Any], *, reached: bool) -> list[object]:
    asked = [question.scene, question.quantity, question.against, cell["uncertainty"], tolerance, reached]
    costs = [cell.get(f"cost.{name}") for name in ("seconds", "operations", "dofs")]
    found = [words_of(cell), cell["mesh"], cell["error"], cell["bound"], *costs]
    return [*asked, *found, len(question.cells), cell["label"], cell["command"]]

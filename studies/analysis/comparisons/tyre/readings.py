"""What the printed pressure table may mean: the paper's tyre with one thing changed, at several travels.

Every reading is held against the same printed nodes by the same measures; nothing is fitted but the travel.
"""

from __future__ import annotations

import pandas as pd

from studies.analysis.cells.answers import Answers
from studies.analysis.comparisons.tyre.printed_pressures import (
    DELTA,
    HALF,
    compare,
    force,
    on_printed_nodes,
    pressure_maps,
    printed_map,
)
from studies.campaigns.report_cells import READINGS, TYRE

COLUMNS = (
    *("reading", "kind", "delta_mm", "stated", "best", "force_N", "printed_sum_N", "centre_MPa", "core_rms"),
    *("in_one_only", "label", "command"),
)
MODEL, DATA = "model", "data"  # what is changed
FIRST = "as stated in the paper"
WORDS = {
    **{"paper": (FIRST, MODEL), "reading linear": ("linear strains", MODEL), "reading 84x80": ("mesh 84x80", MODEL)},
    **{f"reading {name}": (f"{name} strains", MODEL) for name in ("von-karman", "sanders", "donnell")},
    "reading face area": ("pressure on the inner face, dead", MODEL),
    "reading follower": ("pressure on the inner face, following", MODEL),
    "reading full-3d": ("full three-dimensional law", MODEL),
    "reading consistent": ("nodal forces by consistent coupling", MODEL),
}
DATUM = {
    "gamma_deg": "cord angle {} deg",
    "ply_thickness_mm": "ply {} mm thick",
    "p0_MPa": "inflated by {} MPa",
}
CELLS = (*(cell for cell in TYRE if cell.label in WORDS), *READINGS)


def tyre_readings(answers: Answers) -> pd.DataFrame:
    """COLUMNS, a row a reading and travel; stated: at DELTA; best: the smallest core rms of its reading.

    kind: whether the model is changed or a datum within its rounding.  printed_sum_N: printed pressures times the areas
    of their nodes on the wall of that reading.  The other numbers are those of ``compare``.
    """
    printed, parts = printed_map(), []
    for answer in answers.those(CELLS):
        reading, kind = words(answer.label)
        rows = []
        for delta, own in pressure_maps(answer).items():
            found = compare(on_printed_nodes(own, printed, HALF), printed)
            row = {"reading": reading, "kind": kind, "delta_mm": delta, "stated": delta == DELTA}
            row |= {"force_N": answer.value("force_N", delta_mm=delta), "command": answer.command}
            rows.append({**row, **found, "printed_sum_N": force(printed, HALF, answer.settings)})
        own_rows = pd.DataFrame(rows).assign(label=answer.label)
        if rows:
            parts.append(own_rows.assign(best=own_rows.index == own_rows["core_rms"].idxmin()))
    return pd.concat(parts, ignore_index=True)[list(COLUMNS)] if parts else pd.DataFrame(columns=list(COLUMNS))


def words(label: str) -> tuple[str, str]:
    """A reading in words, and its kind, by the label of its cell."""
    if label in WORDS:
        return WORDS[label]
    key, value = label.removeprefix("reading ").split()
    return DATUM[key].format(value), DATA

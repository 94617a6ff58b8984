"""What the force of the paper's tyre is worth: each of its errors with an interval.

Mesh errors are relative to the limit of grids; what a measure, a section or a load changes is the ratio of two limits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from studies.analysis.evidence import Tables
from studies.experiments.accuracy.choices import measure_limits
from studies.run.campaigns.report_cells import BUDGET_MESHES, BUDGETED
from studies.run.cells.answers import Answers
from studies.solving.refinement.richardson import formal_limit

DELTA, EARLY = 20.0, 5.0  # mm; measures are stated at both
PAPER = "one step semismooth {mesh}"  # the cell of the paper's load and section
MESHES = BUDGET_MESHES[1:]  # whose errors are stated
COLUMNS = ("part", "changed", "delta_mm", "change", "within", "settled", "rests_on")
MEASURE, EXACT, LIMITS = "measure", "exact", "limits of both measures"
PARTS = {"follower": "load", "full-3d": "section", "nonsymmetric": "section"}


def tyre_budget(answers: Answers, tables: Tables, solid_shell: pd.DataFrame) -> pd.DataFrame:
    """COLUMNS, a row an error: relative change of the force, and the half-width of its interval.

    tables: among them ``work_precision`` and ``choices``.  settled: whether the change is larger than the interval.
    rests_on: in words, what the change is read from.
    """
    rows = [*_meshes(answers, tables), *_measures(tables), *_changed(answers), *_solid(solid_shell)]
    found = pd.DataFrame(rows, columns=["part", "changed", "delta_mm", "change", "within", "rests_on"])
    return found.assign(settled=found["change"].abs() > found["within"])[list(COLUMNS)]


def _meshes(answers: Answers, tables: Tables) -> Iterator[tuple[object, ...]]:
    """The meshes of the paper and half as fine again, over the limit that grids of two elements agree on."""
    grids = tables("work_precision")
    if grids is None:
        return
    reference, known = (float(grids[name].iloc[0]) for name in ("reference_N", "known"))
    for mesh in MESHES:
        answer = answers.get(PAPER.format(mesh=mesh))
        if answer is not None:
            change = answer.value("force_N", delta_mm=DELTA) / reference - 1
            yield "mesh", f"{mesh}, element of the paper", DELTA, change, known, "its force over the limit of grids"
    yield "mesh", "limit of grids", DELTA, 0.0, known, "limits of two elements"


def _measures(tables: Tables) -> Iterator[tuple[object, ...]]:
    """The measures of ``choices`` against the exact one, for the smallest error that was asked for."""
    choices = tables("choices")
    if choices is None:
        return
    own = measure_limits(choices).dropna(subset=["formulation_error"])
    own = own[(own["scene"] == "tyre") & (own["name"] != EXACT)]
    for delta in (EARLY, DELTA):
        for row in own[own["settings"] == f"delta_mm={delta:g}"].to_dict("records"):
            yield MEASURE, row["name"], delta, row["formulation_error"], row["within"], LIMITS


def _changed(answers: Answers) -> Iterator[tuple[object, ...]]:
    """Another load or section over the paper's: the ratio extrapolated from the two finer of three meshes.

    within: how far the limit has moved since the two coarser ones.
    """
    for name in BUDGETED:
        labels = ((f"budget {name} {mesh}", PAPER.format(mesh=mesh)) for mesh in BUDGET_MESHES)
        pairs = [[answers.get(label) for label in pair] for pair in labels]
        if any(each is None for pair in pairs for each in pair):
            continue
        changes, sizes = [], []
        for one, paper in pairs:
            assert one is not None
            assert paper is not None
            changes.append(one.value("force_N", delta_mm=DELTA) / paper.value("force_N", delta_mm=DELTA) - 1)
            sizes.append(paper.size)
        limit, moved = formal_limit(sizes, changes)
        if not math.isnan(limit):
            yield PARTS[name], name, DELTA, limit, moved, f"{len(BUDGET_MESHES)} meshes"


def _solid(solid_shell: pd.DataFrame) -> Iterator[tuple[object, ...]]:
    """The shell's limit over the solid's, of the isotropic tyre: angle plies are not solved as a solid."""
    own = solid_shell[(solid_shell["quantity"] == "force_N") & (solid_shell["at"].astype(str) == f"{DELTA:g}")]
    for row in own.head(1).dropna(subset=["model_part"]).to_dict("records"):
        off, known = row["model_part"], row["known_to"]
        yield "shell", "shell instead of a solid", DELTA, off, known, "isotropic tyre, limits of both"

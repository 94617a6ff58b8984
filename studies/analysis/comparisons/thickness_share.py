"""The share of the thickness strain that is sampled at the nodes, over all scenes: errors, and how far each goes.

Errors are of coarse meshes against the limit of the scene's ladder, which is the same for every share, or against a
reference where its meshes have none.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd

from formulations.element.mixed import THICKNESS_STRAINS
from studies.analysis.comparisons.element_choice import EQUAL
from studies.ask.declarations import Ladder
from studies.run.campaigns.share_cells import COMPARED, LABEL, meshes_of, read_at
from studies.run.cells.answers import Answer, Answers, number

FARTHER = 0.05  # a finer mesh that goes this much farther does not confirm the end of a path
END = "_limit_point"  # ends the quantity, named by its stage, that says where a path turned back for good
COLUMNS = (
    *("ladder", "quantity", "share", "mesh", "coarse", "known", "within", "error", "nearest"),
    *("outcome", "turns_at", "limit_points", "confirmed", "iterations", "label", "command"),
)


def thickness_share(answers: Answers, sequences: pd.DataFrame, errors: pd.DataFrame) -> pd.DataFrame:
    """COLUMNS, a row a scene, mesh and share, of the headline of each ladder; sequences, errors: of ``convergence``.

    coarse: on half of the default mesh, not on that.  known, within: the value that errors are relative to, and its
    relative uncertainty.  error: NaN where its load was not reached.  nearest: see :func:`nearest`.  turns_at: where
    the path ends at a limit point, in its own unit; it may pass ``limit_points`` before.  confirmed: see
    :func:`confirmed`; None without a finer mesh.
    """
    rows: list[dict[str, Any]] = []
    for ladder in COMPARED:
        known, within = limit_of(ladder, sequences, errors)
        of = {"ladder": ladder.name, "quantity": ladder.quantities[0], "known": known, "within": within}
        half, default = meshes_of(ladder)
        finer: dict[str, Answer] = {}
        for mesh, coarse in ((default, False), (half, True)):
            found, at = dict(_answers(answers, ladder, mesh)), read_at(ladder)
            off = {share: each.value(ladder.quantities[0], **at) / known - 1 for share, each in found.items()}
            near = nearest(off, within)
            for share, each in found.items():
                judged = {"share": share, "error": off[share], "nearest": share in near}
                rows.append(of | {"mesh": mesh, "coarse": coarse} | judged | _path(each, finer.get(share)))
            finer = found
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _path(answer: Answer, finer: Answer | None) -> dict[str, Any]:
    """How far it went, and whether the same on the finer mesh confirms that."""
    record = answer.record
    return {
        "outcome": record["outcome"],
        "turns_at": turns_at(record),
        "limit_points": passed(record),
        "confirmed": None if finer is None else confirmed(record, finer.record),
        "iterations": record["counters"].get("newton_iterations", math.nan),
        "label": answer.label,
        "command": answer.command,
    }


def _answers(answers: Answers, ladder: Ladder, mesh: str) -> Iterator[tuple[str, Answer]]:
    for share in THICKNESS_STRAINS:
        found = answers.get(LABEL.format(ladder=ladder.name, mesh=mesh, share=share))
        if found is not None:
            yield share, found


def limit_of(ladder: Ladder, sequences: pd.DataFrame, errors: pd.DataFrame) -> tuple[float, float]:
    """The most certain limit of a ladder's headline, or else reference, with its relative uncertainty; NaN for none."""
    own = sequences[(sequences["ladder"] == ladder.name) & (sequences["quantity"] == ladder.quantities[0])]
    own = own[own["family"] == ladder.family].drop_duplicates("sequence")  # not the benchmarks at their many loads
    known = own.assign(within=(own["uncertainty"] / own["limit"]).abs()).dropna(subset="within")
    if known.empty:
        known = errors[errors["sequence"].isin(own["sequence"])]
        known = known.assign(limit=known["value"], within=known["uncertainty"])
    if known.empty:
        return math.nan, math.nan
    best = known.sort_values("within", kind="stable").iloc[0]
    return float(best["limit"]), float(best["within"])


def nearest(errors: Mapping[str, float], within: float) -> set[str]:
    """The shares that no other one beats by more than EQUAL, or than the value is uncertain by; NaN is beaten."""
    size = {share: abs(error) for share, error in errors.items() if not math.isnan(error)}
    least = min(size.values(), default=math.nan)
    return {share for share, error in size.items() if error - least <= max(EQUAL, within)}


def turns_at(record: Mapping[str, Any]) -> float:
    """Where the path of a record ends at a limit point; NaN where it reached all loads, or failed otherwise."""
    if record["outcome"] == "converged":
        return math.nan
    return next((number(value) for key, value in record["quantities"].items() if key.endswith(END)), math.nan)


def passed(record: Mapping[str, Any]) -> float:
    """Limit points on a curve that was traced; NaN where none was."""
    return number(record["quantities"].get("limit_points"))


def confirmed(record: Mapping[str, Any], finer: Mapping[str, Any]) -> bool:
    """Does the finer mesh confirm the limit points of a record?

    Not where it goes farther than the end by FARTHER, or passes fewer of them on the way.
    """
    end = turns_at(record)
    if not math.isnan(end):
        return finer["outcome"] != "converged" and not turns_at(finer) > (1 + FARTHER) * end
    return not passed(finer) < passed(record)

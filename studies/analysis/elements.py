"""Options of the element over the ladders of scenes: the default beside that of the paper, and the thickness strain.

Errors are those of the same meshes against their common limit; of the share of the thickness strain that is sampled at
the nodes on coarse meshes, and against a reference where the meshes of a scene have no limit.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from formulations.element.mixed import THICKNESS_STRAINS
from studies.ask.declarations import Ladder
from studies.run.answers import Answer, Answers, number
from studies.run.scene_cells import COMPARED, SHARE_LABEL, meshes_of, read_at
from studies.solving.refinement.richardson import holds_from

ENOUGH = 0.01  # the error that a mesh is wanted for
EQUAL = 1e-3  # two errors this close are equal; so are two that the uncertainty of the limit does not tell apart
WHO = ("default", "paper")
CHOICE_COLUMNS = (
    *("ladder", "quantity", "verdict", "meshes", "uncertainty", "default", "paper"),
    *("default_elements", "paper_elements", "default_iterations", "paper_iterations"),
)


def element_choice(convergence: pd.DataFrame) -> pd.DataFrame:
    """CHOICE_COLUMNS, a row a quantity with a limit, which is that of the element whose limit is the more certain.

    default, paper: relative errors over the meshes, separated by blanks, coarse to fine.  uncertainty: relative, of the
    limit.  verdict: is the default better, equal or worse on the coarsest mesh, where it costs?  *_elements: from which
    the error stays below ENOUGH.  *_iterations: Newton's, on the second mesh.
    """
    own = convergence[~convergence["at"].astype(str).str.startswith("load")]  # not the benchmarks at their many loads
    default, paper = (own[own["element"] == element] for element in ("refined", "paper"))
    by = ["ladder", "quantity"]
    rows = []
    for key, pair in default.merge(paper, on=[*by, "mesh"], suffixes=("_default", "_paper")).groupby(by, sort=False):
        first = pair.iloc[0]
        known = [who for who in WHO if not math.isnan(first[f"limit_{who}"])]
        if not known:
            continue
        best = min(known, key=lambda who: float(first[f"uncertainty_{who}"]))
        limit = float(first[f"limit_{best}"])
        uncertainty, meshes = abs(float(first[f"uncertainty_{best}"]) / limit), list(pair["mesh"])
        errors = [pair[f"value_{who}"].to_numpy(float) / limit - 1 for who in WHO]
        rows.append(
            [
                *(*key, verdict_of(errors[0][0], errors[1][0], uncertainty), " ".join(meshes), uncertainty),
                *(" ".join(map(repr, each.tolist())) for each in errors),
                *(elements_for(meshes, each) for each in errors),
                *(pair[f"iterations_{who}"].iloc[1] for who in WHO),
            ]
        )
    return pd.DataFrame(rows, columns=list(CHOICE_COLUMNS))


def verdict_of(default: float, paper: float, uncertainty: float) -> str:
    """Of two relative errors against a limit that is known to ``uncertainty``."""
    default, paper = abs(default), abs(paper)
    if math.isnan(default) or math.isnan(paper):
        return "not solved by both"
    if abs(default - paper) <= max(EQUAL, uncertainty):
        return "equal"
    return "better" if default < paper else "worse"


def elements_for(meshes: Sequence[str], errors: np.ndarray) -> float:
    """Elements from which the error stays below ENOUGH, log-log between two meshes; NaN outside the meshes."""
    size = np.log([math.prod(map(int, mesh.split("x"))) for mesh in meshes])
    error = np.abs(errors)
    first = holds_from(error <= ENOUGH)
    if first in (0, len(error)):
        return math.nan
    around = [first, first - 1]
    return float(np.exp(np.interp(np.log(ENOUGH), np.log(error[around]), size[around])))


FARTHER = 0.05  # a finer mesh that goes this much farther does not confirm the end of a path
END = "_limit_point"  # ends the quantity, named by its stage, that says where a path turned back for good
SHARE_COLUMNS = (
    *("ladder", "quantity", "share", "mesh", "coarse", "known", "within", "error", "nearest"),
    *("outcome", "turns_at", "limit_points", "confirmed", "iterations", "label", "command"),
)


def thickness_share(answers: Answers, sequences: pd.DataFrame, errors: pd.DataFrame) -> pd.DataFrame:
    """SHARE_COLUMNS, a row a scene, mesh and share, of the headline of each ladder.

    sequences, errors: of ``convergence``.  coarse: on half of the default mesh, not on that.  known, within: the value
    that errors are relative to, and its relative uncertainty.  error: NaN where its load was not reached.  nearest: see
    :func:`nearest`.  turns_at: where the path ends at a limit point, in its own unit; it may pass ``limit_points``
    before.  confirmed: see :func:`confirmed`; None without a finer mesh.
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
    return pd.DataFrame(rows, columns=list(SHARE_COLUMNS))


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
        found = answers.get(SHARE_LABEL.format(ladder=ladder.name, mesh=mesh, share=share))
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

"""Options of the element over the ladders of scenes: the default beside that of the paper, and the thickness strain.

Errors are those of the same meshes against their common limit; of the share of the thickness strain that is sampled at
the nodes on coarse meshes, and against a reference where the meshes of a scene have no limit.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd

from formulations.element.mixed import THICKNESS_STRAINS
from studies.ask.declarations import Ladder
from studies.run.answers import Answer, Answers, number
from studies.run.lists import COMPARED, SHARE_LABEL, meshes_of, read_at

EQUAL = 1e-3  # two errors this close are equal; so are two that the uncertainty of the limit does not tell apart
WHO = ("default", "paper")
CHOICE_COLUMNS = ("ladder", "quantity", "verdict", *WHO)


def element_choice(convergence: pd.DataFrame) -> pd.DataFrame:
    """CHOICE_COLUMNS, a row a quantity with a limit, which is that of the element whose limit is the more certain.

    default, paper: relative errors on the coarsest mesh, where it costs.  verdict: is the default better, equal or
    worse there?
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
        ours, theirs = (float(first[f"value_{who}"]) / limit - 1 for who in WHO)
        verdict = verdict_of(ours, theirs, abs(float(first[f"uncertainty_{best}"]) / limit))
        rows.append([*key, verdict, ours, theirs])
    return pd.DataFrame(rows, columns=list(CHOICE_COLUMNS))


def verdict_of(default: float, paper: float, uncertainty: float) -> str:
    """Of two relative errors against a limit that is known to ``uncertainty``."""
    default, paper = abs(default), abs(paper)
    if math.isnan(default) or math.isnan(paper):
        return "not solved by both"
    if abs(default - paper) <= max(EQUAL, uncertainty):
        return "equal"
    return "better" if default < paper else "worse"


FARTHER = 0.05  # a finer mesh that goes this much farther does not confirm the end of a path
END = "_limit_point"  # ends the quantity, named by its stage, that says where a path turned back for good
SHARE_COLUMNS = ("ladder", "share", "coarse", "nearest", "confirmed")


def thickness_share(answers: Answers, sequences: pd.DataFrame, errors: pd.DataFrame) -> pd.DataFrame:
    """SHARE_COLUMNS, a row a scene, mesh and share, of the headline of each ladder.

    sequences, errors: of ``convergence``.  coarse: on half of the default mesh, not on that.  nearest: see
    :func:`nearest`.  confirmed: see :func:`confirmed`; None without a finer mesh.
    """
    rows: list[dict[str, Any]] = []
    for ladder in COMPARED:
        known, within = limit_of(ladder, sequences, errors)
        half, default = meshes_of(ladder)
        finer: dict[str, Answer] = {}
        for mesh, coarse in ((default, False), (half, True)):
            by_share, at = dict(_answers(answers, ladder, mesh)), read_at(ladder)
            off = {share: each.value(ladder.quantities[0], **at) / known - 1 for share, each in by_share.items()}
            near = nearest(off, within)
            for share, each in by_share.items():
                sure = confirmed(each.record, finer[share].record) if share in finer else None
                of = {"ladder": ladder.name, "share": share, "coarse": coarse}
                rows.append(of | {"nearest": share in near, "confirmed": sure})
            finer = by_share
    return pd.DataFrame(rows, columns=list(SHARE_COLUMNS))


def _answers(answers: Answers, ladder: Ladder, mesh: str) -> Iterator[tuple[str, Answer]]:
    for share in THICKNESS_STRAINS:
        answer = answers.get(SHARE_LABEL.format(ladder=ladder.name, mesh=mesh, share=share))
        if answer is not None:
            yield share, answer


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

"""Do all algorithms give the same contact set and force? Every solve of the pressed tyre beside that of semismooth."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from studies.analysis.outcomes import DEFAULT
from studies.run.answers import HERE, Answer, Answers
from studies.run.lists import agreement

SAME = 1e-7  # relative difference of forces up to which two algorithms agree
COLUMNS = (
    *("algorithm", "way", "load", "section", "epsilon", "exact", "reference", "outcome", "reason", "off", "nodes"),
    *("agrees", "penetration_mm", "mesh", "travel_mm", "travels", "command"),
)


def solves(answers: Answers) -> pd.DataFrame:
    """COLUMNS, a row a solve whose case, a load and a section, semismooth has solved with the exact condition.

    way: what of its settings is not the default of its algorithm, in words.  exact: the contact condition itself was
    asked for.  reference: it is that solve by semismooth.  off: the largest relative difference of a force from it;
    nodes: the most that are in contact in only one of the two; NaN where a travel is missing.
    """
    solved = answers.those(agreement())
    usual = {(*_case(each), each.record["contact"]): each for each in reversed(solved)}
    rows = []
    for each in solved:
        reference = answers.get(" ".join(["agreement", DEFAULT, *_case(each), "exact"]))
        if reference is None:
            continue
        off, nodes = _apart(each, reference)
        travels = [step["delta_mm"] for step in reference.steps]
        default = usual[(*_case(each), each.record["contact"])].settings
        words = [_words(key, value) for key, value in each.settings.items() if default.get(key) != value]
        rows.append(
            [
                *(each.record["contact"], ", ".join(filter(None, words)), *_case(each)),
                *(float(each.settings["epsilon"]), float(each.settings["epsilon"]) == math.inf),
                *(each.label == reference.label, each.record["outcome"], each.record["reason"]),
                *(off, nodes, off <= SAME and nodes == 0),
                max((step["kkt"]["penetration"] for step in each.steps), default=math.nan),
                *(reference.record["mesh"], max(travels, default=0), len(travels), each.command),
            ]
        )
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _case(answer: Answer) -> tuple[str, str]:
    """Load and section."""
    return str(answer.settings["load"]), str(answer.settings["section"])


def _words(key: str, value: object) -> str:
    if key == "epsilon":
        return ""
    return f"{key} {value:g}" if isinstance(value, float) else f"{key} {value}"


def _apart(answer: Answer, reference: Answer) -> tuple[float, float]:
    """The largest of the differences of forces, and of the counts of nodes, over the travels of the reference."""
    travels = [step["delta_mm"] for step in reference.steps]
    forces = np.array([[each.value("force_N", delta_mm=delta) for delta in travels] for each in (answer, reference)])
    if not travels or np.isnan(forces).any():
        return math.nan, math.nan
    off = float(np.max(np.abs(forces[0] / forces[1] - 1)))
    tables = [each.table("contact") for each in (answer, reference)]
    touching = [
        [table["active"][(table["delta_mm"] - at).abs() < HERE].to_numpy() for at in travels] for table in tables
    ]
    return off, float(max(np.sum(own != other) for own, other in zip(*touching, strict=True)))

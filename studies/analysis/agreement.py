"""Do all algorithms give the same contact set and force? Every solve of the pressed tyre beside that of semismooth.

And cells of any scene that were asked one problem and end in different certified states: which, how far apart, why.

The same problem is all that was asked but how it is solved: the algorithm with its own parameters, Newton's iteration,
the linear solver, load steps, and the part of the body that is modelled. Why is said by
:mod:`studies.solving.disagreement`. Cells that were allowed a looser tolerance than the default are left out: what they
differ by is an error of the solver (:mod:`studies.analysis.verify`), and curves by arc length end with their steps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from contact.newton.solves import RESIDUAL_TOLERANCE
from studies.analysis.outcomes import DEFAULT
from studies.analysis.verify import headline
from studies.ask.request import Request
from studies.ask.scene import EPSILON
from studies.ask.settings import MU, own_keys
from studies.run.answers import HERE, Answer, Answers, keys
from studies.run.lists import agreement
from studies.solving.disagreement import ASYMMETRIES, Facts, why
from studies.solving.result import CONVERGED, SOLVED, unit_of

SAME = 1e-7  # relative difference of forces up to which two algorithms agree
SOLVES = (
    *("algorithm", "way", "load", "section", "epsilon", "exact", "reference", "outcome", "reason", "off", "nodes"),
    *("agrees", "penetration_mm", "mesh", "travel_mm", "travels", "command"),
)


def solves(answers: Answers) -> pd.DataFrame:
    """SOLVES, a row a solve whose case, a load and a section, semismooth has solved with the exact condition.

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
        off, nodes = _off_from(each, reference)
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
    return pd.DataFrame(rows, columns=list(SOLVES))


def _case(answer: Answer) -> tuple[str, str]:
    """Load and section."""
    return str(answer.settings["load"]), str(answer.settings["section"])


def _words(key: str, value: object) -> str:
    if key == "epsilon":
        return ""
    return f"{key} {value:g}" if isinstance(value, float) else f"{key} {value}"


def _off_from(answer: Answer, reference: Answer) -> tuple[float, float]:
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


APART = 1e-6  # of the largest in a unit: more than certificates at the default tolerance leave
HOW = sorted({"contact", "newton", "solver", "tolerance", "model", "steps", *own_keys()})  # ways to one answer
ANSWERS = ("scene", "mesh", "quantity", "difference", "why", "label", "command", "other_label", "other_command")


def disagreements(table: pd.DataFrame) -> pd.DataFrame:
    """ANSWERS, a row for each further answer to a problem, beside that of most cells; table: of collect.

    Of each answer the cell is named that is most like the other in how it was solved.
    difference: the largest of a quantity, relative to the largest value in its unit.
    """
    solved = table[table["outcome"].isin(SOLVED) & (table["tolerance"] <= RESIDUAL_TOLERANCE)]
    solved = solved[solved["request"].map(_compares).astype(bool)]
    rows: list[dict[str, Any]] = []
    for scene, own in solved.groupby("scene", sort=False):
        names = _quantities(table, str(scene))
        for _, cells in own.groupby(keys(own, *HOW), sort=False):
            rows += _further(cells.to_dict("records"), names)
    return pd.DataFrame(rows, columns=list(ANSWERS))


def _compares(request: Request) -> bool:
    """Whether something may touch, and the path is not a curve by arc length."""
    return EPSILON.key in request.settings and request.settings.get("path") != "arc"


def _quantities(table: pd.DataFrame, scene: str) -> list[str]:
    """Those that are continuous in the state: forces, pressures, and what the scene is judged by."""
    names = [str(name).removeprefix("q.") for name in table if str(name).startswith("q.")]
    return [name for name in names if name.endswith(("_N", "_MPa")) or name == headline(table, scene)]


def _further(cells: Sequence[dict[Any, Any]], names: Sequence[str]) -> Iterator[dict[str, Any]]:
    """A row for each answer but that of the most cells."""
    answers: list[list[dict[Any, Any]]] = []
    for cell in cells:
        same = next((answer for answer in answers if _apart(answer[0], cell, names)[0] <= APART), None)
        if same is None:
            answers.append([cell])
        else:
            same.append(cell)
    answers.sort(key=len, reverse=True)
    for answer in answers[1:]:
        pairs = [(one, other) for one in answers[0] for other in answer]
        one, other = max(pairs, key=lambda pair: _alike(*pair))
        difference, name = _apart(one, other, names)
        yield {
            **{key: one[key] for key in ("scene", "mesh", "label", "command")},
            **{f"other_{key}": other[key] for key in ("label", "command")},
            **{"quantity": name, "difference": difference, "why": why(*map(_facts, (one, other)))},
        }


def _apart(one: dict[Any, Any], other: dict[Any, Any], names: Sequence[str]) -> tuple[float, str]:
    """The largest difference of what both have, over the largest value in its unit, and its name."""
    pairs = {name: (float(one[f"q.{name}"]), float(other[f"q.{name}"])) for name in names}
    both = {name: pair for name, pair in pairs.items() if not any(map(math.isnan, pair))}
    size: dict[str, float] = {}
    for name, pair in both.items():
        size[unit_of(name)] = max(size.get(unit_of(name), 0.0), *map(abs, pair))
    apart = ((abs(a - b) / (size[unit_of(name)] or 1.0), name) for name, (a, b) in both.items())
    return max(apart, default=(0.0, ""))


def _alike(one: dict[Any, Any], other: dict[Any, Any]) -> tuple[bool, ...]:
    """In how much two cells were solved alike, what tells the most first."""
    facts = [_facts(each) for each in (one, other)]
    return (facts[0].steps == facts[1].steps, facts[0].stable == facts[1].stable, facts[0].model == facts[1].model)


def _facts(cell: dict[Any, Any]) -> Facts:
    asymmetry = tuple(float(cell.get(f"q.{name}_asymmetry", 0.0)) for name in ASYMMETRIES)
    stable, friction = cell["outcome"] == CONVERGED, MU.key in cell["request"].settings
    return Facts(friction, (cell["request"].steps, cell.get("c.substeps")), stable, cell["model"], asymmetry)

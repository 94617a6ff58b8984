"""What the cells of the sheets answer, beside what is known of it, and what quantities mean.

Quantities that any scene may have are named here; its own a scene declares.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd

from studies.ask.request import text_of
from studies.ask.scene import Reference, judged_of, ladders_of
from studies.run.answers import Answer, Answers, number
from studies.run.lists import sheet_cell
from studies.scenes import SCENES
from studies.scenes.complete import STEP_KEYS, Cell, holding

UNITS = ("N_per_mm", "mm", "MPa", "deg", "N")
ALL: Mapping[str, str] = {  # of any scene
    "force_N": "contact force, the sum of the nodal pressures times their areas",
    "contact_nodes": "nodes that touch",
    "limit_points": "limit points of the load on the curve",
    "limit_load_fraction": "load fraction at the first limit point",
    "load_limit_point": "load fraction at which the path ends at a limit point",
}
COLUMNS = (
    *("scene", "quantity", "definition", "unit", "headline", "value", "target", "uncertainty", "kind", "source"),
    *("error", "limit", "limit_uncertainty", "finest_mesh", "verdict"),
)
ANSWERED = ("scene", "label", "mesh", "measure", "model", "outcome", "reason", "unknowns", "iterations", "command")
LOADS = (*STEP_KEYS, "radius", "motion")
NOT_LISTED = ("contact_nodes", "limit_points")


def definition(scene: str, quantity: str) -> str:
    """What a quantity is and where it is read; a value at a limit point says so."""
    of_limit = quantity.startswith("limit_") and quantity not in ALL
    bare = quantity.removeprefix("limit_") if of_limit else quantity
    declared: Mapping[str, str] = getattr(SCENES[scene], "quantities", {})
    own = {**ALL, **declared}
    meaning = next((text for name, text in own.items() if bare == name or bare.startswith(f"{name}_")), "see the scene")
    return f"{meaning}, at the first limit point" if of_limit else meaning


def unit(quantity: str) -> str:
    """The unit that a name ends in; 1 for a number without one."""
    suffix = next((name for name in UNITS if quantity.endswith(f"_{name}")), "1")
    return suffix.replace("_per_", "/")


def values(answers: Answers, convergence: pd.DataFrame) -> pd.DataFrame:
    """COLUMNS: a row a quantity and target of every scene; without a target where none holds, NaN where not solved.

    limit: extrapolated from the ladder of the scene, where it is of the same request but for the mesh.
    """
    rows = [row for scene in SCENES for row in _rows(scene, answers, convergence)]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def answered(answers: Answers) -> pd.DataFrame:
    """ANSWERED: how the cell of every scene has ended, and the command that solves it."""
    return pd.DataFrame([_answered(sheet_cell(scene), answers) for scene in SCENES], columns=list(ANSWERED))


def _answered(cell: Cell, answers: Answers) -> dict[str, Any]:
    answer = answers.get(cell.label)
    known: dict[str, Any] = {"scene": cell.scene, "label": cell.label, "command": cell.command}
    if answer is None:
        return {**known, "outcome": "not solved"}
    record, counters = answer.record, answer.record["counters"]
    fields = {name: record[name] for name in ("mesh", "measure", "model", "reason")}
    counts = {"unknowns": counters["dofs"], "iterations": counters["newton_iterations"]}
    return {**known, **fields, "outcome": record["class"], **counts}


def _rows(scene: str, answers: Answers, convergence: pd.DataFrame) -> Iterator[dict[str, Any]]:
    cell = sheet_cell(scene)
    answer = answers.get(cell.label)
    quantities = {} if answer is None or not answer.converged else _found(answer)
    known: list[Reference] = [] if answer is None else _holding(scene, answer)
    headlines = judged_of(SCENES[scene])
    names = dict.fromkeys((*headlines, *quantities, *(each.quantity for each in known)))
    for quantity in names:
        if quantity in (*LOADS, *NOT_LISTED):
            continue
        about: dict[str, Any] = {"scene": scene, "quantity": quantity, "definition": definition(scene, quantity)}
        value = number(quantities.get(quantity))
        about |= {"unit": unit(quantity), "headline": quantity in headlines, "value": value}
        about |= _limit(scene, quantity, cell, convergence)
        targets = [each for each in known if each.quantity == quantity]
        for each in targets:
            off = value / each.value - 1 if each.value else value - each.value
            reference = {
                "target": each.value,
                "uncertainty": each.uncertainty,
                "kind": each.kind,
                "source": each.source,
            }
            yield {**about, **reference, "error": off}
        if not targets:
            yield {**about, **_known_by_design(quantity, value)}


def _known_by_design(quantity: str, value: float) -> dict[str, Any]:
    """The error of a given solution has the target zero."""
    if not quantity.startswith("error_"):
        return {}
    return {"target": 0.0, "uncertainty": 0.0, "kind": "exact", "source": "the solution is given", "error": value}


def _found(answer: Answer) -> Mapping[str, float]:
    return {name: number(value) for name, value in answer.record["quantities"].items()}


def _holding(scene: str, answer: Answer) -> list[Reference]:
    """The references at the last load of the cell; of several of one quantity and kind the least uncertain."""
    last = answer.steps[-1] if answer.steps else {}
    there = {**answer.settings, "measure": answer.record["measure"]}
    there |= {key: last.get(key, _last(there.get(key))) for key in STEP_KEYS}
    return list(holding(scene, there))


def _last(value: Any) -> Any:
    return value[-1] if isinstance(value, list | tuple) and value else value


def _limit(scene: str, quantity: str, cell: Cell, convergence: pd.DataFrame) -> dict[str, Any]:
    """The extrapolated value of the first ladder of the scene, where it reads the same."""
    ladder = next(iter(ladders_of(SCENES[scene])), None)
    if ladder is None or convergence.empty:
        return {}
    own = convergence[(convergence["ladder"] == ladder.name) & (convergence["quantity"] == quantity)]
    own = own[(own["element"] == "refined") & own["limit"].notna()]
    if own.empty or any(
        text_of(cell.settings.get(key, value)) != value for key, value in ladder.settings.items() if key != "until"
    ):
        return {}
    row = own.iloc[-1]
    limit = {"limit": row["limit"], "limit_uncertainty": row["uncertainty"] / (abs(row["limit"]) or 1.0)}
    return {**limit, "finest_mesh": row["mesh"], "verdict": row["verdict"]}

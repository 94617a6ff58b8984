"""Which measure in which regime: how far off it is, and what it costs over the exact one."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pandas as pd

from studies.analysis.cells.rows import STEP_KEYS
from studies.analysis.findings.outcomes import totals
from studies.analysis.findings.ratios import RATIO_COLUMNS, ratios
from studies.analysis.findings.states import states
from studies.analysis.verify import EXACT, REFERENCE, headline


@dataclass(frozen=True)
class Regime:
    """Scenes whose shells move alike, and why they count as this."""

    name: str
    scenes: tuple[str, ...]
    why: str


REGIMES = (
    Regime(
        "shallow shells",
        ("roof-a", "roof-d", "shallow-cap"),
        "low rise over a wide span; up to 95 % of the limit load all slopes stay small beside one",
    ),
    Regime(
        "contact of a tyre",
        ("tyre",),
        "a wall that is inflated, then pressed by a plane up to 20 mm; moderate rotations at the rim of the patch",
    ),
    Regime(
        "contact of a ring",
        ("ring",),
        "a thin ring pressed between plates to half of its height; its walls turn by up to a right angle",
    ),
    Regime(
        "large rotations",
        ("hemisphere", "cantilever", "sze-pullout", "sze-annulus"),
        "no contact; rotations of half a radian to more than one",
    ),
)
REGIME_COLUMNS = (
    *("regime", "scene", "measure", "scenes", "why"),
    *("error", "error_scene", "error_load", "load_key", "against", "error_known"),
    *("problems", "solved", "path_ends", "failed", "refused", "solved_share", *RATIO_COLUMNS),
)


def regimes(table: pd.DataFrame, verified: pd.DataFrame, curves: pd.DataFrame) -> pd.DataFrame:
    """REGIME_COLUMNS, a row a regime and measure, whose scene is empty, and one for each of its scenes.

    error: the largest, signed: of the exact measure against the reference of the scene, on the mesh with most unknowns,
    known to error_known; of another one against the exact one on the same mesh, over the load of the curve of the scene
    (``curves``: of measure_errors), or, where it has none, at the last load of the finest mesh with all measures.
    Ratios: over the exact measure, on the problems that both solve.
    """
    found = states(table, "measure")
    errors = {each: _errors(table, verified, curves, each) for regime in REGIMES for each in regime.scenes}
    rows: list[dict[str, object]] = []
    for regime in REGIMES:
        own = found[found["scene"].isin(regime.scenes)]
        for measure in own["name"].unique():
            for scene in ("", *(each for each in regime.scenes if (own["scene"] == each).any())):
                cells = own if scene == "" else own[own["scene"] == scene]
                among = regime.scenes if scene == "" else (scene,)
                rows.append(_row(regime, scene, str(measure), cells, [errors[each] for each in among]))
    return pd.DataFrame(rows, columns=list(REGIME_COLUMNS))


def _row(
    regime: Regime, scene: str, measure: str, cells: pd.DataFrame, errors: list[dict[str, dict[str, object]]]
) -> dict[str, object]:
    of_measure = cells[cells["name"] == measure]
    names = ("problems", "solved", "path_ends", "failed", "refused", "solved_share")
    told = dict(zip(names, totals(of_measure), strict=True)) if len(of_measure) else dict.fromkeys(names, 0)
    there = [each[measure] for each in errors if measure in each]
    worst = max(there, key=lambda each: abs(float(str(each["error"]))), default={})
    over = dict(ratios(cells, measure, EXACT))
    who = {"regime": regime.name, "scene": scene, "measure": measure, "scenes": len(set(cells["scene"]))}
    return {**who, "why": regime.why, **worst, **told, **over}


def _errors(
    table: pd.DataFrame, verified: pd.DataFrame, curves: pd.DataFrame, scene: str
) -> dict[str, dict[str, object]]:
    """By measure: error, error_scene, error_load, load_key, against."""
    name = headline(table, scene)
    own = table[table["scene"] == scene]
    key = next((each for each in STEP_KEYS if f"q.{each}" in own and own[f"q.{each}"].notna().any()), "")
    found = _against_reference(table, verified, scene, name, key)
    curve = curves[(curves["scene"] == scene) & curves["error"].notna()] if len(curves) else curves
    if len(curve):
        for measure, rows in curve.groupby("measure", sort=False):
            at = rows.iloc[int(rows["error"].abs().to_numpy().argmax())]
            found[str(measure)] = _error(float(at["error"]), scene, float(at["load"]), key, EXACT)
        return found
    return found | _on_the_finest(own, scene, name, key)


def _error(error: float, scene: str, load: float, key: str, against: str, known: float = math.nan) -> dict[str, object]:
    where = {"error": error, "error_scene": scene, "error_load": load, "load_key": key}
    return {**where, "against": against, "error_known": known}


def _against_reference(
    table: pd.DataFrame, verified: pd.DataFrame, scene: str, quantity: str | None, key: str
) -> dict[str, dict[str, object]]:
    """The exact measure on the mesh with most unknowns."""
    rows = verified[(verified["scene"] == scene) & (verified["quantity"] == quantity) & verified["error"].notna()]
    rows = rows[rows["against"].str.startswith(REFERENCE)].merge(table, on="label", suffixes=("", ".cell"))
    rows = rows[rows["measure"] == EXACT].sort_values("c.dofs", kind="stable")
    if rows.empty:
        return {}
    last = rows[rows["reference"] == rows["reference"].mode().iloc[0]].iloc[-1]  # of the question asked most often
    load = float(last.get(f"q.{key}", math.nan))
    error = float(last["value"] / last["reference"] - 1)
    return {EXACT: _error(error, scene, load, key, str(last["against"]), float(last["uncertainty"]))}


def _on_the_finest(own: pd.DataFrame, scene: str, quantity: str | None, key: str) -> dict[str, dict[str, object]]:
    """Other measures at the last load on the finest mesh on which most measures have an answer."""
    if quantity is None or own.empty:
        return {}
    solved = own[own["outcome"].isin(("converged", "unstable")) & own[f"q.{quantity}"].notna()]
    solved = solved.assign(problem=[request.key(("measure",)) for request in solved["request"]])
    count = solved.groupby("problem")["measure"].transform("nunique")
    has_exact = solved["problem"].isin(solved.loc[solved["measure"] == EXACT, "problem"])
    there = solved[has_exact & (count > 1) & (count == count[has_exact].max())]
    if there.empty:
        return {}
    finest = there[there["problem"] == there.sort_values("c.dofs", kind="stable")["problem"].iloc[-1]]
    exact = float(finest.loc[finest["measure"] == EXACT, f"q.{quantity}"].iloc[0])
    return {
        str(row["measure"]): _error(
            float(row[f"q.{quantity}"]) / exact - 1, scene, float(row.get(f"q.{key}", math.nan)), key, EXACT
        )
        for row in finest.to_dict("records")
        if row["measure"] != EXACT
    }

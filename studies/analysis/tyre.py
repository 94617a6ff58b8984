"""What the force of the tyre is worth: each of its errors with an interval, and which grids and parts of it give it.

Mesh errors are relative to the limit of grids; what a measure, a section or a load changes is the ratio of two limits.
Of the isotropic tyre as a shell and as a solid, what the meshes leave is the finest value over the limit, what the
model leaves the shell's limit over the solid's.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from studies.analysis.evidence import Tables
from studies.experiments.choices import measure_limits
from studies.run.answers import HERE, Answer, Answers
from studies.run.lists import BUDGET_MESHES, BUDGETED, MODELS, SOLID, TYRE
from studies.scenes import SCENES
from studies.scenes.data import read_reference
from studies.solving.refinement.richardson import formal_limit, holds_from

DELTA, EARLY = 20.0, 5.0  # mm; measures are stated at both
PAPER = "one step semismooth {mesh}"  # the cell of the paper's load and section
MESHES = BUDGET_MESHES[1:]  # whose errors are stated
BUDGET_COLUMNS = ("part", "changed", "delta_mm", "change", "within", "settled", "rests_on")
MEASURE, EXACT, LIMITS = "measure", "exact", "limits of both measures"
PARTS = {"follower": "load", "full-3d": "section", "nonsymmetric": "section"}


def tyre_budget(answers: Answers, tables: Tables, solid_shell: pd.DataFrame) -> pd.DataFrame:
    """BUDGET_COLUMNS, a row an error: relative change of the force, and the half-width of its interval.

    tables: among them ``work_precision`` and ``choices``.  settled: whether the change is larger than the interval.
    rests_on: in words, what the change is read from.
    """
    rows = [*_meshes(answers, tables), *_measures(tables), *_changed(answers), *_solid(solid_shell)]
    budget = pd.DataFrame(rows, columns=["part", "changed", "delta_mm", "change", "within", "rests_on"])
    return budget.assign(settled=budget["change"].abs() > budget["within"])[list(BUDGET_COLUMNS)]


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


BODIES = {
    "solid": [cell for cell in SOLID if cell.scene == "tyre-solid" and "epsilon" not in cell.settings],
    "shell": [*SOLID[-1:], *(cell for cell in TYRE if cell.label.startswith("isotropic"))],  # coarse to fine
}
SOFT = [cell for cell in SOLID if "epsilon" in cell.settings]
FILE, FORCE = "isotropic_tyre_3d_solid.csv", "force_N_ngsolve"
FACES = ("inner", "outer")
SOLID_COLUMNS = (
    *("quantity", "at", "body", "mesh", "value", "limit", "mesh_part", "off_other", "model_part", "known_to"),
    *("cancellation", "command"),
)


def solid_shell(answers: Answers) -> pd.DataFrame:
    """SOLID_COLUMNS, a row a mesh of each body: the force by travel, the growth of the equator by face, the penalty.

    limit: extrapolated from the two finer meshes with the formal order; off_other: from the value of another program.
    model_part: shell's limit over the solid's, less one; known_to: what both limits have moved since the two coarser
    meshes, relative.  cancellation: of the membrane forces at the equator.  quantity "penalty":
    the change of the force [-] by a soft plane.
    """
    bodies = {name: answers.those(cells) for name, cells in BODIES.items()}
    if any(len(solved) < len(BODIES[name]) for name, solved in bodies.items()):
        return pd.DataFrame(columns=list(SOLID_COLUMNS))
    printed = read_reference(FILE)
    rows: list[dict[str, Any]] = []
    for delta, force in zip(printed["delta_mm"], printed[FORCE], strict=True):
        rows += _compared("force_N", {"delta_mm": float(delta)}, f"{delta:g}", bodies, float(force))
    for face in FACES:
        name = f"inflated_equator_{face}_mm"
        known = (each for each in SCENES["tyre-solid"].references if (each.quantity, each.kind) == (name, "computed"))
        rows += _compared(name, {}, face, bodies, next(known).value)
    for soft in answers.those(SOFT):
        hard = next(each for each in bodies["solid"] if each.record["mesh"] == soft.record["mesh"])
        for step in soft.steps:
            change = step["force_N"] / hard.value("force_N", delta_mm=step["delta_mm"]) - 1
            about = {"at": f"{step['delta_mm']:g}", "value": change, "command": soft.command}
            rows.append({"quantity": "penalty", **about})
    return pd.DataFrame(rows, columns=list(SOLID_COLUMNS))


def _compared(
    quantity: str, at: Mapping[str, float], words: str, bodies: Mapping[str, Sequence[Answer]], other: float
) -> list[dict[str, Any]]:
    """A row a mesh of each body."""
    rows: list[dict[str, Any]] = []
    for body, cells in bodies.items():
        sizes, values = [cell.size for cell in cells], [cell.value(quantity, **at) for cell in cells]
        limit, moved = formal_limit(sizes, values)
        own = {"quantity": quantity, "at": words, "body": body, "limit": limit, "spread": moved / abs(limit)}
        own |= {"mesh_part": values[-1] / limit - 1, "off_other": limit / other - 1}
        rows += [
            {**own, "mesh": cell.record["mesh"], "command": cell.command, "value": value}
            for cell, value in zip(cells, values, strict=True)
        ]
    solid, shell = rows[0], rows[-1]
    both = {"model_part": shell["limit"] / solid["limit"] - 1, "known_to": solid["spread"] + shell["spread"]}
    both["cancellation"] = cancellation(bodies["solid"][-1].settings)
    return [row | both for row in rows]


def cancellation(settings: Mapping[str, float]) -> float:
    """N_φ/(N_φ - ν N_ψ) at the outer equator of a torus under pressure, by membrane theory of its mid-surface.

    With the tube's radius R and its centre at Rc: N_φ = p R/2, N_ψ = p R (2 Rc + R)/(2 (Rc + R)).
    """
    R = settings["R1_mm"] + 0.5 * settings["plies"] * settings["ply_thickness_mm"]
    Rc = settings["R0_mm"] - settings["R1_mm"]
    hoop, meridian = 0.5, (2 * Rc + R) / (2 * (Rc + R))
    difference = hoop - settings["nu"] * meridian
    return hoop / difference if difference != 0 else math.inf


SAME = 1e-9  # relative difference below which a part of the tyre gives the whole
BEHIND = 2  # finer grids that a grid needs to have reached an error
WITHIN = (0.01, 0.002)  # errors of the force that an engineer asks for
MODEL_COLUMNS = ("plies", "model", "mesh", "force_off", "pressure_off", "same", "operations_share", "label", "command")
FOUND = ("mesh", "unknowns", "force_N", "error", "own_s", "total_s")  # of a grid that reaches an error
REACHING_COLUMNS = ("within", "element", "family", *FOUND, "share")


def tyre_models(answers: Answers) -> pd.DataFrame:
    """MODEL_COLUMNS, a row a model: force, largest nodal pressure and operations relative to those of the whole.

    pressure_off: infinite for another contact set; NaN where DELTA was not reached.
    """
    models = answers.those(MODELS)
    wholes = {_plies(each): each for each in models if each.record["model"] == "full"}
    rows: list[list[object]] = []
    for each in models:
        if (whole := wholes.get(_plies(each))) is None:
            continue
        off = differences(each, whole)
        share = _operations(each) / _operations(whole)
        named = [_plies(each), each.record["model"], each.record["mesh"]]
        rows.append([*named, *off, max(off) <= SAME, share, each.label, each.command])
    return pd.DataFrame(rows, columns=list(MODEL_COLUMNS))


def _operations(answer: Answer) -> float:
    """Of all that was computed, the same on every machine; NaN where a record has none."""
    return float(answer.record["counters"].get("operations") or math.nan)


def _plies(answer: Answer) -> str:
    return "isotropic" if "E_MPa" in answer.settings else "angle plies"


def differences(part: Answer, whole: Answer) -> tuple[float, float]:
    """Force and largest nodal pressure at DELTA relative to the whole."""
    force = abs(part.value("force_N", delta_mm=DELTA) / whole.value("force_N", delta_mm=DELTA) - 1)
    if math.isnan(force):
        return math.nan, math.nan
    tables = (each.table("contact") for each in (part, whole))
    own, other = (table[(table["delta_mm"] - DELTA).abs() < HERE] for table in tables)
    if not np.array_equal(own["active"], other["active"]):
        return force, math.inf
    pressures = own["pressure_MPa"].to_numpy(), other["pressure_MPa"].to_numpy()
    return force, float(np.max(np.abs(pressures[0] - pressures[1])) / np.max(pressures[1]))


def grids_reaching(grids: pd.DataFrame) -> pd.DataFrame:
    """REACHING_COLUMNS, a row an error of WITHIN, element and family: the smallest grid that reaches it, or NaN.

    grids: of work_precision_study.  share: of the unknowns of the uniform grid that reaches the same.
    """
    rows = []
    for within in WITHIN:
        for element, own in grids.groupby("element", sort=False):
            families = {str(family): reaching(each, within) for family, each in own.groupby("family", sort=False)}
            uniform = families.get("uniform")
            for family, grid in families.items():
                row = {} if grid is None else grid.to_dict()
                if grid is not None and uniform is not None:
                    row["share"] = grid["unknowns"] / uniform["unknowns"]
                rows.append({**row, "within": within, "element": element, "family": family})
    return pd.DataFrame(rows, columns=list(REACHING_COLUMNS))


def reaching(grids: pd.DataFrame, error: float) -> pd.Series | None:
    """The smallest grid from which on it and every larger one, BEHIND at the least, stay below the error; None if none.

    A force goes up and down with the place of the rim of the patch between the lines: one good grid may be chance, and
    the last grid of a family has nothing behind it.
    """
    rows = grids.sort_values("unknowns")
    first = holds_from(~(rows["error"].abs() > error))
    return rows.iloc[first] if first + BEHIND < len(rows) else None

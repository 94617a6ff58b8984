"""The isotropic tyre as a shell and as a solid: values on three meshes, their limits, and what the difference is.

What the meshes leave is the finest value over the limit, what the model leaves the shell's limit over the solid's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from studies.run.campaigns.report_cells import SOLID, TYRE
from studies.run.cells.answers import Answer, Answers
from studies.scenes import SCENES
from studies.scenes.data import read_reference
from studies.solving.refinement.richardson import formal_limit, order_of

BODIES = {
    "solid": [cell for cell in SOLID if cell.scene == "tyre-solid" and "epsilon" not in cell.settings],
    "shell": [*SOLID[-1:], *(cell for cell in TYRE if cell.label.startswith("isotropic"))],  # coarse to fine
}
SOFT = [cell for cell in SOLID if "epsilon" in cell.settings]
FILE, FORCE = "isotropic_tyre_3d_solid.csv", "force_N_ngsolve"
FACES = ("inner", "outer")
COLUMNS = (
    *("quantity", "at", "body", "mesh", "value", "limit", "order", "spread", "mesh_part"),
    *("other", "off_other", "model_part", "known_to", "cancellation", "command"),
)


def solid_shell(answers: Answers) -> pd.DataFrame:
    """COLUMNS, a row a mesh of each body: the force by travel and the growth of the equator by face; also the penalty.

    limit: extrapolated from the two finer meshes with the formal order.  spread: how far it has moved since the two
    coarser ones, relative.  other: the value of another program.  model_part: shell's limit over the solid's, less one;
    known_to: what both limits have moved.  cancellation: of the membrane forces at the equator.  quantity "penalty":
    the change of the force [-] by a soft plane.
    """
    bodies = {name: answers.those(cells) for name, cells in BODIES.items()}
    if any(len(found) < len(BODIES[name]) for name, found in bodies.items()):
        return pd.DataFrame(columns=list(COLUMNS))
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
            told = {"at": f"{step['delta_mm']:g}", "value": change, "command": soft.command}
            rows.append({"quantity": "penalty", **told})
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _compared(
    quantity: str, at: Mapping[str, float], words: str, bodies: Mapping[str, Sequence[Answer]], other: float
) -> list[dict[str, Any]]:
    """A row a mesh of each body."""
    rows: list[dict[str, Any]] = []
    for body, cells in bodies.items():
        sizes, values = [cell.size for cell in cells], [cell.value(quantity, **at) for cell in cells]
        limit, moved = formal_limit(sizes, values)
        own = {"quantity": quantity, "at": words, "body": body, "other": other, "limit": limit}
        own |= {"order": order_of(sizes, values), "spread": moved / abs(limit)}
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

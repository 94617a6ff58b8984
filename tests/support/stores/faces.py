"""Made-up tables of two faces: mortar has errors of 1/n^2, nodes of 1/n and no answer on the finest mesh of one."""

from __future__ import annotations

import math
from itertools import product

import pandas as pd

MESHES, QUANTITY, EXACT, LOST = (8, 16, 32), "P_over_ER", 2.0, "two rings"
PROBLEMS = {LOST: ("first", "second"), "ring on itself": ("first",)}
NAMES = ("semismooth", "qp", "regularised")
PLANE_S = 0.04


def made_up_faces() -> dict[str, pd.DataFrame]:
    """All tables of the page by name."""
    own = {"faces": pairings(), "faces_algorithms": algorithms(), "faces_cost": cost()}
    return own | {"faces_spheres": spheres(), "faces_ironing": ironed()}


def pairings() -> pd.DataFrame:
    """The second as slave has an error of the other sign."""
    rows = []
    for (problem, slaves), n, pairing in product(PROBLEMS.items(), MESHES, ("nodes", "mortar")):
        for sign, slave in zip((1, -1), slaves, strict=False):
            lost = problem == LOST and pairing == "nodes" and n == MESHES[-1]
            error = math.nan if lost else sign / n ** (2 if pairing == "mortar" else 1)
            said = {"problem": problem, "scene": "two-rings", "mesh": f"1x{n}", "pairing": pairing, "slave": slave}
            found = {"quantity": QUANTITY, "value": EXACT * (1 + error), "reference": EXACT, "error": error}
            ended = {"outcome": "cap-hit" if lost else "converged", "reason": "it is made up" if lost else ""}
            command = f"footprint solve two-rings --mesh 1x{n} --set pairing={pairing} --set slave={slave} {problem!r}"
            both = math.nan if len(slaves) == 1 or lost else 2 * abs(error)
            ended |= {"finest": n == MESHES[-1], "bias": both}
            spent = {"known": 3e-4, "iterations": 9, "unknowns": 14 * n, "cpu_s": 0.1}
            rows.append({**said, **found, **spent, **ended, "command": command})
    return pd.DataFrame(rows)


def algorithms() -> pd.DataFrame:
    """Springs differ, and qp refuses one of two cases."""
    rows = []
    for case, name in product(PROBLEMS, NAMES):
        refused = case == LOST and name == "qp"
        outcome = "unsupported" if refused else "converged"
        error = math.nan if refused else {"semismooth": 0.0, "qp": 1e-12, "regularised": 1e-3}[name]
        row = {"case": case, "algorithm": name, "outcome": outcome, "reason": "made up" if refused else ""}
        spent = {"iterations": 10, "substeps": 3 if name == "regularised" else 2, "command": f"{case} {name}"}
        rows.append({**row, **spent, "loads": 2, "judged": 2, "force_error": error})
    return pd.DataFrame(rows)


def cost() -> pd.DataFrame:
    """Nodes cost as much as the plane, mortar half as much again."""
    kinds = {"rigid plane": ("ring", 1.0), "nodes": ("two-rings", 1.0), "mortar": ("two-rings", 1.5)}
    return pd.DataFrame(
        [
            {"scene": scene, "pairing": name, "size": size, "unknowns": n, "cpu_s": PLANE_S * ratio, "ratio": ratio}
            for size, n in enumerate((640, 1280))
            for name, (scene, ratio) in kinds.items()
        ]
    )


def spheres() -> pd.DataFrame:
    """Facets end at 2 mm of 5, curved faces do not."""
    rows = []
    for faces, mesh, delta in product(("facets", "curved"), ("30x1", "80x1"), range(1, 6)):
        ends = faces == "facets" and delta > 2
        ended = {
            "outcome": "given-up" if faces == "facets" else "converged",
            "reason": "",
            "command": f"{faces} {mesh}",
        }
        row = {"faces": faces, "mesh": mesh, "delta_mm": delta, "quarter_N": math.nan if ends else 0.4 * delta}
        rows.append({**row, "reference": 0.4 * delta, "known": 0.05, "iterations": 40, "cpu_s": 9.0, **ended})
    return pd.DataFrame(rows)


def ironed() -> pd.DataFrame:
    """Errors of order 1 in H = 140; the shell has half of them, and is not solved on the finest mesh."""
    rows = []
    for (n, error), slab in product(((30, 0.4), (60, 0.2), (120, 0.1)), ("solid", "shell")):
        if (n, slab) == (120, "shell"):
            continue
        V, H = 400.0, 140 * (1 + (error if slab == "solid" else error / 2))
        told = {"slab": slab, "mesh": f"1x{n}", "V_press": 0.8 * V, "H_press": 0.5 * H, "V": V, "H": H}
        rows.append({**told, "ratio": H / V, "ripple": 0.1 * error, "states": 100})
    return pd.DataFrame(rows)

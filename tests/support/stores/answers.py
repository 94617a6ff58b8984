"""Tables of the analysis that page one is made of, made up: what no solve is needed for.

Answers and fields of the cells of sheets, made up: every quantity is its reference, every body is a sheared cube.
"""

from __future__ import annotations

from functools import cache
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd

from studies.analysis.everything import written
from studies.experiments.choices import COLUMNS
from studies.output.atomic import write_table
from studies.output.vtu import write_vtu
from studies.scenes import SCENES
from studies.scenes.complete import Cell

MEASURES = {"exact": 0.0, "linear": 0.4, "sanders": 0.03, "donnell": -0.2}  # errors in the limit
PROBLEMS = {  # regime, scene, settings
    ("small rotations", "scordelis-lo", ""),
    ("small rotations", "roof-a", ""),
    ("large rotations", "hemisphere", "load_fraction=1"),
    ("contact", "tyre", "delta_mm=20"),
    ("contact", "tyre", "delta_mm=5"),
}
RATIOS = {"semismooth": 1.0, "lcp": 0.9, "qp": 1.3}


def made_up_answers() -> dict[str, pd.DataFrame]:
    """Three algorithms of which one fails and one refuses, and what advice is worth."""
    return {"contact_summary": _summary(), "outcomes": _outcomes(), "held_out_summary": _held_out()}


def choices() -> pd.DataFrame:
    """Three regimes of four measures, to two errors: one measure is enough, one is not, one is not settled."""
    rows = []
    for regime, scene, settings in sorted(PROBLEMS):
        head = {"regime": regime, "scene": scene, "settings": settings, "quantity": "force_N"}
        for asked in (0.05, 0.01):
            own = {**head, "asked": asked, "axis": "measure"}
            command = f"footprint solve {scene} --mesh 16x16 --out DIR"
            offer = {"name": "exact", "contact": "semismooth", "mesh": "16x16", "seconds": 0.02 / asked, "tried": True}
            rows.append({**own, "row": "offer", **offer, "error_at_most": 0.9 * asked, "command": command})
            for name, error in MEASURES.items():
                enough = abs(error) < asked
                limit = {"formulation_error": error, "within": 0.03 if name == "sanders" else 0.001}
                by_name = {"verdict": "enough" if enough else "not enough", "mesh": "16x16" if enough else None}
                rows.append({**own, "row": "variant", "name": name, **limit, **by_name, "seconds": 0.3})
                for n in (8, 16):
                    grid = {"mesh": f"{n}x{n}", "unknowns": 6.0 * n * n, "seconds": n / 10}
                    rows.append({**own, "row": "grid", "name": name, **grid, "error_at_most": abs(error) + 1 / n**2})
            if scene == "tyre":
                rows += [{**own, "row": "algorithm", "axis": "algorithm", **_trial(name)} for name in RATIOS]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _trial(name: str) -> dict[str, object]:
    solved = name != "qp"
    record = {"name": name, "contact": name, "mesh": "16x16", "verdict": "converged" if solved else "refused"}
    return {**record, "agrees": True if solved else None, "seconds": RATIOS[name], "iterations": 9}


def write_answers(store: Path, campaign: str) -> None:
    """Put them into a store."""
    written(store, campaign, made_up_answers())
    write_table(store / "tables" / "choices.csv", choices())


def _ends(ratio: float) -> dict[str, float]:
    """Of the intervals of both costs."""
    return {
        f"{cost}_{end}": by * ratio for cost in ("seconds", "operations") for end, by in (("low", 0.9), ("high", 1.1))
    }


def _summary() -> pd.DataFrame:
    usual = {"scenes": 3, "problems": 20, "path_ends": 0, "default": "semismooth", "both": 18, "both_scenes": 3}
    names = {"semismooth": (20, 0, 0, 1.0), "lcp": (16, 4, 0, 0.8), "qp": (15, 0, 5, 1.3)}
    rows = []
    for name, (solved, failed, refused, ratio) in names.items():
        own = {**usual, "algorithm": name, "solved": solved, "failed": failed, "refused": refused}
        own |= {"solved_share": solved / (solved + failed), "causes": "4 iteration limit in ring" if failed else ""}
        own |= {"refusals": "5 not symmetric" if refused else "", "seconds_ratio": ratio, "operations_ratio": ratio}
        rows.append({**own, **_ends(ratio)})
    return pd.DataFrame(rows)


def _outcomes() -> pd.DataFrame:
    rows = []
    for axis, names in (("contact", ("semismooth", "trial-and-error")), ("measure", ("exact", "linear"))):
        for name in names:
            lost = 4 if name == "trial-and-error" else 0
            for scene, count in (("", 20), ("tyre", 12), ("ring", 8)):
                failed = lost if scene in ("", "ring") else 0
                own = {"axis": axis, "name": name, "scene": scene, "planned": count, "solved": count - failed}
                own |= {"path_ends": 0, "failed": failed, "refused": 0, "solved_share": 1 - failed / count}
                rows.append(
                    {**own, "cause": f"{failed} iteration limit" if failed else "", "command": "footprint solve"}
                )
    return pd.DataFrame(rows)


def _held_out() -> pd.DataFrame:
    """Twenty cases, nineteen of them met."""
    own = {"quantities": "headline", "scenes": 5, "cases": 20, "advised": 20, "met": 0.95, "worst_miss": 1.4}
    own |= {"median_regret": 1.0, "mean_regret": 1.5, "worst_regret": 4.0, "dear": 1.5, "share_above": 0.2}
    return pd.DataFrame([own | {"abstained": 0}])


BUILT, DRAWN = ("cantilever", "strip-contact"), ("tyre", "strip-contact")  # scenes with a model, and with fields
LOADS = ("load_fraction", "delta_mm")
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))  # in VTK's order


def sheet_answer(cell: Cell) -> tuple[dict[str, float], dict[str, float]]:
    """What the last step says, and the quantities of a cell."""
    quantities = {each.quantity: each.value for each in SCENES[cell.scene].references}
    loads = {key: float(text.split(",")[-1]) for key, text in cell.settings.items() if key in LOADS}
    return {**loads, **quantities}, quantities


@cache
def cube_text() -> str:
    """fields.vtu of eight elements."""
    lines = np.linspace(0.0, 10.0, 3)
    points = np.array([[x, y, z] for z, y, x in product(lines, repeat=3)])
    at = [[i + a + 3 * (j + b) + 9 * (k + c) for a, b, c in CORNERS] for k, j, i in product(range(2), repeat=3)]
    displacement = np.stack([0.5 * points[:, 2], 0 * points[:, 0], -0.1 * points[:, 2]], axis=-1)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "fields.vtu"
        write_vtu(path, points, np.array(at), {"displacement": displacement, "pressure": 0.01 * points[:, 2]}, {})
        return path.read_text(encoding="ascii")

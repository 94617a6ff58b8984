"""Tables of the analysis that page one is made of, made up: what no solve is needed for."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from studies.analysis.everything import written

MEASURES = {"exact": 0.001, "linear": 0.4, "sanders": 0.03, "donnell": -0.2}  # largest errors
RATIOS = {"semismooth": 1.0, "lcp": 0.9, "qp": 1.3}
SECONDS = {"exact": 1.0, "linear": 0.5, "sanders": 1.1, "donnell": 1.2}


def made_up_answers() -> dict[str, pd.DataFrame]:
    """Three regimes of four measures, three algorithms of which one fails and one refuses, prices of three scenes."""
    sizes = [(name, n, ratio * n / 1e4, ratio) for n in (2000, 10000) for name, ratio in RATIOS.items()]
    made = pd.DataFrame(sizes, columns=["algorithm", "unknowns", "seconds", "seconds_over_default"])
    made = made.assign(mesh="20x18", outcome="converged", reason="", newton_iterations=9, factorisations=9)
    made = made.assign(force_N=2000.0, operations=1e9, operations_over_default=made["seconds_over_default"])
    tables = {"regimes": _regimes(), "contact_summary": _summary(), "outcomes": _outcomes()}
    return {**tables, "price_of_accuracy": _prices(), "contact_sizes": made, "held_out_summary": _held_out()}


def write_answers(store: Path, campaign: str) -> None:
    """Put them into a store."""
    written(store, campaign, made_up_answers())


def _regimes() -> pd.DataFrame:
    rows = []
    for regime, scene in (
        ("shallow shells", "roof-a"),
        ("contact of a tyre", "tyre"),
        ("large rotations", "hemisphere"),
    ):
        for measure, error in MEASURES.items():
            own = {"regime": regime, "measure": measure, "scenes": 1, "why": "it is made up", "error": error}
            own |= {"error_scene": scene, "error_load": 20.0, "load_key": "delta_mm", "against": "exact"}
            own |= {"problems": 8, "solved": 8, "path_ends": 0, "failed": 0, "refused": 0, "solved_share": 1.0}
            own |= {"both": 8, "both_scenes": 1, "seconds_ratio": SECONDS[measure], "operations_ratio": 1.0}
            own |= _ends(SECONDS[measure])
            rows += [{**own, "scene": ""}, {**own, "scene": scene}]
    return pd.DataFrame(rows)


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
    own = {"quantities": "headline", "scenes": 5, "cases": 20, "advised": 20, "met": 0.95, "scenes_met": 4}
    own |= {"median_regret": 1.0, "mean_regret": 1.5, "worst_regret": 4.0, "dear": 1.5, "share_above": 0.2}
    return pd.DataFrame([own | {"scenes_above": 1, "abstained": 0, "scenes_abstained": 0, "truly_none": 0}])


def _prices() -> pd.DataFrame:
    rows = []
    for scene in ("tyre", "hemisphere", "roof-d"):
        for tolerance in (0.05, 0.01, 0.002):
            own = {"scene": scene, "quantity": "force_N", "against": "reference: refined", "known": 0.001}
            own |= {"tolerance": tolerance, "reached": tolerance > 0.002 or scene == "tyre", "mesh": "8x8"}
            own |= {"configuration": "exact semismooth", "error": tolerance / 2, "bound": 0.6 * tolerance}
            own |= {"seconds": 0.01 / tolerance, "operations": 1e6, "unknowns": 1 / tolerance, "cells": 9}
            rows.append({**own, "label": "cell", "command": f"footprint solve {scene}"})
    return pd.DataFrame(rows)

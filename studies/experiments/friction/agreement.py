"""The six algorithms with friction on every scene with contact, in the same load steps: do they agree, at what cost?

All are asked for the exact law, epsilon = inf, but for the regularised one, which has none: its error is shown.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd

from contact.catalogue import ALGORITHMS
from contact.coulomb import State
from studies.experiments.friction.rubbed_scenes import solved
from studies.experiments.rows import Row, tabulated
from studies.solving.result import Result

AGREED = 1e-8  # of the largest force
TOLERANCE = 1e-11  # of the residual: that of the comparison is beyond what it leaves
ACROSS = {"drag_deg": 90.0}
CASES: dict[str, tuple[str, str, Mapping[str, object]]] = {
    "tyre dragged and back": ("tyre", "14x12", {"delta_mm": 8.0, "mu": 0.5, "drag_mm": (0.5, 2.0, 8.0, 0.0), **ACROSS}),
    "tyre turned": ("tyre", "14x12", {"delta_mm": 8.0, "mu": 0.5, "turn_deg": (0.5, 2.0, 8.0)}),
    "tyre pressed, mu = 1.5": ("tyre", "14x12", {"delta_mm": 8.0, "mu": 1.5}),
    "tyre on a drum": ("tyre", "14x12", {"delta_mm": 8.0, "mu": 0.5, "foundation": "drum"}),
    "plate dragged under pressure": (
        "panel",
        "8x8",
        {"shape": "plate", "mu": 0.4, "delta_mm": 0.5, "drag_mm": (0.02, 0.1, -0.1)},
    ),
    "panel under a ball that turns": ("panel", "6x6", {"mu": 0.3, "foundation": "ball", "turn_deg": (1.0, 5.0)}),
    "crushed ring": ("crushed-ring", "1x32", {"mu": 0.4}),
    "crushed ring, solid": ("crushed-ring-solid", "2x16", {"mu": 0.4}),
    "ring": ("ring", "1x32", {"mu": 0.4}),
    "strip on a plane": ("strip-contact", "32x1", {"mu": 0.4}),
    "plate on a plane": ("plate-contact", "32x1", {"mu": 0.4}),
    "heavy strip": ("heavy-strip", "32x1", {"mu": 0.4}),
}


@tabulated
def agreement_table() -> Iterator[Row]:
    """A row a case and algorithm, compared with semismooth at all loads that both have reached.

    force_error: largest difference of a normal or tangential force of a candidate, over the largest force there.
    states: candidates of all loads that one has open, sticking or slipping and the other otherwise.  judged: loads that
    the judge certifies, by the law that was asked for.  agrees: the same states, and forces to AGREED.
    finer_error: of the regularised law, force_error on twice the elements each way; NaN where one of the two does not
    converge there, or they take other load steps.
    """
    for case in CASES:
        yield from _compared(case)


def _compared(case: str) -> Iterator[Row]:
    scene, mesh, settings = CASES[case]
    settings = {**settings, "tolerance": TOLERANCE}
    first = solved(scene, settings, mesh, contact="semismooth")
    for name in ALGORITHMS:
        exact = {} if name == "regularised" else {"epsilon": np.inf}
        found = solved(scene, {**settings, **exact}, mesh, contact=name) if name != "semismooth" else first
        reached = min(len(found.steps), len(first.steps))
        errors = [_difference(found, first, k) for k in range(reached)]
        states, error = sum(each[0] for each in errors), max((each[1] for each in errors), default=np.nan)
        yield {
            "case": case,
            "algorithm": name,
            "epsilon": found.request.number("epsilon"),
            "outcome": found.verdict,
            "reason": found.reason or found.unsupported,
            "loads": len(found.steps),
            "judged": sum(not step["failures"] for step in found.steps),
            "substeps": sum(step["substeps"] for step in found.steps),
            "states": states,
            "force_error": error,
            "agrees": int(found.verdict == "converged" and states == 0 and error <= AGREED),
            "finer_error": _on_finer_mesh(case) if name == "regularised" else np.nan,
            "iterations": found.counters.get("newton_iterations", 0),
            "factorisations": found.counters.get("factorisations", 0),
            "operations": sum(found.work.values()) / 1e6,
            "cpu_s": found.timing["cpu"],
        }


def _on_finer_mesh(case: str) -> float:
    scene, mesh, settings = CASES[case]
    n1, n2 = (2 * int(n) if int(n) > 1 else 1 for n in mesh.split("x"))
    soft, exact = (
        solved(scene, {**settings, "tolerance": TOLERANCE}, f"{n1}x{n2}", contact=name)
        for name in ("regularised", "semismooth")
    )
    ours, theirs = ([step["substeps"] for step in each.steps] for each in (soft, exact))
    if any(each.verdict != "converged" for each in (soft, exact)) or ours != theirs:
        return np.nan
    return max(_difference(soft, exact, k)[1] for k in range(len(ours)))


def _difference(one: Result, other: Result, load: int) -> tuple[int, float]:
    """Candidates in another state, and the largest difference of forces over the largest, at a load."""
    mine, theirs = (_nodes(result, load) for result in (one, other))
    touch = mine.index.union(theirs.index)
    ours, others = (nodes.reindex(touch).fillna(0.0) for nodes in (mine, theirs))
    forces = ["normal_N", "friction_x_N", "friction_y_N", "friction_z_N"]
    largest = float(np.linalg.norm(others[forces].to_numpy(), axis=1).max(initial=0.0)) or 1.0
    off = np.linalg.norm((ours[forces] - others[forces]).to_numpy(), axis=1).max(initial=0.0)
    return int((ours["state"] != others["state"]).sum()), float(off) / largest


def _nodes(result: Result, load: int) -> pd.DataFrame:
    nodes = result.tables["friction"][load].frame().set_index("candidate")
    return nodes.assign(state=np.where(nodes["sticks"] == 1, State.STICK, State.SLIP))

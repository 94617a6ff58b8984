"""What sentences on contact and friction rest on: settled sets, the tyre and its limits, algorithms."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from studies.analysis.evidence import listed
from studies.analysis.friction import FULL
from studies.analysis.outcomes import DEFAULT
from studies.analysis.statements.record import Values
from studies.experiments.friction.scenes import DELTA
from studies.run.answers import Answers
from studies.solving.result import SOLVED

MESHES = ("28x26", "42x40", "84x80")
CHANGES = {  # what of the model changes the force, by its name in the budget
    "follower": "a pressure that follows the inner face",
    "full-3d": "the full three-dimensional law, too stiff in bending,",
    "shell instead of a solid": "a solid (of an isotropic tyre)",
}


def settled(answers: Answers) -> Iterator[Values]:
    """On how many meshes the pressed tyre converges without a cut, by either rule of when an active set has settled."""
    counts = []
    for way in ("semismooth", "semismooth, settle 1"):
        solved = [answers.get(f"one step {way} {mesh}") for mesh in MESHES]
        if None in solved:
            return
        counts.append(sum(each is not None and each.converged and not each.record["cuts"] for each in solved))
    ours, theirs = counts
    yield {"meshes": len(MESHES), "ours": ours, "theirs": theirs, "_problems": 2 * len(MESHES)}


def arena(solver_summary: pd.DataFrame, solver_run: pd.DataFrame) -> Iterator[Values]:
    """Who solves most of the convex problems to the middle tolerance, and how many claim too much."""
    whole = solver_summary[(solver_summary["size"] == "all") & (solver_summary["kind"] == "convex")]
    whole = whole[whole["refused"] < whole["problems"]]
    if whole.empty:
        return
    asked = sorted(whole["tolerance"].unique(), reverse=True)
    middle, strict = (whole[whole["tolerance"] == each] for each in (asked[len(asked) // 2], asked[-1]))
    best = middle.sort_values(["solved", "mean_s"], ascending=[False, True], kind="stable").iloc[0]
    limit = dict(zip(solver_run["name"], solver_run["value"], strict=True))["limit_s"]
    values: Values = {"best": str(best["solver"]), "convex": best["problems"], "tolerance": best["tolerance"]}
    values |= {"limit": float(limit), "solvers": len(middle), "solved": best["solved"], "mean": best["mean_s"]}
    values |= {"claims": middle["claimed"].sum(), "false": middle["false"].sum(), "wrong": (middle["false"] > 0).sum()}
    own, hard = (each[each["solver"] == DEFAULT] for each in (middle, strict))
    values |= {"_problems": best["problems"], "_default": DEFAULT, "_strict": -1}
    if len(own) and len(hard):
        values |= {"ours": own["false"].iloc[0], "ours_solved": own["solved"].iloc[0], "strict": asked[-1]}
        values |= {"ours_strict": hard["false"].iloc[0], "worst": hard["worst_claim"].iloc[0]}
        values["_strict"] = values["ours_strict"]
    yield values


def force_known(work_precision: pd.DataFrame, tyre_budget: pd.DataFrame) -> Iterator[Values]:
    """How far the force of the tyre is known: by its grids, and by what its model leaves out."""
    row, changes = work_precision.iloc[0], {each["changed"]: each for each in tyre_budget.to_dict("records")}
    values: Values = {"force": row["reference_N"], "known": row["known"]}
    clauses, largest = [], 0.0
    for name, words in CHANGES.items():
        if name in changes:
            key, own = name.split()[0].replace("-", "_"), changes[name]
            values |= {key: own["change"], f"{key}_known": own["within"]}
            clauses.append(f"{words} changes it by {{{key}:+.1%}} ± {{{key}_known:.1%}}")
            largest = max(largest, abs(own["change"]) - own["within"])
    yield values | {
        "_decides": int(largest > row["known"]),
        "_told": ", ".join(clauses),
        "_changes": len(clauses),
        "_problems": len(work_precision),
    }


KEPT = 1e-9  # of the largest force: a difference of images below this is rounding


def limits(friction_drag_ends: pd.DataFrame, friction_turn_ends: pd.DataFrame) -> Iterator[Values]:
    """Force and torque once all slip, beside the closed form."""
    drag, turn = friction_drag_ends, friction_turn_ends
    both = pd.concat([drag, turn])
    values: Values = {"delta": DELTA, "mus": listed([f"{mu:g}" for mu in drag["mu"]]), "full": FULL}
    values |= {"far": drag["last"].max(), "off": drag["off"].abs().max()}
    values |= {"around": turn["last"].max(), "turn_off": turn["off"].abs().max()}
    values |= {"certified": both["certified"].sum(), "loads": both["loads"].sum(), "_problems": both["loads"].sum()}
    yield values | _full(drag, "mm", "drag") | _full(turn, "degrees", "turn")


def _full(ends: pd.DataFrame, unit: str, move: str) -> Values:
    """From where on the bound is nearly met, in words."""
    never = ends[ends["full"].isna()]
    if len(never):
        words = f"for μ = {{{move}_never}} it does not stay within {{full:.0%}} of that"
        return {f"_{move}": words, f"{move}_never": listed([f"{mu:g}" for mu in never["mu"]])}
    low, high = f"{{{move}_low:g}}", f"{{{move}_high:g}}"
    words = f"it is within {{full:.0%}} of that from {low} "
    if ends["full"].nunique() == 1:
        words += f"{unit} on"
    else:
        rises = ends.sort_values("mu")["full"].is_monotonic_increasing
        words += f"to {high} {unit} on" + (", later the larger μ" if rises else "")
    return {f"_{move}": words, f"{move}_low": ends["full"].min(), f"{move}_high": ends["full"].max()}


def patch(friction_patch: pd.DataFrame) -> Iterator[Values]:
    """Who sticks at each stop, and what is left of friction once the plane is back."""
    stops = [own for _, own in friction_patch.groupby("stop")]
    mu = friction_patch["mu"].iloc[0]
    values: Values = {"mu": mu}
    clauses = []
    for n, own in enumerate(stops):
        values |= {f"sticks{n}": own["sticks"].sum(), f"touch{n}": len(own), f"at{n}": own["drag_mm"].iloc[0]}
        clauses.append(f"{{sticks{n}:.0f}} of {{touch{n}:.0f}}" + (f" at {{at{n}:g}} mm" if n else " once pressed"))
    last = stops[-1]
    back = len(stops) > 1 and last["drag_mm"].iloc[0] == 0.0
    if back:
        pull = last[["friction_x_N", "friction_y_N", "friction_z_N"]].sum().to_numpy(float)
        values |= {"left": np.linalg.norm(pull), "bound": mu * last["normal_N"].sum()}
    values |= {"_told": listed(clauses), "_back": int(back), "_steps": friction_patch["steps"].iloc[0]}
    yield values | {"_problems": len(stops)}


def symmetry(friction_symmetry: pd.DataFrame) -> Iterator[Values]:
    """What keeps central symmetry, and what does not."""
    largest = friction_symmetry[["normal", "friction"]].max(axis=1)
    kept, broken = friction_symmetry[largest <= KEPT], friction_symmetry[largest > KEPT]
    names = {"kept": listed(list(kept["programme"])), "broken": listed(list(broken["programme"]))}
    values: Values = {**names, "rounding": largest[kept.index].max(), "off": largest[broken.index].max()}
    parts = []
    if len(kept):
        parts.append("{kept_first}, the tyre keeps its central symmetry to {rounding:.0e} of the largest force")
    if len(broken):
        who = "{broken}" if len(kept) else "{broken_first}"
        parts.append(f"{who}, it does not: forces differ by up to {{off:.0%}} from those of their images")
    values |= {f"{name}_first": text.capitalize() for name, text in names.items()}
    yield values | {"_told": "; ".join(parts), "_problems": len(friction_symmetry)}


def failures(friction_agreement: pd.DataFrame) -> Iterator[Values]:
    """Which algorithm does not end where."""
    table = friction_agreement
    lost = table[~table["outcome"].isin(SOLVED)]
    for name, own in lost.groupby("algorithm", sort=False):
        of = (table["algorithm"] == name).sum()
        values: Values = {"name": f"`{name}`", "lost": len(own), "of": of}
        yield values | {"where": listed([f"'{it}'" for it in own["case"]]), "_algorithm": str(name), "_problems": of}

"""What sentences on friction rest on: the tyre's limits, path and symmetry, and the algorithms."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from studies.analysis.evidence import listed
from studies.analysis.friction import FULL
from studies.analysis.statements.record import Values
from studies.experiments.friction.scenes import DELTA
from studies.solving.result import SOLVED

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
        clauses.append(
            f"{{sticks{n}:.0f}} of {{touch{n}:.0f}}" + (f" at {{at{n}:g}} mm" if n else " once it is pressed")
        )
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

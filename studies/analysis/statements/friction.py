"""What is said of friction: the tyre's limits, path and symmetry, the algorithms, and what they are checked by."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from studies.analysis.evidence import listed
from studies.analysis.friction import FULL, public_answers
from studies.analysis.statements.record import LIMIT, OPENING, Statement
from studies.experiments.friction.scenes import DELTA, MESH
from studies.solving.result import SOLVED

PAGE = "friction"
KEPT = 1e-9  # of the largest force: a difference of images below this is rounding
TYRE = f"the paper's whole tyre on {MESH} elements, pressed by {DELTA:g} mm"
SCOPE = f"{TYRE}, one load step from stop to stop"
SAME_STEPS = "the scenes of the page, in the same load steps, from the same start"


def limits(friction_drag_ends: pd.DataFrame, friction_turn_ends: pd.DataFrame) -> Iterator[Statement]:
    """Force and torque once all slip, beside the closed form."""
    drag, turn = friction_drag_ends, friction_turn_ends
    both = pd.concat([drag, turn])
    values: dict[str, float | str] = {"delta": DELTA, "mus": listed([f"{mu:g}" for mu in drag["mu"]]), "full": FULL}
    values |= {"far": drag["last"].max(), "off": drag["off"].abs().max()}
    values |= {"around": turn["last"].max(), "turn_off": turn["off"].abs().max()}
    values |= {"certified": float(both["certified"].sum()), "loads": float(both["loads"].sum())}
    first, first_values = _full(drag, "mm", "drag")
    second, second_values = _full(turn, "degrees", "turn")
    text = (
        "Pressed by {delta:g} mm and dragged across by {far:g} mm, the paper's tyre is pulled by μ F_n with a relative "
        f"error of {{off:.0e}} for μ = {{mus}}; {first}. Turned on the spot by {{around:g}} degrees, its torque is "
        f"μ Σ f r cos(step/2) with a relative error of {{turn_off:.0e}}; {second}. The judge certifies "
        "{certified:.0f} of {loads:.0f} loads."
    )
    count = int(both["loads"].sum())
    yield Statement(
        "friction-limits", PAGE, text, values | first_values | second_values, count, SCOPE, OPENING, machine=True
    )


def _full(ends: pd.DataFrame, unit: str, move: str) -> tuple[str, dict[str, float | str]]:
    """From where on the bound is nearly met, in words."""
    never = ends[ends["full"].isna()]
    if len(never):
        return f"for μ = {{{move}_never}} it does not stay within {{full:.0%}} of that", {
            f"{move}_never": listed([f"{mu:g}" for mu in never["mu"]])
        }
    values: dict[str, float | str] = {f"{move}_low": ends["full"].min(), f"{move}_high": ends["full"].max()}
    low, high = f"{{{move}_low:g}}", f"{{{move}_high:g}}"
    if ends["full"].nunique() == 1:
        return f"it is within {{full:.0%}} of that from {low} {unit} on", values
    later = ", later the larger μ" if ends.sort_values("mu")["full"].is_monotonic_increasing else ""
    return f"it is within {{full:.0%}} of that from {low} to {high} {unit} on{later}", values


def patch(friction_patch: pd.DataFrame) -> Iterator[Statement]:
    """Who sticks at each stop, and what is left of friction once the plane is back."""
    stops = [own for _, own in friction_patch.groupby("stop")]
    values: dict[str, float | str] = {"mu": float(friction_patch["mu"].iloc[0])}
    told = []
    for n, own in enumerate(stops):
        values |= {f"sticks{n}": float(own["sticks"].sum()), f"touch{n}": float(len(own))}
        values |= {f"at{n}": float(own["drag_mm"].iloc[0])}
        told.append(f"{{sticks{n}:.0f}} of {{touch{n}:.0f}}" + (f" at {{at{n}:g}} mm" if n else " once it is pressed"))
    text = f"With μ = {{mu:g}} the nodes in contact that stick are {listed(told)}"
    last = stops[-1]
    if len(stops) > 1 and float(last["drag_mm"].iloc[0]) == 0.0:
        pull = last[["friction_x_N", "friction_y_N", "friction_z_N"]].sum().to_numpy(float)
        values |= {"left": float(np.linalg.norm(pull)), "bound": float(values["mu"]) * float(last["normal_N"].sum())}
        text += "; back at its start the plane still pulls with {left:.0f} N of at most {bound:.0f} N: the path matters"
    scope = f"{TYRE}, {int(friction_patch['steps'].iloc[0])} load steps from stop to stop"
    yield Statement("friction-patch", PAGE, f"{text}.", values, len(stops), scope)


def symmetry(friction_symmetry: pd.DataFrame) -> Iterator[Statement]:
    """What keeps central symmetry, and what does not."""
    largest = friction_symmetry[["normal", "friction"]].max(axis=1)
    kept, broken = friction_symmetry[largest <= KEPT], friction_symmetry[largest > KEPT]
    values: dict[str, float | str] = {"kept": listed([str(name) for name in kept["programme"]])}
    values |= {"broken": listed([str(name) for name in broken["programme"]])}
    values |= {"rounding": largest[kept.index].max(), "off": largest[broken.index].max()}
    parts = []
    if len(kept):
        parts.append("{kept}, the tyre keeps its central symmetry to {rounding:.0e} of the largest force")
    if len(broken):
        parts.append("{broken}, it does not: forces differ by up to {off:.0%} from those of their images")
    text = "; ".join(parts)
    text = text.replace("{kept}", "{kept_first}", 1) if len(kept) else text.replace("{broken}", "{broken_first}", 1)
    values |= {f"{name}_first": str(values[name]).capitalize() for name in ("kept", "broken")}
    yield Statement("friction-symmetry", PAGE, f"{text}.", values, len(friction_symmetry), SCOPE, machine=True)


def failures(friction_agreement: pd.DataFrame) -> Iterator[Statement]:
    """Which algorithm does not end where."""
    table = friction_agreement
    lost = table[~table["outcome"].isin(SOLVED)]
    for name, own in lost.groupby("algorithm", sort=False):
        values: dict[str, float | str] = {"name": f"`{name}`", "lost": float(len(own))}
        values |= {"of": float((table["algorithm"] == name).sum()), "where": listed([f"'{it}'" for it in own["case"]])}
        text = "{name} does not converge on {lost:.0f} of {of:.0f} scenes with friction: {where}."
        yield Statement(f"friction-fails-{name}", PAGE, text, values, int(values["of"]), SAME_STEPS, LIMIT)


def public(friction_public: pd.DataFrame) -> Iterator[Statement]:
    """Public problems: who has an answer that the judge takes."""
    claimed, counts = public_answers(friction_public)
    certified = claimed["certified"]
    problems = friction_public.dropna(subset=["algorithm"])["problem"].nunique()
    values: dict[str, float | str] = {"problems": float(problems)}
    values |= {"solved": float(claimed[certified == "True"]["problem"].nunique())}
    values |= {"false": float((certified == "False").sum())}
    values |= {"told": listed([f"{name} {count}" for name, count in counts.items()])}
    text = (
        "Of {problems:.0f} public problems of Siconos {solved:.0f} have an answer that the judge takes; by algorithm: "
        "{told}. Of what is claimed {false:.0f} answers are refused by the judge."
    )
    scope = "rigid bodies, as published; a few seconds of the processor each"
    yield Statement("friction-public", PAGE, text, values, problems, scope, machine=True)

"""What is said of the tyre with friction: its limits, its path, its symmetry, and what friction costs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from studies.analysis.comparisons.friction import COST_BARS, FULL
from studies.analysis.statements.record import LIMIT, OPENING, Statement
from studies.experiments.friction.rubbed_scenes import COARSE, CONTACT, DELTA, MESH, MU, PATCH_STEPS

PAGE = "friction"
KEPT = 1e-9  # of the largest force: a difference of images below this is rounding
TYRE = f"the paper's whole tyre on {MESH} elements, pressed by {DELTA:g} mm"
SCOPE = f"{TYRE}, one load step from stop to stop"


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
    scope = f"{TYRE}, {PATCH_STEPS} load steps from stop to stop"
    yield Statement("friction-patch", PAGE, f"{text}.", values, len(stops), scope)


def steps(friction_step_orders: pd.DataFrame, friction_steps: pd.DataFrame) -> Iterator[Statement]:
    """What load steps cost in accuracy."""
    rows = {str(row["quantity"]): row for row in friction_step_orders.to_dict("records")}
    own = friction_steps.sort_values("steps")
    values: dict[str, float | str] = {}
    for short, name in (("force", "friction_N"), ("work", "dissipation_N_mm")):
        row = rows[name]
        values |= {f"{short}_{key}": float(row[key]) for key in ("first_error", "error", "order")}
    values |= {"fewest": float(own["steps"].iloc[0]), "most": float(own["steps"].iloc[-1])}
    values |= {"word": "step" if values["fewest"] == 1 else "steps"}
    values |= {"times": float(own["operations"].iloc[-1] / own["operations"].iloc[0])}
    text = (
        "With friction load steps are part of the answer: pressed and dragged by 1 mm in {fewest:.0f} {word} each the "
        "tyre has errors of {force_first_error:+.1%} in its force and {work_first_error:+.0%} in its dissipation; in "
        "{most:.0f} steps, at {times:.0f} times the operations, {force_error:+.2%} and {work_error:+.1%}. "
        "Observed orders in the size of a step are {force_order:.2f} and {work_order:.2f}; theory says 1."
    )
    scope = f"the whole tyre on {COARSE} elements, μ = {MU}; the limit is extrapolated"
    yield Statement("friction-steps", PAGE, text, values, len(own), scope, LIMIT)


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


def costs(friction_cost: pd.DataFrame) -> Iterator[Statement]:
    """Operations and factorisations of an iteration against what is required."""
    own = friction_cost[friction_cost["friction"] == 1]
    values: dict[str, float | str] = {f"{end}_ratio": getattr(own["operations_ratio"], end)() for end in ("min", "max")}
    values |= {f"{end}_each": getattr(own["factorisations"], end)() for end in ("min", "max")}
    values |= {
        "mesh": MESH,
        "bar": COST_BARS["friction_cost"],
        "bar_each": COST_BARS["friction_factorisations"],
    }
    above = own[
        (own["operations_ratio"] > COST_BARS["friction_cost"])
        | (own["factorisations"] > COST_BARS["friction_factorisations"])
    ]
    values |= {"above": listed([f"{row['stage']} to {row['load']:g} mm" for row in above.to_dict("records")])}
    values |= {"count": float(len(above)), "steps": float(len(own))}
    text = (
        "On {mesh} elements of the tyre an iteration with friction takes {min_ratio:.2f} to {max_ratio:.2f} times the "
        "operations of one without, and {min_each:.2f} to {max_each:.2f} factorisations, more on finer meshes; "
        "required are at most {bar:g} and {bar_each:g}, and "
    )
    text += (
        "{count:.0f} of {steps:.0f} steps exceed one of them: {above}."
        if len(above)
        else "none of {steps:.0f} steps exceeds them."
    )
    scope = f"the whole tyre on {MESH} elements, by `{CONTACT}`"
    yield Statement("friction-cost", PAGE, text, values, len(own), scope)
    times: dict[str, float | str] = {f"{end}_ratio": getattr(own["time_ratio"], end)() for end in ("min", "max")}
    text = "In processor time an iteration with friction takes {min_ratio:.2f} to {max_ratio:.2f} times one without."
    yield Statement("friction-seconds", PAGE, text, times, len(own), f"{scope}; the least of repeats", machine=True)


def listed(words: Sequence[str]) -> str:
    """Words in a list."""
    return " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))


MAKERS = (limits, patch, steps, symmetry, costs)

"""What is said of laws that every answer must keep, of manufactured solutions, and of an experiment."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.comparisons.manufactured_orders import THEORY
from studies.analysis.statements.record import OPENING, Statement

CORDS = 52.0  # deg, of the paper's tyre


def manufactured(manufactured_orders: pd.DataFrame) -> Iterator[Statement]:
    """Orders against theory."""
    orders = manufactured_orders["order_displacement"]
    values = {"cases": float(len(orders)), "low": orders.min(), "high": orders.max()}
    values |= {"measures": float(manufactured_orders["measure"].nunique()), "theory": THEORY["error_displacement"]}
    text = (
        "Against manufactured solutions the displacement of {measures:.0f} measures converges with an order between "
        "{low:.3f} and {high:.3f} in {cases:.0f} cases; theory says {theory:g}."
    )
    scope = "between the two finest meshes; smooth solutions"
    yield Statement("manufactured", "convergence", text, values, len(orders), scope, OPENING)


def symmetry(symmetry: pd.DataFrame) -> Iterator[Statement]:
    """What must not matter."""
    broken = symmetry[symmetry["class"] == "broken by accident"]
    design = symmetry[symmetry["class"] == "broken by design"]
    kept = symmetry[~symmetry["class"].isin(["broken by accident", "broken by design"])]
    values = {"checks": float(len(symmetry)), "broken": float(len(broken)), "design": float(len(design))}
    values |= {"largest": float(kept["deviation"].max())}
    text = (
        "Of {checks:.0f} checks of axes, numbering, units, load steps and rigid motions {broken:.0f} fail "
        "unexpectedly. {design:.0f} fail as they must: the measure is not exact, or the cords break the symmetry. The "
        "others deviate by at most {largest:.0e}."
    )
    scope = "small clamped panels and the tyre on a coarse mesh, by every measure and algorithm"
    yield Statement("symmetry", "invariance", text, values, len(symmetry), scope, OPENING, machine=True)


def mirror(mirror: pd.DataFrame, tyre_symmetry: pd.DataFrame) -> Iterator[Statement]:
    """How far the contact pressure of the paper's tyre is from its mirror image, and of one with other cords."""
    stable = mirror[(mirror["outcome"] == "converged") & (mirror["negative"] == 0) & (mirror["measure"] == "exact")]
    finest = stable[stable["mesh"] == "42x40"].dropna(subset=["mirror_both_MPa"])
    printed = tyre_symmetry[(tyre_symmetry["who"] == "printed") & tyre_symmetry["image"].str.startswith("mirror")]
    own = finest[finest["gamma_deg"] == CORDS]
    if own.empty or printed.empty:
        return
    here, worst = own.iloc[0], finest.iloc[int(finest["mirror_both_MPa"].argmax())]
    values = {"cords": CORDS, "pressure": here["mirror_both_MPa"], "share": here["mirror_both_MPa"] / here["peak_MPa"]}
    values |= {"printed": printed["both_touch_MPa"].max(), "central": finest["central_MPa"].max()}
    values |= {"angle": worst["gamma_deg"], "most": worst["mirror_both_MPa"], "angles": float(len(finest))}
    text = (
        "The cords of the paper's tyre at ±{cords:g} deg break the mirror symmetry of its contact pressure by "
        "{pressure:.3f} MPa, {share:.1%} of the peak (printed table: {printed:.3f} MPa); of {angles:.0f} cord angles "
        "with a stable state ±{angle:.1f} deg gives most, {most:.3f} MPa. Half a turn about the contact normal changes "
        "the pressure by {central:.0e} MPa."
    )
    scope = "the paper's tyre on its mesh at 20 mm, stable states, nodes that touch on both sides"
    yield Statement("mirror", "invariance", text, values, len(finest), scope)


def fuzz(fuzz: pd.DataFrame, fuzz_faults: pd.DataFrame) -> Iterator[Statement]:
    """Random cases."""
    counts = fuzz["verdict"].value_counts()
    found = fuzz_faults[fuzz_faults["cases"] > 0]
    values = {"cases": float(len(fuzz)), "broken": float(counts.get("broken", 0))}
    values |= {"explained": float(counts.get("explained", 0)), "faults": float(len(fuzz_faults))}
    values |= {"found": float(len(found)), "latest": float(found["cases"].max()) if len(found) else 0.0}
    text = (
        "Of {cases:.0f} random cases a law is violated in {broken:.0f}; {explained:.0f} differ for identified "
        "reasons. {found:.0f} of {faults:.0f} planted faults are detected, by case {latest:.0f} at the latest."
    )
    scope = "drawn from one sequence of seeds; a fault of another kind may go unseen"
    yield Statement("random-cases", "invariance", text, values, len(fuzz), scope, OPENING)


def experiment(ring_budget: pd.DataFrame) -> Iterator[Statement]:
    """Forces that were measured."""
    last = ring_budget[ring_budget["delta_mm"] == ring_budget["delta_mm"].max()].set_index("body")
    if not {"solid hencky", "solid svk", "shell exact"} <= set(last.index):
        return
    measured = last["measured_N"].iloc[0]
    hencky, svk, shell = (last.loc[name, "limit_N"] for name in ("solid hencky", "solid svk", "shell exact"))
    values = {"measured": measured, "hencky": hencky / measured - 1, "svk": svk / measured - 1}
    values |= {"shell": shell / svk - 1, **{part: last.loc["solid hencky", part] for part in ("friction", "remainder")}}
    text = (
        "Against the force of a crushed polyurethane ring that was measured ({measured:.2f} N at the end) a solid with "
        "Hencky's law has an error of {hencky:+.1%}"
    )
    if values["friction"] * values["remainder"] < 0:
        text += (
            " (friction, which is missing, {friction:+.2f} N, and what is not explained, {remainder:+.2f} N, cancel)"
        )
    text += ", one with the law of the shell {svk:+.1%}, and the shell {shell:+.1%} from that"
    if max(abs(values["hencky"]), abs(values["shell"])) < abs(values["svk"]):
        text += ": the error of the law is larger than that of the shell"
    scope = "one specimen, four readings on a line; friction and the bend of the curve are not known"
    yield Statement("experiment", "shell-limits", f"{text}.", values, len(ring_budget), scope, OPENING)


MAKERS = (manufactured, symmetry, mirror, fuzz, experiment)

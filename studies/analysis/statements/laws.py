"""What is said of laws that every answer must keep, of manufactured solutions, and of an experiment."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.comparisons.manufactured_orders import THEORY
from studies.analysis.statements.record import OPENING, Statement


def manufactured(manufactured_orders: pd.DataFrame) -> Iterator[Statement]:
    """Orders against theory."""
    orders = manufactured_orders["order_displacement"]
    values = {"cases": float(len(orders)), "low": orders.min(), "high": orders.max()}
    values |= {"measures": float(manufactured_orders["measure"].nunique()), "theory": THEORY["error_displacement"]}
    text = (
        "In {cases:.0f} cases of {measures:.0f} measures the error of the displacement against an exact solution falls "
        "with an order between {low:.3f} and {high:.3f}; theory says {theory:g}."
    )
    scope = "between the two finest meshes; smooth solutions"
    yield Statement("manufactured", "manufactured", text, values, len(orders), scope, OPENING)


def symmetry(symmetry: pd.DataFrame) -> Iterator[Statement]:
    """What must not matter."""
    broken = symmetry[symmetry["class"] == "broken by accident"]
    design = symmetry[symmetry["class"] == "broken by design"]
    kept = symmetry[~symmetry["class"].isin(["broken by accident", "broken by design"])]
    values = {"checks": float(len(symmetry)), "broken": float(len(broken)), "design": float(len(design))}
    values |= {"largest": float(kept["deviation"].max())}
    text = (
        "Axes, numbering, units, load steps and rigid motions do not matter: of {checks:.0f} checks {broken:.0f} are "
        "broken by accident, {design:.0f} by design, where a measure or the cords say so; the others keep their "
        "symmetry to {largest:.0e}."
    )
    scope = "small clamped panels and the tyre on a coarse mesh, by every measure and algorithm"
    yield Statement("symmetry", "symmetry", text, values, len(symmetry), scope, OPENING, machine=True)


def mirror(mirror: pd.DataFrame) -> Iterator[Statement]:
    """How far the contact pressure of an angle-ply tyre is from its mirror image."""
    stable = mirror[(mirror["outcome"] == "converged") & (mirror["negative"] == 0) & (mirror["measure"] == "exact")]
    finest = stable[stable["mesh"] == "42x40"].dropna(subset=["mirror_both_MPa"])
    if finest.empty:
        return
    worst = finest.iloc[int(finest["mirror_both_MPa"].argmax())]
    values = {"angle": worst["gamma_deg"], "pressure": worst["mirror_both_MPa"], "peak": worst["peak_MPa"]}
    values |= {"share": worst["mirror_both_MPa"] / worst["peak_MPa"], "central": finest["central_MPa"].max()}
    text = (
        "Angle plies break the mirror symmetry of the contact pressure by up to {pressure:.3f} MPa, {share:.0%} of its "
        "peak, at ±{angle:.1f} deg; half a turn about the contact normal changes it by {central:.0e} MPa."
    )
    scope = "the paper's tyre on its mesh, stable states"
    yield Statement("mirror", "symmetry", text, values, len(finest), scope)


def fuzz(fuzz: pd.DataFrame, fuzz_faults: pd.DataFrame) -> Iterator[Statement]:
    """Random cases."""
    counts = fuzz["verdict"].value_counts()
    found = fuzz_faults[fuzz_faults["cases"] > 0]
    values = {"cases": float(len(fuzz)), "broken": float(counts.get("broken", 0))}
    values |= {"explained": float(counts.get("explained", 0)), "faults": float(len(fuzz_faults))}
    values |= {"found": float(len(found)), "latest": float(found["cases"].max()) if len(found) else 0.0}
    text = (
        "Of {cases:.0f} random cases {broken:.0f} break a law and {explained:.0f} differ for a reason that is "
        "computed. {found:.0f} of {faults:.0f} planted faults are found, by case {latest:.0f} at the latest."
    )
    scope = "drawn from one sequence of seeds; a fault of another kind may go unseen"
    yield Statement("random-cases", "fuzz", text, values, len(fuzz), scope, OPENING)


def experiment(ring_budget: pd.DataFrame) -> Iterator[Statement]:
    """Forces that were measured."""
    last = ring_budget[ring_budget["delta_mm"] == ring_budget["delta_mm"].max()].set_index("body")
    if not {"solid hencky", "solid svk", "shell exact"} <= set(last.index):
        return
    measured = last["measured_N"].iloc[0]
    hencky, svk, shell = (last.loc[name, "limit_N"] for name in ("solid hencky", "solid svk", "shell exact"))
    values = {"measured": measured, "hencky": hencky / measured - 1, "svk": svk / measured - 1}
    values |= {"shell": shell / svk - 1}
    text = (
        "Of a crushed polyurethane ring that was measured ({measured:.2f} N at the end) a solid with Hencky's law is "
        "{hencky:+.1%} off, one with the law of the shell {svk:+.1%}, and the shell {shell:+.1%} from that"
    )
    if max(abs(values["hencky"]), abs(values["shell"])) < abs(values["svk"]):
        text += ": the law is missed by more than the shell is"
    scope = "one specimen, four readings on a line; friction and the bend of the curve are not known"
    yield Statement("experiment", "experiment", f"{text}.", values, len(ring_budget), scope, OPENING)


MAKERS = (manufactured, symmetry, mirror, fuzz, experiment)

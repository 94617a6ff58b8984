"""What is said because users ask: units, solvers, pressures, closed forms, the size of a regularisation."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from studies.analysis.cells.answers import Answers
from studies.analysis.statements.record import ANSWER, Statement

UNITS = ("lengths over 1e6, stresses times 1e6", "lengths times 1e6, stresses over 1e6")
CONTACT_SCENES = ("strip-contact", "plate-contact", "ring", "heavy-strip")
TYRE_AT = 20.0  # mm
MESHES = ("28x26", "42x40", "84x80")


def units(symmetry: pd.DataFrame) -> Iterator[Statement]:
    """The unit system."""
    own = symmetry[symmetry["check"].isin(UNITS)]
    if own.empty:
        return
    broken = float(own["class"].str.startswith("broken").sum())
    values = {"pairs": float(len(own)), "broken": broken, "off": own["deviation"].max()}
    values |= {"more": (own["iterations"] != own["iterations_other"]).sum()}
    text = (
        "Measured in lengths a million times larger or smaller, {broken:.0f} of {pairs:.0f} contact problems change "
        "beyond rounding (largest deviation {off:.0e}), and {more:.0f} take another number of iterations."
    )
    scope = "small clamped panels pressed by a plane or a ball, every measure with every algorithm"
    yield Statement("units", "symmetry", text, values, len(own), scope, ANSWER, machine=True)


def solvers(fuzz: pd.DataFrame) -> Iterator[Statement]:
    """Another linear solver, another algorithm."""
    for name, law, what in (
        ("another-solver", "another solver", "another sparse direct solver"),
        ("another-algorithm", "another algorithm", "another contact algorithm"),
    ):
        own = fuzz[fuzz["law"] == law]
        if own.empty:
            continue
        counts = own["verdict"].value_counts()
        values: dict[str, float | str] = {
            "what": what,
            "cases": float(len(own)),
            "agree": float(counts.get("agrees", 0)),
        }
        values |= {"explained": float(counts.get("explained", 0)), "broken": float(counts.get("broken", 0))}
        text = (
            "Solved once more by {what}, {agree:.0f} of {cases:.0f} random requests give the same answer to 1e-6, "
            "{explained:.0f} differ for a computed reason and {broken:.0f} without one."
        )
        yield Statement(name, "fuzz", text, values, len(own), "requests drawn at random over all scenes", ANSWER)


def epsilon_range(epsilon_laws: pd.DataFrame) -> Iterator[Statement]:
    """How to choose the penalty."""
    own = epsilon_laws.set_index("case")
    if "tyre" not in own.index:
        return
    row = own[own.index == "tyre"].to_dict("records")[0]
    values = {"soft": row["soft_until"], "level": row["level_from"], "slope": row["force_slope"]}
    if any(math.isnan(value) for value in values.values()):
        return
    text = (
        "On the tyre a regularisation p = ε <-g> is off by more than 1 % up to ε = {soft:g} MPa/mm; from there on its "
        "error falls as ε to the {slope:.1f}, down to rounding at {level:g}, when the pressure is kept as an unknown."
    )
    scope = "the tyre at 20 mm; scale ε with pressure over the gap that may stay open"
    yield Statement("epsilon-range", "epsilon", text, values, 1, scope, ANSWER, machine=True)


def hemisphere(convergence: pd.DataFrame, convergence_errors: pd.DataFrame) -> Iterator[Statement]:
    """The pinched hemisphere, which other codes get half of."""
    own = convergence[(convergence["ladder"] == "hemisphere") & (convergence["quantity"] == "inward_mm")]
    pairs = convergence_errors[
        convergence_errors["sequence"].isin(own["sequence"]) & (convergence_errors["kind"] == "read")
    ]
    pairs = pairs.dropna(subset=["model_part"])
    if pairs.empty or own["limit"].isna().all():
        return
    limit, last = float(own["limit"].dropna().iloc[-1]), pairs.iloc[-1]
    first = own.iloc[0]
    values: dict[str, float | str] = {
        "limit": limit,
        "published": float(last["value"]),
        "off": float(last["model_part"]),
    }
    values |= {"mesh": str(first["mesh"]), "coarse": float(first["value"]) / limit - 1}
    text = (
        "The inward displacement of the pinched hemisphere converges to {limit:.4f} mm, {off:+.2%} from the published "
        "{published:.3f}; {mesh} elements are {coarse:+.2%} off their limit."
    )
    scope = "default element, no drilling stiffness to choose; the published value is a finite-element result itself"
    yield Statement("hemisphere", "convergence", text, values, len(own), scope, ANSWER)


def pressures(tyre_comparison: pd.DataFrame) -> Iterator[Statement]:
    """Do pressures add up to the force?"""
    own = tyre_comparison[tyre_comparison["phi_per_label"] == 0.5]
    off = (own["own_sum_N"] / own["force_N"] - 1).abs()
    at = own[own["delta_mm"] == TYRE_AT]
    if at.empty:
        return
    values = {"off": off[at.index].iloc[0], "centre": at["centre_MPa"].iloc[0], "delta": TYRE_AT}
    values |= {"force": at["force_N"].iloc[0]}
    text = (
        "Pressures times nodal areas give the force of the plane to {off:.2%} on the tyre at {delta:g} mm "
        "({force:.1f} N, {centre:.4f} MPa in the centre)."
    )
    scope = "areas of the middle surface as the section integrates them; lumped coupling"
    yield Statement("pressure-sum", "tyre", text, values, len(own), scope, ANSWER)


def contact_orders(manufactured_contact_orders: pd.DataFrame) -> Iterator[Statement]:
    """How fast the pressure converges."""
    own = manufactured_contact_orders
    values = {"cases": float(len(own)), "low": own["order_pressure"].min(), "high": own["order_pressure"].max()}
    values |= {"edge": own["edge_elements"].max(), "middle": own["order_pressure"].median()}
    text = (
        "Against exact solutions with a moving edge of contact the pressure converges with an order of {middle:.2f} in "
        "the median of {cases:.0f} cases ({low:.2f} to {high:.2f}), and the edge is met within {edge:.1f} elements."
    )
    scope = "manufactured solutions; a rim that carries a line force converges more slowly"
    yield Statement("pressure-order", "manufactured", text, values, len(own), scope, ANSWER)


def closed_forms(convergence: pd.DataFrame, convergence_errors: pd.DataFrame) -> Iterator[Statement]:
    """Contact problems with a closed form."""
    own = convergence[convergence["scene"].isin(CONTACT_SCENES)].drop_duplicates("sequence")
    pairs = convergence_errors[
        convergence_errors["sequence"].isin(own["sequence"]) & (convergence_errors["kind"] == "exact")
    ]
    pairs = pairs.drop_duplicates(["sequence", "reference"], keep="last")
    if pairs.empty:
        return
    off = pairs["error"].abs()
    values = {
        "cases": float(len(pairs)),
        "scenes": float(own["scene"].nunique()),
        "off": off.max(),
        "middle": off.median(),
    }
    text = (
        "On the finest meshes of {scenes:.0f} contact problems with a closed form {cases:.0f} quantities are off by at "
        "most {off:.2%}, {middle:.3%} in the median."
    )
    scope = "beams and rings on rigid planes; there is no Hertz problem of solids"
    yield Statement("closed-forms", "convergence", text, values, len(pairs), scope, ANSWER)


def settled(answers: Answers) -> Iterator[Statement]:
    """When an active set has settled."""
    ways = ("semismooth", "semismooth, settle 1")
    found = {way: [answers.get(f"one step {way} {mesh}") for mesh in MESHES] for way in ways}
    known = {way: [each for each in own if each is not None] for way, own in found.items()}
    if any(len(own) < len(MESHES) for own in known.values()):
        return
    ours, theirs = (sum(each.converged and not each.record["cuts"] for each in known[way]) for way in ways)
    values = {"meshes": float(len(MESHES)), "ours": float(ours), "theirs": float(theirs)}
    text = (
        "Pressed by 20 mm in one step on {meshes:.0f} meshes, `semismooth`, which updates the contact set on one "
        "linearisation until few nodes change, ends without a cut on {ours:.0f}; with a linearisation for every set "
        "(settle 1) on {theirs:.0f}. Either ends only when no node changes any more."
    )
    scope = "half of the paper's tyre"
    yield Statement("settling", "algorithms", text, values, 2 * len(MESHES), scope, ANSWER)


MAKERS = (units, solvers, epsilon_range, hemisphere, pressures, contact_orders, closed_forms, settled)

"""What is said because users ask: units, solvers, pressures, closed forms, the size of a regularisation."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.cells.answers import Answers
from studies.analysis.comparisons.ladders import DEFAULT
from studies.analysis.statements.record import ANSWER, OPENING, Statement

UNITS = ("lengths over 1e6, stresses times 1e6", "lengths times 1e6, stresses over 1e6")
CONTACT_SCENES = ("strip-contact", "plate-contact", "ring", "heavy-strip")
TYRE_AT = 20.0  # mm
PAPER_EPSILON = 1e4  # MPa/mm
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
    yield Statement("units", "invariance", text, values, len(own), scope, ANSWER, machine=True)


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
        yield Statement(name, "invariance", text, values, len(own), "requests drawn at random over all scenes", ANSWER)


def epsilon_range(epsilon: pd.DataFrame, epsilon_laws: pd.DataFrame) -> Iterator[Statement]:
    """How to choose the penalty, and what the paper's is."""
    own, tyre = epsilon_laws, epsilon["case"] == "tyre"
    paper = epsilon[tyre & (epsilon["form"] == "displacement") & (epsilon["epsilon"] == PAPER_EPSILON)]
    walls = own.loc[own["case"] == "tyre", "wall"]
    if walls.empty or paper.empty:
        return
    values = {"cases": float(len(own)), "error": own["error_at_wall"].max(), "growth": own["growth_at_wall"].max()}
    values |= {"ten": own["growth_at_ten"].max(), "lost": float((own["fails_at"] <= 1).sum())}
    values |= {"names": ", ".join(own.loc[own["fails_at"] <= 1, "case"]) or "none", "wall": walls.iloc[0]}
    values |= {"paper": PAPER_EPSILON, "times": PAPER_EPSILON / walls.iloc[0]}
    values |= {"off": paper["force_error"].abs().iloc[0], "mesh": str(paper["mesh"].iloc[0])}
    text = (
        "A penalty p = ε <-g> with ε = E/h, the largest modulus over the thickness of the wall, gives the force of "
        "{cases:.0f} problems within {error:.1%} of exact contact; the condition number grows {growth:.2g}-fold "
        "at most. Ten times that ε makes the error about a tenth and the condition number up to {ten:.2g}-fold."
    )
    if values["lost"]:
        text += " On {lost:.0f} of them ({names}) no ε from E/h on reaches a residual of 1e-9."
    text += (
        " E/h is {wall:.3g} MPa/mm for the paper's tyre; the paper's {paper:g} MPa/mm is {times:.2g} times that and "
    )
    text += "changes the force at 20 mm by {off:.0e} (mesh {mesh})."
    scope = "elements no smaller than the wall is thick, a penetration p h/E that is small beside the travel"
    yield Statement("epsilon-range", "algorithms", text, values, len(own), scope, OPENING, machine=True)


def hemisphere(convergence: pd.DataFrame, convergence_errors: pd.DataFrame) -> Iterator[Statement]:
    """The pinched hemisphere, which other codes get half of."""
    own = convergence[(convergence["ladder"] == "hemisphere") & (convergence["quantity"] == "inward_mm")]
    own = own[own["element"] == DEFAULT]
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
        "{published:.3f}; {mesh} elements err by {coarse:+.2%} of their limit."
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
    yield Statement("pressure-order", "convergence", text, values, len(own), scope, ANSWER)


def closed_forms(convergence: pd.DataFrame, convergence_errors: pd.DataFrame) -> Iterator[Statement]:
    """Contact problems with a closed form."""
    own = convergence[convergence["scene"].isin(CONTACT_SCENES) & (convergence["element"] == DEFAULT)]
    own = own.drop_duplicates("sequence")
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
        "On the finest meshes of {scenes:.0f} contact problems with a closed form {cases:.0f} quantities err by at "
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
        "linearisation until few nodes change, converges without a cut on {ours:.0f}; with a linearisation for every "
        "set (settle 1) on {theirs:.0f}. Either has converged only when no node changes any more."
    )
    scope = "half of the paper's tyre"
    yield Statement("settling", "algorithms", text, values, 2 * len(MESHES), scope, ANSWER)


MAKERS = (units, solvers, epsilon_range, hemisphere, pressures, contact_orders, closed_forms, settled)

"""What is said of algorithms with friction, and of the answers that they are checked by."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from studies.analysis.comparisons.friction import FIRST, FLOOR
from studies.analysis.evidence import listed
from studies.analysis.statements.friction import PAGE
from studies.analysis.statements.record import LIMIT, OPENING, Statement
from studies.experiments.friction.scenes.agreement import AGREED
from studies.result import SOLVED

SAME_STEPS = "the scenes of the page, in the same load steps, from the same start"


def agreement(friction_algorithms: pd.DataFrame) -> Iterator[Statement]:
    """Who agrees with the first one everywhere, who does not, and what regularisation changes."""
    table = friction_algorithms
    cases = int(table["cases"].max())
    exact = table[(table["exact"] == 1) & (table["algorithm"] != FIRST)]
    every = exact[exact["agrees"] == exact["cases"]]
    values: dict[str, float | str] = {"cases": float(cases), "bound": AGREED, "first": f"`{FIRST}`"}
    values |= {"ends": float(table.loc[table["algorithm"] == FIRST, "solved"].sum())}
    values |= {"names": listed([f"`{name}`" for name in every["algorithm"]])}
    text = "{first} converges on {ends:.0f} of {cases:.0f} scenes with friction"
    if len(every):
        text += "; so do {names}, with every node in the same state and forces that differ by at most {bound:.0e}"
    for n, row in enumerate(exact[exact["agrees"] < exact["cases"]].to_dict("records")):
        values |= {f"name{n}": f"`{row['algorithm']}`", f"solved{n}": float(row["solved"])}
        values |= {f"agrees{n}": float(row["agrees"])}
        text += f"; {{name{n}}} converges on {{solved{n}:.0f}} and agrees on {{agrees{n}:.0f}}"
    yield Statement("friction-agreement", PAGE, f"{text}.", values, cases * len(table), SAME_STEPS, OPENING)


def failures(friction_agreement: pd.DataFrame) -> Iterator[Statement]:
    """Which algorithm does not end where, and where other load steps make another path."""
    table = friction_agreement
    lost = table[~table["outcome"].isin(SOLVED)]
    for name, own in lost.groupby("algorithm", sort=False):
        values: dict[str, float | str] = {"name": f"`{name}`", "lost": float(len(own))}
        values |= {
            "of": float((table["algorithm"] == name).sum()),
            "where": listed([f"'{case}'" for case in own["case"]]),
        }
        text = "{name} does not converge on {lost:.0f} of {of:.0f} scenes with friction: {where}."
        yield Statement(f"friction-fails-{name}", PAGE, text, values, int(values["of"]), SAME_STEPS, LIMIT)
    first = table[table["algorithm"] == FIRST].set_index("case")["substeps"]
    cut = table[table["outcome"].isin(SOLVED) & (table["substeps"] != table["case"].map(first))]
    if cut.empty:
        return
    worst = cut.iloc[int(cut["force_error"].argmax())]
    values = {"count": float(len(cut)), "name": f"`{worst['algorithm']}`", "case": f"'{worst['case']}'"}
    values |= {"off": float(worst["force_error"]), "steps": float(worst["substeps"])}
    values |= {"asked": float(first[worst["case"]])}
    values |= {"all": float(table["outcome"].isin(SOLVED).sum())}
    text = (
        "{count:.0f} of {all:.0f} converged solves took other load steps than `semismooth`, another path: {name} on "
        "{case} needed {steps:.0f} instead of {asked:.0f}, and its forces differ by {off:.0%} of the largest."
    )
    yield Statement("friction-other-steps", PAGE, text, values, len(cut), SAME_STEPS)


def regularisation(friction_agreement: pd.DataFrame) -> Iterator[Statement]:
    """How far a regularised law is from the exact one."""
    table = friction_agreement
    first = table[table["algorithm"] == FIRST].set_index("case")["substeps"]
    own = table[np.isfinite(table["epsilon"]) & table["outcome"].isin(SOLVED)]
    own = own[own["substeps"] == own["case"].map(first)]
    if own.empty:
        return
    values: dict[str, float | str] = {"low": own["force_error"].min(), "high": own["force_error"].max()}
    values |= {"cases": float(len(own)), "epsilons": listed(sorted({f"{each:g}" for each in own["epsilon"]}))}
    values |= {"states": float(own["states"].sum()), "median": own["force_error"].median()}
    text = (
        "Coulomb's law regularised by springs of {epsilons} MPa/mm changes nodal forces by {low:.0e} to {high:.0e} of "
        "the largest on {cases:.0f} scenes, one mesh each, {median:.0e} in the median; {states:.0f} nodes are in "
        "another state. Finer meshes, or other load steps, may differ by more."
    )
    yield Statement("friction-regularised", PAGE, text, values, len(own), f"{SAME_STEPS}; one stiffness of springs")


def closed_forms(friction_orders: pd.DataFrame) -> Iterator[Statement]:
    """Orders against theory."""
    table = friction_orders
    known = table.dropna(subset=["order"])
    if known.empty:
        return
    values: dict[str, float | str] = {"families": listed(list(dict.fromkeys(table["family"])))}
    values |= {"errors": float(len(table)), "floor": FLOOR, "rounding": float(len(table) - len(known))}
    told = []
    for theory, own in known.groupby("theory", sort=True):
        n = f"{theory:g}"
        values |= {f"low{n}": own["order"].min(), f"high{n}": own["order"].max(), f"count{n}": float(len(own))}
        told.append(f"{{count{n}:.0f}} fall with orders from {{low{n}:.2f}} to {{high{n}:.2f}} where theory says {n}")
    text = "Of {errors:.0f} errors against closed forms ({families}) {rounding:.0f} are below {floor:.0e}"
    text += f", {listed(told)}."
    yield Statement("friction-orders", PAGE, text, values, len(table), "the four finest meshes, or numbers of steps")


def crushed(friction_crushed_ring: pd.DataFrame) -> Iterator[Statement]:
    """What friction adds to the force on a ring, here and by another program."""
    table = friction_crushed_ring.dropna(subset=["aster_change"])
    if table.empty:
        return
    values: dict[str, float | str] = {"mu": float(table["mu"].iloc[0]), "states": float(table["delta_mm"].nunique())}
    values |= {f"aster_{end}": getattr(table["aster_change"], end)() for end in ("min", "max")}
    told = []
    for n, (scene, own) in enumerate(table.groupby("scene", sort=False)):
        values |= {f"name{n}": f"`{scene}`", f"low{n}": own["change"].min(), f"high{n}": own["change"].max()}
        told.append(f"{{low{n}:+.2%}} to {{high{n}:+.2%}} on {{name{n}}}")
    text = f"Friction with μ = {{mu:g}} adds {listed(told)}, over {{states:.0f}} states of the crushed ring; "
    text += "Code_Aster finds {aster_min:+.2%} to {aster_max:+.2%} by another law of the material."
    failed = table["failures"].notna().sum()
    values |= {"failed": float(failed)}
    text += " The judge refuses {failed:.0f} of these states." if failed else ""
    yield Statement(
        "friction-crushed-ring", PAGE, text, values, len(table), "the meshes that the scenes have by default"
    )


def public(friction_public: pd.DataFrame) -> Iterator[Statement]:
    """Public problems: who has an answer that the judge takes."""
    table = friction_public.dropna(subset=["algorithm"])  # the other files are no problems
    table = table.assign(certified=table["certified"].map({True: 1.0, False: 0.0}).astype(float))
    claimed = table[table["outcome"].isin(SOLVED)]
    taken = claimed[claimed["certified"] == 1]
    counts = taken.groupby("algorithm")["problem"].nunique().sort_values(ascending=False, kind="stable")
    values: dict[str, float | str] = {"problems": float(table["problem"].nunique())}
    values |= {"solved": float(taken["problem"].nunique()), "false": float((claimed["certified"] == 0).sum())}
    values |= {"told": listed([f"{name} {count}" for name, count in counts.items()])}
    text = (
        "Of {problems:.0f} public problems of Siconos {solved:.0f} have an answer that the judge takes; by algorithm: "
        "{told}. Of what is claimed {false:.0f} answers are refused by the judge."
    )
    scope = "rigid bodies, as published; a few seconds of the processor each"
    yield Statement("friction-public", PAGE, text, values, int(values["problems"]), scope, machine=True)

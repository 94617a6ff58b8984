"""What is said of algorithms with friction, and of the answers that they are checked by."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from studies.analysis.comparisons.friction import FIRST, FLOOR
from studies.analysis.statements.contact.friction import PAGE, listed
from studies.analysis.statements.record import LIMIT, OPENING, Statement
from studies.experiments.friction.agreement import AGREED
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


def greco(friction_greco: pd.DataFrame) -> Iterator[Statement]:
    """The plate that separates methods."""
    finest = friction_greco[friction_greco["elements"] == friction_greco["elements"].max()]
    solved = finest[finest["outcome"].isin(SOLVED)]
    lost = friction_greco[~friction_greco["outcome"].isin(SOLVED)].drop_duplicates("algorithm")
    values: dict[str, float | str] = {"elements": float(finest["elements"].iloc[0]), "all": float(len(finest))}
    values |= {"solved": float(len(solved)), "off": solved["error"].max()}
    values |= {"lost": listed([f"`{row['algorithm']}` ({row['outcome']})" for row in lost.to_dict("records")])}
    text = "On the GRECO plate, which is open, slips and sticks, {solved:.0f} of {all:.0f} algorithms converge"
    if len(solved):
        text += ", with errors of the slips of at most {off:.3%} on {elements:.0f}x{elements:.0f} elements"
    text += "; {lost} fails." if len(lost) == 1 else "; {lost} fail." if len(lost) else "."
    scope = "9-node quadrilaterals, from rest; against the slips of fine graded meshes"
    yield Statement("friction-greco", PAGE, text, values, len(finest), scope)


def klarbring(friction_klarbring: pd.DataFrame) -> Iterator[Statement]:
    """None, one or several answers."""
    table = friction_klarbring
    cases = table.drop_duplicates("case")["answers"]
    claimed = table["outcome"].isin(SOLVED)
    right = claimed & table["found"].notna() & (table["found"] != "wrong")
    counts = {"none": table["answers"] == 0, "one": table["answers"] == 1, "several": table["answers"] > 1}
    values: dict[str, float | str] = {"cases": float(len(cases)), "wrong": float((table["found"] == "wrong").sum())}
    values |= {"of_none": float((cases == 0).sum()), "of_one": float((cases == 1).sum())}
    values |= {"of_several": float((cases > 1).sum())}
    for name, rows in counts.items():
        values |= {f"{name}_right": float(right[rows].sum()), f"{name}_all": float(rows.sum())}
    values |= {"none_claims": float((claimed & counts["none"]).sum())}
    text = (
        "Of {cases:.0f} sets of Klarbring's springs {of_one:.0f} have one answer, {of_several:.0f} several and "
        "{of_none:.0f} none: at large coefficients that is physics, not a failure. Algorithms find the one answer in "
        "{one_right:.0f} of {one_all:.0f} solves and one of several in {several_right:.0f} of {several_all:.0f}; where "
        "there is none they claim {none_claims:.0f} of {none_all:.0f}, and {wrong:.0f} claims are wrong."
    )
    yield Statement("friction-klarbring", PAGE, text, values, len(table), "one candidate, two displacements, from rest")


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


def ends_of_the_law(friction_tied: pd.DataFrame) -> Iterator[Statement]:
    """An infinite coefficient beside the answers found by trying every set."""
    own = friction_tied
    there, none = own[own["answers"] > 0], own[own["answers"] == 0]
    same = there[there["outcome"].isin(SOLVED) & (there["otherwise"] == 0)]
    values: dict[str, float | str] = {"cases": float(len(own)), "there": float(len(there)), "same": float(len(same))}
    values |= {"off": same["difference"].max(), "none": float(len(none))}
    values |= {"claims": float(none["outcome"].isin(SOLVED).sum())}
    text = (
        "With μ = ∞ on the GRECO plate {there:.0f} of {cases:.0f} cases have an answer, as trying every set of tied "
        "nodes shows; `semismooth` finds {same:.0f} of them"
    )
    text += ", to {off:.0e} of the displacements" if len(same) else ""
    text += ", and claims one in {claims:.0f} of the {none:.0f} without." if len(none) else "."
    yield Statement("friction-tied", PAGE, text, values, len(own), "coarse meshes, few candidates", machine=True)


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


def rigid_motions(friction_joint_motion: pd.DataFrame, friction_rolling: pd.DataFrame) -> Iterator[Statement]:
    """Body and foundation moved together, and a wheel that rolls."""
    together = friction_joint_motion[friction_joint_motion["step"] == "together"]
    rolls = friction_rolling[friction_rolling["outcome"].isin(SOLVED)]
    if together.empty or rolls.empty:
        return
    values: dict[str, float | str] = {"change": together["change_N"].max(), "most": together["friction_N"].max()}
    values |= {"way": together["way_mm"].max(), "turn": together["turn_rad"].max()}
    values |= {"lost": together["dissipation_N_mm"].abs().max()}
    values |= {"hub": rolls["hub_error_mm"].max(), "radius": rolls["radius_error"].abs().max()}
    text = (
        "A body moved with its foundation by up to {way:.0f} mm and {turn:.2g} rad keeps its friction, {most:.3g} N, "
        "to {change:.0e} N and dissipates {lost:.0e} N mm; a wheel rolled between plates has its hub in the middle to "
        "{hub:.0e} mm, and rolls on the radius of its bars to {radius:.1e}."
    )
    count = len(together) + len(rolls)
    yield Statement("friction-motions", PAGE, text, values, count, "small trusses, by `semismooth`", machine=True)


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


MAKERS = (
    *(agreement, failures, regularisation, greco, klarbring),
    *(closed_forms, ends_of_the_law, rigid_motions, crushed, public),
)

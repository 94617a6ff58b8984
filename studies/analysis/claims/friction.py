"""Claims about Coulomb's friction: steps, limits, several answers, regularisation, and what it costs."""

from __future__ import annotations

import pandas as pd

from studies.analysis.claims.record import CAMPAIGN, Claims, Verdict, always, banded, counted

claim = Claims("friction")
TYRE = "the paper's tyre pressed by 10 mm"
SOLVED = ("converged",)


@claim(
    "one-step", "With friction one load step is enough.", "common practice", f"{TYRE}, dragged by 1 mm, 1 %", CAMPAIGN
)
def _one_step(friction_steps: pd.DataFrame) -> Verdict | None:
    own = friction_steps[friction_steps["steps"] == friction_steps["steps"].min()]
    if own.empty:
        return None
    row = own.iloc[0]
    force, lost = abs(float(row["friction_N_error"])), abs(float(row["dissipation_N_mm_error"]))
    text = f"the force errs by {force:.1%}, the dissipation by {lost:.0%}"
    return banded((min(force, lost), max(force, lost)), (0, 0.01), "change of the answer", text, 1)


@claim(
    "few-steps",
    "A few load steps follow any path with friction.",
    "common practice",
    "a point on springs along a curved path, 5 %",
    CAMPAIGN,
)
def _proportional(friction_path: pd.DataFrame) -> Verdict | None:
    own = friction_path[friction_path["steps"] == friction_path["steps"].min()]
    if own.empty:
        return None
    error = own["end_error"].abs()
    text = f"four steps err by {error.min():.0%} to {error.max():.0%} in the end of a curved path"
    return banded((float(error.min()), float(error.max())), (0, 0.05), "error of the end", text, len(own))


def _limit(ends: pd.DataFrame, what: str) -> Verdict:
    off = ends["off"].abs()
    text = f"the {what} of the paper's tyre is on its bound to {off.max():.0e} once all slips"
    return banded((float(off.min()), float(off.max())), (0, 1e-6), "relative difference", text, len(ends))


@claim(
    "drag-limit",
    "A tyre that slips as a whole is pulled by μ times its normal force.",
    "mechanics",
    f"{TYRE}, dragged by 64 mm",
    CAMPAIGN,
    machine=True,
)
def _force(friction_drag_ends: pd.DataFrame) -> Verdict | None:
    return _limit(friction_drag_ends, "force")


@claim(
    "normal-force",
    "Friction leaves the normal force of a tyre as it is.",
    "common practice",
    f"{TYRE}, dragged by 64 mm, 1 %",
    CAMPAIGN,
)
def _normal(friction_drag_ends: pd.DataFrame) -> Verdict | None:
    own = (friction_drag_ends["force_N"] / friction_drag_ends["pressed_N"] - 1).abs()
    text = f"dragging across changes the normal force by {own.min():.1%} to {own.max():.1%}"
    return banded((float(own.min()), float(own.max())), (0, 0.01), "change of the force", text, len(own))


@claim(
    "capstan",
    "A strip on a drum slips when its forces are as exp(μθ).",
    "Euler; mechanics",
    "bars on a drum, from both sides, 1 %",
    CAMPAIGN,
)
def _capstan(friction_capstan: pd.DataFrame) -> Verdict | None:
    off = friction_capstan.drop_duplicates(["mu", "elements", "error"])["error"].abs()
    text = f"ratios of forces err by at most {off.max():.1%} in {len(off)} cases, {off.median():.0e} in the median"
    return banded((float(off.min()), float(off.max())), (0, 0.01), "relative error", text, len(off))


@claim(
    "one-answer",
    "A problem with Coulomb's friction has one answer.",
    "taken for granted",
    "Klarbring's springs",
    CAMPAIGN,
)
def _one_answer(friction_klarbring: pd.DataFrame) -> Verdict | None:
    cases = friction_klarbring.drop_duplicates("case")
    own, ratio = cases["answers"], cases["mu_Knt_over_Ktt"]
    none, several = int((own == 0).sum()), int((own > 1).sum())
    text = f"of {len(own)} sets of springs {several} have several answers and {none} none, from "
    text += f"μ = {ratio[own != 1].min():.2g} K_tt/K_nt on"
    return always(none + several, len(own), text)


@claim(
    "friction-springs",
    "Tangential springs give the answer of Coulomb's law to 1 %.",
    "manuals",
    "the scenes with friction, one mesh each, springs of 10^4 MPa/mm",
    CAMPAIGN,
)
def _springs(friction_agreement: pd.DataFrame) -> Verdict | None:
    own = friction_agreement[friction_agreement["algorithm"] == "regularised"]
    error = own[own["outcome"].isin(SOLVED)]["force_error"].dropna()
    if error.empty:
        return None
    text = f"nodal forces differ by {error.min():.0e} to {error.max():.0e} of the largest on {len(error)} scenes"
    return banded((float(error.min()), float(error.max())), (0, 0.01), "error of forces", text, len(error))


@claim(
    "friction-trial",
    "Trial of open, stick and slip finds the states.",
    "textbooks of contact",
    "the scenes with friction",
    CAMPAIGN,
)
def _trial(friction_algorithms: pd.DataFrame) -> Verdict | None:
    own = friction_algorithms[friction_algorithms["algorithm"] == "trial-and-error"]
    if own.empty:
        return None
    row = own.iloc[0]
    return counted(int(row["solved"]), int(row["cases"]), f"converges on {row['solved']} of {row['cases']} scenes")


@claim(
    "public-friction",
    "Some algorithm solves all public friction problems.",
    "collections of them",
    "problems of Siconos, a few seconds each",
    CAMPAIGN,
    machine=True,
)
def _public(friction_public: pd.DataFrame) -> Verdict | None:
    own = friction_public.dropna(subset=["algorithm"])
    taken = own[own["outcome"].isin(SOLVED) & (own["certified"].astype(str) == "True")]
    counts = taken.groupby("algorithm")["problem"].nunique().sort_values(ascending=False, kind="stable")
    of = own["problem"].nunique()
    if counts.empty:
        return None
    text = f"the best one, `{counts.index[0]}`, has certified answers of {counts.iloc[0]} of {of} within seconds"
    return counted(int(counts.iloc[0]), int(of), text)


@claim(
    "ring-friction",
    "Friction adds 1 to 2 % to the force on a crushed ring.",
    "Code_Aster SSNP502",
    "shell and solid, μ = 0.4",
    CAMPAIGN,
)
def _ring(friction_crushed_ring: pd.DataFrame) -> Verdict | None:
    own = friction_crushed_ring.dropna(subset=["aster_change"])
    if own.empty:
        return None
    change, aster = own["change"], own["aster_change"]
    text = f"by {change.min():.1%} to {change.max():.1%} with St. Venant-Kirchhoff's law"
    band = (float(aster.min()), float(aster.max()))
    return banded((float(change.min()), float(change.max())), band, "change of the force", text, len(own))


@claim("friction-cost", "Friction doubles the work of an iteration.", "common opinion", TYRE, CAMPAIGN)
def _cost(friction_cost: pd.DataFrame) -> Verdict | None:
    own = friction_cost[friction_cost["friction"] == 1]["operations_ratio"]
    if own.empty:
        return None
    text = f"{own.min():.1f} to {own.max():.1f} times the operations of an iteration without friction"
    return banded((float(own.min()), float(own.max())), (1.5, 2.5), "ratio of operations", text, len(own))


@claim(
    "greco",
    "A plate that opens, slips and sticks is no problem for any algorithm.",
    "use as a test",
    "the GRECO plate, Code_Aster SSNV128, from rest",
    CAMPAIGN,
)
def _greco(friction_greco: pd.DataFrame) -> Verdict | None:
    finest = friction_greco[friction_greco["elements"] == friction_greco["elements"].max()]
    solved = int(finest["outcome"].isin(SOLVED).sum())
    lost = ", ".join(f"`{name}`" for name in finest[~finest["outcome"].isin(SOLVED)]["algorithm"]) or "none"
    text = f"{solved} of {len(finest)} algorithms converge; not: {lost}"
    return counted(solved, len(finest), text)

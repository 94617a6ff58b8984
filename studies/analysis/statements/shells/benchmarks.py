"""What is said of shells without contact: benchmarks, convergence, locking, rigid motions, thick walls."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from studies.analysis.comparisons.element_choice import ENOUGH
from studies.analysis.statements.record import LIMIT, OPENING, Statement

LEAVES = 1e-12  # a strain below this is none


def benchmarks(convergence_errors: pd.DataFrame, convergence: pd.DataFrame) -> Iterator[Statement]:
    """How far the extrapolated values are from references."""
    own = convergence.drop_duplicates("sequence")[["sequence", "scene", "ladder", "quantity", "at", "asymptotic"]]
    pairs = convergence_errors.dropna(subset=["model_part"]).drop_duplicates(["sequence", "reference"], keep="last")
    pairs = pairs.merge(own, on="sequence")
    pairs = pairs[pairs["asymptotic"].astype(bool) & pairs["scene"].isin(["cantilever", "hemisphere"])]
    if pairs.empty:
        return
    worst = pairs.iloc[int(pairs["model_part"].abs().argmax())]
    values = {"off": worst["model_part"], "quantity": f"`{worst['quantity']}`", "scene": worst["scene"]}
    values |= {"cases": float(len(pairs)), "within": float(pairs["verdict"].str.startswith("within").sum())}
    text = (
        "Cantilever and hemisphere, extrapolated over their meshes, are within the uncertainties in {within:.0f} of "
        "{cases:.0f} comparisons with exact and published values; the largest difference is {off:+.2%}, in {quantity} "
        "of the {scene}."
    )
    scope = "asymptotic sequences of meshes; a published value may itself be that of a coarse mesh"
    yield Statement("benchmarks", "benchmarks", text, values, len(pairs), scope, OPENING)


def convergence(convergence: pd.DataFrame, convergence_errors: pd.DataFrame) -> Iterator[Statement]:
    """Orders and limits over all scenes."""
    own = convergence[convergence["ladder"].notna()].drop_duplicates("sequence")
    if own.empty:
        return
    good = own["asymptotic"].astype(bool)
    pairs = convergence_errors[convergence_errors["sequence"].isin(own[good]["sequence"])]
    pairs = pairs.dropna(subset=["model_part"]).drop_duplicates(["sequence", "reference"], keep="last")
    within = pairs["verdict"].str.startswith("within").sum()
    values = {"good": float(good.sum()), "all": float(len(own)), "scenes": float(own["scene"].nunique())}
    values |= {"within": float(within), "pairs": float(len(pairs))}
    text = (
        "{good:.0f} of {all:.0f} quantities, over {scenes:.0f} scenes, converge with a steady order on refined meshes; "
        "their limits are within the uncertainties in {within:.0f} of {pairs:.0f} comparisons with references."
    )
    scope = "the default element; what is not asymptotic is listed with its cause"
    yield Statement("convergence", "convergence", text, values, len(own), scope, OPENING)


def element(element_choice: pd.DataFrame) -> Iterator[Statement]:
    """Which element."""
    counts = {word: float((element_choice["verdict"] == word).sum()) for word in ("better", "equal", "worse")}
    values = {**counts, "all": float(len(element_choice)), "within": ENOUGH}
    text = (
        "On the coarsest mesh of each scene the default element is nearer to the limit than the element of the paper "
        "for {better:.0f} of {all:.0f} quantities, equal for {equal:.0f} and worse for {worse:.0f}."
    )
    yield Statement("element", "convergence", text, values, len(element_choice), "the coarsest of three meshes")


def locking(membrane_locking: pd.DataFrame, shear_locking: pd.DataFrame) -> Iterator[Statement]:
    """What still locks."""
    free = membrane_locking[membrane_locking["end"] == "free"]
    if free.empty:
        return
    worst = free.iloc[int(free["energy_ratio"].argmin())]
    values = {"shell": worst["surface"], "thinness": worst["h_over_R"], "elements": worst["elements"]}
    values |= {"found": worst["energy_ratio"], "shear": (1 - shear_locking["ratio"]).abs().max()}
    text = (
        "Thickness, shear and curved-beam locking are removed: a bent cantilever is {shear:.1%} off at any "
        "slenderness. What still locks are coarse meshes of very thin doubly curved shells that bend freely: of the "
        "energy of the {shell} with free ends at h/R = {thinness:g}, {elements:.0f} x {elements:.0f} elements find "
        "{found:.0%}."
    )
    scope = "linear problems; a finer mesh or a clamped end removes it"
    yield Statement("locking", "locking", text, values, len(membrane_locking), scope, OPENING)
    text = (
        "Coarse meshes of very thin doubly curved shells that bend freely still lock: of the energy of the {shell} "
        "with free ends at h/R = {thinness:g}, {elements:.0f} x {elements:.0f} elements find {found:.0%}."
    )
    yield Statement("still-locks", "locking", text, values, len(membrane_locking), scope, LIMIT)


def rigid_motions(rigid_body: pd.DataFrame) -> Iterator[Statement]:
    """Which measures strain nothing when a body moves as a whole."""
    left = rigid_body.groupby("measure", sort=False)["largest"].max()
    clean = [str(name) for name, value in left.items() if value < LEAVES]
    worst = left.idxmax()
    declared = rigid_body.dropna(subset=["declared"])
    off = (declared["strain"] - declared["declared"]).abs().max()
    values: dict[str, float | str] = {
        **{"clean": ", ".join(f"`{name}`" for name in clean) or "none", "of": float(len(left))},
        **{"worst": f"`{worst}`", "strain": float(left.max()), "off": float(off)},
    }
    text = (
        "Of {of:.0f} measures, {clean} strain nothing under any rigid motion; {worst} leaves most, {strain:.2f} after "
        "rotations by 0.5 rad. Each measure keeps the law that it declares to {off:.0e}."
    )
    scope = "formulas alone, no element: translations by 0.3 of the size and rotations by 0.5 rad"
    yield Statement("rigid-motions", "rigid-body", text, values, len(rigid_body), scope, OPENING)


def thick(shell_boundaries: pd.DataFrame) -> Iterator[Statement]:
    """From which thickness on a shell is not enough."""
    usual = shell_boundaries[(shell_boundaries["variant"] == "default") & shell_boundaries["headline"].astype(bool)]
    passed = usual[(usual["boundary_1"] < math.inf) & (usual["boundary_1"] > 0)].sort_values("boundary_1")
    if passed.empty:
        return
    first, last = passed.iloc[0], passed.iloc[-1]
    middle = float(passed["boundary_1"].median())
    values = {"passed": float(len(passed)), "of": float(len(usual)), "first": first["boundary_1"]}
    values |= {"first_case": first["case"], "last": last["boundary_1"], "last_case": last["case"], "middle": middle}
    text = (
        "A shell is within 1 % of the solid up to a thickness of {middle:.2g} of its radius or span in the median of "
        "{of:.0f} cases; {passed:.0f} pass 1 % within what was solved, first the {first_case} at {first:.2g} and last "
        "the {last_case} at {last:.2g}."
    )
    scope = "St. Venant-Kirchhoff law, the section constant-s33 without a shear correction"
    yield Statement("thick-shells", "shell-limits", text, values, len(usual), scope, OPENING)


def scenes(sheet_parts: pd.DataFrame) -> Iterator[Statement]:
    """What is solved at all."""
    names = sheet_parts[sheet_parts["kind"] == "scene"]
    text = (
        "Each of {scenes:.0f} scenes has a sheet: geometry, material, supports, load, what is measured, the target "
        "with its source, and a picture of the deformed shape; the gallery shows them all."
    )
    values, scope = {"scenes": float(len(names))}, "the scenes of the catalogue"
    yield Statement("scenes", "gallery", text, values, len(names), scope)


MAKERS = (scenes, benchmarks, convergence, element, locking, rigid_motions, thick)

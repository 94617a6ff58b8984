"""What is said of shells without contact: convergence, elements, locking, rigid motions, thick walls."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from studies.analysis.comparisons.element_choice import ENOUGH
from studies.analysis.statements.choices import NOISE
from studies.analysis.statements.record import FINDING, LIMIT, OPENING, Statement
from studies.experiments.accuracy.choices import PROBLEM, VARIANT, smallest

EXACT, LINEAR = "exact strains", "linear strains"  # groups of the summary
NODAL = "thickness_strain=nodal"
LEAVES = 1e-12  # a strain below this is none


def convergence(convergence_summary: pd.DataFrame) -> Iterator[Statement]:
    """How many limits agree with references, of exact strains and of linear ones."""
    own = convergence_summary.set_index("group")
    if EXACT not in own.index or not own.loc[EXACT, "comparisons"]:
        return
    values: dict[str, float | str] = {}
    said = []
    for name, group in (("exact", EXACT), ("linear", LINEAR)):
        row = own.loc[[group]].to_dict("records")[0] if group in own.index else {"comparisons": 0}
        if not row["comparisons"]:
            continue
        values |= {f"{name}_all": float(row["comparisons"]), f"{name}_agree": float(row["agree"])}
        values |= {f"{name}_off": row["median_off"], f"{name}_most": row["largest_off"]}
        values |= {f"{name}_in": str(row["largest_off_in"])}
        said.append(
            f"With {name} strains {{{name}_agree:.0f}} of {{{name}_all:.0f}} comparisons of limits with references "
            f"agree within the uncertainties of both; the difference is {{{name}_off:.2%}} in the median and at most "
            f"{{{name}_most:.2%}} ({{{name}_in}})."
        )
    scope = "the default element; a reference is a closed form, a published value or another program, not our own limit"
    problems = int(own.loc[[EXACT, LINEAR], "comparisons"].sum()) if LINEAR in own.index else 0
    yield Statement("convergence", "convergence", " ".join(said), values, problems, scope, OPENING)


def element(element_choice: pd.DataFrame) -> Iterator[Statement]:
    """Which element."""
    counts = {word: float((element_choice["verdict"] == word).sum()) for word in ("better", "equal", "worse")}
    values = {**counts, "all": float(len(element_choice)), "within": ENOUGH}
    text = (
        "On the coarsest mesh of each scene the default element is nearer to the limit than the element of the paper "
        "for {better:.0f} of {all:.0f} quantities, equal for {equal:.0f} and worse for {worse:.0f}."
    )
    yield Statement("element", "convergence", text, values, len(element_choice), "the coarsest of three meshes")


def nodal(choices: pd.DataFrame) -> Iterator[Statement]:
    """The thickness strain taken from the nodes alone: what it saves, and where it is lost."""
    own = pd.concat([smallest(choices, VARIANT, axis) for axis in ("measure", "element")])
    own = own[own["name"].isin([NODAL, "exact"])]
    wide = own.pivot(index=PROBLEM, columns="name", values=["seconds", "verdict"])
    if NODAL not in wide["seconds"]:
        return
    wide = wide[wide["seconds"]["exact"].notna() & wide["verdict"][NODAL].notna()]
    every = wide["seconds"].astype(float)
    ratio = (every[NODAL] / every["exact"])[every["exact"] >= NOISE].dropna()
    if ratio.empty:
        return
    least, most = ratio.idxmin(), ratio.idxmax()
    values: dict[str, float | str] = {"problems": float(len(ratio)), "cheaper": float((ratio < 1).sum())}
    values |= {"low": ratio.min(), "high": ratio.max(), "middle": ratio.median(), "asked": own["asked"].min()}
    values |= {
        "lost": float(every[NODAL].isna().sum()),
        "noise": NOISE,
        "least": f"`{least[0]}`",
        "most": f"`{most[0]}`",
    }
    text = (
        "`thickness_strain=nodal` reaches {asked:.0%} in {low:.2f} ({least}) to {high:.2f} ({most}) times the "
        "processor time of the default element, {middle:.2f} in the median of {problems:.0f} problems of {noise:g} s "
        "or more; it is cheaper on {cheaper:.0f} of them, and does not reach that error on {lost:.0f} more."
    )
    scope = "smallest grid surely within that error; folds of coarse meshes end at limit points of this element"
    yield Statement("nodal", "convergence", text, values, len(ratio), scope, FINDING, machine=True)


def locking(membrane_locking: pd.DataFrame, shear_locking: pd.DataFrame) -> Iterator[Statement]:
    """What still locks."""
    free = membrane_locking[membrane_locking["end"] == "free"]
    if free.empty:
        return
    worst = free.iloc[int(free["energy_ratio"].argmin())]
    values = {"shell": worst["surface"], "thinness": worst["h_over_R"], "elements": worst["elements"]}
    values |= {"found": worst["energy_ratio"], "shear": (1 - shear_locking["ratio"]).abs().max()}
    text = (
        "Very thin doubly curved shells that bend freely lock on coarse meshes: of the energy of the {shell} with free "
        "ends at h/R = {thinness:g}, {elements:.0f} x {elements:.0f} elements capture only {found:.0%}. Thickness, "
        "shear and curved-beam locking are removed: the deflection of a bent cantilever errs by {shear:.1%} at any "
        "slenderness."
    )
    scope = "linear problems; a finer mesh or a clamped end removes it"
    yield Statement("still-locks", "convergence", text, values, len(membrane_locking), scope, LIMIT)


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
        "Of {of:.0f} measures, {clean} leave no strain under any rigid motion; {worst} leaves most, {strain:.2f} after "
        "rotations by {theta:g} rad. Each measure satisfies the law that it declares to {off:.0e}."
    )
    slide, theta = float(rigid_body["slide"].max()), float(rigid_body["theta_rad"].max())
    values |= {"theta": theta}
    scope = f"formulas alone, no element: translations by {slide:g} of the size and rotations by {theta:g} rad"
    yield Statement("rigid-motions", "invariance", text, values, len(rigid_body), scope, OPENING)


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
        "{of:.0f} cases; {passed:.0f} exceed 1 % within what was solved, first the {first_case} at {first:.2g} and "
        "last the {last_case} at {last:.2g}."
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


MAKERS = (scenes, convergence, element, nodal, locking, rigid_motions, thick)

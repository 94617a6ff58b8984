"""What is said of shells: limits beside references and closed forms, and the thickness strain taken at the nodes."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.comparisons.ladders import DEFAULT
from studies.analysis.statements.choices import NOISE
from studies.analysis.statements.record import ANSWER, FINDING, OPENING, Statement
from studies.experiments.accuracy.choices import PROBLEM, VARIANT, smallest

EXACT, LINEAR = "exact strains", "linear strains"  # groups of the summary
NODAL = "thickness_strain=nodal"
CONTACT_SCENES = ("strip-contact", "plate-contact", "ring", "heavy-strip")


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

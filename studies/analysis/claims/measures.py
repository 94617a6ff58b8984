"""Claims about strain measures: rigid motions, regimes, laws, and what they cost."""

from __future__ import annotations

from collections.abc import Collection

import pandas as pd

from studies.analysis.claims.record import CAMPAIGN, Claims, Verdict, always, banded, counted, values_of
from studies.experiments.accuracy.choices import measure_limits

claim = Claims("strain measures")
BOOKS = "textbooks of shells"
LIMITS = "in the limit of the grids, 5 %"
PROBLEMS = f"problems of all regimes {LIMITS}"
LEVEL = 0.05
LEAVES = 1e-12  # a strain below this is none
MODERATE = 3.5  # a rate from which on a strain is of fourth order
GREEN_STRAIN, SMALL = 0.05, 0.01
LARGE, CONTACT = "large rotations", "contact"
CYLINDERS = ("scordelis-lo", "pinched-cylinder", "roof-a", "roof-d", "semicylinder", "sze-pullout", "ring")
SHALLOW = ("shallow-cap", "roof-a", "roof-d", "strip-contact", "plate-contact")


def _surely(
    choices: pd.DataFrame, name: str, regimes: Collection[str] = (), scenes: Collection[str] = ()
) -> Verdict | None:
    """On how many problems, of some regimes or scenes, is a measure surely within LEVEL of the exact one?"""
    own = measure_limits(choices)
    own = own[(own["name"] == name) & own["formulation_error"].notna()]
    if regimes or scenes:
        own = own[own["regime"].isin(regimes) | own["scene"].isin(scenes)]
    if own.empty:
        return None
    size = own["formulation_error"]
    sure = int((size.abs() + own["within"] <= LEVEL).sum())
    text = f"within {LEVEL:.0%} on {sure} of {len(own)} problems; errors of {size.min():+.1%} to {size.max():+.1%}"
    return counted(sure, len(own), text)


@claim(
    "exact-rigid",
    "Green-Lagrange strains of six face displacements vanish under any rigid motion.",
    "the paper of the tyre",
    "plate, cylinder, sphere, torus; formulas alone",
    CAMPAIGN,
    machine=True,
)
def _exact_is_free(rigid_body: pd.DataFrame) -> Verdict | None:
    own = rigid_body[rigid_body["measure"] == "exact"]
    largest = own["largest"].max()
    text = f"largest strain {largest:.0e} under {len(own)} translations and rotations by {own['theta_rad'].max():g} rad"
    return banded((float(own["largest"].min()), float(largest)), (0, LEAVES), "strain", text, len(own))


@claim(
    "translation",
    "No strain measure is strained by a translation.",
    "taken for granted",
    "all measures; plate, cylinder, sphere, torus",
    CAMPAIGN,
)
def _translation(small_motions: pd.DataFrame) -> Verdict | None:
    own = small_motions[small_motions["motion"] == "translation"].groupby("measure", sort=False)["largest"].max()
    if own.empty:
        return None
    strained = [f"`{name}`" for name, value in own.items() if value > LEAVES]
    text = f"strained by a translation: {', '.join(strained) or 'none'} of {len(own)} measures"
    return always(len(strained), len(own), text)


@claim(
    "moderate-rotation",
    "Von Karman strains are free of strain under moderate rotations.",
    BOOKS,
    "plate, cylinder, sphere, torus; small angles",
    CAMPAIGN,
)
def _moderate(rigid_body_powers: pd.DataFrame) -> Verdict | None:
    own = rigid_body_powers[(rigid_body_powers["measure"] == "von-karman")]
    own = own[(own["motion"] != "translation") & own["strain_rate"].notna()]
    if own.empty:
        return None
    fine = own["strain_rate"] >= MODERATE
    others = ", ".join(own[~fine]["motion"].unique())
    text = (
        f"strains of fourth order in the angle for {fine.sum()} of {len(own)} rotations of {own['surface'].nunique()} "
    )
    text += f"surfaces, of second order for others ({others})"
    return counted(int(fine.sum()), len(own), text)


@claim(
    "donnell-cylinders",
    "Donnell's theory is enough for cylinders.",
    BOOKS,
    f"roofs, a cylinder and rings {LIMITS}",
    "footprint choose ring --out ring --error 5%",
)
def _donnell(choices: pd.DataFrame) -> Verdict | None:
    return _surely(choices, "donnell", scenes=CYLINDERS)


@claim(
    "von-karman-shallow",
    "Von Karman strains are enough for plates and shallow shells.",
    BOOKS,
    f"shallow shells, a strip and a plate {LIMITS}",
    "footprint choose shallow-cap --out cap --error 5%",
)
def _plates(choices: pd.DataFrame) -> Verdict | None:
    return _surely(choices, "von-karman", scenes=SHALLOW)


@claim(
    "von-karman-large",
    "With small load steps von Karman strains follow large rotations.",
    "repeated in manuals",
    f"large rotations {LIMITS}",
    "footprint choose cantilever --out beam --error 5%",
)
def _large_von_karman(choices: pd.DataFrame) -> Verdict | None:
    return _surely(choices, "von-karman", [LARGE])


@claim(
    "sanders-large",
    "Sanders' and Koiter's strains are enough for large rotations.",
    BOOKS,
    f"large rotations {LIMITS}",
    "footprint choose hemisphere --out hemisphere --error 5%",
)
def _large_sanders(choices: pd.DataFrame) -> Verdict | None:
    return _surely(choices, "sanders", [LARGE])


@claim(
    "moderate-large",
    "A theory of moderate rotations follows large ones with a small error.",
    BOOKS,
    f"large rotations {LIMITS}",
    "footprint choose sze-annulus --out annulus --error 5%",
)
def _large_moderate(choices: pd.DataFrame) -> Verdict | None:
    return _surely(choices, "moderate-rotation", [LARGE])


@claim(
    "elongation",
    "Engineering strains give the answer of Green-Lagrange strains.",
    BOOKS,
    PROBLEMS,
    "footprint choose tyre --out tyre --error 5%",
)
def _engineering(choices: pd.DataFrame) -> Verdict | None:
    return _surely(choices, "elongation")


@claim(
    "linear-contact",
    "Contact is nonlinear anyway: linear strains in the shell are enough.",
    "common practice",
    f"contact problems {LIMITS}",
    "footprint choose ring --out ring --error 5%",
)
def _linear_contact(choices: pd.DataFrame) -> Verdict | None:
    return _surely(choices, "linear", [CONTACT])


@claim(
    "thin-terms",
    "In a thin shell quadratic terms over the thickness may be dropped.",
    BOOKS,
    PROBLEMS,
    "footprint choose tyre --out tyre --error 1%",
)
def _thin(choices: pd.DataFrame) -> Verdict | None:
    return _surely(choices, "thin-green-lagrange")


@claim(
    "law-5-percent",
    "St. Venant-Kirchhoff's law is fine below a strain of 5 %.",
    "common practice",
    "specimens that stretch or bend, beside Hencky's law, 1 %",
    CAMPAIGN,
)
def _law(law_rules: pd.DataFrame) -> Verdict | None:
    changes = law_rules["factor"] * GREEN_STRAIN
    if changes.empty:
        return None
    small = law_rules[changes <= SMALL]
    text = (
        f"at a strain of {GREEN_STRAIN:.0%} Hencky's law changes the answer by {changes.min():.2%} to "
        f"{changes.max():.0%}; by at most {SMALL:.0%} on {len(small)} of {len(changes)} specimens, which carry by "
        f"{' and '.join(small['carries'].unique())}"
    )
    return banded((float(changes.min()), float(changes.max())), (0, SMALL), "change of the answer", text, len(changes))


@claim(
    "measures-cheaper",
    "Classical strain measures save computing time.",
    BOOKS,
    "pairs of the same request, nonlinear measures, a fifth saved",
    "footprint choose tyre --out tyre",
    machine=True,
)
def _cost(statement_values: pd.DataFrame) -> Verdict | None:
    if not (own := values_of(statement_values, "measures-cost")):
        return None
    text = f"nonlinear ones take {own['high']:.2f} times the operations of exact strains in the median at most; linear "
    text += f"ones {own['linear']:.2f}"
    return banded((own["low"], own["high"]), (0, 0.8), "ratio of operations", text, int(own["both"]))

"""Claims of the seed's paper, and of others, about tyres."""

from __future__ import annotations

import pandas as pd

from studies.analysis.claims.record import CAMPAIGN, Claims, Verdict, banded, counted
from studies.analysis.comparisons.tyre.readings import MODEL

PAPER = "Grigolyuk, Kulikov, Plotnikova (2004), the paper of the tyre"
USE = "as that paper does"
claim = Claims("tyre")
OLD = "earlier reports of this suite, on one mesh"
OURS = "the paper's tyre at 20 mm of travel"
AT = 20.0  # mm
RIGHT_ANGLE = 90.0  # deg, where the plies are symmetric again, as at 0
ENOUGH = 0.01  # a change below it does not matter to an engineer
SOLVE = "footprint solve tyre --out tyre --set delta_mm=20"


def _changed(tyre_budget: pd.DataFrame, changed: str, delta: float = AT) -> tuple[float, float] | None:
    """The change of the force with its uncertainty."""
    own = tyre_budget[(tyre_budget["changed"] == changed) & (tyre_budget["delta_mm"] == delta)]
    return (float(own["change"].iloc[0]), float(own["within"].iloc[0])) if len(own) else None


def _force(
    tyre_budget: pd.DataFrame, changed: str, band: float, verb: str = "changes", delta: float = AT
) -> Verdict | None:
    """Is the change of the force within a band, in the limit of the meshes?"""
    if (found := _changed(tyre_budget, changed, delta)) is None:
        return None
    change, known = found
    text = f"the force at {delta:g} mm {verb} by {change:+.1%} ± {known:.1%}"
    return banded((change - known, change + known), (-band, band), "change of the force", text, 2)


def _ratio(tyre_budget: pd.DataFrame, band: tuple[float, float]) -> Verdict | None:
    """Is the force with linear strains over that with exact ones within a band, in the limit of the meshes?"""
    if (found := _changed(tyre_budget, "linear")) is None:
        return None
    ratio, known = 1 + found[0], found[1]
    text = f"{ratio:.2f} ± {known:.2f} times the force of exact strains, in the limit of the meshes"
    return banded((ratio - known, ratio + known), band, "ratio of forces", text, 2)


@claim(
    "linear-doubles",
    "Linear strains give about twice the contact force.",
    PAPER,
    OURS,
    f"{SOLVE} --measure linear --error 5%",
)
def _twice(tyre_budget: pd.DataFrame) -> Verdict | None:
    return _ratio(tyre_budget, (1.9, 2.1))


@claim(
    "linear-small-travel",
    "At a small travel linear strains are enough.",
    "common practice",
    "the paper's tyre at 5 mm of travel, 5 %",
    "footprint choose tyre --out tyre --set delta_mm=5 --error 5%",
)
def _small_travel(tyre_budget: pd.DataFrame) -> Verdict | None:
    return _force(tyre_budget, "linear", 0.05, delta=5.0)


@claim(
    "printed-table",
    "The printed contact pressures are those of a travel of 20 mm.",
    PAPER,
    "the element and the mesh of the paper",
    f"{SOLVE} --set element=paper --mesh 42x40",
)
def _table(tyre_readings: pd.DataFrame) -> Verdict | None:
    model = tyre_readings[tyre_readings["kind"] == MODEL]
    own, fits = (model[model[name].astype(bool)] for name in ("stated", "best"))
    if own.empty or fits.empty:
        return None
    best = own.iloc[int(own["core_rms"].argmin())]
    text = (
        f"no reading of the model fits better than {own['core_rms'].min():.0%} (rms in the core) at the stated travel, "
        f"with {best['in_one_only']:.0f} nodes in only one patch; at the best of the travels tried "
        f"{fits['core_rms'].min():.0%}"
    )
    return banded((own["core_rms"].min(), own["core_rms"].max()), (0, 0.05), "rms of pressures", text, len(own))


@claim(
    "paper-mesh",
    "A mesh of 42x40 elements is fine enough.",
    USE,
    f"{OURS}, 1 %",
    f"{SOLVE} --set element=paper --mesh 42x40",
)
def _mesh(tyre_budget: pd.DataFrame) -> Verdict | None:
    return _force(tyre_budget, "42x40, element of the paper", ENOUGH, "errs")


@claim(
    "dead-pressure",
    "The inflation may be a dead load on the middle surface.",
    USE,
    f"{OURS}, 5 %",
    f"{SOLVE} --set load=follower --set pressure_area=face",
)
def _dead(tyre_budget: pd.DataFrame) -> Verdict | None:
    return _force(tyre_budget, "follower", 0.05)


@claim(
    "full-law",
    "Six displacements a node take the law of the solid as it is.",
    "manuals of solid shells",
    f"{OURS}, 1 %",
    f"{SOLVE} --set section=full-3d",
)
def _law(tyre_budget: pd.DataFrame) -> Verdict | None:
    return _force(tyre_budget, "full-3d", ENOUGH)


@claim(
    "shell-for-solid",
    "A shell stands for the solid wall of a tyre.",
    PAPER,
    "an isotropic tyre with follower load, force and growth, 1 %",
    CAMPAIGN,
)
def _solid(solid_shell: pd.DataFrame) -> Verdict | None:
    own = solid_shell[solid_shell["body"] != "solid"].dropna(subset=["model_part"]).drop_duplicates(["quantity", "at"])
    if own.empty:
        return None
    low, high = own["model_part"] - own["known_to"], own["model_part"] + own["known_to"]
    force = own[own["quantity"] == "force_N"]
    text = f"forces at {len(force)} travels differ by at most {force['model_part'].abs().max():.2%}, known to "
    text += f"{force['known_to'].min():.1%} to {force['known_to'].max():.1%}; all quantities by "
    text += f"{own['model_part'].min():+.1%} to {own['model_part'].max():+.1%}"
    return banded((float(low.min()), float(high.max())), (-ENOUGH, ENOUGH), "difference", text, len(own))


@claim(
    "mirror-half",
    "Half a tyre with a mirror plane is enough for angle plies.",
    "common practice",
    "angle plies of many angles at 20 mm, 1 % of the peak pressure",
    CAMPAIGN,
)
def _mirror(mirror: pd.DataFrame) -> Verdict | None:
    stable = mirror[(mirror["outcome"] == "converged") & (mirror["negative"] == 0) & (mirror["measure"] == "exact")]
    angles = stable[(stable["gamma_deg"] > 0) & (stable["gamma_deg"] < RIGHT_ANGLE) & (stable["kind"] == "grid")]
    own = angles[angles["mesh"] == "42x40"].dropna(subset=["mirror_both_MPa"])
    if own.empty:
        return None
    share = own["mirror_both_MPa"] / own["peak_MPa"]
    text = f"pressures differ from their mirror image by {share.min():.1%} to {share.max():.1%} of the peak"
    return banded((float(share.min()), float(share.max())), (0, ENOUGH), "share of the peak", text, len(own))


@claim(
    "point-half",
    "Half a tyre with half a turn about the contact normal is enough.",
    "theory of symmetry",
    "angle plies and isotropic, 42x40",
    f"{SOLVE} --model half",
)
def _point(tyre_models: pd.DataFrame) -> Verdict | None:
    own = tyre_models[tyre_models["model"] == "half"]
    if own.empty:
        return None
    text = f"force and pressures of {len(own)} tyres are those of the whole to {own['pressure_off'].max():.0e}"
    return counted(int(own["same"].astype(bool).sum()), len(own), text)


@claim(
    "old-ratio", "Linear strains give 1.41 times the contact force.", OLD, OURS, f"{SOLVE} --measure linear --error 5%"
)
def _old_ratio(tyre_budget: pd.DataFrame) -> Verdict | None:
    return _ratio(tyre_budget, (1.405, 1.415))


@claim(
    "old-von-karman",
    "Von Karman strains err by +3.8 % in the force.",
    OLD,
    OURS,
    f"{SOLVE} --measure von-karman --error 1%",
)
def _old_von_karman(tyre_budget: pd.DataFrame) -> Verdict | None:
    if (found := _changed(tyre_budget, "von-karman")) is None:
        return None
    text = f"{found[0]:+.1%} ± {found[1]:.1%} in the limit of the meshes"
    return banded((found[0] - found[1], found[0] + found[1]), (0.033, 0.043), "change of the force", text, 2)

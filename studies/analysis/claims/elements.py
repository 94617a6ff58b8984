"""Claims about elements, meshes, published values, and walls that are too thick for a shell."""

from __future__ import annotations

import math
from itertools import pairwise

import pandas as pd

from studies.analysis.claims.record import CAMPAIGN, Claims, Verdict, always, banded, counted, values_of

claim = Claims("elements and meshes")
BOOKS, PRACTICE, OLD = "textbooks of finite elements", "common practice", "earlier reports of this suite"
TYRE = "the force of the paper's tyre at 20 mm"
LOCKS = 0.95  # of the energy: a mesh that has less is locked
CLOSE = 0.002  # of a published value
SZE, REFERENCES = "Sze, Liu, Lo", ("read", "exact")
WITHIN = 0.01  # error of the force
THICK = 0.1
FEW = 16  # elements along either side


def _seconds(statement_values: pd.DataFrame, name: str, band: tuple[float, float]) -> Verdict | None:
    """Are the seconds of one thing over those of another, as a sentence has them, within a band?"""
    if not (own := values_of(statement_values, name)):
        return None
    text = f"{own['low']:.2f} to {own['high']:.2f} times the seconds, {own['middle']:.2f} in the median of "
    text += f"{own['problems']:.0f} problems"
    return banded((own["low"], own["high"]), band, "ratio of seconds", text, int(own["problems"]))


def _thin(walls: pd.Series) -> str:
    """The range of thicknesses, in words."""
    return f"from h/R = {walls.max():.0e} to {walls.min():.0e}"


@claim(
    "membrane-locking",
    "Assumed strains of four-node shells are free of membrane locking.",
    "papers on elements",
    "cylinder and hyperboloid with free ends",
    CAMPAIGN,
)
def _membrane(membrane_locking: pd.DataFrame) -> Verdict | None:
    own = membrane_locking[(membrane_locking["end"] == "free") & (membrane_locking["membrane"] == "relaxed")]
    own = own[own["elements"] == FEW]
    if own.empty:
        return None
    low, high = float(own["energy_ratio"].min()), float(own["energy_ratio"].max())
    text = f"{FEW}x{FEW} elements capture {low:.0%} to {high:.0%} of the energy of free shells {_thin(own['h_over_R'])}"
    return banded((low, high), (LOCKS, math.inf), "share of the energy", text, len(own))


@claim("shear-locking", "Full integration needs no care.", "manuals", "a cantilever of slenderness 1 to 1e4", CAMPAIGN)
def _shear(shear_locking: pd.DataFrame) -> Verdict | None:
    own = shear_locking["fully_integrated"]
    ours = shear_locking["ratio"]
    count = shear_locking["elements"].max()
    text = f"{count} fully integrated elements deflect by {own.min():.0e} to {own.max():.0%} of the beam, ours by "
    text += f"{ours.min():.1%} at least, at any slenderness"
    return banded((float(own.min()), float(own.max())), (LOCKS, math.inf), "share of the deflection", text, len(own))


@claim(
    "curved-locking",
    "Low-order curved beam elements lock as they become thin.",
    BOOKS,
    "a curved beam, default element",
    CAMPAIGN,
)
def _curved(curved_beam: pd.DataFrame) -> Verdict | None:
    finest = curved_beam[curved_beam["elements"] == curved_beam["elements"].max()]
    own = finest["ratio"]
    text = f"{own.min():.1%} to {own.max():.1%} of the deflection with the finest mesh {_thin(finest['h_over_R'])}"
    locked = int((own < LOCKS).sum())
    return counted(locked, len(own), text)


@claim(
    "thickness-locking",
    "A finer mesh removes Poisson thickness locking.",
    PRACTICE,
    "plates under moments and pressure, ν = 0.3 and 0.45",
    CAMPAIGN,
)
def _thickness(thickness_locking: pd.DataFrame) -> Verdict | None:
    own = thickness_locking[(thickness_locking["section"] == "full-3d") & (thickness_locking["nu"] > 0)]
    own = own[own["elements"] == own["elements"].max()]["stiffness_ratio"]
    if own.empty:
        return None
    text = f"on the finest mesh too stiff by factors of {own.min():.3f} to {own.max():.3f} with the law of the solid"
    return banded((float(own.min()), float(own.max())), (0.99, 1.01), "ratio of stiffness", text, len(own))


@claim(
    "second-order",
    "Displacements of bilinear elements converge with the square of their size.",
    BOOKS,
    "manufactured solutions of all measures",
    CAMPAIGN,
)
def _order(manufactured_orders: pd.DataFrame) -> Verdict | None:
    own = manufactured_orders["order_displacement"]
    text = f"orders of {own.min():.2f} to {own.max():.2f} in {len(own)} cases"
    return banded((float(own.min()), float(own.max())), (1.9, 2.1), "order", text, len(own))


@claim(
    "pressure-order",
    "Contact pressures converge as fast as displacements.",
    "taken for granted",
    "exact solutions with a moving edge of contact; eight of ten cases",
    CAMPAIGN,
)
def _pressure(manufactured_contact_orders: pd.DataFrame) -> Verdict | None:
    own = manufactured_contact_orders["order_pressure"].dropna()
    if own.empty:
        return None
    text = f"orders of {own.min():.1f} to {own.max():.1f}, {own.median():.1f} in the median of {len(own)} cases"
    return banded((float(own.quantile(0.1)), float(own.quantile(0.9))), (1.8, 2.2), "order", text, len(own))


def _published(errors: pd.DataFrame, ladders: pd.DataFrame, source: str, ladder: str = "") -> pd.DataFrame:
    """Limits beside published values, a row a quantity: of the default element, with a limit."""
    names = ladders[ladders["element"] == "refined"].drop_duplicates("sequence")
    found = errors[errors["kind"].isin(REFERENCES) & errors["source"].str.contains(source, regex=False)]
    found = found.merge(names[["sequence", "ladder", "quantity"]], on="sequence")
    found = found[found["ladder"].eq(ladder)] if ladder else found[found["ladder"].notna()]
    found = found.dropna(subset=["model_part"])
    return found.drop_duplicates(["ladder", "quantity", "value"], keep="last")


@claim(
    "sze-tables",
    "The tables of Sze, Liu and Lo (2004) are references to 0.2 %.",
    "papers on shells",
    "their ends of paths that have a limit here",
    CAMPAIGN,
)
def _sze(convergence_errors: pd.DataFrame, convergence: pd.DataFrame) -> Verdict | None:
    own = _published(convergence_errors, convergence, SZE)
    if own.empty:
        return None
    size, known = own["model_part"].abs(), own["limit_uncertainty"]
    near = int((size - known <= CLOSE).sum())
    text = f"{near} of {len(own)} values may be right to {CLOSE:.1%}; they differ from the limits by up to "
    text += f"{size.max():.1%} ({own.iloc[int(size.argmax())]['ladder']})"
    return counted(near, len(own), text)


@claim(
    "scordelis-lo",
    "The Scordelis-Lo roof deflects by 0.3024.",
    "MacNeal, Harder (1985)",
    "default element, linear strains, 0.1 %",
    "footprint solve scordelis-lo --out roof --error 0.2%",
)
def _scordelis(convergence_errors: pd.DataFrame, convergence: pd.DataFrame) -> Verdict | None:
    own = _published(convergence_errors, convergence, "", "scordelis-lo")
    own = own[own["value"] == 0.3024]
    if own.empty:
        return None
    row = own.iloc[-1]
    off, known = float(row["model_part"]), float(row["limit_uncertainty"])
    text = f"the limit is {off:+.2%} ± {known:.2%} from it"
    return banded((off - known, off + known), (-0.001, 0.001), "difference", text, 1)


@claim(
    "pagano",
    "One director through all plies is enough from a span of ten thicknesses.",
    BOOKS,
    "Pagano's cross-ply plate without a shear correction, 5 %",
    "footprint solve pagano --out plate",
)
def _pagano(convergence_errors: pd.DataFrame, convergence: pd.DataFrame) -> Verdict | None:
    own = _published(convergence_errors, convergence, "Pagano", "pagano-S10")
    if own.empty:
        return None
    off = own["model_part"]
    text = f"deflection and stresses differ by {off.min():+.0%} to {off.max():+.0%} from the exact plate"
    return banded((float(off.min()), float(off.max())), (-0.05, 0.05), "difference", text, len(own))


@claim("one-grid", "A grid whose answer is within 1 % has converged to 1 %.", "taken for granted", TYRE, CAMPAIGN)
def _crossing(work_precision: pd.DataFrame) -> Verdict | None:
    own = work_precision[(work_precision["family"] == "uniform") & (work_precision["element"] == "refined")]
    errors = own.sort_values("unknowns")["error"].abs().to_list()
    near = [n for n, error in enumerate(errors) if error <= WITHIN]
    if not near:
        return None
    lost = sum(any(error > WITHIN for error in errors[n + 1 :]) for n in near)
    text = f"of {len(near)} uniform grids within {WITHIN:.0%} {lost} are followed by a finer one that is not"
    return always(lost, len(near), text)


@claim("finer-is-better", "A finer mesh has a smaller error.", "taken for granted", TYRE, CAMPAIGN)
def _finer(work_precision: pd.DataFrame) -> Verdict | None:
    own = work_precision[(work_precision["family"] == "uniform") & (work_precision["element"] == "refined")]
    errors = own.sort_values("unknowns")["error"].abs().to_list()
    if len(errors) < 2:
        return None
    worse = sum(after > before for before, after in pairwise(errors))
    text = f"the error of the tyre's force grows in {worse} of {len(errors) - 1} steps to the next finer uniform grid"
    return always(worse, len(errors) - 1, text)


@claim("refine-the-patch", "Refine where the contact is.", f"{PRACTICE}; the mesh of the tyre's paper", TYRE, CAMPAIGN)
def _patch(work_precision: pd.DataFrame) -> Verdict | None:
    own = work_precision[work_precision["element"] == "refined"]
    wide = own.pivot_table(index="mesh", columns="family", values="error", aggfunc="first", sort=False).abs()
    if not {"patch", "uniform"} <= set(wide):
        return None
    pairs = wide[["patch", "uniform"]].dropna()
    better = int((pairs["patch"] < pairs["uniform"]).sum())
    text = f"less error than a uniform grid of as many elements on {better} of {len(pairs)} meshes"
    return counted(better, len(pairs), text)


@claim("local-grids", "Locally refined grids reach 1 % for the least time.", OLD, TYRE, CAMPAIGN, machine=True)
def _local(work_precision: pd.DataFrame) -> Verdict | None:
    own = work_precision[(work_precision["element"] == "refined") & (work_precision["error"].abs() <= WITHIN)]
    seconds = own.groupby("family")["total_s"]
    if not {"local", "uniform"} <= set(seconds.groups):
        return None
    ratio = float(seconds.max()["local"] / seconds.max()["uniform"])
    text = f"the finest local grid within {WITHIN:.0%} takes {ratio:.1f} times the seconds of the finest uniform one"
    return banded((ratio, ratio), (0, 1), "ratio of seconds", text, 1)


@claim(
    "paper-element",
    "The element of the paper is as good as any of its order.",
    OLD,
    "coarsest meshes of the benchmarks",
    CAMPAIGN,
)
def _coarse(element_choice: pd.DataFrame) -> Verdict | None:
    counts = element_choice["verdict"].value_counts()
    same = int(counts.get("equal", 0) + counts.get("worse", 0))
    text = f"on the coarsest mesh the default element is better for {counts.get('better', 0)} of {len(element_choice)} "
    text += f"quantities, equal for {counts.get('equal', 0)}, worse for {counts.get('worse', 0)}"
    return counted(same, len(element_choice), text)


@claim(
    "nodal-cheaper",
    "Thickness strains taken at the nodes are cheaper.",
    OLD,
    "problems of all regimes to 1 %, a fifth saved",
    "footprint choose tyre --out tyre",
    machine=True,
)
def _nodal(statement_values: pd.DataFrame) -> Verdict | None:
    return _seconds(statement_values, "nodal", (0, 0.8))


@claim(
    "thin-shells",
    "A wall thinner than a tenth of its radius is a shell.",
    BOOKS,
    "cases beside solids or closed forms, 1 %",
    CAMPAIGN,
)
def _shells(shell_boundaries: pd.DataFrame) -> Verdict | None:
    own = shell_boundaries[(shell_boundaries["variant"] == "default") & shell_boundaries["headline"].astype(bool)]
    own = own[own["boundary_1"] > 0]
    if own.empty:
        return None
    fine = int((own["boundary_1"] >= THICK).sum())
    worst = own.iloc[int(own["boundary_1"].argmin())]
    text = f"within 1 % of the solid up to {THICK:g} in {fine} of {len(own)} cases; least for the {worst['case']}, "
    text += f"{worst['boundary_1']:.2g}"
    return counted(fine, len(own), text)


@claim(
    "accuracy-is-dear",
    "An answer to 1 % costs many times one to 5 %.",
    PRACTICE,
    "problems of all regimes, recommended configurations",
    "footprint choose tyre --out tyre --error 5%",
    machine=True,
)
def _accuracy(statement_values: pd.DataFrame) -> Verdict | None:
    return _seconds(statement_values, "one-per-cent", (5, math.inf))


claim.untested(
    "twisted-beam",
    "The usual targets of the twisted beam are right to four digits.",
    "benchmark lists",
    "needs meshes that are not of lines of curvature",
)

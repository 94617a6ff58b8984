"""Claims whose verdict takes more than numbers that are read off one table: functions by their names in claims.toml."""

from __future__ import annotations

from itertools import pairwise

import pandas as pd

from studies.analysis.claims.record import Verdict, always, banded, counted
from studies.analysis.comparisons.friction import public_answers

CLOSE = 0.002  # of a published value
WITHIN = 0.01  # error of the force


def _published(errors: pd.DataFrame, ladders: pd.DataFrame, source: str, ladder: str = "") -> pd.DataFrame:
    """Limits beside published values, a row a quantity: of the default element, with a limit."""
    names = ladders[ladders["element"] == "refined"].drop_duplicates("sequence")
    found = errors[errors["kind"].isin(("read", "exact")) & errors["source"].str.contains(source, regex=False)]
    found = found.merge(names[["sequence", "ladder", "quantity"]], on="sequence")
    found = found[found["ladder"].eq(ladder)] if ladder else found[found["ladder"].notna()]
    found = found.dropna(subset=["model_part"])
    return found.drop_duplicates(["ladder", "quantity", "value"], keep="last")


def sze_tables(convergence_errors: pd.DataFrame, convergence: pd.DataFrame) -> Verdict | None:
    """How many of their values may be right, within what the limits are uncertain by?"""
    own = _published(convergence_errors, convergence, "Sze, Liu, Lo")
    if own.empty:
        return None
    size, known = own["model_part"].abs(), own["limit_uncertainty"]
    near = int((size - known <= CLOSE).sum())
    text = f"{near} of {len(own)} values may be right to {CLOSE:.1%}; they differ from the limits by up to "
    text += f"{size.max():.1%} ({own.iloc[int(size.argmax())]['ladder']})"
    return counted(near, len(own), text)


def scordelis_lo(convergence_errors: pd.DataFrame, convergence: pd.DataFrame) -> Verdict | None:
    """The limit beside the usual target."""
    own = _published(convergence_errors, convergence, "", "scordelis-lo")
    own = own[own["value"] == 0.3024]
    if own.empty:
        return None
    row = own.iloc[-1]
    off, known = float(row["model_part"]), float(row["limit_uncertainty"])
    text = f"the limit is {off:+.2%} ± {known:.2%} from it"
    return banded((off - known, off + known), (-0.001, 0.001), "difference", text, 1)


def pagano(convergence_errors: pd.DataFrame, convergence: pd.DataFrame) -> Verdict | None:
    """Deflection and stresses beside the exact plate."""
    own = _published(convergence_errors, convergence, "Pagano", "pagano-S10")
    if own.empty:
        return None
    off = own["model_part"]
    text = f"deflection and stresses differ by {off.min():+.0%} to {off.max():+.0%} from the exact plate"
    return banded((float(off.min()), float(off.max())), (-0.05, 0.05), "difference", text, len(own))


def _uniform_errors(work_precision: pd.DataFrame) -> list[float]:
    """Of the default element, coarse to fine."""
    own = work_precision[(work_precision["family"] == "uniform") & (work_precision["element"] == "refined")]
    return own.sort_values("unknowns")["error"].abs().to_list()


def one_grid(work_precision: pd.DataFrame) -> Verdict | None:
    """Is a grid that is within 1 % followed by one that is not?"""
    errors = _uniform_errors(work_precision)
    near = [n for n, error in enumerate(errors) if error <= WITHIN]
    if not near:
        return None
    lost = sum(any(error > WITHIN for error in errors[n + 1 :]) for n in near)
    text = f"of {len(near)} uniform grids within {WITHIN:.0%} {lost} are followed by a finer one that is not"
    return always(lost, len(near), text)


def finer_is_better(work_precision: pd.DataFrame) -> Verdict | None:
    """How often does the error grow?"""
    errors = _uniform_errors(work_precision)
    if len(errors) < 2:
        return None
    worse = sum(after > before for before, after in pairwise(errors))
    text = f"the error of the tyre's force grows in {worse} of {len(errors) - 1} steps to the next finer uniform grid"
    return always(worse, len(errors) - 1, text)


def refine_the_patch(work_precision: pd.DataFrame) -> Verdict | None:
    """Grids refined at the patch beside uniform ones of as many elements."""
    own = work_precision[work_precision["element"] == "refined"]
    wide = own.pivot_table(index="mesh", columns="family", values="error", aggfunc="first", sort=False).abs()
    if not {"patch", "uniform"} <= set(wide):
        return None
    pairs = wide[["patch", "uniform"]].dropna()
    better = int((pairs["patch"] < pairs["uniform"]).sum())
    text = f"less error than a uniform grid of as many elements on {better} of {len(pairs)} meshes"
    return counted(better, len(pairs), text)


def one_step(friction_steps: pd.DataFrame) -> Verdict | None:
    """The errors of force and dissipation in the fewest load steps."""
    row = friction_steps.iloc[int(friction_steps["steps"].argmin())]
    force, lost = abs(float(row["friction_N_error"])), abs(float(row["dissipation_N_mm_error"]))
    text = f"the force errs by {force:.1%}, the dissipation by {lost:.0%}"
    return banded((min(force, lost), max(force, lost)), (0, 0.01), "change of the answer", text, 1)


def public_friction(friction_public: pd.DataFrame) -> Verdict | None:
    """Of how many problems has the best algorithm an answer that the judge takes?"""
    _, counts = public_answers(friction_public)
    if counts.empty:
        return None
    of = friction_public.dropna(subset=["algorithm"])["problem"].nunique()
    text = f"the best one, `{counts.index[0]}`, has certified answers of {counts.iloc[0]} of {of} within seconds"
    return counted(int(counts.iloc[0]), int(of), text)

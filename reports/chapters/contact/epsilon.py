"""The page of epsilon: slopes, plateau and break-down of the regularisation, and the paper's value judged."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from reports.chapter import Chapter
from reports.chapters.contact import figures as figures_contact
from reports.chapters.contact.figures import PAPER
from reports.markdown import NOTHING, Part, fixed, joined, machine, percent, picture, prose, scientific, table
from reports.tables import Store

NAME = "epsilon.svg"
STRAIGHT = 0.05  # local slopes this close to -1 belong to the law
SOFT = 0.01  # error of the force above which epsilon is too soft
LEVEL = 1e-12  # error of the force below which nothing but rounding is left
SIZE = {"tyre": "the tyre at 20 mm", "strip": "the clamped strip at five times its touching pressure"}


@dataclass(frozen=True)
class Law:
    """value ~ epsilon^slope between two epsilons; None where no two neighbouring decades follow the law."""

    slope: float | None
    low: float
    high: float


def fitted_law(epsilon: pd.Series, value: pd.Series) -> Law:
    """The longest run of epsilons over which the local slope is -1, and the least-squares slope over it.

    Values that rounding makes, LEVEL and less, do not count.
    """
    x, y = np.log10(epsilon.to_numpy(float)), value.abs().to_numpy(float)
    y = np.where(y > LEVEL, y, np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        straight = np.abs(np.diff(np.log10(y)) / np.diff(x) + 1) <= STRAIGHT
    best, run = (0, 0), 0
    for i, good in enumerate(straight):
        run = run + 1 if good else 0
        best = max(best, (run, i + 1))
    length, last = best
    if length == 0:
        return Law(None, math.nan, math.nan)
    own = slice(last - length, last + 1)
    slope = float(np.polyfit(x[own], np.log10(y[own]), 1)[0])
    return Law(slope, float(10 ** x[own][0]), float(10 ** x[own][-1]))


@dataclass(frozen=True)
class Findings:
    """Where a case is too soft, where it is as good as exact, and where the displacement form breaks down."""

    penetration: Law
    force: Law
    soft_until: float | None
    level_from: float | None
    breaks_at: float | None
    best: float
    best_error: float


def findings(own: pd.DataFrame) -> Findings:
    """Of the rows of one case."""
    multiplier = own[(own["form"] == "multiplier") & np.isfinite(own["epsilon"])]
    displacement = own[own["form"] == "displacement"]
    error = multiplier["force_error"].abs()
    soft, level = multiplier["epsilon"][error > SOFT], multiplier["epsilon"][error > LEVEL]
    after = multiplier["epsilon"][multiplier["epsilon"] > (level.max() if len(level) else 0.0)]
    broken = displacement["epsilon"][displacement["outcome"] != "converged"]
    converged = displacement[displacement["outcome"] == "converged"]
    best = converged.iloc[int(converged["force_error"].abs().argmin())]
    return Findings(
        fitted_law(multiplier["epsilon"], multiplier["penetration_mm"]),
        fitted_law(multiplier["epsilon"], multiplier["force_error"]),
        float(soft.max()) if len(soft) else None,
        float(after.min()) if len(after) else None,
        float(broken.min()) if len(broken) else None,
        float(best["epsilon"]),
        abs(float(best["force_error"])),
    )


def epsilon_page(store: Store) -> Part:
    """The whole page."""
    data = store.table("epsilon")
    cases = list(dict.fromkeys(data["case"]))
    text = prose(f"""# How large should ε be?

The paper replaces the contact condition by p = ε <-g>: a pressure proportional to the penetration, with
ε = {PAPER:g} MPa/mm. The same two problems are solved with ε from {data["epsilon"].min():g} to
{data["epsilon"][np.isfinite(data["epsilon"])].max():g} MPa/mm, each from the state before contact, and compared with
the exact multiplier: {" and ".join(SIZE.get(case, case) for case in cases)}. Two forms of one equation: the
*multiplier* form keeps the pressure as an unknown; the *displacement* form eliminates it, K + ε GᵀWG, as penalty
methods do. The error of the force is that of the sum of the contact forces.""")
    shown = picture(NAME, "Penetration, error of the force and condition over ε, two cases in two forms")
    parts = [Part(f"{text}\n\n{shown}", {NAME: figures_contact.epsilon(data)}), Part(_laws(data, cases))]
    parts += [Part(_paper(data, cases)), *(Part(_case(data[data["case"] == case], case)) for case in cases)]
    return joined([*parts, Part("The table is part of the campaigns `agreement` and `report`: `footprint run`.")])


def _laws(data: pd.DataFrame, cases: list[str]) -> str:
    rows, ends = [], []
    for case in cases:
        found = findings(data[data["case"] == case])
        laws = [word for law in (found.penetration, found.force) for word in (fixed(law.slope, 3), _range(law))]
        rows.append([case, *laws, _epsilon(found.soft_until), _epsilon(found.level_from)])
        ends.append([case, _epsilon(found.breaks_at), scientific(found.best_error), f"{found.best:g}"])
    header = ["case", "slope of the penetration", "over ε", "slope of the force error", "over ε"]
    header += [f"error above {percent(SOFT, 0, False)} up to", f"error below {scientific(LEVEL, 0)} from"]
    text = prose("""## Slopes, plateau, break-down

Penetration and force error fall as 1/ε; the slopes are fitted by least squares over the longest run of decades whose
local slopes are -1. The multiplier form ends on a plateau of rounding and stays there. The displacement form ends
where ε times the rounding of a gap exceeds what the forces may be out of balance: its pressures lose the digits that
the condition of its matrix takes. How far ε may go depends on the problem, since the stiffness of the body and the
size of its pressures stand beside it: the thin strip breaks down first.""")
    broken = ["case", "does not converge from", "smallest error of a converged force", "at ε"]
    blocks = [text, table("Laws and limits, ε in MPa/mm", header, rows)]
    # one decade more or less is a matter of rounding
    return "\n\n".join([*blocks, machine(table("Break-down of the displacement form, ε in MPa/mm", broken, ends))])


def _range(law: Law) -> str:
    return NOTHING if law.slope is None else f"{law.low:g} … {law.high:g}"


def _epsilon(value: float | None) -> str:
    return NOTHING if value is None else f"{value:g}"


def _paper(data: pd.DataFrame, cases: list[str]) -> str:
    """The paper's epsilon on the tyre, and how far it is from either end."""
    lines, ends = [], []
    for case in cases:
        own = data[data["case"] == case]
        row = own[(own["form"] == "multiplier") & (own["epsilon"] == PAPER)].iloc[0]
        penalised = own[(own["form"] == "displacement") & (own["epsilon"] == PAPER)].iloc[0]
        exact = own[~np.isfinite(own["epsilon"])].iloc[0]
        found = findings(own)
        growth = float(penalised["condition"]) / float(exact["condition"])
        ends.append(f"- {SIZE.get(case, case)}: {_room(found.breaks_at)}")
        lines.append(
            f"- {SIZE.get(case, case)}: force off by {scientific(abs(row['force_error']))} of itself, "
            f"penetration {scientific(row['penetration_mm'])} mm, {int(row['nodes_unlike'])} nodes unlike the exact "
            f"set, {int(row['iterations'])} iterations against {int(exact['iterations'])}; the matrix of the "
            f"displacement form has {digits_of(growth)} times the condition of the exact one."
        )
    text = prose("""With the multiplier form nothing speaks against a larger ε, or against the exact condition, which
takes no more iterations. Eliminated, the pressure leaves this room for a harder one:""")
    heading = f"## The paper's ε = {PAPER:g}"
    return "\n\n".join([heading, "\n".join(lines), text, machine("\n".join(ends))])


def _room(breaks_at: float | None) -> str:
    """Between the paper's epsilon and the break-down."""
    if breaks_at is None:
        return "every tested ε converges"
    decades = math.log10(breaks_at / PAPER)
    return f"the break-down is {fixed(decades, 0)} decades away" if decades > 0 else "this ε does not converge any more"


def digits_of(value: float) -> str:
    """Two digits, without an exponent up to a thousand."""
    return f"{value:.2g}" if value < 1e3 else scientific(value)


def _case(own: pd.DataFrame, case: str) -> str:
    """All rows; those of the displacement form are decided by rounding."""
    header = ["ε [MPa/mm]", "outcome", "iterations", "penetration [mm]", "force [N]", "error of the force"]
    header += ["nodes unlike", "condition"]
    blocks = [f"## {case.capitalize()}: all solves"]
    for form in dict.fromkeys(own["form"]):
        rows = [_row(row) for _, row in own[own["form"] == form].iterrows()]
        body = table(f"The {form} form", header, rows, words=2)
        blocks.append(body if form == "multiplier" else machine(body))
    return "\n\n".join(blocks)


def _row(row: pd.Series) -> list[str]:
    error, penetration = abs(float(row["force_error"])), float(row["penetration_mm"])
    return [
        *(f"{float(row['epsilon']):g}", str(row["outcome"]), str(row["iterations"])),
        scientific(penetration, 2) if penetration > LEVEL else f"< {LEVEL:g}",
        f"{float(row['force_N']):.7g}",
        scientific(error, 2) if error > LEVEL else f"< {LEVEL:g}",
        *(str(row["nodes_unlike"]), scientific(float(row["condition"]))),
    ]


CHAPTER = Chapter(
    "epsilon",
    "Contact: ε",
    "the regularisation from far too soft to far too hard, and the paper's value.",
    epsilon_page,
    needs=("epsilon",),
    always=True,
)

"""The page of epsilon: slopes, plateau and break-down of the regularisation, and the paper's value judged."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from reports.chapter import Chapter
from reports.chapters.contact import figures as figures_contact
from reports.chapters.contact.figures import PAPER
from reports.markdown import NOTHING, Part, fixed, joined, machine, percent, picture, prose, scientific, table
from reports.tables import Store

NAME = "epsilon.svg"
SIZE = {"tyre": "the tyre at 20 mm", "strip": "the clamped strip at five times its touching pressure"}


Laws = Mapping[Any, Mapping[Any, Any]]  # by case, the row of the table of laws


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
    laws, rule = store.analysis("epsilon_laws").set_index("case").to_dict("index"), store.rules()
    parts = [Part(f"{text}\n\n{shown}", {NAME: figures_contact.epsilon(data)}), Part(_laws(laws, rule))]
    level, own = rule["epsilon_level"], {case: data[data["case"] == case] for case in cases}
    parts += [Part(_paper(data, laws)), *(Part(_case(own[case], case, level)) for case in cases)]
    return joined([*parts, Part("The table is part of the campaigns `agreement` and `report`: `footprint run`.")])


def _laws(laws: Laws, rule: Mapping[str, float]) -> str:
    rows, ends = [], []
    for case, law in laws.items():
        slopes = [w for name in ("penetration", "force") for w in (fixed(law[f"{name}_slope"], 3), _range(law, name))]
        rows.append([case, *slopes, _epsilon(law["soft_until"]), _epsilon(law["level_from"])])
        ends.append([case, _epsilon(law["breaks_at"]), scientific(law["best_error"]), f"{law['best']:g}"])
    header = ["case", "slope of the penetration", "over ε", "slope of the force error", "over ε"]
    header += [
        f"error above {percent(rule['epsilon_soft'], 0, False)} up to",
        f"error below {scientific(rule['epsilon_level'], 0)} from",
    ]
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


def _range(law: Mapping[Any, Any], name: str) -> str:
    low, high = (law[f"{name}_{end}"] for end in ("low", "high"))
    return NOTHING if math.isnan(low) else f"{low:g} … {high:g}"


def _epsilon(value: float) -> str:
    return NOTHING if math.isnan(value) else f"{value:g}"


def _paper(data: pd.DataFrame, laws: Laws) -> str:
    """The paper's epsilon on the tyre, and how far it is from either end."""
    lines, ends = [], []
    for case, law in laws.items():
        own = data[data["case"] == case]
        row = own[(own["form"] == "multiplier") & (own["epsilon"] == PAPER)].iloc[0]
        penalised = own[(own["form"] == "displacement") & (own["epsilon"] == PAPER)].iloc[0]
        exact = own[~np.isfinite(own["epsilon"])].iloc[0]
        growth = float(penalised["condition"]) / float(exact["condition"])
        ends.append(f"- {SIZE.get(case, case)}: {_room(law['breaks_at'])}")
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


def _room(breaks_at: float) -> str:
    """Between the paper's epsilon and the break-down."""
    if math.isnan(breaks_at):
        return "every tested ε converges"
    decades = math.log10(breaks_at / PAPER)
    return f"the break-down is {fixed(decades, 0)} decades away" if decades > 0 else "this ε does not converge any more"


def digits_of(value: float) -> str:
    """Two digits, without an exponent up to a thousand."""
    return f"{value:.2g}" if value < 1e3 else scientific(value)


def _case(own: pd.DataFrame, case: str, level: float) -> str:
    """All rows; those of the displacement form are decided by rounding."""
    header = ["ε [MPa/mm]", "outcome", "iterations", "penetration [mm]", "force [N]", "error of the force"]
    header += ["nodes unlike", "condition"]
    blocks = [f"## {case.capitalize()}: all solves"]
    for form in dict.fromkeys(own["form"]):
        rows = [_row(row, level) for _, row in own[own["form"] == form].iterrows()]
        body = table(f"The {form} form", header, rows, words=2)
        blocks.append(body if form == "multiplier" else machine(body))
    return "\n\n".join(blocks)


def _row(row: pd.Series, level: float) -> list[str]:
    error, penetration = abs(float(row["force_error"])), float(row["penetration_mm"])
    return [
        *(f"{float(row['epsilon']):g}", str(row["outcome"]), str(row["iterations"])),
        scientific(penetration, 2) if penetration > level else f"< {level:g}",
        f"{float(row['force_N']):.7g}",
        scientific(error, 2) if error > level else f"< {level:g}",
        *(str(row["nodes_unlike"]), scientific(float(row["condition"]))),
    ]


CHAPTER = Chapter(
    "epsilon",
    "Contact: ε",
    "the regularisation from far too soft to far too hard, and the paper's value.",
    epsilon_page,
    needs=("rules", "epsilon", "epsilon_laws"),
    always=True,
)

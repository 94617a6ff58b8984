"""The page of epsilon: slopes, plateau and break-down of the regularisation, and the paper's value judged."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.chapter import Chapter
from reports.figures.drawing import BLACK, canvas, legend_above, looks, svg
from reports.formats import NOTHING, fixed, scientific, share
from reports.markdown import Part, commands, fold, joined, listing, machine, picture, prose
from reports.store.tables import Store

PAPER = 1e4  # MPa/mm
FORMS = {"multiplier": "-", "displacement": "--"}  # and how they are drawn
PANELS = (  # column, words, what is drawn of it
    ("penetration_mm", "penetration [mm]", (1e-15, 1e2)),
    ("force_error", "relative error of the force", (1e-17, 1e1)),
    ("condition", "condition (1-norm)", (1e4, 1e18)),
)
SIZE = {"tyre": "the tyre at 20 mm", "strip": "the clamped strip at five times its touching pressure"}


def epsilon_page(store: Store) -> Part:
    """The whole page."""
    data = store.table("epsilon")
    cases = list(dict.fromkeys(data["case"]))
    meshes = data.drop_duplicates("case").set_index("case")["mesh"]
    named = " and ".join(f"{SIZE.get(case, case)} (mesh {meshes[case]})" for case in cases)
    text = prose(f"""# Regularisation by ε

The paper replaces the contact condition by p = ε <-g>: a pressure proportional to the penetration, with
ε = {PAPER:g} MPa/mm. The same two problems are solved with ε from {data["epsilon"].min():g} to
{data["epsilon"][np.isfinite(data["epsilon"])].max():g} MPa/mm, each from the state before contact, and compared with
the exact multiplier: {named}. Two forms of one equation: the
*multiplier* form keeps the pressure as an unknown; the *displacement* form eliminates it, K + ε GᵀWG, as penalty
methods do. The error of the force is that of the sum of the contact forces.""")
    laws, rule = store.analysis("epsilon_laws"), store.rules()
    words = "Penetration, error of the force and condition over ε, two cases in two forms"
    return joined(
        text,
        _recommended(laws, meshes),
        picture("epsilon.svg", words, draw_epsilon(data)),
        *_laws(laws, rule),
        _paper(data, laws),
        *(_case(data[data["case"] == case], case, rule["epsilon_level"]) for case in cases),
        prose("""The commands solve the cases with the multiplier form, from the beginning of their paths; the
displacement form is an experiment of the campaigns `agreement` and `report` (`footprint run`)."""),
        commands(data["command"][data["form"] == "multiplier"]),
    )


def _recommended(laws: pd.DataFrame, meshes: pd.Series) -> Part:
    """From which epsilon on the force is right, and up to which a form of it can be solved."""
    heads = "case | mesh | multiplier form | displacement form"
    line = "{case} | {mesh} | from {level_from:g} on | from {level_from:g} to below {breaks_at:end}"
    found = laws.assign(mesh=laws["case"].map(meshes))
    return Part(machine(listing("Range of ε [MPa/mm] to be used", found, heads, line, words=4, end=_end)))


def _end(breaks_at: float) -> str:
    return "any tested" if math.isnan(breaks_at) else f"{breaks_at:g}"


@svg
def draw_epsilon(table: pd.DataFrame) -> Figure:
    """Penetration, force error and condition over epsilon: a colour a case, solid and dashed the two forms.

    Hollow markers: not converged; what is not even of the size of the answer is left out. Dotted: the paper's epsilon.
    """
    table = table[np.isfinite(table["epsilon"]) & (table["force_error"].abs() < 1)]
    drawn, (figure, every) = looks(table["case"]), canvas(3, width=12.0, height=4.4)
    for axes, (column, label, limits) in zip(every, PANELS, strict=True):
        for case, form in product(drawn, FORMS):
            rows = table[(table["case"] == case) & (table["form"] == form)]
            value, converged = rows[column].abs(), rows["outcome"] == "converged"
            value = value.where(value.between(*limits))
            colour, marker = drawn[case].colour, drawn[case].marker
            axes.loglog(rows["epsilon"], value, color=colour, linestyle=FORMS[form])
            axes.plot([], [], color=colour, linestyle=FORMS[form], marker=marker, label=f"{case}, {form} form")
            for fill, chosen in (("full", converged), ("none", ~converged)):
                dots = {"color": colour, "marker": marker, "linestyle": "none", "fillstyle": fill}
                axes.loglog(rows["epsilon"], value.where(chosen), **dots)
        axes.axvline(PAPER, color=BLACK, linestyle=":", linewidth=1)
        axes.set(xlabel="ε [MPa/mm]", ylabel=label, ylim=limits, xlim=(3e-3, 3e14))
    every[0].plot([], [], "o", color=BLACK, fillstyle="none", label="not converged")
    every[0].plot([], [], color=BLACK, linestyle=":", linewidth=1, label="the paper's ε")
    legend_above(figure, every[0], columns=6)
    return figure


def _laws(laws: pd.DataFrame, rule: Mapping[str, float]) -> tuple[str, str, str]:
    soft, level = share(rule["epsilon_soft"], 0), scientific(rule["epsilon_level"], 0)
    heads = "case | slope of the penetration | over ε | slope of the force error | over ε | "
    heads += f"error above {soft} up to | error below {level} from"
    line = "{case} | {penetration_slope:.3f} | {penetration_over} | {force_slope:.3f} | {force_over} | "
    line += "{soft_until:g} | {level_from:g}"
    over = {f"{name}_over": _ranges(laws, name) for name in ("penetration", "force")}
    broken = "case | does not converge from | smallest error of a converged force | at ε"
    ends = "{case} | {breaks_at:g} | {best_error:.1e} | {best:g}"
    text = prose("""## Slopes, plateau, break-down

Penetration and force error fall as 1/ε; the slopes are fitted by least squares over the longest run of decades whose
local slopes are -1. The multiplier form ends on a plateau of rounding and stays there. The displacement form ends
where ε times the rounding of a gap exceeds what the forces may be out of balance: its pressures lose the digits that
the condition of its matrix takes. How far ε may go depends on the problem, since the stiffness of the body and the
size of its pressures stand beside it: the thin strip breaks down first.""")
    slopes = listing("Laws and limits, ε in MPa/mm", laws.assign(**over), heads, line)
    # one decade more or less is a matter of rounding
    return text, slopes, machine(listing("Break-down of the displacement form, ε in MPa/mm", laws, broken, ends))


def _ranges(laws: pd.DataFrame, name: str) -> list[str]:
    """Where a slope was fitted, case by case."""
    ends = zip(laws[f"{name}_low"], laws[f"{name}_high"], strict=True)
    return [NOTHING if math.isnan(low) else f"{low:g} … {high:g}" for low, high in ends]


def _paper(data: pd.DataFrame, laws: pd.DataFrame) -> Part:
    """The paper's epsilon on the tyre, and how far it is from either end."""
    lines, ends = [], []
    for case, breaks_at in zip(laws["case"], laws["breaks_at"], strict=True):
        own = data[data["case"] == case]
        row = own[(own["form"] == "multiplier") & (own["epsilon"] == PAPER)].iloc[0]
        penalised = own[(own["form"] == "displacement") & (own["epsilon"] == PAPER)].iloc[0]
        exact = own[~np.isfinite(own["epsilon"])].iloc[0]
        growth = float(penalised["condition"]) / float(exact["condition"])
        ends.append(f"- {SIZE.get(case, case)}: {_room(breaks_at)}")
        lines.append(
            f"- {SIZE.get(case, case)}: force off by {scientific(abs(row['force_error']))} of itself, "
            f"penetration {scientific(row['penetration_mm'])} mm, {int(row['nodes_unlike'])} nodes in only one of "
            f"its set and the exact one, {int(row['iterations'])} iterations against {int(exact['iterations'])}; the "
            f"matrix of the displacement form has {digits_of(growth)} times the condition of the exact one."
        )
    text = prose("""With the multiplier form a larger ε does no harm, and neither does the exact condition,
which takes no more iterations. Eliminated, the pressure leaves this room for a harder one:""")
    return joined(f"## The paper's ε = {PAPER:g}", "\n".join(lines), text, machine("\n".join(ends)))


def _room(breaks_at: float) -> str:
    """Between the paper's epsilon and the break-down."""
    if math.isnan(breaks_at):
        return "every tested ε converges"
    decades = math.log10(breaks_at / PAPER)
    return f"the break-down is {fixed(decades)} decades away" if decades > 0 else "this ε does not converge any more"


def digits_of(value: float) -> str:
    """Two digits, without an exponent up to a thousand."""
    return f"{value:.2g}" if value < 1e3 else scientific(value)


def _case(own: pd.DataFrame, case: str, level: float) -> Part:
    """All rows; those of the displacement form are decided by rounding."""

    def size(value: float) -> str:
        return scientific(abs(value), 2) if abs(value) > level else f"< {level:g}"

    heads = "ε [MPa/mm] | outcome | iterations | penetration [mm] | force [N] | error of the force | "
    heads += "nodes in one set only | condition"
    line = "{epsilon:g} | {outcome} | {iterations} | {penetration_mm:size} | {force_N:.7g} | {force_error:size} | "
    line += "{nodes_unlike} | {condition:.1e}"
    blocks = []
    for form, rows in own.groupby("form", sort=False):
        body = listing(
            f"{case.capitalize()}, the {form} form, mesh {own['mesh'].iloc[0]}", rows, heads, line, 2, size=size
        )
        blocks.append(body if form == "multiplier" else machine(body))
    return fold(f"{case.capitalize()}: all solves", *blocks)


CHAPTER = Chapter(
    "epsilon",
    "Regularisation by ε",
    "the regularisation from far too soft to far too hard, and the paper's value.",
    epsilon_page,
    needs=("rules", "epsilon", "epsilon_laws"),
    always=True,
)

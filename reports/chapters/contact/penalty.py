"""Part of the page of algorithms: which ε a penalty code needs, from the stiffness of the wall."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, canvas, legend_above, looks, svg
from reports.formats import NOTHING, scientific
from reports.markdown import Part, commands, joined, listing, machine, picture, prose
from reports.store.tables import Store

PAPER = 1e4  # MPa/mm
SOFTEST = 1e-2  # of E/h: what fails below that fails for another reason than the penalty
PANELS = (  # column, words, what is drawn of it
    ("force_error", "relative error of the force", (1e-11, 1e1)),
    ("growth", "condition over that of exact contact", (3e-1, 1e12)),
)


def penalty_part(store: Store) -> Part:
    """The recommendation, the problems that it rests on, and the paper's ε."""
    data, laws = store.table("epsilon"), store.analysis("epsilon_laws")
    sides, slopes = laws["element_over_h"], laws["force_slope"]
    heads = "problem | E/h [MPa/mm] | element over h | error of the force at E/h | growth of the condition at E/h | "
    heads += "at 10 E/h | residual above 1e-9 from"
    line = "{case} | {wall:.4g} | {element_over_h:.2g} | {error_at_wall:.1e} | {growth_at_wall:.3g} | "
    line += "{growth_at_ten:.3g} | {fails_at:fails}"
    text = prose(f"""## Which ε does a penalty code need?

A penalty method replaces contact by p = ε <-g>, a pressure proportional to the penetration, and adds ε GᵀWG to the
stiffness. **Take ε = E/h**, with the largest modulus and the thickness of the wall: a spring of E a²/h at a node of a
square element with the side a. Condition: elements no smaller than the wall is thick (here {sides.min():.2g} to
{sides.max():.2g} times), and a penetration p h/E that is small beside the travel. The relative error of the force is
about the penetration over the travel, and falls with 1/ε (fitted exponents {slopes.min():.2f} to {slopes.max():.2f}).
The condition of the matrix grows as ε from above E/h on, where the spring is stiffer than the wall through its
thickness; each digit more of the force then costs a digit of the solve. {len(laws)} problems, from far too soft to far
too hard:""")
    made = machine(listing("A penalty of ε = E/h", laws, heads, line, fails=_fails))  # rounding decides the last
    words = "Error of the force and condition of a penalty method over ε in units of E/h"
    after = prose(f"""A residual that stays above 1e-9 is at first rounding alone, and the force still right; many
decades higher the force is lost, too (right end of the curves). Where it does so for any ε, the stiffness of the body
is the cause and not the penalty. With the pressure as an unknown, as in `semismooth`,
there is no such limit, and exact contact takes no more iterations than the paper's ε in {_no_dearer(data)} of
{len(laws)} problems.""")
    drawn = picture("epsilon.svg", words, draw_penalty(data, laws))
    return joined(text, made, drawn, _paper(data, laws), after, commands(data["command"][data["epsilon"] == PAPER]))


def _no_dearer(data: pd.DataFrame) -> int:
    """In how many problems exact contact takes no more iterations than the paper's epsilon."""
    kept = data[data["form"] == "multiplier"]
    exact, paper = (kept[kept["epsilon"] == at].set_index("case")["iterations"] for at in (np.inf, PAPER))
    return int((exact <= paper).sum())


def _fails(value: float) -> str:
    return NOTHING if math.isnan(value) else "any ε" if value < SOFTEST else f"{value:.2g} E/h"


def _paper(data: pd.DataFrame, laws: pd.DataFrame) -> str:
    """The paper's epsilon on its tyre."""
    known = laws[laws["case"] == "tyre"]
    rows = data[(data["case"] == "tyre") & (data["form"] == "displacement") & (data["epsilon"] == PAPER)]
    if known.empty or rows.empty:
        return ""
    row = rows.iloc[0]
    return prose(f"""The paper's ε of {PAPER:g} MPa/mm is {PAPER / known["wall"].iloc[0]:.2g} E/h on its tyre:
the force at 20 mm differs from exact contact by {scientific(abs(row["force_error"]))} on a mesh of {row["mesh"]}, and
the wall penetrates by {scientific(row["penetration_mm"])} mm.""")


@svg
def draw_penalty(data: pd.DataFrame, laws: pd.DataFrame) -> Figure:
    """A penalty method over ε h/E, a colour a problem; hollow: the tolerance is not reached. Dotted: ε = E/h.

    What is not even of the size of the answer is left out.
    """
    exact = data[~np.isfinite(data["epsilon"])].set_index("case")["condition"]
    own = data[(data["form"] == "displacement") & (data["force_error"].abs() < 1)]
    own = own.assign(
        at=own["epsilon"] / own["case"].map(laws.set_index("case")["wall"]),
        growth=own["condition"] / own["case"].map(exact),
    )
    drawn, (figure, every) = looks(own["case"]), canvas(len(PANELS), width=10.0, height=4.4)
    for axes, (column, label, limits) in zip(every, PANELS, strict=True):
        for case, look in drawn.items():
            rows = own[own["case"] == case]
            value, converged = rows[column].abs(), rows["outcome"] == "converged"
            axes.loglog(rows["at"], value, **look.dashes)
            axes.plot([], [], **look.whole, label=case)
            for fill, chosen in (("full", converged), ("none", ~converged)):
                axes.loglog(rows["at"], value.where(chosen), **look.points, linestyle="none", fillstyle=fill)
        axes.axvline(1.0, color=BLACK, linestyle=":", linewidth=1)
        axes.set(xlabel="ε over E/h", ylabel=label, ylim=limits)
    every[0].plot([], [], "o", color=BLACK, fillstyle="none", label="residual above 1e-9")
    legend_above(figure, every[0], columns=5)
    return figure

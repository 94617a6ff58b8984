"""Part of the page of algorithms: which ε a penalty code needs, from the stiffness of the wall."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, canvas, legend_above, looks, svg
from reports.formats import NOTHING
from reports.markdown import Part, commands
from reports.store.tables import Store
from reports.template import Template

PAPER = 1e4  # MPa/mm
SOFTEST = 1e-2  # of E/h: what fails below that fails for another reason than the penalty
PANELS = (  # column, words, what is drawn of it
    ("force_error", "relative error of the force", (1e-11, 1e1)),
    ("growth", "condition over that of exact contact", (3e-1, 1e12)),
)


def _fails(value: float) -> str:
    return NOTHING if math.isnan(value) else "any ε" if value < SOFTEST else f"{value:.2g} E/h"


TEXT = Template("algorithms", fails=_fails)


def penalty_part(store: Store) -> Part:
    """The recommendation, the problems that it rests on, and the paper's ε."""
    data, laws = store.table("epsilon"), store.analysis("epsilon_laws")
    sides, slopes = laws["element_over_h"], laws["force_slope"]
    told = {
        **{"smallest": sides.min(), "largest": sides.max(), "flattest": slopes.min(), "steepest": slopes.max()},
        **{"count": len(laws), "laws": laws, "paper": _paper(data, laws), "no_dearer": _no_dearer(data)},
        "commands": commands(data["command"][data["epsilon"] == PAPER]),
    }
    return TEXT("penalty", {"epsilon.svg": draw_penalty(data, laws)}, **told)


def _no_dearer(data: pd.DataFrame) -> int:
    """In how many problems exact contact takes no more iterations than the paper's epsilon."""
    kept = data[data["form"] == "multiplier"]
    exact, paper = (kept[kept["epsilon"] == at].set_index("case")["iterations"] for at in (np.inf, PAPER))
    return int((exact <= paper).sum())


def _paper(data: pd.DataFrame, laws: pd.DataFrame) -> Part:
    """The paper's epsilon on its tyre."""
    known = laws[laws["case"] == "tyre"]
    rows = data[(data["case"] == "tyre") & (data["form"] == "displacement") & (data["epsilon"] == PAPER)]
    if known.empty or rows.empty:
        return Part()
    row = rows.iloc[0]
    return TEXT("paper", **row, over_wall=PAPER / known["wall"].iloc[0], off=abs(row["force_error"]))


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

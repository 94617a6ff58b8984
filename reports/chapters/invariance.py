"""The page of what must not matter: rigid motions by measure, symmetries and units, random cases."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import wrap
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reports.chapter import chapter
from reports.figures.drawing import BLACK, canvas, looks, svg
from reports.formats import NOTHING, code, digits, fixed
from reports.markdown import Part, Template, commands, filled
from reports.store import Store

NOTHING_LEFT = 1e-12  # a strain below this is rounding
SAME = 1e-9  # measures this close all the way share a curve
WIDTH = 63  # letters in a line of a panel's legend, its comma included
ACCIDENT, DESIGN, APART = "broken by accident", "broken by design", "does not apply"
PLATE = {"out": "out of plane", "drilling": "drilling"}  # motions whose strain on a plate is shown as it begins


def _size(value: float) -> str:
    return "0" if abs(value) < NOTHING_LEFT else f"{value:.3g}"


TEXT = Template("invariance", size=_size)


def invariance_page(store: Store) -> Part:
    """The whole page."""
    sweep = store.table("rotation_sweep")
    motions = {**_motions(store), "panel": _panel(store), "turn_miss": _miss(sweep)}
    drawn = _random(store) if store.has("fuzz") else Part()
    turn = {"rigid-body-turn.svg": full_turn(sweep)}
    return TEXT("page", turn, **motions, **_symmetries(store), random=drawn)


def _motions(store: Store) -> dict[str, Any]:
    """What each measure leaves under rigid motions, and how it begins."""
    data, powers = store.table("rigid_body"), store.table("rigid_body_powers")
    plate = powers[powers["surface"] == "plate"].set_index(["measure", "motion"]).to_dict("index")
    rows = []
    for name, own in data.groupby("measure", sort=False):
        begins = {f"plate_{word}": _power(plate.get((name, motion))) for word, motion in PLATE.items()}
        counts = {"told": int(own["declared"].notna().sum()), "cases": len(own), "miss": _miss(own)}
        rows.append({"measure": name, **own.groupby("motion")["largest"].max(), **begins, **counts})
    sizes = {"theta": float(data["theta_rad"].max()), "slide": float(data["slide"].max())}
    return {"motions": rows, "nothing_left": NOTHING_LEFT, **sizes}


def _miss(rows: pd.DataFrame) -> float:
    """The largest distance from a declared law."""
    return float((rows["strain"] - rows["declared"]).abs().max())


def _power(row: dict | None) -> str:
    """How a strain begins over a small angle; a dash where that is not known."""
    if row is None:
        return NOTHING
    rate = float(row["strain_rate"])
    return "0" if np.isnan(rate) else f"{fixed(row['strain_coefficient'], 3)} a^{fixed(rate, 2)}"


def _panel(store: Store) -> Part:
    """What the element adds, as its own rotations one after another show; nothing where they were not made."""
    there = store.rows("rotations", measure="exact", body="free", path="back")
    left = filled("{strain:size} ({interpolation})", there[there["leg"] == 3], size=_size) if len(there) else []
    return TEXT("panel", left=", ".join(left)) if left else Part()


def shared_curves(rows: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """The measures of one case grouped by equal strains: their names and one of their tables."""
    groups: list[tuple[list[str], pd.DataFrame]] = []
    for name, own in rows.groupby("measure", sort=False):
        same = (names for names, first in groups if np.allclose(first["strain"], own["strain"], rtol=0, atol=SAME))
        names = next(same, None)
        if names is None:
            groups.append(([str(name)], own))
        else:
            names.append(str(name))
    for names, own in groups:
        yield ", ".join(names), own


@svg
def full_turn(sweep: pd.DataFrame) -> Figure:
    """Strain over the angle of a rigid rotation, a panel a case; the exact answer is zero."""
    cases, drawn = sweep.groupby(["surface", "motion"], sort=False), looks(sweep["measure"])
    figure, panels = canvas(len(cases), columns=2, width=9.0, height=4.2)
    for axes, ((surface, motion), rows) in zip(panels, cases, strict=True):
        for names, own in shared_curves(rows):
            colour, angle = drawn[own["measure"].iloc[0]].colour, np.degrees(own["theta_rad"])
            label = "\n".join(wrap(names, WIDTH, break_long_words=False, break_on_hyphens=False))
            axes.plot(angle, own["strain"], color=colour, linewidth=3.5, alpha=0.7, label=label)
            axes.plot(angle, own["declared"], color=BLACK, linestyle=":", linewidth=1.2)
        axes.set(title=f"{surface}, {motion}", xlabel="rotation [deg]", ylabel="strain [-]", xlim=(0, 360))
        axes.set_xticks([0, 90, 180, 270, 360])
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=8, frameon=False)
    declared = Line2D([], [], color=BLACK, linestyle=":", linewidth=1.2, label="declared law")
    figure.legend(handles=[declared], loc="outside upper center")
    return figure


def accidents(store: Store) -> tuple[int, int]:
    """How many checks are broken by accident, and of how many."""
    data = store.table("symmetry")
    return int((data["class"] == ACCIDENT).sum()), len(data)


def _symmetries(store: Store) -> dict[str, Any]:
    """A row a check: what is unchanged, and what breaks by design."""
    data = store.table("symmetry")
    broken, checks = accidents(store)
    counts = {"measures": data["measure"].nunique(), "algorithms": data["algorithm"].nunique(), "checks": checks}
    rows = [{"check": check, **_check(own)} for check, own in data.groupby("check", sort=False)]
    return {**counts, "broken": broken, "symmetries": rows, "accidents": data[data["class"] == ACCIDENT]}


def _check(own: pd.DataFrame) -> dict[str, Any]:
    """Counts of a check, its largest deviation, and that of each measure that breaks it by design."""
    kinds = (("design", DESIGN), ("accident", ACCIDENT), ("apart", APART))
    counts = {word: int((own["class"] == kind).sum()) for word, kind in kinds}
    largest = own[own["class"] != DESIGN]["deviation"].max()
    design = own[own["class"] == DESIGN].groupby("measure", sort=False)["deviation"].max()
    deviations = ", ".join(f"{code(name)} {digits(value, 2)}" for name, value in design.items())
    unchanged = len(own) - sum(counts.values())
    return {"cases": len(own), "unchanged": unchanged, **counts, "largest": largest, "deviations": deviations}


def _random(store: Store) -> Part:
    """Requests that nobody has written down, and what they broke."""
    cases = store.table("fuzz")
    alone = cases[cases["verdict"] == "not compared"]["word"]
    refused, solved = int((alone == "refused").sum()), int((alone == "converged").sum())
    reasons = cases[cases["verdict"] == "explained"]["said"].str.split(r"[:,]", regex=True).str[0].value_counts()
    broken = cases[cases["verdict"] == "broken"]
    counts = {
        "cases": len(cases),
        "counts": {name: int((cases["verdict"] == name).sum()) for name in ("agrees", "explained", "broken")},
        "why": f" ({', '.join(f'{count} {reason}' for reason, count in reasons.items())})" if len(reasons) else "",
        **{"alone": len(alone), "refused": refused, "ended": len(alone) - refused - solved, "solved": solved},
    }
    rows = broken.assign(said=broken["said"].str.slice(0, 200))
    return TEXT("random", **counts, broken=rows, commands=commands(broken["command"]))


CHAPTER = chapter(
    TEXT, invariance_page, needs=("rigid_body", "rigid_body_powers", "rotation_sweep", "symmetry"), always=True
)

"""The page of friction: the tyre dragged and turned, its patch, load steps, and the parts of the algorithms."""

from __future__ import annotations

from typing import Any

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.friction.algorithms import SOLVED, algorithms_part, checks_part
from reports.chapters.friction.figures import dragged, path_errors, turned
from reports.chapters.friction.filmstrip import filmstrip
from reports.formats import formatted
from reports.markdown import Part, commands
from reports.store.tables import Store
from reports.template import Template

TYRE = ("friction_dragged", "friction_turned", "friction_patch", "friction_steps")
FITTED = ("friction_drag_ends", "friction_turn_ends", "friction_step_orders", "friction_algorithms", "friction_orders")
OTHERS = ("friction_agreement", "friction_greco", "friction_klarbring")


def _small(value: float) -> str:
    """A difference; what rounding leaves has no digits."""
    return formatted(value, "+.0e") if abs(value) > 1e-10 else "rounding"


TEXT = Template("friction", small=_small)


def friction_page(store: Store) -> Part:
    """The whole page."""
    drag, turn, patch, steps = map(store.table, TYRE)
    drawn = {
        "friction-dragged.svg": dragged(drag),
        "friction-turned.svg": turned(turn),
        "friction-patch.svg": filmstrip(patch),
        "friction-steps.svg": path_errors(steps),
    }
    orders = store.analysis("friction_step_orders").set_index("quantity")["order"]
    named = steps.assign(work=steps["dissipation_N_mm"] / 1e3, billions=steps["operations"] / 1e9)
    coarse = steps.sort_values("steps").iloc[0]
    many = "one step" if coarse["steps"] == 1 else f"{coarse['steps']:g} steps"
    told = {
        "patch": patch.to_dict("records")[0],
        "order": orders,
        "coarse": coarse,
        "coarse_steps": many,
        "steps": named,
    }
    parts = {"algorithms": algorithms_part(store), "checks": checks_part(store)}
    moved = {**_ends(store, drag, turn), **_certified(pd.concat([drag, turn]))}
    return TEXT("page", drawn, title=CHAPTER.title, rules=store.rules(), **moved, **told, **parts)


def _ends(store: Store, drag: pd.DataFrame, turn: pd.DataFrame) -> dict[str, Any]:
    """Force at the end of a drag, torque at that of a turn, and what is dissipated on the way, the press included."""
    pulled, spun = (
        ends.assign(work=ends["mu"].map(moved.groupby("mu")["dissipation_N_mm"].last() / 1e3))
        for ends, moved in ((store.analysis(FITTED[0]), drag), (store.analysis(FITTED[1]), turn))
    )
    return {
        "mesh": pulled["mesh"].iloc[0],
        "dragged_by": pulled["last"].iloc[0],
        "turned_by": spun["last"].iloc[0],
        "dragged": pulled,
        "turned": spun.assign(peak=spun["largest"] / 1e3, torque=spun["value"] / 1e3, limit=spun["bound"] / 1e3),
        "commands": commands([*pulled["command"], *spun["command"]]),
    }


def _certified(moved: pd.DataFrame) -> dict[str, Any]:
    """Loads of the drags and turns that are not certified, or where the path has ended."""
    odd = moved[moved["failures"].notna() | (moved["outcome"] != SOLVED[0])]
    all_are = f"All {len(moved)} loads of these paths converged and are certified by the judge."
    return {"odd": odd, "certified": all_are if odd.empty else ""}


CHAPTER = Chapter(
    "friction",
    "Friction",
    "the tyre dragged and turned, stick and slip, what load steps change, and which algorithm to use.",
    friction_page,
    needs=(*TYRE, *FITTED, *OTHERS),
)

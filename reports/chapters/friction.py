"""The page of friction: the tyre dragged and turned, load steps, and how the algorithms agree and what they cost."""

from __future__ import annotations

import re
from typing import Any

import pandas as pd

from reports.chapter import chapter
from reports.figures.friction import dragged, filmstrip, path_errors, turned
from reports.formats import NOTHING, code, formatted, scientific, share
from reports.markdown import Part, Template, by_name, commands, machine, table
from reports.store import Store

TYRE = ("friction_dragged", "friction_turned", "friction_patch", "friction_steps")
FITTED = ("friction_drag_ends", "friction_turn_ends", "friction_step_orders", "friction_algorithms", "friction_orders")
OTHERS = ("friction_agreement", "friction_greco", "friction_klarbring")
FIRST, SOLVED = "semismooth", ("converged", "unstable")


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
    orders = store.table("friction_step_orders").set_index("quantity")["order"]
    named = steps.assign(work=steps["dissipation_N_mm"] / 1e3, billions=steps["operations"] / 1e9)
    coarse = steps.sort_values("steps").iloc[0]
    many = "one step" if coarse["steps"] == 1 else f"{coarse['steps']:g} steps"
    values = {
        "patch": patch.to_dict("records")[0],
        "order": orders,
        "coarse": coarse,
        "coarse_steps": many,
        "steps": named,
    }
    parts = {"algorithms": algorithms_part(store), "checks": checks_part(store)}
    moved = {**_ends(store, drag, turn), **_certified(pd.concat([drag, turn]))}
    return TEXT("page", drawn, rules=store.rules(), **moved, **values, **parts)


def _ends(store: Store, drag: pd.DataFrame, turn: pd.DataFrame) -> dict[str, Any]:
    """Force at the end of a drag, torque at that of a turn, and what is dissipated on the way, the press included."""
    pulled, spun = (
        ends.assign(work=ends["mu"].map(moved.groupby("mu")["dissipation_N_mm"].last() / 1e3))
        for ends, moved in ((store.table(FITTED[0]), drag), (store.table(FITTED[1]), turn))
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


def algorithms_part(store: Store) -> Part:
    """Whether they agree, and what they cost."""
    data, summary = store.table("friction_agreement"), store.table("friction_algorithms")
    names = [name for name in summary["algorithm"] if name != FIRST]
    first = data[data["algorithm"] == FIRST].set_index("case")["substeps"]
    groups = data.assign(usual=data["case"].map(first)).groupby("case", sort=False)
    rows = by_name((((case, first[case]), own) for case, own in groups), names, _cell, "algorithm")
    heads = ["scene", "load steps", *map(code, names)]
    cases = table(f"Against `{FIRST}`, at all loads", heads, rows, words=len(heads))
    odd = data[~data["outcome"].isin(SOLVED)]
    odd = odd.assign(reason=odd["reason"].map(_short))
    return TEXT("algorithms", scenes=data["case"].nunique(), summary=summary, cases=cases, odd=odd, lost=len(odd))


def _short(reason: object) -> str:
    """The first clause of a reason."""
    return re.split(r"; | \(", str(reason))[0]


def _cell(row: dict) -> str:
    """What became of a scene; usual: the load steps of the first algorithm."""
    if row["outcome"] not in SOLVED:
        return str(row["outcome"])
    if row["agrees"]:
        return "same"
    parts = [scientific(row["force_error"]), f"{row['states']} states" if row["states"] else ""]
    parts.append(f"{row['substeps']} steps" if row["substeps"] != row["usual"] else "")
    return ", ".join(filter(None, parts))


def checks_part(store: Store) -> Part:
    """Closed forms and orders, and problems that separate the algorithms."""
    data = store.table("friction_orders").assign(size=lambda rows: rows["error"].abs())
    families = data.groupby(["family", "theory"], sort=False).agg(
        errors=("error", "size"), worst=("size", "max"), low=("order", "min"), high=("order", "max")
    )
    return TEXT("checks", families=families.reset_index(), rules=store.rules(), **_separating(store))


def _separating(store: Store) -> dict[str, Part | str]:
    """A row an algorithm: a plate, springs with none, one or several answers, and public problems."""
    greco, springs = store.table("friction_greco"), store.table("friction_klarbring")
    bound, public = store.rules()["friction_greco"], store.has("friction_public")
    files = store.table("friction_public").dropna(subset=["algorithm"]) if public else pd.DataFrame({"algorithm": []})
    finest = greco[greco["elements"] == greco["elements"].max()]
    names = dict.fromkeys([*finest["algorithm"], *springs["algorithm"], *files["algorithm"]])
    rows = [
        [code(name), _plate(finest, name, bound), *_found(springs, name), *(_public(files, name) if public else ())]
        for name in names
    ]
    heads = ["algorithm", "GRECO plate", "one answer: solved", "several: one solved", "none: claimed", "claims wrong"]
    heads += ["public: certified", "public: refused by the judge"] if public else []
    shown = table("Problems that separate the algorithms", heads, rows)
    if not public:
        return {"public": "", "separating": shown}
    contacts = files["contacts"]
    sentence = TEXT("public", problems=files["problem"].nunique(), fewest=contacts.min(), most=contacts.max())
    return {"public": sentence, "separating": machine(shown)}


def _plate(finest: pd.DataFrame, name: str, bound: float) -> str:
    own = finest[finest["algorithm"] == name]
    if own.empty:
        return NOTHING
    row = own.iloc[0]
    if row["outcome"] not in SOLVED:
        return str(row["outcome"])
    return f"{'within' if row['error'] <= bound else 'failed'}, {share(row['error'], 3)}"


def _found(springs: pd.DataFrame, name: str) -> list[str]:
    own = springs[springs["algorithm"] == name]
    if own.empty:
        return [NOTHING] * 4
    claimed, wrong = own["outcome"].isin(SOLVED), own["found"] == "wrong"
    right = claimed & own["found"].notna() & ~wrong
    kinds = (own["answers"] == 1, own["answers"] > 1)
    none = own["answers"] == 0
    counts = [f"{int(right[kind].sum())} of {int(kind.sum())}" for kind in kinds]
    return [*counts, f"{int(claimed[none].sum())} of {int(none.sum())}", str(int(wrong.sum()))]


def _public(files: pd.DataFrame, name: str) -> list[str]:
    own = files[files["algorithm"] == name]
    if own.empty:
        return [NOTHING] * 2
    judged = own["certified"].map({True: 1.0, False: 0.0}).astype(float)
    claimed = own["outcome"].isin(SOLVED)
    taken, refused = claimed & (judged == 1), claimed & (judged == 0)
    if claimed.any() and not (taken | refused).any():
        return [f"not judged, {int(claimed.sum())} claimed", NOTHING]
    return [f"{int(taken.sum())} of {len(own)}", str(int(refused.sum()))]


CHAPTER = chapter(TEXT, friction_page, needs=(*TYRE, *FITTED, *OTHERS))

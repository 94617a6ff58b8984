"""Section of the page of convergence: which share of the thickness strain is sampled at the nodes, over all scenes."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from reports.formats import NOTHING, fixed, percent, share
from reports.formats import quantity as words
from reports.markdown import Part, commands, folded, joined, prose, table
from reports.store.tables import Store

SHARES = ("projected", "balanced", "nodal")  # none, half, all


def thickness_share_part(store: Store) -> Part:
    """What the table says, and the table."""
    found, rule = store.analysis("thickness_share"), store.rules()
    text = prose(f"""### Which share of the thickness strain

The default element with none (`projected`, as in the paper), half (`balanced`) or all (`nodal`) of the thickness strain
taken from the nodes, as far as each scene goes: on its default mesh, and on half of that each way. Errors are relative
to the limit of the scene's [meshes](#orders-and-limits), or, where they have none, to its reference; a dash: that load
was not reached. *Best* is a share that no other one beats by more than {share(rule["equal"], 1)}, or than the limit is
uncertain by. A limit point is confirmed where the default mesh comes no farther than {share(rule["farther"], 0)} beyond
it, or passes as many.

{said(found)}

What is taken from the nodes makes an element softer, and on a mesh that is too stiff for other reasons softness looks
like accuracy. With all of it a strip that turns by φ bends like φ - φ³/6: folds end at limit points of the element.""")
    header = ["scene", "quantity", "mesh", "best", "ends at a limit point", *SHARES, "iterations"]
    listed = table("Errors by the share", header, _rows(found), words=5)
    return joined(text, folded("All scenes by the share", listed), commands(found["command"]))


def said(found: pd.DataFrame) -> str:
    """In how many scenes each share is best on each mesh, and in which of them its path ends at limit points."""
    coarse = found["coarse"].astype(bool)
    halves = {"half of the default mesh": found[coarse], "the default mesh": found[~coarse]}
    wrong, last = found[found["confirmed"].eq(False)], found[~coarse & found["turns_at"].notna()]
    return " ".join(
        [
            *(_counts(words, own) for words, own in halves.items()),
            f"Limit points that the default mesh does not confirm: {_scenes(wrong)}.",
            f"That mesh itself ends at one: {_scenes(last)}.",
        ]
    )


def _counts(words: str, own: pd.DataFrame) -> str:
    """In how many scenes all shares are equal, and in how many others each is among the best, and alone."""
    near = own["nearest"].astype(bool)
    best = [set(each.loc[near, "share"]) for _, each in own.groupby("ladder")]
    others = [names for names in best if names != set(SHARES)]
    among = {name: sum(name in names for names in others) for name in SHARES}
    alone = {name: sum(names == {name} for names in others) for name in SHARES}
    told = ", ".join(f"`{name}` in {among[name]} ({alone[name]} alone)" for name in SHARES)
    return f"On {words} all are equal in {len(best) - len(others)} of {len(best)} scenes; best in others: {told}."


def _scenes(own: pd.DataFrame) -> str:
    """Of each share."""
    scenes = ((name, ", ".join(own.loc[own["share"] == name, "ladder"])) for name in SHARES)
    return "; ".join(f"`{name}` in {ladders or 'none'}" for name, ladders in scenes)


def _rows(found: pd.DataFrame) -> Iterator[list[str]]:
    """A line a scene and mesh, the coarser mesh first."""
    for (ladder, quantity), both in found.groupby(["ladder", "quantity"], sort=False):
        for mesh in reversed(list(dict.fromkeys(both["mesh"]))):
            own = both[both["mesh"] == mesh].set_index("share").reindex(list(SHARES))
            near = own.index[own["nearest"].eq(True)]
            best = "equal" if len(near) == len(SHARES) else ", ".join(near) or NOTHING
            ends = [_end(*pair) for pair in zip(own["turns_at"], own["confirmed"], strict=True)]
            shown = NOTHING if set(ends) == {NOTHING} else " / ".join(ends)
            counted = " / ".join(map(fixed, own["iterations"]))
            yield [str(ladder), words(str(quantity)), mesh, best, shown, *map(percent, own["error"]), counted]


def _end(end: float, confirmed: object) -> str:
    """Where a path ends, and what the finer mesh says of that."""
    if math.isnan(end):
        return NOTHING
    return f"{end:.3g} (not confirmed)" if confirmed is False else f"{end:.3g}"

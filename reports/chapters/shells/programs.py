"""Part of the page of benchmarks: the same scenes solved by other programs from our decks, without an edit."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import Any

import pandas as pd

from reports.formats import fixed, percent
from reports.markdown import Part, commands, joined, listing, machine, prose
from reports.store.tables import Store

HEADING = "## In other programs"
COMMAND = "footprint bench programs --store .footprint/store"
OTHERS = {"ngsolve": "NGSolve", "kratos": "Kratos"}
MESH, PLIES = "mesh", "plies"  # reasons, as the table has them


def programs_part(store: Store) -> Part:
    """Scenes in other programs; it takes those programs, so no campaign runs them by itself."""
    if not (store.has_table("programs") and store.has_analysis("program_agreement")):
        return joined(HEADING, machine(f"Not run here; `{COMMAND}` does, with CalculiX."))
    every, finest = store.table("programs"), store.analysis("program_agreement")
    text = prose("""A scene is written as a deck of quadratic bricks between the faces of the shell (`footprint export`)
and run as it is; what comes back is read as the scene reads its own. *Off* is its value over ours, less one, *rate* the
exponent at which that falls with the size of the bricks from the coarser mesh. Where *same rule* is given, our own
solid of 27-node bricks was solved on the same mesh with one direction of plies in every brick, as a deck has them, and
the column is the program's value over that, less one. NGSolve and Kratos are those of
[the costs](cost.md#beside-other-programs): no decks of ours, loads and meshes of their own, each over our finest value
there. Seconds are wall time of the program.""")
    heads = "scene | program | mesh | quantity | load | theirs | ours | off | reason"
    line = "{case} | {program} | {mesh} | {quantity} | {load:.4g} | {theirs:.5g} | {ours:.5g} | "
    best = listing("Finest meshes", finest, heads, f"{line}{{difference:+.2%}} | {{reason:said}}", words=4, said=_said)
    heads = "scene | measure | quantity | load | ours | on | reference | " + " | ".join(OTHERS.values())
    line = "{case} | `{measure}` | {quantity} | {load:.4g} | {ours:.5g} | {our_mesh} | {reference:.5g} | "
    line += " | ".join(f"{{{name}:+.2%}}" for name in OTHERS)
    known = finest[finest[["reference", *OTHERS]].notna().any(axis=1)]
    beside = listing("Beside references and programs without a deck of ours", known, heads, line, words=3)
    heads = "scene | element | mesh | bricks | quantity | load | off | rate | same rule | seconds"
    line = "{case} | {elements} | {mesh} | {bricks:.0f} | {quantity} | {load:.4g} | {difference:+.2%} | {rate:.1f} | "
    line += "{held_difference:+.2%} | {seconds:.1f}"
    meshes = listing("All meshes", every, heads, line, words=5)
    return joined(HEADING, machine(" ".join(sentences(finest)), text, best, beside, meshes, commands([COMMAND])))


def sentences(finest: pd.DataFrame) -> list[str]:
    """On how many scenes and quantities each program agrees, and what does not, with the reason."""
    said = []
    for (program, version), own in finest.groupby(["program", "version"], sort=False):
        near = own[own["within"]]
        said.append(
            f"{program} ({version}) runs {own['case'].nunique()} scenes from our decks; on the finest mesh of each, "
            f"{len(near)} of {len(own)} values (scenes: {near['case'].nunique()}) are within 1 % of ours."
        )
        said += [_beyond(row) for row in own[~own["within"]].to_dict("records")]
    return said


def _beyond(row: Mapping[Hashable, Any]) -> str:
    told = f"{row['quantity']} of {row['case']} is {percent(row['difference'])} off"
    if row["reason"] == PLIES:
        rule = "a deck has one direction of plies a brick, and our own solid under that rule is"
        return f"{told}: {rule} {percent(row['held_difference'])} from it on the same mesh."
    if row["reason"] == MESH:
        return f"{told}, and falls with the mesh at the rate {fixed(row['rate'], 1)}."
    return f"{told}, without a reason found."


def _said(value: object) -> str:
    return {MESH: "mesh", PLIES: "one direction of plies a brick", "open": "open"}.get(str(value), "–")

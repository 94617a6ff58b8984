"""What became of the cells that a campaign has planned: counted by class, and why some were not solved."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

from reports.formats import digits
from reports.markdown import Part, joined, listing, machine, prose, table
from reports.store.cells import CLASSES, Cell
from reports.store.tables import Store

WORDS = {  # of each class, for people
    "converged": "and the judge agrees",
    "unstable": "converged, and the judge agrees, to an equilibrium with negative eigenvalues of the tangent",
    "wrong": "said to have converged, and the judge does not agree",
    "not-converged": "the iteration, or the path, came to an end before the load",
    "cap-hit": "a limit of iterations was reached",
    "time": "killed at the time limit",
    "memory": "more than the memory limit",
    "crash": "the process died",
    "unsupported": "refused, with a reason",
    "missing": "not solved yet",
}
SOLVED = ("converged", "unstable", "wrong", "not-converged", "cap-hit")


def completeness_line(store: Store) -> str:
    """How much of the campaign is there, in one line."""
    counts = Counter(each.ended for each in store.planned)
    told = ", ".join(f"{counts[name]} {name}" for name in CLASSES if counts[name])
    return f"{store.campaign}: {len(store.planned)} cells planned: {told or 'none'}"


def completeness(store: Store) -> Part:
    """Cells planned by scene and class, and what could not be solved."""
    present = [name for name in CLASSES if any(each.ended == name for each in store.planned)]
    scenes = dict.fromkeys(each.scene for each in store.planned)
    rows = [[scene, *_counts((e for e in store.planned if e.scene == scene), present)] for scene in scenes]
    rows.append(["all", *_counts(store.planned, present)])
    parts = [table(f"Cells of the campaign {store.campaign}", ["scene", "planned", *present], rows)]
    parts.append(prose("; ".join(f"*{name}*: {WORDS[name]}" for name in present) + "."))
    unsolved = [each for each in store.planned if each.ended not in (*SOLVED, "unsupported")]
    if unsolved:
        told = "cell | class | reason", "{label} | {ended} | {reason}"
        parts.append(machine(listing("Cells without a result", unsolved, *told, words=3)))
    return joined(*parts)


def refusals(store: Store) -> str:
    """The reasons of unsupported cells, one row for all that share it."""
    found = Counter((each.scene, each.reason) for each in store.planned if each.ended == "unsupported")
    if not found:
        return "Every cell that was planned makes sense."
    rows = ([scene, reason, count] for (scene, reason), count in found.items())
    return table("Why cells were not solved", ["scene", "reason", "cells"], rows, words=2)


def _counts(planned: Iterable[Cell], present: list[str]) -> list[int]:
    counts = Counter(each.ended for each in planned)
    return [counts.total(), *(counts[name] for name in present)]


def origin(store: Store) -> str:
    """Where the numbers of the whole campaign were made: commits, versions, machines and time; not compared."""
    results = {each.directory: each.result for each in store.planned if each.result}.values()
    made = [result["provenance"] for result in results if result["provenance"]]
    times = [result["timing_s"] for result in results]
    spent = {name: sum(each.get(name, 0.0) for each in times) for name in ("cpu", "total")}
    packages = (f"{name} {version}" for each in made for name, version in each["packages"].items())
    machines = (", ".join(f"{key} {value}" for key, value in each["machine"].items()) for each in made)
    told = {
        "footprint": _counted(each["version"] for each in made),
        "commit": _counted(_commit(each) for each in made),
        "packages": ", ".join(dict.fromkeys(packages)),
        "machine": _counted(machines),
        "time on the clock, processor time of all cells [s]": f"{digits(spent['total'], 3)}, {digits(spent['cpu'], 3)}",
    }
    return "## Machine\n\n" + machine(table("Where the numbers were made", ["", ""], told.items(), words=2))


def _commit(made: Mapping[str, Any]) -> str:
    """The commit, and whether the files were others than those of it; a record of old does not say."""
    return f"{made['commit']}{' (modified)' if made.get('modified') else ''}"


def _counted(names: Iterable[str]) -> str:
    """Each name with the number of cells it stands for."""
    return "; ".join(f"{name}: {count} cells" for name, count in Counter(names).items())

"""Where the numbers of a campaign come from, and what became of its cells: counts, commits, versions, machines, time.

The one maker of these counts: the foot of every page and the tables of origins and of completeness count alike, a cell
of the plan as one, also where two of them ask for the same and share a record. What is told of machines and times is
not compared between two versions of a page.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

from reports.formats import digits
from reports.markdown import Part, Template, by_name, joined, machine, table
from reports.store import CLASSES, Cell, Store

TEXT = Template("origin")
SHOWN = 12  # digits of a commit
MINUTE = len("2026-01-01T00:00")  # of a date as a record has it
AXES = {"contact": "contact algorithm", "measure": "strain measure"}
WORDS = {  # of each class, for people
    "converged": "accepted by the judge",
    "unstable": "accepted by the judge; the tangent has negative eigenvalues",
    "wrong": "reported as converged, but refused by the judge",
    "not-converged": "the iteration, or the path, stopped before the load",
    "cap-hit": "a limit of iterations was reached",
    "time": "stopped at the time limit",
    "memory": "exceeded the memory limit",
    "crash": "the process died",
    "unsupported": "refused, with a reason",
    "missing": "not solved yet",
}
SOLVED = ("converged", "unstable", "wrong", "not-converged", "cap-hit")


def counted(planned: Iterable[Cell]) -> dict[str, int]:
    """Cells by class, the classes in their order."""
    counts = Counter(each.ended for each in planned)
    return {name: counts[name] for name in CLASSES if counts[name]}


def completeness_line(store: Store) -> str:
    """How much of the campaign is there, in one line."""
    counts = ", ".join(f"{count} {name}" for name, count in counted(store.planned).items())
    return f"{store.campaign}: " + (f"{len(store.planned)} cells planned: {counts}" if counts else "tables alone")


def foot(store: Store) -> str:
    """What stands at the end of every page of the campaign."""
    made = _made(store)
    sentences = [
        completeness_line(store),
        f"footprint {_each(each['version'] for each in made)}, commit {_each(_commit(each, SHOWN) for each in made)}",
        f"solved {_between(each['date'] for each in made if 'date' in each)}",
        _each(_machine(each["machine"]) for each in made),
        f"BLAS {_each(_blas(each['blas']) for each in made if 'blas' in each)}",
        ", ".join(_packages(made)),
    ]
    return machine(f"*{'; '.join(sentences)}.*") if made else machine(f"*{sentences[0]}.*")


def origin(store: Store) -> str:
    """The section on the machine: where all numbers of the campaign were made."""
    made = _made(store)
    times = [result["timing_s"] for result in {each.directory: each.result for each in _solved(store)}.values()]
    spent = {name: sum(each.get(name, 0.0) for each in times) for name in ("cpu", "total")}
    facts = {
        "footprint": _each((each["version"] for each in made), always=True),
        "commit": _each((_commit(each) for each in made), always=True),
        "solved": _between(each["date"] for each in made if "date" in each),
        "packages": ", ".join(_packages(made)),
        "BLAS": _each(_blas(each["blas"]) for each in made if "blas" in each),
        "machine": _each((_machine(each["machine"]) for each in made), always=True),
        "time on the clock, processor time of all cells [s]": f"{digits(spent['total'], 3)}, {digits(spent['cpu'], 3)}",
    }
    return "## Machine\n\n" + machine(table("Where the numbers were made", ["what", "is"], facts.items(), words=2))


def machines(store: Store) -> Part:
    """Whose machine the cells are from, where they are from several: how far merged ones were verified, whose times."""
    if not store.has("machines"):
        return Part()
    table = store.table("machines")
    if len(table) < 2 and (table["seconds"] > 0).all():
        return Part()
    return TEXT("machines", rows=table)


def _solved(store: Store) -> list[Cell]:
    return [each for each in store.planned if each.result]


def _made(store: Store) -> list[Mapping[str, Any]]:
    """What each cell with a record tells of its origin."""
    return [provenance for each in _solved(store) if (provenance := each.result["provenance"])]


def _commit(made: Mapping[str, Any], shown: int | None = None) -> str:
    """The commit, and whether the files were others than those of it; a record of old does not say."""
    return f"{made['commit'][:shown]}{' (modified)' if made.get('modified') else ''}"


def _machine(provenance: Mapping[str, Any]) -> str:
    """Processor, cores, memory, system and Python, as far as a record has them."""
    names = (("cpu", "{}"), ("cores", "{} cores"), ("memory_GiB", "{} GiB"), ("system", "{}"), ("processor", "{}"))
    return ", ".join(
        form.format(provenance[name]) for name, form in (*names, ("python", "Python {}")) if provenance.get(name)
    )


def _blas(provenance: Mapping[str, str]) -> str:
    """Of each package that brings one, and on how many threads."""
    brought = ", ".join(f"{version} ({name})" for name, version in provenance.items() if name != "threads")
    return f"{brought}, threads: {provenance['threads']}"


def _packages(made: Iterable[Mapping[str, Any]]) -> list[str]:
    """All that any cell was solved with; a package in two versions has two entries."""
    versions = (f"{name} {version}" for each in made for name, version in each["packages"].items() if version)
    return list(dict.fromkeys(versions))


def _between(dates: Iterable[str]) -> str:
    """The first and the last minute, in UTC."""
    minutes = sorted(date[:MINUTE].replace("T", " ") for date in dates)
    return " to ".join(dict.fromkeys((minutes[0], minutes[-1]))) + " UTC" if minutes else "at a time that is not kept"


def _each(names: Iterable[str], *, always: bool = False) -> str:
    """Each name with the number of cells it stands for; one alone without, unless ``always``."""
    counts = Counter(names)
    alone = len(counts) == 1 and not always
    return "; ".join(name if alone else f"{name}: {count} cells" for name, count in counts.items()) or "not kept"


def outcomes_part(store: Store) -> Part:
    """The whole part."""
    matrices = [_matrix(store, axis) for axis in AXES] if store.has("outcomes") else []
    parts = {"completeness": completeness(store), "refusals": refusals(store)}
    return TEXT("part", summary=summary_table(store), matrices=joined(*matrices), **parts)


def summary_table(store: Store) -> Part:
    """What each algorithm solves and refuses, and its time over that of the default where both solve."""
    data = store.rows("contact_summary")
    return TEXT("summary", rows=data.assign(put=data["solved"] + data["failed"]) if len(data) else [])


def _matrix(store: Store, axis: str) -> Part:
    """Scene by competitor: solved of those that could be."""
    data = store.rows("outcomes", axis=axis)
    whole, own = data[data["scene"] == ""], data[data["scene"] != ""]
    if own.empty:
        return Part()
    names = list(dict.fromkeys(whole["name"]))
    groups = [*((str(scene), each) for scene, each in own.groupby("scene", sort=False)), ("all", whole)]
    rows = by_name((((scene,), each) for scene, each in groups), names, _entry)
    grid = table("Solved of those that could be solved; r: refused, e: the path ends", ["scene", *names], rows)
    return TEXT("matrix", axis=AXES[axis], grid=grid, lost=own[own["cause"] != ""])


def _entry(row: dict) -> str:
    marks = [f"{int(row[key])} {mark}" for key, mark in (("refused", "r"), ("path_ends", "e")) if row[key]]
    return f"{int(row['solved'])}/{int(row['solved'] + row['failed'])}" + (f" ({', '.join(marks)})" if marks else "")


def completeness(store: Store) -> Part:
    """Cells planned by scene and class, and what could not be solved."""
    present = list(counted(store.planned))
    scenes = dict.fromkeys(each.scene for each in store.planned)
    rows = [[scene, *_counts((e for e in store.planned if e.scene == scene), present)] for scene in scenes]
    rows.append(["all", *_counts(store.planned, present)])
    cells = table(f"Cells of the campaign {store.campaign}", ["scene", "planned", *present], rows)
    words = "; ".join(f"*{name}*: {WORDS[name]}" for name in present)
    unsolved = [each for each in store.planned if each.ended not in (*SOLVED, "unsupported")]
    return TEXT("completeness", cells=cells, words=words, unsolved=unsolved)


def _counts(planned: Iterable[Cell], present: list[str]) -> list[int]:
    counts = counted(planned)
    return [sum(counts.values()), *(counts.get(name, 0) for name in present)]


def refusals(store: Store) -> Part:
    """The reasons of unsupported cells, one row for all that share it."""
    reasons = Counter((each.scene, each.reason) for each in store.planned if each.ended == "unsupported")
    rows = [{"scene": scene, "reason": reason, "count": count} for (scene, reason), count in reasons.items()]
    return TEXT("refusals", rows=rows) if rows else Part("Every cell that was planned makes sense.")

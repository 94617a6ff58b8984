"""The page of algorithms: what each of them costs on the same cases, in iterations, factorisations and time."""

from __future__ import annotations

from reports.chapter import Chapter
from reports.chapters.contact.agreement_cases import Entry, entries
from reports.chapters.contact.robustness import robustness
from reports.chapters.tyre import figures as figures_tyre
from reports.markdown import Part, commands, fixed, joined, machine, percent, picture, prose, table
from reports.tables import Store

COUNTERS = ("newton_iterations", "factorisations", "assemblies", "set_changes")
PARTS = ("assembly", "factorisation", "solve", "contact")
NAME = "contact-iterations.svg"


def algorithms_page(store: Store) -> Part:
    """The whole page."""
    found = list(entries(store))
    solved = [entry for entry in found if not entry.cell.unsupported]
    refused = [entry for entry in found if entry.cell.unsupported]
    names = ", ".join(dict.fromkeys(f"`{entry.contact}`" for entry in found))
    introduction = prose(f"""# What the contact algorithms cost

{names}: every algorithm of the catalogue on the four cases of [the agreement](contact-agreement.md), inflation and
{len(found[0].travels)} travels of the plane. A *Newton iteration* is a linearised problem with a change of the
displacements; a *set change* is one at which at least one node entered or left. What is not asked of an algorithm is
listed with its reason, not left out.""")
    parts = [Part(introduction), _counters(solved), _times(solved), _histories(solved)]
    if refused:
        rows = [[entry.way, *entry.case, str(entry.cell.result["reason"])] for entry in refused]
        parts.append(Part(table("Refused", ["algorithm", "load", "section", "reason"], rows, words=4)))
    return joined([*parts, Part(commands(entry.cell.command for entry in found)), robustness(store)])


def _counters(solved: list[Entry]) -> Part:
    """Counters; those of a path with a rejected step are the machine's."""
    header = ["algorithm", "load", "section", "outcome", *(name.replace("_", " ") for name in COUNTERS)]
    rows = {entry: _counter_row(entry) for entry in solved}
    steady = table(
        "Counters over the whole path", header, [row for e, row in rows.items() if not e.cell.cuts()], words=4
    )
    cut = [row for entry, row in rows.items() if entry.cell.cuts()]
    text = prose("""## Iterations

How far an iteration gets is a matter of the algorithm: one that solves a whole complementarity problem in each counts
one for it, one that guesses a set counts every guess.""")
    blocks = [text, steady]
    if cut:
        blocks.append(machine(table("Counters of paths with a rejected step", header, cut, words=4)))
    return Part("\n\n".join(blocks))


def _counter_row(entry: Entry) -> list[str]:
    counters = entry.cell.result["counters"]
    numbers = [fixed(counters.get(name), 0) for name in COUNTERS]
    return [entry.way, *entry.case, str(entry.cell.result["outcome"]), *numbers]


def _times(solved: list[Entry]) -> Part:
    """Wall times and where they go."""
    rows = []
    for entry in solved:
        times = entry.cell.result["timing_s"]
        total = float(times["total"])
        shares = [percent(float(times.get(name, 0.0)) / total, 0, False) for name in PARTS]
        rows.append([entry.way, *entry.case, fixed(total, 2), *shares])
    header = ["algorithm", "load", "section", "total [s]", *PARTS]
    body = machine(table("Wall time of the whole path, and its parts", header, rows, words=3))
    text = prose("""## Times

One run each. *Assembly* is the shell, *factorisation* and *solve* the sparse linear algebra, *contact* what an
algorithm does with sets, gaps and multipliers; the rest is the building of the model and the judge.""")
    return Part(f"{text}\n\n{body}")


def _histories(solved: list[Entry]) -> Part:
    """Residuals and sets of the first case, the exact condition."""
    exact = [entry for entry in solved if entry.exact]
    first = [entry for entry in exact if entry.case == exact[0].case and entry.as_it_is]
    histories = {entry.contact: entry.cell.table("history") for entry in first}
    load, section = exact[0].case
    text = prose(f"""## Iteration histories

The {load} load with the section `{section}` and the exact condition, inflation and all travels one after the other.

{picture(NAME, "Residual and contact set over the residual evaluations of the algorithms")}""")
    return Part(text, {NAME: figures_tyre.iterations(histories)})


CHAPTER = Chapter(
    "algorithms",
    "Contact: costs",
    'their iterations, factorisations and times, where they cycle, which says "solved" and is wrong.',
    algorithms_page,
    needs=("cycles", "false_success"),
    always=True,
)

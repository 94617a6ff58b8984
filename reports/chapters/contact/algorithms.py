"""The page of algorithms: what each of them costs on the same cases, in iterations, factorisations and time."""

from __future__ import annotations

from reports.chapter import Chapter
from reports.chapters.contact.agreement_cases import CASE, OF_CASE, Entry, entries, refusals
from reports.chapters.contact.robustness import robustness
from reports.chapters.tyre.figures import iterations
from reports.formats import fixed, share
from reports.markdown import Part, commands, fold, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

COUNTERS = ("newton_iterations", "factorisations", "assemblies", "set_changes")
PARTS = ("assembly", "factorisation", "solve", "contact")


def algorithms_page(store: Store) -> Part:
    """The whole page."""
    found = list(entries(store))
    solved = [entry for entry in found if not entry.cell.unsupported]
    refused = [entry for entry in found if entry.cell.unsupported]
    names = ", ".join(dict.fromkeys(f"`{entry.contact}`" for entry in found))
    introduction = prose(f"""# Costs of the algorithms

{names}: every algorithm of the catalogue on the four cases of [the agreement](contact-agreement.md), inflation and
{len(found[0].travels)} travels of the plane. A *Newton iteration* is a linearised problem with a change of the
displacements; a *set change* is one at which at least one node entered or left. What is not asked of an algorithm is
listed with its reason, not left out.""")
    return joined(
        introduction,
        _counters(solved),
        _times(solved),
        _histories(solved),
        refusals(refused) if refused else "",
        commands(entry.cell.command for entry in found),
        robustness(store),
    )


def _counters(solved: list[Entry]) -> Part:
    """Counters; those of a path with a rejected step are the machine's."""
    heads = " | ".join([CASE, "outcome", *(name.replace("_", " ") for name in COUNTERS)])
    line = " | ".join(
        [OF_CASE, "{cell.result[outcome]}", *(f"{{cell.result[counters][{name}]:.0f}}" for name in COUNTERS)]
    )
    steady, cut = ([entry for entry in solved if bool(entry.cell.cuts) is rejected] for rejected in (False, True))
    text = prose("""## Iterations

How far an iteration gets is a matter of the algorithm: one that solves a whole complementarity problem in each counts
one for it, one that guesses a set counts every guess.""")
    first = [entry for entry in steady if entry.case == steady[0].case]
    blocks: list[Part | str] = [
        text,
        listing(f"Counters, {' load, '.join(steady[0].case)}", first, heads, line, words=4),
    ]
    every = [listing("Counters over the whole path", steady, heads, line, words=4)]
    if cut:
        every.append(machine(listing("Counters of paths with a rejected step", cut, heads, line, words=4)))
    return joined(*blocks, fold("Counters of all loads and sections", *every))


def _times(solved: list[Entry]) -> Part:
    """Wall times and where they go."""
    rows = []
    for entry in solved:
        times = entry.cell.result["timing_s"]
        if "total" not in times:  # merged: of another machine
            continue
        total = float(times["total"])
        shares = [share(float(times.get(name, 0.0)) / total, 0) for name in PARTS]
        rows.append([entry.way, *entry.case, fixed(total, 2), *shares])
    header = ["algorithm", "load", "section", "total [s]", *PARTS]
    first = solved[0].case
    shown = [row for row in rows if tuple(row[1:3]) == first]
    body = machine(table(f"Wall time of the whole path and its parts, {' load, '.join(first)}", header, shown, words=3))
    every = machine(table("Wall time of the whole path, and its parts", header, rows, words=3))
    text = prose("""## Times

One run each. *Assembly* is the shell, *factorisation* and *solve* the sparse linear algebra, *contact* what an
algorithm does with sets, gaps and multipliers; the rest is the building of the model and the judge.""")
    return joined(text, body, fold("Wall times of all loads and sections", every))


def _histories(solved: list[Entry]) -> Part:
    """Residuals and sets of the first case, the exact condition."""
    exact = [entry for entry in solved if entry.exact]
    first = [entry for entry in exact if entry.case == exact[0].case and not entry.own]
    histories = {entry.contact: entry.cell.table("history") for entry in first}
    load, section = exact[0].case
    travels = first[0].travels
    reached = f", to {max(travels):g} mm," if travels else ""
    text = prose(f"""## Iterations of one step

The last step of the path{reached} under the {load} load with the section
`{section}` and the exact condition, a panel an algorithm.""")
    words = "Residual over the iterations of the last step, with the nodes in contact"
    return joined(text, picture("contact-iterations.svg", words, iterations(histories)))


CHAPTER = Chapter(
    "algorithms",
    "Costs of the algorithms",
    'their iterations, factorisations and times, where they cycle, which says "solved" and is wrong.',
    algorithms_page,
    needs=("cycles", "false_success"),
    always=True,
)

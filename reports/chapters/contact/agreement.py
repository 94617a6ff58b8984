"""The page of agreement: do all contact algorithms give the same set and the same force, whatever the case?"""

from __future__ import annotations

from reports.chapter import Chapter
from reports.chapters.contact import figures as figures_contact
from reports.chapters.contact.agreement_cases import SAME, Entry, entries
from reports.markdown import NOTHING, Part, commands, digits, fixed, joined, machine, picture, prose, scientific, table
from reports.tables import Store

NAME = "contact-forces.svg"


def agreement_page(store: Store) -> Part:
    """The whole page."""
    found = list(entries(store))
    exact = [entry for entry in found if entry.exact and not entry.cell.unsupported]
    others = [entry for entry in exact if entry.cell is not entry.reference]
    refused = [entry for entry in found if entry.cell.unsupported]
    same = sum(entry.agrees for entry in others)
    mesh = found[0].reference.result["mesh"]
    introduction = prose(f"""# Do the contact algorithms agree?

The paper's tyre on a mesh of {mesh}, inflated and pressed, by every contact algorithm of the catalogue, under a dead
and under a follower pressure (with which the tangent is no longer symmetric), with the symmetric section
`constant-s33` and with the paper's non-symmetric one. The equations are the same, so contact set and force must be: the
reference of a case is `semismooth` with the exact condition, and two algorithms agree when no node is in contact in one
set only and the forces differ by at most {scientific(SAME, 0)} of their value, at every travel. That holds for {same}
of {len(others)} other solves with the exact condition; {len(refused)} of {len(found)} requests were refused by the
algorithm. A finite ε solves other equations, and its difference is that of the [regularisation](epsilon.md).""")
    worst = _disagreements(others)
    parts = [introduction, _forces(found), _exact(exact), worst, _finite(found), _refusals(refused)]
    shown = picture(NAME, "Force over the travel of the plane, by load and section")
    lines = commands(entry.cell.command for entry in found)
    text = "\n\n".join([*(part for part in parts[:2]), shown, *(part for part in parts[2:] if part), lines])
    curves = {", ".join(e.case): _curve(e) for e in exact if e.cell is e.reference}
    return joined([Part(text, {NAME: figures_contact.forces(curves)})])


def _curve(entry: Entry) -> tuple[list[float], list[float]]:
    return entry.travels, [entry.reference.value("force_N", delta_mm=delta) for delta in entry.travels]


def _forces(found: list[Entry]) -> str:
    """The reference of every case."""
    rows = []
    for entry in found:
        if entry.cell is entry.reference:
            steps = entry.cell.steps
            rows.append([*entry.case, *(f"{digits(s['force_N'], 9)} ({s['contact_nodes']})" for s in steps)])
    travels = next(entry.travels for entry in found)
    header = ["load", "section", *(f"{delta:g} mm" for delta in travels)]
    return table("Force [N] and nodes in contact, by the reference", header, rows, words=2)


def _exact(exact: list[Entry]) -> str:
    """Every solve with the exact condition."""
    rows = []
    for entry in exact:
        if entry.cell is not entry.reference:
            unlike = [fixed(entry.nodes_unlike(delta), 0) for delta in entry.travels]
            off = [scientific(abs(entry.force_difference(delta))) for delta in entry.travels]
            rows.append([entry.way, *entry.case, *unlike, *off, "yes" if entry.agrees else "no"])
    travels = exact[0].travels if exact else []
    header = ["algorithm", "load", "section", *(f"nodes unlike, {delta:g} mm" for delta in travels)]
    header += [*(f"force off, {delta:g} mm" for delta in travels), "agrees"]
    # the differences are rounding
    return machine(table("Against the reference, the exact condition", header, rows, words=3))


def _disagreements(others: list[Entry]) -> str:
    """Who does not agree, and how it ended."""
    rows = [
        [entry.way, *entry.case, str(entry.cell.result["outcome"]), str(entry.cell.result["reason"])]
        for entry in others
        if not entry.agrees
    ]
    if not rows:
        return "No solve with the exact condition disagrees."
    return table("Solves that do not agree", ["algorithm", "load", "section", "outcome", "reason"], rows, words=5)


def _finite(found: list[Entry]) -> str:
    """What a finite epsilon, the default of some algorithms, changes."""
    rows = [
        [
            *(entry.way, *entry.case),
            scientific(entry.largest_difference),
            NOTHING if entry.most_nodes_unlike is None else str(entry.most_nodes_unlike),
            scientific(max((step["kkt"]["penetration"] for step in entry.cell.steps), default=None)),
        ]
        for entry in found
        if not entry.exact and not entry.cell.unsupported
    ]
    if not rows:
        return ""
    header = ["algorithm", "load", "section", "force off, at most", "nodes unlike, at most", "penetration [mm]"]
    return table("Against the reference, a finite ε", header, rows, words=3)


def _refusals(refused: list[Entry]) -> str:
    """What an algorithm does not do, and why."""
    if not refused:
        return "No algorithm refuses any of the cases."
    rows = [[entry.way, *entry.case, str(entry.cell.result["reason"])] for entry in refused]
    return table("Refused", ["algorithm", "load", "section", "reason"], rows, words=4)


CHAPTER = Chapter(
    "contact-agreement",
    "Contact: agreement",
    "one tyre by every contact algorithm, load and section.",
    agreement_page,
    always=True,
)

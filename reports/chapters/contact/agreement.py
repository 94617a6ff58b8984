"""The page of agreement: do all contact algorithms give the same set and the same force, whatever the case?"""

from __future__ import annotations

from reports.chapter import Chapter
from reports.chapters.contact.agreement_cases import CASE, OF_CASE, SAME, Entry, entries, refusals
from reports.chapters.tyre.figures import load_deflection
from reports.formats import digits, scientific
from reports.markdown import Part, commands, joined, listing, machine, picture, prose, table
from reports.store.tables import Store


def agreement_page(store: Store) -> Part:
    """The whole page."""
    found = list(entries(store))
    exact = [entry for entry in found if entry.exact and not entry.cell.unsupported]
    others = [entry for entry in exact if entry.cell is not entry.reference]
    refused = [entry for entry in found if entry.cell.unsupported]
    same = sum(entry.agrees for entry in others)
    mesh = found[0].reference.result["mesh"]
    introduction = prose(f"""# Agreement of the algorithms

The paper's tyre on a mesh of {mesh}, inflated and pressed, by every contact algorithm of the catalogue, under a dead
and under a follower pressure (with which the tangent is no longer symmetric), with the symmetric section
`constant-s33` and with the paper's non-symmetric one. The equations are the same, so contact set and force must be: the
reference of a case is `semismooth` with the exact condition, and two algorithms agree when no node is in contact in one
set only and the forces differ by at most {scientific(SAME, 0)} of their value, at every travel. That holds for {same}
of {len(others)} other solves with the exact condition; {len(refused)} of {len(found)} requests were refused by the
algorithm. A finite ε solves other equations, and its difference is that of the [regularisation](epsilon.md).""")
    curves = {", ".join(e.case): _curve(e) for e in exact if e.cell is e.reference}
    drawn = load_deflection(curves, "travel of the plane [mm]", "force [N]", loc="upper left")
    return joined(
        introduction,
        _exact(others),
        _disagreements(others),
        _forces(found),
        picture("contact-forces.svg", "Force over the travel of the plane, by load and section", drawn),
        _finite(found),
        refusals(refused) if refused else "No algorithm refuses any of the cases.",
        _elsewhere(store),
        _answers(store),
        commands(entry.cell.command for entry in found),
    )


def _curve(entry: Entry) -> tuple[list[float], list[float]]:
    return entry.travels, [entry.reference.value("force_N", delta_mm=delta) for delta in entry.travels]


def _forces(found: list[Entry]) -> str:
    """The reference of every case."""
    rows = [
        [*entry.case, *(f"{digits(step['force_N'], 9)} ({step['contact_nodes']})" for step in entry.cell.steps)]
        for entry in found
        if entry.cell is entry.reference
    ]
    header = ["load", "section", *(f"{delta:g} mm" for delta in found[0].travels)]
    return table(
        f"Force [N] (and nodes in contact) by the reference, mesh {found[0].reference.result['mesh']}",
        header,
        rows,
        words=2,
    )


def _exact(others: list[Entry]) -> str:
    """Every other solve with the exact condition, at the travel where it differs most."""
    heads = f"{CASE} | nodes in one set only, at most | force off, at most | agrees"
    line = OF_CASE + " | {most_nodes_unlike:.0f} | {largest_difference:.1e} | {agrees:word}"
    # the differences are rounding
    return machine(
        listing(
            "Against the reference, the exact condition, over all travels", others, heads, line, words=3, word=_word
        )
    )


def _word(agrees: bool) -> str:
    return "yes" if agrees else "no"


def _disagreements(others: list[Entry]) -> str:
    """Who does not agree, and how it ended."""
    odd = [entry for entry in others if not entry.agrees]
    heads, line = f"{CASE} | outcome | reason", f"{OF_CASE} | {{cell.result[outcome]}} | {{cell.reason}}"
    if not odd:
        return "No solve with the exact condition disagrees."
    return listing("Solves that do not agree", odd, heads, line, words=5)


def _elsewhere(store: Store) -> Part:
    """Where in the whole campaign an algorithm has failed."""
    if not store.has_analysis("outcomes"):
        return Part("")
    found = store.analysis("outcomes")
    own = found[(found["axis"] == "contact") & (found["scene"] != "") & (found["failed"] > 0)]
    heads = "algorithm | scene | why not solved | problems | solved | failed"
    line = "{name:code} | {scene:code} | {cause} | {planned} | {solved} | {failed}"
    text = prose(f"""## Where algorithms do not end

Agreement is shown above for solves that end; not all do. Over all scenes with contact an algorithm has failed
in {len(own)} of {int(((found["axis"] == "contact") & (found["scene"] != "")).sum())} pairs of algorithm and scene;
[solved and failed](tradeoff.md#solved-and-failed) has all of them, with paths that end.""")
    return joined(text, listing("Algorithms and scenes with failures", own, heads, line, words=3) if len(own) else "")


def _answers(store: Store) -> Part:
    """Problems of the whole campaign to which it has more than one certified answer."""
    if not store.has_analysis("disagreements"):
        return Part("")
    found = store.analysis("disagreements")
    text = prose(f"""## Problems with more than one answer

A certified state is one answer, not the only one. Over all cells of the campaign that ask the same problem, solved to
the default tolerance, {len(found)} further answers differ from that of most cells by more than the certificates leave.
Why is said from facts alone: with friction, whether the path was followed in other load steps; without it, whether both
states are stable, and whether a model of a part is symmetric where that of the whole is not.""")
    heads = "scene | mesh | quantity | most cells | by | steps | other cells | by | steps | apart | why"
    line = (
        "{scene:code} | {mesh} | {quantity} | {value:.6g} | {contact:code}, {model} | {substeps:.0f} | "
        "{other_value:.6g} | {other_contact:code}, {other_model} | {other_substeps:.0f} | {difference:.1e} | {why}"
    )
    return joined(text, listing("Further answers", found, heads, line, words=3) if len(found) else "")


def _finite(found: list[Entry]) -> str:
    """What a finite epsilon, the default of some algorithms, changes."""
    soft = [entry for entry in found if not entry.exact and not entry.cell.unsupported]
    heads = f"{CASE} | force off, at most | nodes in one set only, at most | penetration [mm]"
    line = OF_CASE + " | {largest_difference:.1e} | {most_nodes_unlike:.0f} | {penetration:.1e}"
    return listing("Against the reference, a finite ε", soft, heads, line, words=3) if soft else ""


CHAPTER = Chapter(
    "contact-agreement",
    "Agreement of the algorithms",
    "one tyre by every contact algorithm, load and section.",
    agreement_page,
    always=True,
)

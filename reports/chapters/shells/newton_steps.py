"""Section of the benchmarks page: what plain and mixed Newton need to reach the full load of the hemisphere."""

from __future__ import annotations

from reports.formats import fixed, scientific
from reports.markdown import Part, commands, joined, machine, prose, table
from reports.store.cells import Cell
from reports.store.tables import Store

WHOLE = {"scene": "hemisphere", "mesh": "16x16", "load_fraction": 1, "membrane": "compatible", "lines": "even"}
ELEMENT = {"interpolation": "curvilinear", "thickness_strain": "projected"}


def load_steps(store: Store) -> list[Cell]:
    """The hemisphere's whole load by mixed and plain Newton in one step, and by plain Newton in twenty."""
    ways = (("mixed", 1), ("plain", 1), ("plain", 20))
    return [store.find(**WHOLE, **ELEMENT, newton=newton, steps=steps) for newton, steps in ways]


def newton_part(store: Store) -> Part:
    """Mixed Newton in one step, plain Newton in one and in twenty."""
    mixed, plain, twenty = load_steps(store)
    cells = (mixed, twenty, plain)
    steady, unsteady = ([cell for cell in cells if bool(cell.cuts) is cut] for cut in (False, True))
    header = ["cell", "Newton", "load steps asked for", "taken", "rejected", "Newton iterations"]
    header.append("inward displacement against mixed")
    rows = {cell: _row(cell, mixed) for cell in cells}
    text = prose(f"""## Load steps of Newton's method

The hemisphere's whole load on the coarsest mesh. Mixed Newton keeps the stress resultants of the last linear step in
the tangent; equations and answer are those of plain Newton. {_one_step(plain)}""")
    parts = [text]
    if steady:
        title = "Newton iterations to the full load, every step taken as asked"
        parts.append(table(title, header, (rows[cell] for cell in steady), words=2))
    if unsteady:
        note = "How many iterations a rejected step takes is decided by rounding, and so by the machine."
        title = "Newton iterations to the full load, with rejected steps"
        counts = table(title, header, (rows[cell] for cell in unsteady), words=2)
        parts.append(machine(note, counts, _attempts(plain)))
    return joined(*parts, commands(cell.command for cell in cells))


def _row(cell: Cell, mixed: Cell) -> list[object]:
    taken, inward, answer = (
        each.value(name, load_fraction=1.0)
        for each, name in ((cell, "substeps"), (cell, "inward_mm"), (mixed, "inward_mm"))
    )
    asked, iterations = cell.settings["steps"], cell.result["counters"]["newton_iterations"]
    told = [asked, fixed(taken), len(cell.cuts), iterations, scientific(inward / answer - 1.0)]
    return [cell.label, cell.result["newton"], *told]


def _one_step(plain: Cell) -> str:
    """What became of the whole load in one plain step."""
    if not plain.converged:
        return f"Plain Newton, asked to take it in one step, fails even with smaller steps: {plain.result['reason']}."
    if not plain.cuts:
        return "Plain Newton takes it in one step, too."
    return "Plain Newton does not reach it in one step: the attempt is rejected, and the step is cut until it goes on."


def _attempts(cell: Cell) -> str:
    """Every attempt of a path, as its history tells."""
    history = cell.table("history")
    number = (history["iteration"] == 0).cumsum()
    rows = []
    for _, attempt in history.groupby(number):
        last = attempt.iloc[-1]
        event = str(last.get("event"))
        said = event if event in cell.cuts else "taken"
        rows.append([f"{last['parameter']:g}", str(len(attempt) - 1), said])
    return table(f"Attempts of the cell `{cell.label}`", ["load fraction tried", "iterations", "outcome"], rows)

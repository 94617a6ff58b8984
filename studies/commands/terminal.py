"""What ``footprint solve`` shows of a result on a terminal: its loads, counters, rounds, and references.

Nothing is solved, judged or written here.
"""

from __future__ import annotations

from collections.abc import Iterator

from studies.output.atomic import Table
from studies.output.terminal import columns
from studies.scenes.complete import STEP_KEYS, closest
from studies.solving.refinement import mesh_error
from studies.solving.result import UNSTABLE, WRONG, Result, Step

MANY = 10**6
COUNTED = ("newton_iterations", "limit_point")  # of the counters of a step, those that a terminal shows


def print_table(result: Result) -> None:
    """The loads that were reached, one line each, what fits a terminal."""
    if result.loads:
        rows = [_row(step) for step in result.loads]
        if result.verdict == WRONG:  # the last load, at which the path ends
            rows = [row | {"judge": ""} for row in rows[:-1]] + [rows[-1] | {"judge": WRONG}]
        _print_columns(Table.of_rows(rows))
    if result.request.model_reason:
        print(f"model {result.request.model}: {result.request.model_reason}")
    spent = [f"{_count(value)} {name.replace('_', ' ')}" for name, value in result.counters.items()]
    coarser = result.timing.get(mesh_error.COARSER)
    more = "" if coarser is None else f" and {coarser:.2g} s on coarser grids"
    counters = ", ".join([*spent, f"{result.timing['total']:.3g} s{more}"])
    unstable = ", unstable" if result.verdict == UNSTABLE else ""
    print(f"{result.as_json()['outcome']}{unstable}: {counters}")
    for sentence in (*result.unstable, *result.notes):
        print(sentence)


def _count(value: float) -> str:
    """Whole, or to three digits where nobody reads the others."""
    return f"{value:.3g}" if value >= MANY else str(value)


def references(result: Result) -> Iterator[str]:
    """What is known of the quantities of the last load from elsewhere, and by how much they differ."""
    if not result.loads:
        return
    request, values = result.request, result.loads[-1].seen
    there = {**request.settings, "measure": request.measure, **{key: values[key] for key in STEP_KEYS if key in values}}
    for quantity, known in closest(request.scene, there, values).items():
        off = 100 * (values[quantity] / known.value - 1)
        where = f"{quantity} {known.value:.6g} +- {100 * known.uncertainty:.2g} % ({known.kind}: {known.source})"
        yield f"reference {where}; this value differs by {off:+.2g} %"


def _row(step: Step) -> dict[str, object]:
    """What is seen at a load, what it took, and how many eigenvalues are negative, - where they are not counted."""
    row = step.seen | {key: step.counters[key] for key in COUNTED if key in step.counters}
    if "stability" in step.certificate:
        negative = step.certificate["stability"]["negative"]
        row["negative"] = "-" if negative is None else negative
    return row


def print_rounds(result: Result) -> None:
    """The rounds of refinement, the limit, and the error of the value on the last grid."""
    quantities, rounds = result.quantities, result.table("refinement")
    _print_columns(rounds)
    if "uncertainty" not in quantities:
        print(result.reason)
        return
    if "loads" in result.tables:
        _print_columns(result.table("loads"))
    name = str(rounds.columns["quantity"][0])
    print(f"{name} = {quantities[f'extrapolated_{name}']:.6g} +- {100 * quantities['uncertainty']:.2g} %")
    low, high = (100 * quantities[key] for key in ("error_low", "error_high"))
    print(f"on the last grid {quantities[name]:.6g}, error {low:.2g} to {high:.2g} %")
    if result.reason:
        print(result.reason)


def _print_columns(table: Table) -> None:
    """Numbers to six digits, flush right."""
    names = list(table.columns)
    shown = (map(_shown, row.values()) for row in table.rows())
    print("\n".join(columns([names, *map(list, shown)], right=range(len(names)))))


def _shown(value: object) -> str:
    return "-" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)

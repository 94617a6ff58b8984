"""``footprint bench peers``: work and precision of shells and of other programs, measured in one run.

Processor time of one thread, from the request to the value, without imports; rounds in which every mesh of every
program has its turn, so that what the machine does meanwhile meets all. Seconds are stated in units of one
factorisation by SuperLU of the whole paper's tyre on 42x40 (9840 unknowns) in the same rounds, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
import pandas as pd

from contact.solvers.sparse import factorise
from studies.bench.costs import at_rest, shell_of
from studies.bench.peers.problems import Line, problems
from studies.output.stopwatch import timed
from studies.output.terminal import columns

ROUNDS = 3
LONG = 20.0  # seconds of a solve that is not repeated
UNIT_MESH = "42x40"
KEYS = ["problem", "program", "family", "mesh"]


def unit_of(mesh: str = UNIT_MESH) -> Callable[[], float]:
    """A function that factorises the tangent of the tyre at rest by SuperLU: processor time [s]."""
    work = partial(factorise, at_rest(shell_of(mesh)), "splu", ordered=True)
    return lambda: timed(work)[0]


def measured(
    lines: Sequence[Line],
    unit: Callable[[], float],
    rounds: int = ROUNDS,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
) -> pd.DataFrame:
    """A row a mesh: problem, program, family, mesh, value, unknowns, iterations, seconds and parts of them, error.

    units: seconds over the median of ``unit()``.  seconds and the rest are medians over ``rounds``, or of one run
    that took LONG.  within, bar, uncertainty: of the problem.  value is nan where a program did not get there.
    """
    works = [(line, mesh) for line in lines for mesh in line.meshes]
    rows: list[dict[str, object]] = []
    units: list[float] = []
    long: set[tuple[str, ...]] = set()
    for turn in range(rounds):
        units.append(unit())
        for done, (line, mesh) in enumerate(works):
            key = (line.problem, line.program, line.family, mesh)
            progress(turn * len(works) + done, rounds * len(works), " ".join(key[1:]))
            if key in long:
                continue
            solved = line.solve(mesh)
            long |= {key} if solved.seconds > LONG else set()
            rows.append({**dict(zip(KEYS, key, strict=True)), **solved._asdict()})
    progress(rounds * len(works), rounds * len(works), "done")
    found = pd.DataFrame(rows).groupby(KEYS, sort=False)
    table = found.median().assign(runs=found.size()).reset_index()
    return judged(table.assign(units=table["seconds"] / np.median(units)))


def judged(table: pd.DataFrame) -> pd.DataFrame:
    """With the relative error of each value, and of the problem what it is compared by."""
    known = pd.DataFrame(map(vars, problems().values())).set_index("name")
    found = table.join(known[["reference", "uncertainty", "within", "bar"]], on="problem")
    return found.assign(error=found["value"] / found["reference"] - 1)


def lines_of(table: pd.DataFrame) -> Iterator[str]:
    """The table for a terminal."""
    rows = [("problem", "program", "family", "mesh", "unknowns", "value", "error/%", "seconds", "units", "runs")]
    for row in table.to_dict("records"):
        numbers = (f"{row['value']:.6g}", f"{100 * row['error']:+.2f}", f"{row['seconds']:.3f}", f"{row['units']:.2f}")
        rows.append((*(row[key] for key in KEYS), f"{row['unknowns']:.0f}", *numbers, str(row["runs"])))
    yield from columns(rows, right=range(4, 10))

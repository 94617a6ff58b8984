"""``footprint bench``: what a factorisation, a solve, the whole command and an assembly cost, in units of one work.

Lines of work are timed in rounds, and the unit beside them: what the machine does meanwhile, other programs and a
slower clock, meets both, and their ratio is left. The unit is one factorisation of the tangent of the whole tyre on
42x40 elements, 9840 unknowns, by SuperLU. Each line says what is done, and its bars. Tangents of the whole tyre are
factorised as they are, definite, and with another section, not symmetric.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd
from scipy import sparse

from contact.solvers.sparse import factorise
from formulations.shell import ShellModel
from studies.bench.newton import asked, tyre
from studies.output.stopwatch import CPU, Clock, timed
from studies.run.children import ONE_THREAD
from studies.run.source_hash import ROOT
from studies.scenes.complete import complete
from studies.solving.result import Result
from studies.solving.solve import solve

COLUMNS = ("group", "line", "what", "median", "low", "high", "at_most", "holds")
NO_BAR = float("nan")
HOLDS, VARIES, BROKEN = "holds", "varies", "BROKEN"


def cpu() -> float:
    """Processor time [s], user and system, of this process and of its children that have ended."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return CPU() + children.ru_utime + children.ru_stime


@dataclass(frozen=True, eq=False)
class Line:
    """A work that is timed, and bars on its time; NO_BAR where it is only shown.

    over: over that of other lines of the group, by their names.  most: in units.
    cold: the work keeps nothing that makes it faster next time; any other is done once before it counts.
    """

    name: str
    work: Callable[[], Any]
    over: Mapping[str, float] = field(default_factory=dict)
    most: float = NO_BAR
    cold: bool = False


@dataclass(frozen=True, eq=False)
class Group:
    """Lines that are timed in turns."""

    name: str
    lines: Sequence[Line]


def in_rounds(
    groups: Iterable[Group],
    unit: Callable[[], object],
    rounds: int,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
    clock: Clock = cpu,
) -> pd.DataFrame:
    """One row a ratio: group, line, what it is, median, low and high over the rounds, its bar, and whether it holds.

    The unit of a round is the median of those beside its lines. A bar holds where the median does; it is broken where
    every round is beyond it, and where rounds lie on both sides a busy machine has not decided. Groups are asked for
    one after another, so that what they need is made, and freed, in time.
    """
    rows = [row for group in groups for row in _readings(group, unit, rounds, progress, clock)]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _readings(
    group: Group,
    unit: Callable[[], object],
    rounds: int,
    progress: Callable[[int, int, str], None],
    clock: Clock,
) -> Iterator[tuple[object, ...]]:
    spent: dict[str, list[float]] = {line.name: [] for line in group.lines}
    units: list[float] = []
    for line in group.lines:
        if not line.cold:
            line.work()
    for turn in range(rounds):
        beside = []
        for place, line in enumerate(group.lines):
            progress(turn * len(group.lines) + place, rounds * len(group.lines), f"{group.name}: {line.name}")
            beside.append(timed(unit, clock)[0])
            spent[line.name].append(timed(line.work, clock)[0])
        units.append(statistics.median(beside))
    for line in group.lines:
        ratios = {"units": (units, line.most)} | {f"x {name}": (spent[name], bar) for name, bar in line.over.items()}
        for what, (others, bar) in ratios.items():
            values = [own / other for own, other in zip(spent[line.name], others, strict=True)]
            median = statistics.median(values)
            yield group.name, line.name, what, median, min(values), max(values), bar, _verdict(values, median, bar)


def _verdict(values: Sequence[float], median: float, bar: float) -> str:
    if bar != bar:
        return ""
    return HOLDS if median <= bar else VARIES if any(value <= bar for value in values) else BROKEN


def shown(table: pd.DataFrame) -> str:
    """The table for a terminal."""
    return table.to_string(index=False, float_format="{:.3g}".format, na_rep="")


MESH = "42x40"
SIZES = (MESH, "102x100")  # 10 and 60 thousand unknowns
DELTA_MM = "20"
UNIT, SOLVES = "unit: the tangent of the whole tyre by SuperLU", "solve: half tyre, inflated and pressed in one step"
COMMAND, ASSEMBLY = "command", "assembly: whole tyre"
SOLVE = "start to files"
START, IMPORTS = "command imported, request read", "numpy and scipy imported"
WHOLE = ("-m", "studies.cli", "solve", "tyre", "--model", "half", "--set", f"delta_mm={DELTA_MM}")
FLOOR = ("-c", "import numpy, scipy.linalg, scipy.sparse.linalg")  # nothing is solved without
REFUSED = ("-m", "studies.cli", "solve", "tyre", "--mesh", "0x0", "--out", "unused")  # once all that solves is loaded
OVER_SPLU = 0.35


def costs(
    rounds: int,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
    *,
    sizes: tuple[str, ...] = SIZES,
    mesh: str = MESH,
) -> pd.DataFrame:
    """The table of :func:`in_rounds`.

    Needs one thread (OMP_NUM_THREADS=1, as the command line sets it). Raises UsageError for a mesh it cannot have.
    """
    K = at_rest(shell_of(mesh))
    with TemporaryDirectory() as folder:
        every = groups(K, mesh, sizes, Path(folder))
        return in_rounds(every, partial(factorise, K, "splu", ordered=True), rounds, progress)


def groups(K: sparse.csc_matrix, mesh: str, sizes: tuple[str, ...], folder: Path) -> Iterator[Group]:
    """All that is measured; each is made when it is its turn."""
    orders = {"order of the grid: the unit": True, "order of least degree": False}
    each = [Line(name, partial(factorise, K, "splu", ordered=own), cold=True) for name, own in orders.items()]
    yield Group(UNIT, each)
    for size in sizes:
        yield from factorisations(size)
    yield solves(mesh)
    yield Group(
        COMMAND,
        [
            Line(IMPORTS, partial(child, FLOOR, folder)),
            Line(START, partial(child, REFUSED, folder, 2), over={IMPORTS: 1.5}),
            Line(SOLVE, partial(child, (*WHOLE, "--mesh", mesh, "--out", str(folder / "out")), folder), most=6.0),
        ],
    )
    yield assembly(mesh)


def shell_of(mesh: str, **settings: str) -> ShellModel:
    """The whole tyre of the paper; raises UsageError."""
    return tyre(asked(mesh, **settings)).shell


def at_rest(shell: ShellModel) -> sparse.csc_matrix:
    """The tangent (n, n) at u = 0, definite where it is symmetric; its unknowns are in an order of elimination."""
    return sparse.csc_matrix(shell.linearise(np.zeros(shell.discretisation.n_free)).tangent)


def factorisations(mesh: str) -> Iterator[Group]:
    """The tangents of a mesh, a group each, by fronts and by SuperLU."""
    for kind, settings in {"definite": {}, "not symmetric": {"section": "nonsymmetric"}}.items():
        A = at_rest(shell_of(mesh, **settings))
        fronts = Line("fronts", partial(factorise, A, "multifrontal", ordered=True), over={"splu": OVER_SPLU})
        superlu = Line("splu", partial(factorise, A, "splu", ordered=True), cold=True)
        yield Group(f"factorisation of {A.shape[0]} unknowns, {kind}", [fronts, superlu])


def solves(mesh: str) -> Group:
    """The algorithms, condensed and on fronts, and what both are worth; all beside semismooth."""

    def line(contact: str, over: Mapping[str, float], **settings: str) -> Line:
        name = ", ".join([contact, *(f"{key}={value}" for key, value in settings.items())])
        return Line(name, partial(_solved, contact, mesh, **settings), over)

    beside = {"semismooth": NO_BAR}
    return Group(
        SOLVES,
        [
            line("semismooth", {"regularised": 1.0}),
            line("lcp", {"semismooth": 1.3}),
            line("qp", {"semismooth": 1.3}),
            line("trial-and-error", beside),
            line("regularised", beside),
            line("augmented-lagrangian", beside),
            line("lcp", beside, system="full"),
            line("qp", beside, system="full"),
            line("semismooth", beside, solver="splu"),
        ],
    )


def assembly(mesh: str) -> Group:
    """Residual and tangent of the whole tyre as the iterations of a mixed Newton need them."""
    shell = shell_of(mesh)
    u = np.zeros(shell.discretisation.n_free)
    memory = shell.linearise(u).remember(u)
    return Group(ASSEMBLY, [Line("residual and tangent", partial(shell.linearise, u, memory))])


def _solved(contact: str, mesh: str, **settings: str) -> Result:
    return solve(*complete("tyre", {"delta_mm": DELTA_MM, **settings}, mesh, model="half", contact=contact))


def child(words: Sequence[str], compiled: Path, code: int = 0) -> None:
    """Run Python on one thread to the end, with this exit code; what it compiles is kept, as on installation."""
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, **ONE_THREAD, "PYTHONPATH": path, "PYTHONPYCACHEPREFIX": str(compiled / "compiled")}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    done = subprocess.run([sys.executable, "-P", *words], env=environment, capture_output=True, check=False)
    assert done.returncode == code, done.stderr

"""A run of the solver table into a store: the problems of a folder, samples, and the tables of pages.

Two fields are run, each with tables of its own name: all solvers, and the settings of OSQP. A run is resumed only with
the same files, limit, judge, versions and machine. Nothing is timed, judged or summarised here.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np
import pandas as pd

from contact.interchange.linearised_step import FrozenFrictionalStep, FrozenStep, FrozenStepError
from studies.arena.results import harness
from studies.arena.solver_summaries import data_profiles, effects, performance_profiles, rank_correlation, summary
from studies.arena.solver_table import LIMIT_S, ROUNDS, TOLERANCES, Tell, kind, read, recorded, solver_table
from studies.arena.solvers.base import Solver
from studies.arena.solvers.catalogue import ABLATION, SOLVERS
from studies.ask.request import UsageError
from studies.output.atomic import write_table
from studies.output.provenance import provenance

REPEATED = 0.95  # the correlation of ranks from which two runs agree
STEADY = ("limit_s", "harness", "cpu", "cores", "numpy", "scipy")  # may not change within a run, nor may PACKAGES
PACKAGES = (
    *("osqp", "clarabel", "proxsuite", "piqp", "daqp", "highspy", "scs", "qpalm", "cvxopt", "quadprog", "cvxpy"),
    "qpsolvers",
)
PROBLEM_COLUMNS = ("problem", "digest", "kind", "unknowns", "candidates", "entries")


@dataclass(frozen=True)
class Field:
    """The competing solvers, and the tables derived from a solver table besides its summary, by name."""

    name: str
    of: Callable[[], Sequence[Solver]]
    further: Callable[[pd.DataFrame, pd.DataFrame], Mapping[str, pd.DataFrame]]

    @property
    def solvers(self) -> Sequence[Solver]:
        """The solvers at this moment: --use adds others."""
        return self.of()

    def path(self, store: Path, table: str) -> Path:
        """Of a table in a store, e.g. solver_samples."""
        return store / "tables" / f"{self.name}_{table}.csv"


def _profiles(table: pd.DataFrame, summed: pd.DataFrame) -> dict[str, pd.DataFrame]:
    return {"profiles": pd.concat([performance_profiles(table), data_profiles(table)], ignore_index=True)}


FIELDS = {
    "solver": Field("solver", lambda: tuple(SOLVERS.values()), _profiles),
    "osqp": Field("osqp", lambda: ABLATION, lambda table, summed: {"effects": effects(summed)}),
}


def problems_in(folder: Path) -> dict[str, FrozenStep]:
    """The frozen steps of a folder by name, fewest unknowns first; raises UsageError for an invalid file.

    Those with friction are left out: no solver here supports it.
    """
    paths = sorted(folder.glob("*.npz"))
    if not paths:
        raise UsageError(f"--problems {folder}: no frozen steps (*.npz) in it")
    try:
        steps = {path.stem: FrozenStep.read(path) for path in paths}
    except FrozenStepError as error:
        raise UsageError(str(error)) from None
    without = {name: step for name, step in steps.items() if not isinstance(step, FrozenFrictionalStep)}
    if not without:
        raise UsageError(f"--problems {folder}: all frozen steps in it are with friction, which no solver here knows")
    return dict(sorted(without.items(), key=lambda item: len(item[1].r)))


def run(
    field: Field,
    problems: Mapping[str, FrozenStep],
    store: Path,
    *,
    only: Sequence[str] = (),
    tolerances: Sequence[float] = TOLERANCES,
    rounds: int = ROUNDS,
    limit_s: float = LIMIT_S,
    tell: Tell = lambda done, planned, label: None,
) -> pd.DataFrame:
    """Run the solves that are missing, write all tables and return the solver table.

    only: names of solvers, default all. Raises UsageError for an unknown name, and where the store was begun with
    other files, another limit, other versions or on another machine.
    """
    chosen = _chosen(field, only)
    about, listed = conditions(limit_s), listing(problems)
    _same_run(field, store, about, listed)
    write_table(field.path(store, "run"), pd.DataFrame(about.items(), columns=["name", "value"]))
    write_table(field.path(store, "problems"), listed)
    path = field.path(store, "samples")
    samples = recorded(list(problems.items()), path, chosen, tolerances, rounds=rounds, limit_s=limit_s, tell=tell)
    table = solver_table(samples[samples["problem"].isin(list(problems))])
    summed = summary(table, limit_s)
    for name, each in {"table": table, "summary": summed, **field.further(table, summed)}.items():
        write_table(field.path(store, name), each)
    return table


def conditions(limit_s: float) -> dict[str, str]:
    """The limit of a solve, the checksum of the judge, the machine, and the versions of the solvers."""
    record = provenance()
    machine = {key: str(record["machine"][key]) for key in ("cpu", "cores", "memory_GiB", "system", "python")}
    versions = {name: _version(name) for name in ("numpy", "scipy", *PACKAGES)}
    return {
        "limit_s": repr(float(limit_s)),
        "harness": harness(),
        "commit": str(record["commit"]),
        **machine,
        **versions,
    }


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def listing(problems: Mapping[str, FrozenStep]) -> pd.DataFrame:
    """The problems put to the solvers: PROBLEM_COLUMNS; digest: of all numbers of a problem."""
    rows = [
        (name, _digest(step), kind(step), len(step.r), len(step.gap), step.K.nnz) for name, step in problems.items()
    ]
    return pd.DataFrame(rows, columns=list(PROBLEM_COLUMNS))


def _digest(step: FrozenStep) -> str:
    matrices = [each for each in (step.K, step.G, step.coupling) if each is not None]
    digest = hashlib.sha256()
    for part in (*(each.data for each in matrices), step.r, step.gap, step.weights, np.array(step.scale)):
        digest.update(np.ascontiguousarray(part).tobytes())
    return digest.hexdigest()[:16]


def _chosen(field: Field, only: Sequence[str]) -> list[Solver]:
    names = [solver.name for solver in field.solvers]
    for name in only:
        if name not in names:
            raise UsageError(f"--only {name!r} must be one of {'; '.join(names)}")
    return [solver for solver in field.solvers if not only or solver.name in only]


def _same_run(field: Field, store: Path, about: Mapping[str, str], listed: pd.DataFrame) -> None:
    """Raises UsageError where the store has samples of other conditions."""
    if not field.path(store, "samples").exists():
        return
    before = told(field, store)
    for name in (*STEADY, *PACKAGES):
        if before.get(name) != about[name]:
            raise UsageError(
                f"{store} was begun with {name} {before.get(name)}, not {about[name]}: choose another --out"
            )
    known = pd.read_csv(field.path(store, "problems")).set_index("problem")["digest"]
    for name, digest in listed[["problem", "digest"]].itertuples(index=False):
        if known.get(name, digest) != digest:
            raise UsageError(f"{store} was begun with another file {name}.npz: choose another --out")


def told(field: Field, store: Path) -> dict[str, str]:
    """The conditions of the run in a store; raises UsageError where there is none."""
    path = field.path(store, "run")
    if not path.exists():
        raise UsageError(f"{store}: no run of bench solvers in it (no {path.name})")
    return dict(pd.read_csv(path, dtype=str, keep_default_na=False).itertuples(index=False, name=None))


def against(field: Field, store: Path, other: Path) -> pd.DataFrame:
    """Rank correlation of two stores, with failures at the shorter of their limits: RANK_COLUMNS."""
    limits = [float(told(field, each)["limit_s"]) for each in (store, other)]
    one, two = (read(field.path(each, "table")) for each in (store, other))
    return rank_correlation(one, two, min(limits))

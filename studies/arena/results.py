"""The results of an entry on a machine, as one JSON file.

    format, format_version   FORMAT, VERSION
    entry                    the solver, 1 to 80 printable characters
    machine                  texts: cpu, cores, system, python, numpy, scipy, threads and kernels of BLAS, instructions
    harness, collection      the checksums of the judge and of the problems; a file with others is stale
    limit_s                  processor time of a solve
    tolerances               a list of {tolerance, public, held_out}, the accuracy asked for, largest first

``public`` is a list of {problem, status, cost}: status one of STATUS, cost in factorisations of K, null where it is not
ok. ``held_out`` is null, or the counts by status, the mean of cost and the digest of the secret: no name, no size.

    ok         claimed, and as accurate as asked            excluded   refused: no such problem is its business
    anomalous  claimed, and not as accurate                 missing    not installed, or not asked
    failed     not claimed, or killed at the limit          stale      of another harness or collection, as read

No solver is run and no result is read or ranked here.
"""

from __future__ import annotations

import hashlib
import math
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from studies.arena.collected.dataset import identity
from studies.output.atomic import write_json
from studies.output.provenance import provenance
from studies.run.source_hash import sources_hash

FORMAT, VERSION = "footprint arena result", 1
OK, ANOMALOUS, FAILED, MISSING, EXCLUDED, STALE = "ok", "anomalous", "failed", "missing", "excluded", "stale"
STATUS = (OK, ANOMALOUS, FAILED, MISSING, EXCLUDED)  # of a problem; STALE is that of a whole file
HARNESS = ("studies.arena.solver_table", "studies.arena.results")
NOT_HARNESS = ("studies.arena.solvers.catalogue",)  # the solvers being judged
MACHINE = ("cpu", "cores", "system", "python", "numpy", "scipy", "threads", "kernels", "instructions")
TEXT = 80  # characters of an entry, twice as many of the machine


@dataclass(frozen=True)
class Solved:
    """A problem by its name, how it ended, and the cost in factorisations of K, NaN where it is not OK."""

    problem: str
    status: str
    cost: float


@dataclass(frozen=True)
class Counted:
    """The held-out tier: problems by status, geometric mean of the cost of those solved, and whose secret it is."""

    statuses: Mapping[str, int]
    cost: float
    secret: str


@dataclass(frozen=True)
class Asked:
    """All results at one tolerance."""

    tolerance: float
    public: tuple[Solved, ...]
    held_out: Counted | None = None


@dataclass(frozen=True)
class Result:
    """A file."""

    entry: str
    machine: Mapping[str, str]
    harness: str
    collection: str
    limit_s: float
    tolerances: tuple[Asked, ...]

    @property
    def place(self) -> str:
        """Of the machine: eight digits of a hash of its description."""
        return hashlib.sha256(repr(sorted(self.machine.items())).encode()).hexdigest()[:8]

    @property
    def file(self) -> str:
        """Its name: the entry in letters, and the place of the machine."""
        word = re.sub(r"[^a-z0-9]+", "-", self.entry.lower()).strip("-")[:40] or "entry"
        own = hashlib.sha256(self.entry.encode()).hexdigest()[:4]
        return f"{word}-{own}-{self.place}.json"

    @property
    def stale(self) -> bool:
        """Whether another harness judged, or another collection was solved."""
        return (self.harness, self.collection) != (harness(), identity())

    def write(self, directory: Path) -> Path:
        """Into a folder, whole or not at all."""
        path = directory / self.file
        write_json(path, {"format": FORMAT, "format_version": VERSION, **asdict(self)})
        return path


@cache
def harness() -> str:
    """The checksum of the code that runs, times and judges: 16 digits of a hash of its sources."""
    return sources_hash(HARNESS, without=NOT_HARNESS)[:16]


def here() -> dict[str, str]:
    """MACHINE of this machine. kernels, instructions: as set by the environment."""
    record = provenance()
    machine, packages = record["machine"], record["packages"]
    about = {key: str(machine[key]) for key in ("cpu", "cores", "system", "python")}
    about |= {key: str(packages.get(key, "")) for key in ("numpy", "scipy")}
    without = os.environ.get("NPY_DISABLE_CPU_FEATURES", "")
    about |= {"threads": str(record["blas"]["threads"]), "kernels": os.environ.get("OPENBLAS_CORETYPE", "own")}
    about["instructions"] = f"without {without}" if without else "own"
    return {key: plain(value) for key, value in about.items()}


def plain(text: str) -> str:
    """At most 2 TEXT characters, the unprintable ones as spaces."""
    return "".join(letter if letter.isprintable() else " " for letter in text)[: 2 * TEXT]


def results_of(
    tables: Mapping[str, pd.DataFrame], limit_s: float, wanted: Sequence[str], secret: str = ""
) -> list[Result]:
    """One result per solver of the tables ``public`` and ``held_out`` (columns of solver_table), either may be absent.

    wanted: all problems of the collection without friction; one that was not put to a solver is missing.
    """
    public, held = tables.get("public"), tables.get("held_out")
    present = [each for each in (public, held) if each is not None]
    names = dict.fromkeys(name for each in present for name in each["solver"])
    return [
        Result(name, here(), harness(), identity(), limit_s, tuple(_asked(name, public, held, wanted, secret)))
        for name in names
    ]


def _asked(
    name: str, public: pd.DataFrame | None, held: pd.DataFrame | None, wanted: Sequence[str], secret: str
) -> Iterable[Asked]:
    sides = [None if each is None else each[each["solver"] == name] for each in (public, held)]
    tolerances = {float(value) for each in sides if each is not None for value in each["tolerance"]}
    for tolerance in sorted(tolerances, reverse=True):
        own, drawn = (None if each is None else each[each["tolerance"] == tolerance] for each in sides)
        by_problem = {} if own is None else {each.problem: each for each in map(_solved, own.to_dict("records"))}
        listed = tuple(by_problem.get(problem, Solved(problem, MISSING, math.nan)) for problem in wanted)
        counts = None
        if drawn is not None and len(drawn):
            ended = [_solved(row) for row in drawn.to_dict("records")]
            counts = Counted(statuses(ended), mean_cost(ended), secret)
        yield Asked(tolerance, listed, counts)


def _solved(row: Mapping[Any, Any]) -> Solved:
    if not row["asked"]:
        status = MISSING if str(row["reason"]).startswith("not installed") else EXCLUDED
    else:
        status = ANOMALOUS if row["false"] else OK if row["claimed"] else FAILED
    cost = float(row["seconds"]) / float(row["factorisation_s"]) if status == OK else math.nan
    return Solved(str(row["problem"]), status, cost if math.isfinite(cost) else math.nan)


def statuses(ended: Iterable[Solved]) -> dict[str, int]:
    """The number of problems with each STATUS."""
    ends = [each.status for each in ended]
    return {status: ends.count(status) for status in STATUS}


def mean_cost(ended: Iterable[Solved]) -> float:
    """Geometric mean of the cost of those that are OK; NaN where there is none."""
    costs = [each.cost for each in ended if each.status == OK and each.cost > 0]
    return float(np.exp(np.mean(np.log(costs)))) if costs else math.nan

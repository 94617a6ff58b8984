"""Every solver on every frozen problem and tolerance: each answer judged from the file alone, each solve timed.

Rounds are interleaved: in each, every problem is put to every solver with every tolerance, one after another in one
process that may be killed. A solver that was killed at one tolerance is not run at a stricter one on that problem; this
sample counts as killed, too, with the same reason. Samples are one flat table, from which an interrupted run resumes.
Times are medians over the rounds.
"""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from functools import cached_property, lru_cache
from itertools import count, product
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pandas as pd

from contact.interchange.linearised_step import FrozenStep
from contact.interchange.oracle import positive_definite
from contact.solvers.sparse import factorise, symmetric
from studies.arena.answers import NONE, RESIDUALS, Scales, accuracy
from studies.arena.solvers.base import Answer, Solver
from studies.arena.solvers.catalogue import SOLVERS
from studies.arena.solvers.process import Child

TOLERANCES = (1e-4, 1e-6, 1e-8)
LIMIT_S = 20.0  # of a solve
ROUNDS = 3
KEY = ("solver", "problem", "tolerance")
ABOUT = ("kind", "unknowns", "candidates", "asked", "claimed", "accuracy")
SAMPLE_COLUMNS = (
    *("round", *KEY, *ABOUT, *RESIDUALS, "false", "kept", "seconds", "iterations", "memory_MB", "factorisation_s"),
    "reason",
)
COLUMNS = (*SAMPLE_COLUMNS[1:], "samples")
KILLED = "killed after"  # the reason of a solve that reached its limit begins with this
Problems = Collection[tuple[str, FrozenStep]]
Tell = Callable[[int, int, str], None]  # solves that are done, solves in all, and the next one


def solver_table(samples: pd.DataFrame) -> pd.DataFrame:
    """One row per solver, problem and tolerance of samples, with COLUMNS.

    asked: whether the solver is installed and applies; ``reason``: why not, or its message.  accuracy, RESIDUALS: of
    the answer, claimed or not, infinite where it was killed, see :mod:`studies.arena.answers`; of the least accurate
    round.  false: claimed, and less accurate than required, in any round.  kept: whether a claim meets the tolerance
    by the solver's own criterion, where it has one.
    seconds: of the processor, median of so many ``samples``; NaN where it was killed.  memory_MB: the largest peak, see
    :mod:`studies.arena.solvers.process`.  factorisation_s: of K, median, the unit of data profiles.
    """
    worst = samples.sort_values("accuracy", kind="stable", ascending=False).drop_duplicates(list(KEY))
    groups = samples.groupby(list(KEY), sort=False)
    table = worst.set_index(list(KEY)).reindex(groups.size().index)
    table["false"], table["claimed"] = groups["false"].max(), groups["claimed"].max()
    table["seconds"], table["memory_MB"] = groups["seconds"].median(), groups["memory_MB"].max()
    table["samples"] = groups["seconds"].count()
    units = samples.groupby("problem")["factorisation_s"].median()
    table["factorisation_s"] = units.reindex(table.index.get_level_values("problem")).to_numpy()
    return table.reset_index()[list(COLUMNS)]


def recorded(
    problems: Problems,
    path: Path,
    solvers: Iterable[Solver] = tuple(SOLVERS.values()),
    tolerances: Sequence[float] = TOLERANCES,
    *,
    rounds: int = ROUNDS,
    limit_s: float = LIMIT_S,
    tell: Tell = lambda done, planned, label: None,
) -> pd.DataFrame:
    """The samples of a run, each written to ``path`` (CSV) at once; those in the file are not repeated.

    An incomplete last line, left by a machine that went down, is removed.
    """
    done = read(path)
    if path.exists():
        whole = path.read_bytes()
        os.truncate(path, whole.rfind(b"\n") + 1)
    with path.open("a", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, SAMPLE_COLUMNS)
        if not path.stat().st_size:
            writer.writeheader()
        keys = {(int(n), *rest) for n, *rest in done[["round", *KEY]].itertuples(index=False)}
        none = done.loc[done["seconds"].isna(), [*KEY, "reason"]]
        over = {(solver, problem, tolerance): reason for solver, problem, tolerance, reason in none.to_numpy()}
        rows = samples(problems, solvers, tolerances, rounds=rounds, limit_s=limit_s, done=keys, over=over, tell=tell)
        for row in rows:
            writer.writerow(row)
            file.flush()
    return read(path)


def read(path: Path) -> pd.DataFrame:
    """Complete rows of samples, or of a solver table; none where there is no file."""
    whole = path.read_text(encoding="utf-8").rpartition("\n")[0] if path.exists() else ""
    if not whole:
        return pd.DataFrame(columns=list(SAMPLE_COLUMNS))
    types = {"kept": object, "reason": object}
    table = pd.read_csv(io.StringIO(whole), dtype=types, keep_default_na=False, na_values=["", "nan"])
    return table.assign(kept=table["kept"].map({"True": True, "False": False}), reason=table["reason"].fillna(""))


def samples(
    problems: Problems,
    solvers: Iterable[Solver] = tuple(SOLVERS.values()),
    tolerances: Sequence[float] = TOLERANCES,
    *,
    rounds: int = ROUNDS,
    limit_s: float = LIMIT_S,
    done: Collection[tuple[int, str, str, float]] = (),
    over: Mapping[tuple[str, str, float], str] = MappingProxyType({}),
    tell: Tell = lambda done, planned, label: None,
) -> Iterator[dict[str, object]]:
    """One row per solve, with SAMPLE_COLUMNS.

    Refused or killed solves are not repeated: ``over`` has those of earlier runs with their reasons; ``done`` has the
    round and the KEY of all earlier samples.
    """
    solvers, loose_first, ended = list(solvers), sorted(tolerances, reverse=True), dict(over)
    planned, progress = rounds * len(problems) * len(solvers) * len(loose_first), count()
    with closing(Child(limit_s)) as child:
        for turn, (name, step) in product(range(rounds), problems):
            bench = _Bench(child, name, step, turn)
            for solver, tolerance in product(_turned(solvers, turn), loose_first):
                tell(next(progress), planned, f"{name}: {solver.name}")
                key = solver.name, name, tolerance
                if key in ended or (turn, *key) in done:
                    continue
                before = (ended.get((solver.name, name, looser), "") for looser in loose_first if looser > tolerance)
                row = bench.row(solver, tolerance, next((why for why in before if why.startswith(KILLED)), ""))
                if not np.isfinite(float(str(row["seconds"]))):
                    ended[key] = str(row["reason"])
                yield row


@lru_cache(maxsize=2)
def kind(step: FrozenStep) -> str:
    """Kind of a problem, from its file: ``convex``, ``not convex``, ``not symmetric`` or ``consistent coupling``."""
    if step.coupling is not None:
        return "consistent coupling"
    if not symmetric(step.K):
        return "not symmetric"
    return "convex" if positive_definite(step.K) else "not convex"


@dataclass
class _Bench:
    """A problem, and the process in which it is solved."""

    child: Child
    name: str
    step: FrozenStep
    turn: int
    factorisation_s: float = np.nan

    @cached_property
    def scales(self) -> Scales:
        """The scales of the residuals."""
        return Scales.of(self.step)

    def row(self, solver: Solver, tolerance: float, killed: str = "") -> dict[str, object]:
        """The sample of a solver; ``killed``: the reason, where it was killed at a looser tolerance."""
        step, answer, peak = self.step, None, np.nan
        reason = solver.missing() or solver.applies(step)
        if reason is None:
            if np.isnan(self.factorisation_s):
                self.factorisation_s = self.child.solve(FACTORISATION, step, 0.0)[0].seconds
            if killed:
                answer = Answer.none(step, killed)
            else:
                answer, peak = self.child.solve(solver, step, tolerance)
        result = answer or Answer.none(step, str(reason))
        kept = solver.keeps(step, result, tolerance) if result.claimed else None
        about = {"round": self.turn, "solver": solver.name, "problem": self.name, "tolerance": tolerance}
        about |= {"kind": kind(step), "unknowns": len(step.r), "candidates": len(step.gap), "asked": answer is not None}
        about |= {"kept": kept, "seconds": result.seconds, "iterations": result.iterations, "memory_MB": peak}
        worth = judged(result, step, tolerance, self.scales)
        return {**about, **worth, "factorisation_s": self.factorisation_s, "reason": result.reason}


def judged(answer: Answer, step: FrozenStep, tolerance: float, scales: Scales) -> dict[str, object]:
    """claimed, accuracy, RESIDUALS and false of an answer."""
    worth = accuracy(step, answer.du, answer.pressure, scales) if np.all(np.isfinite(answer.du)) else NONE
    wrong = answer.claimed and not worth.worst <= tolerance
    return {"claimed": answer.claimed, "accuracy": worth.worst, **asdict(worth), "false": wrong}


@dataclass(frozen=True)
class _Factorisation(Solver):
    """One factorisation of K: not a solver, but the unit of data profiles."""

    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        factorise(step.K)
        return Answer.none(step, "a factorisation")


FACTORISATION = _Factorisation("factorisation")


def _turned(solvers: list[Solver], turn: int) -> list[Solver]:
    """Another order in each round, so that no solver always follows the same one."""
    at = turn % max(len(solvers), 1)
    return solvers[at:] + solvers[:at]

r"""The public problems with friction of Siconos before the algorithms, the judge and the oracle.

Rigid bodies, from one contact to thousands, in the local and the global form of FCLib; files are not copied here but
for the small ones in ``public_problems.json``. The table beside this module is made by::

    git clone https://github.com/siconos/siconos && git -C siconos checkout 6070f0f6f
    python -m studies.experiments.friction.public_problems OUT.csv \
        siconos/numerics/src/FrictionContact/test/data siconos/numerics/python/tests/data

with h5py installed, else problems in HDF5 are left out. Algorithms get contacts with ways of their own
(:mod:`contact.interchange.own_ways`), the oracle the problem as a step of its unknowns
(:mod:`contact.interchange.siconos`).

Of 65 files 62 are problems. With 5 s of the processor each, 56 of them have an answer that the judge takes, and nothing
that is called solved is refused by it: semismooth has 46, the augmented Lagrangian 45, the oracle 43, lcp 42, qp 26 and
trial-and-error 18. Redundant contacts make the systems of active sets singular, and W that is not symmetric is refused
by qp. Where the oracle has an answer, too, every other one has its ways.
"""

from __future__ import annotations

import json
import signal
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy import sparse

from contact.catalogue import by_the_exact_law
from contact.interchange.fclib import read_fclib
from contact.interchange.friction_oracle import minimise
from contact.interchange.friction_states import Known
from contact.interchange.linearised_step import FrozenFrictionalStep
from contact.interchange.oracle import AGREEMENT, OracleError
from contact.interchange.own_ways import with_own_ways
from contact.interchange.siconos import HDF5, SiconosError, SiconosProblem, read
from contact.problem import ContactAlgorithm, ContactSolution, Outcome
from contact.solvers.sparse import checked_solve, factorise
from contact.verify import judge
from studies.experiments import Row
from studies.output.atomic import write_table

LIMIT_S = 5.0  # of the processor, of one solve
ORACLE = "oracle"
UNDECIDED = "not tried"


@dataclass(frozen=True, eq=False)
class Tried:
    """outcome: of the solve.  certified: by the judge, None without a claim.  ways (m, 3) [mm], reason: in words."""

    outcome: str
    seconds: float = 0.0
    certified: bool | None = None
    ways: np.ndarray | None = None
    reason: str = ""


def algorithms() -> dict[str, ContactAlgorithm]:
    """Those of the catalogue, by name; trial-and-error is the naive set."""
    return by_the_exact_law(naive=True)


def public_table() -> pd.DataFrame:
    """The shipped outcomes: a row a problem and algorithm, in the columns of :func:`rows`."""
    return pd.read_csv(Path(__file__).with_name("public_problems.csv"), keep_default_na=False)


def small() -> dict[str, SiconosProblem]:
    """The problems that are shipped, by the names of their files."""
    return {name: _of(given) for name, given in _shipped()["problems"].items()}


def source() -> tuple[str, str]:
    """Where they are from, and their licence."""
    shipped = _shipped()
    return shipped["source"], shipped["licence"]


def _shipped() -> dict[str, Any]:
    return dict(json.loads(Path(__file__).with_name("public_problems.json").read_text(encoding="utf-8")))


def _of(given: Mapping[str, Any]) -> SiconosProblem:
    arrays = {key: np.array(given[key], float) for key in given if key != "d"}
    W, M, H = (sparse.csc_matrix(arrays[key]) if key in arrays else None for key in ("W", "M", "H"))
    return SiconosProblem(given["d"], arrays["mu"], arrays["offset"], W, M, H, arrays.get("q"))


def read_any(path: Path) -> SiconosProblem:
    """From text or HDF5; raises SiconosError, OSError."""
    with path.open("rb") as file:
        begins = file.read(len(HDF5))
    return read_fclib(path) if begins == HDF5 else read(path)


def limited(solve: Callable[[], Tried], limit_s: float = LIMIT_S) -> Tried:
    """What comes of a solve, with its time of the processor, after which it is stopped."""

    def stop(number: int, frame: object) -> None:
        raise TimeoutError(f"more than {limit_s:g} s")

    before, begun = signal.signal(signal.SIGPROF, stop), time.process_time()
    signal.setitimer(signal.ITIMER_PROF, limit_s)
    try:
        attempt = solve()
    except TimeoutError as error:
        attempt = Tried("time limit", reason=str(error))
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
    return replace(attempt, seconds=time.process_time() - begun)


def rows(name: str, problem: SiconosProblem, limit_s: float = LIMIT_S) -> Iterator[Row]:
    """A row for the oracle and one an algorithm.

    d, contacts, mu: of the problem, mu the largest.  certified: whether the judge takes what is called solved.
    agrees: whether the ways of the contacts are the oracle's to 1e-7 of the largest, with and without contact; forces
    of redundant contacts are several.  seconds: of the processor.  reason: why there is no answer.
    """
    head: Row = {"problem": name, "kind": problem.kind, "d": problem.d}
    head |= {"contacts": len(problem.mu), "mu": float(f"{np.max(problem.mu):.6g}")}
    own = limited(partial(_by_oracle, problem), limit_s)
    yield head | {"algorithm": ORACLE} | _told(own, None, 0.0)
    step, free = with_own_ways(problem), float(np.max(np.abs(_free(problem))))
    for label, algorithm in algorithms().items():
        attempt = limited(partial(_by_algorithm, algorithm, step), limit_s)
        yield head | {"algorithm": label} | _told(attempt, own.ways if own.certified else None, free)


def _free(problem: SiconosProblem) -> np.ndarray:
    """The ways of the contacts where none carries anything."""
    if problem.M is None or problem.H is None or problem.q is None:
        return problem.offset
    return problem.offset + problem.H.T @ checked_solve(factorise(problem.M), problem.M, problem.q)


def _told(attempt: Tried, wanted: np.ndarray | None, free: float) -> Row:
    agrees: bool | str = ""
    if attempt.ways is not None and attempt.certified and wanted is not None:
        size = float(max(free, np.max(np.abs(wanted)), np.max(np.abs(attempt.ways)))) or 1.0
        agrees = float(np.max(np.abs(attempt.ways - wanted))) <= AGREEMENT * size
    certified: bool | str = "" if attempt.certified is None else attempt.certified
    row: Row = {"outcome": attempt.outcome, "certified": certified, "agrees": agrees}
    return row | {"seconds": f"{attempt.seconds:.2f}", "reason": attempt.reason}


def _by_algorithm(algorithm: ContactAlgorithm, step: FrozenFrictionalStep) -> Tried:
    problem, m = step.problem(), len(step.mu)
    why = algorithm.supports(problem)
    if why is not None:
        return Tried(Outcome.REFUSED.word, reason=why)
    try:
        solution = algorithm.solve(problem, ContactSolution.at_rest(len(step.r), m))
    except (ValueError, ArithmeticError) as error:
        return Tried(Outcome.REFUSED.word, reason=str(error).splitlines()[0])
    if not solution.outcome.converged:
        return Tried(solution.outcome.word)
    if np.isfinite(algorithm.epsilon):
        return Tried(solution.outcome.word, reason=f"by its own law, of springs of {algorithm.epsilon:g} MPa/mm")
    return _judged(solution.outcome.word, step, solution.u, solution.pressure, solution.rubbed.force)


def _by_oracle(problem: SiconosProblem) -> Tried:
    try:
        step = problem.step()
        minimum: Known = minimise(step)
    except (SiconosError, OracleError) as error:
        return Tried("none", reason=str(error).splitlines()[0])
    return _judged("converged", step, minimum.du, minimum.normal, minimum.friction)


def _judged(word: str, step: FrozenFrictionalStep, u: np.ndarray, normal: np.ndarray, friction: np.ndarray) -> Tried:
    wrong = judge(step.problem(), u, normal, friction).failures()
    ways = np.column_stack([step.gap + step.G @ u, step.slip + (step.S @ u).reshape(-1, 2)])
    return Tried(word, certified=not wrong, ways=ways, reason=", ".join(wrong))


def table(folders: Sequence[Path]) -> pd.DataFrame:
    """All problems of folders, each name once, and what is none with the reason, smallest files first."""
    paths = {path.name: path for folder in folders for path in sorted(folder.glob("*")) if path.is_file()}
    lines: list[Row] = []
    for name, path in sorted(paths.items(), key=lambda item: (item[1].stat().st_size, item[0])):
        try:
            problem = read_any(path)
        except SiconosError as error:
            why = str(error).replace(str(path), "the file")
            lines.append({"problem": name, "outcome": UNDECIDED, "reason": why})
            continue
        lines.extend(rows(name, problem))
    columns = ["problem", "kind", "d", "contacts", "mu", "algorithm", "outcome", "certified", "agrees", "seconds"]
    return pd.DataFrame(lines, columns=[*columns, "reason"], dtype=object).fillna("")


def main(arguments: Sequence[str]) -> None:
    """OUT.csv FOLDER .."""
    out, *folders = map(Path, arguments)
    write_table(out, table(folders))


if __name__ == "__main__":
    main(sys.argv[1:])

"""Who a card is of, and all tries of it, kind by kind: the newcomer and those of ours, one problem after another.

A card is of a part that a file adds to a catalogue, or of one of ours by its name. Nothing is concluded here. The
newcomer may take BUDGET_S in all and LIMIT_S for a try, on the clock; tries that are left when that is spent are not
begun.
"""

from __future__ import annotations

import math
import pickle
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from importlib.resources import files
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.problem import ContactSolution, Outcome
from formulations.element.mixed import THICKNESS_STRAINS
from formulations.strains.catalogue import MEASURES
from studies.arena.answers import Scales
from studies.arena.card.problems import BENT, POINTS, SMALL, Posed, frozen_of, posed
from studies.arena.card.trials import (
    AGREES,
    ALIKE,
    FAILED,
    FALSE,
    LATE,
    REFUSED,
    SOLVED,
    Ended,
    Trial,
    against,
    alone,
    asked,
    epsilon_of,
)
from studies.arena.solver_table import judged
from studies.arena.solvers.base import Answer as Said
from studies.arena.solvers.base import Solver
from studies.arena.solvers.catalogue import SOLVERS
from studies.arena.solvers.process import Child
from studies.ask.scene import UsageError
from studies.fuzz.comparing import Answer, difference
from studies.output.stopwatch import timed
from studies.scenes import SCENES
from studies.scenes.element import PRESETS
from studies.scenes.plugins import load_file

TEMPLATE = files("studies.arena").joinpath("template")
LAYOUT = {  # its files and their folders in a repository
    "README.md": "",
    "my_algorithm.py": "",
    "card.yml": ".github/workflows",
}
ALGORITHM, MEASURE, SOLVER, ELEMENT = "contact algorithm", "strain measure", "QP solver", "element option"
CATALOGUES: dict[str, tuple[dict[str, Any], ...]] = {
    ALGORITHM: (ALGORITHMS,),
    MEASURE: (MEASURES,),
    SOLVER: (SOLVERS,),
    ELEMENT: (THICKNESS_STRAINS, PRESETS),
}
LIMIT_S, BUDGET_S = 10.0, 60.0
TOLERANCES = (1e-6, 1e-8)
SOLVER_LIMIT_S, PATIENCE = 5.0, 3  # of processor time; so often it may be killed
BESIDE = ("semismooth", "Lemke", "condensed QP, finished", "OSQP, scaled", "Clarabel, scaled", "HiGHS, scaled")
REFERENCE = {ALGORITHM: "semismooth", MEASURE: "exact", SOLVER: "semismooth", ELEMENT: "balanced"}  # of ratios of cost
EXACT = ("semismooth", "lcp")  # whose answer is the right one on a scene
Tell = Callable[[str], None]


@dataclass(frozen=True)
class Subject:
    """A part by kind and name; file: that it came with, or nothing; ours: the parts of its kind that were there."""

    kind: str
    name: str
    file: str
    ours: tuple[str, ...]


def subjects(asked: str) -> list[Subject]:
    """The parts that a file adds or replaces, or the part of ours with this name; raises UsageError with one line."""
    path = Path(asked)
    if path.suffix == ".py" or path.is_file():
        return _of_file(path)
    for kind, catalogues in CATALOGUES.items():
        if any(asked in each for each in catalogues):
            return [Subject(kind, asked, "", _names(catalogues))]
    known = ", ".join(name for catalogues in CATALOGUES.values() for name in _names(catalogues))
    raise UsageError(f"{asked!r} must be a file that ends in .py, or one of {known}")


def element(name: str) -> Mapping[str, str]:
    """The settings of an element option: a thickness strain, or a preset."""
    return {"thickness_strain": name} if name in THICKNESS_STRAINS else PRESETS[name]


def _of_file(path: Path) -> list[Subject]:
    before = {kind: [dict(each) for each in catalogues] for kind, catalogues in CATALOGUES.items()}
    scenes = len(SCENES)
    load_file(path.resolve())
    found = []
    for kind, catalogues in CATALOGUES.items():
        ours = _names(before[kind])
        for kept, now in zip(before[kind], catalogues, strict=True):
            for name, part in now.items():
                if name not in kept:
                    found.append(Subject(kind, name, str(path), ours))
                elif kept[name] is not part:
                    raise UsageError(f"plug-in {path}: {name!r} is a part of ours; give it another name")
    for each in found:
        _check(path, each)
    if not found:
        more = "only scenes, which have no card" if len(SCENES) > scenes else "nothing to any catalogue"
        raise UsageError(f"plug-in {path}: it adds {more}: no algorithm, measure, element option or QP solver")
    return found


def _check(path: Path, subject: Subject) -> None:
    """Raises UsageError for an entry that is not what its catalogue holds; who loads a file has checked the others."""
    if subject.kind == SOLVER and not isinstance(SOLVERS[subject.name], Solver):
        raise UsageError(f"plug-in {path}: {subject.name!r} of SOLVERS must be a studies.arena.solvers.base.Solver")
    if subject.kind == SOLVER:
        try:
            pickle.dumps(SOLVERS[subject.name])
        except Exception as error:  # pickle raises whatever it meets
            said = f"{subject.name!r} cannot be sent to the process that solves"
            raise UsageError(f"plug-in {path}: {said}: {error}") from error
    share = THICKNESS_STRAINS.get(subject.name, 0.0) if subject.kind == ELEMENT else 0.0
    if not (isinstance(share, float | int) and 0 <= share <= 1):
        raise UsageError(f"plug-in {path}: the share {subject.name!r} = {share!r} must be a number in [0, 1]")


def _names(catalogues: Iterable[Mapping[str, Any]]) -> tuple[str, ...]:
    return tuple(name for each in catalogues for name in each)


def write_layout(directory: Path) -> list[Path]:
    """Write the layout of a repository that hands in an algorithm, and return its files.

    Raises UsageError unless the directory is empty, or none yet.
    """
    if directory.exists() and (not directory.is_dir() or any(directory.iterdir())):
        raise UsageError(f"--template {directory} must be an empty directory, or none yet")
    written = []
    for name, place in LAYOUT.items():
        path = directory / place / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(TEMPLATE.joinpath(name).read_bytes())
        written.append(path)
    return sorted(written)


# --- tries ------------------------------------------------------------------------------------------------------------


@dataclass
class Field:
    """Who is tried in turn, each for LIMIT_S at most; the newcomer only as long as it has anything left of BUDGET_S."""

    names: Sequence[str]
    newcomer: str
    left_s: float = BUDGET_S

    def take(self, name: str, attempt: Callable[[float], Ended]) -> Ended:
        """One try, if there is any time for it."""
        if name != self.newcomer:
            return attempt(LIMIT_S)
        if self.left_s <= 0:
            return Ended(LATE, f"not begun: {BUDGET_S:g} s were spent before")
        seconds, found = timed(partial(attempt, min(LIMIT_S, self.left_s)), time.monotonic)
        self.left_s -= seconds
        return found


def trials(subject: Subject, tell: Tell) -> Iterator[Trial]:
    """Of the newcomer and of ours."""
    run = {ALGORITHM: _algorithms, SOLVER: _solvers}.get(subject.kind, _parts)
    return run(subject, tell)


# --- algorithms -----------------------------------------------------------------------------------------------------


def _algorithms(subject: Subject, tell: Tell) -> Iterator[Trial]:
    """Each on each problem; on a scene the right answer is the first by an algorithm of EXACT."""
    everyone = [*(name for name in subject.ours if name != subject.name), subject.name]
    field, epsilons = Field(everyone, subject.name), {name: epsilon_of(name) for name in everyone}
    problems = {name: list(posed(epsilon)) for name, epsilon in epsilons.items()}
    for i, first in enumerate(problems[subject.name]):
        tell(first.name)
        for name in everyone:
            case = problems[name][i]
            yield against(name, case, field.take(name, partial(alone, name, case)), _made(name, epsilons[name], case))
    for scene in (*SMALL, *POINTS):
        tell(scene.name)
        right: Answer | None = None
        for name in sorted(everyone, key=lambda each: (each == subject.name, each not in EXACT)):
            found = field.take(name, partial(asked, scene, contact=name))
            yield against(name, scene, found, right if math.isinf(epsilons[name]) else None)
            if right is None and name in EXACT and found.ended == SOLVED:
                right = found.answer


def _made(name: str, epsilon: float, case: Posed) -> Answer | None:
    """The answer of a problem; of a frozen one it is that of the exact constraint."""
    if case.step is not None and math.isfinite(epsilon):
        return None
    return Answer(case.problem, case.answer, ALGORITHMS[name](epsilon=epsilon))


# --- measures and elements --------------------------------------------------------------------------------------------


def _parts(subject: Subject, tell: Tell) -> Iterator[Trial]:
    """Each measure, or element option, by an algorithm; the newcomer by a second one, which must agree."""
    reference, mine = REFERENCE[subject.kind], subject.name
    names = dict.fromkeys([reference, *subject.ours, mine])
    field = Field(sorted(names, key=lambda name: (name == mine, name != reference)), mine)
    options = {name: {"measure": name} if subject.kind == MEASURE else element(name) for name in names}
    for scene in (*BENT, *SMALL, *POINTS):
        tell(scene.name)
        usual: Answer | None = None
        for name in field.names:
            found = field.take(name, partial(asked, scene, contact=EXACT[0], part=options[name]))
            second = None
            if name == mine and found.answer is not None and len(found.answer.problem.weights):
                second = field.take(name, partial(asked, scene, contact=EXACT[1], part=options[name])).answer
            if name == reference:
                usual = found.answer
            yield against(name, scene, found, second, usual)


# --- solvers --------------------------------------------------------------------------------------------------------


def _solvers(subject: Subject, tell: Tell) -> Iterator[Trial]:
    """In a process of their own, which is killed when it takes too long; judged from the file alone."""
    everyone = [SOLVERS[name] for name in (*(each for each in BESIDE if each != subject.name), subject.name)]
    killed = Counter[str]()
    with closing(Child(SOLVER_LIMIT_S)) as child:
        for case in posed(math.inf):
            tell(case.name)
            step = frozen_of(case)
            scales = Scales.of(step)
            for tolerance, solver in product(TOLERANCES, everyone):
                name = f"{case.name} to {tolerance:g}"
                refused = solver.missing() or solver.applies(step)
                if refused is not None:
                    yield Trial(solver.name, case.group, name, REFUSED, refused)
                elif killed[solver.name] >= PATIENCE:
                    yield Trial(solver.name, case.group, name, LATE, f"not begun: killed {PATIENCE} times before")
                else:
                    said, _ = child.solve(solver, step, tolerance)
                    killed[solver.name] += bool(np.isnan(said.seconds))
                    worth = judged(said, step, tolerance, scales)
                    yield _row(solver.name, case, name, said, worth)


def _row(who: str, case: Posed, name: str, said: Said, worth: Mapping[str, object]) -> Trial:
    """Of an answer; where it is as accurate as was asked, its distance is what the problem makes of that."""
    spent: dict[str, Any] = {"iterations": said.iterations, "seconds": said.seconds}
    if np.isnan(said.seconds):
        return Trial(who, case.group, name, LATE, said.reason)
    if not said.claimed:
        return Trial(who, case.group, name, FAILED, said.reason, **spent)
    accuracy = float(str(worth["accuracy"]))
    if worth["false"]:
        return Trial(who, case.group, name, FALSE, f"its accuracy is {accuracy:.1e}", **spent)
    found = ContactSolution(said.du, said.pressure, said.pressure > 0, Outcome.CONVERGED)
    algorithm = ALGORITHMS["semismooth"]()
    apart = difference(*(Answer(case.problem, state, algorithm) for state in (case.answer, found)))
    agreement = AGREES if apart <= ALIKE else f"as accurate as asked, {accuracy:.1e}: apart by {apart:.1e}"
    return Trial(who, case.group, name, SOLVED, "", **spent, apart=apart, agreement=agreement)

"""The subject of a card and its trials, kind by kind: the new part and ours, one problem after another.

The subject is a part that a file adds to a catalogue, or one of ours by its name. The results are not evaluated here.
The new part has BUDGET_S in all and LIMIT_S per trial, processor time; trials that are left when the budget is spent
are not started.
"""

from __future__ import annotations

import math
import pickle
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, MutableMapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from importlib.resources import files
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.interchange.linearised_step import FrozenStep
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
    RAISED,
    REFUSED,
    SOLVED,
    Ended,
    Trial,
    against,
    alone,
    asked,
    epsilon_of,
    guarded,
)
from studies.arena.solver_table import judged
from studies.arena.solvers.base import Answer as SolverAnswer
from studies.arena.solvers.base import Solver
from studies.arena.solvers.catalogue import SOLVERS
from studies.arena.solvers.process import DIED, Child
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
CATALOGUES: dict[str, tuple[MutableMapping[str, Any], ...]] = {
    ALGORITHM: (ALGORITHMS,),
    MEASURE: (MEASURES,),
    SOLVER: (SOLVERS,),
    ELEMENT: (THICKNESS_STRAINS, PRESETS),
}
LIMIT_S, BUDGET_S = 10.0, 60.0
TOLERANCES = (1e-6, 1e-8)
SOLVER_LIMIT_S, PATIENCE = 5.0, 3  # of processor time; number of kills after which a solver is not run any more
BESIDE = ("semismooth", "Lemke", "condensed QP, finished", "OSQP, scaled", "Clarabel, scaled", "HiGHS, scaled")
REFERENCE = {ALGORITHM: "semismooth", MEASURE: "exact", SOLVER: "semismooth", ELEMENT: "balanced"}  # of ratios of cost
EXACT = ("semismooth", "lcp")  # their answer is the reference on a scene
Tell = Callable[[str], None]


@dataclass(frozen=True)
class Subject:
    """A part by kind and name; file: its source, or empty; ours: the parts of its kind in the suite."""

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
    added = []
    for kind, catalogues in CATALOGUES.items():
        ours = _names(before[kind])
        for kept, now in zip(before[kind], catalogues, strict=True):
            for name, part in now.items():
                if name not in kept:
                    added.append(Subject(kind, name, str(path), ours))
                elif kept[name] is not part:
                    raise UsageError(f"plug-in {path}: {name!r} is a part of ours; give it another name")
    for each in added:
        _check(path, each)
    if not added:
        more = "only scenes, which have no card" if len(SCENES) > scenes else "nothing to any catalogue"
        raise UsageError(f"plug-in {path}: it adds {more}: no algorithm, measure, element option or QP solver")
    return added


def _check(path: Path, subject: Subject) -> None:
    """Raises UsageError for an invalid entry of a catalogue; the loader of the file has checked the other kinds."""
    if subject.kind == SOLVER and not isinstance(SOLVERS[subject.name], Solver):
        raise UsageError(f"plug-in {path}: {subject.name!r} of SOLVERS must be a studies.arena.solvers.base.Solver")
    if subject.kind == SOLVER:
        try:
            pickle.dumps(SOLVERS[subject.name])
        except Exception as error:  # pickle raises exceptions of any type
            message = f"{subject.name!r} cannot be sent to the process that solves"
            raise UsageError(f"plug-in {path}: {message}: {error}") from error
    share = THICKNESS_STRAINS.get(subject.name, 0.0) if subject.kind == ELEMENT else 0.0
    if not (isinstance(share, float | int) and 0 <= share <= 1):
        raise UsageError(f"plug-in {path}: the share {subject.name!r} = {share!r} must be a number in [0, 1]")


def _names(catalogues: Iterable[Mapping[str, Any]]) -> tuple[str, ...]:
    return tuple(name for each in catalogues for name in each)


def write_layout(directory: Path) -> list[Path]:
    """Write the layout of a repository that submits an algorithm, and return its files.

    Raises UsageError unless the directory is empty or does not exist.
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


# --- trials -----------------------------------------------------------------------------------------------------------


@dataclass
class Field:
    """The parts in turn, each for LIMIT_S at most; the new one only while some of its BUDGET_S is left."""

    names: Sequence[str]
    newcomer: str
    left_s: float = BUDGET_S

    def take(self, name: str, attempt: Callable[[float], Ended]) -> Ended:
        """One trial, if time is left for it."""
        if name != self.newcomer:
            return attempt(LIMIT_S)
        if self.left_s <= 0:
            return Ended(LATE, f"not begun: {BUDGET_S:g} s were spent before")
        seconds, result = timed(partial(attempt, min(LIMIT_S, self.left_s)))
        self.left_s -= seconds
        return result


def trials(subject: Subject, tell: Tell) -> Iterator[Trial]:
    """The trials of the new part and of ours."""
    run = {ALGORITHM: _algorithms, SOLVER: _solvers}.get(subject.kind, _parts)
    return run(subject, tell)


# --- algorithms -----------------------------------------------------------------------------------------------------


def _algorithms(subject: Subject, tell: Tell) -> Iterator[Trial]:
    """Each algorithm on each problem; on a scene the reference is the first answer by an algorithm of EXACT."""
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
            result = field.take(name, partial(asked, scene, contact=name))
            yield against(name, scene, result, right if math.isinf(epsilons[name]) else None)
            if right is None and name in EXACT and result.ended == SOLVED:
                right = result.answer


def _made(name: str, epsilon: float, case: Posed) -> Answer | None:
    """The known answer of a problem; that of a frozen one belongs to the exact constraint."""
    if case.step is not None and math.isfinite(epsilon):
        return None
    return Answer(case.problem, case.answer, ALGORITHMS[name](epsilon=epsilon))


# --- measures and elements --------------------------------------------------------------------------------------------


def _parts(subject: Subject, tell: Tell) -> Iterator[Trial]:
    """Each measure, or element option, with one algorithm; the new one with a second one, too, which must agree."""
    reference, mine = REFERENCE[subject.kind], subject.name
    names = dict.fromkeys([reference, *subject.ours, mine])
    field = Field(sorted(names, key=lambda name: (name == mine, name != reference)), mine)
    options = {name: {"measure": name} if subject.kind == MEASURE else element(name) for name in names}
    for scene in (*BENT, *SMALL, *POINTS):
        tell(scene.name)
        usual: Answer | None = None
        for name in field.names:
            result = field.take(name, partial(asked, scene, contact=EXACT[0], part=options[name]))
            second = None
            if name == mine and result.answer is not None and len(result.answer.problem.weights):
                second = field.take(name, partial(asked, scene, contact=EXACT[1], part=options[name])).answer
            if name == reference:
                usual = result.answer
            yield against(name, scene, result, second, usual)


# --- solvers --------------------------------------------------------------------------------------------------------


def _solvers(subject: Subject, tell: Tell) -> Iterator[Trial]:
    """In a separate process, which is killed at the time limit; judged from the file alone."""
    everyone = [SOLVERS[name] for name in (*(each for each in BESIDE if each != subject.name), subject.name)]
    killed = Counter[str]()
    with closing(Child(SOLVER_LIMIT_S)) as child:
        for case in posed(math.inf):
            tell(case.name)
            step = frozen_of(case)
            scales = Scales.of(step)
            for tolerance, solver in product(TOLERANCES, everyone):
                name = f"{case.name} to {tolerance:g}"
                refused = guarded(partial(_asked, solver, step), LIMIT_S)
                if refused.ended:
                    yield Trial(solver.name, case.group, name, refused.ended, refused.reason)
                elif killed[solver.name] >= PATIENCE:
                    yield Trial(solver.name, case.group, name, LATE, f"not begun: killed {PATIENCE} times before")
                else:
                    answer, _ = child.solve(solver, step, tolerance)
                    killed[solver.name] += bool(np.isnan(answer.seconds))
                    if (answer.du.shape, answer.pressure.shape) != (step.r.shape, step.gap.shape):
                        shapes = f"an answer of the shapes {answer.du.shape} and {answer.pressure.shape}"
                        yield Trial(solver.name, case.group, name, RAISED, shapes)
                        continue
                    if answer.reason == DIED:
                        yield Trial(solver.name, case.group, name, RAISED, DIED)
                        continue
                    worth = judged(answer, step, tolerance, scales)
                    yield _row(solver.name, case, name, answer, worth)


def _asked(solver: Solver, step: FrozenStep) -> Ended:
    """Whether it is there, and applies."""
    refused = solver.missing() or solver.applies(step)
    return Ended("") if refused is None else Ended(REFUSED, str(refused))


def _row(who: str, case: Posed, name: str, answer: SolverAnswer, worth: Mapping[str, object]) -> Trial:
    """The trial of an answer; where it is as accurate as required, its deviation is due to the problem."""
    spent: dict[str, Any] = {"iterations": answer.iterations, "seconds": answer.seconds}
    if np.isnan(answer.seconds):
        return Trial(who, case.group, name, LATE, answer.reason)
    if not answer.claimed:
        return Trial(who, case.group, name, FAILED, answer.reason, **spent)
    accuracy = float(str(worth["accuracy"]))
    if worth["false"]:
        return Trial(who, case.group, name, FALSE, f"its accuracy is {accuracy:.1e}", **spent)
    solution = ContactSolution(answer.du, answer.pressure, answer.pressure > 0, Outcome.CONVERGED)
    algorithm = ALGORITHMS["semismooth"]()
    apart = difference(*(Answer(case.problem, state, algorithm) for state in (case.answer, solution)))
    agreement = AGREES if apart <= ALIKE else f"as accurate as asked, {accuracy:.1e}: apart by {apart:.1e}"
    return Trial(who, case.group, name, SOLVED, "", **spent, apart=apart, agreement=agreement)

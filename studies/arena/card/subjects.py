"""Who a card is of: the parts that a file adds to a catalogue, or one of ours by its name; and a layout to begin with.

What a part is worth is not asked here.
"""

from __future__ import annotations

import pickle
import shutil
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.resources import as_file, files
from pathlib import Path
from typing import Any

from contact.catalogue import ALGORITHMS
from formulations.element.mixed import THICKNESS_STRAINS
from formulations.strains.catalogue import MEASURES
from studies.arena.solvers.base import Solver
from studies.arena.solvers.catalogue import SOLVERS
from studies.ask.scene import UsageError
from studies.scenes import SCENES
from studies.scenes.element import PRESETS
from studies.scenes.plugins import load_file

TEMPLATE = "template"
ALGORITHM, MEASURE, SOLVER, ELEMENT = "contact algorithm", "strain measure", "QP solver", "element option"
CATALOGUES: dict[str, tuple[dict[str, Any], ...]] = {
    ALGORITHM: (ALGORITHMS,),
    MEASURE: (MEASURES,),
    SOLVER: (SOLVERS,),
    ELEMENT: (THICKNESS_STRAINS, PRESETS),
}


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
    with as_file(files("studies.arena.card").joinpath(TEMPLATE)) as source:
        shutil.copytree(source, directory, ignore=shutil.ignore_patterns("__pycache__"), dirs_exist_ok=True)
    return sorted(path for path in directory.rglob("*") if path.is_file())

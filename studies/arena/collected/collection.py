"""The files of the collection: written, compared with the manifest in the suite, and regenerated from it.

Contents are compared by sums that are insensitive to rounding. Which steps are taken, and how each is regenerated, is
decided in :mod:`.rule` and :mod:`.frictional`, which define one collection each.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from importlib.resources import files
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
import pandas as pd

from contact.interchange.linearised_step import FrozenFrictionalStep, FrozenStep, FrozenStepError
from studies.output.atomic import write_by, write_table, write_text

HERE = files("studies.arena.collected")
LICENCE = "MIT"
VERSION = 2  # of the collection: another choice of problems is another version
ROUNDING = 1e-6  # relative, of the sums: effect of different rounding along paths of Newton's method
SUMS = ("sum_K", "sum_r", "sum_G", "sum_gap")  # identify a file
FRICTION_SUMS = ("sum_S", "sum_slip", "sum_mu")  # and these, too, one with friction
LEFT_OUT = ["name", "family", "why"]
KEPT = files("studies.arena").joinpath("kept")  # folder of the files that are shipped
FORMAT = "format.md"  # description of the files
TUNE, TEST = "tune", "test"
SALT = 2  # the first with which both splits have each kind of matrix
FIFTH = 5  # one source in so many is for tuning
FORM = re.compile(r"-(touching|condensed)$")
ITERATE = re.compile(r"-s\d+(i\d+)?$")
MESH = re.compile(r"-\d+x\d+(?=-|$)")
POINTS = re.compile(r"-\d+$")  # of a published problem
Tell = Callable[[str], None]
Step = TypeVar("Step", FrozenStep, FrozenFrictionalStep)


def silent(name: str) -> None:
    """No progress report."""


@dataclass(frozen=True, eq=False)
class Candidate(Generic[Step]):
    """A step that may be taken: its family, its name in the collection, its origin, and its licence.

    states: of a touching form the candidates (m,) that are pressed and raised, else None.
    """

    family: str
    name: str
    origin: dict[str, Any]
    step: Step
    licence: str = LICENCE
    states: np.ndarray | None = None


def sums(step: FrozenStep) -> dict[str, float]:
    """Norms of K, r, G and gap, with friction of S, slip and mu: they identify a problem on another machine."""
    norms = _norms(SUMS, step.K.data, step.r, step.G.data, step.gap)
    if isinstance(step, FrozenFrictionalStep):
        norms |= _norms(FRICTION_SUMS, step.S.data, step.slip, step.mu)
    return norms


def _norms(names: tuple[str, ...], *parts: np.ndarray) -> dict[str, float]:
    return {name: float(np.linalg.norm(part)) for name, part in zip(names, parts, strict=True)}


@dataclass(frozen=True)
class Collection(Generic[Step]):
    """The steps without friction, or those with it.

    manifest_file, left_out_file: names.  read: a file; raises FrozenStepError.  sizes: of a row of the manifest and a
    step, reference sizes for sums that are small differences.  again: regenerates the candidates of some rows.
    """

    manifest_file: str
    left_out_file: str
    read: Callable[[Path], Step]
    sizes: Callable[[Mapping[Hashable, Any], Step], Mapping[str, float]]
    again: Callable[[pd.DataFrame], Iterator[Candidate[Step]]]

    def manifest(self) -> pd.DataFrame:
        """As shipped with the suite: traits, the algorithm of the answer and what confirms it, sums of the file."""
        return _kept(self.manifest_file)

    def left_out(self) -> pd.DataFrame:
        """The candidates left out when the manifest was made: name, family, why."""
        return _kept(self.left_out_file)

    def unlike(self, directory: Path, kept: pd.DataFrame) -> list[str]:
        """Missing files and differences from the manifest, one line each, which begins with the name."""
        lines = []
        for row in kept.to_dict("records"):
            path = directory / f"{row['name']}.npz"
            if not path.exists():
                lines.append(f"{row['name']}: missing")
                continue
            try:
                step = self.read(path)
            except FrozenStepError as error:
                lines.append(f"{row['name']}: {error}")
            else:
                lines += _differing(row, step, self.sizes(row, step))
        return lines

    def make(self, directory: Path, kept: pd.DataFrame, tell: Tell = silent) -> None:
        """Write the manifest and its files; existing files that agree with it are not written again."""
        missing = {line.partition(":")[0] for line in self.unlike(directory, kept)}
        for name in sorted(missing & kept_names()):
            write_by(directory / f"{name}.npz", partial(_copy_kept, name))
            missing.remove(name)
        for candidate in self.again(kept[kept["name"].isin(missing)]):
            tell(candidate.name)
            if candidate.name in missing:
                write(directory, candidate)
        self._finish(directory, kept)

    def write_choice(self, directory: Path, rows: list[dict[str, Any]], gone: list[dict[str, str]]) -> pd.DataFrame:
        """Write the rows that a rule has taken and those that it has left out; returns the manifest."""
        table = pd.DataFrame(rows)
        write_table(directory / self.left_out_file, pd.DataFrame(gone, columns=LEFT_OUT))
        self._finish(directory, table)
        return table

    def _finish(self, directory: Path, table: pd.DataFrame) -> None:
        write_table(directory / self.manifest_file, table)
        write_text(directory / FORMAT, HERE.joinpath(FORMAT).read_text(encoding="utf-8"))


def write(directory: Path, candidate: Candidate[Step]) -> Path:
    """The file of a problem, without its answer."""
    path = directory / f"{candidate.name}.npz"
    head = {"name": candidate.name, "family": candidate.family, "licence": candidate.licence, **candidate.origin}
    write_by(path, replace(candidate.step, meta=head | {"collection_version": VERSION}).write)
    return path


def kept_names() -> set[str]:
    """Of the problems whose files are shipped with the suite: another machine would not reproduce them.

    Rounding grows to more than 1e-8 along their paths.
    """
    return {path.name.removesuffix(".npz") for path in KEPT.iterdir() if path.name.endswith(".npz")}


def _copy_kept(name: str, path: Path) -> None:
    path.write_bytes(KEPT.joinpath(f"{name}.npz").read_bytes())


def _kept(name: str) -> pd.DataFrame:
    with HERE.joinpath(name).open(encoding="utf-8") as file:
        table = pd.read_csv(file, keep_default_na=False)
    return table.assign(split=table["name"].map(split_of))


def split_of(name: str) -> str:
    """The split of a problem, TUNE or TEST, by a hash of its source.

    A scene with its settings, or a published source, is in one of the two with all its meshes, loads, iterates and
    derived forms, so that no matrix of one split is nearly the same as one of the other.
    """
    source = name
    for each in (FORM, ITERATE, MESH, POINTS):
        source = each.sub("", source)
    return TUNE if int(hashlib.sha256(f"{SALT} {source}".encode()).hexdigest(), 16) % FIFTH == 0 else TEST


def _differing(row: Mapping[Hashable, Any], step: FrozenStep, sizes: Mapping[str, float]) -> list[str]:
    """Differences between a row of the manifest and a step, one line each; sums are compared relative to their size."""
    if (len(step.r), len(step.gap)) != (row["unknowns"], row["candidates"]):
        return [f"{row['name']}: of another size"]
    lines = []
    for name, own in sums(step).items():
        kept = float(row[name])
        if not abs(own - kept) <= ROUNDING * max(abs(kept), sizes.get(name, 0.0)):
            lines.append(f"{row['name']}: {name} is {own!r}, the manifest says {kept!r}")
    return lines

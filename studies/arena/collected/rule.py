"""The collection of frozen contact problems: by which rule they are chosen, how the files are made and checked again.

The rule. Published problems come first, then paths in their order, small before large. A step is taken when three
things hold: its answer is certified by two ways (:mod:`.certified`); no step taken before from the same scene has the
same classes of size, candidates, share pressed, kind of matrix, coupling, condition and touching (:mod:`.traits`); and
its file still fits in the size of the whole collection. A step that is taken offers its derived forms, candidates that
touch without pressure and the dual in its forces, each a family of its own. The column ``adds`` of the manifest says of
which class a step is the first.

The rule leaves out what neither way certifies, and so favours those who solve as the first way does; every such step is
named with its reason beside the manifest.

Then the files are made once more with other kernels of BLAS and other instructions, and only what agrees stays: a path
of an indefinite tangent may be turned elsewhere by the last digit. The manifest is kept with the suite; the files are
made from it by one command. What they hold is compared by sums that rounding moves little.
What another machine would not make again is kept as arrays (:mod:`.kept`). No solver is judged here.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from contact.interchange.linearised_step import FrozenStep, FrozenStepError
from studies.arena.collected import paths as listed
from studies.arena.collected.candidates import (
    CONDENSED,
    TOUCHING,
    Candidate,
    condensed,
    derived,
    form_of,
    on_path,
    published,
    touching,
)
from studies.arena.collected.candidates import candidates as all_candidates
from studies.arena.collected.certified import Certified, NotCertifiedError, confirm, find
from studies.arena.collected.kept import copy_kept, kept_names, raised_states, write_states
from studies.arena.collected.traits import Traits, traits
from studies.store.atomic import write_by, write_table, write_text

MANIFEST, LEFT_OUT, FORMAT = "manifest.csv", "left-out.csv", "format.md"
VERSION = 1  # of the collection: another choice of problems is another version
LARGEST = 100e6  # bytes of all files
MOST = 8e6  # bytes of one of them
ENTRY = 7.0  # bytes of an entry of a matrix in a compressed file, measured: 4 to 8
SUMS = ("sum_K", "sum_r", "sum_G", "sum_gap")  # what a file is recognised by
ROUNDING = 1e-6  # relative, of those sums: what paths of Newton's method make of different rounding
TURNED = "with other kernels of BLAS its path leads elsewhere"
CLASSES = ("unknowns", "candidates", "share pressed", "kind", "coupling", "condition", "touching")


def _silent(line: str) -> None:
    """Nothing is told."""


@dataclass(frozen=True, eq=False)
class Taken:
    """A candidate with its answer and traits, and the class that it is the first of."""

    candidate: Candidate
    answer: Certified
    traits: Traits
    adds: str

    @property
    def row(self) -> dict[str, Any]:
        """Of the manifest, but for the size of the file."""
        step, forces = self.candidate.step, self.candidate.step.problem().nodal_forces(self.answer.pressure)
        told = {"name": self.candidate.name, "family": self.candidate.family, "adds": self.adds, **self.traits.told}
        told |= {"force_N": float(forces.sum()), "displacement_mm": float(np.max(np.abs(self.answer.du), initial=0.0))}
        told |= {"found_by": self.answer.found_by, "confirmed_by": " and ".join(self.answer.confirmed_by)}
        told |= {"licence": self.candidate.licence, **dict(zip(SUMS, sums(step), strict=True))}
        return told | self.candidate.origin


@dataclass(eq=False)
class Rule:
    """The rule at work: classes seen in each family, bytes spent, and what was left out although it is new."""

    largest: float = LARGEST
    seen: dict[str, set[tuple[object, ...]]] = field(default_factory=dict)
    spent: float = 0.0
    left_out: list[dict[str, str]] = field(default_factory=list)

    def taken(self, candidate: Candidate) -> Taken | None:
        """The candidate with its answer, where the rule takes it."""
        step, before = candidate.step, self.seen.setdefault(candidate.family, set())
        size = ENTRY * (step.K.nnz + step.G.nnz)
        if not len(step.gap):
            return None
        try:
            if size > MOST or self.spent + size > self.largest:
                raise NotCertifiedError(f"{size / 1e6:.1f} MB are too many")
            first = find(step)
            own = traits(step, first)
            if own.classes in before:
                return None
            answer = confirm(step, first, own.condition)
        except ArithmeticError as error:  # NotCertifiedError, and what a singular step raises
            self.left_out.append({"name": candidate.name, "family": candidate.family, "why": str(error)})
            return None
        found = Taken(candidate, answer, own, _news(own.classes, before))
        before.add(own.classes)
        self.spent += size
        return found


def _news(classes: tuple[object, ...], before: set[tuple[object, ...]]) -> str:
    """In which class nothing was before in the family, or that the combination is new."""
    new = [name for i, name in enumerate(CLASSES) if all(other[i] != classes[i] for other in before)]
    return ", ".join(new) if before and new else "combination" if before else "family"


def chosen(found: Iterable[Candidate], rule: Rule, tell: Callable[[str], None] = _silent) -> Iterator[Taken]:
    """Those that the rule takes, in their order, each followed by those of its derived forms that it takes, too."""
    for candidate in found:
        tell(candidate.name)
        taken = rule.taken(candidate)
        if taken is not None:
            yield taken
            for form in derived(candidate, taken.answer):
                again = rule.taken(form)
                if again is not None:
                    yield again


def choose(directory: Path, tell: Callable[[str], None] = _silent, only: str = "") -> pd.DataFrame:
    """Apply the rule: write all files, the manifest and what was left out; only: the scene of paths, default all."""
    wanted = [path for path in listed.paths() if only in ("", path.scene)]
    rule = Rule()
    rows, states = [], {}
    for taken in chosen(all_candidates(wanted), rule, tell):
        rows.append(_written(directory, taken))
        if taken.candidate.states is not None:
            states[taken.candidate.name] = taken.candidate.states
    table = pd.DataFrame(rows)
    write_states(directory, states)
    write_table(directory / LEFT_OUT, pd.DataFrame(rule.left_out, columns=["name", "family", "why"]))
    _finish(directory, table)
    return table


def _written(directory: Path, taken: Taken) -> dict[str, Any]:
    path = write(directory, taken.candidate)
    return taken.row | {"bytes": path.stat().st_size}


def write(directory: Path, candidate: Candidate) -> Path:
    """The file of a problem, without its answer."""
    path = directory / f"{candidate.name}.npz"
    head = {"name": candidate.name, "family": candidate.family, "licence": candidate.licence, **candidate.origin}
    head |= {"collection_version": VERSION}
    write_by(path, FrozenStep(**{**vars(candidate.step), "meta": head}).write)
    return path


def _finish(directory: Path, table: pd.DataFrame) -> None:
    write_table(directory / MANIFEST, table)
    write_text(directory / FORMAT, files("studies.arena.collected").joinpath(FORMAT).read_text(encoding="utf-8"))


def make(directory: Path, kept: pd.DataFrame, tell: Callable[[str], None] = _silent) -> None:
    """Write the files of the kept manifest and the manifest; those that are there and as it says are left alone."""
    missing = {line.partition(":")[0] for line in unlike(directory, kept)}
    for name in sorted(missing & kept_names()):
        copy_kept(name, directory)
        missing.remove(name)
    states = raised_states()
    for candidate in _wanted(missing):
        tell(candidate.name)
        if candidate.name in missing:
            write(directory, candidate)
        for form in _forms(candidate, missing, states):
            tell(form.name)
            write(directory, form)
    _finish(directory, kept)


def _forms(candidate: Candidate, missing: set[str], states: Mapping[str, np.ndarray]) -> Iterator[Candidate]:
    """Its missing forms; none where nothing is known of who touches or it is not met, which ``unlike`` says then."""
    name = f"{candidate.name}-{TOUCHING}"
    if name in missing and name in states:
        with suppress(NotCertifiedError):
            yield form_of(candidate, TOUCHING, touching(candidate.step, states[name]))
    if f"{candidate.name}-{CONDENSED}" in missing:
        yield form_of(candidate, CONDENSED, condensed(candidate.step))


def _wanted(names: set[str]) -> Iterator[Candidate]:
    """Candidates that have one of the names, or of which a derived form has; other paths are not walked."""
    for candidate in published():
        if any(_is_of(name, candidate.name) for name in names):
            yield candidate
    for path in listed.paths():
        if any(name.startswith(f"{path.name}-s") for name in names):
            for candidate in on_path(path):
                if any(_is_of(name, candidate.name) for name in names):
                    yield candidate


def _is_of(name: str, base: str) -> bool:
    return name in {base, f"{base}-{TOUCHING}", f"{base}-{CONDENSED}"}


def sums(step: FrozenStep) -> tuple[float, ...]:
    """Norms of K, r, G and gap: what a problem is recognised by on another machine."""
    return tuple(float(np.linalg.norm(part)) for part in (step.K.data, step.r, step.G.data, step.gap))


def manifest() -> pd.DataFrame:
    """The manifest that is kept with the suite."""
    return _kept(MANIFEST)


def left_out() -> pd.DataFrame:
    """What the rule left out when the manifest was made: name, family, why."""
    return _kept(LEFT_OUT)


def _kept(name: str) -> pd.DataFrame:
    with files("studies.arena.collected").joinpath(name).open(encoding="utf-8") as file:
        return pd.read_csv(file, keep_default_na=False)


def unlike(directory: Path, kept: pd.DataFrame) -> list[str]:
    """What files lack or hold otherwise than the manifest says, a line each, which begins with the name."""
    lines = []
    for row in kept.to_dict("records"):
        path = directory / f"{row['name']}.npz"
        if not path.exists():
            lines.append(f"{row['name']}: missing")
            continue
        try:
            step = FrozenStep.read(path)
        except FrozenStepError as error:
            lines.append(f"{row['name']}: {error}")
            continue
        # what is in balance is known to its parts
        lines += differing(row, step, dict(zip(SUMS, sums(step), strict=True)), {"sum_r": step.scale})
    return lines


def differing(
    told: Mapping[Hashable, Any], step: FrozenStep, found: Mapping[str, float], sizes: Mapping[str, float]
) -> list[str]:
    """What a row of the manifest says otherwise than the sums that were ``found`` of a step, a line each.

    sizes: of what some of them are the difference of; those are known to so much.
    """
    if (len(step.r), len(step.gap)) != (told["unknowns"], told["candidates"]):
        return [f"{told['name']}: of another size"]
    lines = []
    for name, own in found.items():
        kept = float(told[name])
        if not abs(own - kept) <= ROUNDING * max(abs(kept), sizes.get(name, 0.0)):
            lines.append(f"{told['name']}: {name} is {own!r}, the manifest says {kept!r}")
    return lines


def keep_agreeing(directory: Path, kept: pd.DataFrame, to: Path) -> None:
    """Write the manifest of what files made elsewhere bear out; the other rows join those that are left out."""
    wrong = {line.partition(":")[0] for line in unlike(directory, kept)}
    other = kept["name"].isin(wrong)
    gone = kept.loc[other, ["name", "family"]].assign(why=TURNED)
    write_table(to / MANIFEST, kept[~other])
    write_table(to / LEFT_OUT, pd.concat([left_out(), gone], ignore_index=True))

"""The collection of frozen contact problems: by which rule they are chosen, how the files are made and checked again.

The rule. Paths are walked in their order, small before large. An iterate on a path is taken when three things hold:
its answer is certified by two ways (:mod:`studies.arena.certified`); no iterate taken before from the same scene has
the same classes of size, candidates, share pressed, kind of matrix, coupling, condition and touching
(:class:`studies.arena.traits.Traits`); and its file still fits in the size of the whole collection. The column ``adds``
of the manifest says which class it is the first of.

Files are made by one command, named and counted in the manifest that is kept with the suite; what they hold is compared
by sums that rounding moves little, because two machines round differently. No solver is judged here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from contact.interchange.linearised_step import FrozenStep
from studies.arena import paths as listed
from studies.arena.certified import Certified, confirm, find
from studies.arena.newton_path import Met, newton_path
from studies.arena.traits import Traits, traits
from studies.experiments.obstacle_problems.collection import CLASSICS, Bounded, classic, obstacle, torsion
from studies.store.atomic import write_by, write_table

MANIFEST = "manifest.csv"
LARGEST = 100e6  # bytes of all files
MOST = 8e6  # bytes of one of them
LICENCE = "MIT"
SUMS = ("sum_K", "sum_r", "sum_G", "sum_gap")  # what a file is recognised by
ROUNDING = 1e-6  # relative, of those sums: what paths of Newton's method make of different rounding
CLASSES = ("unknowns", "candidates", "share pressed", "kind", "coupling", "condition", "touching")


@dataclass(frozen=True, eq=False)
class Candidate:
    """A step that may be taken: its family, its name in it, where it is from."""

    family: str
    name: str
    origin: dict[str, Any]
    step: FrozenStep


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
        return {**told, **dict(zip(SUMS, sums(step), strict=True)), **self.candidate.origin}

    def write(self, path: Path) -> None:
        """The file of the problem, its answer aside."""
        step = self.candidate.step
        scales = {"force_N": step.scale, "displacement_mm": float(np.max(np.abs(self.answer.du), initial=0.0))}
        head = {"name": self.candidate.name, "licence": LICENCE, **self.candidate.origin, "scales": scales}
        write_by(path, FrozenStep(**{**vars(step), "meta": head}).write)


def sums(step: FrozenStep) -> tuple[float, ...]:
    """Norms of K, r, G and gap: what a problem is recognised by on another machine."""
    return tuple(float(np.linalg.norm(part)) for part in (step.K.data, step.r, step.G.data, step.gap))


def candidates(paths: Iterable[listed.Path]) -> Iterator[Candidate]:
    """Published problems, then the iterates along the paths; a path that cannot be asked for raises UsageError."""
    for body in published():
        family = body.name.split()[0]
        step = frozen(body)
        yield Candidate(family, body.name.replace(" ", "-").replace("=", ""), {"source": body.name}, step)
    for path in paths:
        solve: list[Met] = []
        for met in newton_path(path.scene, path.settings, path.mesh):
            if solve and met.solve != solve[0].solve:
                yield from _looked_at(path, solve)
                solve = []
            solve.append(met)
        yield from _looked_at(path, solve)


def _looked_at(path: listed.Path, solve: Sequence[Met]) -> Iterator[Candidate]:
    """All iterates of a solve, or its first ones and the last but one, from where a step still moves something."""
    chosen = range(len(solve)) if not path.looks else sorted({*range(path.looks - 1), len(solve) - 2})
    for i in chosen:
        if 0 <= i < len(solve):
            met = solve[i]
            origin = {"scene": path.scene, "mesh": path.mesh, "stage": met.stage, "target": met.target}
            origin |= {"settings": " ".join(f"{key}={value}" for key, value in path.settings.items())}
            origin |= {"solve": met.solve, "iteration": met.iteration, "arrived": met.arrived}
            yield Candidate(path.scene, f"{path.name}-s{met.solve}i{met.iteration}", origin, met.at.step)


def published() -> Iterator[Bounded]:
    """Obstacle problems and classics of linear complementarity, up to a hundred thousand unknowns."""
    for points in (5, 10, 23, 46):
        for name in ("OBSTCLAL", "OBSTCLBL"):
            yield obstacle(name, points)
        yield torsion(5.0, points)
        yield torsion(20.0, points)
    for points in (102, 318):
        yield small_die(points)
    for name in CLASSICS:
        for n in (3, 10, 30, 100):
            yield classic(name, n)


def small_die(points: int) -> Bounded:
    """The membrane of OBSTCLAL where only a square of 40 x 40 points in the middle may touch the obstacle."""
    whole = obstacle("OBSTCLAL", points)
    inner = np.arange(points - 2) - (points - 2) // 2
    near = np.logical_and.outer(np.abs(inner) < 20, np.abs(inner) < 20).ravel()
    low = np.where(near, whole.low, -math.inf)
    return Bounded(f"DIE {points}", whole.K, whole.f, low, whole.up, whole.start)


def frozen(body: Bounded) -> FrozenStep:
    """A body between bounds as a step from x = 0."""
    problem, zero = body.problem(), np.zeros(len(body.f))
    lin = problem.linearise(zero, None)
    return FrozenStep(body.K, lin.residual, problem.gap_jacobian(zero), problem.gap(zero), problem.weights, lin.scale)


def chosen(
    found: Iterable[Candidate], tell: Callable[[str], None] = lambda name: None, largest: float = LARGEST
) -> Iterator[Taken]:
    """Those that the rule takes, in their order; bytes are estimated by 12 an entry of the matrices."""
    seen: dict[str, set[tuple[object, ...]]] = {}
    spent = 0.0
    for candidate in found:
        tell(candidate.name)
        size = 12.0 * (candidate.step.K.nnz + candidate.step.G.nnz)
        if size > MOST or spent + size > largest or not len(candidate.step.gap):
            continue
        before = seen.setdefault(candidate.family, set())
        try:
            found_first = find(candidate.step)
            own = traits(candidate.step, found_first)
            if own.classes in before:
                continue
            answer = confirm(candidate.step, found_first)
        except ArithmeticError:  # NotCertifiedError, and what a singular step raises
            continue
        adds = _news(own.classes, before)
        before.add(own.classes)
        spent += size
        yield Taken(candidate, answer, own, adds)


def _news(classes: tuple[object, ...], before: set[tuple[object, ...]]) -> str:
    """In which class nothing was before in the family, or that the combination is new."""
    new = [name for i, name in enumerate(CLASSES) if all(other[i] != classes[i] for other in before)]
    return ", ".join(new) if before and new else "combination" if before else "family"


def make(directory: Path, tell: Callable[[str], None] = lambda name: None, only: str = "") -> pd.DataFrame:
    """Write all files and the manifest; only: the scene of the paths, default all."""
    wanted = [path for path in listed.paths() if only in ("", path.scene)]
    rows = []
    for taken in chosen(candidates(wanted), tell):
        path = directory / f"{taken.candidate.name}.npz"
        taken.write(path)
        rows.append(taken.row | {"bytes": path.stat().st_size})
    table = pd.DataFrame(rows)
    write_table(directory / MANIFEST, table)
    return table


def manifest() -> pd.DataFrame:
    """The manifest that is kept with the suite."""
    with files("studies.arena").joinpath(MANIFEST).open(encoding="utf-8") as file:
        return pd.read_csv(file, keep_default_na=False)


def unlike(directory: Path, kept: pd.DataFrame) -> list[str]:
    """What files lack or hold otherwise than the manifest says, a line each."""
    lines = []
    for row in kept.to_dict("records"):
        path = directory / f"{row['name']}.npz"
        if not path.exists():
            lines.append(f"{row['name']}: missing")
            continue
        step = FrozenStep.read(path)
        if (len(step.r), len(step.gap), step.K.nnz) != (row["unknowns"], row["candidates"], row["entries"]):
            lines.append(f"{row['name']}: of another size")
            continue
        for name, own in zip(SUMS, sums(step), strict=True):
            if not abs(own - row[name]) <= ROUNDING * max(abs(row[name]), math.ulp(1.0)):
                lines.append(f"{row['name']}: {name} is {own!r}, the manifest says {row[name]!r}")
    return lines

"""The rule of the collection: which frozen problems without friction are taken, and how they are regenerated.

The rule. Published problems come first, then paths in their order, small before large. A step is taken under three
conditions: its answer is certified by two methods (:mod:`.certified`); no step taken before from the same scene has the
same classes of size, candidates, share pressed, kind of matrix, coupling, condition and touching (:class:`Traits`); and
its file still fits in the size of the whole collection. A step that is taken offers its derived forms, candidates that
touch without pressure and the dual in its forces, each as a separate family. The column ``adds`` of the manifest names
the class of which a step is the first.

The rule leaves out steps that are not certified by both methods, which favours solvers similar to the first one; every
such step is listed with its reason beside the manifest.

Then the files are made again with other BLAS kernels and other instructions, and only those that agree are kept: on a
path with an indefinite tangent rounding may decide the branch. The manifest is shipped with the suite; one command
makes the files from it. No solver is judged here.

The pressed and raised candidates of each touching form are stored, as a step that is not convex has several answers,
and rounding decides which one is computed.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, onenormest, splu

from contact.interchange.linearised_step import FrozenStep
from contact.interchange.oracle import positive_definite
from contact.solvers.sparse import symmetric
from studies.arena.collected.candidates import (
    CONDENSED,
    TOUCHING,
    condensed,
    derived,
    form_of,
    on_path,
    paths,
    published,
    touching,
)
from studies.arena.collected.candidates import candidates as all_candidates
from studies.arena.collected.certified import Certified, NotCertifiedError, confirm, find
from studies.arena.collected.collection import HERE, LEFT_OUT, Candidate, Collection, Tell, silent, sums, write
from studies.output.atomic import write_by, write_table

RAISED_IN = "raised.npz"
LARGEST = 100e6  # bytes of all files
MOST = 8e6  # bytes of one of them
ENTRY = 7.0  # bytes of an entry of a matrix in a compressed file, measured: 4 to 8
TURNED = "with other kernels of BLAS its path leads elsewhere"
CLASSES = ("unknowns", "candidates", "share pressed", "kind", "coupling", "condition", "touching")
SIZES = (30, 100, 300, 1_000, 3_000, 10_000, 30_000)  # unknowns from which a new class begins
COUNTS = (3, 10, 30, 100, 300, 1_000)  # candidates
SHARES = (1e-12, 0.1, 0.4, 0.8, 1 - 1e-12)  # pressed of all candidates: none, few, some, many, nearly all, all


@dataclass(frozen=True)
class Traits:
    """Numbers of a step and of its answer.

    kind: of its matrix.  condition: of K with a unit diagonal, in the 1-norm, estimated; infinite where K is singular.
    pressed, touching: candidates that carry force, and that are closed without.
    """

    unknowns: int
    candidates: int
    entries: int
    kind: str
    coupling: str
    condition: float
    pressed: int
    touching: int

    @property
    def classes(self) -> tuple[object, ...]:
        """Two steps with the same classes count as duplicates."""
        share = self.pressed / max(self.candidates, 1)
        stiff = math.inf if math.isinf(self.condition) else math.floor(math.log10(self.condition) / 3)
        return (
            sum(self.unknowns >= bound for bound in SIZES),
            sum(self.candidates >= bound for bound in COUNTS),
            sum(share > bound for bound in SHARES),
            self.kind,
            self.coupling,
            stiff,
            self.touching > 0,
        )


def traits(step: FrozenStep, answer: Certified) -> Traits:
    """The traits of a step with a certified answer."""
    return Traits(
        len(step.r),
        len(step.gap),
        step.K.nnz,
        kind(step),
        "lumped" if step.coupling is None else "consistent",
        condition(step.K),
        int(answer.pressed.sum()),
        int(answer.touching.sum()),
    )


def kind(step: FrozenStep) -> str:
    """definite, indefinite (singular included) or not symmetric."""
    if not symmetric(step.K):
        return "not symmetric"
    return "definite" if positive_definite(step.K) else "indefinite"


def condition(K: sparse.csc_matrix) -> float:
    """|D K D|_1 |(D K D)^-1|_1 with D = |diag K|^-1/2, the second norm estimated (Higham, Tisseur 2000)."""
    diagonal = np.abs(K.diagonal())
    unit = sparse.diags_array(1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)))
    A = sparse.csc_matrix(unit @ K @ unit)
    try:
        factor = splu(A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=1e-3, options={"SymmetricMode": True})
    except RuntimeError:
        return math.inf
    inverse = LinearOperator(A.shape, matvec=factor.solve, rmatvec=partial(factor.solve, trans="T"), dtype=float)
    return float(abs(A).sum(axis=0).max() * onenormest(inverse))


@dataclass(frozen=True, eq=False)
class Taken:
    """A candidate with its answer and traits, and the class that it is the first of."""

    candidate: Candidate[FrozenStep]
    answer: Certified
    traits: Traits
    adds: str

    @property
    def row(self) -> dict[str, Any]:
        """A row of the manifest without the size of the file."""
        candidate, answer = self.candidate, self.answer
        force = float(candidate.step.problem().nodal_forces(answer.pressure).sum())
        row = {"name": candidate.name, "family": candidate.family, "adds": self.adds, **asdict(self.traits)}
        row |= {"force_N": force, "displacement_mm": float(np.max(np.abs(answer.du), initial=0.0))}
        row |= {"found_by": answer.found_by, "confirmed_by": " and ".join(answer.confirmed_by)}
        return row | {"licence": candidate.licence, **sums(candidate.step), **candidate.origin}


@dataclass(eq=False)
class Rule:
    """State of the selection: classes seen in each family, bytes spent, and new steps that were left out."""

    largest: float = LARGEST
    seen: dict[str, set[tuple[object, ...]]] = field(default_factory=dict)
    spent: float = 0.0
    left_out: list[dict[str, str]] = field(default_factory=list)

    def taken(self, candidate: Candidate[FrozenStep]) -> Taken | None:
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
            self.left_out.append(dict(zip(LEFT_OUT, (candidate.name, candidate.family, str(error)), strict=True)))
            return None
        accepted = Taken(candidate, answer, own, _news(own.classes, before))
        before.add(own.classes)
        self.spent += size
        return accepted


def _news(classes: tuple[object, ...], before: set[tuple[object, ...]]) -> str:
    """The classes that are new in the family, or that the combination is new."""
    new = [name for i, name in enumerate(CLASSES) if all(other[i] != classes[i] for other in before)]
    return ", ".join(new) if before and new else "combination" if before else "family"


def chosen(candidates: Iterable[Candidate[FrozenStep]], rule: Rule, tell: Tell = silent) -> Iterator[Taken]:
    """The candidates that the rule takes, in order, each followed by its derived forms that it takes."""
    for candidate in candidates:
        tell(candidate.name)
        taken = rule.taken(candidate)
        if taken is not None:
            yield taken
            for form in derived(candidate, taken.answer):
                again = rule.taken(form)
                if again is not None:
                    yield again


def choose(directory: Path, tell: Tell = silent, only: str = "") -> pd.DataFrame:
    """Apply the rule: write the files, the manifest and the list of those left out; only: a scene, default all."""
    rule, rows, states = Rule(), [], {}
    for taken in chosen(all_candidates(path for path in paths() if only in ("", path.scene)), rule, tell):
        candidate = taken.candidate
        rows.append(taken.row | {"bytes": write(directory, candidate).stat().st_size})
        if candidate.states is not None:
            states[candidate.name] = candidate.states
    write_by(directory / RAISED_IN, partial(_write_states, states))
    return STEPS.write_choice(directory, rows, rule.left_out)


def _write_states(states: Mapping[str, np.ndarray], path: Path) -> None:
    with path.open("wb") as file:
        np.savez_compressed(file, **states)  # type: ignore[arg-type]


def raised_states() -> dict[str, np.ndarray]:
    """The PRESSED and RAISED candidates of the step of each stored touching form."""
    with HERE.joinpath(RAISED_IN).open("rb") as file, np.load(file) as arrays:
        return {name: arrays[name] for name in arrays.files}


def _again(kept: pd.DataFrame) -> Iterator[Candidate[FrozenStep]]:
    """Candidates with one of the names, and derived forms with one of them; other paths are not followed.

    A form without stored states, or whose states do not fit, is omitted; ``unlike`` then reports it as missing.
    """
    names, states = set(kept["name"]), raised_states()
    ways = [published(), *(on_path(path) for path in paths() if _begins(names, path.name))]
    for candidate in (each for way in ways for each in way):
        touches, dual = f"{candidate.name}-{TOUCHING}", f"{candidate.name}-{CONDENSED}"
        if names & {candidate.name, touches, dual}:
            yield candidate
        if touches in names and touches in states:
            with suppress(NotCertifiedError):
                yield form_of(candidate, TOUCHING, touching(candidate.step, states[touches]))
        if dual in names:
            yield form_of(candidate, CONDENSED, condensed(candidate.step))


def _begins(names: Iterable[str], path: str) -> bool:
    return any(name.startswith(f"{path}-s") for name in names)


STEPS = Collection(
    "manifest.csv",
    "left-out.csv",
    FrozenStep.read,
    lambda row, step: {"sum_r": step.scale},  # accurate relative to the forces in balance
    _again,
)


def keep_agreeing(directory: Path, kept: pd.DataFrame, to: Path) -> None:
    """Write the manifest of the rows that files made elsewhere agree with; the others join those left out."""
    wrong = {line.partition(":")[0] for line in STEPS.unlike(directory, kept)}
    other = kept["name"].isin(wrong)
    gone = kept.loc[other, ["name", "family"]].assign(why=TURNED)
    write_table(to / STEPS.manifest_file, kept[~other])
    write_table(to / STEPS.left_out_file, pd.concat([STEPS.left_out(), gone], ignore_index=True))

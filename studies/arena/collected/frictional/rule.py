"""The frozen steps with friction that are kept: the rule, the manifest, and the files made from it again.

A step is taken when an algorithm has an answer that the judge takes and the equations on its states confirm it
(:mod:`.certified`); the oracle is a third way where it ends. All that are listed are asked, the others are named with
their reasons. The manifest stands beside that of the steps without friction, which it leaves alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from contact.coulomb import State
from contact.interchange.linearised_step import FrozenFrictionalStep, FrozenStepError
from studies.arena.collected.frictional.certified import FrictionCertified, confirm, find
from studies.arena.collected.frictional.steps import FAMILIES, FrictionalCandidate
from studies.arena.collected.rule import SUMS, VERSION, differing, sums
from studies.arena.collected.traits import condition, kind
from studies.store.atomic import write_by, write_table

MANIFEST, LEFT_OUT = "frictional.csv", "frictional-left-out.csv"
FRICTION_SUMS = (*SUMS, "sum_S", "sum_slip", "sum_mu")


def _silent(line: str) -> None:
    """Nothing is told."""


def friction_manifest() -> pd.DataFrame:
    """The manifest that is kept with the suite: traits, who found the answer and what confirms it, sums of the file."""
    return _kept(MANIFEST)


def friction_left_out() -> pd.DataFrame:
    """What was not certified when the manifest was made: name, family, why."""
    return _kept(LEFT_OUT)


def _kept(name: str) -> pd.DataFrame:
    with files("studies.arena.collected.frictional").joinpath(name).open(encoding="utf-8") as file:
        return pd.read_csv(file, keep_default_na=False)


def row(candidate: FrictionalCandidate) -> dict[str, Any]:
    """Of the manifest, but for the size of the file; raises NotCertifiedError."""
    step = candidate.step
    stiff = condition(step.K)
    answer = confirm(step, find(step), stiff)
    told = {"name": candidate.name, "family": candidate.family, "unknowns": len(step.r)}
    told |= {"candidates": len(step.mu), "entries": step.K.nnz, "kind": kind(step), "condition": stiff}
    told |= {"friction": "coulomb", "mu": float(np.max(step.mu)), **_states(answer)}
    told |= {"force_N": float(answer.known.normal.sum()), "friction_N": _size(answer.known.friction)}
    told |= {"displacement_mm": float(np.max(np.abs(answer.known.du), initial=0.0))}
    told |= {"found_by": answer.found_by, "confirmed_by": " and ".join(answer.confirmed_by)}
    told |= {"several": answer.several, "licence": candidate.licence}
    return told | dict(zip(FRICTION_SUMS, friction_sums(step), strict=True)) | candidate.origin


def _states(answer: FrictionCertified) -> dict[str, int]:
    """How many candidates are open, stick and slip."""
    count = np.bincount(answer.known.state, minlength=len(State))
    return dict(zip(("open", "sticking", "slipping"), map(int, count), strict=True))


def _size(friction: np.ndarray) -> float:
    """The sum of the sizes of friction [N]."""
    return float(np.sum(np.linalg.norm(friction, axis=1)))


def friction_sums(step: FrozenFrictionalStep) -> tuple[float, ...]:
    """Norms of K, r, G, gap, S, slip and mu: what a problem is recognised by on another machine."""
    more = (step.S.data, step.slip, step.mu)
    return (*sums(step), *(float(np.linalg.norm(part)) for part in more))


def choose_frictional(directory: Path, tell: Callable[[str], None] = _silent, only: str = "") -> pd.DataFrame:
    """Apply the rule: write all files, the manifest and what was left out; only: a family, default all."""
    rows, gone = [], []
    for candidate in _of(only):
        tell(candidate.name)
        try:
            found = row(candidate)
        except ArithmeticError as error:  # NotCertifiedError, and what a singular step raises
            gone.append({"name": candidate.name, "family": candidate.family, "why": str(error)})
            continue
        rows.append(found | {"bytes": write(directory, candidate).stat().st_size})
    write_table(directory / LEFT_OUT, pd.DataFrame(gone, columns=["name", "family", "why"]))
    write_table(directory / MANIFEST, pd.DataFrame(rows))
    return pd.DataFrame(rows)


def _of(family: str) -> Iterator[FrictionalCandidate]:
    for name, make in FAMILIES.items():
        if family in ("", name):
            yield from make()


def write(directory: Path, candidate: FrictionalCandidate) -> Path:
    """The file of a problem, without its answer."""
    path, step = directory / f"{candidate.name}.npz", candidate.step
    head = {"name": candidate.name, "family": candidate.family, "licence": candidate.licence, **candidate.origin}
    head |= {"collection_version": VERSION}
    write_by(path, replace(step, meta=head).write)
    return path


def make_frictional(directory: Path, kept: pd.DataFrame, tell: Callable[[str], None] = _silent) -> None:
    """Write the files of the kept manifest and the manifest; those that are there and as it says are left alone."""
    missing = {line.partition(":")[0] for line in unlike_frictional(directory, kept)}
    wanted = kept.loc[kept["name"].isin(missing), "family"]
    for family in dict.fromkeys(wanted):
        for candidate in FAMILIES[family]():
            if candidate.name in missing:
                tell(candidate.name)
                write(directory, candidate)
    write_table(directory / MANIFEST, kept)


def unlike_frictional(directory: Path, kept: pd.DataFrame) -> list[str]:
    """What files lack or hold otherwise than the manifest says, a line each, which begins with the name."""
    lines = []
    for told in kept.to_dict("records"):
        path = directory / f"{told['name']}.npz"
        if not path.exists():
            lines.append(f"{told['name']}: missing")
            continue
        try:
            step = FrozenFrictionalStep.read(path)
        except FrozenStepError as error:
            lines.append(f"{told['name']}: {error}")
            continue
        moved = float(told["displacement_mm"])
        sizes = {"sum_r": step.scale, "sum_gap": moved, "sum_slip": moved}
        lines += differing(told, step, dict(zip(FRICTION_SUMS, friction_sums(step), strict=True)), sizes)
    return lines

"""A sample of the collection made and certified, and the held-out tier drawn, with the kernels that this process has.

They are chosen when BLAS is loaded, so that others need another process: ``python -m support.problems.kernels DIR``
writes the files into DIR and prints what it found as JSON.
"""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from contact.interchange.linearised_step import FrozenStep
from studies.arena import held_out
from studies.arena.collected.certified import NotCertifiedError, confirm, find, rounding
from studies.arena.collected.collection import sums
from studies.arena.collected.rule import STEPS, traits

KEY = b"a secret of the tests"
LARGEST, EVERY = 3000, 10  # unknowns, problems
ILL = 1e11  # condition from where on the last digit decides where a path goes


@dataclass(frozen=True)
class Found:
    """product: a digest of one, which names the kernels. wrong: a line for what is not as the manifest says.

    held_out: by problem the sums of :func:`studies.arena.collected.collection.sums`.
    """

    product: str
    wrong: list[str]
    held_out: dict[str, dict[str, float]]


def sample() -> pd.DataFrame:
    """Every tenth problem of under 3,000 unknowns, and all of them whose stiffness is the worst."""
    kept = STEPS.manifest()
    kept = kept[kept["unknowns"] < LARGEST]
    return kept[kept["name"].isin(kept["name"].iloc[::EVERY]) | (kept["condition"] > ILL)]


def product() -> str:
    """Of two matrices, whose last digits are those of the kernels."""
    a = np.random.default_rng(0).random((300, 300))
    return hashlib.sha256((a @ a).tobytes()).hexdigest()


def wrong(directory: Path) -> list[str]:
    """What of the sample is made otherwise than the manifest says, or has another answer."""
    kept = sample()
    STEPS.make(directory, kept)
    lines = STEPS.unlike(directory, kept)
    for row in kept.to_dict("records"):
        try:
            why = _answered(row, FrozenStep.read(directory / f"{row['name']}.npz"))
        except NotCertifiedError as error:
            why = str(error)
        lines += [f"{row['name']}: {why}"] if why else []
    return lines


def _answered(row: dict, step: FrozenStep) -> str:
    """How the answer by two ways differs from that of the manifest; raises NotCertifiedError where they disagree.

    A convex problem has one answer, up to who touches within rounding. Another has several: which of them is found is
    a matter of the last digit, and each that both ways take is one.
    """
    first = find(step)
    own = traits(step, first)
    actual = confirm(step, first, own.condition)
    if own.kind != row["kind"]:
        return f"{own.kind}, not {row['kind']}"
    if own.kind != "definite":
        return ""
    forces, least = step.problem().nodal_forces(actual.pressure), rounding(own.condition)
    gap = step.gap + step.G @ actual.du
    sure = int(np.sum(forces > least * forces.max()))
    closed = gap <= least * max(np.abs(step.gap).max(), np.abs(gap).max())
    if not sure <= row["pressed"] <= np.sum(closed | (forces > 0)):
        return f"{sure} pressed surely, not {row['pressed']}"
    total = float(forces.sum())
    if abs(total - row["force_N"]) > max(1e-5, least) * abs(row["force_N"]):
        return f"{total!r} N, not {row['force_N']!r}"
    return ""


def drawn() -> dict[str, dict[str, float]]:
    """The sums of the held-out problems of the tests' secret."""
    return {name: sums(step) for name, step in held_out.problems(KEY).items()}


if __name__ == "__main__":
    print(json.dumps(vars(Found(product(), wrong(Path(sys.argv[1])), drawn()))))

"""What makes one frozen step unlike another: the classes by which steps are chosen and by which answers are sorted.

No step is solved here but for its condition; who solves it best may not enter.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, onenormest, splu

from contact.interchange.linearised_step import FrozenStep
from contact.interchange.oracle import positive_definite
from contact.solvers.sparse import symmetric
from studies.arena.collected.certified import Certified

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
    def told(self) -> dict[str, Any]:
        """As data."""
        return asdict(self)

    @property
    def classes(self) -> tuple[object, ...]:
        """Two steps with the same classes add nothing to each other."""
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

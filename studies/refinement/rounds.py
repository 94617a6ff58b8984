"""Rounds: a quantity on a grid and on the one with all its elements cut, and what they say of its limit.

Each round solves on a grid and on the one with all its elements cut, T and T'. Bilinear elements converge with the
square of their size, so that a round says of the limit::

    L = J' + (J' - J)/3

and two rounds with different grids say how well: L is within ::

    u = max(SAFETY |L - L_before|, |J' - J|/3, rim/2)

of the limit. The second term is all that Richardson's law adds: with nodes that hang on coarse elements T may be off by
more than four times what T' is. The third is half of what the rim of a patch of contact, which jumps from node to node,
has done from T to T'. A first round alone knows |J' - J|.
Nothing is solved here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from studies.analysis.richardson import correction
from studies.refinement.limits import SAFETY, Estimate


@dataclass(frozen=True)
class Round:
    """A quantity on a grid and on the one with all elements cut, and their unknowns.

    seconds: CPU time of the round; finer_seconds, own_seconds: of the finer grid and of the other alone, which may be
    that of the round before.  rim: what the rim of a patch of contact adds to the indicators.
    """

    value: float
    finer: float
    unknowns: int
    finer_unknowns: int
    seconds: float
    finer_seconds: float
    rim: float = 0.0
    own_seconds: float = 0.0

    @property
    def limit(self) -> float:
        """Richardson's for the order 2."""
        return self.finer + correction((2.0, 1.0), (self.value, self.finer))


def estimate(rounds: Sequence[Round]) -> Estimate:
    """What all rounds so far say of the limit."""
    last = rounds[-1]
    step = abs(last.finer - last.value)
    within = step if len(rounds) == 1 else max(SAFETY * abs(last.limit - rounds[-2].limit), step / 3, last.rim / 2)
    scale = abs(last.limit) or np.finfo(float).tiny
    return Estimate(last.limit, within / scale, abs(last.finer - last.limit) / scale)

"""A bar dragged over a plane under uniform pressure: partial slip, unloading and cycles in closed form.

Where friction is at most tau per length, a bar EA that is pulled by F at its end slips along F/tau and its end comes by
F^2/(2 EA tau); back to 0 it keeps half of that, and a cycle from F to -F and back takes 2 F^3/(3 EA tau).

The model has an answer in closed form, too, and its error no rate over meshes of any size. With q = F/(tau h) elements
of length h in the slip zone, the nodes 0 .. K - 1 from the end slip, K the integer next to q, and with d = q - K::

    u_k = tau h^2/(2 EA) ((q - k)^2 - d^2),    end: 1 - d^2/q^2,    loop: 1 + (1/2 - 3 d^2)/q^2 + O(q^-3)

relative to the bar. The node at the front sticks with the friction that is left, so that both errors follow from where
the front lies between two nodes: none of the end where it falls on one, nearly none of the loop where |d| = 0.41.
On meshes with the same d both are of second order: those of :data:`MESHES` have d = 0.2 for F and 0.4 for F/2, of which
the first unloading is made. Another n (mod 5) gives another d.

The length of the slip zone is read in two ways. Counted from the states it is wrong by (d + 1/2) h, first order; as the
vertex of the parabola of slips it is q h to rounding. The sum of friction over tau is no reading: it is the balance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pandas as pd

from contact.coulomb import State
from studies.experiments.friction.closed_forms.bars import EA, Bar, front

TAU, PULL, LENGTH = 0.5, 20.0, 100.0  # N/mm, N, mm
END, ZONE, LOOP = PULL**2 / (2 * EA * TAU), PULL / TAU, 2 * PULL**3 / (3 * EA * TAU)  # mm, mm, N mm
MESHES = (18, 33, 63, 123)
ERRORS = ("end_error", "back_error", "loop_error", "counted_error")  # those that have an order, on meshes with one d


def strip_table(meshes: Sequence[int] = MESHES, steps: Sequence[int] = (1, 4)) -> pd.DataFrame:
    """The dragged strip on every mesh, with every number of load steps between two turning points.

    offset: d.  end_mm, end_error: end displacement at F; back_error: back at 0; loop_N_mm, loop_error: dissipation of
    a cycle from F to -F and back; front_mm, front_error; counted_mm, counted_error: both readings of the slip zone at
    F. Errors are relative to the bar; discrete_end_error, discrete_loop_error: those that the closed form of the model
    has.  least_N_mm: the least dissipation of a step.
    """
    rows = []
    for n in meshes:
        q = ZONE * n / LENGTH
        for count in steps:
            turns = (0.0, PULL, 0.0, PULL, -PULL, PULL)
            pulls = [a + (b - a) * k / count for a, b in pairwise(turns) for k in range(1, count + 1)]
            bar = Bar(n, LENGTH, 1.0, press=TAU)
            states = bar.follow(pulls)
            ends = [float(state.solution.u[-2]) for state in states]
            first = states[count - 1].solution
            loop = sum(state.dissipation for state in states[3 * count :])
            read, counted = front(bar, first.u[::2]), float(np.sum((first.rubbed.state == State.SLIP) * bar.shares))
            rows.append(
                {"elements": n, "steps": count, "offset": q - _slipping(q)}
                | {"converged": len(states) == len(pulls) and all(s.solution.outcome.converged for s in states)}
                | {"iterations": sum(s.solution.counters["newton_iterations"] for s in states)}
                | {"end_mm": ends[count - 1], "end_error": ends[count - 1] / END - 1}
                | {"back_error": ends[2 * count - 1] / (END / 2) - 1}
                | {"loop_N_mm": loop, "loop_error": loop / LOOP - 1}
                | {"front_mm": read, "front_error": read / ZONE - 1}
                | {"counted_mm": counted, "counted_error": counted / ZONE - 1}
                | {"discrete_end_error": -(((q - _slipping(q)) / q) ** 2), "discrete_loop_error": _loop(q)}
                | {"least_N_mm": min(state.dissipation for state in states)}
            )
    return pd.DataFrame(rows)


def _slipping(q: float) -> int:
    """K: how many nodes slip where friction of q elements is asked for; the last end has half of one."""
    return math.ceil(q - 0.5)


def _loop(q: float) -> float:
    """Relative error of the dissipation of the model: sum of w_k ((q - k)^2 - d^2) beside q^3/3, w_0 = 1/2."""
    k = np.arange(_slipping(q))
    summed = np.sum(np.where(k == 0, 0.5, 1.0) * ((q - k) ** 2 - (q - _slipping(q)) ** 2))
    return float(summed / (q**3 / 3) - 1)

"""A linearisation factorised in one state of its candidates; others by exchanging what is given and what follows.

Each candidate has one way, its gap, or three, with two slips; F are the forces along them, v = v_now + J du the ways
after the step K du - J^T F = -r. In the state that is factorised each way has an input z, its force or its way, and an
output w, the other one. That is linear::

    w = q + M z

Any other state asks for inputs of the candidates in another one, which are a small dense system in columns of M. They
are found when they are asked for, from the same factors. What states ask for does not enter here.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np
from scipy import sparse

from contact.newton.held import Bound, Ports
from contact.newton.solves import LinearSolves
from contact.solvers.sparse import response, response_flops

REFINED = 1e-12  # relative change of the inputs that a step has found, above which it is solved again
REFINEMENTS = 3


class Exchange:
    """w = q + M z of d ways, see :class:`contact.newton.held.Ports`.

    now (d,): the ways before the step.  compliance (d,): of a way under its own force.  left (n,): the residual without
    forces of the foundation.
    """

    def __init__(
        self, run: LinearSolves, held: Bound, ports: Ports, now: np.ndarray, compliance: np.ndarray, left: np.ndarray
    ) -> None:
        """Factorise; raises SingularMatrixError."""
        self._run, self._held, self._ports, self._compliance = run, held, ports, compliance
        with run.tally.timed("contact_s"):
            self._matrix = held.matrix
        self._factor = run.factorise(self._matrix, of=held)
        self._known, self._columns = np.zeros(0, int), np.zeros((len(now), 0))
        self._load(now, left)

    def _load(self, now: np.ndarray, left: np.ndarray) -> None:
        """Put these ways (d,) and forces (n,) in place of those before; the factors stay."""
        self._now, self._left = now, left
        self._free = self._solution(np.zeros(len(now)))
        self.q = self._free[1]

    def solved(
        self, z: np.ndarray, places: np.ndarray, missing: Callable[[np.ndarray, np.ndarray], np.ndarray]
    ) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) and w (d,) once z (d,) is refined at the ``places`` (p,) by what (p,) is missing there."""
        du, w = self._free
        if len(places):
            for _ in range(REFINEMENTS):
                du, w = self._solution(z)
                change = missing(z, w)
                if np.all(np.abs(change) <= REFINED * np.max(np.abs(z))):
                    break
                z[places] += change
        return du, w

    def outputs(self, z: np.ndarray, places: np.ndarray) -> np.ndarray:
        """w (d,) of the inputs z (d,) at these places, 0 elsewhere, by columns alone."""
        return self.q + (self.columns(places) @ z[places] if len(places) else 0.0)

    def columns(self, places: np.ndarray) -> np.ndarray:
        """Those of M (d, p)."""
        new = np.setdiff1d(places, self._known)
        if len(new):
            with self._run.tally.timed("contact_s"):
                self._columns = np.hstack([self._columns, self._found(new)])
            self._known = np.append(self._known, new)
        place = np.empty(len(self._now), int)
        place[self._known] = np.arange(len(self._known))
        return self._columns[:, place[places]]

    def cost(self, places: np.ndarray) -> float:
        """Operations of the columns of these places that are not known."""
        new = np.setdiff1d(places, self._known)
        return response_flops(self._factor, *self._sides(new)) if len(new) else 0.0

    def _solution(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) and w (d,) under the inputs z (d,)."""
        held, ports = self._held, self._ports
        pushed, slack = ports.acting.T @ np.where(ports.forced, z, 0.0), ports.to_slack @ (z - self._now)
        y = self._run.solution(self._factor, self._matrix, held.load(pushed - self._left, slack))
        du = held.motion(y, slack)
        way = self._now + ports.rows @ du + self._compliance * z
        return du, np.where(ports.forced, way, ports.multiplied @ held.forces(y, du, self._left - pushed))

    @cached_property
    def _all_sides(self) -> tuple[sparse.csc_matrix, sparse.csc_matrix]:
        return self._held.sides(self._ports)

    def _sides(self, places: np.ndarray) -> tuple[sparse.csc_matrix, sparse.csc_matrix]:
        """What there is of y in w (n, d), and what inputs at these places put on the right-hand side of y (n, p)."""
        seen, done = self._all_sides
        return seen, sparse.csc_matrix(done[:, places])

    def _found(self, places: np.ndarray) -> np.ndarray:
        """Columns of M (d, p): by way of y, and what holds where all else is at rest."""
        columns = response(self._factor, *self._sides(places)) + self._held.direct(self._ports, places)
        columns[places, np.arange(len(places))] += np.where(self._ports.forced, self._compliance, 0.0)[places]
        return columns

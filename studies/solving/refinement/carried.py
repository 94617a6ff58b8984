"""States of a path carried from the model on one grid to that on another.

Displacements are carried by cubics, resultants mode by mode, for they build the geometric stiffness of the first step
of a mixed Newton; pressures, the contact set and friction by the nodes around. Slips are counted from the states of the
path itself. Whether a start is used does not enter here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from contact.continuation.candidates import Start, Starts, State, none_known
from contact.problem import ContactSolution
from formulations.geometry.transfer import Transfer
from formulations.strains.quantities import N_V
from studies.ask.scene import SceneModel, ShellSceneModel, Stage
from studies.scenes.walk import Visited, no_starts

LINEAR = 1  # what jumps at the rim of a patch is interpolated without overshooting
MOSTLY = 0.5  # of the nodes around, in contact


def starts_from(visits: Sequence[Visited], here: ShellSceneModel, there: SceneModel) -> Callable[[Stage], Starts]:
    """The starts of the stages of ``there``; none where the grids or the unknowns of a stage do not fit.

    visits: the requested points of the path on the grid of ``here``.
    """
    if not isinstance(there, ShellSceneModel):
        return no_starts
    transfer = Transfer.between(here.shell.discretisation.grid, there.shell.discretisation.grid)
    if transfer is None:
        return no_starts
    carrier = Carrier(here, there, transfer)

    def of(stage: Stage) -> Starts:
        known = [visited for visited in visits if visited.stage.name == stage.name and visited.converged]
        return none_known if stage.whole is not None else _Known(carrier, known).at

    return of


@dataclass(frozen=True, eq=False)
class _Known:
    """The points of a stage in their order."""

    carrier: Carrier
    visits: Sequence[Visited]

    def at(self, index: int, last: State, parameter: float) -> Start | None:
        """That of the point with this index, if the path has stood at both parameters on its way there."""
        if index >= len(self.visits):
            return None
        visited = self.visits[index]
        states = dict(visited.point.way)
        if parameter not in states or last[0] not in states:
            return None
        return self.carrier.start(visited, (last[0], states[last[0]]), (parameter, states[parameter]), last[1])


@dataclass(frozen=True, eq=False)
class Carrier:
    """From the model on one grid to that on another."""

    here: ShellSceneModel
    there: ShellSceneModel
    transfer: Transfer

    def start(self, visited: Visited, before: State, at: State, last: ContactSolution) -> Start | None:
        """A state of a stage, where the path there has reached ``last`` as here to the state ``before``.

        What the path here has moved since is added to the last state there: what the grids differ by hardly changes
        from load to load. None where the unknowns of the stage are not those of the shell.
        """
        shell, other = self.here.moved(at[0]).shell, self.there.moved(at[0]).shell
        was, old = self.here.moved(before[0]).shell, self.there.moved(before[0]).shell
        if len(at[1].u) != shell.discretisation.n_free or len(last.u) != other.discretisation.n_free:
            return None
        if shell.prescribed is not None and before[0] == 0.0 and np.any(last.u):
            return None  # a stage that begins with a guess, and not with a state
        moved = shell.nodal_displacements(at[1].u) - was.nodal_displacements(before[1].u)
        there, H = other.discretisation.map, None
        alike = there.inside == shell.discretisation.map.inside  # else what is between the faces moves as they do
        u = last.u + there.restrict_nodal(self.transfer.nodal(moved if alike else moved[:, :N_V]))
        if shell.newton == "mixed" and alike:
            change = shell.resultants(at[1].u) - was.resultants(before[1].u)
            H = old.resultants(last.u) + self.transfer.modes(change, shell.powers)
        start = Start(u, at[1].pressure, at[1].active, H)
        return self._touching(visited, *at, start) if len(at[1].active) else start

    def _touching(self, visited: Visited, t: float, state: ContactSolution, start: Start) -> Start:
        """With pressures, set and friction at the candidates."""
        active = self._at_candidates(state.active.astype(float)) >= MOSTLY
        start = replace(start, pressure=np.where(active, self._at_candidates(state.pressure), 0.0), active=active)
        if state.friction is None:
            return start
        from contact.coulomb import State as Rubs  # no solve without friction loads it

        weights = visited.problem_at(t).weights
        traction = state.friction.force / np.where(weights > 0, weights, 1.0)[:, None]
        slips, closed = (
            self._at_candidates(each.astype(float))
            for each in (state.friction.state == Rubs.SLIP, state.friction.state != Rubs.OPEN)
        )
        stick_or_slip = np.where(slips > MOSTLY * closed, Rubs.SLIP, Rubs.STICK)
        return replace(
            start,
            traction=np.where(active[:, None], self._at_candidates(traction), 0.0),
            state=np.where(active, stick_or_slip, Rubs.OPEN).astype(state.friction.state.dtype),
        )

    def _at_candidates(self, values: np.ndarray) -> np.ndarray:
        """Values (m, ...) at the candidates here -> (k, ...) at those there; 0 at nodes that are no candidates."""
        of_node, to_node = self.here.candidate_of_node, self.there.candidate_of_node
        at_nodes = np.concatenate([values, np.zeros((1, *values.shape[1:]))])[of_node]
        carried = self.transfer.nodal(self.transfer.here.carried(at_nodes), LINEAR)
        touching = to_node >= 0
        at_candidates = np.zeros((int(to_node.max(initial=-1)) + 1, *values.shape[1:]))
        at_candidates[to_node[touching]] = carried[touching]
        return at_candidates

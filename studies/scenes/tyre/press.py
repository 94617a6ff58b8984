"""The stages every tyre goes through, shell or solid: inflation, then the travel of a foundation, by steps or by arc.

The foundation comes along -e_x, touches the inflated tyre at (psi, phi) = (0, 0), and moves inwards by delta counted
from that first touch. What the wall is made of does not enter here.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
from scipy import sparse

from contact.continuation.arc_length import ArcLength, Trace
from contact.continuation.equilibrium_curve import ArcPoint
from contact.continuation.load_stepping import follow
from contact.continuation.pressed_curve import PressedCurve
from contact.continuation.turning_points import EASY, HARD
from contact.obstacles.foundation import Candidates, Foundation, against, travelling
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome, without_contact
from formulations.shell import ShellModel
from formulations.solid import SolidModel
from studies.ask.scene import Begun, CurveStage, Observation, Request, Setting, Stage, UsageError
from studies.output.atomic import Table
from studies.scenes.contact.extent import half_extent
from studies.scenes.foundations import NORMAL
from studies.scenes.tyre.parts import Part
from studies.scenes.tyre.readings import asymmetries, to_edges

FIRST = 1.0  # mm, over the number of steps
LARGEST = 4.0  # of the first step
MOST_POINTS = 60
PATH = Setting.one_of(
    "path", ("travel", "arc"), None, "steps of the travel, or arc length through limit points", otherwise="travel"
)
ARC_POINTS = Setting("arc_points", None, "points of the curve, with path=arc", "int", 1, 10_000, otherwise="60")
PATH_SETTINGS = (PATH, ARC_POINTS)


def arc_of(request: Request) -> ArcLength | None:
    """The continuation, or None for steps of the travel; raises UsageError for points without a curve."""
    settings = request.settings
    if settings.get("path", "travel") == "travel":
        if "arc_points" in settings:
            raise UsageError("arc_points needs path=arc")
        return None
    points = int(settings.number("arc_points")) if "arc_points" in settings else MOST_POINTS
    tolerance = request.number("tolerance")
    first = FIRST / request.steps
    return ArcLength(first, EASY, HARD, largest=LARGEST, max_points=points, tolerance=tolerance, lowest=0.0)


OVERLAP = 1e-6  # mm
BY_TRAVEL = 0.25  # of the travel asked for: up to there the arc length has nothing to find
MODE_STEP = 1e-3  # mm: the faces are linear in u but for a turn of frames
WHOLE = 1e-9  # what rounding takes off shares that add up to 1


Body = ShellModel | SolidModel
Faces = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]  # u -> deformed inner and outer face (n, 3) [mm]


@dataclass(frozen=True, eq=False)
class Wall:
    """Both faces of the WHOLE tyre at ``part.angles``, however small the part of it that is solved.

    nodes (m,): those of the part's grid that are contact candidates.  of_part: its faces.
    """

    part: Part
    nodes: np.ndarray
    of_part: Faces

    @cached_property
    def of_candidates(self) -> sparse.csr_matrix:
        """(N, m) what each place takes of the candidates."""
        part, m = self.part, len(self.nodes)
        at = sparse.csr_matrix((np.ones(m), (self.nodes, np.arange(m))), shape=(part.grid.n_nodes, m))
        return sparse.csr_matrix(part.view @ part.grid.carried(at[part.merging()]))

    @cached_property
    def covered(self) -> np.ndarray:
        """The places that take all of their value of candidates."""
        return np.flatnonzero(np.asarray(self.of_candidates.sum(axis=1)).ravel() > 1 - WHOLE)

    def faces(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Deformed inner and outer face (N, 3) [mm]."""
        inner, outer = (self.part.sign * (self.part.view @ face) for face in self.of_part(u))
        return inner, outer

    @property
    def crown(self) -> int:
        """The place (0, 0)."""
        return int(np.argmin(np.max(np.abs(self.part.angles), axis=1)))

    def spread(self, values: np.ndarray) -> np.ndarray:
        """Values of the candidates (m,) at all places (N,), zero elsewhere; of bool, whether all of a place are."""
        spread = self.of_candidates @ values.astype(float)
        return spread > 1 - WHOLE if values.dtype == bool else spread


@dataclass(frozen=True, eq=False)
class PressedStage(CurveStage):
    """The curve of a body that a foundation presses, t its travel.

    first: travel up to which plain steps lead; from there on by arc length to the targets beyond.
    """

    continuation: ArcLength
    first: float

    def trace(self, begun: Begun, algorithm: ContactAlgorithm, tell: Callable[[float], None]) -> Trace:
        """With the contact of the algorithm."""
        problem_at, start = begun
        (point,) = follow(problem_at, 0.0, [self.first], algorithm, start)
        rest = ArcPoint(start.u, 0.0, pressure=start.pressure, active=start.active)
        if not point.outcome.converged:
            reason = str(point.solution.history[-1].get("event", point.outcome.value))
            return Trace(
                (rest,), point.outcome, reason, dict(point.solution.counters), list(map(dict, point.solution.history))
            )
        curve, begin = PressedCurve.through(problem_at, self.first, point.solution, algorithm)
        curve.tally.add(point.solution)
        beyond = [target for target in self.targets if target > self.first]
        trace = self.continuation.along(curve, begin, beyond, tell)
        return replace(trace, points=(rest, *trace.points))


@dataclass(frozen=True, eq=False)
class Column:
    """One column of elements all around; lift(u) -> unknowns of the tyre in the same state."""

    body: Body
    lift: Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class PressedTyre:
    """The stages of a tyre: inflation without contact, then the travel of the foundation, at the origin here.

    column: where inflation is solved first, before it is lifted to the tyre; None when the tyre is inflated itself.
    arc: how the press is followed by arc length; None for steps of the travel.
    rim_by_pressure: how the extents of the patch are read, see :func:`half_extent`.
    """

    body: Body
    wall: Wall
    candidates: Candidates
    deltas: Sequence[float]
    foundation: Foundation
    column: Column | None = field(default=None, kw_only=True)
    arc: ArcLength | None = field(default=None, kw_only=True)
    rim_by_pressure: bool = field(default=False, kw_only=True)

    def stages(self) -> Iterator[Stage]:
        """Inflation by a pressure factor, of a column first, then the foundation by delta [mm]."""
        if self.column is not None:
            begin = partial(begin_inflation, self.column.body)
            yield Stage("column", begin, (1.0,), lambda *_: Observation(None), whole=self.column.lift)
        yield Stage("inflation", partial(begin_inflation, self.body), (1.0,), self._observe_inflation)
        press = ("press", self._begin_press, tuple(self.deltas), self._observe_press)
        if self.arc is None:
            yield Stage(*press, see_mode=self._see_mode)
        else:
            first = self.deltas[0] if len(self.deltas) > 1 else BY_TRAVEL * self.deltas[0]
            yield PressedStage(*press, self.arc, self._summarise, first)

    def _summarise(self, points: Sequence[ArcPoint]) -> dict[str, float]:
        """Number of limit points, the first one, and how far the foundation goes back behind it."""
        limits = [i for i, point in enumerate(points) if point.limit]
        if not limits:
            return {"limit_points": 0.0}
        behind = min(point.factor for point in points[limits[0] :])
        return {
            "limit_points": float(len(limits)),
            "press_limit_point": points[limits[0]].factor,
            "least_delta_behind_mm": behind,
        }

    def _begin_press(self, previous: ContactSolution | None) -> Begun:
        assert previous is not None
        m = len(self.candidates.reference)
        inflated = self.candidates.positions(previous.u)
        first_touch = float(np.max(inflated @ NORMAL))
        overlap = -float(np.min(self.foundation.moved(first_touch * NORMAL).gap(inflated)))
        if overlap > OVERLAP:
            raise UsageError(f"the foundation is too narrow: it overlaps the inflated tyre by {overlap:.3g} mm")
        start = ContactSolution(previous.u, np.zeros(m), np.zeros(m, bool), Outcome.CONVERGED)

        def travel() -> ContactProblem:
            touching = self.foundation.moved(first_touch * NORMAL)
            problem = travelling(self.body.linearise, self.candidates, touching, -NORMAL)
            return replace(problem, ordered=self.body.ordered)

        def at(delta: float) -> ContactProblem:
            there = self.foundation.moved((first_touch - delta) * NORMAL)
            problem = against(self.body.linearise, self.candidates, there)
            return self.with_balances(replace(problem, ordered=self.body.ordered, travel=travel))

        return at, start

    def with_balances(self, problem: ContactProblem) -> ContactProblem:
        """The problem with what the body lets the judge see beyond the contact conditions."""
        return problem

    def _observe_inflation(self, problem: ContactProblem, state: ContactSolution, t: float) -> Observation:
        rest = np.zeros_like(state.u)
        inner, outer = (x[self.wall.crown, 0] for x in self.wall.faces(state.u))
        inner_0, outer_0 = (x[self.wall.crown, 0] for x in self.wall.faces(rest))
        growth = {"inflated_equator_inner_mm": inner - inner_0, "inflated_equator_outer_mm": outer - outer_0}

        def tables() -> dict[str, Table]:
            states = (("unloaded", rest), ("inflated", state.u))
            return {"profile": Table.stacked([self._profile(name, 0.0, u) for name, u in states])}

        return Observation(None, {k: float(v) for k, v in growth.items()}, tables)

    def _observe_press(self, problem: ContactProblem, state: ContactSolution, delta: float) -> Observation:
        wall, shape = self.wall, self.wall.part.shape
        pressure = wall.spread(state.pressure).reshape(shape)
        active, share = (wall.spread(each).reshape(shape) for each in (state.active, state.active.astype(float)))
        x = wall.faces(state.u)[1]
        row, column = divmod(wall.crown, shape[1])
        read = pressure if self.rim_by_pressure else None
        along, across = (None, None) if read is None else (read[row], read[:, column])
        assert problem.directions is not None
        inwards, forces = -(problem.directions(state.u) @ NORMAL), problem.nodal_forces(state.pressure)
        headline = {
            "force_N": wall.part.copies * float(np.sum(inwards * forces)),
            "centre_pressure_MPa": float(pressure[row, column]),
            "mean_pressure_MPa": float(forces @ state.pressure) / (float(np.sum(forces)) or 1.0),
            "contact_nodes": int(active.sum()),
            "half_length_mm": half_extent(x[:, 1].reshape(shape)[row], share[row], along),
            "half_width_mm": half_extent(x[:, 2].reshape(shape)[:, column], share[:, column], across),
            "patch_to_clamp_mm": to_edges(x.reshape(*shape, 3), active),
        }
        step = {"delta_mm": delta, **headline, **asymmetries(pressure)}

        def tables() -> dict[str, Table]:
            covered = wall.covered
            a1, a2 = np.rad2deg(wall.part.angles[covered]).T
            nodes = {"delta_mm": delta, "psi_deg": a1, "phi_deg": a2}
            at_candidates = {"pressure_MPa": state.pressure, "gap_mm": problem.gap(state.u), "active": state.active}
            nodes |= {name: wall.spread(values)[covered] for name, values in at_candidates.items()}
            nodes["active"] = nodes["active"].astype(int)
            nodes |= {f"{axis}_mm": x[covered, i] for i, axis in enumerate("xyz")}
            return {"contact": Table.of(nodes), "profile": self._profile("pressed", delta, state.u)}

        return Observation(step, {k: float(v) for k, v in headline.items()}, tables)

    def _see_mode(self, state: ContactSolution, mode: np.ndarray) -> Observation:
        """How the outer face moves along the mode, the largest motion as unit: a table, and where it is largest."""
        step = MODE_STEP / float(np.max(np.abs(mode)))
        ends = [self.wall.faces(state.u + sign * step * mode)[1] for sign in (-1.0, 1.0)]
        motion = (ends[1] - ends[0]) / (2 * step)
        size = np.linalg.norm(motion, axis=1)
        angles = np.rad2deg(self.wall.part.angles)
        largest = int(np.argmax(size))
        place = {"mode_psi_deg": abs(float(angles[largest, 0])), "mode_phi_deg": abs(float(angles[largest, 1]))}
        nodes = {"psi_deg": angles[:, 0], "phi_deg": angles[:, 1]}
        nodes |= {f"{axis}": motion[:, i] / size[largest] for i, axis in enumerate("xyz")}
        message = "its mode is largest at psi = {mode_psi_deg:.4g}, phi = {mode_phi_deg:.4g} deg".format(**place)
        return Observation(None, place, lambda: {"mode": Table.of(nodes)}, message)

    def _profile(self, state: str, delta: float, u: np.ndarray) -> Table:
        """Both faces of the meridian phi = 0."""
        part = self.wall.part
        line = np.arange(self.wall.crown % part.shape[1], len(part.angles), part.shape[1])
        columns = {"state": state, "delta_mm": delta, "psi_deg": np.rad2deg(part.angles[line, 0])}
        for face, x in zip(("inner", "outer"), self.wall.faces(u), strict=True):
            columns |= {f"{face}_radial_mm": x[line, 0], f"{face}_axial_mm": x[line, 2]}
        return Table.of(columns)


def begin_inflation(body: Body, previous: ContactSolution | None) -> Begun:
    """From rest, or from what a column has found."""
    n = body.discretisation.n_free
    start = ContactSolution.at_rest(n, 0) if previous is None else previous

    def at(t: float) -> ContactProblem:
        loaded = body.scaled(t)
        residual = loaded.residual if isinstance(loaded, ShellModel) else None
        return replace(without_contact(loaded.linearise, n, ordered=body.ordered), residual=residual)

    return at, start

"""Follow r(u) = t f of a quadratic model by power series: the curve itself, piece by piece, not points of it.

Every piece costs one factorisation and reaches as far as the residual allows; the next one sets out from there. Newton
corrects only a recorded point that is not in balance. Requested loads and limit points are roots on the way, and the
state at any load passed is an evaluation. No contact and no element may enter here.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from contact.continuation.arc_length import Trace
from contact.continuation.equilibrium_curve import NO_CONTACT, NO_SET, ArcPoint, Curve
from contact.continuation.power_series import Expand, Piece, SeriesCurve
from contact.events import Event, EventKind
from contact.newton.solves import RESIDUAL_TOLERANCE
from contact.problem import Linearisation, Linearise, Outcome
from contact.rounding import rounding_floor
from contact.solvers.sparse import AUTO, SingularMatrixError

SHARE = 0.1  # of the tolerance that the truncation of one piece may take up
PRECISION = 1e-4  # of a piece in displacement over the tolerance: forces are less precise by as much (measured)
FINEST = 1e-13  # of that precision; what is finer is rounding
SOLVED = 4.0  # times the rounding of forces at a point: what the solutions of a thin shell's orders add to it
SHORTER = 0.85  # of a piece that is not right to its end
SMALLEST = 1e-3  # of its length, below which it is not cut


@dataclass(frozen=True, eq=False)
class PowerSeries:
    """Parameters of the continuation.

    order: N of the series.  to_limit: end with the first limit point.  tolerance: residual relative to the forces in
    balance that every recorded point has.  most_pieces: after which the march is given up.  max_iterations: of a
    Newton correction.  ordered: as for a problem.
    """

    order: int = 26
    to_limit: bool = False
    most_pieces: int = 300
    max_iterations: int = 10
    solver: str = AUTO
    tolerance: float = RESIDUAL_TOLERANCE
    ordered: bool = False

    def trace(
        self,
        linearise: Linearise,
        expand: Expand,
        load: np.ndarray,
        targets: Sequence[float],
        on_point: Callable[[float], None] = lambda t: None,
    ) -> Trace:
        """The curve from rest to the last target: a point at every target, limit point and end of a piece.

        As :meth:`contact.continuation.arc_length.ArcLength.trace`; expand(u, order): the recurrence at u.
        """
        curve = Curve.at_rest(linearise, load, self.max_iterations, self.solver, self.tolerance, self.ordered)
        return _March(self, expand, list(targets), curve).run(on_point)


@dataclass(eq=False)
class _March:
    """One run: what is still ahead, what has been recorded, and how far the curve has come."""

    how: PowerSeries
    expand: Expand
    ahead: list[float]
    curve: Curve
    points: list[ArcPoint] = field(default_factory=list)
    pieces: list[Piece] = field(default_factory=list)
    moved: float = 0.0
    loaded: float = 0.0

    def run(self, on_point: Callable[[float], None]) -> Trace:
        """From rest on."""
        outcome, reason = self._run(on_point)
        tally, curve = self.curve.tally, SeriesCurve(tuple(self.pieces))
        return Trace(tuple(self.points), outcome, reason, tally.counters, tally.history, curve)

    def _run(self, on_point: Callable[[float], None]) -> tuple[Outcome, str]:
        at = ArcPoint(np.zeros_like(self.curve.load), 0.0)
        lin, direction = self.curve.loaded(at.u, 0.0), np.append(np.zeros_like(at.u), 1.0)
        self.points.append(at)
        while len(self.pieces) < self.how.most_pieces:
            advanced, failed = None, ""
            try:
                advanced = self._reached(self._series(at, lin, direction), lin)
            except SingularMatrixError as error:
                failed = f": {error}"
            if advanced is None:
                return Outcome.STEP_LIMIT, f"power series after t = {at.factor:.6g}{failed}"
            piece, lin = advanced
            ended = self._pass(piece)
            if ended is not None:
                return ended
            before, at = at, self._balanced(piece, piece.length, lin=lin)
            self.points.append(replace(at, along=sum(each.length for each in self.pieces)))
            on_point(at.factor)
            lin = self.curve.loaded(at.u, at.factor) if at.iterations else lin
            self.moved += float(np.linalg.norm(at.u - before.u))
            self.loaded += abs(at.factor - before.factor)
            self.curve = self.curve.scaled(self.moved, self.loaded)
            direction = self._scaled(piece.tangent(piece.length))
        return Outcome.ITERATION_LIMIT, f"{len(self.pieces)} series of the curve did not reach t = {self.ahead[0]:g}"

    def _scaled(self, tangent: np.ndarray) -> np.ndarray:
        """The unit vector along dx/da in the scale of the curve."""
        along = tangent * np.append(np.full(len(tangent) - 1, self.curve.m), 1.0)
        return np.asarray(along / np.linalg.norm(along))

    def _series(self, at: ArcPoint, lin: Linearisation, direction: np.ndarray) -> Piece:
        """The series from a point in balance; raises SingularMatrixError."""
        m, n, order = self.curve.m, len(at.u), self.how.order
        weights = np.append(np.full(n, m * m), 1.0)
        solve = self.curve.bordered(lin, direction, checked=False)  # the residual at the end tells
        with self.curve.tally.timed("assembly_s"):
            expansion = self.expand(at.u, order)
        x = np.empty((order + 1, n + 1))
        x[0] = np.append(at.u, at.factor)
        first = solve(np.append(np.zeros(n), 1.0))
        x[1] = first / np.sqrt(first @ (weights * first))
        for k in range(1, order):
            with self.curve.tally.timed("assembly_s"):
                left = expansion.add(x[k, :-1])
            solved = solve(np.append(-left, 0.0))
            x[k + 1] = solved - (solved @ (weights * x[1])) * x[1]
        if not np.isfinite(x).all():
            raise SingularMatrixError("the orders of the series are not finite")
        return Piece.of(x, m, max(PRECISION * self.how.tolerance, FINEST))

    def _reached(self, series: Piece, lin: Linearisation) -> tuple[Piece, Linearisation] | None:
        """The series as far as the residual allows, and the model there; None where that is nowhere."""
        size, longest = float(np.linalg.norm(self.curve.load)), series.length
        while series.length > SMALLEST * longest:
            u, factor = series.at(series.length)
            there = self.curve.loaded(u, factor)
            scale = max(there.scale, size * abs(series.x[0, -1]))
            allowed = max(SHARE * self.how.tolerance * scale, SOLVED * rounding_floor(there, u))
            if np.linalg.norm(there.residual - lin.residual) <= allowed:
                return series, there
            series = series.cut(SHORTER * series.length)
        return None

    def _pass(self, piece: Piece) -> tuple[Outcome, str] | None:
        """Record the limit points and the targets on a piece, in order; how the march ends, if it does here."""
        before = sum(each.length for each in self.pieces)
        events: list[tuple[float, float | None]] = [(a, None) for a in piece.limits()]
        events += [(lengths[0], t) for t in self.ahead if (lengths := piece.passes(t))]
        for a, target in sorted(events, key=lambda event: event[0]):
            point = self._balanced(piece, a, target)
            self.points.append(replace(point, limit=target is None, along=before + a))
            if target is not None:
                self.ahead.remove(target)
            elif self.how.to_limit:
                self.pieces.append(piece.cut(a))
                return Outcome.LIMIT_POINT, f"the path turns back at t = {point.factor:.6g}"
            if not self.ahead:
                self.pieces.append(piece.cut(a))
                return Outcome.CONVERGED, ""
        self.pieces.append(piece)
        return None

    def _balanced(
        self, piece: Piece, a: float, target: float | None = None, lin: Linearisation | None = None
    ) -> ArcPoint:
        """The point at a length: as it is, or corrected on the plane across the curve or at its target."""
        u, factor = piece.at(a)
        factor = factor if target is None else target
        tangent, run = self._scaled(piece.tangent(a)), self.curve.run
        at = run.at(lin or self.curve.loaded(u, factor), u, NO_CONTACT, NO_SET)
        event = Event(EventKind.POINT, f"series {len(self.pieces) + 1} at length {a:.6g}")
        run.tally.note(at.residual, NO_SET, NO_SET, event)
        run.tally.history[-1] |= {"parameter": factor, "iteration": 0}
        point = ArcPoint(u, factor, rising=bool(tangent[-1] > 0))
        if run.balanced(at):
            return point
        normal = tangent if target is None else np.append(np.zeros_like(u), 1.0)
        balanced = self.curve.on_plane(point, self.curve.place(point), normal, "correction")
        return point if balanced is None else replace(balanced, rising=point.rising)

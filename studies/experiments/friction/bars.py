"""An elastic bar on a plane, on a drum or in one, with friction: partial and gross slip in closed form.

Elements of constant strain u' + w/R; x runs along the foundation, w off it. Small displacements: a strip in a hollow
drum, pushed, is the one on a drum, pulled, with the signs of R, of the tension and of the pull turned.

The strip is dragged over a plane under uniform pressure. Where friction is at most tau per length, a bar EA that is
pulled by F at its end slips along F/tau and its end comes by F^2/(2 EA tau); back to 0 it keeps half of that, and a
cycle from F to -F and back takes 2 F^3/(3 EA tau).

The model has an answer in closed form, too, and its error no rate over meshes of any size. With q = F/(tau h) elements
of length h in the slip zone, the nodes 0 .. K - 1 from the end slip, K the integer next to q, and with d = q - K::

    u_k = tau h^2/(2 EA) ((q - k)^2 - d^2),    end: 1 - d^2/q^2,    loop: 1 + (1/2 - 3 d^2)/q^2 + O(q^-3)

relative to the bar. The node at the front sticks with the friction that is left, so that both errors follow from where
the front lies between two nodes: none of the end where it falls on one, nearly none of the loop where |d| = 0.41.
On meshes with the same d both are of second order: those of :data:`MESHES` have d = 0.2 for F and 0.4 for F/2, of which
the first unloading is made. Another n (mod 5) gives another d.

The length of the slip zone is read in two ways. Counted from the states it is wrong by (d + 1/2) h, first order; as the
vertex of the parabola of slips it is q h to rounding. The sum of friction over tau is not a reading: it is the balance.

The drum: with the normal force N0 along the strip at rest and N1 at the end that moves, both tension on a drum of
radius R and both compression in one::

    slip angle ln(N1/N0)/mu,    u = R/(EA mu) (N1 - N0 - N0 ln(N1/N0)),    gross slip at N1/N0 = exp(mu theta)

Errors have a rate where the front lies at the same place between two nodes on all meshes, as of the strip: the wrap
is ln(N1/N0)/(0.6 mu) and the numbers of elements are those of the strip.
Source: the equation of the capstan (Euler, Eytelwein); the rest follows by integration.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product

import numpy as np
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.continuation.friction_path import PathState, Stage, follow
from contact.coulomb import State
from contact.problem import ContactProblem, ContactSolution, linear_mechanics
from studies.experiments import Row, tabulated
from studies.experiments.friction.klarbring import in_plane

EA = 1e4  # N
STIFF = 1e9  # N/mm, of what drives an end
SLIPS = 1e-9  # of the largest slip: below, a node sticks
MESHES = (18, 33, 63, 123)  # numbers of elements
# the strip
TAU, PULL, LENGTH = 0.5, 20.0, 100.0  # N/mm, N, mm
STRIP_END, ZONE, LOOP = PULL**2 / (2 * EA * TAU), PULL / TAU, 2 * PULL**3 / (3 * EA * TAU)  # mm, mm, N mm
# the drum
RADIUS, N0, N1, MU = 100.0, 10.0, 15.0, 0.3  # mm, N, N
ANGLE = math.log(N1 / N0) / MU
WRAP = ANGLE / 0.6  # of the strip in partial slip
DRUM_END = RADIUS / (EA * MU) * (N1 - N0 - N0 * math.log(N1 / N0))  # mm, 0.03151163
SIDES = {"on": 1.0, "inside": -1.0}
DRIVEN = 10.0  # mm: far beyond the first gross slip


@dataclass(frozen=True, eq=False)
class Bar:
    """n elements over ``length`` [mm]; u_0, w_0, u_1, ..: node by node.

    curvature [1/mm]: of the drum, 0 on a plane, negative in a hollow one.  press [N/mm]: dead load on the
    foundation.  tension [N]: at rest, negative in a hollow drum.  held: whether the first end does not move along, else
    it carries the tension as a dead load.  driven: whether the last end goes where a stiff spring takes it, else it
    carries what it is pulled by beyond the tension.
    """

    n: int
    length: float
    mu: float
    curvature: float = 0.0
    press: float = 0.0
    tension: float = 0.0
    held: bool = False
    driven: bool = False

    @property
    def shares(self) -> np.ndarray:
        """Length [mm] of each node (n + 1,)."""
        shares = np.full(self.n + 1, self.length / self.n)
        shares[[0, -1]] /= 2
        return shares

    def stage_at(self, pull: float, anchors: np.ndarray) -> Stage:
        """Pulled by ``pull`` [N] beyond the tension, or driven to ``pull`` [mm]; anchors (n + 1,) [mm]."""
        n, h, size = self.n, self.length / self.n, 2 * (self.n + 1)
        e = np.arange(n)
        rows = np.repeat(e, 4)
        columns = (2 * e[:, None] + np.arange(4)).ravel()
        strain = np.tile([-1 / h, self.curvature / 2, 1 / h, self.curvature / 2], n)
        B = sparse.csr_matrix((strain, (rows, columns)), shape=(n, size))
        springs, load = np.zeros(size), np.zeros(size)
        load[1::2] -= self.press * self.shares
        if not self.curvature:
            springs[1::2] = EA / h  # off the plane nothing else holds a bar
        if self.held:
            springs[0] = STIFF
        if self.driven:
            springs[-2], load[-2] = STIFF, STIFF * pull
        else:
            load[-2] = pull
        K = sparse.csc_matrix(EA * h * (B.T @ B) + sparse.diags_array(springs))
        # the ends carry the tension themselves: what is left of it presses on the drum
        load[1::2] -= self.tension * self.curvature * self.shares
        along, across = (sparse.csr_matrix(sparse.eye_array(size, format="csr")[start::2]) for start in (0, 1))
        largest = max(float(np.max(np.abs(load))), abs(pull))
        mechanics = linear_mechanics(K, load, largest)
        contact = ContactProblem(mechanics, lambda u: across @ u, lambda u: across, self.shares)
        return Stage(in_plane(contact, along, self.mu, -anchors), lambda u: np.asarray(along @ u))

    @property
    def rest(self) -> PathState:
        """Pressed, sticking, under its tension."""
        size, m = 2 * (self.n + 1), self.n + 1
        at = ContactSolution.at_rest(size, m)
        pressed = np.full(m, self.press + self.tension * self.curvature)
        return PathState(0.0, replace(at, pressure=pressed, active=np.ones(m, bool)), np.zeros(m))

    def follow(self, pulls: Sequence[float]) -> list[PathState]:
        """The states at these pulls in turn, from rest; a front passes many nodes on one linearisation."""
        return list(follow(self.stage_at, pulls, Semismooth(settle=0.0), self.rest))


def front(bar: Bar, slip: np.ndarray) -> float:
    """How far from its last end [mm] a bar slips, read off its slips (n + 1,) [mm] alone.

    Towards the front slip is a parabola with its vertex there, s ~ (x - front)^2: the vertex of the one through the
    last three nodes that slip. Uniform friction makes a parabola of all of it, and the reading exact on any mesh.
    """
    x = bar.length * np.arange(bar.n + 1) / bar.n
    moves = np.abs(slip) > SLIPS * np.max(np.abs(slip))
    first = int(np.flatnonzero(moves)[0])
    curved, sloped, _ = np.polyfit(x[first : first + 3] - x[first], slip[first : first + 3], 2)
    return float(bar.length - x[first] + sloped / (2 * curved))


@tabulated
def strip_table(meshes: Sequence[int] = MESHES, steps: Sequence[int] = (1, 4)) -> Iterator[Row]:
    """The dragged strip on every mesh, with every number of load steps between two turning points.

    offset: d.  end_mm, end_error: end displacement at F; back_error: back at 0; loop_N_mm, loop_error: dissipation of
    a cycle from F to -F and back; front_mm, front_error; counted_mm, counted_error: both readings of the slip zone at
    F. Errors are relative to the bar; discrete_end_error, discrete_loop_error: those that the closed form of the model
    has.  least_N_mm: the least dissipation of a step.
    """
    for n, count in product(meshes, steps):
        q = ZONE * n / LENGTH
        turns = (0.0, PULL, 0.0, PULL, -PULL, PULL)
        pulls = [a + (b - a) * k / count for a, b in pairwise(turns) for k in range(1, count + 1)]
        bar = Bar(n, LENGTH, 1.0, press=TAU)
        states = bar.follow(pulls)
        ends = [float(state.solution.u[-2]) for state in states]
        first = states[count - 1].solution
        loop = sum(state.dissipation for state in states[3 * count :])
        read, counted = front(bar, first.u[::2]), float(np.sum((first.rubbed.state == State.SLIP) * bar.shares))
        yield (
            {"elements": n, "steps": count, "offset": q - _slipping(q)}
            | {"outcome": states[-1].solution.outcome.word}
            | {"iterations": sum(s.solution.counters["newton_iterations"] for s in states)}
            | {"end_mm": ends[count - 1], "end_error": ends[count - 1] / STRIP_END - 1}
            | {"back_error": ends[2 * count - 1] / (STRIP_END / 2) - 1}
            | {"loop_N_mm": loop, "loop_error": loop / LOOP - 1}
            | {"front_mm": read, "front_error": read / ZONE - 1}
            | {"counted_mm": counted, "counted_error": counted / ZONE - 1}
            | {"discrete_end_error": -(((q - _slipping(q)) / q) ** 2), "discrete_loop_error": _loop(q)}
            | {"least_N_mm": min(state.dissipation for state in states)}
        )


def _slipping(q: float) -> int:
    """K: how many nodes slip where friction of q elements is asked for; the last end has half of one."""
    return math.ceil(q - 0.5)


def _loop(q: float) -> float:
    """Relative error of the dissipation of the model: sum of w_k ((q - k)^2 - d^2) beside q^3/3, w_0 = 1/2."""
    k = np.arange(_slipping(q))
    summed = np.sum(np.where(k == 0, 0.5, 1.0) * ((q - k) ** 2 - (q - _slipping(q)) ** 2))
    return float(summed / (q**3 / 3) - 1)


@tabulated
def drum_table(meshes: Sequence[int] = MESHES, sides: Sequence[str] = tuple(SIDES)) -> Iterator[Row]:
    """Partial slip on the drum and inside: end displacement, slip angle by the vertex of slips, and relative errors."""
    for side, n in product(sides, meshes):
        sign = SIDES[side]
        bar = Bar(n, RADIUS * WRAP, MU, curvature=sign / RADIUS, tension=sign * N0, held=True)
        solution = bar.follow([sign * (N1 - N0)])[-1].solution
        end, angle = abs(float(solution.u[-2])), front(bar, solution.u[::2]) / RADIUS
        yield (
            {"side": side, "elements": n, "outcome": solution.outcome.word}
            | {"end_mm": end, "end_error": end / DRUM_END - 1}
            | {"slip_rad": angle, "slip_error": angle / ANGLE - 1}
        )


@tabulated
def capstan_table(
    turns: Sequence[tuple[float, float]] = ((0.2, 1.0), (0.3, 2.0), (0.5, 2.0), (0.5, 4.0)),
    meshes: Sequence[int] = (12, 25, 50, 100),
    sides: Sequence[str] = tuple(SIDES),
) -> Iterator[Row]:
    """Gross slip by (mu, theta): ratio N1/N0, and its relative error from exp(mu theta).

    ratio: by the balance of all forces along the strip; at_spring: by the stiff spring that drives the end, which has
    fewer digits.  slipping: nodes.
    """
    for side, (mu, theta), n in product(sides, turns, meshes):
        sign = SIDES[side]
        bar = Bar(n, RADIUS * theta, mu, curvature=sign / RADIUS, tension=sign * N0, driven=True)
        solution = bar.follow([sign * DRIVEN])[-1].solution
        ratio = 1 - sign * float(np.sum(solution.rubbed.force[:, 0])) / N0
        yield (
            {"side": side, "mu": mu, "theta_rad": theta, "elements": n, "outcome": solution.outcome.word}
            | {"slipping": int(np.sum(solution.rubbed.state == State.SLIP)), "ratio": ratio}
            | {"error": ratio / math.exp(mu * theta) - 1}
            | {"at_spring": 1 + STIFF * (DRIVEN - sign * float(solution.u[-2])) / N0}
        )

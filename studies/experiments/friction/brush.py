"""Springs that stand on a plane by themselves, as bristles of a brush: a tyre's patch, and a block on an arc.

Each point of the patch has three unknowns and a stiffness k (3, 3) of its own, by area [N/mm^3]. It is pressed by how
far its springs are approached, so that pressures are those of the solve; a stiffness that couples lets them depend on
friction. The plane z = 0 is dragged along itself and turned about z, by any amount: :mod:`contact.slip`.

Dragged until everything slides, the force is mu F_n; spun, the moment is mu sum f r with the r where points are then.
A step that turns by a makes the slip a chord of its circle: it leans by a/2, and the moment of the model is that times
cos(a/2), whatever the springs. Turned by a little from rest, under the pressure p(r) on a disc of radius a with springs
k by area, a core r < c sticks::

    k phi c = mu p(c),    M = 2 pi (k phi c^4/4 + mu int_c^a p r^2 dr)
    loop from phi to -phi and back = 8 pi mu int_c^a p (phi r - mu p/k) r dr

Source: the brush model of tyres, Pacejka, Tyre and Vehicle Dynamics (2012); the integrals are worked out here.

What load steps cost in accuracy is seen on a block on two springs while the plane is dragged along a quarter circle:
the direction turns all the time, so that the answer depends on the path. With the stiffness k (2, 2) of the springs,
|k u| = mu N once it slips, and slip against friction, the block is where an ordinary differential equation takes it, in
the arc length sigma of the drag d::

    u' = d' - lam k u,    lam = (k u.k d' - (mu N)^2 N'/N)/(k u.k k u),    dissipation' = lam (mu N)^2

Before it sticks, u = d. A step of the path is an implicit Euler step of that, of first order in its length.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.polynomial import Polynomial
from scipy import sparse
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from contact.algorithms.semismooth import Semismooth
from contact.continuation.friction_path import PathState, Stage, follow
from contact.coulomb import Coulomb, Motion, State
from contact.obstacles.foundation import Candidates, RigidPlane
from contact.problem import ContactProblem, ContactSolution, linear_mechanics
from contact.slip import Slip
from studies.experiments import Row, tabulated

GROUND = RigidPlane(np.array([0.0, 0.0, -1.0]), 0.0)


@dataclass(frozen=True, eq=False)
class Brush:
    """Points at ``places`` (m, 2) [mm] with areas (m,) [mm^2], stiffness (3, 3) [N/mm^3] and the coefficient mu.

    approach(load) -> (m,) [mm]: by which springs are pressed; moved(load): how far the plane has moved from rest.
    """

    places: np.ndarray
    areas: np.ndarray
    stiffness: np.ndarray
    mu: float
    approach: Callable[[float], np.ndarray]
    moved: Callable[[float], Motion]

    @property
    def candidates(self) -> Candidates:
        """The ends of the springs, on the plane where they are not approached."""
        m = len(self.areas)
        at = np.column_stack([self.places, np.zeros(m)])
        return Candidates(at, sparse.csr_matrix(sparse.eye_array(3 * m)), self.areas)

    def stage_at(self, load: float, anchors: np.ndarray) -> Stage:
        """The step to ``load`` from anchors (m, 3)."""
        m, candidates = len(self.areas), self.candidates
        K = sparse.csc_matrix(sparse.kron(sparse.diags_array(self.areas), self.stiffness))
        across = sparse.csr_matrix((np.ones(m), np.arange(2, 3 * m, 3), np.arange(m + 1)), shape=(m, 3 * m))
        near = self.approach(load)
        mechanics = linear_mechanics(
            K, np.zeros(3 * m), float(np.linalg.norm(self.areas * near * self.stiffness[2, 2]))
        )
        motion = self.moved(load)
        slip = Slip(candidates, GROUND, motion, anchors)
        size = float(np.max(np.abs(candidates.reference), initial=0.0) + np.linalg.norm(motion.translation))
        slips = slip.jacobian(np.zeros(3 * m))  # the same everywhere
        law = Coulomb(np.full(m, self.mu), slip, lambda u: slips, size)
        problem = ContactProblem(mechanics, lambda u: across @ u - near, lambda u: across, self.areas, coulomb=law)
        return Stage(problem, slip.places)

    def follow(self, loads: Sequence[float]) -> list[PathState]:
        """The states at these loads in turn, from rest."""
        m = len(self.areas)
        rest = PathState(0.0, ContactSolution.at_rest(3 * m, m), self.candidates.reference)
        return list(follow(self.stage_at, loads, Semismooth(), rest))

    def friction(self, state: PathState) -> np.ndarray:
        """Forces (m, 3) [N] of the plane on the points along itself, in space."""
        anchored = Slip(self.candidates, GROUND, self.moved(state.load), state.anchors)
        own = np.einsum("mk,mki->mi", state.solution.rubbed.force, anchored.directions)
        return np.asarray(own @ anchored.motion.rotation.T)

    def moment(self, state: PathState) -> float:
        """Of friction about the z axis [N mm], where the points are now."""
        x, t = self.candidates.positions(state.solution.u), self.friction(state)
        return float(np.sum(x[:, 0] * t[:, 1] - x[:, 1] * t[:, 0]))


def spun(load: float) -> Motion:
    """The plane turned by the load [rad] about z."""
    return Motion(np.zeros(3), np.array([0.0, 0.0, load]), np.zeros(3))


MU, STIFF, PRESSURE, DISC = 0.5, 50.0, 0.5, 50.0  # -, N/mm^3, MPa, mm
COUPLED = np.array([[40.0, 5.0, 8.0], [5.0, 60.0, -6.0], [8.0, -6.0, 50.0]])  # N/mm^3, of springs that lean
SECTORS = 8

PRESSURES = {"uniform": Polynomial([PRESSURE]), "parabolic": Polynomial([PRESSURE, 0.0, -PRESSURE / DISC**2])}


def uneven(n: int = 8, mu: float = MU) -> Brush:
    """A rectangular patch of n x 2n springs that lean; its pressures differ by a factor of three. Not moved."""
    x, y = (half * (np.arange(k) + 0.5 - k / 2) * 2 / k for half, k in ((30.0, n), (50.0, 2 * n)))
    places = np.array(list(product(x, y)))
    near = 0.01 * (1 + 0.3 * places[:, 0] / 30 - 0.2 * (places[:, 1] / 50) ** 2)
    return Brush(places, np.full(len(places), 6000.0 / len(places)), COUPLED, mu, lambda load: near, spun)


@dataclass(frozen=True)
class Parking:
    """A disc under a pressure, turned from rest until the share ``core`` of its radius sticks; see the module."""

    pressure: str
    core: float

    @property
    def c(self) -> float:
        """[mm]."""
        return self.core * DISC

    @property
    def phi(self) -> float:
        """[rad]."""
        return float(MU * PRESSURES[self.pressure](self.c) / (STIFF * self.c))

    @property
    def moment(self) -> float:
        """M [N mm]."""
        rest = (PRESSURES[self.pressure] * Polynomial([0.0, 0.0, 1.0])).integ()
        return float(2 * math.pi * (STIFF * self.phi * self.c**4 / 4 + MU * (rest(DISC) - rest(self.c))))

    @property
    def loop(self) -> float:
        """[N mm]."""
        p = PRESSURES[self.pressure]
        lost = (p * (Polynomial([0.0, self.phi]) - MU / STIFF * p) * Polynomial([0.0, 1.0])).integ()
        return float(8 * math.pi * MU * (lost(DISC) - lost(self.c)))

    def brush(self, rings: int) -> Brush:
        """Rings of the same width, each with its points where the moment of its area is."""
        edges = DISC * np.arange(rings + 1) / rings
        outer, inner = edges[1:], edges[:-1]
        r = 2 / 3 * (outer**3 - inner**3) / (outer**2 - inner**2)
        angle = 2 * math.pi * np.arange(SECTORS) / SECTORS
        places = (r[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)).reshape(-1, 2)
        areas = np.repeat(math.pi * (outer**2 - inner**2) / SECTORS, SECTORS)
        near = PRESSURES[self.pressure](np.repeat(r, SECTORS)) / STIFF
        return Brush(places, areas, STIFF * np.eye(3), MU, lambda load: near, spun)


@tabulated
def parking_table(rings: Sequence[int] = (10, 19, 40, 79), cores: Sequence[float] = (1 / 3, 2 / 3)) -> Iterator[Row]:
    """The disc turned until a core of ``cores`` of its radius sticks; then back as far, and forth again.

    Errors are relative: of the core, where the slip, continued from the two rings inmost of those that slip, is none;
    of the moment at the first turn, and of the dissipation of the cycle after it. With 3 k + 1 rings the edge of a core
    of thirds falls alike between two of them.
    """
    for pressure, core, n in product(PRESSURES, cores, rings):
        disc = Parking(pressure, core)
        brush = disc.brush(n)
        states = brush.follow([disc.phi, -disc.phi, disc.phi])
        first, loop = states[0], sum(state.dissipation for state in states[1:])
        slip = np.linalg.norm((first.anchors[:, :2] - brush.places)[::SECTORS], axis=1)
        read = _root(np.linalg.norm(brush.places, axis=1)[::SECTORS], slip, first.solution.rubbed.state[::SECTORS])
        yield (
            {"pressure": pressure, "core": core, "rings": n, "outcome": states[-1].solution.outcome.word}
            | {"core_error": read / disc.c - 1, "moment_error": brush.moment(first) / disc.moment - 1}
            | {"loop_error": loop / disc.loop - 1}
        )


def _root(r: np.ndarray, slip: np.ndarray, state: np.ndarray) -> float:
    """Where the line through the first two that slip is zero."""
    first = int(np.flatnonzero(state == State.SLIP)[0])
    (a, b), (s, t) = r[first : first + 2], slip[first : first + 2]
    return float(a - s * (b - a) / (t - s))


RADIUS, NORMAL, SPRING = 10.0, 8.0, 1.0  # mm, N, N/mm of the stiffer spring of a block
WAY = math.pi / 2 * RADIUS
STEPS = (4, 8, 16, 32, 64, 128)
TIGHT = 1e-12  # of the reference


@dataclass(frozen=True)
class Block:
    """ratio: of the springs along y and x.  swell: share of NORMAL by which the normal force swells and comes back."""

    ratio: float = 1.0
    swell: float = 0.0

    @property
    def stiffness(self) -> np.ndarray:
        """k (2,) [N/mm]."""
        return np.array([SPRING, self.ratio * SPRING])

    def normal(self, way: float) -> float:
        """N [N]."""
        return NORMAL * (1 + self.swell * math.sin(2 * math.pi * way / WAY))

    def normal_rate(self, way: float) -> float:
        """dN/dsigma [N/mm]."""
        return NORMAL * self.swell * 2 * math.pi / WAY * math.cos(2 * math.pi * way / WAY)

    def reference(self) -> tuple[np.ndarray, float]:
        """u (2,) [mm] and the dissipation [N mm] at the end of the way."""
        k = self.stiffness

        def over(way: float) -> float:
            return float(np.linalg.norm(k * drag(way))) - MU * self.normal(way)

        slips = float(brentq(over, 0.0, WAY / 2, xtol=TIGHT))

        def rate(way: float, y: np.ndarray) -> np.ndarray:
            force, along = k * y[:2], direction(way)
            bound = MU * self.normal(way)
            lam = (force @ (k * along) - bound * MU * self.normal_rate(way)) / (force @ (k * force))
            return np.append(along - lam * force, lam * bound**2)

        path = solve_ivp(rate, (slips, WAY), np.append(drag(slips), 0.0), method="DOP853", rtol=TIGHT, atol=TIGHT)
        return path.y[:2, -1], float(path.y[2, -1])

    @property
    def brush(self) -> Brush:
        """The block as one spring of unit area, the load being the arc length."""
        k = np.diag([*self.stiffness, SPRING])
        return Brush(np.zeros((1, 2)), np.ones(1), k, MU, lambda way: np.array([self.normal(way) / SPRING]), _moved)


BLOCKS = {"springs alike": Block(), "springs unlike": Block(3.0), "normal force swells": Block(3.0, 0.3)}


def drag(way: float) -> np.ndarray:
    """d (2,) [mm] after an arc length on the circle that begins along x."""
    return RADIUS * np.array([math.sin(way / RADIUS), 1 - math.cos(way / RADIUS)])


def direction(way: float) -> np.ndarray:
    """d' (2,)."""
    return np.array([math.cos(way / RADIUS), math.sin(way / RADIUS)])


@tabulated
def path_table(steps: Sequence[int] = STEPS, blocks: Sequence[str] = tuple(BLOCKS)) -> Iterator[Row]:
    """Every block in every number of load steps: end_error, distance from the reference over its length; work_error."""
    known = {name: BLOCKS[name].reference() for name in blocks}
    for name, count in product(blocks, steps):
        exact, work = known[name]
        states = BLOCKS[name].brush.follow([WAY * k / count for k in range(1, count + 1)])
        u, dissipated = states[-1].solution.u[:2], sum(state.dissipation for state in states)
        yield (
            {"case": name, "steps": count, "outcome": states[-1].solution.outcome.word}
            | {"end_error": float(np.linalg.norm(u - exact) / np.linalg.norm(exact))}
            | {"work_error": dissipated / work - 1}
        )


def _moved(way: float) -> Motion:
    return Motion(np.append(drag(way), 0.0), np.zeros(3), np.zeros(3))

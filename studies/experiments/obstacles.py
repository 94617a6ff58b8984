"""Published obstacle problems and linear complementarity classics as contact problems, and where sets go round in them.

Obstacle problems: the elastic membrane of Dembo and Tulowitzki (1983) over a sine landscape and the elastic-plastic
torsion of Moré and Toraldo, SIAM J. Optim. 1 (1991) 93-113, as in CUTEst (OBSTCL.., TORSION.), rewritten from the
formulas. LCP classics: Murty (1978), Fathi (1979), Csizmadia, Ben Gharbia and Gilbert (2012), as listed in
gilbert-jch/hnm4lcp. An unknown is a "displacement", a bound a candidate, its multiplier a "pressure" on unit area.
The table of cycles has some of them by the textbook's swaps and by our algorithms.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.events import EventKind, events
from contact.problem import ContactProblem, ContactSolution, Outcome, linear_mechanics
from studies.experiments import Row, tabulated


@dataclass(frozen=True, eq=False)
class Bounded:
    """K x - f = p_low - p_up, low <= x <= up; x (n,); a bound at infinity is not a candidate.

    start: where the source starts, (n,).  optimum: published min x.K.x/2 - f.x, or None.  answer: known x, or None.
    symmetric: whether there is such a minimum at all.
    """

    name: str
    K: sparse.csc_matrix
    f: np.ndarray
    low: np.ndarray
    up: np.ndarray
    start: np.ndarray
    optimum: float | None = None
    answer: np.ndarray | None = None
    symmetric: bool = True

    def problem(self) -> ContactProblem:
        """The contact problem; lower bounds come before upper ones."""
        n, below, above = len(self.f), np.flatnonzero(np.isfinite(self.low)), np.flatnonzero(np.isfinite(self.up))
        eye = sparse.eye_array(n, format="csr")
        G = sparse.csr_matrix(sparse.vstack([eye[below], -eye[above]]))
        offset = np.concatenate([-self.low[below], self.up[above]])

        return ContactProblem(
            linear_mechanics(self.K, self.f), lambda u: offset + G @ u, lambda u: G, np.ones(len(offset))
        )

    def begin(self) -> ContactSolution:
        """The source's starting point; bounds that it touches are in the set."""
        gap = self.problem().gap(self.start)
        return ContactSolution(self.start, np.zeros(len(gap)), gap == 0, Outcome.CONVERGED)


def _membrane(points: int) -> sparse.csc_matrix:
    """Sum over the interior points of a quarter of the four squared differences, boundary values zero.

    A difference between two interior points is counted twice, one towards the boundary once.
    """
    n = points - 2
    chain = np.diag(np.full(n, 2.0)) - np.eye(n, k=1) - np.eye(n, k=-1)
    chain[0, 0] = chain[-1, -1] = 1.5
    line = sparse.csc_matrix(chain)
    eye = sparse.eye_array(n, format="csc")
    return sparse.csc_matrix(sparse.kron(line, eye) + sparse.kron(eye, line))


def obstacle(name: str, points: int) -> Bounded:
    """OBSTCLAE, AL (problem A, below only), OBSTCLBL, BM, BU (problem B, both sides) on a square of points x points.

    A: x >= sin(3.2 s) sin(3.3 t); B: l^3 <= x <= l^2 + 0.02 with l = sin(9.2 s) sin(9.3 t); load 1. The last letter is
    the starting point: Lower, Upper bound, Middle, E ones. The upper bound 2000 of A is left out: it is never reached.
    """
    inner, h = np.arange(1, points - 1) / (points - 1), 1 / (points - 1)
    s, t = (x.ravel() for x in np.meshgrid(inner, inner, indexing="ij"))
    if name[6] == "A":
        low, up = np.sin(3.2 * s) * np.sin(3.3 * t), np.full(s.size, np.inf)
    else:
        wave = np.sin(9.2 * s) * np.sin(9.3 * t)
        low, up = wave**3, wave**2 + 0.02
    start = {"L": low, "E": np.ones(s.size), "U": up, "M": (low + up) / 2}[name[7]]
    optimum = _OPTIMA.get((name[:7], points))
    return Bounded(f"{name} {points}", _membrane(points), np.full(s.size, h * h), low, up, start, optimum)


def torsion(c: float, points: int) -> Bounded:
    """TORSION1 (c = 5) and its family (10, 20): |x| <= distance to the boundary, load c, from the upper bound."""
    inner, h = np.arange(1, points - 1), 1 / (points - 1)
    edge = np.minimum(inner, points - 1 - inner)
    distance = h * np.minimum(edge[:, None], edge[None, :]).ravel()
    optimum = _OPTIMA.get(("TORSION", points)) if c == 5 else None
    f = np.full(distance.size, c * h * h)
    return Bounded(f"TORSION c={c:g} {points}", _membrane(points), f, -distance, distance, distance, optimum)


# comments SOLTN of the SIF files
_OPTIMA = {
    ("OBSTCLA", 4): 0.753659753,
    ("OBSTCLA", 10): 1.397897560,
    ("OBSTCLA", 23): 1.678027027,
    ("OBSTCLA", 32): 1.748270031,
    ("OBSTCLB", 4): -0.0081108,
    ("OBSTCLB", 10): 2.87503823,
    ("OBSTCLB", 23): 6.51932527,
    ("OBSTCLB", 32): 6.88708670,
    ("TORSION", 4): -0.51851852,
    ("TORSION", 10): -0.49234185,
    ("TORSION", 22): -0.45608771,
}


def murty(n: int) -> tuple[np.ndarray, np.ndarray]:
    """M lower triangular, 1 on and 2 below the diagonal; q = -1; answer e1."""
    return np.eye(n) + 2 * np.tri(n, k=-1), -np.ones(n)


def fathi(n: int) -> tuple[np.ndarray, np.ndarray]:
    """M M^T of Murty's: symmetric and definite; q = -1; answer e1."""
    M, q = murty(n)
    return M @ M.T, q


def csizmadia(n: int) -> tuple[np.ndarray, np.ndarray]:
    """2 I - tril(1): 1 on, -1 below the diagonal; q = e - M e; answer 0."""
    M = 2 * np.eye(n) - np.tri(n)
    return M, np.ones(n) - M @ np.ones(n)


def ben_gharbia_gilbert(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Cyclic: 1 on the diagonal, 2 on the subdiagonal for odd n; 4/3 and 1/2 on two for even n; q = e; answer 0.

    Newton-min cycles with period n from the complement of the answer.
    """
    eye = np.eye(n)
    below, second = np.roll(eye, 1, axis=0), np.roll(eye, 2, axis=0)
    return (eye + 2 * below if n % 2 else eye + 4 / 3 * below + second / 2), np.ones(n)


CLASSICS: dict[str, Callable[[int], tuple[np.ndarray, np.ndarray]]] = {
    "Murty": murty,
    "Fathi": fathi,
    "Csizmadia": csizmadia,
    "Ben Gharbia-Gilbert": ben_gharbia_gilbert,
}


def classic(name: str, n: int) -> Bounded:
    """The LCP w = M z + q as a body before the wall z = 0."""
    M, q = CLASSICS[name](n)
    answer = np.eye(n)[0] if name in ("Murty", "Fathi") else np.zeros(n)
    symmetric = bool(np.array_equal(M, M.T))
    K, up = sparse.csc_matrix(M), np.full(n, np.inf)
    return Bounded(f"{name} {n}", K, -q, np.zeros(n), up, np.ones(n), answer=answer, symmetric=symmetric)


def collection() -> list[Bounded]:
    """The problems that algorithms are compared on."""
    sides = [obstacle(f"OBSTCL{name}", points) for name in ("AE", "AL", "BL", "BM", "BU") for points in (10, 23)]
    bars = [torsion(c, points) for c in (5.0, 10.0, 20.0) for points in (10, 22)]
    return [*sides, *bars, *(classic(name, n) for name in CLASSICS for n in (3, 5, 8, 10))]


WAYS: dict[str, tuple[str, dict[str, float]]] = {
    "trial-and-error": ("trial-and-error", {}),
    "semismooth, settle 1": ("semismooth", {"settle": 1.0}),
    "semismooth": ("semismooth", {}),
    "regularised": ("regularised", {"epsilon": 1e8}),
}


def small() -> Bounded:
    """A symmetric, positive definite problem of three unknowns x >= 0 on which swapping all violators has period 3.

    The matrix is recalled from Curtis, Han, Robinson, Comput. Optim. Appl. 60 (2015) 311-341; f was found by search.
    """
    K = sparse.csc_matrix(np.array([[4.0, 5.0, -5.0], [5.0, 9.0, -5.0], [-5.0, -5.0, 7.0]]))
    above, zero = np.full(3, np.inf), np.zeros(3)
    return Bounded("3x3", K, np.array([2.0, 1.0, -3.0]), zero, above, zero)


def plain_period(body: Bounded) -> int:
    """Period of the plain active set, 0 when it settles: both bounds are one set, an unknown may jump between them.

    Source: Bergounioux, Ito, Kunisch, SIAM J. Control Optim. 37 (1999) 1176-1194, with one bound.
    """
    seen: dict[bytes, int] = {}
    x, force = body.start, body.K @ body.start - body.f
    while True:
        side = _side(body, x, force)
        if side.tobytes() in seen:
            period = len(seen) - seen[side.tobytes()]
            return 0 if period == 1 else period
        seen[side.tobytes()] = len(seen)
        free = side == 0
        x = np.where(side < 0, body.low, np.where(side > 0, body.up, 0.0))
        x[free] = sparse.linalg.spsolve(body.K[free][:, free], (body.f - body.K @ x)[free])
        force = np.where(free, 0.0, body.K @ x - body.f)


def _side(body: Bounded, x: np.ndarray, force: np.ndarray) -> np.ndarray:
    """-1 at the lower bound, 1 at the upper, 0 free (n,), by force and violation together."""
    return np.where(force + body.low - x > 0, -1, np.where(force + body.up - x < 0, 1, 0))


def _begin(body: Bounded) -> ContactSolution:
    """The start of the body with the set that the plain one begins with."""
    side = _side(body, body.start, body.K @ body.start - body.f)
    below, above = np.isfinite(body.low), np.isfinite(body.up)
    return replace(body.begin(), active=np.concatenate([side[below] < 0, side[above] > 0]))


def problems() -> list[Bounded]:
    """Those on which the plain set goes round, and one on which it does not."""
    sides = [obstacle(f"OBSTCLB{start}", 23) for start in "LMU"]
    cyclic = [replace(classic("Ben Gharbia-Gilbert", n), start=-np.eye(n)[0]) for n in (3, 5, 7)]
    return [small(), *cyclic, *sides, torsion(5.0, 22)]


@tabulated
def cycles() -> Iterator[Row]:
    """One row a problem: period of the plain set; then, for each way, its outcome and whether it noticed a cycle."""
    for body in problems():
        row: Row = {"problem": body.name, "plain_period": plain_period(body)}
        for way, (name, settings) in WAYS.items():
            solution = ALGORITHMS[name](**{"epsilon": math.inf} | settings).solve(body.problem(), _begin(body))
            noticed = events(solution.history, EventKind.CYCLE)
            row[way] = solution.outcome.word + (", cycle detected" if noticed else "")
        yield row

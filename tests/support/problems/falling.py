"""The height of a profile, written down otherwise than by its pieces.

Elastic nets that random balls, drums and bars come down on, and the swept way of a point by means of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.optimize import brentq

from contact.obstacles.cleat import Profile, cleat
from contact.obstacles.drum_sphere import Drum, Sphere
from contact.obstacles.foundation import Candidates, against, travelling
from contact.problem import ContactProblem, ContactSolution, Linearise, linear_mechanics
from contact.swept import FREE, SLID, TOUCHING


def rounded_height(corners: list[tuple[float, float]], radius: float) -> Callable[[np.ndarray], np.ndarray]:
    """Height t(s) of the same profile written with circles found by their touching both lines, flanks under 90."""
    v = [np.array(c, float) for c in corners]
    far = 50.0
    points = [v[0] - [far, 0], *v, v[-1] + [far, 0]]
    parts = []
    for before, at, after in zip(points[:-2], points[1:-1], points[2:], strict=True):
        a, b = (before - at) / np.linalg.norm(before - at), (after - at) / np.linalg.norm(after - at)
        bisector = (a + b) / np.linalg.norm(a + b)
        centre = at + radius / math.sqrt((1 - a @ b) / 2) * bisector  # sine of half the inner angle
        touch = sorted([(at + ((centre - at) @ a) * a)[0], (at + ((centre - at) @ b) * b)[0]])
        parts.append((touch, centre, np.sign(-bisector[1])))

    def height(s: np.ndarray) -> np.ndarray:
        t = np.interp(s, [p[0] for p in points], [p[1] for p in points])
        for (low, high), centre, sign in parts:
            on = (s >= low) & (s <= high)
            t[on] = centre[1] + sign * np.sqrt(np.maximum(radius**2 - (s[on] - centre[0]) ** 2, 0))
        return t

    return height


UP, DOWN = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -1.0])
CLOSE = 1e-6  # to a limit of the rule: not to be decided
LYING = 1e-9  # deep: on a level top, not inside


@dataclass(frozen=True, eq=False)
class Net:
    """side x side points at distance 1 in z = 0, held by springs to their neighbours, to a fixed rim and to rest.

    In their plane all of them are ``stiffer`` by a factor, or points would slip off small obstacles.  by_arc: whether
    the travel may be an unknown.
    """

    foundation: Sphere | Drum | Profile
    travel: float
    bar: tuple[float, float, float, float] | None = None
    side: int = 5
    tension: float = 1.0
    anchor: float = 0.02
    stiffer: float = 30.0
    by_arc: bool = False

    @cached_property
    def places(self) -> np.ndarray:
        """(m, 3) at rest."""
        line = np.arange(self.side) - (self.side - 1) / 2
        return np.array([(x, y, 0.0) for x in line for y in line])

    @cached_property
    def mechanics(self) -> Linearise:
        """Linear."""
        n, eye = self.side, np.eye(self.side)
        chain = 2 * eye - np.eye(n, k=1) - np.eye(n, k=-1)
        net = self.tension * (np.kron(chain, eye) + np.kron(eye, chain)) + self.anchor * np.eye(n * n)
        K = sparse.csc_matrix(np.kron(net, np.diag([self.stiffer, self.stiffer, 1.0])))
        return linear_mechanics(K, np.zeros(3 * n * n), scale=self.tension)

    def problem_at(self, t: float) -> ContactProblem:
        """The foundation t of its travel down."""
        points = Candidates(self.places, sparse.csr_matrix(np.eye(self.places.size)), np.ones(len(self.places)))
        problem = against(self.mechanics, points, self.foundation.moved(t * self.travel * DOWN))
        moves = self.travel * DOWN
        if not self.by_arc:
            return problem
        return replace(problem, travel=lambda: travelling(self.mechanics, points, self.foundation, moves))

    @property
    def rest(self) -> ContactSolution:
        """Flat, before the foundation."""
        return ContactSolution.at_rest(self.places.size, len(self.places))

    def seen(self, t: float, u: np.ndarray) -> np.ndarray:
        """Points (m, 3) less the travel of the foundation."""
        return self.places + u.reshape(-1, 3) - t * self.travel * DOWN

    def turns(self, a: np.ndarray, b: np.ndarray) -> list[float]:
        """Cosines of the normals where the segment from a to b (3,) goes in and where it comes out, or ends.

        Of balls and drums by the roots of |a + s v|^2 = R^2, of bars by 4001 points and the height of the profile.
        """
        if isinstance(self.foundation, Profile):
            return self._turns_on_bar(a, b)
        across = np.eye(3)
        if isinstance(self.foundation, Drum):
            across -= np.outer(self.foundation.axis, self.foundation.axis)
        arm, v = across @ (a - self.foundation.centre), across @ (b - a)
        root = (arm @ v) ** 2 - v @ v * (arm @ arm - self.foundation.radius**2)
        if v @ v == 0 or root <= 0:
            return []
        low, high = np.clip((-arm @ v + np.array([-1, 1]) * math.sqrt(root)) / (v @ v), 0, 1)
        one, other = arm + low * v, arm + high * v
        return [float(one @ other / np.linalg.norm(one) / np.linalg.norm(other))] if high > low else []

    def _turns_on_bar(self, a: np.ndarray, b: np.ndarray) -> list[float]:
        profile, (high, top, flank, rounding) = self.foundation, self.bar
        foot = top / 2 + high / math.tan(math.radians(flank))
        height = rounded_height([(-foot, 0), (-top / 2, high), (top / 2, high), (foot, 0)], rounding)

        def at(share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            y = a + np.atleast_1d(share)[:, None] * (b - a)
            return y @ profile.travel - profile.centre, profile.offset - y @ profile.normal

        def above(share: float) -> float:
            s, t = at(share)
            return float(t[0] - height(s)[0]) + LYING

        def normal(share: float) -> np.ndarray:
            s, h = at(share)[0], 1e-7
            n = np.array([-(height(s + h) - height(s - h))[0] / (2 * h), 1.0])
            return n / np.linalg.norm(n)

        share = np.linspace(0, 1, 4001)
        s, t = at(share)
        inside = t < height(s) - LYING
        changes = np.flatnonzero(inside[1:] != inside[:-1])
        ends = [_root(above, share[k], share[k + 1]) for k in changes]
        ends = ([0.0] if inside[0] else []) + ends + ([1.0] if inside[-1] else [])
        return [float(normal(low) @ normal(high)) for low, high in zip(ends[::2], ends[1::2], strict=True)]


def _root(f: Callable[[float], float], low: float, high: float) -> float:
    """Where f changes its sign; at the lower end where that is a matter of rounding."""
    return float(brentq(f, low, high, xtol=1e-13)) if f(low) * f(high) < 0 else low


def falling(rng: np.random.Generator, kind: str) -> Net:
    """A ball, a drum or a bar a little above the net, of any size, that comes down by any travel."""
    radius, aside = math.exp(rng.uniform(math.log(0.05), math.log(3.0))), rng.uniform(-0.5, 0.5, 2)
    turn, lift, travel = rng.uniform(0, math.pi), rng.uniform(0.01, 0.3), rng.uniform(0.5, 4.0)
    along = np.array([math.cos(turn), math.sin(turn), 0.0])
    centre = np.array([*aside, lift + radius])
    if kind == "ball":
        return Net(Sphere(centre, radius), travel)
    if kind == "drum":
        return Net(Drum(centre, along, radius), travel)
    bar = rng.uniform(0.5, 5.0), 0.5 + rng.uniform(0, 2), float(rng.choice([60.0, 80.0, 88.0])), min(radius, 0.2)
    return Net(Profile(UP, lift + bar[0], along, float(aside @ along[:2]), cleat(*bar)), travel, bar)


def passing(net: Net, before: np.ndarray, after: np.ndarray) -> tuple[set[int], set[int]]:
    """Points that pass through the foundation from one place (m, 3), seen from it, to another; and those that may."""
    surely, perhaps = set(), set()
    for i, (a, b) in enumerate(zip(before, after, strict=True)):
        open_at_start = net.foundation.gap(a[None])[0] > TOUCHING * np.linalg.norm(b - a)
        limit = FREE if open_at_start else SLID
        for turn in net.turns(a, b):
            if turn < limit - CLOSE:
                surely.add(i)
            elif turn < limit + CLOSE:
                perhaps.add(i)
    return surely, surely | perhaps

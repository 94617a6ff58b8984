"""The problems of a card: a frozen sample, problems with built-in answers, small scenes, and hard points of scenes.

The sample, about twenty small steps made in a few seconds, is taken by the rule of the collection from a few of its
paths. All parts get the same problems; none is run here. For the laws there are problems of a few unknowns with dense
random matrices, some with a built-in answer, and an independent method of solution.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse
from scipy.optimize import nnls

from contact.interchange.linearised_step import FrozenStep, freeze
from contact.problem import ContactProblem, ContactSolution, Outcome, linear_mechanics
from studies.arena.collected.candidates import Path as Walk
from studies.arena.collected.candidates import candidates
from studies.arena.collected.rule import Rule, Taken
from studies.fuzz.posed import made as random_matrices

FROZEN, MADE, SCENE, HARD = "frozen", "made", "scene", "hard"
GROUPS = {
    FROZEN: "frozen steps of the collection",
    MADE: "random matrices made from their answer",
    SCENE: "small scenes",
    HARD: "hard points",
}
CASES = range(24)  # of random matrices


@dataclass(frozen=True, eq=False)
class Posed:
    """A contact problem, its answer, and its frozen step, if there is one."""

    group: str
    name: str
    problem: ContactProblem
    answer: ContactSolution
    step: FrozenStep | None = None


@dataclass(frozen=True)
class Asked:
    """A request of a scene; why: the difficulty of a hard point."""

    group: str
    scene: str
    mesh: str
    settings: Mapping[str, str] = field(default_factory=dict)
    why: str = ""

    @property
    def name(self) -> str:
        """The request as one line, after its difficulty."""
        request = " ".join([self.scene, self.mesh, *(f"{key}={value}" for key, value in self.settings.items())])
        return f"{self.why}: {request}" if self.why else request


DECLARED: dict[str, list[Any]] = tomllib.loads(Path(__file__).with_name("problems.toml").read_text(encoding="utf-8"))
PATHS = tuple(Walk(**each) for each in DECLARED["paths"])
SMALL, BENT = (tuple(Asked(SCENE, **each) for each in DECLARED[name]) for name in ("small", "bent"))
POINTS = tuple(Asked(HARD, **each) for each in DECLARED["points"])


@lru_cache(maxsize=1)
def sample() -> tuple[Taken, ...]:
    """Frozen problems with their certified answers, always the same in the same order."""
    rule = Rule()
    selected = (each for each in candidates(PATHS) if "scene" in each.origin or each.name in DECLARED["published"])
    return tuple(taken for taken in map(rule.taken, selected) if taken is not None)


def posed(epsilon: float) -> Iterator[Posed]:
    """The frozen sample, and random matrices whose answers obey the law of an epsilon [MPa/mm]."""
    yield from frozen()
    yield from made(epsilon)


def frozen() -> Iterator[Posed]:
    """The sample with its certified answers."""
    for taken in sample():
        step, certified = taken.candidate.step, taken.answer
        answer = ContactSolution(certified.du, certified.pressure, certified.pressed, Outcome.CONVERGED)
        yield Posed(FROZEN, taken.candidate.name, step.problem(), answer, step)


def made(epsilon: float) -> Iterator[Posed]:
    """Random matrices, one per seed; see :mod:`studies.fuzz.posed`."""
    for seed in CASES:
        yield Posed(MADE, f"matrices {seed}", *random_matrices(seed, epsilon))


def frozen_of(case: Posed) -> FrozenStep:
    """The step of a problem that is linear in its displacements."""
    return case.step or freeze(case.problem, np.zeros_like(case.answer.u), np.zeros_like(case.answer.pressure), {})


# --- random matrices --------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Quadratic:
    """min 1/2 u.K.u - f.u under g0 + G u >= 0, with contact areas w; (n,), (m,), dense matrices."""

    K: np.ndarray
    f: np.ndarray
    G: np.ndarray
    g0: np.ndarray
    w: np.ndarray

    def problem(self, coupling: np.ndarray | None = None) -> ContactProblem:
        """As a contact problem; coupling: consistent W (m, m), default diag(w)."""
        G = sparse.csr_matrix(self.G)
        return ContactProblem(
            linear_mechanics(sparse.csc_matrix(self.K), self.f),
            lambda u: self.g0 + G @ u,
            lambda u: G,
            self.w,
            None if coupling is None else sparse.csr_matrix(coupling),
        )

    def step(self) -> FrozenStep:
        """As a step from u = 0."""
        return freeze(self.problem(), np.zeros_like(self.f), np.zeros_like(self.g0), {})


_EYE, _ONES, _FAR = np.eye(2), np.ones(2), np.array([10.0, 10.0])
HOPELESS = {  # problems without an answer, or with NaN
    "no number": Quadratic(_EYE, np.array([np.nan, 0.5]), -_EYE, _FAR, _ONES),
    "no solution": Quadratic(np.diag([-1.0, 1.0]), np.array([1.0, 0.0]), _EYE, np.zeros(2), _ONES),
    "no stiffness": Quadratic(np.zeros((2, 2)), np.array([1.0, 0.5]), -_EYE, _FAR, _ONES),
}


def stieltjes(rng: np.random.Generator, n: int) -> np.ndarray:
    """Symmetric, diagonally dominant, no positive entry off the diagonal: active sets converge monotonically."""
    links = np.triu(rng.random((n, n)) * (rng.random((n, n)) < 0.5), 1)
    links = links + links.T
    return np.diag(links.sum(axis=1) + rng.uniform(0.1, 1, n)) - links


def definite(rng: np.random.Generator, n: int) -> np.ndarray:
    """Symmetric and positive definite, otherwise arbitrary."""
    root = rng.normal(size=(n, n))
    return root @ root.T / n + 0.2 * np.eye(n)


def random_quadratic(rng: np.random.Generator, kind: str, m: int = 6) -> Quadratic:
    """``obstacle``: M-matrix, one unknown a row; ``definite``: any SPD matrix; ``inclined``: three unknowns a row."""
    per_row = 3 if kind == "inclined" else 1
    n = per_row * m + 2
    K = stieltjes(rng, n) if kind == "obstacle" else definite(rng, n)
    unknowns = rng.permutation(n)[: per_row * m].reshape(m, per_row)
    G = np.zeros((m, n))
    slopes = rng.uniform(0.5, 2, (m, per_row))
    G[np.arange(m)[:, None], unknowns] = -slopes if kind == "obstacle" else slopes * rng.choice([-1, 1], slopes.shape)
    return Quadratic(K, rng.normal(size=n), G, rng.uniform(-0.3, 0.6, m), rng.uniform(0.5, 2, m))


OPEN, PRESSED, TOUCHING = range(3)


def manufactured(
    rng: np.random.Generator, kind: str, states: np.ndarray, epsilon: float = math.inf, size: float | np.ndarray = 1.0
) -> tuple[Quadratic, np.ndarray, np.ndarray]:
    """A problem whose only solution u, p is built in: each candidate OPEN, PRESSED, or TOUCHING without pressure.

    ``size`` (m,): how far open [mm] or how strongly pressed [MPa]; the touching have exactly zero of both.
    """
    data = random_quadratic(rng, kind, len(states))
    u = rng.normal(size=len(data.f))
    pressure = np.where(states == PRESSED, size * rng.uniform(0.5, 2, len(states)), 0.0)
    gap = np.where(states == OPEN, size * rng.uniform(0.5, 2, len(states)), 0.0) - pressure / epsilon
    f = data.K @ u - data.G.T @ (data.w * pressure)
    return Quadratic(data.K, f, data.G, gap - data.G @ u, data.w), u, pressure


def dual_by_nnls(data: Quadratic, epsilon: float) -> tuple[np.ndarray, np.ndarray]:
    """u (n,) and p (m,) from the dual: min 1/2 mu.S.mu + c.mu, mu >= 0, S = G K^-1 G^T + 1/(epsilon W)."""
    flexibility = np.linalg.solve(data.K, data.G.T)
    S = data.G @ flexibility + np.diag(1 / (epsilon * data.w))
    c = data.g0 + data.G @ np.linalg.solve(data.K, data.f)
    root_of_S = np.linalg.cholesky(S)
    mu, _ = nnls(root_of_S.T, -np.linalg.solve(root_of_S, c))
    return np.linalg.solve(data.K, data.f) + flexibility @ mu, mu / data.w

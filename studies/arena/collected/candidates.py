"""Candidate steps without friction for the collection: iterates along paths, published problems, and derived forms.

The linearisation at an iterate of a path is recorded as the algorithm gets it: tangent and residual with the memory of
the element, gaps, and the curvature of the gap under the current forces. Paths are listed in paths.toml; which
candidates are taken is a rule (:mod:`studies.arena.collected.rule`); no file is written here.
"""

from __future__ import annotations

import json
import math
import tomllib
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product
from typing import ClassVar

import numpy as np
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep, freeze
from contact.parameters import Parameter
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Linearised
from contact.solvers.sparse import checked_solve, factorise, symmetric
from studies.arena.collected.certified import Certified, NotCertifiedError, exact_on
from studies.arena.collected.collection import HERE, Candidate
from studies.ask.settings import configured
from studies.experiments.obstacles import CLASSICS, Bounded, classic, obstacle, torsion
from studies.scenes.complete import complete
from studies.scenes.walk import walk

PUBLIC = "public_lcps.json"
TOUCHING, CONDENSED = "touching", "condensed"
PRESSED, RAISED = 1, 2  # candidates of a step by the answer that its touching form is made from
LARGE = 120_000  # entries of K beyond which a step has no derived forms: they would fill the collection
DENSE = 300  # candidates whose compliance is written as a full matrix


@dataclass(frozen=True)
class Path:
    """A request; looks: number of iterates taken from a solve, the first ones and the last, 0 for all."""

    scene: str
    mesh: str
    settings: Mapping[str, str] = field(default_factory=dict)
    looks: int = 0

    @property
    def name(self) -> str:
        """The request as one word."""
        settings = [f"{key}={value}".replace(",", "_") for key, value in self.settings.items()]
        return "-".join([self.scene, self.mesh, *settings])


def paths() -> Iterator[Path]:
    """All paths of the collection in order (paths.toml)."""
    for each in tomllib.loads(HERE.joinpath("paths.toml").read_text(encoding="utf-8"))["looked"]:
        meshes, looks = each.pop("meshes"), each.pop("looks", 0)
        requests = [(scene, settings) for scene, several in each.items() for settings in several]
        yield from (Path(scene, mesh, settings, looks) for mesh, (scene, settings) in product(meshes, requests))


@dataclass(eq=False)
class Iterate:
    """The linearisation at u (n,), and the nodal forces (m,) of its gap curvature, if that was used."""

    problem: ContactProblem
    u: np.ndarray
    lin: Linearised
    forces: np.ndarray | None = None

    @property
    def step(self) -> FrozenStep:
        """The problem of the Newton step from this iterate."""
        problem, lin, K = self.problem, self.lin, self.lin.tangent
        if problem.gap_curvature is not None and self.forces is not None:
            K = sparse.csc_matrix(K - problem.gap_curvature(self.u, self.forces))
        G = sparse.csr_matrix(problem.gap_jacobian(self.u))
        return FrozenStep(K, lin.residual, G, problem.gap(self.u), problem.weights, lin.scale, problem.coupling)


@dataclass(eq=False)
class Watched(ABC):
    """A wrapper of the algorithm ``inside`` on a path; a :class:`contact.problem.ContactAlgorithm`."""

    inside: ContactAlgorithm
    name: ClassVar[str] = "watched"
    parameters: ClassVar[tuple[Parameter, ...]] = ()

    @property
    def epsilon(self) -> float:
        """Of the algorithm inside [MPa/mm]."""
        return self.inside.epsilon

    def supports(self, problem: ContactProblem) -> str | None:
        """As the algorithm inside."""
        return self.inside.supports(problem)

    @abstractmethod
    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """The answer of the algorithm inside, with a record of the solve."""


@dataclass(eq=False)
class Recorder(Watched):
    """Records the linearisations: ``solves`` has the iterates of each call, and whether it converged."""

    solves: list[tuple[list[Iterate], bool]] = field(default_factory=list)

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Solve, and record each linearisation; not without candidates, nor where the travel is an unknown, too."""
        iterates: list[Iterate] = []
        kept = len(problem.weights) and not problem.driven
        solution = self.inside.solve(_noting(problem, iterates) if kept else problem, start)
        self.solves.append((iterates, solution.outcome.converged))
        return solution


def _noting(problem: ContactProblem, iterates: list[Iterate]) -> ContactProblem:
    def linearise(u: np.ndarray, memory: object) -> Linearised:
        iterates.append(Iterate(problem, u.copy(), problem.linearise(u, memory)))
        return iterates[-1].lin

    def curvature(u: np.ndarray, forces: np.ndarray) -> sparse.csc_matrix:
        assert problem.gap_curvature is not None
        if iterates and np.array_equal(u, iterates[-1].u):
            iterates[-1].forces = forces.copy()
        return problem.gap_curvature(u, forces)

    return replace(problem, linearise=linearise, gap_curvature=None if problem.gap_curvature is None else curvature)


def on_path(path: Path) -> Iterator[Candidate[FrozenStep]]:
    """The iterates taken along a path; raises UsageError where the request is invalid.

    All iterates of a solve, or its first ones and the last but one, whose step is still more than rounding.
    """
    scene, request = complete(path.scene, path.settings, path.mesh)
    recorder = Recorder(configured(request.contact, request.settings))
    settings, number = " ".join(f"{key}={value}" for key, value in path.settings.items()), 0
    for visited in walk(scene.build(request).stages(), recorder, request.steps):
        at = {"stage": visited.stage.name, "target": visited.point.requested, "settings": settings}
        for iterates, arrived in recorder.solves:
            number, count = number + 1, len(iterates)
            chosen = sorted({*range(path.looks - 1), count - 2}) if path.looks else range(count)
            for i in (i for i in chosen if 0 <= i < count):
                origin = {"scene": path.scene, "mesh": path.mesh, **at, "solve": number, "iteration": i}
                name = f"{path.name}-s{number}i{i}"
                yield Candidate(path.scene, name, {**origin, "arrived": arrived}, iterates[i].step)
        recorder.solves.clear()


def published() -> Iterator[Candidate[FrozenStep]]:
    """Obstacle problems, classics of linear complementarity, and test problems of Siconos."""
    for body in _bounded():
        name = body.name.replace(" ", "-").replace("=", "")
        family = "-".join(word for word in body.name.split() if not any(map(str.isdigit, word)))
        yield Candidate(family, name, {"source": body.name}, frozen(body))
    record = json.loads(HERE.joinpath(PUBLIC).read_text(encoding="utf-8"))
    for name, given in record["problems"].items():
        step = of_complementarity(np.array(given["M"], float), np.array(given["q"], float))
        yield Candidate("siconos", f"siconos-{name}", {"source": record["source"]}, step, record["licence"])


def _bounded() -> Iterator[Bounded]:
    for points in (5, 10, 23, 46):
        for name in ("OBSTCLAL", "OBSTCLBL"):
            yield obstacle(name, points)
        yield torsion(5.0, points)
        yield torsion(20.0, points)
    for points in (102, 318):
        yield small_die(points)
    for name in CLASSICS:
        for n in (3, 10, 30, 100):
            yield classic(name, n)


def small_die(points: int) -> Bounded:
    """The membrane of OBSTCLAL where only a square of 40 x 40 points in the middle may touch the obstacle."""
    whole = obstacle("OBSTCLAL", points)
    inner = np.arange(points - 2) - (points - 2) // 2
    near = np.logical_and.outer(np.abs(inner) < 20, np.abs(inner) < 20).ravel()
    low = np.where(near, whole.low, -math.inf)
    return Bounded(f"DIE {points}", whole.K, whole.f, low, whole.up, whole.start)


def frozen(body: Bounded) -> FrozenStep:
    """A body between bounds as a step from x = 0."""
    problem = body.problem()
    return freeze(problem, np.zeros(len(body.f)), np.zeros(len(problem.weights)), {})


def of_complementarity(M: np.ndarray, q: np.ndarray) -> FrozenStep:
    """The problem z >= 0, M z + q >= 0, z.(M z + q) = 0 as a step: du = z moves candidates along rows of unity, K = M.

    M (n, n), q (n,); the pressures of the step are M z + q.
    """
    n = len(q)
    scale = float(np.linalg.norm(q))
    return FrozenStep(sparse.csc_matrix(M), q, sparse.csr_matrix(sparse.eye_array(n)), np.zeros(n), np.ones(n), scale)


def derived(of: Candidate[FrozenStep], answer: Certified) -> Iterator[Candidate[FrozenStep]]:
    """The derived forms of a step with a known answer, where they exist and the step is not large."""
    if of.step.K.nnz > LARGE:
        return
    states = raised(answer)
    if states is not None:
        yield replace(form_of(of, TOUCHING, touching(of.step, states)), states=states)
    if has_dual(of.step):
        yield form_of(of, CONDENSED, condensed(of.step))


def form_of(of: Candidate[FrozenStep], form: str, step: FrozenStep) -> Candidate[FrozenStep]:
    """A derived form of a candidate."""
    return Candidate(form, f"{of.name}-{form}", of.origin | {"form": form}, step, of.licence)


def raised(answer: Certified) -> np.ndarray | None:
    """(m,): the candidates that are PRESSED, and RAISED every second that is left open; None where nothing is open."""
    chosen = np.flatnonzero(~answer.pressed & ~answer.touching)[::2]
    if not len(chosen):
        return None
    states = np.where(answer.pressure > 0, PRESSED, 0).astype(np.int8)
    states[chosen] = RAISED
    return states


def touching(step: FrozenStep, states: np.ndarray) -> FrozenStep:
    """The foundation raised to some candidates that are open in an answer: they touch without force.

    The answer on the set PRESSED remains valid. Raises NotCertifiedError where the set has none, or has another number
    of candidates.
    """
    if len(states) != len(step.gap):
        raise NotCertifiedError(f"{len(states)} states of {len(step.gap)} candidates")
    gap = step.gap + step.G @ exact_on(step, states == PRESSED)[0]
    return FrozenStep(**{**vars(step), "gap": np.where(states == RAISED, step.gap - gap, step.gap)})


def has_dual(step: FrozenStep) -> bool:
    """Not with consistent coupling, beyond DENSE candidates, or where a candidate has no area."""
    return step.coupling is None and 1 < len(step.gap) <= DENSE and bool(np.all(step.weights > 0))


def condensed(step: FrozenStep) -> FrozenStep:
    """The step in its nodal forces f [N] alone, the dual: f >= 0, s = H f + q >= 0, f.s = 0.

    H = G K^-1 G^T [mm/N], q = g - G K^-1 r [mm]. Units change places: unknowns are forces, pressures are gaps.
    """
    solve = partial(checked_solve, factorise(step.K), step.K)
    columns = np.column_stack([solve(row) for row in step.G.toarray()])
    H = np.asarray(step.G @ columns)
    return of_complementarity((H + H.T) / 2 if symmetric(step.K) else H, step.gap - step.G @ solve(step.r))


def candidates(paths: Iterable[Path]) -> Iterator[Candidate[FrozenStep]]:
    """All published problems, then the iterates along the paths."""
    yield from published()
    for path in paths:
        yield from on_path(path)

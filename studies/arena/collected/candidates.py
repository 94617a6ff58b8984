"""Steps that the collection may take: iterates along paths, published problems, and forms derived from a step.

Which of them are taken is a rule (:mod:`studies.arena.collected.rule`); no file is written here.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib.resources import files
from typing import Any

import numpy as np
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep
from contact.solvers.sparse import checked_solve, factorise, symmetric
from studies.arena.collected.certified import Certified, NotCertifiedError, exact_on
from studies.arena.collected.newton_path import Met, newton_path
from studies.arena.collected.paths import Path
from studies.experiments.obstacle_problems.collection import CLASSICS, Bounded, classic, obstacle, torsion

LICENCE = "MIT"
PUBLIC = "public_lcps.json"
TOUCHING, CONDENSED = "touching", "condensed"
PRESSED, RAISED = 1, 2  # candidates of a step by the answer that its touching form is made from
LARGE = 120_000  # entries of K beyond which a step has no derived forms: they would fill the collection
DENSE = 300  # candidates whose compliance is written as a full matrix


@dataclass(frozen=True, eq=False)
class Candidate:
    """A step that may be taken: its family, its name in the collection, where it is from, and its licence.

    states: of a touching form the candidates (m,) that are PRESSED and RAISED, else None.
    """

    family: str
    name: str
    origin: dict[str, Any]
    step: FrozenStep
    licence: str = LICENCE
    states: np.ndarray | None = None


def on_path(path: Path) -> Iterator[Candidate]:
    """The iterates along a path that are looked at; raises UsageError where it cannot be asked for."""
    solve: list[Met] = []
    for met in newton_path(path.scene, path.settings, path.mesh):
        if solve and met.solve != solve[0].solve:
            yield from _looked_at(path, solve)
            solve = []
        solve.append(met)
    yield from _looked_at(path, solve)


def _looked_at(path: Path, solve: Sequence[Met]) -> Iterator[Candidate]:
    """All iterates of a solve, or its first ones and the last but one, from where a step still moves something."""
    chosen = range(len(solve)) if not path.looks else sorted({*range(path.looks - 1), len(solve) - 2})
    for i in chosen:
        if 0 <= i < len(solve):
            met = solve[i]
            origin = {"scene": path.scene, "mesh": path.mesh, "stage": met.stage, "target": met.target}
            origin |= {"settings": " ".join(f"{key}={value}" for key, value in path.settings.items())}
            origin |= {"solve": met.solve, "iteration": met.iteration, "arrived": met.arrived}
            yield Candidate(path.scene, f"{path.name}-s{met.solve}i{met.iteration}", origin, met.at.step)


def published() -> Iterator[Candidate]:
    """Obstacle problems, classics of linear complementarity, and those that Siconos is tested by."""
    for body in _bounded():
        name = body.name.replace(" ", "-").replace("=", "")
        family = "-".join(word for word in body.name.split() if not any(map(str.isdigit, word)))
        yield Candidate(family, name, {"source": body.name}, frozen(body))
    told = json.loads(files("studies.arena.collected").joinpath(PUBLIC).read_text(encoding="utf-8"))
    for name, given in told["problems"].items():
        step = of_complementarity(np.array(given["M"], float), np.array(given["q"], float))
        yield Candidate("siconos", f"siconos-{name}", {"source": told["source"]}, step, told["licence"])


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
    problem, zero = body.problem(), np.zeros(len(body.f))
    lin = problem.linearise(zero, None)
    return FrozenStep(body.K, lin.residual, problem.gap_jacobian(zero), problem.gap(zero), problem.weights, lin.scale)


def of_complementarity(M: np.ndarray, q: np.ndarray) -> FrozenStep:
    """The problem z >= 0, M z + q >= 0, z.(M z + q) = 0 as a step: du = z moves candidates along rows of unity, K = M.

    M (n, n), q (n,); the pressures of the step are M z + q.
    """
    n = len(q)
    scale = float(np.linalg.norm(q))
    return FrozenStep(sparse.csc_matrix(M), q, sparse.csr_matrix(sparse.eye_array(n)), np.zeros(n), np.ones(n), scale)


def derived(of: Candidate, answer: Certified) -> Iterator[Candidate]:
    """Forms of a step whose answer is known, where it has them and is not large."""
    if of.step.K.nnz > LARGE:
        return
    states = raised(answer)
    if states is not None:
        yield replace(form_of(of, TOUCHING, touching(of.step, states)), states=states)
    if has_dual(of.step):
        yield form_of(of, CONDENSED, condensed(of.step))


def form_of(of: Candidate, form: str, step: FrozenStep) -> Candidate:
    """A form of a step."""
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
    """The foundation raised to some candidates that an answer leaves open: they touch and carry nothing.

    That answer, the one on the set PRESSED, stays one. Raises NotCertifiedError where the set has none, or is of
    another number of candidates.
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


def candidates(paths: Iterable[Path]) -> Iterator[Candidate]:
    """All published problems, then the iterates along the paths."""
    yield from published()
    for path in paths:
        yield from on_path(path)

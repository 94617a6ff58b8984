"""Faulty algorithms and faulty models, and after how many random cases the fuzzer has found each.

A fault is there only while it is looked for: an algorithm of the catalogue, or a function of a model, gives way to a
wrapped one. A case that breaks a law without the fault is not a finding of it.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace
from typing import Any
from unittest.mock import patch

import numpy as np
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.continuation import stability
from contact.obstacles.drum_sphere import Round
from contact.problem import ContactProblem, ContactSolution, Outcome
from formulations.shell import ShellModel
from studies.ask.request import Request
from studies.fuzz.attempt import Asked
from studies.fuzz.cases import SCENE, asked_of, first_asked
from studies.fuzz.examine import BROKEN, examine
from studies.scenes.contact import panel
from studies.scenes.tyre import model as tyre_model
from studies.solving import certificate
from support import planted_in_friction
from support.planted_in_friction import Fault, fault

MOST = 500
Solve = Callable[[Semismooth, ContactProblem, ContactSolution], ContactSolution]


def right(own: Semismooth, problem: ContactProblem, start: ContactSolution, **other: Any) -> ContactSolution:
    """What the sound algorithm makes of it, with other parameters if any."""
    return Semismooth(**{**vars(own), **other}).solve(problem, start)


def algorithm(name: str) -> Callable[[Solve], Fault]:
    """A fault of the algorithm that everything is compared with."""

    def named(solve: Solve) -> Fault:
        faulty = type("Faulty", (Semismooth,), {"solve": solve})
        return Fault(name, lambda: patch.dict(ALGORITHMS, semismooth=faulty))

    return named


# --- algorithms -----------------------------------------------------------------------------------------------------


@algorithm("a node that penetrates most is left out")
def left_out(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """As if it were far away."""
    if not len(problem.weights):
        return right(own, problem, start)
    away = np.zeros(len(problem.weights))
    away[np.argmin(problem.gap(start.u))] = 1e3 * (1 + float(np.max(np.abs(problem.gap(start.u)))))
    return right(own, replace(problem, gap=lambda u: problem.gap(u) + away, only=None), start)


@algorithm("tension is allowed at one node")
def glued(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """The nearest open node is closed, too, and may pull."""
    solution = right(own, problem, start)
    open_nodes = np.flatnonzero(~solution.active)
    if not solution.outcome.converged or not len(open_nodes) or not solution.active.any():
        return solution
    nearest = open_nodes[np.argmin(problem.gap(solution.u)[open_nodes])]
    u, p, active = solution.u, solution.pressure, solution.active | (np.arange(len(solution.active)) == nearest)
    run = own.run(problem)
    for _ in range(8):
        du, p = run.step(problem.linearise(u, None), u, p, active)
        u = u + du
    return replace(solution, u=u, pressure=p, active=active)


@algorithm("pressures are those of the step before")
def stale(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """Where there were any."""
    solution = right(own, problem, start)
    before = solution.pressure * (1 - 1e-4) if not start.pressure.any() else start.pressure
    return replace(solution, pressure=before)


@algorithm("areas are a tenth too large")
def too_large(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """Pressures are too small by as much."""
    wrong = None if problem.coupling is None else 1.1 * problem.coupling
    return right(own, replace(problem, weights=1.1 * problem.weights, coupling=wrong, only=None), start)


@algorithm("the tolerance is ignored")
def loose(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """A hundredth of the forces may be out of balance."""
    return right(own, problem, start, tolerance=1e-2)


@algorithm("the iteration limit is called converged")
def at_the_limit(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """After two iterations."""
    solution = right(own, problem, start, max_iterations=2)
    return replace(solution, outcome=Outcome.CONVERGED, pressure=np.maximum(solution.pressure, 0.0))


@algorithm("it never ends once nodes touch")
def endless(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """Evaluates for ever."""
    solution = right(own, problem, start)
    while solution.active.sum() > 1:
        problem.linearise(solution.u, None)
    return solution


@algorithm("it raises with four nodes in contact")
def raises(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """An index out of range."""
    solution = right(own, problem, start)
    np.zeros(4)[int(solution.active.sum())]
    return solution


@algorithm("a finite epsilon is taken for infinite")
def exact(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """The constraint is exact whatever is asked for."""
    return right(own, problem, start, epsilon=np.inf)


@algorithm("the last candidate is never looked at")
def last_ignored(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """An end of a range that is one short."""
    away = np.zeros(len(problem.weights))
    away[-1:] = 1e6
    return right(own, replace(problem, gap=lambda u: problem.gap(u) + away, only=None), start)


@algorithm("it returns what is not a number")
def no_number(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """NaN displacements, reported as converged."""
    solution = right(own, problem, start)
    return replace(solution, u=np.full_like(solution.u, np.nan))


@algorithm("an end has no reason")
def silent(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """A refusal without a reason."""
    solution = right(own, problem, start)
    if solution.active.sum() < 3:
        return solution
    return replace(solution, outcome=Outcome.REFUSED, history=({},))


# --- models -----------------------------------------------------------------------------------------------------------


@fault("the normal of one node of a ball or drum points inwards", Round, "gradient")
def inwards(sound: Callable[..., np.ndarray], body: Round, x: np.ndarray) -> np.ndarray:
    """Of the first candidate."""
    return sound(body, x) * np.where(np.arange(len(x)) == 0, -1.0, 1.0)[:, None]


@fault("a ball or drum has no curvature", Round, "curvature")
def flat(sound: Callable[..., np.ndarray], body: Round, x: np.ndarray) -> np.ndarray:
    """As if it were a plane."""
    return np.zeros((len(x), 3, 3))


@fault("nodes on the seam of half a tyre have twice their area", tyre_model, "_candidates")
def doubled(sound: Callable[..., Any], shell: ShellModel, part: Any, area: str, *, coupled: bool) -> Any:
    """Those that both halves have."""
    nodes, candidates = sound(shell, part, area, coupled=coupled)
    on_seam = np.isin(part.grid.nodes[nodes, 1], part.grid.ends[1]) & (part.copies > 1)
    return nodes, replace(candidates, weights=np.where(on_seam, 2.0, 1.0) * candidates.weights)


@fault("a thickness stays in mm in other units", panel, "_wall")
def unscaled(sound: Callable[..., Any], request: Request, h: float, stress: float) -> Any:
    """Whatever the unit of length."""
    return sound(request, h / request.number("length_unit"), stress)


@fault("the tangent is a thousandth too stiff", ShellModel, "linearise")
def stiffened(sound: Callable[..., Any], *arguments: Any) -> Any:
    """All of it, its residual untouched."""
    lin = sound(*arguments)
    return replace(lin, tangent=sparse.csc_matrix(1.001 * lin.tangent))


@fault("two negative eigenvalues too many are counted", certificate, "stability")
def two_too_many(sound: Callable[..., Any], *arguments: Any) -> Any:
    """Where any are."""
    inertia = sound(*arguments)
    return inertia if inertia.negative is None else replace(inertia, negative=inertia.negative + 2)


@fault("modes of elements are counted as those of the body", stability, "_apart", SCENE)
def with_the_body(
    sound: Callable[..., Any], problem: Any, state: Any, K: Any, epsilon: Any, inertia: Any, overlooked: Any
) -> Any:
    """None is set apart."""
    return inertia


FAULTS = (
    *(left_out, glued, stale, too_large, loose, at_the_limit, endless, raises, exact, last_ignored, no_number, silent),
    *(inwards, flat, doubled, unscaled, stiffened, two_too_many, with_the_body),
    *planted_in_friction.FAULTS,
)


def found_after(looked_for: Fault, most: int = MOST, among: Callable[[Asked], bool] | None = None) -> tuple[int, str]:
    """How many cases it took, and by which law it was found; 0 cases where none of ``most`` has.

    among: requests that are examined, and counted; the others are passed over.
    """
    kind = looked_for.kind or ("" if among is None else SCENE)
    seeds = (seed for seed in itertools.count() if among is None or _drawn_among(seed, among))
    for cases, seed in enumerate(itertools.islice(seeds, most), 1):
        with looked_for.planted():
            report = examine(seed, kind)
        if report.verdict == BROKEN and examine(seed, kind).verdict != BROKEN:
            return cases, report.law
    return 0, ""


def _drawn_among(seed: int, among: Callable[[Asked], bool]) -> bool:
    """Of the request that is solved; its scene is built only where what was drawn first is among them, too."""
    return among(first_asked(seed, SCENE)[0]) and among(asked_of(seed))

"""Faulty algorithms and faulty models, and after how many random cases the fuzzer has found each.

A fault is there only while it is looked for: an algorithm of the catalogue, or a function of a model, gives way to a
wrapped one. A case that breaks a law without the fault is no finding of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.continuation import stability
from contact.obstacles.drum_sphere import Round
from contact.problem import ContactProblem, ContactSolution, Outcome
from formulations.shell import ShellModel
from studies import certificate
from studies.experiments import planted_in_friction
from studies.experiments.planting import Fault, swapped
from studies.fuzz.cases import SCENE, Asked, asked_of
from studies.fuzz.examine import BROKEN, examine
from studies.scenes.contact import panel
from studies.scenes.tyre import model as tyre_model

MOST = 500
Solve = Callable[[Semismooth, ContactProblem, ContactSolution], ContactSolution]


def right(own: Semismooth, problem: ContactProblem, start: ContactSolution, **other: Any) -> ContactSolution:
    """What the sound algorithm makes of it, with other parameters if any."""
    return Semismooth(**{**vars(own), **other}).solve(problem, start)


def algorithm(name: str) -> Callable[[Solve], Fault]:
    """A fault of the algorithm that everything is compared with."""

    def named(solve: Solve) -> Fault:
        faulty = type("Faulty", (Semismooth,), {"solve": solve})
        return Fault(name, lambda: swapped(ALGORITHMS, "semismooth", faulty))

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
    found = right(own, problem, start)
    open_nodes = np.flatnonzero(~found.active)
    if not found.outcome.converged or not len(open_nodes) or not found.active.any():
        return found
    nearest = open_nodes[np.argmin(problem.gap(found.u)[open_nodes])]
    u, p, active = found.u, found.pressure, found.active | (np.arange(len(found.active)) == nearest)
    run = own.run(problem)
    for _ in range(8):
        du, p = run.step(problem.linearise(u, None), u, p, active)
        u = u + du
    return replace(found, u=u, pressure=p, active=active)


@algorithm("pressures are those of the step before")
def stale(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """Where there were any."""
    found = right(own, problem, start)
    before = found.pressure * (1 - 1e-4) if not start.pressure.any() else start.pressure
    return replace(found, pressure=before)


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
    found = right(own, problem, start, max_iterations=2)
    return replace(found, outcome=Outcome.CONVERGED, pressure=np.maximum(found.pressure, 0.0))


@algorithm("it never ends once nodes touch")
def endless(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """Evaluates for ever."""
    found = right(own, problem, start)
    while found.active.sum() > 1:
        problem.linearise(found.u, None)
    return found


@algorithm("it raises with four nodes in contact")
def raises(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """An index out of range."""
    found = right(own, problem, start)
    np.zeros(4)[int(found.active.sum())]
    return found


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


@algorithm("it returns what is no number")
def no_number(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """Displacements of NaN, and says that it has converged."""
    found = right(own, problem, start)
    return replace(found, u=np.full_like(found.u, np.nan))


@algorithm("an end has no reason")
def silent(own: Semismooth, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """A refusal without a word."""
    found = right(own, problem, start)
    if found.active.sum() < 3:
        return found
    return replace(found, outcome=Outcome.REFUSED, history=({},))


# --- models -----------------------------------------------------------------------------------------------------------


@contextmanager
def _one_gradient_turned() -> Iterator[None]:
    """Of the first candidate."""
    sound = Round.gradient

    def turned(self: Round, x: np.ndarray) -> np.ndarray:
        return sound(self, x) * np.where(np.arange(len(x)) == 0, -1.0, 1.0)[:, None]

    with swapped(Round, "gradient", turned):
        yield


@contextmanager
def _no_curvature() -> Iterator[None]:
    def flat(self: Any, x: np.ndarray) -> np.ndarray:
        return np.zeros((len(x), 3, 3))

    with swapped(Round, "curvature", flat):
        yield


@contextmanager
def _seam_twice() -> Iterator[None]:
    whole = tyre_model._candidates

    def doubled(shell: ShellModel, part: Any, area: str, *, coupled: bool) -> Any:
        nodes, candidates = whole(shell, part, area, coupled=coupled)
        on_seam = np.isin(part.grid.nodes[nodes, 1], part.grid.ends[1]) & (part.copies > 1)
        weights = np.where(on_seam, 2.0, 1.0) * candidates.weights
        return nodes, replace(candidates, weights=weights)

    with swapped(tyre_model, "_candidates", doubled):
        yield


@contextmanager
def _thickness_in_mm() -> Iterator[None]:
    wall = panel._wall

    def unscaled(request: Any, h: float, stress: float) -> Any:
        return wall(request, h / request.number("length_unit"), stress)

    with swapped(panel, "_wall", unscaled):
        yield


@contextmanager
def _tangent(change: Callable[[sparse.csc_matrix], sparse.csc_matrix]) -> Iterator[None]:
    linearise = ShellModel.linearise

    def changed(self: ShellModel, *arguments: Any) -> Any:
        lin = linearise(self, *arguments)
        return replace(lin, tangent=change(lin.tangent))

    with swapped(ShellModel, "linearise", changed):
        yield


def _two_too_many() -> Any:
    def counted(*arguments: Any) -> Any:
        found = stability.stability(*arguments)
        return found if found.negative is None else replace(found, negative=found.negative + 2)

    return swapped(certificate, "stability", counted)


def _elements_with_the_body() -> Any:
    return swapped(stability, "_apart", lambda problem, state, K, epsilon, found, overlooked: found)


FAULTS = (
    *(left_out, glued, stale, too_large, loose, at_the_limit, endless, raises, exact, last_ignored, no_number, silent),
    Fault("the normal of one node of a ball or drum points inwards", _one_gradient_turned),
    Fault("a ball or drum has no curvature", _no_curvature),
    Fault("nodes on the seam of half a tyre have twice their area", _seam_twice),
    Fault("a thickness stays in mm in other units", _thickness_in_mm),
    Fault("the tangent is a thousandth too stiff", lambda: _tangent(lambda K: sparse.csc_matrix(1.001 * K))),
    Fault("two negative eigenvalues too many are counted", _two_too_many),
    Fault("modes of elements are counted as those of the body", _elements_with_the_body, SCENE),
    *planted_in_friction.FAULTS,
)


def found_after(fault: Fault, most: int = MOST, among: Callable[[Asked], bool] | None = None) -> dict[str, Any]:
    """How many cases it took, which case found it and by which law; 0 cases where none of ``most`` has.

    among: requests that are examined, the others are passed over.
    """
    kind = fault.kind or ("" if among is None else SCENE)
    for seed in range(most):
        if among is not None and not among(asked_of(seed)):
            continue
        with fault.planted():
            report = examine(seed, kind)
        if report.verdict == BROKEN and examine(seed, kind).verdict != BROKEN:
            return {"fault": fault.name, "cases": seed + 1, "law": report.law, "said": report.said}
    return {"fault": fault.name, "cases": 0, "law": "", "said": ""}


def planted_faults() -> pd.DataFrame:
    """All faults, a row each."""
    return pd.DataFrame([found_after(fault) for fault in FAULTS])

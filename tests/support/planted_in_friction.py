"""How a fault is planted: it is there while a context lasts, and leaves nothing behind.

Those of friction: of its direction, its judge, what it has lost, units and settings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from typing import Any
from unittest.mock import patch

import numpy as np

from contact.coulomb import State
from contact.newton.friction_run import FrictionalRun, Point
from contact.problem import ContactAlgorithm, ContactSolution, Outcome
from contact.slip import Slip
from studies.ask import settings
from studies.ask.request import Value
from studies.ask.settings import DRAG, MU
from studies.fuzz import state_laws
from studies.fuzz.cases import FRICTION
from studies.solving import recording
from studies.solving import solve as solving
from studies.solving.certificate import certificate
from studies.solving.friction_stages import Stages


@dataclass(frozen=True)
class Fault:
    """What is wrong, in words, and how it is planted: a context in which it is there.

    kind: of the cases that look for it, by default of each what is drawn from its number.
    """

    name: str
    planted: Callable[[], AbstractContextManager[object]]
    kind: str = ""


def fault(name: str, place: Any, function: str, kind: str = "") -> Callable[[Callable[..., Any]], Fault]:
    """A fault of a function of a module or a class: what stands in its place is given the sound one first."""

    def named(faulty: Callable[..., Any]) -> Fault:
        return Fault(name, lambda: patch.object(place, function, _before(vars(place)[function], faulty)), kind)

    return named


def _before(sound: Callable[..., Any], faulty: Callable[..., Any]) -> Callable[..., Any]:
    """A plain function, which a class binds as it did the sound one."""
    return lambda *arguments, **options: faulty(sound, *arguments, **options)


Change = Callable[[ContactSolution, ContactSolution], ContactSolution]


def answer(name: str) -> Callable[[Change], Fault]:
    """A fault of every converged answer with friction; change(solution, start)."""

    def named(change: Change) -> Fault:
        @fault(name, FrictionalRun, "finish", FRICTION)
        def changed(
            sound: Callable[..., ContactSolution], run: FrictionalRun, at: Point, outcome: Outcome
        ) -> ContactSolution:
            solution = sound(run, at, outcome)
            return change(solution, run.begun) if outcome.converged else solution

        return changed

    return named


@answer("friction keeps its direction when a drag reverses")
def kept(solution: ContactSolution, start: ContactSolution) -> ContactSolution:
    """A node that slips on keeps the direction of its friction, whichever way it slips now."""
    assert solution.friction is not None
    if start.friction is None:
        return solution
    slips = (solution.friction.state == State.SLIP) & (start.friction.state == State.SLIP)
    now, before = (np.linalg.norm(each.friction.force, axis=1)[:, None] for each in (solution, start) if each.friction)
    old = np.divide(start.friction.force, before, out=np.zeros_like(solution.friction.force), where=before > 0)
    force = np.where(slips[:, None], now * old, solution.friction.force)
    return replace(solution, friction=replace(solution.friction, force=force))


@answer("friction along the slip")
def along(solution: ContactSolution, start: ContactSolution) -> ContactSolution:
    """And not against it."""
    assert solution.friction is not None
    slips = (solution.friction.state == State.SLIP)[:, None]
    force = np.where(slips, -solution.friction.force, solution.friction.force)
    return replace(solution, friction=replace(solution.friction, force=force))


@contextmanager
def _unjudged() -> Iterator[None]:
    """Friction along the slip, and a judge that nobody asks."""

    def unasked(*arguments: Any) -> dict[str, Any]:
        return {**certificate(*arguments), "failures": [], "diagnosis": []}

    with patch.object(recording, "certificate", unasked), along.planted():
        yield


@answer("what friction loses is gained")
def gained(solution: ContactSolution, start: ContactSolution) -> ContactSolution:
    """Of a step."""
    assert solution.friction is not None
    before = 0.0 if start.friction is None else start.friction.dissipation
    lost = 2 * before - solution.friction.dissipation
    return replace(solution, friction=replace(solution.friction, dissipation=lost))


@fault("a drag is taken in the unit of length of the problem", Stages, "_stops", FRICTION)
def in_own_units(sound: Callable[..., tuple[float, ...]], stages: Stages, setting: Any) -> tuple[float, ...]:
    """And not in mm."""
    stops = sound(stages, setting)
    unit = stages._settings.number("length_unit") if "length_unit" in stages._settings else 1.0
    return tuple(stop / unit for stop in stops) if setting is DRAG else stops


@fault("anchors are a thousandth off", Slip, "left", FRICTION)
def anchored_elsewhere(sound: Callable[..., np.ndarray], *arguments: Any) -> np.ndarray:
    """Where candidates are taken to have stuck, for the algorithm and its judge alike."""
    return 1.001 * sound(*arguments)


@contextmanager
def _settings_dropped() -> Iterator[None]:
    """All but the stiffness of springs, where it is solved and where it is looked at."""
    sound = settings.configured

    def configured(contact: str, settings: Mapping[str, Value]) -> ContactAlgorithm:
        algorithm = sound(contact, settings)
        return type(algorithm)(epsilon=algorithm.epsilon) if MU.key in settings else algorithm

    with patch.object(solving, "configured", configured), patch.object(state_laws, "configured", configured):
        yield


DROPPED = Fault("settings of an algorithm are dropped with friction", _settings_dropped, FRICTION)
UNJUDGED = Fault("friction along the slip, and no judge is asked", _unjudged, FRICTION)
FAULTS = (kept, along, UNJUDGED, gained, in_own_units, anchored_elsewhere, DROPPED)

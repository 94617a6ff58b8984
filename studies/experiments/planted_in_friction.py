"""Faults of friction that are planted: of its direction, its judge, what it has lost, units and settings."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np

from contact.coulomb import State
from contact.friction.run import FrictionalRun, Point
from contact.friction.slip import Slip
from contact.problem import ContactAlgorithm, ContactSolution, Outcome
from studies import algorithm_settings, solving
from studies.certificate import certificate
from studies.experiments.planting import Fault, swapped
from studies.friction.settings import DRAG, MU
from studies.friction.stages import Stages
from studies.fuzz import rubbed
from studies.fuzz.cases import FRICTION
from studies.request import Value

Change = Callable[[ContactSolution, ContactSolution], ContactSolution]


@contextmanager
def _answers(change: Change) -> Iterator[None]:
    """Every converged answer with friction is changed; change(found, start)."""
    sound = FrictionalRun.finish

    def finish(self: FrictionalRun, at: Point, outcome: Outcome) -> ContactSolution:
        found = sound(self, at, outcome)
        return change(found, self.begun) if outcome.converged else found

    with swapped(FrictionalRun, "finish", finish):
        yield


def _kept(found: ContactSolution, start: ContactSolution) -> ContactSolution:
    """Who slips on keeps the direction of its friction, whichever way it slips now."""
    assert found.friction is not None
    if start.friction is None:
        return found
    slips = (found.friction.state == State.SLIP) & (start.friction.state == State.SLIP)
    now, before = (np.linalg.norm(each.friction.force, axis=1)[:, None] for each in (found, start) if each.friction)
    old = np.divide(start.friction.force, before, out=np.zeros_like(found.friction.force), where=before > 0)
    force = np.where(slips[:, None], now * old, found.friction.force)
    return replace(found, friction=replace(found.friction, force=force))


def _along(found: ContactSolution, start: ContactSolution) -> ContactSolution:
    """Friction along the slip."""
    assert found.friction is not None
    slips = (found.friction.state == State.SLIP)[:, None]
    force = np.where(slips, -found.friction.force, found.friction.force)
    return replace(found, friction=replace(found.friction, force=force))


def _gained(found: ContactSolution, start: ContactSolution) -> ContactSolution:
    """What a step has lost is gained."""
    assert found.friction is not None
    before = 0.0 if start.friction is None else start.friction.dissipation
    lost = 2 * before - found.friction.dissipation
    return replace(found, friction=replace(found.friction, dissipation=lost))


@contextmanager
def _unjudged() -> Iterator[None]:
    """Friction along the slip, and a judge that nobody asks."""

    def unasked(*arguments: Any) -> dict[str, Any]:
        return {**certificate(*arguments), "failures": [], "diagnosis": []}

    with swapped(solving, "certificate", unasked), _answers(_along):
        yield


@contextmanager
def _drag_in_own_units() -> Iterator[None]:
    sound = Stages._stops

    def stops(self: Stages, setting: Any) -> tuple[float, ...]:
        found = sound(self, setting)
        unit = self._settings.number("length_unit") if "length_unit" in self._settings else 1.0
        return tuple(stop / unit for stop in found) if setting is DRAG else found

    with swapped(Stages, "_stops", stops):
        yield


def _anchored(change: Callable[[np.ndarray], np.ndarray]) -> Any:
    """Where candidates are taken to have stuck is changed, for the algorithm and its judge alike."""
    sound = Slip.left
    return swapped(Slip, "left", lambda slip, u, stretched: change(sound(slip, u, stretched)))


@contextmanager
def _settings_dropped() -> Iterator[None]:
    sound = algorithm_settings.configured

    def configured(contact: str, settings: Mapping[str, Value]) -> ContactAlgorithm:
        found = sound(contact, settings)
        return type(found)(epsilon=found.epsilon) if MU.key in settings else found

    with swapped(solving, "configured", configured), swapped(rubbed, "configured", configured):
        yield


FAULTS = tuple(
    Fault(name, planted, FRICTION)
    for name, planted in (
        ("friction keeps its direction when a drag reverses", lambda: _answers(_kept)),
        ("friction along the slip", lambda: _answers(_along)),
        ("friction along the slip, and no judge is asked", _unjudged),
        ("what friction loses is gained", lambda: _answers(_gained)),
        ("a drag is taken in the unit of length of the problem", _drag_in_own_units),
        ("anchors are a thousandth off", lambda: _anchored(lambda places: 1.001 * places)),
        ("settings of an algorithm are dropped with friction", _settings_dropped),
    )
)

"""Faults of friction that are planted: of its direction, its judge, what it has lost, units and settings."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np

from contact.friction import posed
from contact.friction.algorithms import catalogue
from contact.friction.algorithms.base import FrictionalAlgorithm
from contact.friction.posed import WithFriction
from contact.friction.problem import State
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution
from studies import solving
from studies.certificate import certificate
from studies.experiments.planting import Fault, fault, swapped
from studies.friction.settings import DRAG
from studies.friction.stages import Stages
from studies.fuzz.cases import FRICTION

Change = Callable[[ContactSolution, ContactSolution], ContactSolution]


def answer(name: str) -> Callable[[Change], Fault]:
    """A fault of every converged answer with friction; change(found, start)."""

    def named(change: Change) -> Fault:
        @fault(name, WithFriction, "solve", FRICTION)
        def changed(
            sound: Callable[..., ContactSolution], own: WithFriction, problem: ContactProblem, start: ContactSolution
        ) -> ContactSolution:
            found = sound(own, problem, start)
            return found if found.friction is None or not found.outcome.converged else change(found, start)

        return changed

    return named


@answer("friction keeps its direction when a drag reverses")
def kept(found: ContactSolution, start: ContactSolution) -> ContactSolution:
    """Who slips on keeps the direction of its friction, whichever way it slips now."""
    assert found.friction is not None
    if start.friction is None:
        return found
    slips = (found.friction.state == State.SLIP) & (start.friction.state == State.SLIP)
    now, before = (np.linalg.norm(each.friction.force, axis=1)[:, None] for each in (found, start) if each.friction)
    old = np.divide(start.friction.force, before, out=np.zeros_like(found.friction.force), where=before > 0)
    force = np.where(slips[:, None], now * old, found.friction.force)
    return replace(found, friction=replace(found.friction, force=force))


@answer("friction along the slip")
def along(found: ContactSolution, start: ContactSolution) -> ContactSolution:
    """And not against it."""
    assert found.friction is not None
    slips = (found.friction.state == State.SLIP)[:, None]
    force = np.where(slips, -found.friction.force, found.friction.force)
    return replace(found, friction=replace(found.friction, force=force))


@contextmanager
def _unjudged() -> Iterator[None]:
    """Friction along the slip, and a judge that nobody asks."""

    def unasked(*arguments: Any) -> dict[str, Any]:
        return {**certificate(*arguments), "failures": [], "diagnosis": []}

    with swapped(solving, "certificate", unasked), along.planted():
        yield


@answer("what friction loses is gained")
def gained(found: ContactSolution, start: ContactSolution) -> ContactSolution:
    """Of a step."""
    assert found.friction is not None
    before = 0.0 if start.friction is None else start.friction.dissipation
    lost = 2 * before - found.friction.dissipation
    return replace(found, friction=replace(found.friction, dissipation=lost))


@fault("a drag is taken in the unit of length of the problem", Stages, "_stops", FRICTION)
def in_own_units(sound: Callable[..., tuple[float, ...]], stages: Stages, setting: Any) -> tuple[float, ...]:
    """And not in mm."""
    found = sound(stages, setting)
    unit = stages._settings.number("length_unit") if "length_unit" in stages._settings else 1.0
    return tuple(stop / unit for stop in found) if setting is DRAG else found


@fault("anchors are a thousandth off", posed, "_anchors", FRICTION)
def anchored_elsewhere(sound: Callable[..., np.ndarray], *arguments: Any) -> np.ndarray:
    """Where candidates are taken to have stuck, for the algorithm and its judge alike."""
    return 1.001 * sound(*arguments)


@fault("settings of an algorithm are dropped with friction", catalogue, "twin", FRICTION)
def without_settings(sound: Callable[..., Any], algorithm: ContactAlgorithm) -> FrictionalAlgorithm:
    """All but the stiffness of its springs."""
    return catalogue.FRICTIONAL[algorithm.name](epsilon=algorithm.epsilon)


UNJUDGED = Fault("friction along the slip, and no judge is asked", _unjudged, FRICTION)
FAULTS = (kept, along, UNJUDGED, gained, in_own_units, anchored_elsewhere, without_settings)

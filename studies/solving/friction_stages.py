"""The stages of a scene with friction: its own with a coefficient, then those in which the foundation slides.

How friction is solved does not enter here (:mod:`contact.newton.friction_run`), nor does any particular scene.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from contact.continuation.candidates import laid
from contact.coulomb import Motion
from contact.faces.rubbings import rubbed as between_faces
from contact.problem import ContactProblem, ContactSolution
from contact.slip import with_friction
from contact.swept import Surface
from studies.ask.request import Settings, UsageError
from studies.ask.scene import Begun, CurveStage, Observation, Setting, Stage
from studies.ask.settings import DRAG, MU, TURN, WAY
from studies.output.atomic import Table
from studies.scenes.friction_readings import FORCES, FRICTION, forces, nodal

STEEP = 0.8  # cosine of an axis with the normal
INVARIANT = 1e-9  # of the size of a foundation: a gap that has not changed


@dataclass(frozen=True, eq=False)
class Pressed:
    """The last stage of a scene with a foundation: its problem at the end, and the displacement (n,) it begins with."""

    stage: Stage
    problem: ContactProblem
    begun: np.ndarray

    @property
    def surface(self) -> Surface:
        """Of the foundation at the end."""
        assert self.problem.surface is not None
        return self.problem.surface


@dataclass(frozen=True, eq=False)
class Slide:
    """Ways of a foundation along itself: along the unit vector ``way`` (3,), around the unit ``normal`` (3,)."""

    normal: np.ndarray
    way: np.ndarray

    @classmethod
    def under(cls, pressed: Pressed, degrees: float) -> Slide:
        """In the tangent plane where foundation and body are nearest before the press.

        degrees: of the way from the first axis of space that is not nearly along the normal there.
        """
        y = pressed.surface.positions(pressed.begun)
        nearest = int(np.argmin(pressed.surface.gap(y)))
        normal = pressed.surface.gradient(y[nearest : nearest + 1])[0]
        axis = np.eye(3)[int(np.argmax(np.abs(normal) < STEEP))]
        along = axis - (axis @ normal) * normal
        along /= np.linalg.norm(along)
        across, angle = np.cross(normal, along), math.radians(degrees)
        return cls(normal, math.cos(angle) * along + math.sin(angle) * across)

    def motion(self, drag: float, turn: float) -> Motion:
        """By ``drag`` [length], then by ``turn`` [deg] about the origin, where the body is pressed: x = R (X + d)."""
        turned = Motion(np.zeros(3), math.radians(turn) * self.normal, np.zeros(3))
        return replace(turned, translation=turned.rotation @ (drag * self.way))

    @staticmethod
    def stays(pressed: Pressed, motion: Motion) -> bool:
        """Whether the foundation comes to lie in itself: the gap of no candidate changes."""
        surface, y = pressed.surface, pressed.surface.positions(pressed.begun)
        change = surface.gap(motion.into(y)) - surface.gap(y)
        return bool(np.max(np.abs(change)) <= INVARIANT * (surface.size + float(np.max(np.abs(y)))))


class Stages:
    """The stages of a scene with friction in those that have a foundation, then those of its drag and its turn.

    Raises UsageError where there is no foundation, or one that does not slide along itself as it is asked to.
    """

    def __init__(self, stages: Iterable[Stage], settings: Settings) -> None:
        self._stages, self._settings = stages, settings
        self._mu = settings.number(MU.key)

    def __iter__(self) -> Iterator[Stage]:
        pressed = list[Pressed]()  # of this walk alone: each stage is begun before the next one is asked for
        for stage in self._stages:
            if isinstance(stage, CurveStage):
                raise UsageError("friction needs steps of the travel: arc length has no path with it")
            yield replace(stage, begin=partial(self._begin, stage, pressed.append), observe=partial(_observe, stage))
        if not pressed:
            raise UsageError("the scene has nothing that friction could act on")
        if pressed[-1].problem.surface is None:  # faces have stages of their own in which one slides along the other
            return
        drags = self._stops(DRAG)
        yield from self._slid(pressed[-1], DRAG, drags, lambda t: (t, 0.0))
        far = drags[-1] if drags else 0.0
        yield from self._slid(pressed[-1], TURN, self._stops(TURN), lambda t: (far, t))

    def _stops(self, setting: Setting) -> tuple[float, ...]:
        return self._settings.numbers(setting.key) if setting.key in self._settings else ()

    def _begin(self, stage: Stage, note: Callable[[Pressed], None], previous: ContactSolution | None) -> Begun:
        problem_at, start = stage.begin(previous)
        last = problem_at(stage.targets[-1])
        if last.surface is None and last.faces is None:
            return problem_at, start

        def rubbed(t: float) -> ContactProblem:
            share, problem = stage.rubs(t), problem_at(t)
            mu = share * self._mu if share else 0.0
            return with_friction(problem, mu, Motion.none()) if problem.faces is None else between_faces(problem, mu)

        note(Pressed(stage, last, start.u))
        return rubbed, start if last.faces is None else laid(rubbed(0.0), start)

    def _slid(
        self, pressed: Pressed, setting: Setting, stops: Sequence[float], way: Callable[[float], tuple[float, float]]
    ) -> Iterator[Stage]:
        """The stage of these stops; nothing without any."""
        if not stops:
            return
        slide = Slide.under(pressed, self._settings.number(WAY.key) if WAY.key in self._settings else 0.0)

        def motion(t: float) -> Motion:
            drag, turn = way(t)
            return slide.motion(drag * pressed.stage.units.length, turn)

        for t in stops:
            if not slide.stays(pressed, motion(t)):
                raise UsageError(f"{setting.key} = {t:g}: the foundation does not slide along itself")

        def begin(previous: ContactSolution | None) -> Begun:
            assert previous is not None
            return lambda t: with_friction(pressed.problem, self._mu, motion(t)), previous

        def observe(problem: ContactProblem, state: ContactSolution, t: float) -> Observation:
            observation = _observe(pressed.stage, problem, state, pressed.stage.targets[-1])
            tables = observation.tables
            last = {name: value for name, value in observation.quantities.items() if name in FORCES}
            step = {setting.key: t, **(observation.step or {})}
            # the headline of the scene is that of the end of its press, and so are its tables
            return Observation(step, last, lambda: {FRICTION: tables()[FRICTION].with_column(setting.key, t)})

        yield Stage(setting.key.rpartition("_")[0], begin, stops, observe)


def _observe(stage: Stage, problem: ContactProblem, state: ContactSolution, t: float) -> Observation:
    """What the scene reads off, and of friction its forces and its table."""
    observation = stage.observe(problem, state, t)
    if problem.coulomb is None or state.friction is None or observation.step is None:
        return observation
    resultants = forces(problem, state, stage.units)
    load = next(iter(observation.step))

    def tables() -> dict[str, Table]:
        return {**observation.tables(), FRICTION: nodal(problem, state, stage.units).with_column(load, t)}

    step, quantities = {**observation.step, **resultants}, {**observation.quantities, **resultants}
    return replace(observation, step=step, quantities=quantities, tables=tables)

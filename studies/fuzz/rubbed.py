"""What friction may not do, whoever has solved: drive, hold beyond its bound, or point along the slip.

Slips are worked out from places and motions of two accepted states, not from what an answer says of them; no algorithm
may enter here. How two answers compare is in :mod:`studies.fuzz.comparing`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.friction.slip import sliding_of
from contact.problem import ContactProblem, ContactSolution
from studies.algorithm_settings import configured, settings_of
from studies.friction.observed import in_space
from studies.friction.settings import rubbing
from studies.fuzz.attempt import Attempt, Broken
from studies.result import Result

SMALL = 1e-9  # of the largest force, and of a large slip: none
SIDEWAYS = 1e-4  # chord by which friction may miss the direction against a slip
LOST = "dissipation_N_mm"


def check(one: Attempt) -> None:
    """Hold a converged solve against the laws of friction, if it has any; raises Broken."""
    if not rubbing(one.found.request.settings):
        return
    _settings_count(one)
    _never_drives(one.found)
    end = one.found.end
    assert end is not None
    if end.point.solution.friction is None:  # nothing has been moved
        return
    if np.isinf(one.found.request.number("epsilon")):
        Slipped.between(end.last_accepted, (end.problem, end.point.solution)).check()


def _settings_count(one: Attempt) -> None:
    """Every setting of the algorithm that was given is one of what solves; raises Broken."""
    request = one.found.request
    algorithm = configured(request.contact, request.settings)
    own = [setting.key for setting in settings_of(request.contact) if setting.key in one.asked.settings]
    lost = [key for key in own if getattr(algorithm, key, None) != request.settings[key]]
    if lost:
        raise Broken("settings count", f"{request.contact} with friction drops {', '.join(lost)}")


def _never_drives(result: Result) -> None:
    """What has been lost never falls along the path; raises Broken."""
    before, settings = 0.0, result.request.settings
    length, stress = (settings.number(key) if key in settings else 1.0 for key in ("length_unit", "stress_unit"))
    for step in result.loads:
        lost, scales = step.quantities.get(LOST), step.certificate["scales"]
        if lost is None:
            continue
        most, large = step.quantities["bound_N"], scales["force_N"] / (stress * length**2)
        size = (most if np.isfinite(most) else large) * scales["length_mm"] / length
        if not lost >= before - SMALL * max(size, abs(before)):
            raise Broken("dissipation", f"falls from {before:.6g} to {lost:.6g} N mm, of {size:.3g}")
        before = lost


@dataclass(frozen=True, eq=False)
class Slipped:
    """Candidates between two accepted states: slip and friction (m, 3) in the frame of the foundation, normal forces.

    bound (m,) [N]: mu f.  length [mm]: a large slip.
    """

    slip: np.ndarray
    friction: np.ndarray
    normal: np.ndarray
    bound: np.ndarray
    length: float

    @classmethod
    def between(
        cls, before: tuple[ContactProblem, ContactSolution], after: tuple[ContactProblem, ContactSolution]
    ) -> Slipped:
        """Each candidate from where it was on the foundation to where it is, in the tangent plane there."""
        (old, start), (problem, state) = before, after
        assert problem.surface is not None
        assert problem.coulomb is not None
        surface, sliding = problem.surface, sliding_of(problem)
        motion = sliding.motion if old.coulomb is None else sliding_of(old).motion
        first = motion.into((old.surface or surface).positions(start.u))
        way = sliding.places(state.u) - first
        normals = surface.gradient(first)
        normals = normals / np.linalg.norm(normals, axis=1)[:, None]
        slip = way - np.sum(way * normals, axis=1)[:, None] * normals
        f = problem.nodal_forces(state.pressure)
        bound = problem.coulomb.bound(f)
        length = max(surface.size, float(np.max(np.abs(way), initial=0.0)))
        return cls(slip, in_space(problem, state) @ sliding.motion.rotation, f, bound, length)

    def check(self) -> None:
        """Raises Broken where friction is beyond its bound, or does not oppose the slip of a candidate."""
        t, s = np.linalg.norm(self.friction, axis=1), np.linalg.norm(self.slip, axis=1)
        force = max(float(np.max(np.abs(self.normal), initial=0.0)), float(np.max(t, initial=0.0)))
        beyond = t - self.bound - SMALL * force
        if np.max(beyond, initial=-np.inf) > 0:
            raise Broken("bound", f"friction is {np.max(beyond):.3g} N beyond mu f, of {force:.3g}")
        moves = (s > SMALL * self.length) & (t > SMALL * force)
        chord = np.linalg.norm(self.slip[moves] / s[moves, None] + self.friction[moves] / t[moves, None], axis=1)
        excess = chord - SIDEWAYS - SMALL * self.length / s[moves] - SMALL * force / t[moves]
        if np.max(excess, initial=-np.inf) > 0:
            worst = int(np.argmax(excess))
            raise Broken("opposes", f"chord of {chord[worst]:.3g} against a slip of {s[moves][worst]:.3g} mm")

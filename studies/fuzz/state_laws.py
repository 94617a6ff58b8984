"""Laws of one converged state, whoever has solved for it: its derivatives, its stability, and its friction.

- The gap against its jacobian, the jacobian against its curvature, the residual against its tangent, by central
  differences. A difference must fall with its step, c t^2 down to rounding: the least of several steps is taken, and
  steps are so small that no force changes by more than a thousandth of the forces in balance.
- The count of negative eigenvalues against dense algebra, and of slender elements against a finer grid.
- Friction may not drive, hold beyond its bound, or point along the slip. Slips are worked out from places and motions
  of two accepted states, not from what an answer says of them.

No algorithm may enter here. How two answers compare is in :mod:`studies.fuzz.comparing`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.problem import ContactProblem, ContactSolution
from contact.rounding import rounding_floor
from contact.slip import Slip, sliding_of
from contact.solvers.sparse import symmetric
from studies.ask.settings import configured, rubbing, settings_of
from studies.fuzz.attempt import CONVERGED, Attempt, Broken, attempt, quiet
from studies.fuzz.comparing import Answer, signs
from studies.fuzz.values import generator
from studies.scenes.friction_readings import in_space
from studies.solving.result import UNSTABLE, Result

STEPS = (1e-3, 1e-5)
BOUND = 1e-4  # relative mismatch of a derivative; a wrong term, wherever it matters, is of the order of one
ROUNDING = 10.0  # times machine precision of the terms that a difference is made of
DENSE = 3000  # unknowns beyond which nothing is counted by dense algebra
SLENDER = 8.0  # sides of elements, or numbers of them, whose ratio is at least so much
SMALL = 1e-9  # of the largest force, and of a large slip: none
SIDEWAYS = 1e-4  # chord by which friction may miss the direction against a slip
LOST = "dissipation_N_mm"


def check(one: Attempt, answer: Answer, seed: int) -> None:
    """Hold a converged solve and its last state against all of these laws; raises Broken."""
    check_derivatives(answer.problem, answer.state, seed)
    _stability(one.found, answer)
    _stable_when_finer(one, seed)
    _friction(one)


# --- derivatives ------------------------------------------------------------------------------------------------------


def check_derivatives(problem: ContactProblem, state: ContactSolution, seed: int) -> None:
    """Raises Broken for a derivative of the problem that its differences do not bear out."""
    with quiet():
        wrong = mismatches(problem, state.u, state.pressure, generator(seed, "direction"))
    if wrong:
        raise Broken("derivatives", ", ".join(f"{name}: error {value:.1e}" for name, value in wrong.items()))


def mismatches(problem: ContactProblem, u: np.ndarray, p: np.ndarray, rng: np.random.Generator) -> dict[str, float]:
    """Relative mismatch of each derivative along a random direction; only those above BOUND and rounding."""
    size = float(np.max(np.abs(u), initial=0.0))
    if size == 0.0 or not len(u):
        return {}
    lin, force = problem.linearise(u, None), problem.nodal_forces(p)
    v = rng.normal(size=len(u)) * size / np.sqrt(len(u))
    v *= min(1.0, lin.scale / (float(np.linalg.norm(lin.tangent @ v)) or 1.0))  # elements may be slivers
    alone = problem.residual or (lambda x: problem.linearise(x, None).residual)
    checks = {"tangent": Difference(alone, lin.tangent @ v, 0.0, rounding_floor(lin, u))}
    if len(p):
        G, eps = problem.gap_jacobian(u), float(np.finfo(float).eps)
        gaps = (problem.gap_size + float(np.max(np.abs(problem.gap(u)) + abs(G) @ np.abs(u)))) * np.sqrt(len(p))
        checks["gap jacobian"] = Difference(problem.gap, G @ v, 0.0, eps * gaps)
        bent = 0 * v if problem.gap_curvature is None else problem.gap_curvature(u, force) @ v
        pushed = float(np.linalg.norm(G.T @ force))
        if pushed > 0:
            checks["gap curvature"] = Difference(
                lambda x: problem.gap_jacobian(x).T @ force, bent, pushed * 1e-3, eps * pushed
            )
    excesses = {name: check.excess(u, v) for name, check in checks.items()}
    return {name: value for name, value in excesses.items() if not value <= BOUND}


@dataclass(frozen=True, eq=False)
class Difference:
    """f and its slope along v; least: what stands for the slope where it vanishes; rounding: of f."""

    f: Callable[[np.ndarray], np.ndarray]
    slope: np.ndarray
    least: float
    rounding: float

    def excess(self, u: np.ndarray, v: np.ndarray) -> float:
        """The least relative mismatch of all steps, less what rounding explains of it."""
        size = max(float(np.linalg.norm(self.slope)), self.least) or 1.0
        off = [np.linalg.norm((self.f(u + t * v) - self.f(u - t * v)) / (2 * t) - self.slope) / size for t in STEPS]
        excess = [float(each) - ROUNDING * self.rounding / (t * size) for each, t in zip(off, STEPS, strict=True)]
        return min(excess) if np.all(np.isfinite(excess)) else float("nan")


# --- stability --------------------------------------------------------------------------------------------------------


def _stability(result: Result, answer: Answer) -> None:
    """Raises Broken where the certificate counts other negative eigenvalues than dense algebra does.

    Of an unsymmetric tangent they are not counted by its symmetric part, and a traced curve ends elsewhere.
    """
    counts = result.loads[-1].certificate.get("stability", {}) if result.loads else {}
    K = answer.problem.linearise(answer.state.u, None).tangent
    if (
        counts.get("negative") is None
        or K.shape[0] > DENSE
        or not symmetric(K)
        or result.end is None
        or result.end.trace is not None
    ):
        return
    with quiet():
        negative, unsigned = signs(answer, answer.state.active)
    least = counts["negative"] + counts["element_modes"]
    most = least + counts["rounding"]
    if negative > most or negative + unsigned < least:
        raise Broken(
            "stability", f"told {least} negative eigenvalues, {most - least} unsigned; dense {negative}, {unsigned}"
        )


def _stable_when_finer(one: Attempt, seed: int) -> None:
    """Raises Broken where slender elements make a state unstable that is not when they are cut across."""
    n1, n2 = one.found.request.mesh
    if one.found.verdict != UNSTABLE or one.asked.refined or max(n1, n2) < SLENDER * min(n1, n2):
        return
    finer = f"{n1}x{2 * n2}" if n2 < n1 else f"{2 * n1}x{n2}"
    other = attempt(one.asked.with_options(mesh=finer), seed)
    if other.kind == CONVERGED and other.found.verdict != UNSTABLE:
        raise Broken("stability", f"unstable, but not on {finer}: {one.found.unstable[0]}")


# --- friction ---------------------------------------------------------------------------------------------------------


def _friction(one: Attempt) -> None:
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
    """Candidates between two accepted states: slip and friction in the frame of the foundation, normal forces.

    slip, friction (m, 3), or (m, 2) between faces.

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
        assert problem.coulomb is not None
        sliding, f = sliding_of(problem), problem.nodal_forces(state.pressure)
        if not isinstance(sliding, Slip):  # between faces, by both ways along the patches
            slip = sliding.since(sliding_of(old).places(start.u)).measured(state.u)
            length = max(problem.gap_size, float(np.max(np.abs(slip), initial=0.0)))
            return cls(slip, state.rubbed.force, f, problem.coulomb.bound(f), length)
        assert problem.surface is not None
        earlier, surface = sliding if old.coulomb is None else sliding_of(old), problem.surface
        assert isinstance(earlier, Slip)
        motion = earlier.motion
        first = motion.into((old.surface or surface).positions(start.u))
        way = sliding.places(state.u) - first
        normals = surface.gradient(first)
        normals = normals / np.linalg.norm(normals, axis=1)[:, None]
        slip = way - np.sum(way * normals, axis=1)[:, None] * normals
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

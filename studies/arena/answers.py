"""What an answer (du, p) to a frozen contact problem is worth, from the file alone: every claim recomputed.

An answer from outside is a .npz or a .json with ``du`` (n,) [mm], and ``pressure`` (m,) [MPa] with the ``claims`` it
makes; to a problem with friction ``normal`` (m,) [N] and ``friction`` (m, 2) [N], without claims. The residuals and
bounds of friction are those of :mod:`contact.verify`. No algorithm is run and no answer of ours is looked at here.

With nodal forces f = W p and gaps s = g + G du after the step, four residuals, each over a scale (:class:`Scales`)::

    equilibrium      |K du + r - G^T f| / F                 complementarity  sum_i |w_i p_i s_i| / (F L)
    penetration      max_i max(-s_i, 0) / L                 tension          max_i max(-w_i p_i, 0) / F

The sum of complementarity is the duality gap of the quadratic programme. The accuracy is the largest of the four.

Why the scales are what they are. A solver that measures the balance of forces by the forces of its own answer can be
satisfied by making the answer larger: for any f with a positive response, du = K^-1 (G^T f - r) balances to rounding,
and t f with t -> infinity leaves r itself below every relative tolerance, while all gaps stay open (OSQP's two
residuals accept that; a test shows it). So F comes from the file alone. L is bounded from the file: it grows with the
motion of the answer only up to the largest gap there is, since no candidate has to come further to touch, and a
smaller motion is judged more strictly. No answer can increase F or that bound.

Rounding is not counted as error: eps times the sum of the magnitudes of its terms is subtracted from each residual. An
answer with zero residuals solves a problem whose entries differ from the file's in their last digit (Oettli, Prager,
Numer. Math. 6 (1964) 405-409), however large it is; for thin shells 1e-9 of F is the measured limit of accuracy.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from contact.interchange.linearised_step import FrozenFrictionalStep, FrozenStep
from contact.interchange.untrusted import parsed_object, read_arrays, read_json, text_of
from contact.scales import Stiffness
from contact.solvers.sparse import SingularMatrixError, checked_solve, factorise
from contact.verify import judge
from studies.ask.request import UsageError

EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Scales:
    """What residuals of a problem are measured by.

    force F [N]: the largest of the forces in balance that the file states, of the imbalance |r|, and of the force that
    the deepest candidate, alone, takes to be pushed out of the foundation; where nothing moves at all, of the force
    that moves the stiffest candidate by the largest gap.
    length [mm]: the larger of the deepest penetration before the step and of the way that F moves the stiffest
    candidate when all else is held.  reach [mm]: the largest gap, the most by which the motion of an answer counts.
    """

    force: float
    length: float
    reach: float

    @classmethod
    def of(cls, step: FrozenStep) -> Scales:
        """Of a problem; one factorisation of K where a candidate penetrates."""
        problem, rest = step.problem(), np.zeros_like(step.r)
        held = Stiffness.of(problem, problem.linearise(rest, None), rest).most
        deepest = float(np.max(-step.gap, initial=0.0))
        reach = float(np.max(np.abs(step.gap), initial=0.0))
        force = max(step.scale, float(np.linalg.norm(step.r)), _pushed_out(step, held)) or held * reach or 1.0
        return cls(force, max(deepest, force / held if held > 0 else 0.0), reach)

    def gap(self, moved: np.ndarray) -> float:
        """L [mm] of an answer that moves the candidates by ``moved`` (m,) [mm] along their gaps."""
        return max(self.length, min(float(np.max(np.abs(moved), initial=0.0)), self.reach)) or 1.0


@dataclass(frozen=True)
class Accuracy:
    """The four residuals, relative, 0 for an exact answer; infinite where an answer is not finite."""

    equilibrium: float
    penetration: float
    tension: float
    complementarity: float

    @property
    def worst(self) -> float:
        """The accuracy: the largest residual."""
        return max(asdict(self).values())


RESIDUALS = tuple(Accuracy.__dataclass_fields__)
NONE = Accuracy(np.inf, np.inf, np.inf, np.inf)


def accuracy(step: FrozenStep, du: np.ndarray, pressure: np.ndarray, scales: Scales | None = None) -> Accuracy:
    """The residuals of du (n,) [mm] and pressure (m,) [MPa]; ``scales``: of the step, where known.

    Raises ValueError when they do not fit the step.
    """
    if du.shape != step.r.shape or pressure.shape != step.gap.shape:
        raise ValueError(f"{du.shape} and {pressure.shape} for {step.r.shape} unknowns, {step.gap.shape} candidates")
    by = scales or Scales.of(step)
    with np.errstate(over="ignore", invalid="ignore"):  # solvers without an answer may return any numbers
        residuals = _residuals(step, du, pressure, by)
    finite = np.isfinite(residuals.worst) and np.all(np.isfinite(du)) and np.all(np.isfinite(pressure))
    return residuals if finite else NONE


def _residuals(step: FrozenStep, du: np.ndarray, pressure: np.ndarray, by: Scales) -> Accuracy:
    weighed = step.weights * pressure
    forces = weighed if step.coupling is None else step.coupling @ pressure
    terms = abs(step.K) @ np.abs(du) + np.abs(step.r) + abs(step.G).T @ np.abs(forces)
    imbalance = np.linalg.norm(step.K @ du + step.r - step.G.T @ forces) - EPS * np.linalg.norm(terms)
    moved = step.G @ du
    gap, rounding = step.gap + moved, EPS * (np.abs(step.gap) + abs(step.G) @ np.abs(du))
    length = by.gap(moved)
    open_or_not = np.maximum(np.abs(gap) - rounding, 0.0)
    return Accuracy(
        equilibrium=max(float(imbalance), 0.0) / by.force,
        penetration=(float(np.max(-gap - rounding, initial=0.0)) + 0.0) / length,
        tension=(float(np.max(-weighed, initial=0.0)) + 0.0) / by.force,
        complementarity=float(np.sum(np.abs(weighed) * open_or_not)) / (by.force * length),
    )


def _pushed_out(step: FrozenStep, held: float) -> float:
    """Force [N] on the deepest candidate i that closes its gap with no other loaded: |G_i| (-g_i)/(G K^-1 G^T)_ii.

    Zero where K has no such compliance, as for a body that only the foundation supports; where the file has no other
    force either, the force with all other unknowns fixed.
    """
    if not np.any(step.gap < 0):
        return 0.0
    deepest = int(np.argmin(step.gap))
    row = np.asarray(step.G[[deepest]].todense(), float).ravel()
    size, depth = float(np.linalg.norm(row)), -float(step.gap[deepest])
    try:
        compliance = float(row @ checked_solve(factorise(step.K), step.K, row))
    except SingularMatrixError:
        compliance = 0.0
    if compliance > 0:
        return size * depth / compliance
    return 0.0 if step.scale > 0 or np.any(step.r) else size * depth * held


CERTIFIED = 1e-8  # default of the accuracy that is required
SAME = 1e-9  # relative, of a claimed force
CLAIMS = ("accuracy", *RESIDUALS, "force", "pressed")
RUBBED = ("du", "normal", "friction")
OFF = {"force": "of the larger of it and F", "pressed": "candidates"}  # units of deviations; residuals: a factor


@dataclass(frozen=True, eq=False)
class Given:
    """An answer as read from its file: du (n,) [mm], pressure (m,) [MPa], and its claims."""

    du: np.ndarray
    pressure: np.ndarray
    claims: Mapping[str, Any]


@dataclass(frozen=True)
class Claim:
    """A claimed value, the recomputed one and their deviation; false where that exceeds its tolerance."""

    what: str
    claimed: str
    found: str
    off: float
    false: bool


@dataclass(frozen=True, eq=False)
class Judgement:
    """The residuals by name, the force and the length that they are relative to, the verdict, and the claims."""

    residuals: Mapping[str, float]
    force_N: float
    length_mm: float
    certified: bool
    verdict: str
    claims: tuple[Claim, ...] = ()

    @property
    def sound(self) -> bool:
        """Certified, and no claim is false."""
        return self.certified and not any(claim.false for claim in self.claims)

    def lines(self) -> list[str]:
        """As text: each residual, each claim, the verdict last."""
        report = [f"{name}: {value:.2e}" for name, value in self.residuals.items()]
        report.append(f"relative to {self.force_N:.6g} N and {self.length_mm:.6g} mm")
        for claim in self.claims:
            how = f"FALSE by {claim.off:.3g} {OFF.get(claim.what, 'times')}" if claim.false else "true"
            report.append(f"claim {claim.what} = {claim.claimed}: {how}, it is {claim.found}")
        return [*report, self.verdict]


def read_answer(path: Path) -> Given:
    """From a .npz or a .json; raises UsageError with the fault, OSError when there is no file."""
    with _in_one_line(path, "not an answer"):
        fields = _values(path, ("du", "pressure"), ("claims",))
        claims = fields.get("claims", {})
        if isinstance(claims, np.ndarray):  # of a .npz, as text
            claims = parsed_object(text_of(claims, "claims"), "claims")
        if not isinstance(claims, dict):
            raise ValueError("claims must be a JSON object")
        du, pressure = (np.asarray(fields[name], dtype=float) for name in ("du", "pressure"))
        if du.ndim != 1 or pressure.ndim != 1:
            raise ValueError("du and pressure must each be a list of numbers")
    unknown = [name for name in claims if name not in CLAIMS]
    if unknown:
        raise UsageError(f"{path}: claim {unknown[0]!r} must be one of {', '.join(CLAIMS)}")
    return Given(du, pressure, claims)


@contextmanager
def _in_one_line(path: Path, what: str) -> Iterator[None]:
    """Any fault of a file as a UsageError of one line."""
    try:
        yield
    except (ValueError, KeyError, TypeError) as error:
        why = f"{error} is missing" if isinstance(error, KeyError) else str(error).splitlines()[0]
        raise UsageError(f"{path} is {what}: {why}") from None


def _values(path: Path, required: Sequence[str], optional: Sequence[str] = ()) -> Mapping[str, Any]:
    """Arrays of a .npz, or the object in a .json; raises ValueError, and OSError when there is no file."""
    if path.suffix != ".json":
        return read_arrays(path, required, optional)
    content = read_json(path)
    if not isinstance(content, dict):
        raise ValueError("it must be a JSON object")
    return content


def judge_answer(step: FrozenStep, given: Given, asked: float = CERTIFIED) -> Judgement:
    """Recompute every residual and compare every claim with it; raises UsageError for the wrong number of values."""
    scales = Scales.of(step)
    try:
        worth = accuracy(step, given.du, given.pressure, scales)
    except ValueError as error:
        raise UsageError(str(error)) from None
    finite = bool(np.all(np.isfinite(given.du)))
    length = scales.gap(step.G @ given.du) if finite else scales.length
    claims = tuple(_claim(step, given, worth, scales, *item) for item in given.claims.items())
    certified = worth.worst <= asked
    verdict = f"{'certified' if certified else 'NOT certified'}: accuracy {worth.worst:.2e}, asked {asked:.0e}"
    return Judgement(asdict(worth), scales.force, length, certified, verdict, claims)


def _claim(step: FrozenStep, given: Given, worth: Accuracy, scales: Scales, what: str, value: Any) -> Claim:
    if what == "pressed":
        return _pressed(given, value)
    claimed = _number(what, value)
    if what == "force":
        actual = float(np.sum(step.problem().nodal_forces(given.pressure)))
        off = abs(actual - claimed) / max(abs(actual), scales.force)
        return Claim(what, f"{claimed:.9g}", f"{actual:.9g}", off, not off <= SAME)
    actual = worth.worst if what == "accuracy" else float(getattr(worth, what))
    off = actual / claimed if claimed > 0 else np.inf if actual > 0 else 1.0
    return Claim(what, f"{claimed:.2e}", f"{actual:.2e}", off, not actual <= claimed)


def _pressed(given: Given, claimed: Any) -> Claim:
    """off: number of candidates in exactly one of the two sets."""
    if not isinstance(claimed, list) or not all(isinstance(i, int) and 0 <= i < len(given.pressure) for i in claimed):
        raise UsageError(f"claim pressed must be a list of candidates from 0 to {len(given.pressure) - 1}")
    actual = set(np.flatnonzero(given.pressure > 0).tolist())
    off = len(actual ^ set(claimed))
    return Claim("pressed", f"{len(claimed)} candidates", f"{len(actual)}", off, off > 0)


def _number(what: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not (value >= 0 or what == "force"):
        raise UsageError(f"claim {what} = {value!r} must be a number in [0, inf)")
    return float(value)


def judge_friction_answer(step: FrozenFrictionalStep, path: Path) -> Judgement:
    """Recompute every residual of the answer in a file; raises UsageError where it is invalid or has the wrong size."""
    with _in_one_line(path, "not an answer to a problem with friction"):
        fields = _values(path, (), RUBBED)
        du, normal, friction = (np.asarray(fields[name], dtype=float) for name in RUBBED)
    if du.shape != step.r.shape:
        raise UsageError(f"du of the shape {du.shape} for {len(step.r)} unknowns")
    try:
        by_forces = replace(step.problem(), weights=np.ones(len(step.mu)))  # normal forces for pressures
        verdict = judge(by_forces, du, normal, friction)
    except ValueError as error:
        raise UsageError(str(error)) from None
    failures = verdict.failures()
    word = f"NOT certified: {', '.join(failures)}" if failures else "certified: every residual within its bound"
    scales = verdict.certificate["scales"]
    return Judgement(verdict.kkt, scales["force_N"], scales["length_mm"], not failures, word)

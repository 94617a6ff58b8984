"""What an answer from outside is worth: every claim recomputed from the file of the problem and that of the answer.

An answer is a .npz or a .json with ``du`` (n,) [mm], and ``pressure`` (m,) [MPa] with the ``claims`` it makes; to a
problem with friction ``normal`` (m,) [N] and ``friction`` (m, 2) [N], without claims. The residuals and bounds of
friction are those of :mod:`contact.verify`. No algorithm is run and no answer of ours is looked at here.
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
from contact.verify import judge
from studies.arena.accuracy import RESIDUALS, Accuracy, Scales, accuracy
from studies.ask.request import UsageError

CERTIFIED = 1e-8  # accuracy that is asked for unless said otherwise
SAME = 1e-9  # relative, of a claimed force
CLAIMS = ("accuracy", *RESIDUALS, "force", "pressed")
RUBBED = ("du", "normal", "friction")
OFF = {"force": "of the larger of it and F", "pressed": "candidates"}  # a false claim; residuals: by a factor


@dataclass(frozen=True, eq=False)
class Given:
    """An answer as it came: du (n,) [mm], pressure (m,) [MPa], and what it claims about itself."""

    du: np.ndarray
    pressure: np.ndarray
    claims: Mapping[str, Any]


@dataclass(frozen=True)
class Claim:
    """A claim, what it is in truth, and how far it is from that; false where that is farther than it may be."""

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
        """In words: each residual, each claim, the verdict last."""
        told = [f"{name}: {value:.2e}" for name, value in self.residuals.items()]
        told.append(f"relative to {self.force_N:.6g} N and {self.length_mm:.6g} mm")
        for claim in self.claims:
            how = f"FALSE by {claim.off:.3g} {OFF.get(claim.what, 'times')}" if claim.false else "true"
            told.append(f"claim {claim.what} = {claim.claimed}: {how}, it is {claim.found}")
        return [*told, self.verdict]


def read_answer(path: Path) -> Given:
    """From a .npz or a .json; raises UsageError with the fault, OSError when there is no file."""
    with _in_one_line(path, "no answer"):
        told = _values(path, ("du", "pressure"), ("claims",))
        claims = told.get("claims", {})
        if isinstance(claims, np.ndarray):  # of a .npz, as text
            claims = parsed_object(text_of(claims, "claims"), "claims")
        if not isinstance(claims, dict):
            raise ValueError("claims must be a JSON object")
        du, pressure = (np.asarray(told[name], dtype=float) for name in ("du", "pressure"))
        if du.ndim != 1 or pressure.ndim != 1:
            raise ValueError("du and pressure must each be a list of numbers")
    unknown = [name for name in claims if name not in CLAIMS]
    if unknown:
        raise UsageError(f"{path}: claim {unknown[0]!r} must be one of {', '.join(CLAIMS)}")
    return Given(du, pressure, claims)


@contextmanager
def _in_one_line(path: Path, what: str) -> Iterator[None]:
    """Whatever is wrong with a file, as UsageError."""
    try:
        yield
    except (ValueError, KeyError, TypeError) as error:
        why = f"{error} is missing" if isinstance(error, KeyError) else str(error).splitlines()[0]
        raise UsageError(f"{path} is {what}: {why}") from None


def _values(path: Path, wanted: Sequence[str], optional: Sequence[str] = ()) -> Mapping[str, Any]:
    """Arrays of a .npz, or what a .json holds; raises ValueError, and OSError when there is no file."""
    if path.suffix != ".json":
        return read_arrays(path, wanted, optional)
    told = read_json(path)
    if not isinstance(told, dict):
        raise ValueError("it must be a JSON object")
    return told


def judge_answer(step: FrozenStep, given: Given, asked: float = CERTIFIED) -> Judgement:
    """Every residual recomputed, every claim held against it; raises UsageError for the wrong number of values."""
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


def _claim(step: FrozenStep, given: Given, worth: Accuracy, scales: Scales, what: str, said: Any) -> Claim:
    if what == "pressed":
        return _pressed(given, said)
    claimed = _number(what, said)
    if what == "force":
        found = float(np.sum(step.problem().nodal_forces(given.pressure)))
        off = abs(found - claimed) / max(abs(found), scales.force)
        return Claim(what, f"{claimed:.9g}", f"{found:.9g}", off, not off <= SAME)
    found = worth.worst if what == "accuracy" else float(getattr(worth, what))
    off = found / claimed if claimed > 0 else np.inf if found > 0 else 1.0
    return Claim(what, f"{claimed:.2e}", f"{found:.2e}", off, not found <= claimed)


def _pressed(given: Given, said: Any) -> Claim:
    """off: how many candidates are in one of the two sets alone."""
    if not isinstance(said, list) or not all(isinstance(i, int) and 0 <= i < len(given.pressure) for i in said):
        raise UsageError(f"claim pressed must be a list of candidates from 0 to {len(given.pressure) - 1}")
    found = set(np.flatnonzero(given.pressure > 0).tolist())
    off = len(found ^ set(said))
    return Claim("pressed", f"{len(said)} candidates", f"{len(found)}", off, off > 0)


def _number(what: str, said: Any) -> float:
    if isinstance(said, bool) or not isinstance(said, int | float) or not (said >= 0 or what == "force"):
        raise UsageError(f"claim {what} = {said!r} must be a number in [0, inf)")
    return float(said)


def judge_friction_answer(step: FrozenFrictionalStep, path: Path) -> Judgement:
    """Every residual of the answer in a file recomputed; raises UsageError for what is none, or of another size."""
    with _in_one_line(path, "no answer to a problem with friction"):
        told = _values(path, (), RUBBED)
        du, normal, friction = (np.asarray(told[name], dtype=float) for name in RUBBED)
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

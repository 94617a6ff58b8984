"""The members of a sweep: one or two settings over ranges, the order they are solved in, and what is kept of each.

Nothing is solved here.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from studies.ask.request import Request, UsageError, names_for
from studies.ask.scene import has_contact, settings_beside
from studies.ask.settings import Setting, settings_of
from studies.output.atomic import as_text, plain, write_json
from studies.output.provenance import provenance
from studies.run.plan import identity
from studies.scenes import SCENES
from studies.scenes.plugins import use_options
from studies.solving.result import CLASSES, SOLVED

FEWEST, LONGEST, MOST = 2, 1000, 10_000  # values of a range, and members
DIRECTIONS = 2
UNEVEN = 1e-6  # of a step of a range
DIGITS = 13  # of the largest value of a range, that the others have
SWEEP = "studies.sweeps.sweep"  # what solves it
REST = "rest"
Place = tuple[int, ...]  # of a member: the index of its value in each range


@dataclass(frozen=True)
class Range:
    """A setting and its values, evenly spaced."""

    key: str
    values: tuple[float, ...]

    @classmethod
    def of(cls, setting: Setting, wanted: str | Sequence[float]) -> Range:
        """From "A:B:N", or from the values; raises UsageError with one line."""
        text = isinstance(wanted, str)
        given = wanted if text else np.atleast_1d(np.asarray(wanted, dtype=object)).tolist()
        label = f"over {setting.key}={given}"
        form = f"N values from A to B, N a whole number in [{FEWEST}, {LONGEST}]"
        if setting.kind != "float":
            several = f"; a solve takes several, --set {setting.key}=A,B,..." if setting.kind == "floats" else ""
            raise UsageError(f"{label}: {setting.key} is not one number: {setting.range_text}{several}")
        *ends, number = map(str, given.split(":") if isinstance(given, str) else (*given, len(given)))
        if (text and len(ends) != 2) or not number.isdecimal() or not FEWEST <= int(number) <= LONGEST:
            raise UsageError(f"{label} must be A:B:N, {form}")
        numbers = np.array([setting.parse(end) for end in ends], float)
        values = np.linspace(numbers[0], numbers[-1], int(number))
        if np.isfinite(values).all():  # digits of rounding are no part of a setting: 0 is 0
            values[1:-1] = values[1:-1].round(DIGITS - int(np.ceil(np.log10(np.max(np.abs(values)) or 1.0))))
        if not np.isfinite(values).all() or values[0] == values[-1]:
            raise UsageError(f"{label}: A and B must be two finite numbers that differ")
        if not text and np.max(np.abs(values - numbers)) > UNEVEN * abs(values[1] - values[0]):
            raise UsageError(f"{label} must be evenly spaced")
        return cls(setting.key, tuple(values.tolist()))


def ranges_of(
    scene: str, over: Mapping[str, str | Sequence[float]], given: Mapping[str, object], contact: str
) -> tuple[Range, ...]:
    """One or two of them; raises UsageError with one line."""
    if not isinstance(over, Mapping):
        raise UsageError(f"over {over!r} must be settings with their values, as {{'KEY': [A, ..., B]}}")
    if not 1 <= len(over) <= DIRECTIONS:
        raise UsageError(f"over {', '.join(over) or 'nothing'}: a sweep goes over one setting or two")
    known: dict[str, Setting] = {}
    if scene in SCENES:
        entry = SCENES[scene]
        of_contact = settings_of(contact) if has_contact(entry) else ()
        known = {setting.key: setting for setting in (*entry.settings, *settings_beside(entry), *of_contact)}
    for key in over:
        if key not in known:
            has = names_for(key, known, " ".join(["footprint show", scene, *use_options()]))
            raise UsageError(f"{scene} has no setting {key!r}; it has {has}")
        if key in given:
            raise UsageError(f"{key} = {given[key]} is given, and swept over: it can be one of both")
    ranges = tuple(Range.of(known[key], values) for key, values in over.items())
    count = math.prod(len(each.values) for each in ranges)
    if count > MOST:
        raise UsageError(f"{count} members: a sweep has at most {MOST}")
    return ranges


def places(ranges: Sequence[Range]) -> Iterator[Place]:
    """Of all members, as they stand in tables."""
    yield from product(*(range(len(each.values)) for each in ranges))


def order(ranges: Sequence[Range]) -> Iterator[Place]:
    """Of all members, back and forth, the shorter range from one value of the longer to the next."""
    counts = [len(each.values) for each in ranges]
    outer = int(np.argmax(counts))
    for i in range(counts[outer]):
        if len(counts) == 1:
            yield (i,)
        else:
            row = range(counts[1 - outer])
            yield from ((j, i) if outer else (i, j) for j in (row if i % 2 == 0 else reversed(row)))


def settings_at(ranges: Sequence[Range], place: Place) -> dict[str, float]:
    """What a member has of what is swept over."""
    return {each.key: each.values[i] for each, i in zip(ranges, place, strict=True)}


@dataclass(frozen=True)
class Member:
    """The outcome of one member.

    settings: its values of what is swept over.  verdict: of :data:`CLASSES`.  reason: why it is not converged, or the
    notes of an answer that is.  quantities: at the last load, and errors: {quantity: {low, high}}, none where it is not
    solved.  seconds: CPU time of all its grids.  started_from: members, another grid, or REST.
    """

    settings: dict[str, float]
    verdict: str
    reason: str = ""
    quantities: dict[str, float | None] = field(default_factory=dict)
    errors: dict[str, dict[str, float]] = field(default_factory=dict)
    newton_iterations: int = 0
    seconds: float = 0.0
    started_from: str = REST

    @property
    def normal(self) -> Member:
        """As it is read from its file, whether it is kept or not."""
        return Member(**plain(asdict(self)))

    @property
    def solved(self) -> bool:
        """Whether there is an equilibrium that the judge certifies."""
        return self.verdict in SOLVED

    def error(self, quantity: str) -> float | None:
        """The largest error that the value may have, relative to its limit; None where it is not known."""
        interval, value = self.errors.get(quantity), self.quantities.get(quantity)
        if interval is None or value is None:
            return None
        low, high = interval["low"], interval["high"]
        return max(high - value, value - low) / (abs(high + low) / 2 or math.ulp(0.0))


@dataclass(frozen=True)
class Kept:
    """Members in a directory, a file each; those solved by other sources or for another request are ignored.

    scene: its name.  beside: what decides a member beside its request.
    """

    directory: Path
    scene: str
    beside: object

    def read(self, request: Request) -> Member | None:
        """A member that was kept whole; None without one."""
        identity = self.identity(request)
        try:
            record = json.loads(self.path(identity).read_text(encoding="utf-8"))
            member = Member(**record["member"])
            whole = record["identity"] == identity and record["sum"] == _sum(record["member"])
        except (OSError, ValueError, LookupError, TypeError, RecursionError):
            return None
        return member if whole and member.verdict in CLASSES else None

    def write(self, request: Request, member: Member) -> None:
        """Keep one."""
        data, identity = plain(asdict(member)), self.identity(request)
        record = {"identity": identity, "request": request.data, "beside": self.beside, "member": data}
        write_json(self.path(identity), {**record, "sum": _sum(data), "provenance": provenance()})

    def path(self, identity: str) -> Path:
        """The file of a member."""
        return self.directory / f"{identity[:16]}.json"

    def identity(self, request: Request) -> str:
        """Hash of all that decides a member: neither date nor machine."""
        deck = [path.read_text(errors="replace") for path in _deck(self.scene) if path.is_file()]
        return _sum([identity(request, SWEEP), plain(self.beside), deck])


def _sum(data: Any) -> str:
    return hashlib.sha256(as_text({"": data}).encode()).hexdigest()


def _deck(scene: str) -> tuple[Path, Path]:
    """Where the files of a scene are that is a deck."""
    return Path(scene), Path(scene).with_suffix(".toml")

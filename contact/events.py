"""What happens on the way to a solution, and at its end: a kind for programmes, a sentence for people.

Nothing may be decided by the sentence.
"""

from __future__ import annotations

import enum
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np


class EventKind(enum.Flag):
    """Kinds; one event may be of several."""

    STEP_CUT = enum.auto()  # an attempt was rejected, the next one is half as long
    STEP_GROWN = enum.auto()  # an easy step: the next one is twice as long
    PATH_END = enum.auto()  # no step is small enough
    TAKEN_IN = enum.auto()  # candidates that were left out penetrate
    CYCLE = enum.auto()  # a set came back, and single candidates are swapped
    SUBSTITUTE = enum.auto()  # what had to be done instead of what the algorithm does
    UPDATE = enum.auto()  # of the known pressure of an outer loop
    FAILED = enum.auto()  # why there is no step; the outcome says the rest
    PASSED = enum.auto()  # a candidate passes through the foundation
    BIFURCATION = enum.auto()  # the path has passed one
    POINT = enum.auto()  # which point of a curve is looked for


@dataclass(frozen=True)
class Event:
    """kind, and the sentence that a user reads."""

    kind: EventKind
    text: str

    def __str__(self) -> str:
        return self.text

    def __add__(self, other: Event) -> Event:
        return Event(self.kind | other.kind, f"{self.text}; {other.text}")


class PathEnd(enum.Enum):
    """What there is at the end of a path."""

    LIMIT_POINT = "limit point"
    BIFURCATION = "bifurcation"
    NEITHER = "neither"  # or not to be told


@dataclass(frozen=True, eq=False)
class Ending:
    """Why a path ends, and in one sentence.

    limit: the parameter of the limit point, where there is one; mode (n,): the unit vector along which u moves there.
    """

    kind: PathEnd
    sentence: str
    limit: float | None = None
    mode: np.ndarray | None = None


def events(history: Iterable[Mapping[str, Any]], kind: EventKind | None = None) -> list[Event]:
    """The events of a history that are of the kind, in order; of any kind by default."""
    every = [row["event"] for row in history if "event" in row]
    return every if kind is None else [event for event in every if kind & event.kind]

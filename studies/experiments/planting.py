"""How a fault is planted: it is there while a context lasts, and leaves nothing behind. No fault itself enters here."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Fault:
    """What is wrong, in words, and how it is planted: a context in which it is there.

    kind: of the cases that look for it, by default of each what is drawn from its number.
    """

    name: str
    planted: Callable[[], Any]
    kind: str = ""


@contextmanager
def swapped(place: Any, name: str, other: Any) -> Iterator[None]:
    """An entry of a dictionary, or an attribute, while the context lasts."""
    entry = isinstance(place, dict)
    kept = place[name] if entry else vars(place)[name]

    def put(value: Any) -> None:
        if entry:
            place[name] = value
        else:
            setattr(place, name, value)

    put(other)
    try:
        yield
    finally:
        put(kept)

"""How a fault is planted: it is there while a context lasts, and leaves nothing behind. No fault itself enters here."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Fault:
    """What is wrong, in words, and how it is planted: a context in which it is there.

    kind: of the cases that look for it, by default of each what is drawn from its number.
    """

    name: str
    planted: Callable[[], AbstractContextManager[None]]
    kind: str = ""


def fault(name: str, place: Any, function: str, kind: str = "") -> Callable[[Callable[..., Any]], Fault]:
    """A fault of a function of a module or a class: what stands in its place is given the sound one first."""

    def named(faulty: Callable[..., Any]) -> Fault:
        return Fault(name, lambda: swapped(place, function, _before(vars(place)[function], faulty)), kind)

    return named


def _before(sound: Callable[..., Any], faulty: Callable[..., Any]) -> Callable[..., Any]:
    """A plain function, which a class binds as it did the sound one."""
    return lambda *arguments, **options: faulty(sound, *arguments, **options)


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

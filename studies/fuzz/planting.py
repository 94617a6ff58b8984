"""How a fault is planted: it is there while a context lasts, and leaves nothing behind. No fault itself enters here."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any
from unittest.mock import patch


@dataclass(frozen=True)
class Fault:
    """What is wrong, in words, and how it is planted: a context in which it is there.

    kind: of the cases that look for it, by default of each what is drawn from its number.
    """

    name: str
    planted: Callable[[], AbstractContextManager[object]]
    kind: str = ""


def fault(name: str, place: Any, function: str, kind: str = "") -> Callable[[Callable[..., Any]], Fault]:
    """A fault of a function of a module or a class: what stands in its place is given the sound one first."""

    def named(faulty: Callable[..., Any]) -> Fault:
        return Fault(name, lambda: patch.object(place, function, _before(vars(place)[function], faulty)), kind)

    return named


def _before(sound: Callable[..., Any], faulty: Callable[..., Any]) -> Callable[..., Any]:
    """A plain function, which a class binds as it did the sound one."""
    return lambda *arguments, **options: faulty(sound, *arguments, **options)

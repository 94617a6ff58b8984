"""Scenes, solving, campaigns and their store: the room that composes formulations and contact.

Element and contact algebra must not enter here; nor may pages and pictures, which read the store alone. The names
below are for notebooks and load what they need when they are first asked for; ``import footprint`` has the same.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from studies.answers import Chosen, Run, Swept
    from studies.ask.scene import UsageError
    from studies.catalogue.descriptions import Description
    from studies.notebook import advise, card, choose, describe, gradient, judge, scene, solve, sweep

__all__ = [
    "Chosen",
    "Description",
    "Run",
    "Swept",
    "UsageError",
    "advise",
    "card",
    "choose",
    "describe",
    "gradient",
    "judge",
    "scene",
    "solve",
    "sweep",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from studies import notebook

    return getattr(notebook, name)


def __dir__() -> list[str]:
    return sorted(__all__)

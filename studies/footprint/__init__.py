"""Footprint: shells in contact, solved, judged and compared. Each name is loaded when it is first asked for.

The build lays this folder down as the package ``footprint`` beside the four others; nothing of ours imports it.
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

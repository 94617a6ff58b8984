"""Footprint: shells in contact, solved, judged and compared. The names are those of :mod:`studies`.

The build lays this folder down as the package ``footprint`` beside the four others; nothing of ours imports it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import studies
from studies import __all__ as __all__

if TYPE_CHECKING:
    from studies import *  # noqa: F403


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(studies, name)


def __dir__() -> list[str]:
    return sorted(__all__)

"""Parts from outside that break while they are used: one line that names the part and the place.

Where the parts come from is not known here (:mod:`studies.scenes.plugins`), nor what is solved with them.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from contact.answered import ContractError
from contact.catalogue import ALGORITHMS
from formulations.strains.catalogue import MEASURES
from studies.ask.request import PartError, UsageError
from studies.ask.scene import Scene

OURS = ("contact", "formulations", "reports", "studies")


@contextmanager
def blamed(contact: str, measure: str = "exact", scene: Scene | None = None) -> Iterator[None]:
    """Raise PartError for what a part from outside raises, and for an answer that is none.

    Where no part is from outside, an exception is a fault of ours and stays what it is.
    """
    try:
        yield
    except (UsageError, MemoryError):
        raise
    except ContractError as error:
        raise PartError(str(error)) from error
    except (Exception, SystemExit) as error:
        said = _said(error, _from_outside(contact, measure, scene))
        if said is None:
            raise
        raise PartError(said) from error


def _from_outside(contact: str, measure: str, scene: Scene | None) -> dict[str, str]:
    """The modules of the parts that are not ours, by what the parts are called."""
    modules = {
        f"contact algorithm {contact!r}": ALGORITHMS[contact].__module__,
        f"measure {measure!r}": type(MEASURES[measure]).__module__,
    }
    if scene is not None:
        modules[f"scene {scene.name!r}"] = type(scene).__module__
    return {part: module for part, module in modules.items() if module.partition(".")[0] not in OURS}


def _said(error: BaseException, parts: dict[str, str]) -> str | None:
    """The line: of the part in whose file it was raised, or of all that are from outside where it was in none."""
    what = " ".join(f"{type(error).__name__}: {error}".split())
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        for part, module in parts.items():
            if frame.filename == getattr(sys.modules.get(module), "__file__", None):
                return f"{part}: {Path(frame.filename).name}:{frame.lineno}: {what}"
    return f"{' or '.join(parts)}: {what}" if parts else None

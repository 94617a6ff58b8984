"""What is asked: the scene, what the reader has set, the quantity's error, and the lines that the answer gives back.

Nothing is solved here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from studies.choosing.variants import REFERENCE
from studies.complete import complete
from studies.request import Request, text_of
from studies.scene import Scene

DEFAULTS = {"contact": Request.contact, "newton": Request.newton, "model": Request.model, "steps": Request.steps}


@dataclass(frozen=True, eq=False)
class Question:
    """The scene by its name and with the lines of the reference; given: settings; options: of a request, typed."""

    name: str
    scene: Scene
    given: Mapping[str, object]
    options: Mapping[str, Any]
    error: float

    @property
    def contact(self) -> str:
        """The algorithm asked for."""
        return str(self.options.get("contact", Request.contact))

    def asked(self, mesh: str, options: Mapping[str, Any], settings: Mapping[str, str]) -> tuple[Scene, Request]:
        """The scene and the request as a command line has them, some things changed; raises UsageError."""
        return complete(self.name, {**self.given, **settings}, mesh, **self._options(options))

    def command(self, mesh: str, options: Mapping[str, Any], settings: Mapping[str, str]) -> str:
        """That command line."""
        words = [f"--{key} {value}" for key, value in self._options(options).items() if DEFAULTS.get(key) != value]
        words += [f"--set {key}={text_of(value)}" for key, value in {**self.given, **settings}.items()]
        return " ".join(["footprint solve", self.name, f"--mesh {mesh}", *words, "--out DIR"])

    def _options(self, changed: Mapping[str, Any]) -> dict[str, Any]:
        return {"measure": REFERENCE, **self.options, **changed}

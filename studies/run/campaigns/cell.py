"""A labelled request: what campaigns are lists of."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from studies.ask.request import Request
from studies.ask.scene import Scene
from studies.scenes.complete import complete


@dataclass(frozen=True)
class Cell:
    """A labelled request: ``label`` is for people, ``options`` are those of ``footprint solve``.

    artefacts: its fields and tables are kept beside its record.  group: the list that it is of.
    expected: why it is expected not to go as asked, if so.
    """

    label: str
    scene: str
    options: dict[str, Any] = field(default_factory=dict)
    settings: dict[str, str] = field(default_factory=dict)
    artefacts: bool = True
    expected: str = ""
    group: str = ""

    def resolved(self) -> tuple[Scene, Request]:
        """The scene and the request; raises UsageError when there is none."""
        return complete(self.scene, self.settings, **self.options)

    @property
    def command(self) -> str:
        """The command that reproduces the cell."""
        words = [f"--{key} {value}" for key, value in self.options.items()]
        words += [f"--set {key}={value}" for key, value in self.settings.items()]
        return " ".join(["footprint solve", self.scene, *words, "--out DIR"])

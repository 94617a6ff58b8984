"""What is asked of a process that solves cells; only what a warm process has loaded anyway enters here."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from studies.scenes.complete import Cell


@dataclass(frozen=True)
class Limits:
    """Of one cell: seconds of wall time, and MB of private memory beyond an idle process."""

    time_s: float = 900.0
    memory_MB: float = 8192.0


KEPT = ("cell", "fuzz")  # kinds of tasks whose answers are records


@dataclass(frozen=True)
class Task:
    """A cell, a table of the whole store, a random case, or the canary, to be done; all that a worker has to know.

    use: the files of plug-ins that are loaded before.
    """

    kind: str
    id: str
    cell: Cell | None = None
    use: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """For people."""
        return f"{self.kind} {self.id}" if self.cell is None else self.cell.label


Order = tuple[Task, Limits, Path | None]  # and the folder that the files of the task go to, if they are kept

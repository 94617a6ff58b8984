"""All solvers of the arena by name; one that is not installed is listed, too."""

from __future__ import annotations

from studies.arena.solvers.base import Solver
from studies.arena.solvers.condensed import CONDENSED
from studies.arena.solvers.ours import OURS
from studies.arena.solvers.outside import OUTSIDE

SOLVERS: dict[str, Solver] = {solver.name: solver for solver in (*OURS, *OUTSIDE, *CONDENSED)}

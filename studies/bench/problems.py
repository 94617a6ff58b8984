"""What every program solves: problems with references that are not ours, a line of work and precision, one solve."""

import math
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from studies.scenes import SCENES
from studies.scenes.complete import closest, complete
from studies.scenes.data import reference_rows

MEASURED = tomllib.loads(Path(__file__).with_name("measured.toml").read_text(encoding="utf-8"))
DELTA_MM = 10.0
SOLID, PLIES = "isotropic_tyre_3d_solid.csv", "bias_tyre_3d_solid.csv"
KNOWN = {SOLID: 0.003, PLIES: 0.01}  # relative uncertainty


class Solved(NamedTuple):
    """The value of one solve, nan where the load was not reached, and what it took.

    unknowns: prescribed ones included where a program counts them.  seconds: processor time from the request to the
    value.  start, assembly, factorisation [s] of it: mesh and spaces; elements and residuals; factorising tangents.
    """

    value: float
    unknowns: int
    iterations: int
    seconds: float
    start: float
    assembly: float
    factorisation: float


@dataclass(frozen=True)
class Problem:
    """A quantity of a scene at its full load; its reference and the relative uncertainty of that, from ``source``.

    within: relative error at which costs are compared.  bar: how many times the seconds of the shells the best mesh of
    a peer is to take there, nan without one.  linear: one solve of a linear shell, whose time is no matter.
    """

    name: str
    quantity: str
    reference: float
    uncertainty: float
    within: float
    bar: float = math.nan
    linear: bool = False


@dataclass(frozen=True)
class Line:
    """A program with one choice of its settings, ``family``, on meshes from coarse to fine, each by ``solve(mesh)``."""

    problem: str
    program: str
    family: str
    meshes: tuple[str, ...]
    solve: Callable[[str], Solved]


@dataclass(frozen=True)
class LinearShell:
    """A quantity of a scene of quadrilaterals by the linear measure, on meshes from coarse to fine."""

    scene: str
    quantity: str
    meshes: tuple[str, ...]
    settings: Mapping[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """That of the problem."""
        return ", ".join([self.scene, *self.settings.values()])

    @property
    def asked(self) -> dict[str, Any]:
        """What is solved, but for the mesh."""
        return {"scene": self.scene, "quantity": self.quantity, "settings": self.settings}

    def problem(self) -> Problem:
        """Raises LookupError without a reference."""
        _, request = complete(self.scene, self.settings, self.meshes[0], measure="linear")
        there = {**request.settings, "measure": "linear", "load_fraction": 1.0}
        known = closest(self.scene, there, {self.quantity})
        if self.quantity not in known:
            raise LookupError(f"{self.name} has no reference of {self.quantity}")
        reference = known[self.quantity]
        return Problem(self.name, self.quantity, reference.value, reference.uncertainty, 0.01, linear=True)


LINEAR_SHELLS = tuple(LinearShell(**{**each, "meshes": tuple(each["meshes"])}) for each in MEASURED["linear"])


def size(mesh: str) -> tuple[int, int]:
    """Both numbers of N1xN2."""
    n1, n2 = mesh.split("x")
    return int(n1), int(n2)


@cache
def problems() -> dict[str, Problem]:
    """By name."""
    listed = (
        Problem("tyre, isotropic", "force_N", solid_force(SOLID), KNOWN[SOLID], 0.003, 100.0),
        # 5 %: a shell with one director through four plies ends two to three per cent above the solid
        Problem("tyre, angle plies", "force_N", solid_force(PLIES), KNOWN[PLIES], 0.05),
        Problem("hemisphere", "inward_mm", *_published("hemisphere", "inward_mm", "read"), 0.01, 50.0),
        Problem("sze-pullout", "w_A_mm", *_published("sze-pullout", "w_A_mm", "read"), 0.01),
        Problem("cantilever", "tip_deflection_mm", *_published("cantilever", "tip_deflection_mm", "exact"), 0.01),
        *(shell.problem() for shell in LINEAR_SHELLS),
    )
    return {problem.name: problem for problem in listed}


def solid_force(file: str) -> float:
    """Force [N] of the finest solid of a table at DELTA_MM."""
    rows = reference_rows(file)
    return next(row["force_N_ngsolve"] for row in rows if row["delta_mm"] == DELTA_MM)


def _published(scene: str, quantity: str, kind: str) -> tuple[float, float]:
    """Value and relative uncertainty of the reference of a scene at full load."""
    for each in SCENES[scene].references:
        if (each.quantity, each.kind, each.at) == (quantity, kind, {"load_fraction": 1.0}):
            return each.value, each.uncertainty
    raise LookupError(f"{scene} has no {kind} reference of {quantity}")

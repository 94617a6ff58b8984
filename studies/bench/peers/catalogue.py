"""Our lines and those of other programs: scenes of the catalogue with the settings that reach most for their cost, and
what each program needs; one that is not installed is left out by name.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from contact.problem import Outcome
from studies.bench.peers.problems import DELTA_MM, Line, Solved
from studies.output.stopwatch import timed
from studies.scenes.complete import complete
from studies.scenes.tyre.scene import ISOTROPIC
from studies.solving.solve import solve

FULL = {"load_fraction": "1"}
FOLLOWER = {"load": "follower", "pressure_area": "face", "delta_mm": repr(DELTA_MM)}
ISOTROPIC_TYRE = {**ISOTROPIC, "delta_mm": repr(DELTA_MM)}
TYRES = ("20x18", "24x22", "28x26", "32x30", "36x34", "40x38", "48x46", "60x58", "72x70")  # of the whole
PLY_TYRES = ("20x18", "28x26", "36x34", "42x40", "60x58", "84x80")
SQUARES = tuple(f"{n}x{n}" for n in (8, 10, 12, 14, 16, 20, 24, 32, 48))
OCTANTS = ("6x9", "8x12", "12x18", "16x24", "24x36")
STRIPS = ("4x1", "8x1", "16x1", "32x1", "64x1")
PAPER = {"element": "paper"}
NODAL = {"thickness_strain": "nodal"}
# elements over psi and phi, of the quarter; those of a wall of plies of the whole
QUARTERS = {
    2: ("6x6", "8x8", "12x12", "12x16", "16x16", "20x20"),
    3: ("4x4", "5x5", "6x6", "8x8", "10x10", "14x12"),
    4: ("3x3", "4x4", "5x5", "6x6"),
}
WHOLES = {2: ("8x8", "12x10", "16x14", "20x18"), 3: ("8x8", "10x8")}
KRATOS = {
    "hemisphere": ("8x8", "12x12", "16x16", "20x20", "24x24", "32x32"),
    "sze-pullout": ("6x9", "8x12", "12x18", "16x24"),
    "cantilever": ("4x1", "8x1", "16x1", "32x1", "64x1"),
}
KINDS = ("thick quadrilaterals", "thin quadrilaterals", "thick triangles")


@dataclass(frozen=True)
class Peer:
    """A program, the modules that it comes in, and its lines, which import them."""

    name: str
    modules: tuple[str, ...]
    lines: Callable[[], tuple[Line, ...]]

    @property
    def missing(self) -> str:
        """Why it is left out, nothing where it is there."""
        absent = [name for name in self.modules if not _found(name)]
        return f"{self.name} is skipped: no module {', '.join(absent)} (extra peers)" if absent else ""


def _found(module: str) -> bool:
    try:
        return importlib.util.find_spec(module) is not None
    except ModuleNotFoundError:  # of its package
        return False


def _ngsolve() -> tuple[Line, ...]:
    from studies.bench.peers.ngsolve_tyre import AnglePlies, Isotropic, tyre

    return tuple(
        Line(problem, "ngsolve", f"order {order}", meshes, partial(tyre, delta_mm=DELTA_MM, wall=wall, order=order))
        for problem, wall, orders in (
            ("tyre, isotropic", Isotropic(), QUARTERS),
            ("tyre, angle plies", AnglePlies(), WHOLES),
        )
        for order, meshes in orders.items()
    )


def _kratos() -> tuple[Line, ...]:
    from studies.bench.peers.kratos_shells import shell

    return tuple(
        Line(problem, "kratos", kind, meshes, partial(shell, problem, kind))
        for problem, meshes in KRATOS.items()
        for kind in KINDS
    )


PEERS = (
    Peer("ngsolve", ("ngsolve",), _ngsolve),
    Peer(
        "kratos",
        tuple(
            f"KratosMultiphysics{part}" for part in ("", ".StructuralMechanicsApplication", ".LinearSolversApplication")
        ),
        _kratos,
    ),
)


def available() -> tuple[tuple[Line, ...], tuple[str, ...]]:
    """The lines of all programs that are there, ours first, and a sentence for each that is not."""
    found = [line for peer in PEERS if not peer.missing for line in peer.lines()]
    beside = {line.problem for line in found}
    own = [line for line in lines() if line.problem in beside]
    return (*own, *found), tuple(peer.missing for peer in PEERS if peer.missing)


# --- ours -------------------------------------------------------------------------------------------------------------


def lines() -> tuple[Line, ...]:
    """Each family of each problem."""
    tyres = (
        ("tyre, isotropic", "element paper", TYRES, "quarter", {**ISOTROPIC_TYRE, **PAPER}),
        ("tyre, isotropic", "default", TYRES, "quarter", ISOTROPIC_TYRE),
        ("tyre, angle plies", "whole, element paper", PLY_TYRES, "full", {**FOLLOWER, **PAPER}),
        ("tyre, angle plies", "half, element paper", PLY_TYRES, "half", {**FOLLOWER, **PAPER}),
    )
    shells = (
        ("hemisphere", "inward_mm", SQUARES),
        ("sze-pullout", "w_A_mm", OCTANTS),
        ("cantilever", "tip_deflection_mm", STRIPS),
    )
    families = {"default": FULL, "thickness strain at nodes": {**FULL, **NODAL}}
    return (
        *(
            Line(problem, "footprint", family, meshes, partial(solved, "tyre", "force_N", model, settings))
            for problem, family, meshes, model, settings in tyres
        ),
        *(
            Line(scene, "footprint", family, meshes, partial(solved, scene, quantity, "auto", settings))
            for scene, quantity, meshes in shells
            for family, settings in families.items()
        ),
    )


def solved(scene: str, quantity: str, model: str, settings: Mapping[str, str], mesh: str) -> Solved:
    """The quantity at the last load.  The parts are shares of wall time, taken of the processor time."""
    seconds, result = timed(lambda: solve(*complete(scene, settings, mesh, model=model)))
    value = float(result.steps[-1][quantity]) if result.outcome is Outcome.CONVERGED else math.nan
    parts = (seconds * result.timing[part] / result.timing["total"] for part in ("build", "assembly", "factorisation"))
    return Solved(value, int(result.counters["dofs"]), int(result.counters["newton_iterations"]), seconds, *parts)

"""The programs beside ours: what each needs, and its lines; one that is not installed is left out by name."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from studies.bench.peers import shells
from studies.bench.peers.problems import DELTA_MM, Line

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
    own = [line for line in shells.lines() if line.problem in beside]
    return (*own, *found), tuple(peer.missing for peer in PEERS if peer.missing)

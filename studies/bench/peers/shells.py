"""Our lines: scenes of the catalogue with the settings that reach most for their cost."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from time import process_time

from contact.problem import Outcome
from studies.bench.peers.problems import DELTA_MM, Line, Solved
from studies.complete import complete
from studies.scenes.tyre.scene import ISOTROPIC
from studies.solving import solve

FULL = {"load_fraction": "1"}
FOLLOWER = {"load": "follower", "pressure_area": "face", "delta_mm": repr(DELTA_MM)}
ISOTROPIC_TYRE = {**ISOTROPIC, "delta_mm": repr(DELTA_MM)}
TYRES = ("20x18", "24x22", "28x26", "32x30", "36x34", "40x38", "48x46", "60x58", "72x70")  # of the whole
PLY_TYRES = ("20x18", "28x26", "36x34", "42x40", "60x58", "84x80")
SQUARES = tuple(f"{n}x{n}" for n in (8, 10, 12, 14, 16, 20, 24, 32, 48))
OCTANTS = ("6x9", "8x12", "12x18", "16x24", "24x36")
STRIPS = ("4x1", "8x1", "16x1", "32x1", "64x1")
NODAL = {"thickness_strain": "nodal"}


def lines() -> tuple[Line, ...]:
    """Each family of each problem."""
    paper, plain = {"element": "paper"}, dict[str, str]()
    tyres = (
        _tyre("element paper", "tyre, isotropic", TYRES, "quarter", {**ISOTROPIC_TYRE, **paper}),
        _tyre("default", "tyre, isotropic", TYRES, "quarter", ISOTROPIC_TYRE),
        _tyre("whole, element paper", "tyre, angle plies", PLY_TYRES, "full", {**FOLLOWER, **paper}),
        _tyre("half, element paper", "tyre, angle plies", PLY_TYRES, "half", {**FOLLOWER, **paper}),
    )
    shells = (
        _line(scene, scene, family, meshes, quantity, "auto", {**FULL, **settings})
        for scene, quantity, meshes in (
            ("hemisphere", "inward_mm", SQUARES),
            ("sze-pullout", "w_A_mm", OCTANTS),
            ("cantilever", "tip_deflection_mm", STRIPS),
        )
        for family, settings in (("default", plain), ("thickness strain at nodes", NODAL))
    )
    return (*tyres, *shells)


def _tyre(family: str, problem: str, meshes: tuple[str, ...], model: str, settings: Mapping[str, str]) -> Line:
    return _line(problem, "tyre", family, meshes, "force_N", model, settings)


def _line(
    problem: str, scene: str, family: str, meshes: tuple[str, ...], quantity: str, model: str, chosen: Mapping[str, str]
) -> Line:
    work = partial(solved, scene, quantity, model, chosen)
    return Line(problem, "footprint", family, meshes, work)


def solved(scene: str, quantity: str, model: str, settings: Mapping[str, str], mesh: str) -> Solved:
    """The quantity at the last load.  The parts are shares of wall time, taken of the processor time."""
    begun = process_time()
    result = solve(*complete(scene, settings, mesh, model=model))
    reached = result.outcome is Outcome.CONVERGED
    value = float(result.steps[-1][quantity]) if reached else math.nan
    seconds = process_time() - begun
    parts = (seconds * result.timing[part] / result.timing["total"] for part in ("build", "assembly", "factorisation"))
    return Solved(value, int(result.counters["dofs"]), int(result.counters["newton_iterations"]), seconds, *parts)

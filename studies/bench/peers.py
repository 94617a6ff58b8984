"""Other programs beside ours: which there are and what they solve, error against processor time, and their decks.

``footprint bench peers`` measures work and precision of shells and of other programs in one run: processor time of one
thread, from the request to the value, without imports; rounds in which every mesh of every program has its turn, so
that what the machine does meanwhile meets all. Seconds are stated in units of one factorisation by SuperLU of the whole
paper's tyre on 42x40 (9840 unknowns) in the same rounds, too. A program that is not installed is left out by name.
"""

import importlib.util
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd

from contact.problem import Outcome
from contact.solvers.sparse import factorise
from studies.bench.costs import at_rest, shell_of
from studies.bench.problems import DELTA_MM, LINEAR_SHELLS, Line, Solved, problems
from studies.bench.programs import Case
from studies.output.stopwatch import timed
from studies.output.terminal import columns
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
    from studies.bench.ngsolve_tyre import AnglePlies, Isotropic, tyre

    return tuple(
        Line(problem, "ngsolve", f"order {order}", meshes, partial(tyre, delta_mm=DELTA_MM, wall=wall, order=order))
        for problem, wall, orders in (
            ("tyre, isotropic", Isotropic(), QUARTERS),
            ("tyre, angle plies", AnglePlies(), WHOLES),
        )
        for order, meshes in orders.items()
    )


def _kratos() -> tuple[Line, ...]:
    from studies.bench.kratos_shells import linear, shell

    return (
        *(
            Line(problem, "kratos", kind, meshes, partial(shell, problem, kind))
            for problem, meshes in KRATOS.items()
            for kind in KINDS
        ),
        *(Line(each.name, "kratos", KINDS[0], each.meshes, partial(linear, each)) for each in LINEAR_SHELLS),
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
        *(
            Line(
                each.name,
                "footprint",
                "default",
                each.meshes,
                partial(solved, each.scene, each.quantity, "auto", each.settings, measure="linear"),
            )
            for each in LINEAR_SHELLS
        ),
    )


def solved(
    scene: str, quantity: str, model: str, settings: Mapping[str, str], mesh: str, *, measure: str = "exact"
) -> Solved:
    """The quantity at the last load.  The parts are shares of wall time, taken of the processor time."""
    seconds, result = timed(lambda: solve(*complete(scene, settings, mesh, model=model, measure=measure)))
    value = float(result.steps[-1][quantity]) if result.outcome is Outcome.CONVERGED else math.nan
    parts = (seconds * result.timing[part] / result.timing["total"] for part in ("build", "assembly", "factorisation"))
    return Solved(value, int(result.counters["dofs"]), int(result.counters["newton_iterations"]), seconds, *parts)


ROUNDS = 3
LONG = 20.0  # seconds of a solve that is not repeated
UNIT_MESH = "42x40"
KEYS = ["problem", "program", "family", "mesh"]


def unit_of(mesh: str = UNIT_MESH) -> Callable[[], float]:
    """A function that factorises the tangent of the tyre at rest by SuperLU: processor time [s]."""
    work = partial(factorise, at_rest(shell_of(mesh)), "splu", ordered=True)
    return lambda: timed(work)[0]


def measured(
    lines: Sequence[Line],
    unit: Callable[[], float],
    rounds: int = ROUNDS,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
) -> pd.DataFrame:
    """A row a mesh: problem, program, family, mesh, value, unknowns, iterations, seconds and parts of them, error.

    units: seconds over the median of ``unit()``.  seconds and the rest are medians over ``rounds``, or of one run
    that took LONG.  within, bar, uncertainty: of the problem.  value is nan where a program did not get there.
    """
    works = [(line, mesh) for line in lines for mesh in line.meshes]
    rows: list[dict[str, object]] = []
    units: list[float] = []
    long: set[tuple[str, ...]] = set()
    for turn in range(rounds):
        units.append(unit())
        for done, (line, mesh) in enumerate(works):
            key = (line.problem, line.program, line.family, mesh)
            progress(turn * len(works) + done, rounds * len(works), " ".join(key[1:]))
            if key in long:
                continue
            solved = line.solve(mesh)
            long |= {key} if solved.seconds > LONG else set()
            rows.append({**dict(zip(KEYS, key, strict=True)), **solved._asdict()})
    progress(rounds * len(works), rounds * len(works), "done")
    found = pd.DataFrame(rows).groupby(KEYS, sort=False)
    table = found.median().assign(runs=found.size()).reset_index()
    return judged(table.assign(units=table["seconds"] / np.median(units)))


def judged(table: pd.DataFrame) -> pd.DataFrame:
    """With the relative error of each value, and of the problem what it is compared by."""
    known = pd.DataFrame(map(vars, problems().values())).set_index("name")
    found = table.join(known[["reference", "uncertainty", "within", "bar", "linear"]], on="problem")
    return found.assign(error=found["value"] / found["reference"] - 1)


def lines_of(table: pd.DataFrame) -> Iterator[str]:
    """The table for a terminal."""
    rows = [("problem", "program", "family", "mesh", "unknowns", "value", "error/%", "seconds", "units", "runs")]
    for row in table.to_dict("records"):
        numbers = (f"{row['value']:.6g}", f"{100 * row['error']:+.2f}", f"{row['seconds']:.3f}", f"{row['units']:.2f}")
        rows.append((*(row[key] for key in KEYS), f"{row['unknowns']:.0f}", *numbers, str(row["runs"])))
    yield from columns(rows, right=range(4, 10))


FULL = {"load_fraction": "1"}

CASES = (
    Case("scordelis-lo", ("4x4", "8x8", "16x16"), "32x32", measure="linear"),
    Case("pinched-cylinder", ("8x8", "16x16", "24x24"), "32x32", measure="linear"),
    Case("hemisphere", ("8x8", "12x12", "20x20"), "32x32", FULL),
    Case("cantilever", ("16x1", "32x1", "64x1"), "64x1", FULL),
    Case("pressurised-cylinder", ("1x2", "2x4"), "2x4"),
    Case("strip-contact", ("8x2", "16x2"), "64x1", {"load_fraction": "5"}, "linear"),
    Case("crushed-ring-solid", ("1x12", "1x24"), "1x48", {"delta_mm": "5.5625,11.125"}),
    Case(
        "tyre, isotropic",
        ("16x18", "24x26", "32x30"),
        "60x58",
        {**ISOTROPIC, "delta_mm": f"{DELTA_MM:g}"},
        scene="tyre",
    ),
    # whole bricks: those with a rule of eight points soften further where cords leave their plane
    Case(
        "tyre, angle plies, inflated",
        ("10x12", "12x14", "14x18"),
        "84x80",
        {**FOLLOWER, "delta_mm": "0"},
        scene="tyre",
        integration="full",
        held=True,
    ),
)

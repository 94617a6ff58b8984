"""Other programs beside ours: which there are and what they solve, error against processor time, and their decks.

``footprint bench peers`` measures work and precision of shells and of other programs in one run: processor time of one
thread, from the request to the value, without imports; rounds in which every mesh of every program has its turn, so
that what the machine does meanwhile meets all. Seconds are stated in units of one factorisation by SuperLU of the whole
paper's tyre on 42x40 (9840 unknowns) in the same rounds, too. A program that is not installed is left out by name.
"""

import importlib.util
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd

from contact.problem import Outcome
from contact.solvers.sparse import factorise
from studies.bench.costs import at_rest, shell_of
from studies.bench.problems import DELTA_MM, LINEAR_SHELLS, MEASURED, Line, Solved, problems
from studies.bench.programs import Case
from studies.output.stopwatch import timed
from studies.scenes.complete import complete
from studies.solving.solve import solve

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

    walls: dict[str, Isotropic | AnglePlies] = {"tyre, isotropic": Isotropic(), "tyre, angle plies": AnglePlies()}
    tyre_lines = []
    for problem, wall in walls.items():
        for order, meshes in MEASURED["ngsolve"][problem].items():
            solve = partial(tyre, delta_mm=DELTA_MM, wall=wall, order=int(order))
            tyre_lines.append(Line(problem, "ngsolve", f"order {order}", tuple(meshes), solve))
    return tuple(tyre_lines)


def _kratos() -> tuple[Line, ...]:
    from studies.bench.kratos_shells import linear, shell

    return (
        *(
            Line(problem, "kratos", kind, tuple(meshes), partial(shell, problem, kind))
            for problem, meshes in MEASURED["kratos"].items()
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
    theirs = [line for peer in PEERS if not peer.missing for line in peer.lines()]
    beside = {line.problem for line in theirs}
    own = [line for line in lines() if line.problem in beside]
    return (*own, *theirs), tuple(peer.missing for peer in PEERS if peer.missing)


# --- ours -------------------------------------------------------------------------------------------------------------


def lines() -> tuple[Line, ...]:
    """Each family of each problem."""
    return (
        *(
            Line(each["problem"], "footprint", each["family"], tuple(each["meshes"]), partial(solved, **each["solve"]))
            for each in MEASURED["ours"]
        ),
        *(
            Line(
                each.name,
                "footprint",
                "default",
                each.meshes,
                partial(solved, **each.asked, model="auto", measure="linear"),
            )
            for each in LINEAR_SHELLS
        ),
    )


def solved(
    mesh: str, *, scene: str, quantity: str, model: str, settings: Mapping[str, str], measure: str = "exact"
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
    groups = pd.DataFrame(rows).groupby(KEYS, sort=False)
    table = groups.median().assign(runs=groups.size()).reset_index()
    return judged(table.assign(units=table["seconds"] / np.median(units)))


def judged(table: pd.DataFrame) -> pd.DataFrame:
    """With the relative error of each value, and of the problem what it is compared by."""
    known = pd.DataFrame(map(vars, problems().values())).set_index("name")
    joined = table.join(known[["reference", "uncertainty", "within", "bar", "linear"]], on="problem")
    return joined.assign(error=joined["value"] / joined["reference"] - 1)


def shown(table: pd.DataFrame) -> str:
    """The table for a terminal."""
    formatted = table.assign(**{"error/%": 100 * table["error"]})
    names = [*KEYS, "unknowns", "value", "error/%", "seconds", "units", "runs"]
    return formatted[names].to_string(index=False, float_format="{:.4g}".format)


CASES = tuple(Case(**{**each, "meshes": tuple(each["meshes"])}) for each in MEASURED["deck"])

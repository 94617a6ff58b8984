"""``footprint bench peers``: the isotropic tyre by shells and by NGSolve's solids in one run, force against cost.

A quarter against a quarter, from the request to the force, in processor time of one thread: so the load of the machine
touches neither. Imports are not counted. Needs the extra peers.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from time import process_time

import pandas as pd

from contact.problem import Outcome
from studies.bench.newton import timed
from studies.campaigns.ladder_cells import ISOTROPIC
from studies.columns import columns
from studies.complete import complete
from studies.scene import UsageError
from studies.scenes.data import read_reference
from studies.scenes.tyre.grid_lines import checked_mesh
from studies.solving import solve

DELTA_MM = 10.0
SHELL = {**ISOTROPIC, "element": "paper"}
SHELL_MESHES = ("28x26", "32x30", "36x34", "48x46")  # of the whole tyre, as everywhere; a quarter of it is solved
PEER_MESHES = ("8x8", "14x12")  # of the quarter: about the coarsest within 0.3 %, and one settled to 0.1 %
WITHIN = 0.003  # relative error of the force asked for, and the uncertainty of the reference
ROUNDS = 3  # of the shells at the least, around each solid


def checked(meshes: Sequence[str]) -> list[tuple[int, int]]:
    """Meshes of the peer; raises UsageError for one that it cannot have, and without the extra."""
    if importlib.util.find_spec("ngsolve") is None:
        raise UsageError("peers need the extra peers: pip install 'footprint[peers]'")
    sizes = [complete("tyre", {}, mesh)[1].mesh for mesh in meshes]
    for n1, n2 in sizes:
        checked_mesh((2 * n1, 2 * n2))  # both halves of its lines
    return sizes


def peers(
    meshes: Sequence[str] = PEER_MESHES, shells: Sequence[str] = SHELL_MESHES, delta_mm: float = DELTA_MM
) -> pd.DataFrame:
    """Table with columns program, elements, unknowns, force_N, seconds, error, ratio; one row per mesh.

    error: of the force against :func:`reference`, nan at other travels. seconds: of the processor, the median of the
    rounds of a shell. ratio: seconds over those of :func:`sufficient`. force_N is nan where a program fails.
    """
    sizes = checked(meshes)
    from studies.bench.peer_ngsolve import quarter

    runs = []
    for done in range(max(ROUNDS, len(sizes) + 1)):  # interleaved: what the machine does meanwhile meets both
        runs += [_run("footprint", mesh, partial(shell_quarter, mesh, delta_mm)) for mesh in shells]
        for size in sizes[done : done + 1]:
            runs.append(_run("ngsolve", f"{size[0]}x{size[1]}", partial(quarter, size, delta_mm)))
    table = pd.DataFrame(runs).groupby(["program", "elements"], sort=False, as_index=False).median()
    table["error"] = table["force_N"] / reference(delta_mm) - 1
    table["ratio"] = table["seconds"] / sufficient(table)
    return table.astype({"unknowns": int})


def _run(program: str, elements: str, work: Callable[[], tuple[float, int]]) -> dict[str, object]:
    """A row of one solve; work() -> force [N], unknowns."""
    found: list[tuple[float, int]] = []
    seconds = timed(lambda: found.append(work()), clock=process_time)
    force, unknowns = found[0]
    return {"program": program, "elements": elements, "unknowns": unknowns, "force_N": force, "seconds": seconds}


def reference(delta_mm: float) -> float:
    """Force [N] of NGSolve 18x16, the finest solid there is, within 0.3 %; nan at a travel without one."""
    table = read_reference("isotropic_tyre_3d_solid.csv")
    found = table.loc[table["delta_mm"] == delta_mm, "force_N_ngsolve"]
    return float(found.iloc[0]) if len(found) else math.nan


def sufficient(table: pd.DataFrame) -> float:
    """Seconds of the coarsest shell from which on every finer one is within 0.3 %, nan without one.

    A coarse mesh may be within by luck: its force jumps with the nodes that touch.
    """
    best = math.nan
    own = table[table["program"] == "footprint"].sort_values("unknowns", ascending=False)
    for error, seconds in zip(own["error"], own["seconds"], strict=True):
        if not abs(error) <= WITHIN:
            break
        best = float(seconds)
    return best


def shell_quarter(mesh: str, delta_mm: float) -> tuple[float, int]:
    """Force of the whole tyre [N], nan where it was not reached, and number of unknowns of the quarter."""
    result = solve(*complete("tyre", {**SHELL, "delta_mm": repr(delta_mm)}, mesh, model="quarter"))
    reached = result.outcome is Outcome.CONVERGED
    return float(result.steps[-1]["force_N"]) if reached else math.nan, int(result.counters["dofs"])


def lines(table: pd.DataFrame) -> Iterator[str]:
    """The table for a terminal."""
    rows = [("program", "elements", "unknowns", "force/N", "error/%", "seconds", "ratio")]
    for row in table.assign(error=100 * table["error"]).to_dict("records"):
        numbers = (f"{row[name]:.2f}" for name in ("force_N", "error", "seconds"))
        rows.append((row["program"], row["elements"], str(row["unknowns"]), *numbers, f"{row['ratio']:.1f}"))
    yield from columns(rows, right=range(1, 7))

"""Work and precision of the tyre's grids: the force on uniform, patch, adapted and locally refined ones, and its cost.

Errors are against the mean of the limits that local refinement states with each element: two discretisations of one
problem. The mean is known to half of what the limits are apart, or to what they state of themselves, whichever is
larger. Uniform, patch and adapted grids have no part in it; the last limit of an element is half of that distance off
by definition, which says nothing of its error.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from studies.ask.request import Request
from studies.ask.scene import Scene
from studies.scenes.complete import complete
from studies.scenes.element import PRESETS
from studies.scenes.tyre.scene import Tyre
from studies.solving.refinement.error_control import solve_to_error
from studies.solving.refinement.grids import coarsest
from studies.solving.solve import solve

FAMILIES = dict.fromkeys(("uniform", "patch"), tuple((n, n) for n in range(20, 84, 4)))
ELEMENTS = (400, 500, 600, 700, 800, 900, 1000, 1200, 1400, 1700, 2000, 2500)  # of the adapted one
LEAST = 0.002  # relative uncertainty to which the tyre is refined locally
TO_20: Mapping[str, str] = {"delta_mm": "20"}
COLUMNS = ("family", "mesh", "unknowns", "force_N", "error", "own_s", "total_s")


@dataclass(frozen=True, eq=False)
class LocalGrids:
    """A local refinement: its last limit [N] with the relative uncertainty stated, and COLUMNS but the error."""

    limit: float
    uncertainty: float
    rows: pd.DataFrame


def work_precision_study(
    settings: Mapping[str, str] = TO_20,
    families: Mapping[str, Sequence[tuple[int, int]]] = FAMILIES,
    elements: Sequence[int] = ELEMENTS,
    least: float = LEAST,
    root: tuple[int, int] | None = None,
) -> pd.DataFrame:
    """The tyre with each element: COLUMNS, element, and of the reference what is the same in all rows.

    reference_N [N]; apart: how far the limits of the elements are apart; known: to what the reference is known, both
    relative.  settings: by default the paper's tyre at 20 mm.  least: relative uncertainty that ends the local
    refinement, root: its coarsest mesh.
    """
    own = {element: {**settings, "element": element} for element in PRESETS}
    local = {element: local_grids(each, least, root) for element, each in own.items()}
    limits = [each.limit for each in local.values()]
    reference = float(np.mean(limits))
    apart = float(np.ptp(limits)) / reference
    known = max(apart / 2, *(each.uncertainty for each in local.values()))
    tables = []
    for element, each in own.items():
        tensor = work_precision(each, families, elements, reference=reference)
        grids = pd.concat([tensor, _with_error(local[element].rows, reference)], ignore_index=True)
        tables.append(grids.assign(element=element, reference_N=reference, apart=apart, known=known))
    return pd.concat(tables, ignore_index=True)


def work_precision(
    settings: Mapping[str, str],
    families: Mapping[str, Sequence[tuple[int, int]]] = FAMILIES,
    elements: Sequence[int] = ELEMENTS,
    *,
    reference: float,
) -> pd.DataFrame:
    """One row a tensor grid with COLUMNS: force at the last travel [N], signed relative error, CPU seconds.

    families: grids of each grading but "adapted", whose numbers of elements are ``elements``.  own_s: of the grid
    alone; total_s: with the estimate on coarse grids that an adapted one asks for, once.  reference [N]: what the
    errors are against. Raises RuntimeError where the tyre is not solved.
    """
    rows = []
    for family, meshes in families.items():
        scene, request = complete("tyre", {**settings, "grading": family})
        rows += [_solved(scene, request, mesh, 0.0) for mesh in meshes]
    scene, request = complete("tyre", {**settings, "grading": "adapted"})
    assert isinstance(scene, Tyre)
    start = time.process_time()
    scene = scene.adapted(request)
    estimate = time.process_time() - start
    rows += [_solved(scene, request, scene.mesh_of(request, count), estimate) for count in elements]
    return _with_error(pd.DataFrame(rows), reference)


def local_grids(settings: Mapping[str, str], least: float, root: tuple[int, int] | None = None) -> LocalGrids:
    """One refinement to a relative uncertainty ``least``, or as far as it goes, from the coarsest mesh ``root``.

    Raises RuntimeError where the tyre is not solved.
    """
    start = time.process_time()
    result, _ = solve_to_error(*coarsest("tyre", settings, root), least, "force_N")
    if not result.outcome.converged:
        raise RuntimeError(f"local refinement: {result.reason}")
    rounds = result.table("refinement").frame()
    before = time.process_time() - start - rounds["seconds"].sum()
    quantities = result.quantities
    return LocalGrids(quantities["extrapolated_force_N"], quantities["uncertainty"], rows_of_rounds(rounds, before))


def rows_of_rounds(rounds: pd.DataFrame, before: float) -> pd.DataFrame:
    """COLUMNS but the error, of the table ``refinement``: each grid T_k, and the limit L_k with the unknowns of T_k'.

    before: CPU seconds until the first round.  own_s: of the grid alone.  total_s: of T_k with all rounds before it,
    and nothing more where it is T' of the last of them; of L_k with its own round, too.
    """
    named = {"mesh": [f"round {k}" for k in range(1, len(rounds) + 1)]}
    own, until = rounds["own_seconds"], before + rounds["seconds"].cumsum()
    known = rounds["unknowns"] == rounds["finer_unknowns"].shift()
    local = {
        "unknowns": rounds["unknowns"],
        "force_N": rounds["value"],
        "own_s": own,
        "total_s": until - rounds["seconds"] + own.mask(known, 0.0),
    }
    limit = {
        "unknowns": rounds["finer_unknowns"],
        "force_N": rounds["limit"],
        "own_s": rounds["finer_seconds"],
        "total_s": until,
    }
    tables = [
        pd.DataFrame({"family": family, **named, **columns})
        for family, columns in (("local", local), ("extrapolated", limit))
    ]
    return pd.concat(tables, ignore_index=True)


def _with_error(rows: pd.DataFrame, reference: float) -> pd.DataFrame:
    return rows.assign(error=rows["force_N"] / reference - 1)[list(COLUMNS)]


def _solved(scene: Scene, request: Request, mesh: tuple[int, int], before: float) -> dict[str, Any]:
    """A row without its error; raises RuntimeError where the tyre is not solved."""
    result = solve(scene, replace(request, mesh=mesh))
    if not result.outcome.converged:
        raise RuntimeError(f"{mesh[0]}x{mesh[1]}: {result.reason}")
    return {
        "family": str(request.settings["grading"]),
        "mesh": f"{mesh[0]}x{mesh[1]}",
        "unknowns": result.counters["dofs"],
        "force_N": float(result.steps[-1]["force_N"]),
        "own_s": result.timing["cpu"],
        "total_s": result.timing["cpu"] + before,
    }

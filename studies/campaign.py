"""Campaigns: named lists of requests, solved into a store cell by cell.

A cell is identified by what decides its result. One that is already in the store is not solved again; a campaign
stopped at any moment goes on where it was.
"""

from __future__ import annotations

import hashlib
import json
import math
import multiprocessing
import os
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from functools import cache, partial
from pathlib import Path
from typing import Any

import pandas as pd

from contact.algorithms import ALGORITHMS
from formulations.element import MEMBRANES, THICKNESS_STRAINS
from formulations.element_geometry import INTERPOLATIONS
from formulations.measures import MEASURES
from studies import convergence_cells
from studies.cell import Cell
from studies.convergence_cells import ISOTROPIC
from studies.cycles import cycles
from studies.epsilon import epsilon_study
from studies.extremes import axes_table, check_table, extremes_table
from studies.false_success import table as false_success
from studies.locking import curved_beam, membrane_locking, shear_locking, thickness_locking
from studies.mirror import mirror_table
from studies.rigid_body import rigid_body_table, rotation_sweep, small_motions
from studies.scenes import SCENES
from studies.scenes.data import DATA
from studies.solve import resolve, solve
from studies.store import SCHEMA, plain, write_json, write_table_once, write_text
from studies.symmetry import symmetry_table
from studies.work_precision import work_precision_study

Task = tuple[str, Callable[[], object]]
SOURCES = ("formulations", "contact", "studies")


_PAPER = {"element": "paper"}


def enforcements(default: float) -> tuple[tuple[str, str], ...]:
    """The exact condition, which all algorithms must agree on, and what an algorithm does if not told otherwise."""
    return (("exact", "inf"),) if math.isinf(default) else (("exact", "inf"), ("epsilon", f"{default:g}"))


def _tyre(label: str, settings: dict[str, str] | None = None, **options: Any) -> Cell:
    """All of the tyre, so that its symmetry is a finding, unless ``model`` says otherwise."""
    return Cell(label, "tyre", {"model": "full", **options}, {**_PAPER, **(settings or {})})


_TO_20 = {"delta_mm": "20"}
_ANSWERS = {
    "exact": {"epsilon": "inf"},
    "epsilon": {"epsilon": "1e4"},
}

TYRE = (
    _tyre("paper", {"delta_mm": ",".join(str(d) for d in (5, 10, 15, *range(20, 28)))}),
    _tyre("linear", measure="linear"),
    *(
        _tyre(f"{measure} {contact} {newton} {kind}", {**_TO_20, **epsilon}, **options)
        for measure in ("exact", "linear")
        for contact in ("semismooth", "trial-and-error")
        for newton in (("mixed", "plain") if measure == "exact" else ("mixed",))
        for kind, epsilon in _ANSWERS.items()
        for options in [
            {"measure": measure, "contact": contact, "newton": newton, "steps": 4 if newton == "plain" else 1}
        ]
    ),
    _tyre("consistent", {**_TO_20, "coupling": "consistent"}),
    _tyre("fine", _TO_20, mesh="84x80"),
    _tyre("follower", {**_TO_20, "load": "follower", "pressure_area": "face"}),
    _tyre("follower fine", {**_TO_20, "load": "follower", "pressure_area": "face"}, mesh="84x80"),
    _tyre("isotropic", ISOTROPIC),
    _tyre("isotropic fine", ISOTROPIC, mesh="84x80"),
)
SOLID = (
    *(Cell(f"solid {mesh}", "tyre-solid", {"mesh": mesh}) for mesh in ("14x18", "28x36", "56x72")),  # each is nested
    Cell("solid penalty", "tyre-solid", {"mesh": "28x36"}, {"epsilon": "20"}),  # as in the reference by NGSolve
    _tyre("isotropic coarse", ISOTROPIC, mesh="28x26"),
)
BENCHMARKS = (
    *(Cell(f"cantilever {n}", "cantilever", {"mesh": f"{n}x{n // 16}"}, _PAPER) for n in (16, 32, 64)),
    *(Cell(f"hemisphere {n}", "hemisphere", {"mesh": f"{n}x{n}"}, _PAPER) for n in (16, 32, 64)),
    *(
        Cell(f"hemisphere one step {newton}", "hemisphere", {"newton": newton}, {"load_fraction": "1", **_PAPER})
        for newton in ("mixed", "plain")
    ),
    Cell(
        "hemisphere twenty steps plain",
        "hemisphere",
        {"newton": "plain", "steps": 20},
        {"load_fraction": "1", **_PAPER},
    ),
)
_GROWING = {
    "tyre": ("20x20", {"delta_mm": ",".join(str(d) for d in range(1, 21))}),
    "hemisphere": ("16x16", {"load_fraction": ",".join(f"{i / 20:g}" for i in range(1, 21))}),
    "cantilever": ("32x2", {"load_fraction": ",".join(f"{i / 20:g}" for i in range(1, 21))}),
    "sze-pullout": ("12x18", {"load_fraction": ",".join(f"{i / 20:g}" for i in range(1, 21))}),
    "roof-a": ("8x8", {"load_fraction": ",".join(f"{i / 20:g}" for i in range(1, 15))}),
    "shallow-cap": ("32x4", {"load_fraction": ",".join(f"{i / 40:g}" for i in range(2, 23))}),
}
MEASURED = (
    *(
        Cell(f"{scene} by {measure}", scene, {"measure": measure, "mesh": mesh}, settings)
        for scene, (mesh, settings) in _GROWING.items()
        for measure in MEASURES
    ),
    *(
        Cell(f"hemisphere {n} {' '.join(options.values())}", "hemisphere", {"mesh": f"{n}x{n}"}, settings)
        for interpolation in INTERPOLATIONS
        for thickness in THICKNESS_STRAINS
        for membrane in MEMBRANES
        for options in [{"interpolation": interpolation, "thickness_strain": thickness, "membrane": membrane}]
        for settings in [{"load_fraction": "1", **options}]
        for n in (8, 16, 32)
    ),
)
CONVERGENCE = (
    *convergence_cells.cells({"element": "refined"}, "refined"),
    *convergence_cells.cells({"element": "paper"}, "paper", finest=False),
)
_WAYS: dict[str, tuple[str, dict[str, str]]] = {  # each algorithm as it is, and settings that change how it gets there
    **{contact: (contact, {}) for contact in ALGORITHMS},
    "semismooth, settle 1": ("semismooth", {"settle": "1"}),
    "qp, eps 1e-3": ("qp", {"eps": "1e-3"}),
    "qp, clarabel": ("qp", {"backend": "clarabel"}),
    "lcp, active-set": ("lcp", {"method": "active-set"}),
    "lcp, nnls": ("lcp", {"method": "nnls"}),
}
AGREEMENT = tuple(
    _tyre(
        f"agreement {way} {load} {section} {kind}",
        {"load": load, "section": section, "delta_mm": "5,10,15,20", "epsilon": epsilon, **settings},
        contact=contact,
        model="half",
    )
    for way, (contact, settings) in _WAYS.items()
    for kind, epsilon in enforcements(math.inf if settings else ALGORITHMS[contact]().epsilon)
    for load in ("dead", "follower")
    for section in ("constant-s33", "nonsymmetric")
)
_EXACT = {"epsilon": "inf"}
ROBUSTNESS = (
    *(
        _tyre(
            f"one step {way} {mesh}",
            {**_TO_20, **_EXACT, **_WAYS[way][1]},
            mesh=mesh,
            contact="semismooth",
            model="half",
        )
        for way in ("semismooth", "semismooth, settle 1")
        for mesh in ("28x26", "42x40", "84x80")
    ),
    _tyre("far", {"delta_mm": "20,25,30,35,40", **_EXACT}, contact="semismooth", model="half"),
)
MODELS = (  # what a part of the tyre saves, and that it changes nothing
    *(_tyre(f"model {model} angle plies", _TO_20, model=model) for model in ("full", "half")),
    *(
        _tyre(f"model {model} isotropic", {**ISOTROPIC, **_TO_20}, model=model)
        for model in ("full", "half", "mirror", "quarter")
    ),
)
CAMPAIGNS: dict[str, Sequence[Cell]] = {
    "tyre": TYRE,
    "benchmarks": BENCHMARKS,
    "measures": MEASURED,
    "solid": (*(cell for cell in TYRE if cell.label.startswith("isotropic")), *SOLID),
    "convergence": CONVERGENCE,
    "agreement": (*AGREEMENT, *ROBUSTNESS),
    "models": MODELS,
    "report": (*TYRE, *SOLID, *BENCHMARKS, *MEASURED, *CONVERGENCE, *AGREEMENT, *ROBUSTNESS, *MODELS),
}
TABLES: dict[str, Callable[[], pd.DataFrame]] = {
    "rigid_body": rigid_body_table,
    "small_motions": small_motions,
    "rotation_sweep": rotation_sweep,
    "thickness_locking": thickness_locking,
    "shear_locking": shear_locking,
    "curved_beam": curved_beam,
    "membrane_locking": membrane_locking,
    "epsilon": epsilon_study,
    "cycles": cycles,
    "false_success": false_success,
    "symmetry": symmetry_table,
    "mirror": mirror_table,
    "extremes": extremes_table,
    "extremes_maps": axes_table,
    "extremes_check": check_table,
    "ladders": convergence_cells.ladder_table,
    "work_precision": work_precision_study,
}
TABLES_OF: dict[str, Sequence[str]] = {
    "measures": ("rigid_body", "small_motions", "rotation_sweep"),
    "convergence": ("ladders",),
    "models": ("work_precision",),
    "agreement": ("epsilon", "cycles", "false_success"),
    "report": tuple(TABLES),
}


def identity(cell: Cell) -> str:
    """Hash of all that decides the result: resolved request, schema and sources; no date, no machine."""
    _, request = resolve(cell.scene, cell.settings, **cell.options)
    content = json.dumps(plain([SCHEMA, _source_hash(), asdict(request)]), sort_keys=True)
    return hashlib.sha256(content.encode()).hexdigest()[:16]


@cache
def _source_hash() -> str:
    root = Path(__file__).parent.parent
    digest = hashlib.sha256()
    for package in SOURCES:
        for path in sorted((root / package).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def run(
    name: str,
    store: Path,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
    jobs: int = 1,
) -> int:
    """Solve what is missing, then write the index and the references of the scenes; returns the cells solved now.

    ``jobs``: processes that solve side by side, a cell or a table each.
    """
    cells = CAMPAIGNS[name]
    ids = [identity(cell) for cell in cells]
    directories = {cell_id: store / "cells" / cell_id for cell_id in ids}
    missing = {
        cell_id: cell
        for cell_id, cell in zip(ids, cells, strict=True)
        if not (directories[cell_id] / "result.json").exists()
    }
    tasks: list[Task] = [(f"table {table}", partial(_make_table, table, store)) for table in TABLES_OF.get(name, ())]
    tasks += [(cell.label, partial(_solve_cell, cell, directories[cell_id])) for cell_id, cell in missing.items()]
    for done, label in enumerate(_finished(tasks, jobs), start=len(cells) - len(missing)):
        progress(min(done, len(cells)), len(cells), label)
    rows = [
        {"label": cell.label, "id": cell_id, "scene": cell.scene, "command": cell.command}
        for cell, cell_id in zip(cells, ids, strict=True)
    ]
    references = [
        {"scene": scene, **asdict(reference)}
        for scene in sorted({cell.scene for cell in cells})
        for reference in SCENES[scene].references
    ]
    for table in sorted(DATA.glob("*.csv")):
        write_text(store / "references" / table.name, table.read_text(encoding="utf-8"))
    write_json(store / "references.json", {"references": references})
    write_json(store / "campaign.json", {"schema": SCHEMA, "campaign": name, "cells": rows})
    progress(len(cells), len(cells), "done")
    return len(missing)


def _solve_cell(cell: Cell, directory: Path) -> None:
    scene, request = resolve(cell.scene, cell.settings, **cell.options)
    solve(scene, request).write(directory)


def _make_table(name: str, store: Path) -> None:
    write_table_once(store / "tables" / f"{name}.csv", f"{SCHEMA} {_source_hash()}", TABLES[name])


def _finished(tasks: Sequence[Task], jobs: int) -> Iterator[str]:
    """Do the tasks; the name of each as it is done. The first failure, or an interruption, drops those not begun."""
    if jobs == 1:
        for label, task in tasks:
            task()
            yield label
        return
    # spawned, not forked: the caller may have threads
    spawned = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=spawned, initializer=_end_with_parent) as pool:
        labels = {pool.submit(task): label for label, task in tasks}
        try:
            for future in as_completed(labels):
                future.result()
                yield labels[future]
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _end_with_parent() -> None:
    """Let this worker end when the campaign is killed; by itself it would wait for more tasks for ever."""
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()

"""Other programs on decks of ours, run as they are, and the table of ``footprint bench programs`` beside ours.

Each mesh of each scene is one file in the store, so that a run that was stopped goes on; it is made anew when the
sources, the case or the program change. Which scenes there are is in :mod:`studies.bench.peers`: a list that grows must
not make anew what was run. A deck puts one direction of plies on every brick, that at its centre: how much of a
difference is due to this rule, our own solid under the same rule shows. How a deck is written and a field is judged
belongs to :mod:`studies.exchange`; no value that a program has found may be kept in a source.
"""

import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from formulations.solid import SolidDiscretisation, SolidModel
from studies.ask.request import UsageError, text_of
from studies.ask.settings import configured
from studies.exchange.deck import deck, element
from studies.exchange.judging import NOTHING, OURS, WORK, Comparison, compared, our_solution
from studies.exchange.of_scene import problem_of
from studies.exchange.problem import Problem
from studies.exchange.results import GROWTH, Found, read_results
from studies.output.atomic import write_table_once
from studies.output.stopwatch import WALL, timed
from studies.run.source_hash import sources_hash
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.scenes.tyre.model import checked_wall
from studies.scenes.tyre.solid import SolidTyreModel
from studies.scenes.walk import walk

PROGRAM, COMMAND = "CalculiX", "ccx"
ABSENT = "bench programs needs CalculiX: the command ccx, of Debian's package calculix-ccx"
FINISHED = "Job finished"
SOLID = "tyre-solid"
CENTRE = 13  # of the 27 Gauss points
FOLDER, TABLE = "programs", "programs"
WITHIN = 0.01  # relative difference to ours
HELD_WITHIN = 0.02  # the same, to our solid under the rule of one direction a brick
OF_CASE = ["case", "program", "quantity", "step"]
MESH, PLIES, OPEN = "mesh", "plies", "open"  # reasons of a difference beyond WITHIN


@dataclass(frozen=True)
class Case:
    """One scene; ``name`` is that of the problem of ``bench peers`` where that has the same.

    meshes: bricks along a1 and a2, from coarse to fine.  ours: mesh of our solution.  held: whether the rule of one
    direction of plies a brick is checked by our own solid.
    """

    name: str
    meshes: tuple[str, ...]
    ours: str
    settings: Mapping[str, str] = field(default_factory=dict)
    measure: str = "exact"
    scene: str = ""
    integration: str = ""
    held: bool = False

    @property
    def of(self) -> str:
        """Name of its scene in the catalogue."""
        return self.scene or self.name


def _command() -> str:
    command = shutil.which(COMMAND)
    if command is None:
        raise UsageError(ABSENT)
    return command


def version() -> str:
    """Of the program that is installed, "ccx 2.20"; raises UsageError where there is none."""
    output = subprocess.run([_command(), "-v"], capture_output=True, text=True, check=False, timeout=60).stdout
    match = re.search(r"Version (\S+)", output)
    return f"{COMMAND} {match[1] if match else 'unknown'}"


def found_by(lines: Iterable[str], problem: Problem) -> list[Found]:
    """What it finds for a deck, step by step; raises UsageError where it does not come to the end."""
    command = _command()
    with tempfile.TemporaryDirectory(prefix="footprint-") as place:
        folder = Path(place)
        (folder / "scene.inp").write_text("\n".join(lines) + "\n", encoding="ascii")
        run = subprocess.run([command, "scene"], cwd=folder, capture_output=True, text=True, check=False)
        if FINISHED not in run.stdout:
            message = next((line.strip() for line in run.stdout.splitlines() if "*ERROR" in line), "no reason told")
            raise UsageError(f"{PROGRAM} does not come to the end of {problem.request.scene}: {message}")
        return read_results(folder / "scene.dat", problem)


def measured(
    cases: Sequence[Case],
    store: Path,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
) -> pd.DataFrame:
    """A row a quantity, load and mesh; raises UsageError where the program is not there or does not end.

    theirs, ours; difference: theirs over ours, less one.  reference, source, uncertainty: what is published, the first
    that holds.  held: our solid under the rule of one direction of plies a brick.  nodes, elements: of the deck.
    seconds: wall time of the program.  step: number of the load from 0.  within, reason, rate: see :func:`explained`.
    """
    release = version()
    sources = sources_hash((__name__,))
    works = [(case, mesh) for case in cases for mesh in case.meshes]
    paths = []
    for done, (case, mesh) in enumerate(works):
        progress(done, len(works), f"{case.name} {mesh}")
        path = store / FOLDER / f"{re.sub(r'[^a-z0-9]+', '-', case.name)}-{mesh}.csv"
        identity = "\n".join((sources, release, repr(case), mesh))
        write_table_once(path, identity, partial(_table, case, mesh, release))
        paths.append(path)
    progress(len(works), len(works), "done")
    return explained(pd.concat(map(pd.read_csv, paths), ignore_index=True))


def _table(case: Case, mesh: str, release: str) -> pd.DataFrame:
    problem = problem_of(case.of, case.settings, mesh, measure=case.measure)
    seconds, results = timed(lambda: found_by(deck(problem, case.integration), problem), WALL)
    loads = [each.load for each in results]
    ours = our_solution(problem, loads, case.settings, case.ours, measure=case.measure)
    if not ours.outcome.converged:
        raise UsageError(f"our solution of {case.name} on {case.ours} did not converge: {ours.reason}")
    rows = compared(problem, results, ours, WITHIN)
    common = {
        "case": case.name,
        "scene": case.of,
        "settings": "; ".join(f"{key}={text_of(value)}" for key, value in case.settings.items()),
        "measure": case.measure,
        "mesh": mesh,
        "program": PROGRAM,
        "version": release,
        "elements": element(problem, case.integration),
        "bricks": len(problem.bricks.elements),
        "nodes": len(problem.bricks.x),
        "our_mesh": case.ours,
        "seconds": seconds,
        "held": inflated_equator(problem) if case.held else np.nan,
    }
    return pd.DataFrame([{**common, **values} for values in _values(rows, loads)])


def _values(rows: Sequence[Comparison], loads: Sequence[float]) -> Iterator[dict[str, Any]]:
    """Of each comparison with ours, with the first reference of the same quantity and load."""
    published = {(row.load, row.quantity): row for row in reversed(rows) if row.against not in (OURS, WORK, NOTHING)}
    for row in (row for row in rows if row.against == OURS):
        known = published.get((row.load, row.quantity))
        yield {
            "quantity": row.quantity,
            "step": loads.index(row.load),
            "load": row.load,
            "theirs": row.found,
            "ours": row.value,
            "difference": row.found / row.value - 1,
            "reference": np.nan if known is None else known.value,
            "source": "" if known is None else known.against,
        }


def inflated_equator(problem: Problem, *, held: bool = True) -> float:
    """Radial growth [mm] of the outer face at the equator of the inflated solid on the bricks of a tyre.

    nan where the solid is not inflated.  held: whether axes are those at the centre; else those at each Gauss point.
    """
    n1, n2 = problem.request.mesh
    known = {setting.key for setting in SCENES[SOLID].settings}
    own = {key: value for key, value in problem.request.settings.items() if key in known and key != "solver"}
    scene, request = complete(SOLID, own, f"{n1}x{n2}", model=problem.request.model)
    model = scene.build(request)
    assert isinstance(model, SolidTyreModel)
    solid = model.body.discretisation
    if held:
        frame = np.repeat(solid.mesh.frame[:, CENTRE : CENTRE + 1], solid.mesh.frame.shape[1], axis=1)
        laminate = checked_wall(request.settings)[0]
        solid = SolidDiscretisation.build(replace(solid.mesh, frame=frame), laminate, solid.fixed)
        model = replace(model, body=SolidModel(solid, model.body.pressure))
    stages = (stage for stage in model.stages() if stage.name != "press")
    *_, last = walk(stages, configured(request.contact, request.settings), request.steps)
    rest, inflated = (model.wall.faces(u)[1][model.wall.crown, 0] for u in (np.zeros_like(last.state.u), last.state.u))
    return float(inflated - rest) if last.converged else np.nan


def explained(table: pd.DataFrame) -> pd.DataFrame:
    """With ``within`` WITHIN, the ``rate`` at which differences fall from the coarser mesh, and a ``reason``.

    rate: of |difference| in the size of bricks, nan on the coarsest mesh.  held_difference: theirs over ``held``, less
    one.  reason: of what is beyond, PLIES where our solid under the rule of one direction a brick agrees within
    HELD_WITHIN; MESH where the difference is smaller than on the coarser mesh, or has none that is coarser and one that
    is finer and smaller; else OPEN.
    """
    table = table.assign(
        within=table["difference"].abs() <= WITHIN,
        held_difference=np.where(table["quantity"] == GROWTH, table["theirs"] / table["held"] - 1, np.nan),
    )
    finer = table.sort_values("bricks", kind="stable")
    keys, size = [finer[name] for name in OF_CASE], finer["difference"].abs()
    bricks = finer["mesh"].str.split("x", expand=True).astype(int)
    before, after = (size.groupby(keys, sort=False).shift(by) for by in (1, -1))
    table["rate"] = np.log(before / size) / np.log((bricks / bricks.groupby(keys, sort=False).shift()).max(axis=1))
    falls = (size < before).where(before.notna(), after < size).reindex(table.index)
    reasons = np.select(
        [table["within"], table["held_difference"].abs() <= HELD_WITHIN, falls], ["", PLIES, MESH], OPEN
    )
    return table.assign(reason=reasons)


def shown(table: pd.DataFrame) -> str:
    """The table for a terminal."""
    formatted = table.assign(reason=table["reason"].replace("", "within"), **{"off/%": 100 * table["difference"]})
    names = [
        "case",
        "mesh",
        "elements",
        "quantity",
        "load",
        "theirs",
        "ours",
        "off/%",
        "reference",
        "seconds",
        "reason",
    ]
    return formatted[[*names, "reason"]].to_string(index=False, float_format="{:.5g}".format, na_rep="")

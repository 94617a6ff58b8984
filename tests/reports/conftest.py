"""A store made up here: nothing is solved, and every law, order and reference is known."""

from __future__ import annotations

import math
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from reports.site import rendered
from reports.store import Store, load_store
from studies.analysis.everything import compared, written
from studies.ask.declarations import Ladder
from studies.catalogue.bodies import built
from studies.catalogue.tables import catalogue_tables
from studies.experiments import epsilon as epsilon_study
from studies.experiments import extremes, locking, rigid_body
from studies.experiments.extreme_limits import limits_table
from studies.experiments.false_success import COLUMNS as CLAIM_COLUMNS
from studies.experiments.rotations import RUNS
from studies.output.atomic import SCHEMA, write_json, write_table, write_text
from studies.run.collect import collect
from studies.run.lists import LADDERS, LISTS, SHEETS
from studies.run.plan import Row
from studies.scenes import SCENES
from studies.scenes.complete import Cell
from studies.scenes.complete import complete as resolve
from studies.scenes.data import DATA
from support.stores.answers import BUILT, DRAWN, cube_text, sheet_answer, write_answers
from support.stores.arena import made_up_arena
from support.stores.campaigns import linked, said_again
from support.stores.convergence import (
    made_up_distortion,
    made_up_manufactured,
    made_up_shells,
    made_up_statements,
    made_up_touching,
)
from support.stores.experiments import made_up_faces, made_up_laws, made_up_programs, made_up_ring, made_up_walls
from support.stores.friction import made_up_friction

PSI, PHI = np.arange(-60.0, 61.0, 5.0), np.arange(-22.5, 22.6, 2.5)
KKT = {"equilibrium": 1e-12, "penetration": 0.0, "tension": 0.0, "complementarity": 0.0}
JUDGED = {"kkt": KKT, "failures": []}
LOCKING = 1e-4  # of the made-up hyperboloid: U/U_h - 1 = l^2/5 + LOCKING (l^3/h)^2
PAIRED = ("exact", "donnell"), ("semismooth", "lcp")


@cache
def contact_text(*deltas: float) -> str:
    return pd.concat([contact_table(delta) for delta in deltas]).to_csv(index=False)


@cache
def profile_text(*deltas: float) -> str:
    return profile_table(deltas).to_csv(index=False)


def contact_table(delta: float) -> pd.DataFrame:
    """An elliptic patch that grows with delta, symmetric under the half turn only."""
    psi, phi = (a.ravel() for a in np.meshgrid(PSI, PHI, indexing="ij"))
    active = (psi / (2 * delta)) ** 2 + (phi / delta) ** 2 < 1
    pressure = np.where(active, 0.15 + 1e-5 * psi * phi, 0.0)
    nodes = {"delta_mm": delta, "psi_deg": psi, "phi_deg": phi, "pressure_MPa": pressure}
    return pd.DataFrame(nodes | {"gap_mm": np.where(active, 0.0, 1.0), "active": active.astype(int)})


def profile_table(deltas: Sequence[float]) -> pd.DataFrame:
    psi = np.linspace(-120.0, 120.0, 25)
    states = [("unloaded", 0.0, 0.0), ("inflated", 0.0, 1.0), *(("pressed", delta, 1.0) for delta in deltas)]
    parts = []
    for state, delta, growth in states:
        columns: dict[str, Any] = {"state": state, "delta_mm": delta, "psi_deg": psi}
        for face, radius in (("inner", 50.0), ("outer", 54.8)):
            columns[f"{face}_radial_mm"] = 200.0 + (radius + growth) * np.cos(np.deg2rad(psi))
            columns[f"{face}_axial_mm"] = (radius + growth) * np.sin(np.deg2rad(psi))
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts)


def tyre_step(delta: float, measure: str) -> dict[str, Any]:
    patch = {"contact_nodes": 30, "half_length_mm": 4 * delta, "half_width_mm": 2 * delta}
    symmetry = {"central_asymmetry": 1e-14, "mirror_asymmetry": 0.1}
    loads = {"force_N": delta * delta * (5.0 if measure == "exact" else 7.0), "centre_pressure_MPa": 0.15}
    return {
        "delta_mm": delta,
        **loads,
        **patch,
        "kkt": KKT,
        "failures": [],
        "rounding": 1e-13,
        **symmetry,
        "newton_iterations": 5,
        "substeps": 1,
    }


def static_step(scene: str, n: int, fraction: float) -> dict[str, Any]:
    """The references of the scene, approached with second order; between their loads, shares of the last."""
    kind = "exact" if scene == "cantilever" else "read"
    error = 1.0 - 0.1 * (16 / n) ** 2
    known = {(r.quantity, r.at.get("load_fraction")): r.value for r in SCENES[scene].references if r.kind == kind}
    names = dict.fromkeys(name for name, _ in known)
    values = {name: error * known.get((name, fraction), fraction * known[name, 1.0]) for name in names}
    return {"load_fraction": fraction, **values, **JUDGED, "rounding": 1e-8} | {"newton_iterations": 4, "substeps": 1}


def climbed(ladder: Ladder, n: int) -> dict[str, float]:
    """Second order towards the first reference of each quantity that has one for this ladder, else towards 1."""
    wanted = {"measure": ladder.measure, "load_fraction": "1", **ladder.settings}
    if ladder.at:
        wanted |= dict([ladder.at.split("=")])

    def holds(at: Mapping[str, float | str]) -> bool:
        known = {key: value for key, value in at.items() if key in wanted}
        return all(str(value) == wanted[key] or value == _number(wanted[key]) for key, value in known.items())

    values = {}
    for quantity in ladder.quantities:
        actual = [r.value for r in SCENES[ladder.scene].references if r.quantity == quantity and holds(r.at)]
        coarsest = int(ladder.meshes[0].split("x")[0])
        values[quantity] = (actual or [1.0])[0] * (1 - 0.1 * (coarsest / n) ** 2)
    return values


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def membrane_table() -> pd.DataFrame:
    """All shells of the second order, the free hyperboloid with the third-order locking on top."""
    rows = []
    for surface in ("cylinder", "hyperboloid"):
        for end in ("free", "clamped"):
            for membrane in ("compatible", "relaxed"):
                for h in locking.THINNESS:
                    for n in locking.MESHES:
                        excess = 0.2 / n**2
                        excess += LOCKING * (n**-3 / h) ** 2 if (surface, end) == ("hyperboloid", "free") else 0.0
                        ratio = 1 / (1 + excess)
                        known = surface == "cylinder" and h == locking.YARDSTICK_THINNESS
                        yardsticks = (0.5, 0.9) if known else (np.nan, np.nan)
                        rows.append((surface, end, membrane, h, n, ratio, np.sqrt(1 - ratio), *yardsticks))
    names = ["surface", "end", "membrane", "h_over_R", "elements", "energy_ratio", "energy_norm_error"]
    return pd.DataFrame(rows, columns=[*names, "yardstick_reduced", "yardstick_unreduced"])


def rotations_table() -> pd.DataFrame:
    """Two measures on every body and path, the second one lost on its way astray."""
    rows = []
    for measure, (body, path), leg in product(("exact", "linear"), RUNS, range(7)):
        lost = (measure, path) == ("linear", "astray") and leg > 4
        strain = 0.0 if measure == "exact" or leg in (0, 6) else 0.1 * leg
        change = np.nan if body == "free" else strain
        values = (np.nan,) * 4 if lost else (strain, strain, change, strain)
        rows.append((measure, "isoparametric", body, path, leg, "step-limit" if lost else "converged", *values))
    names = ["measure", "interpolation", "body", "path", "leg", "outcome"]
    return pd.DataFrame(rows, columns=[*names, "strain", "energy", "energy_change", "off"])


def epsilon_table() -> pd.DataFrame:
    """Penetration 0.1/epsilon, force error -2e-3/epsilon; the displacement form breaks down at 1e6."""
    rows = []
    for case in ("tyre", "strip"):
        for epsilon in (*epsilon_study.EPSILONS, np.inf):
            error = -2e-3 / epsilon
            rows.append((case, "multiplier", epsilon, "converged", 6, 0.1 / epsilon, 1e3 * (1 + error), error, 0, 1e5))
            if np.isfinite(epsilon):
                broken = epsilon >= 1e6
                outcome, error = ("rounding", 1.0) if broken else ("converged", error)
                own = (outcome, 6, 0.1 / epsilon, 1e3 * (1 + error), error, 0, 1e3 * epsilon)
                rows.append((case, "displacement", epsilon, *own))
    names = ["case", "form", "epsilon", "outcome", "iterations", "penetration_mm", "force_N", "force_error"]
    table = pd.DataFrame(rows, columns=[*names, "nodes_unlike", "condition"])
    return table.assign(mesh="20x20", command=[f"solve {row[0]} {row[2]:g}" for row in rows])


def cycles_table() -> pd.DataFrame:
    """One problem on which the textbook cycles, and one on which nobody does."""
    names = ["problem", "plain_period", "trial-and-error", "semismooth, settle 1", "semismooth"]
    message = "converged, cycle detected"
    return pd.DataFrame(
        [("3x3", 3, message, "iteration-limit", message), ("mild", 0, *["converged"] * 3)], columns=names
    )


def claims_table() -> pd.DataFrame:
    """Two of ours that are right, one alone that is not, though it mostly keeps what it was asked for."""
    rows = [
        ("lcp", "", 1e-10, 1e-8, 9, 9, 0, 0, 1e-15, "mild", ""),
        ("regularised", "", 1e-10, 1e-8, 9, 9, 0, 0, 2e-3, "mild", ""),
        ("osqp alone, defaults", "osqp 1.1", 1e-3, 1e-8, 9, 5, 1, 3, 0.5, "stiff", "equilibrium"),
    ]
    return pd.DataFrame(rows, columns=list(CLAIM_COLUMNS))


def membrane_over_sphere() -> pd.DataFrame:
    """The second order in u, the first in the energy and the radius."""
    rows = []
    for element, level, algorithm in product(("P1", "Q2"), (2, 3), ("semismooth", "lcp")):
        errors = {"l2": 4.0**-level, "h1": 2.0**-level, "force": 4.0**-level, "radius": 2.0**-level}
        orders = {"order_l2": 2.0, "order_h1": 1.0, "order_force": 2.0, "order_radius": 1.0}
        own = {"element": element, "level": level, "algorithm": algorithm, "unknowns": 4**level}
        rows.append({**own, "outcome": "converged", "iterations": 3.0, "apart": 1e-15, **errors, **orders})
    return pd.DataFrame(rows)


def plate_table() -> pd.DataFrame:
    """Two loads on two meshes by two algorithms."""
    cases = product(("Q1", "Q2"), (8, 16), ("uniform", "lifting"), ("semismooth", "lcp"))
    errors = {"uniform": 1e-14, "lifting": np.nan}
    rows = [(*case, "converged", 0.04, 0.001, 17.8, errors[case[2]], 1e-15) for case in cases]
    names = ["element", "elements", "load", "algorithm", "outcome", "slip_mm", "lift_mm", "edge_mm"]
    return pd.DataFrame(rows, columns=[*names, "pressure_error", "apart"])


PRECISION = {"uniform": 40.0, "patch": math.nan, "adapted": 10.0, "local": 4.0, "extrapolated": 0.4}


def precision_table() -> pd.DataFrame:
    """Errors are PRECISION/unknowns, half of it for the element refined; patch grids never come below 2 %.

    Adapted grids take 2 s before the first, local ones 1 s.
    """
    rows = []
    for element, part in (("paper", 1.0), ("refined", 0.5)):
        for family, law in PRECISION.items():
            before = {"adapted": 2.0, "local": 1.0, "extrapolated": 1.0}.get(family, 0.0)
            for n in (500, 1001, 2001, 4001, 8001, 16001, 32001):
                error = 0.02 if math.isnan(law) else part * law / n
                rows.append((element, family, f"{n}x1", n, 2000 * (1 + error), error, n / 1000, n / 1000 + before))
    names = ["element", "family", "mesh", "unknowns", "force_N", "error", "own_s", "total_s"]
    return pd.DataFrame(rows, columns=names).assign(reference_N=2000.0, apart=1e-4, known=1.5e-3)


def symmetry_table() -> pd.DataFrame:
    """Donnell is broken by design where it moves; nothing is broken by accident."""
    checks = {"axes exchanged": 1e-15, "3 load steps for one": 1e-11, "plate moved and turned": 0.2}
    rows = []
    for measure in PAIRED[0]:
        for algorithm in PAIRED[1]:
            for check, deviation in checks.items():
                design = check.startswith("plate") and measure == "donnell"
                off = 1e-14 if check.startswith("plate") and not design else deviation
                actual = "broken by design" if design else "solver tolerance" if off > 1e-13 else "rounding"
                row = {"check": check, "measure": measure, "algorithm": algorithm, "deviation": off}
                row |= {"rounding": 1e-13, "tolerance": 1e-9, "class": actual}
                row |= {"reason": "declares E11 = -0.001" if design else "", "contact_nodes": 9, "nodes_unlike": 0}
                rows.append({**row, "iterations": 5, "iterations_other": 6})
    return pd.DataFrame(rows)


def random_cases() -> pd.DataFrame:
    """Three that agree, one explained, one not compared and one broken."""
    said = ("agrees", "agrees", "agrees", "not both are stable: 1 and 0", "not compared, ended: because", "off by 1")
    verdicts = ("agrees", "agrees", "agrees", "explained", "not compared", "broken")
    words = ("converged",) * 5 + ("",)
    laws = ("units", "the made answer", "nodes renumbered", "part = whole", "more steps", "derivatives")
    kinds = ("scene", "matrices", "posed", "scene", "scene", "scene")
    record = {"seed": range(6), "kind": kinds, "about": "footprint solve", "word": words, "law": laws}
    commands = [f"footprint fuzz --seed {seed}" for seed in range(6)]
    return pd.DataFrame(record | {"verdict": verdicts, "said": said, "command": commands})


TRAVEL, PRESS = extremes.Axis.powers("delta_mm", "travel [mm]", -2, 2, 17), extremes.Axis.even("p", "p [MPa]", 0, 1, 17)
EXTREMES = (
    extremes.Chart("two", "Two settings", "panel", TRAVEL, PRESS),
    extremes.Chart("each", "Each algorithm", "panel", TRAVEL, extremes.Axis("contact", "algorithm", ("lcp", "qp"))),
)


def made_up_outcome(cell: Cell) -> extremes.Found:
    """Right of 1 mm it does not converge; qp refuses everything."""
    travel = float(cell.settings["delta_mm"])
    if cell.options.get("contact") == "qp":
        return extremes.Found(extremes.REFUSED, "qp does not apply: it is made up")
    if travel > 1:
        message = (
            f"the iteration limit was reached (the set was updated {travel:g} times); cut; no limit point: the rest"
        )
        return extremes.Found(extremes.FAILED, message)
    return extremes.Found(extremes.CONVERGED)


def made_up_point(cell: Cell, smallest: float) -> extremes.Found:
    """Thin rings are lost, augmented-lagrangian has no epsilon, and results are what they are."""
    if float(cell.settings.get("h_mm", 1)) < 0.1:
        return extremes.Found(extremes.FAILED, "rounding alone (1e-7) is too large; cut; no limit point: the rest")
    if cell.options["contact"] == "augmented-lagrangian" and "epsilon" in cell.settings:
        return extremes.Found(extremes.REFUSED, "augmented-lagrangian does not apply: it is made up")
    load = 2 * float(cell.settings.get("delta_mm", 0)) / 100 / (math.pi / 4 - 2 / math.pi)
    tip = {"tip_shortening_mm": 0.0, "tip_deflection_mm": 0.0}
    return extremes.Found(extremes.CONVERGED, "", {"P_R2_over_EI": 1.005 * load, "w_bar": 0.4, "force_N": 2.0, **tip})


def made_up_what_if() -> dict[str, pd.DataFrame]:
    """Two settings on two meshes and travels; a goal of p0/0.75 that only the force, 1e4 p0, keeps up."""
    both = product(("42x40", "84x80"), (5.0, 20.0), ("force_N", "inflated_equator_outer_mm"))
    rates = [
        {
            **{"mesh": mesh, "delta_mm": travel, "quantity": quantity, "value": 2000.0, "setting": setting},
            **{"printed": 50.0, "half_a_unit": 0.5, "relative": 1.0 + (mesh == "42x40"), "rounding": 0.01},
        }
        for mesh, travel, quantity in both
        for setting in ("p0_MPa", "R1_mm")
    ]
    names = {"force_N": "centre_pressure_MPa", "inflated_equator_outer_mm": "half_length_mm"}
    rates += [{**row, "quantity": names[str(row["quantity"])]} for row in rates]
    every = pd.DataFrame(product((40.0, 45.0, 50.0), (0.1, 0.2, 0.3)), columns=["gamma_deg", "p0_MPa"])
    read = {"mean_pressure_MPa": every["p0_MPa"] / 0.75, "inflated_equator_outer_mm": 44.0 - every["gamma_deg"]}
    every = every.assign(**read, force_N=1e4 * every["p0_MPa"], verdict="converged")
    posed = {"delta_mm": 20.0, "least_inflated_equator_outer_mm": -0.5, "least_force_N": 1900.0}
    asked = every.iloc[[8, 1]].assign(mesh="28x26", **posed, optimum=[False, True])
    return {"what_if": pd.DataFrame(rates), "even_footprint": asked, "every_footprint": every}


def write_tables(directory: Path) -> None:
    tables = {
        "rigid_body": rigid_body.rigid_body_table(),
        "small_motions": rigid_body.small_motions(),
        "rotation_sweep": rigid_body.rotation_sweep(points=5),
        "rotations": rotations_table(),
        "thickness_locking": locking.thickness_locking(meshes=(4, 8)),
        "shear_locking": locking.shear_locking(),
        "curved_beam": locking.curved_beam(),
        "membrane_locking": membrane_table(),
        "epsilon": epsilon_table(),
        "cycles": cycles_table(),
        "false_success": claims_table(),
        "membrane": membrane_over_sphere(),
        "greco_plate": plate_table(),
        "work_precision": precision_table(),
        "crushed_ring": made_up_ring(),
        "law_strain": made_up_laws(),
        "manufactured": made_up_manufactured(),
        "manufactured_contact": made_up_touching(),
        "manufactured_statements": made_up_statements(),
        "distortion": made_up_distortion(),
        "distorted_shells": made_up_shells(),
        "shell_limits": made_up_walls(),
        "programs": made_up_programs(),
        "fuzz": random_cases(),
        **made_up_arena(),
        **made_up_what_if(),
        **made_up_faces(),
        **made_up_friction(),
        "symmetry": symmetry_table(),
        "extremes": extremes.extremes_table(EXTREMES, made_up_outcome),
        "extremes_maps": extremes.axes_table(EXTREMES),
        "extremes_limits": limits_table(("exact", "linear"), ("lcp", "augmented-lagrangian"), made_up_point),
        "extremes_check": pd.DataFrame({"map": ["two"], "points": 289, "distance": [1.0], "unlike": [5]}),
    }
    for name, table in tables.items():
        write_table(directory / f"{name}.csv", table)


def write_cell(cell: Cell, directory: Path) -> Row:
    """A record, and tables where they are shown; returns the row of the index."""
    _, request = resolve(cell.scene, cell.settings, **cell.options)
    settings = dict(request.settings)
    quantities = {"inflated_equator_inner_mm": 1.0, "inflated_equator_outer_mm": 0.9}
    of = cell.label.partition(" ")[2] if cell.label.startswith(("convergence ", "share ")) else ""
    ladder = next((ladder for ladder in LADDERS if of.startswith(f"{ladder.name} ")), None)
    if ladder is not None:
        quantities = climbed(ladder, request.mesh[0])
        if ladder.scene == "tyre":
            step = tyre_step(float(ladder.at.partition("=")[2] or 20.0), "exact")
        else:
            step = static_step("cantilever", 16, float(ladder.settings.get("load_fraction", 1)))
            step |= {key: float(value) for key, value in ladder.settings.items() if key == "delta_mm"}
        steps = [{**step, **quantities}]
    elif cell.group == SHEETS:
        at, quantities = sheet_answer(cell)
        known = tyre_step(20.0, "exact") if cell.scene.startswith("tyre") else {**JUDGED, "rounding": 1e-8}
        steps = [{**known, "newton_iterations": 4, "substeps": 1, **at}]
        if cell.scene in DRAWN:
            write_text(directory / "fields.vtu", cube_text())
    elif cell.scene.startswith("tyre"):
        deltas = [float(delta) for delta in settings["delta_mm"]]
        steps = [tyre_step(delta, request.measure) for delta in deltas]
        write_text(directory / "contact.csv", contact_text(*deltas))
        write_text(directory / "profile.csv", profile_text(*deltas))
    elif cell.scene == "ring":
        counts = {"rounding": 1e-8, "newton_iterations": 4, "substeps": 1}
        steps = [{"delta_mm": delta, "P_R2_over_EI": 0.5 * delta, **JUDGED, **counts} for delta in settings["delta_mm"]]
    else:
        steps = [static_step(cell.scene, request.mesh[0], f) for f in settings["load_fraction"]]
    result = {
        **{name: getattr(request, name) for name in ("scene", "measure", "contact", "newton", "model")},
        "mesh": f"{request.mesh[0]}x{request.mesh[1]}",
        "settings": {**settings, "steps": request.steps},
        **{"outcome": "converged", "class": "converged", "reason": "converged", "steps": steps},
        "cuts": ["a step was cut"] if cell.expected else [],
        "quantities": quantities,
        "counters": {
            "dofs": 6 * request.mesh[0] * request.mesh[1],
            "newton_iterations": 9,
            "factorisations": 9,
            "assemblies": 9,
            "set_changes": 2,
        },
        "timing_s": {"total": 1.25, "build": 0.1, "assembly": 0.5, "factorisation": 0.5, "solve": 0.1, "contact": 0.05},
        "provenance": {"version": "0", "commit": "unknown", "packages": {"numpy": "2"}, "machine": {"cores": 2}},
        "files": [],
    }
    write_json(directory.with_suffix(".json"), {"schema": SCHEMA, "id": directory.name, **result})
    return Row(cell, directory.name, request)


@pytest.fixture(autouse=True)
def not_synced(monkeypatch: pytest.MonkeyPatch) -> None:
    """The files of a test need not outlive the machine."""
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)


@pytest.fixture(scope="session")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A whole report campaign, whose thousand files need not outlive the machine."""
    root = tmp_path_factory.mktemp("store")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda descriptor: None)
        _fill(root)
    return root


def _fill(root: Path) -> None:
    rows = [write_cell(cell, root / "cells" / str(i)).as_json() for i, cell in enumerate(LISTS["report"].cells())]
    references = [{"scene": name, **asdict(r)} for name, scene in SCENES.items() for r in scene.references]
    shutil.copytree(DATA, root / "references", ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    write_json(root / "references.json", {"schema": SCHEMA, "references": references})
    write_tables(root / "tables")
    record = {"schema": SCHEMA, "campaign": "report", "title": "made up", "pages": "all"}
    write_json(root / "campaigns" / "report.json", {**record, "cells": rows})
    write_answers(root, "report")
    written(root, "report", compared(root, "report", collect(root, "report")))
    models = [built(name) for name in BUILT]
    written(root, "report", catalogue_tables(root, "report", pd.read_csv(root / "tables/convergence.csv"), models))
    said_again(root)


@pytest.fixture(scope="session")
def files(loaded: Store) -> dict[str, str]:
    """All pages, their pictures empty."""
    return rendered(loaded, draw=False)


@pytest.fixture(scope="session")
def drawn(loaded: Store) -> dict[str, str]:
    """All pages and their pictures."""
    return rendered(loaded)


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures are built but not turned to SVG, which takes most of the time of a page."""
    monkeypatch.setattr(Figure, "savefig", lambda self, file, **options: file.write(b"<svg/>"))


@pytest.fixture(scope="session")
def loaded(store: Path) -> Store:
    """The store as pages read it; none of its tables may be changed."""
    return load_store(store)


@pytest.fixture
def edited(loaded: Store, tmp_path: Path) -> Store:
    """The same cells with tables of their own, to be replaced or removed before they are read."""
    shutil.copytree(loaded.path / "tables", tmp_path / "tables", copy_function=os.link)
    return replace(loaded, path=tmp_path)


@pytest.fixture
def own_store(store: Path, tmp_path: Path) -> Iterator[Path]:
    """A copy that a test may damage: by replacing files, not by writing to them."""
    with linked(store, tmp_path / "store") as own:
        yield own

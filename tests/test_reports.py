"""The reports on a store made up here: nothing is solved."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from reports import labels
from reports.compare import differences, same_number
from reports.convergence import extrapolated, order_against, self_order
from reports.figures import draw_result
from reports.markdown import NOTHING, digits, fixed, machine, percent, prose, scientific
from reports.page_measures import crossing
from reports.pages import check_pages, compare_pages, rendered, write_pages
from reports.printed import FILE, HALF, IMAGES, LITERAL, asymmetry, compare, core, force, printed_map
from reports.schema import StoreError, load_store
from studies.campaign import CAMPAIGNS, Cell
from studies.rigid_body import rigid_body_table, rotation_sweep
from studies.scenes import SCENES
from studies.scenes.data import DATA, read_reference
from studies.solve import resolve
from studies.store import SCHEMA, write_json, write_table

PSI, PHI = np.arange(-60.0, 61.0, 5.0), np.arange(-22.5, 22.6, 2.5)
TYRE_SETTINGS = {"R1_mm": 50.0, "R0_mm": 250.0, "plies": 4, "ply_thickness_mm": 1.2}
KKT = {"equilibrium": 1e-12, "penetration": 0.0, "tension": 0.0, "complementarity": 0.0}
CUT_EVENT = "the residual is no longer finite or has grown without bound: step cut to 0.5"


def contact_table(delta: float) -> pd.DataFrame:
    """An elliptic patch that grows with delta, symmetric under the half turn only."""
    psi, phi = (a.ravel() for a in np.meshgrid(PSI, PHI, indexing="ij"))
    active = (psi / (2 * delta)) ** 2 + (phi / delta) ** 2 < 1
    pressure = np.where(active, 0.15 + 1e-5 * psi * phi, 0.0)
    nodes = {"delta_mm": delta, "psi_deg": psi, "phi_deg": phi, "pressure_MPa": pressure}
    return pd.DataFrame(nodes | {"gap_mm": np.where(active, 0.0, 1.0), "active": active.astype(int)})


def profile_table(deltas: list[float]) -> pd.DataFrame:
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


def history_table(cut: bool) -> pd.DataFrame:
    row = {"stage": "load", "parameter": 1.0, "contact_nodes": 0, "added": 0, "removed": 0}
    rows = [row | {"iteration": i, "residual": residual} for i, residual in enumerate((1.0, 1e-3, 1e-12))]
    return pd.DataFrame([rows[0], rows[1] | {"residual": np.inf, "event": CUT_EVENT}, *rows] if cut else rows)


def tyre_step(delta: float, measure: str) -> dict[str, Any]:
    patch = {"contact_nodes": 30, "half_length_mm": 4 * delta, "half_width_mm": 2 * delta}
    symmetry = {"central_asymmetry": 1e-14, "mirror_asymmetry": 0.1}
    loads = {"force_N": delta * delta * (5.0 if measure == "exact" else 7.0), "centre_pressure_MPa": 0.15}
    return {"delta_mm": delta, **loads, **patch, "kkt": KKT, "rounding": 1e-13, **symmetry, "newton_iterations": 5}


def static_step(scene: str, n: int, fraction: float) -> dict[str, Any]:
    """The references of the scene, approached with second order; between their loads, shares of the last."""
    kind = "exact" if scene == "cantilever" else "read"
    error = 1.0 - 0.1 * (16 / n) ** 2
    known = {(r.quantity, r.at["load_fraction"]): r.value for r in SCENES[scene].references if r.kind == kind}
    names = dict.fromkeys(name for name, _ in known)
    values = {name: error * known.get((name, fraction), fraction * known[name, 1.0]) for name in names}
    return {"load_fraction": fraction, **values, "kkt": KKT, "rounding": 1e-8, "newton_iterations": 4, "substeps": 1}


def write_cell(cell: Cell, directory: Path) -> None:
    _, request = resolve(cell.scene, cell.settings, **cell.options)
    settings = dict(request.settings)
    if cell.scene.startswith("tyre"):
        deltas = [float(delta) for delta in settings["delta_mm"]]
        steps = [tyre_step(delta, request.measure) for delta in deltas]
        write_table(directory / "contact.csv", pd.concat([contact_table(delta) for delta in deltas]))
        write_table(directory / "profile.csv", profile_table(deltas))
    else:
        steps = [static_step(cell.scene, request.mesh[0], f) for f in settings["load_fraction"]]
    write_table(directory / "history.csv", history_table(cut=cell.label in labels.EXPECTED_TO_FAIL))
    result = {
        **{name: getattr(request, name) for name in ("scene", "measure", "contact", "newton", "model")},
        "mesh": f"{request.mesh[0]}x{request.mesh[1]}",
        "settings": {**settings, "steps": request.steps},
        **{"outcome": "converged", "reason": "converged", "steps": steps},
        "quantities": {"inflated_equator_inner_mm": 1.0, "inflated_equator_outer_mm": 0.9},
        "counters": {"dofs": 10, "newton_iterations": 9, "factorisations": 9, "assemblies": 9, "set_changes": 2},
        "timing_s": {"total": 1.25, "build": 0.1, "assembly": 0.5, "factorisation": 0.5, "solve": 0.1, "contact": 0.05},
        "provenance": {"version": "0", "commit": "unknown", "packages": {"numpy": "2"}, "machine": {"cores": 2}},
    }
    write_json(directory / "result.json", result)


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A whole report campaign."""
    root = tmp_path_factory.mktemp("store")
    rows = []
    for i, cell in enumerate(CAMPAIGNS["report"]):
        write_cell(cell, root / "cells" / str(i))
        rows.append({"label": cell.label, "id": str(i), "scene": cell.scene, "command": cell.command})
    references = [{"scene": name, **asdict(r)} for name, scene in SCENES.items() for r in scene.references]
    shutil.copytree(DATA, root / "references", ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    write_json(root / "references.json", {"references": references})
    write_table(root / "tables" / "rigid_body.csv", rigid_body_table())
    write_table(root / "tables" / "rotation_sweep.csv", rotation_sweep(points=5))
    write_json(root / "campaign.json", {"schema": SCHEMA, "campaign": "report", "cells": rows})
    return root


@pytest.fixture(scope="module")
def files(store: Path) -> dict[str, str]:
    return rendered(load_store(store))


@pytest.fixture
def own_store(store: Path, tmp_path: Path) -> Path:
    """A copy that a test may damage."""
    return Path(shutil.copytree(store, tmp_path / "store"))


@pytest.fixture
def out(files: dict[str, str], tmp_path: Path) -> Path:
    """The pages as committed."""
    for name, text in files.items():
        path = tmp_path / "pages" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return tmp_path / "pages"


def edit_json(path: Path, change: Callable[[dict[str, Any]], object]) -> None:
    data = json.loads(path.read_text(encoding="utf-8"))
    change(data)
    write_json(path, data)


def replace_in(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


DAMAGES: dict[str, tuple[Callable[[Path], object], str]] = {
    "no store": (lambda root: shutil.rmtree(root), "no such directory"),
    "no index": (lambda root: (root / "campaign.json").unlink(), "campaign.json: missing"),
    "schema": (lambda root: edit_json(root / "campaign.json", lambda d: d.update(schema=99)), "schema 99"),
    "cell missing": (lambda root: (root / "cells/3/result.json").unlink(), "cells/3/result.json: missing"),
    "cell corrupt": (lambda root: (root / "cells/3/result.json").write_text("{"), "result.json: cannot be read"),
    "not a record": (lambda root: (root / "cells/3/result.json").write_text("[]"), "expected a record"),
    "key": (lambda root: edit_json(root / "cells/3/result.json", lambda d: d.pop("steps")), "result.json: lacks steps"),
    "step": (
        lambda root: edit_json(root / "cells/3/result.json", lambda d: d["steps"][0].pop("force_N")),
        "result.json: lacks force_N",
    ),
    "table missing": (lambda root: (root / "cells/0/contact.csv").unlink(), "contact.csv: missing"),
    "table empty": (lambda root: (root / "cells/0/contact.csv").write_text(""), "contact.csv: cannot be read"),
    "column": (lambda root: (root / "cells/0/contact.csv").write_text("a,b\n1,2\n"), "lacks the columns delta_mm"),
    "reference": (lambda root: (root / "references" / FILE).unlink(), f"{FILE}: missing"),
    "label": (
        lambda root: edit_json(root / "campaign.json", lambda d: d["cells"].pop(0)),
        "no cell 'paper', which the pages need",
    ),
}


@pytest.mark.parametrize(("damage", "says"), DAMAGES.values(), ids=list(DAMAGES))
def test_a_damaged_store_is_one_clear_line_and_nothing_is_written(
    own_store: Path, tmp_path: Path, damage: Callable[[Path], object], says: str
) -> None:
    damage(own_store)
    with pytest.raises(StoreError) as caught:
        write_pages(own_store, tmp_path / "out")
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_pages_are_the_same_bytes_every_time(store: Path, files: dict[str, str], tmp_path: Path) -> None:
    written = write_pages(store, tmp_path)
    assert [path.relative_to(tmp_path).as_posix() for path in written] == list(files)
    assert {"index.md", "tyre.md", "benchmarks.md"} <= set(files)
    for path, text in zip(written, files.values(), strict=True):
        assert path.read_bytes() == text.encode(), path.name
    assert not list(tmp_path.rglob(".part-*"))


def test_committed_pages_agree_with_their_store(store: Path, out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures are not compared, so drawing them is left out here."""
    monkeypatch.setattr(Figure, "savefig", lambda self, file, **options: file.write(b"<svg/>"))
    assert check_pages(store, out) == []
    assert f"{out / 'nowhere'}: no page to compare" in check_pages(store, out / "nowhere")


def test_every_picture_of_a_page_is_written_and_every_written_picture_is_shown(files: dict[str, str]) -> None:
    pages = "\n".join(text for name, text in files.items() if name.endswith(".md"))
    for name in files:
        if name.endswith(".svg"):
            assert f"]({name})" in pages
    assert pages.count("](figures/") == sum(name.endswith(".svg") for name in files)


def test_cells_that_did_not_converge_are_shown(own_store: Path) -> None:
    """All fail but the one without which there is no page; what was never reached is not in the store."""
    for i, cell in enumerate(CAMPAIGNS["report"]):
        if cell.label == labels.PAPER:
            continue
        directory = own_store / "cells" / str(i)
        failed = {"outcome": "cycling", "reason": "press at 20: it cycles", "steps": [], "quantities": {}}
        edit_json(directory / "result.json", lambda result, failed=failed: result.update(failed))
        for name in ("contact.csv", "profile.csv"):
            (directory / name).unlink(missing_ok=True)
    files = rendered(load_store(own_store))
    assert f"| all | {len(CAMPAIGNS['report'])} | 1 | 0 | {len(CAMPAIGNS['report']) - 1} |" in files["index.md"]
    assert f"| {labels.SLOWEST} | not converged: press at 20: it cycles |" in files["index.md"]
    assert "| cycling: press at 20: it cycles |" in files["tyre.md"]
    assert not any("nan" in text for name, text in files.items() if name.endswith(".md"))


def test_without_the_travel_of_the_printed_table_there_is_no_page(own_store: Path) -> None:
    number = next(i for i, cell in enumerate(CAMPAIGNS["report"]) if cell.label == labels.PAPER)
    path = own_store / "cells" / str(number) / "result.json"
    edit_json(path, lambda result: result.update(steps=result["steps"][:3], reason="it cycles"))
    with pytest.raises(StoreError, match="cell 'paper' has no step at delta_mm = 20: it cycles"):
        rendered(load_store(own_store))


def test_benchmark_rows_and_orders(files: dict[str, str]) -> None:
    """Two tables of four load fractions, and the second order that the made-up values converge with."""
    rows = [line for line in files["benchmarks.md"].splitlines() if line.startswith("| outward displacement [mm] |")]
    assert len(rows) == 8
    assert all(line.endswith("| 2.00 | 2.00 | 2.00 |") for line in rows[4:])


def test_a_changed_digit_is_found_with_page_and_line(files: dict[str, str], out: Path) -> None:
    text = files["tyre.md"].splitlines()
    number = next(i for i, line in enumerate(text, start=1) if "2000.00" in line)
    replace_in(out / "tyre.md", "2000.00", "2000.07")
    (found,) = compare_pages(files, out)
    assert found.startswith(f"tyre.md:{number}: committed ")
    assert "2000.07" in found


def test_what_the_machine_decides_is_not_compared(files: dict[str, str], out: Path) -> None:
    replace_in(out / "tyre.md", "| paper | 1.25 |", "| paper | 7.00 |")
    replace_in(out / "index.md", "numpy 2", "numpy 3")
    assert compare_pages(files, out) == []


def test_words_are_compared(files: dict[str, str], out: Path) -> None:
    replace_in(out / "index.md", "planned", "foreseen")
    (found,) = compare_pages(files, out)
    assert found.startswith("index.md:")


def test_missing_and_surplus_files_are_found(files: dict[str, str], out: Path) -> None:
    (out / "tyre.md").unlink()
    (out / "old.md").write_text("old")
    picture = next(iter(files))
    (out / picture).unlink()
    found = compare_pages(files, out)
    assert [line.split(":")[0] for line in found] == [picture, "tyre.md", "old.md"]


def test_comparing_no_page_at_all_is_a_difference(files: dict[str, str], tmp_path: Path) -> None:
    assert f"{tmp_path}: no page to compare" in compare_pages(files, tmp_path)


@pytest.mark.parametrize(
    ("a", "b", "same"),
    [
        ("12.34", "12.35", True),
        ("12.34", "12.36", False),
        ("211", "212", False),
        ("211", "211", True),
        ("1959.049892", "1959.049999", True),
        ("1959.049892", "1959.149892", False),
        ("3.0e-13", "7.1e-09", True),
        ("0", "7.1e-09", True),
        ("0", "0.3", False),
        ("3.0e-13", "2.0e-08", False),
        ("-8.02e-07", "-8.03e-07", True),
        ("-8.02e-07", "+8.02e-07", False),
    ],
)
def test_numbers_agree_to_their_last_digit(a: str, b: str, same: bool) -> None:
    assert same_number(a, b) is same


def test_inserted_and_lost_lines_are_differences_of_their_own() -> None:
    assert len(differences("p.md", "a 1\nb 2\n", "a 1\nnew\nb 2\n")) == 1
    assert differences("p.md", "a 1\nb 2\n", "b 2\n") == ["p.md:1: committed 'a 1', regenerated ''"]
    assert differences("p.md", f"x\n{machine('9 s')}\ny 1", f"x\n{machine('8 s')}\n\ny 1") != []
    assert differences("p.md", f"x\n{machine('9 s')}", "x") != []


def hand_made() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Printed: 7 x 7 of 1 MPa without a corner; ours: 1.1 MPa without a core node and without row 15."""
    angles = np.arange(-15.0, 16.0, 5.0)
    printed = pd.DataFrame(1.0, index=pd.Index(angles), columns=pd.Index(angles))
    ours = 1.1 * printed
    printed.iloc[0, 0] = np.nan
    ours.iloc[2, 2] = np.nan
    ours.iloc[6] = np.nan
    return ours, printed


def test_comparison_of_two_patches_by_hand() -> None:
    ours, printed = hand_made()
    c = compare(ours, printed)
    assert (c.printed_nodes, c.nodes, c.both) == (48, 41, 40)
    assert (c.symmetric_difference, c.outside) == (9, 8)
    assert c.core_nodes == 8  # 3 x 3 in the middle of 7 x 7, less the one that is not in ours
    assert c.core_rms == pytest.approx(0.1, rel=1e-12)
    assert (c.centre, c.printed_centre) == (1.1, 1.0)


def test_core_keeps_its_distance_along_both_directions() -> None:
    patch = np.ones((7, 7), bool)
    assert core(patch).sum() == 9
    patch[3, 0] = False
    assert core(patch).sum() == 8
    assert not core(patch)[3, 2]
    assert core(patch)[2, 2]
    assert core(np.ones((4, 9), bool)).sum() == 0


def test_force_is_pressure_times_mid_surface_area() -> None:
    _, printed = hand_made()
    psi = np.deg2rad(np.asarray(printed.columns, dtype=float))
    r = 200.0 + 52.4 * np.cos(psi)  # mid-surface, 2.4 mm outside the inner face
    areas = np.deg2rad(5.0) * np.deg2rad(2.5) * 52.4 * r
    expected = 7 * areas.sum() - areas[0]  # one corner is blank
    assert force(printed, HALF, TYRE_SETTINGS) == pytest.approx(expected, rel=1e-12)


def test_symmetries_of_the_printed_table() -> None:
    printed = printed_map(read_reference(FILE))
    central, *mirrors = (asymmetry(printed, image) for image in IMAGES)
    assert central == (0.0, 0.0)
    for mirror in mirrors:
        assert mirror == pytest.approx((0.039, 0.039), abs=1e-12)
    patch = printed.notna().to_numpy()
    assert patch.sum() == 277
    assert np.array_equal(patch, patch[::-1, ::-1])
    assert force(printed, LITERAL, TYRE_SETTINGS) == pytest.approx(2 * force(printed, HALF, TYRE_SETTINGS))


def test_asymmetry_counts_blanks_as_zero_or_leaves_them_out() -> None:
    p = pd.DataFrame([[np.nan, 2.0, 3.0], [1.0, 2.0, 1.5]], index=[-1.0, 1.0], columns=[-1.0, 0.0, 1.0])
    image = next(name for name in IMAGES if "p(-psi, phi)" in name)
    assert asymmetry(p, image) == (3.0, 0.5)


@pytest.mark.parametrize("order", [1.0, 2.0, 3.5])
def test_orders_and_limit_of_a_power_law(order: float) -> None:
    f = [7.0 + 0.3 * h**order for h in (1.0, 0.5, 0.25)]
    assert order_against(f[0], f[1], 7.0) == pytest.approx(order, abs=1e-10)
    assert self_order(*f) == pytest.approx(order, abs=1e-10)
    assert extrapolated(*f) == pytest.approx(7.0, abs=1e-12)


def test_orders_that_mean_nothing_are_not_given() -> None:
    assert order_against(1.2, 0.9, 1.0) is None  # the error changes its sign
    assert order_against(1.2, 1.01, 1.0, noise=0.05) is None  # below the error of the reference
    assert self_order(1.0, 2.0, 1.5) is None
    assert self_order(1.0, 2.0, 2.0) is None
    assert extrapolated(1.0, 2.0, 4.0) is None  # diverges


def test_zero_has_no_sign_in_any_format() -> None:
    assert fixed(-0.0004, 2) == "0.00"
    assert fixed(-0.0004, 2, sign=True) == "0.00"
    assert percent(-1e-9) == "0.00 %"
    assert digits(-0.0, 3) == "0.00"
    assert scientific(-0.0) == "0"
    assert fixed(None, 2) == scientific(None) == percent(None) == "–"


def test_prose_joins_lines_but_not_items() -> None:
    assert prose("a\nb\n\n- c\n  d\n- e") == "a b\n\n- c d\n- e"


@pytest.mark.parametrize(("label", "count"), [(labels.BASE, 4), ("hemisphere 16", 1)])
def test_pictures_of_one_result(own_store: Path, label: str, count: int) -> None:
    directory = load_store(own_store).cell(label).directory
    drawn = draw_result(directory)
    assert len(drawn) == count
    assert all(path.parent == directory / "figures" and path.read_text().startswith("<?xml") for path in drawn)


def test_a_result_without_a_step_has_no_picture(own_store: Path) -> None:
    edit_json(own_store / "cells/0/result.json", lambda result: result.update(steps=[]))
    assert draw_result(own_store / "cells/0") == []
    with pytest.raises(StoreError, match=r"result\.json: missing"):
        draw_result(own_store)


def test_the_load_from_which_an_error_stays_above_a_level() -> None:
    error = pd.DataFrame({"load": [1.0, 2.0, 3.0, 4.0], "a": [0.0, 0.02, 0.0, -0.02], "b": [0.02] * 4, "c": [0.0] * 4})
    assert crossing(error, "a", 0.01) == "3.50"  # the visit at 2 does not last
    assert crossing(error, "b", 0.01) == "below 1.00"
    assert crossing(error, "c", 0.01) == NOTHING

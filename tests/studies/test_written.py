"""What a solve leaves in its directory, and nothing of others; tables as pandas has them, fields for meshio."""

from __future__ import annotations

import json
import math
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pandas as pd
import pytest

from studies.cli import main
from studies.output.atomic import Table, forget
from studies.output.vtu import read_vtu, write_vtu
from studies.scenes.complete import complete
from studies.scenes.contact.strip import LIFT
from studies.scenes.manufactured.scene import carrying
from studies.solving.solve import solve

RING = ["solve", "ring", "--mesh", "1x8", "--set", "delta_mm=5,10"]


def names(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def test_what_a_former_result_has_left_goes_and_what_is_of_others_stays(tmp_path: Path) -> None:
    foreign = {"notes.txt", "mine.csv", "figures/mine.svg"}
    (tmp_path / "figures").mkdir()
    for name in foreign:
        (tmp_path / name).write_text("mine")
    assert main([*RING, "--error", "50%", "--plot", "--out", str(tmp_path)]) == 0
    first = names(tmp_path)
    assert {"refinement.csv", "grid.csv", "figures/grid.svg", *foreign} <= first
    assert {*json.loads((tmp_path / "result.json").read_text())["files"]} == first - foreign - {"result.json"}
    assert main([*RING, "--out", str(tmp_path)]) == 0
    second = names(tmp_path)
    assert not {"refinement.csv", "grid.csv", "figures/grid.svg", "figures/load-displacement.svg"} & second
    assert {*json.loads((tmp_path / "result.json").read_text())["files"]} == second - foreign - {"result.json"}


@pytest.mark.parametrize("record", ["result.json", "choice.json", "sweep.json"])
def test_only_what_a_record_names_and_is_not_kept_is_forgotten(record: str, tmp_path: Path) -> None:
    (tmp_path / "figures").mkdir()
    for name in ("a.csv", "b.csv", "figures/a.svg", "mine.csv", "notes.txt", "fields.pvd"):
        (tmp_path / name).write_text("x")
    (tmp_path / record).write_text(
        json.dumps({"files": ["a.csv", "b.csv", "figures/a.svg", "notes.txt", "fields.pvd"]})
    )
    forget(tmp_path, record, ["b.csv"])
    assert names(tmp_path) == {"b.csv", "mine.csv", "notes.txt", record}
    forget(tmp_path / "nowhere", record, [])


@pytest.mark.slow
def test_a_second_choice_leaves_nothing_of_the_first(tmp_path: Path) -> None:
    (tmp_path / "mine.csv").write_text("mine")
    for scene in ("panel", "hemisphere"):  # the second has no contact, and no table of algorithms
        main(["choose", scene, "--mesh", "4x4", "--error", "20%", "--budget", "3s", "--out", str(tmp_path)])
        record = json.loads((tmp_path / "choice.json").read_text())
        assert {*record["files"]} == names(tmp_path) - {"choice.json", "mine.csv"}


def test_a_result_that_lies_about_its_files_deletes_nothing_elsewhere(tmp_path: Path) -> None:
    out, beside = tmp_path / "out", tmp_path / "beside.csv"
    out.mkdir()
    beside.write_text("mine")
    (out / "notes.txt").write_text("mine")
    messages = ["../beside.csv", str(beside), "notes.txt", "..", 7, ["x"]]
    for files in (messages, "fields.vtu", None, {"a": 1}):
        (out / "result.json").write_text(json.dumps({"files": files}))
        assert main([*RING, "--out", str(out)]) == 0
        assert beside.exists()
        assert (out / "notes.txt").exists()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["ring", "--freeze", "{}/none/step.npz"], "--freeze {0}/none/step.npz: there is no directory {0}/none"),
        (["ring", "--freeze", "{}"], "--freeze {0} is a directory, not a file"),
    ],
)
def test_a_place_that_cannot_be_is_refused_before_anything_is_solved(
    words: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [word.format(tmp_path) for word in words]
    assert main(["solve", *words, "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err == f"footprint: {says.format(tmp_path)}\n"
    assert names(tmp_path) == set()
    assert not (tmp_path / "none").exists()


def test_a_step_is_frozen_into_the_directory_of_its_result(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main([*RING, "--out", str(out), "--freeze", str(out / "step.npz")]) == 0
    assert (out / "step.npz").exists()


def test_fields_hold_the_displacements_given_to_supports(tmp_path: Path) -> None:
    """Of the lifted end; and resultants are those of the lifted strip, not of one whose end stays."""
    solution = solve(*complete("heavy-strip", {"load_fraction": "0.25,0.5"}, "8x1"))
    solution.write(tmp_path)
    fields = meshio.read(tmp_path / "fields.vtu")
    end = fields.points[:, 0] == 0.0
    up = fields.point_data["displacement"][end, 2]
    assert up[fields.point_data["face"][end] == 1.0] == pytest.approx([-0.5 * LIFT] * 2, rel=1e-12)
    lifted, u = solution.model.body_at(0.5), solution.last.u
    stated = np.array([values[0] for name, values in fields.cell_data.items() if name.startswith("H_")]).T
    assert stated == pytest.approx(lifted.resultants(u)[:, : stated.shape[1]], rel=1e-12, abs=1e-15)
    assert abs(stated - solution.model.shell.resultants(u)[:, : stated.shape[1]]).max() > 1e-3 * abs(stated).max()


def test_fields_of_a_manufactured_solution_are_the_solution_at_its_held_edges(tmp_path: Path) -> None:
    solution = solve(*complete("manufactured", {}, "4x4"))
    solution.write(tmp_path)
    model = solution.model
    body = carrying(model.shell, model.exact_at(1.0), model.loaded)
    record = meshio.read(tmp_path / "fields.vtu").point_data["displacement"]
    assert record == pytest.approx(
        np.concatenate(body.discretisation.cartesian(solution.last.u, body.prescribed)), abs=1e-12
    )
    held = np.tile(body.discretisation.map.held.any(axis=1), 2)
    assert np.linalg.norm(record[held], axis=1).max() > 1.0


def test_strains_are_those_of_the_displacements_beside_them(tmp_path: Path) -> None:
    """Of a sphere under pressure: (l^2 - 1)/2 with the stretches l of both faces and of the wall, from the points."""
    solution = solve(*complete("pressurised-sphere", {}, "8x1"))
    solution.write(tmp_path)
    fields = meshio.read(tmp_path / "fields.vtu")
    faces = np.split(fields.points, 2), np.split(fields.points + fields.point_data["displacement"], 2)
    (before, after), cells = ([np.linalg.norm(face, axis=1) for face in pair] for pair in faces), fields.cell_data
    for face, side in enumerate("-+"):
        stretch = np.mean(after[face] / before[face])
        for name in ("E11", "E22"):
            assert cells[name + side][0] == pytest.approx((stretch**2 - 1) / 2, rel=2e-3)
    wall = [np.linalg.norm(outer - inner, axis=1) for inner, outer in faces]
    assert cells["E33"][0] == pytest.approx(np.mean(((wall[1] / wall[0]) ** 2 - 1) / 2), rel=2e-3)


def test_gaps_and_contact_are_those_of_the_points_beside_them(tmp_path: Path) -> None:
    """The foundation of the tyre and of the ring is a plane across x: a gap and x make its place, at every load."""
    for words in (RING, ["solve", "tyre", "--mesh", "12x12", "--set", "delta_mm=5,10", "--no-error"]):
        out = tmp_path / words[1]
        assert main([*words, "--out", str(out)]) == 0
        table = pd.read_csv(out / "contact.csv")
        place = {delta: rows["gap_mm"] + rows["x_mm"] for delta, rows in table.groupby("delta_mm")}
        assert place[5.0].to_numpy() == pytest.approx(np.full(len(place[5.0]), place[5.0].iloc[0]), abs=1e-9)
        assert place[10.0].mean() == pytest.approx(place[5.0].mean() - 5, abs=1e-9)
        record = json.loads((out / "result.json").read_text())
        fields = meshio.read(out / "fields.vtu")
        x = fields.points + fields.point_data["displacement"]
        gap, touches = fields.point_data["gap"], fields.point_data["in_contact"]
        known = np.isfinite(gap)
        assert (gap + x[:, 0])[known] == pytest.approx(np.full(known.sum(), place[10.0].mean()), abs=1e-9)
        assert np.all(fields.point_data["face"][known] == 1)
        assert np.array_equal(touches[known] == 1, fields.point_data["pressure"][known] > 0)
        assert np.all(touches[~known] == 0)
        assert {"contact.csv", "nodes.csv", "fields_1.vtu", "fields.pvd"} <= {*record["files"]}
    ring = pd.read_csv(tmp_path / "ring" / "contact.csv")
    record = json.loads((tmp_path / "ring" / "result.json").read_text())
    assert ring.groupby("delta_mm")["active"].sum().tolist() == [step["contact_nodes"] for step in record["steps"]]


def test_a_series_has_the_state_of_every_load_and_its_nodes_the_last(tmp_path: Path) -> None:
    assert main([*RING, "--out", str(tmp_path / "both")]) == 0
    series = ElementTree.parse(tmp_path / "both" / "fields.pvd").getroot().iter("DataSet")
    files = {float(each.attrib["timestep"]): each.attrib["file"] for each in series}
    assert files == {5.0: "fields_1.vtu", 10.0: "fields.vtu"}
    for delta, name in files.items():
        alone = tmp_path / f"{delta:g}"
        loads = f"delta_mm={','.join(f'{each:g}' for each in files if each <= delta)}"
        assert main(["solve", "ring", "--mesh", "1x8", "--set", loads, "--out", str(alone)]) == 0
        ours, theirs = (
            meshio.read(path).point_data["displacement"] for path in (tmp_path / "both" / name, alone / "fields.vtu")
        )
        assert np.array_equal(ours, theirs)
    nodes = pd.read_csv(tmp_path / "both" / "nodes.csv")
    fields = meshio.read(tmp_path / "both" / "fields.vtu")
    assert nodes[["ux_mm", "uy_mm", "uz_mm"]].to_numpy() == pytest.approx(fields.point_data["displacement"], abs=0)
    assert nodes[["x_mm", "y_mm", "z_mm"]].to_numpy() == pytest.approx(fields.points, abs=0)
    assert main(["solve", "ring", "--mesh", "1x8", "--set", "delta_mm=5", "--out", str(tmp_path / "both")]) == 0
    assert not {"fields.pvd", "fields_1.vtu"} & names(tmp_path / "both")


def test_every_array_of_a_solve_has_its_unit(tmp_path: Path) -> None:
    assert main([*RING, "--out", str(tmp_path)]) == 0
    arrays = ElementTree.parse(tmp_path / "fields.vtu").getroot().iter("DataArray")
    units = {each.attrib["Name"]: each.findtext("InformationKey[@name='UNITS_LABEL']") for each in arrays}
    expected = {"Points": "mm", "displacement": "mm", "gap": "mm", "pressure": "MPa", "H_11-": "N/mm", "E11+": "1"}
    expected |= {"2E12-": "1", "S_LL1-": "MPa"}
    assert expected.items() <= units.items()
    without = {"face", "in_contact", "connectivity", "offsets", "types"}
    assert {name for name, unit in units.items() if unit is None} == without
    assert read_vtu(tmp_path / "fields.vtu").data.keys() >= {"gap", "E33"}


def test_a_curve_that_comes_back_is_in_its_order(tmp_path: Path) -> None:
    assert main(["solve", "roof-b", "--mesh", "4x4", "--no-error", "--out", str(tmp_path)]) == 0
    sets = [each.attrib for each in ElementTree.parse(tmp_path / "fields.pvd").getroot().iter("DataSet")]
    assert [float(each["timestep"]) for each in sets] == list(range(1, len(sets) + 1))
    assert len(sets) == len(json.loads((tmp_path / "result.json").read_text())["steps"])
    assert all((tmp_path / each["file"]).exists() for each in sets)


def test_files_are_those_of_pandas_to_the_byte(rng: np.random.Generator, tmp_path: Path) -> None:
    columns = {
        "wide": rng.normal(size=40) * 10.0 ** rng.integers(-300, 300, size=40),
        "count": np.arange(40),
        "rare": np.where(np.arange(40) % 3, math.nan, 0.1),
        "edge": np.resize([math.inf, -math.inf, -0.0, 1e16, 1e-5, 123456789.0], 40),
        "state": "unloaded",
        "said": np.resize(['limit point, "cut"', "two\nlines", ""], 40),
    }
    Table.of(columns).write(tmp_path / "ours.csv")
    pd.DataFrame(columns).to_csv(tmp_path / "theirs.csv", index=False)
    assert (tmp_path / "ours.csv").read_bytes() == (tmp_path / "theirs.csv").read_bytes()


def test_what_a_row_lacks_is_blank_and_a_whole_number_stays_one(tmp_path: Path) -> None:
    rows = [{"stage": "press", "added": 3}, {"stage": "press", "event": "cut"}]
    Table.of_rows(rows).write(tmp_path / "history.csv")
    assert (tmp_path / "history.csv").read_text() == "stage,added,event\npress,3,\npress,,cut\n"
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "history.csv"), pd.DataFrame(rows))


def test_without_rows_the_named_columns_are_there(tmp_path: Path) -> None:
    Table.of_rows([], ["stage", "residual"]).write(tmp_path / "history.csv")
    assert (tmp_path / "history.csv").read_text() == "stage,residual\n"
    assert len(Table({})) == len(Table.of_rows([], ["stage"])) == 0


def test_stacked_and_framed_as_pandas_does() -> None:
    parts = [{"state": "a", "x": np.array([1.0, 2.0])}, {"state": "b", "x": np.array([3.0]), "y": np.array([4.0])}]
    ours = Table.stacked([Table.of(part) for part in parts])
    theirs = pd.concat([pd.DataFrame(part) for part in parts], ignore_index=True)
    pd.testing.assert_frame_equal(ours.frame(), theirs)
    assert len(ours) == 3


def test_columns_of_different_length_are_no_table() -> None:
    with pytest.raises(ValueError, match="broadcast"):
        Table.of({"x": np.zeros(3), "y": np.zeros(4)})
    with pytest.raises(ValueError, match="shorter"):
        list(Table({"x": [1, 2], "y": [1]}).rows())


@pytest.mark.parametrize(("nodes", "kind"), [(8, "hexahedron"), (27, "hexahedron27")])
def test_meshio_reads_every_bit_back(nodes: int, kind: str, rng: np.random.Generator, tmp_path: Path) -> None:
    points = rng.normal(size=(90, 3)) * [1e-300, 1.0, 1e300]
    cells = rng.permuted(np.tile(np.arange(90), (5000, 1)), axis=1)[:, :nodes]  # more than a block of 32 kB
    point_data = {"displacement": rng.normal(size=(90, 3)), "pressure": rng.normal(size=90)}
    cell_data = {"H_11-": rng.normal(size=(5000, 2))[:, 0]}  # strided
    write_vtu(tmp_path / "fields.vtu", points, cells, point_data, cell_data)
    read = meshio.read(tmp_path / "fields.vtu")
    (block,) = read.cells
    assert block.type == kind
    np.testing.assert_array_equal(block.data, cells)
    np.testing.assert_array_equal(read.points, points)
    assert read.point_data.keys() == point_data.keys()
    assert read.cell_data.keys() == cell_data.keys()
    for name, values in point_data.items():
        np.testing.assert_array_equal(read.point_data[name], values)
    np.testing.assert_array_equal(read.cell_data["H_11-"][0], cell_data["H_11-"])


def test_another_kind_of_cell_is_refused(tmp_path: Path) -> None:
    with pytest.raises(KeyError):
        write_vtu(tmp_path / "fields.vtu", np.zeros((4, 3)), np.zeros((1, 4), int), {}, {})

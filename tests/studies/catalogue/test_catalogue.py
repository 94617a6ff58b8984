"""The tables of the sheets: read from the parts and models themselves, and solved by the command that stands there."""

from __future__ import annotations

import math
import shlex
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import QuadraticMeasure
from studies.catalogue.bodies import skin
from studies.catalogue.loads import loads
from studies.catalogue.models import built
from studies.catalogue.parts import facts, laws, parts, plies, settings, terms
from studies.catalogue.quantities import definition, unit
from studies.catalogue.supports import supports
from studies.catalogue.surfaces import shape_of
from studies.catalogue.values import answered, values
from studies.cli import main
from studies.output.vtu import read_vtu, write_vtu
from studies.run.campaigns.file import find
from studies.run.campaigns.run import run
from studies.run.campaigns.sheet_cells import FRAMES, sheet_cell, sheet_cells
from studies.run.cells.answers import Answers
from studies.run.cells.rows import STEP_KEYS
from studies.scenes import SCENES
from studies.scenes.benchmarks.cantilever import Cantilever
from studies.scenes.complete import complete


class Mine(Cantilever):
    """A strip of somebody else's."""

    name = "mine"
    title = "Somebody else's strip"


@cache
def shell_of(name: str) -> ShellModel:
    body = built(name).body
    assert isinstance(body, ShellModel)
    return body


@pytest.mark.parametrize(
    ("scene", "where", "said"),
    [
        ("cantilever", "edge a1 = 0", "clamped: neither face moves"),
        ("cantilever", "edge a1 = 10", "free"),
        ("hemisphere", "edge a2 = 0", "plane of symmetry: neither face moves along a2"),
        ("hemisphere", "point a1 = 0, a2 = 0", "held: inner face along a1"),
        ("roof-a", "edge a2 = 0.1", "hinged: the middle does not move, the director turns"),
        ("scordelis-lo", "edge a1 = 0", "hard diaphragm: neither face moves along a2, the middle not along the normal"),
        ("strip-contact", "edge a1 = 100", "plane of symmetry: neither face moves along a1"),
        ("heavy-strip", "edge a1 = 0", "held: inner and outer face along the normal"),
    ],
)
def test_supports_are_read_from_what_is_held(scene: str, where: str, said: str) -> None:
    assert dict(supports(shell_of(scene).discretisation))[where] == said


@pytest.mark.parametrize(
    ("scene", "kind", "said"),
    [
        ("cantilever", "line force", "(0, 0, 4) N in all along the edge a1 = 10, dead"),
        ("roof-a", "point force", "(-750, 0, 0) N at (2540, 0, 0) mm, shared by both faces"),
        ("sze-moment", "couple", "52.3599 N mm in all along the edge a1 = 12, turns with the director"),
        ("strip-contact", "area load", "2.4e-05 N/mm² in the median"),
        ("pressurised-sphere", "pressure", "0.52381 MPa on the inner face, outwards"),
    ],
)
def test_loads_are_those_of_load_fraction_one(scene: str, kind: str, said: str) -> None:
    found = dict(loads(shell_of(scene)))
    assert said in found[kind]


def test_two_point_forces_are_told_one_by_one() -> None:
    found = [text for kind, text in loads(shell_of("hemisphere")) if kind == "point force"]
    assert [text.partition(" N at ")[0] for text in found] == ["(200, 0, 0)", "(0, -200, 0)"]


def test_surfaces_are_named_with_their_sizes() -> None:
    named = {
        name: shape_of(shell_of(name).discretisation.surface).kind for name in ("hemisphere", "roof-a", "sze-annulus")
    }
    assert named == {
        "hemisphere": "sphere of radius 10 mm",
        "roof-a": "circular cylinder of radius 2540 mm",
        "sze-annulus": "plane in polar coordinates",
    }


def words_of(formula: str) -> list[str]:
    return sorted(formula.replace("- ", "-").replace("+ ", "").split())


def test_what_a_measure_drops_and_keeps_is_the_exact_one() -> None:
    table = terms()
    assert set(table["measure"]) == set(MEASURES)
    exact = table[table["measure"] == "exact"].set_index("strain")
    assert (exact["dropped"] == "").all()
    for name in ("linear", "donnell", "novozhilov", "moderate-rotation"):
        own = table[table["measure"] == name].set_index("strain")
        for strain in own.index:
            whole = sorted(exact.loc[strain, "formula"].replace("- ", "-").replace("+ ", "").split(" "))
            kept = f"{own.loc[strain, 'formula']} {own.loc[strain, 'dropped']}"
            assert sorted(kept.replace("- ", "-").replace("+ ", "").split()) == [each for each in whole if each], (
                name,
                strain,
            )


def test_every_scene_measure_and_algorithm_is_a_part_also_from_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SCENES, "mine", Mine())
    found = parts()
    assert set(found.loc[found["kind"] == "scene", "part"]) == set(SCENES)
    assert "Somebody else's strip" in set(found["meaning"])
    assert len(found) == found[["kind", "part"]].drop_duplicates().shape[0]
    assert set(settings().loc[lambda table: table["part"] == "mine", "key"]) > {"load_fraction", "tolerance"}
    assert "sheet mine" in {cell.label for cell in sheet_cells()}
    assert (found["meaning"] != "").all()
    assert not found.loc[found["kind"] == "measure", "source"].eq("").any()
    assert set(laws()["measure"]) == set(MEASURES)


def test_the_command_of_every_sheet_asks_for_its_cell() -> None:
    asked = []
    for cell in sheet_cells():
        words = shlex.split(cell.command)[2:]
        pairs = list(zip(words[1::2], words[2::2], strict=True))
        given = dict(text.split("=", 1) for flag, text in pairs if flag == "--set")
        options = {flag.removeprefix("--"): text for flag, text in pairs if flag not in ("--set", "--out")}
        asked.append(complete(words[0], given, **options)[1] == complete(cell.scene, cell.settings, **cell.options)[1])
    assert len(asked) == len(SCENES) + len(FRAMES)
    assert all(asked)


def test_every_quantity_that_is_asked_of_a_scene_is_explained() -> None:
    for name, scene in SCENES.items():
        for quantity in {each.quantity for each in scene.references}:
            assert "see the scene" not in definition(name, quantity), (name, quantity)
    assert definition("roof-b", "limit_w_C_mm").endswith("at the first limit point")
    assert unit("N_phi_crown_N_per_mm") == "N/mm"
    assert unit("w_bar") == "1"


def test_fields_are_read_back_and_their_skin_is_closed(tmp_path: Path) -> None:
    points = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0, 2.0)])
    cells = np.array([[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]])
    u = np.random.default_rng(1).normal(size=points.shape)
    write_vtu(tmp_path / "f.vtu", points, cells, {"displacement": u, "pressure": u[:, 0]}, {"ply": np.ones(2)})
    found = read_vtu(tmp_path / "f.vtu")
    np.testing.assert_array_equal(found.points, points)
    np.testing.assert_array_equal(found.cells, cells)
    np.testing.assert_array_equal(found.data["displacement"], u)
    quads = skin(found.cells)
    assert len(quads) == 10
    assert not any(set(quad) == {1, 4, 7, 10} for quad in quads.tolist())
    sides = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    assert (np.unique(sides, axis=0, return_counts=True)[1] == 2).all()
    assert len(skin(np.arange(27)[None])) == 24


@pytest.mark.slow
def test_a_sheet_is_solved_to_its_value_by_its_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two scenes, through the store and through the command line."""
    for name in set(SCENES) - {"cantilever", "strip-contact"}:
        monkeypatch.delitem(SCENES, name)
    monkeypatch.setattr("studies.run.campaigns.sheet_cells.frames", lambda: iter(()))
    run(find("sheets"), tmp_path / "store")
    answers = Answers.of(tmp_path / "store", "sheets")
    table, told = values(answers, pd.DataFrame()), answered(answers).set_index("scene")
    assert set(told["outcome"]) == {"converged"}
    for name in SCENES:
        place = tmp_path / name
        main([*shlex.split(told.loc[name, "command"])[1:-1], str(place), "--start", "cold"])  # as cells of a store are
        result = pd.read_json(place / "result.json", typ="series")
        own = table[(table["scene"] == name) & table["value"].notna()]
        assert len(own) > 1
        for _, row in own.iterrows():
            assert math.isclose(row["value"], result["quantities"][row["quantity"]], rel_tol=1e-9)
    assert table.loc[table["target"].notna(), "error"].abs().max() < 0.02
    assert not set(table["quantity"]) & set(STEP_KEYS)


@pytest.mark.slow
def test_every_model_of_the_catalogue_is_described() -> None:
    whole = [built(name) for name in SCENES]
    said, layers = facts(whole), plies(whole)
    for name in SCENES:
        own = said[said["scene"] == name]
        assert {"Model", "Supports", "Material"} <= set(own["section"]), name
        assert set(own["section"]) & {"Load", "Load of load fraction 1", "Contact"}, name
        assert len(layers[layers["scene"] == name]) > 0, name
    assert isinstance(MEASURES["exact"], QuadraticMeasure)
    assert sheet_cell("tyre").options["model"] == "full"

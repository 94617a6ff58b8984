"""What the parts of the catalogues say of themselves: ``footprint show`` and ``list``, and the tables of the sheets."""

from __future__ import annotations

import math
import re
import shlex
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from contact.catalogue import ALGORITHMS
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES, SANDERS
from formulations.strains.measure import EXACT_LAW, QuadraticMeasure, quadratic_measure
from formulations.strains.quantities import QUANTITIES, STRAINS
from studies.ask.scene import Setting, UsageError, has_contact, ladders_of, settings_beside, sheet_of
from studies.catalogue.bodies import built, skin
from studies.catalogue.descriptions import describe, meaning_of
from studies.catalogue.tables import facts, laws, parts, plies, settings, terms
from studies.catalogue.values import _limit, answered, definition, unit, values
from studies.catalogue.words import loads, shape_of, supports
from studies.cli import main
from studies.output.vtu import read_vtu, write_vtu
from studies.run.answers import Answers
from studies.run.campaign import find
from studies.run.lists import FRAMES, sheet_cell, sheet_cells
from studies.run.running import run
from studies.scenes import SCENES
from studies.scenes.benchmarks.cantilever import Cantilever
from studies.scenes.complete import STEP_KEYS, complete

NAMES = (*SCENES, *MEASURES, *ALGORITHMS)


class Mine(Cantilever):
    """A strip of somebody else's."""

    name = "mine"
    title = "Somebody else's strip"


@cache
def shell_of(name: str) -> ShellModel:
    body = built(name).body
    assert isinstance(body, ShellModel)
    return body


def test_supports_are_read_from_what_is_held() -> None:
    for scene, where, said in (
        ("cantilever", "edge a1 = 0", "clamped: neither face moves"),
        ("cantilever", "edge a1 = 10", "free"),
        ("hemisphere", "edge a2 = 0", "plane of symmetry: neither face moves along a2"),
        ("hemisphere", "point a1 = 0, a2 = 0", "held: inner face along a1"),
        ("roof-a", "edge a2 = 0.1", "hinged: the middle does not move, the director turns"),
        ("scordelis-lo", "edge a1 = 0", "hard diaphragm: neither face moves along a2, the middle not along the normal"),
        ("strip-contact", "edge a1 = 100", "plane of symmetry: neither face moves along a1"),
        ("heavy-strip", "edge a1 = 0", "held: inner and outer face along the normal"),
    ):
        assert dict(supports(shell_of(scene).discretisation))[where] == said


def test_loads_are_those_of_load_fraction_one() -> None:
    for scene, kind, said in (
        ("cantilever", "line force", "(0, 0, 4) N in all along the edge a1 = 10, dead"),
        ("roof-a", "point force", "(-750, 0, 0) N at (2540, 0, 0) mm, shared by both faces"),
        ("sze-moment", "couple", "52.3599 N mm in all along the edge a1 = 12, turns with the director"),
        ("strip-contact", "area load", "2.4e-05 N/mm² in the median"),
        ("pressurised-sphere", "pressure", "0.52381 MPa on the inner face, outwards"),
    ):
        assert said in dict(loads(shell_of(scene)))[kind]
    points = [text for kind, text in loads(shell_of("hemisphere")) if kind == "point force"]  # one by one
    assert [text.partition(" N at ")[0] for text in points] == ["(200, 0, 0)", "(0, -200, 0)"]


def test_surfaces_are_named_with_their_sizes() -> None:
    named = {
        name: shape_of(shell_of(name).discretisation.surface).kind for name in ("hemisphere", "roof-a", "sze-annulus")
    }
    assert named == {
        "hemisphere": "sphere of radius 10 mm",
        "roof-a": "circular cylinder of radius 2540 mm",
        "sze-annulus": "plane in polar coordinates",
    }


def terms_of(formula: str) -> list[str]:
    return sorted(formula.replace("- ", "-").replace("+ ", "").split())


def test_what_a_measure_drops_and_keeps_is_the_exact_one() -> None:
    table = terms()
    assert set(table["measure"]) == set(MEASURES)
    exact = table[table["measure"] == "exact"].set_index("strain")
    assert (exact["dropped"] == "").all()
    for name in ("linear", "donnell", "novozhilov", "moderate-rotation"):
        own = table[table["measure"] == name].set_index("strain")
        for strain in own.index:
            kept = f"{own.loc[strain, 'formula']} {own.loc[strain, 'dropped']}"
            assert terms_of(kept) == terms_of(exact.loc[strain, "formula"]), (name, strain)


def test_every_scene_measure_and_algorithm_is_a_part_also_from_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SCENES, "mine", Mine())
    actual = parts()
    assert set(actual.loc[actual["kind"] == "scene", "part"]) == set(SCENES)
    assert "Somebody else's strip" in set(actual["meaning"])
    assert len(actual) == actual[["kind", "part"]].drop_duplicates().shape[0]
    assert set(settings().loc[lambda table: table["part"] == "mine", "key"]) > {"load_fraction", "tolerance"}
    assert "sheet mine" in {cell.label for cell in sheet_cells()}
    assert (actual["meaning"] != "").all()
    assert not actual.loc[actual["kind"] == "measure", "source"].eq("").any()
    assert set(laws()["measure"]) == set(MEASURES)


def test_the_command_of_every_sheet_asks_for_its_cell() -> None:
    asked = []
    for cell in sheet_cells():
        words = shlex.split(cell.command)[2:]
        pairs = list(zip(words[1::2], words[2::2], strict=True))
        given = dict(text.split("=", 1) for flag, text in pairs if flag == "--set")
        options = {flag.removeprefix("--"): text for flag, text in pairs if flag not in ("--set", "--out")}
        asked.append(complete(words[0], given, **options)[1] == complete(cell.scene, cell.settings, **cell.options)[1])
    assert len(asked) == sum(sheet_of(scene).listed for scene in SCENES.values()) + len(FRAMES)
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
    actual = read_vtu(tmp_path / "f.vtu")
    np.testing.assert_array_equal(actual.points, points)
    np.testing.assert_array_equal(actual.cells, cells)
    np.testing.assert_array_equal(actual.data["displacement"], u)
    quads = skin(actual.cells)
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
    monkeypatch.setattr("studies.run.lists.frames", lambda: iter(()))
    run(find("sheets"), tmp_path / "store")
    answers = Answers.of(tmp_path / "store", "sheets")
    table, stated = values(answers, pd.DataFrame()), answered(answers).set_index("scene")
    assert set(stated["outcome"]) == {"converged"}
    for name in SCENES:
        place = tmp_path / name
        main(
            [*shlex.split(stated.loc[name, "command"])[1:-1], str(place), "--start", "cold"]
        )  # as cells of a store are
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


def test_a_name_means_one_thing() -> None:
    assert len(set(NAMES)) == len(NAMES)


def test_what_a_part_of_others_leaves_unsaid_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """A table without a meaning is known by its source; an algorithm need not say when it applies."""

    class Terse:
        """Guesses."""

        parameters = ()

        def supports(self, problem: object) -> None:
            pass

    table = quadratic_measure("terse", {}, reference="a letter", rigid_body_law=EXACT_LAW)
    monkeypatch.setitem(MEASURES, "terse", table)
    monkeypatch.setitem(ALGORITHMS, "guess", Terse)
    assert describe("terse").text.startswith("terse (measure): a letter\n\nstrains of a face")
    assert describe("guess").text == "guess (algorithm): Guesses."


def test_nothing_is_without_a_meaning(capsys: pytest.CaptureFixture[str]) -> None:
    for name in NAMES:
        actual = describe(name)
        assert actual.meaning.strip(), name
        assert actual.meaning in actual.text, name
        assert list(actual.settings.columns) == ["name", "meaning", "unit", "range", "default"]
        assert actual.settings.map(lambda text: isinstance(text, str) and bool(text.strip())).all(axis=None), name
        if name in SCENES:
            rubs = {"mu"} if has_contact(SCENES[name]) else set()
            slides = {"drag_mm", "drag_deg", "turn_deg"} if name in ("tyre", "panel") else set()
            keys = {*(s.key for s in SCENES[name].settings), "tolerance"} | rubs | slides
            assert set(actual.settings["name"]) == keys, name
            assert all(reference.source in actual.text for reference in SCENES[name].references), name
        else:
            assert "source" in actual.text.lower(), name
    assert main(["show", "tyre"]) == 0
    assert capsys.readouterr().out == describe("tyre").text + "\n"


def evaluated(formula: str, values: dict[str, float]) -> float:
    """Sum of signed products of a fraction, quantities and their squares."""
    total = 0.0
    for sign, term in re.findall(r"([+-]?) ?([^+-]+)", formula):
        factors = (
            values[word] if word in values else values[word[:-1]] ** 2 if word[-1] == "²" else float(Fraction(word))
            for word in term.split()
        )
        total += math.prod(factors) * (-1 if sign == "-" else 1)
    return total


def test_formulas_are_those_of_the_table() -> None:
    q = np.random.default_rng(0).uniform(-0.5, 0.5, len(QUANTITIES))
    values = {quantity.rstrip("+"): value for quantity, value in zip(QUANTITIES, q, strict=True)}
    quadratic = [measure for measure in MEASURES.values() if isinstance(measure, QuadraticMeasure)]
    assert len(quadratic) > 3
    for measure in quadratic:
        for strain, formula in measure.formulas.items():
            row = next(i for i, name in enumerate(STRAINS) if name in (strain, f"{strain}+"))
            assert evaluated(formula, values) == pytest.approx(measure.strain(q)[row], rel=1e-12), formula


def test_a_coefficient_that_is_no_fraction_is_a_decimal() -> None:
    measure = quadratic_measure(
        "x", {"E11": {"l1": -math.pi, "w1 w1": 1 / 3}}, reference="none", rigid_body_law=EXACT_LAW
    )
    assert measure.formulas["E11"] == "- 3.14159 l1 + 1/3 w1²"
    assert measure.formulas["E33"] == "0"


def test_the_law_of_a_measure_is_shown() -> None:
    assert "theta^4/8" in describe("sanders").text
    assert SANDERS.rigid_body_law.drilling(0.1, 1.0) == pytest.approx(-(0.1**4) / 8, rel=1e-2)


def test_an_unknown_name_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(UsageError, match=r"must be one of \d+, see footprint list; did you mean semicylinder.*\?"):
        describe("semicylindre")
    assert main(["show", "bicycle"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_the_list_is_aligned_with_a_meaning_each(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "scenes"]) == 0
    lines = capsys.readouterr().out.splitlines()
    start = {line.index(meaning_of(name)) for name, line in zip(SCENES, lines, strict=True)}
    assert start == {max(map(len, SCENES)) + 2}


def test_values_and_text_are_the_same_and_checked_alike() -> None:
    several, whole = Setting("x", None, "", "floats", 0, 20), Setting("x", None, "", "int", 0, 20)
    for value in ("5,10", [5, 10], (5.0, 10.0), np.array([5, 10])):
        assert several.parse(value) == (5, 10)
    assert several.parse(5) == (5,)
    for wrong in ([], None, [1, None], [[1, 2]], True, [10, 5], object(), {"a": 1}, "5,,10", [5, "a"]):
        with pytest.raises(UsageError, match=r"x = .* must be increasing numbers in \[0, 20\]"):
            several.parse(wrong)
    assert whole.parse(3) == whole.parse(3.0) == whole.parse("3") == whole.parse(np.int64(3)) == 3
    for wrong in (1.5, "1.5", [1, 2], True, "one", math.nan):
        with pytest.raises(UsageError, match="a whole number"):
            whole.parse(wrong)


def test_the_unit_is_what_the_key_ends_in() -> None:
    units = {"h_mm": "mm", "p_MPa": "MPa", "a_deg": "deg", "F_N": "N", "nu": "1"}
    assert {key: Setting(key, 1.0, "").unit for key in units} == units
    assert Setting("epsilon", 1.0, "", unit="MPa/mm").unit == "MPa/mm"


def test_a_default_as_it_is_printed_asks_for_the_same() -> None:
    for scene in SCENES.values():
        for setting in (*scene.settings, *settings_beside(scene)):
            if setting.default is not None:
                assert setting.parse(setting.default_text) == setting.parse(setting.default), setting.key


def test_the_uncertainty_of_a_limit_is_a_part_of_it() -> None:
    ladder = ladders_of(SCENES["ring"])[0]
    record = {
        "ladder": ladder.name,
        "quantity": "flat_half_length",
        "element": "refined",
        "mesh": "1x80",
        "verdict": "",
    }
    known = pd.DataFrame([{**record, "limit": -4.0, "uncertainty": 0.2}])
    actual = _limit("ring", "flat_half_length", SimpleNamespace(settings=ladder.settings), known)
    assert actual["limit_uncertainty"] == pytest.approx(0.05)

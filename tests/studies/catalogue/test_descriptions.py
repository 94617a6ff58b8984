"""``footprint show`` and ``list``: no part lacks a meaning, formulas are those of the tables."""

from __future__ import annotations

import math
import re
from fractions import Fraction

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from formulations.strains.catalogue import MEASURES, SANDERS
from formulations.strains.measure import EXACT_LAW, QuadraticMeasure, quadratic_measure
from formulations.strains.quantities import QUANTITIES, STRAINS
from studies.ask.scene import Setting, UsageError, has_contact, settings_beside
from studies.catalogue.descriptions import describe, meaning_of
from studies.cli import main
from studies.scenes import SCENES

NAMES = (*SCENES, *MEASURES, *ALGORITHMS)


def test_a_name_means_one_thing() -> None:
    assert len(set(NAMES)) == len(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_without_a_meaning(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    found = describe(name)
    assert found.meaning.strip()
    assert found.meaning in found.text
    assert list(found.settings.columns) == ["name", "meaning", "unit", "range", "default"]
    assert found.settings.map(lambda text: isinstance(text, str) and bool(text.strip())).all(axis=None)
    assert main(["show", name]) == 0
    assert capsys.readouterr().out == found.text + "\n"
    if name in SCENES:
        rubs = {"mu"} if has_contact(SCENES[name]) else set()
        slides = {"drag_mm", "drag_deg", "turn_deg"} if name in ("tyre", "panel") else set()
        assert set(found.settings["name"]) == {*(s.key for s in SCENES[name].settings), "tolerance"} | rubs | slides
        assert all(reference.source in found.text for reference in SCENES[name].references)
    else:
        assert "source" in found.text.lower()


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


@pytest.mark.parametrize("name", [name for name, m in MEASURES.items() if isinstance(m, QuadraticMeasure)])
def test_formulas_are_those_of_the_table(name: str) -> None:
    measure = MEASURES[name]
    q = np.random.default_rng(0).uniform(-0.5, 0.5, len(QUANTITIES))
    values = {quantity.rstrip("+"): value for quantity, value in zip(QUANTITIES, q, strict=True)}
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
    with pytest.raises(UsageError, match="must be one of tyre"):
        describe("bicycle")
    assert main(["show", "bicycle"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_the_list_is_aligned_with_a_meaning_each(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "scenes"]) == 0
    lines = capsys.readouterr().out.splitlines()
    start = {line.index(meaning_of(name)) for name, line in zip(SCENES, lines, strict=True)}
    assert start == {max(map(len, SCENES)) + 2}


@pytest.mark.parametrize(
    ("value", "parsed"),
    [("5,10", (5, 10)), ([5, 10], (5, 10)), ((5.0, 10.0), (5, 10)), (np.array([5, 10]), (5, 10)), (5, (5,))],
)
def test_values_and_text_are_the_same(value: object, parsed: object) -> None:
    assert Setting("x", None, "", "floats", 0, 20).parse(value) == parsed


@pytest.mark.parametrize("value", [[], None, [1, None], [[1, 2]], True, [10, 5], object(), {"a": 1}, "5,,10", [5, "a"]])
def test_values_are_checked_like_text(value: object) -> None:
    with pytest.raises(UsageError, match=r"x = .* must be increasing numbers in \[0, 20\]"):
        Setting("x", None, "", "floats", 0, 20).parse(value)


@pytest.mark.parametrize("value", [1.5, "1.5", [1, 2], True, "one", math.nan])
def test_a_whole_number_is_one(value: object) -> None:
    setting = Setting("x", None, "", "int", 0, 20)
    assert setting.parse(3) == setting.parse(3.0) == setting.parse("3") == setting.parse(np.int64(3)) == 3
    with pytest.raises(UsageError, match="a whole number"):
        setting.parse(value)


def test_the_unit_is_what_the_key_ends_in() -> None:
    units = {"h_mm": "mm", "p_MPa": "MPa", "a_deg": "deg", "F_N": "N", "nu": "1"}
    assert {key: Setting(key, 1.0, "").unit for key in units} == units
    assert Setting("epsilon", 1.0, "", unit="MPa/mm").unit == "MPa/mm"


@pytest.mark.parametrize("name", SCENES)
def test_a_default_as_it_is_printed_asks_for_the_same(name: str) -> None:
    scene = SCENES[name]
    for setting in (*scene.settings, *settings_beside(scene)):
        if setting.default is not None:
            assert setting.parse(setting.default_text) == setting.parse(setting.default), setting.key

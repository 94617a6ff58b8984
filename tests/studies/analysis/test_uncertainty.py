"""The error budget of the ring and stated errors, on numbers that are made up, where every part is known."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from studies.analysis.uncertainty import PARTS, axial_states, error_budget, error_statements, input_effects
from studies.experiments.solid_laws import crushed_ring_study
from studies.scenes.contact.crushed_ring import FILE, READING
from studies.scenes.data import read_reference
from support.stores.experiments import FACTORS, LEFT, SLOPES, made_up_ring

TABLE = read_reference(FILE)
END = TABLE.iloc[-1]


@pytest.fixture(scope="module")
def study() -> pd.DataFrame:
    return made_up_ring()


@pytest.fixture(scope="module")
def budget(study: pd.DataFrame) -> pd.DataFrame:
    return error_budget(study)


def adds_up(budget: pd.DataFrame) -> bool:
    return bool(np.allclose(budget[list(PARTS)].sum(axis=1), budget["difference_N"], rtol=0, atol=1e-12))


def at_end(budget: pd.DataFrame, body: str) -> pd.Series:
    return budget[(budget["body"] == body) & (budget["delta_mm"] == END["delta_mm"])].iloc[0]


def test_parts_add_up(budget) -> None:
    assert len(budget) == len(FACTORS) * len(TABLE)
    assert adds_up(budget)
    assert budget["difference_N"].tolist() == (budget["force_N"] - budget["measured_N"]).tolist()


def test_every_part_is_the_one_that_was_made(budget) -> None:
    D, shell = END["measured_N"], at_end(budget, "shell exact")
    assert shell["mesh"] == pytest.approx(LEFT / 64**2, rel=1e-9)
    assert shell["shell"] == pytest.approx((0.91 - 0.9) * D, rel=1e-9)
    assert shell["law"] == pytest.approx((0.9 - 1.02) * D, rel=1e-9)
    assert shell["friction"] == pytest.approx(-(33.480 / 32.856 - 1) * 1.02 * D, rel=1e-9)
    assert shell["reading"] == pytest.approx(0.0, abs=1e-9)  # the chord ends there
    assert shell["remainder"] == pytest.approx(0.02 * D - shell["friction"], rel=1e-9)
    solid = at_end(budget, "solid neo-hooke")
    assert (solid["shell"], solid["law"]) == (0.0, pytest.approx(-0.02 * D, rel=1e-9))


def test_reading_is_the_bend_over_the_chord(study) -> None:
    """Half a newton more than the straight line at the first travel alone."""
    first = TABLE["delta_mm"].iloc[0]
    bent = study.copy()
    bent.loc[
        (bent["body"] == "solid hencky") & (bent["delta_mm"] == first) & (bent["study"] == "meshes"), "force_N"
    ] += 0.5
    before, after = (error_budget(each).set_index(["body", "delta_mm"]) for each in (study, bent))
    rise = (after["reading"] - before["reading"]).xs("shell exact", level="body")
    assert rise.to_numpy() == pytest.approx([0.5, 0, 0, 0], abs=1e-9)


def test_uncertainties_are_standard_ones(budget, study) -> None:
    row = at_end(budget, "shell exact")
    inputs = np.sqrt(sum(slope**2 for slope in SLOPES.values()) / 3) * row["force_N"]
    parts = (1.25 * LEFT / 64**2 / 2, inputs, row["friction"] / np.sqrt(3), READING / np.sqrt(3))
    assert row["u_val"] == pytest.approx(np.sqrt(np.sum(np.square(parts))), rel=1e-6)
    assert (budget["within"] == (budget["difference_N"].abs() <= budget["u_val"])).all()
    assert set(budget["within"]) == {True}  # data known that badly excuse everything
    exact_data = study.assign(force_N=study["force_N"].where(study["study"] != "inputs", 1.0))
    assert not error_budget(exact_data).query("body == 'shell exact'")["within"].all()


def test_wrong_reasons_are_named(budget) -> None:
    """von-karman with nu = 0 is 1 % off the test and 11 % off its solid; the other one is off both."""
    assert set(budget[budget["wrong_reason"]]["body"]) == {"shell von-karman, ν = 0"}


def test_states_are_compared_on_one_mesh(study) -> None:
    assert axial_states(study)["off"].to_numpy() == pytest.approx(np.full(4, -0.25), rel=1e-12)


def test_effects_are_those_of_the_data(study) -> None:
    effects = input_effects(study).drop_duplicates("input").set_index("input")["relative"]
    assert effects.to_dict() == pytest.approx({key: abs(slope) / np.sqrt(3) for key, slope in SLOPES.items()})


@pytest.mark.slow
def test_the_ring_itself() -> None:
    """What the page says of the test, on meshes coarser than those of the page."""
    budget = error_budget(crushed_ring_study(((16, 2), (24, 3), (32, 4)), (32, 64, 128)))
    assert adds_up(budget)
    hencky = budget[budget["body"] == "solid hencky"]
    assert np.all((hencky["limit_N"] / hencky["measured_N"] - 1).abs()[1:] <= 0.03)
    shell = at_end(budget, "shell exact")
    assert abs(shell["shell"] / shell["limit_N"]) <= 0.015
    assert shell["law"] / shell["measured_N"] == pytest.approx(-0.10, abs=0.01)
    assert not shell["within"]
    karman = at_end(budget, "shell von-karman, ν = 0")
    assert karman["wrong_reason"]
    assert -karman["shell"] / karman["law"] > 1  # of the law's part
    assert at_end(budget, "solid hencky")["within"]


def row(asked: float, **values: object) -> dict[str, object]:
    usual = {"scene": "flat", "settings": "", "quantity": "w", "asked": asked, "reached": True, "reason": ""}
    usual |= {"stated": 1.0, "uncertainty": 0.01, "low": 0.0, "high": 0.02, "unknowns": 100, "cost": 2.0}
    usual |= {"true": 1.0, "known": 1e-4, "decided": True, "inside": True, "off": 5e-3}
    usual |= {"value_error": 0.01, "value_decided": True, "value_inside": True}
    return usual | values


def test_statements_are_counted_by_error_and_once_where_they_are_the_same() -> None:
    table = pd.DataFrame(
        [
            row(0.05),
            row(0.05, quantity="N", value_inside=False, value_error=0.04, inside=False, off=0.02, cost=5.0),
            row(0.05, quantity="M", value_decided=False, cost=math.nan),
            row(0.05, scene="round", uncertainty=1e-14),
            row(0.01),
            row(0.01, quantity="N", reached=False, reason="too many"),
            row(0.01, quantity="M", unknowns=200, uncertainty=0.005, off=1e-3, value_error=0.004),
        ]
    )
    coarse, fine, whole = error_statements(table).to_dict("records")
    assert (coarse["asked_for"], coarse["reached"], coarse["statements"], coarse["expensive"]) == (4, 4, 3, 1)
    assert (coarse["priced"], coarse["cost"]) == (2, 3.5)
    assert (coarse["decided"], coarse["inside"], coarse["limit_decided"], coarse["limit_inside"]) == (2, 1, 3, 2)
    assert coarse["wide"] == pytest.approx((2 + 0.5) / 2)
    assert coarse["limit_wide"] == pytest.approx(2)
    assert (fine["asked_for"], fine["reached"], fine["decided"]) == (3, 2, 2)
    assert fine["wide"] == pytest.approx((2 + 5) / 2)
    assert math.isnan(whole["asked"])
    assert (whole["statements"], whole["decided"], whole["inside"]) == (4, 3, 2)
    assert whole["wide"] == pytest.approx(2)

"""What the tables of friction come to: ends, orders and sums by algorithm of made-up tables with known answers."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from studies.analysis.everything import DECLARED, fitted
from studies.analysis.friction import by_algorithm, ends, orders, step_orders
from studies.experiments.friction.bars import capstan_table
from support.stores.friction import DRAGS, LOST, NAIVE, SOFT, TURNS, agreement, made_up_friction, moved, steps

FAMILIES = DECLARED["friction_orders"]


def test_a_drag_is_full_from_where_it_stays_within_a_hundredth_of_its_bound() -> None:
    found = ends(moved("drag_mm", DRAGS), "drag_mm")
    assert list(found["full"]) == [8.0, 8.0]  # 0.98 of the bound is not enough
    assert list(found["loose"]) == [8.0, 8.0]
    assert list(found["off"]) == [0.0, 0.0]
    assert list(found["largest"]) == [250.0, 500.0]
    assert list(found["certified"]) == [4, 4]
    assert found["command"][1].endswith("--set mu=0.5 --set drag_mm=1,2,8 --set drag_deg=90 --out DIR")


def test_a_turn_is_measured_by_the_chord_of_its_last_step() -> None:
    """The last step is of 10 degrees; whoever sticks in the centre sticks for ever."""
    found = ends(moved("turn_deg", TURNS), "turn_deg")
    np.testing.assert_allclose(found["off"], 0.0, atol=1e-15)
    assert list(found["loose"]) == [2.0, 2.0]
    assert "drag_deg" not in found["command"][0]


def test_what_does_not_hold_at_the_end_holds_from_nowhere() -> None:
    table = moved("drag_mm", DRAGS)
    table.loc[table["drag_mm"] == 8.0, ["friction_N", "sticking"]] = (100.0, 1)
    table.loc[1, "failures"] = "cone"
    found = ends(table, "drag_mm")
    assert found["full"].isna().all()
    assert found["loose"].isna().all()
    assert list(found["certified"]) == [3, 4]


def test_orders_are_those_that_errors_were_made_with() -> None:
    found = orders("strip", made_up_friction()["friction_strip"], **FAMILIES["strip"]).set_index("quantity")
    assert found["order"].drop("front").round(9).to_dict() == {"end": 2.0, "back": 2.0, "loop": 2.0, "counted": 1.0}
    assert math.isnan(found.loc["front", "order"])  # rounding
    assert found.loc["end", "error"] == pytest.approx(0.1 / 80**2)


def test_an_error_below_the_floor_on_one_mesh_has_no_order() -> None:
    table = made_up_friction()["friction_path"]
    table.loc[2, "end_error"] = 1e-9
    found = orders("path", table, **FAMILIES["path"]).set_index("quantity")["order"]
    assert math.isnan(found["end"])
    assert found["work"] == pytest.approx(1.0)


def test_families_name_columns_that_the_experiments_make() -> None:
    table = capstan_table(((0.2, 1.0),), (4, 8), ("on",))
    found = orders("capstan", table, **FAMILIES["capstan"])
    assert found["order"][0] == pytest.approx(2.0, abs=0.2)
    made = made_up_friction()
    for name, of in FAMILIES.items():
        assert {*of["cases"], of["of"], *of["theory"]} - {"front_error"} <= set(made[f"friction_{name}"])


def test_the_order_of_steps_needs_no_limit() -> None:
    found = step_orders(steps().drop(columns="cpu_s"))
    np.testing.assert_allclose(found["order"], 1.0)
    assert list(found["first_error"]) == [-0.04, 1.0]
    shifted = steps().assign(friction_N=lambda t: t["friction_N"] + 7.0)
    np.testing.assert_allclose(step_orders(shifted)["order"], 1.0)


def test_failures_and_other_steps_are_counted_and_are_in_no_median() -> None:
    found = by_algorithm(agreement()).set_index("algorithm")
    counts = found.loc[NAIVE, ["cases", "solved", "failed", "agrees", "other_steps", "both"]]
    assert counts.tolist() == [3, 2, 1, 1, 1, 1]
    assert found.loc[NAIVE, "iterations_ratio"] == 3.0
    assert found.loc[SOFT, ["exact", "agrees"]].tolist() == [0, 0]
    assert found.loc["qp", "operations_ratio"] == 1.5
    refused = agreement()
    refused.loc[(refused["case"] == LOST) & (refused["algorithm"] == NAIVE), "outcome"] = "unsupported"
    assert by_algorithm(refused).set_index("algorithm").loc[NAIVE, ["refused", "failed"]].tolist() == [1, 0]


def test_tables_are_made_of_those_that_are_there() -> None:
    made = fitted(made_up_friction().get)
    assert set(made) == {
        *("friction_drag_ends", "friction_turn_ends", "friction_orders", "friction_step_orders", "friction_algorithms")
    }
    assert set(made["friction_orders"]["family"]) == set(FAMILIES)
    assert isinstance(made["friction_algorithms"], pd.DataFrame)

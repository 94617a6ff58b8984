"""What is said of stated errors, on tables that are made up."""

from __future__ import annotations

import math

import pandas as pd
import pytest

from studies.analysis.comparisons.error_statements import error_statements


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

"""Observed orders of manufactured solutions: every measure, surface and element, with contact, and what is planted."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

from formulations.strains.catalogue import MEASURES
from formulations.strains.quantities import STRAINS
from studies.analysis.powers import CASE, THEORY, contact_orders, distortion_orders, manufactured_orders, orders
from studies.experiments.manufactured import (
    MESHES,
    Case,
    cases,
    distortion,
    errors_of,
    manufactured,
    manufactured_contact,
    statements,
)
from studies.scenes.complete import complete as resolve
from studies.scenes.manufactured import statements as stated
from studies.scenes.manufactured.statements import STATEMENTS, wrong_coefficients
from studies.solving.solve import solve

WITHIN = {"order_displacement": 0.1, "order_resultants": 0.1, "order_mean_resultants": 0.2, "order_energy": 0.1}
CONTACT_SAMPLE = ("exact", "linear", "elongation")
SAMPLE = [
    ("exact", "inner-torus", "refined"),
    ("exact", "torus", "arc"),
    ("donnell", "torus", "paper"),
    ("elongation", "cylinder", "paper"),
]


def off(table: pd.DataFrame) -> dict[str, float]:
    """The largest distance of each order from its theory."""
    return {name: float((table[name] - THEORY[name.replace("order_", "error_")]).abs().max()) for name in WITHIN}


@pytest.mark.parametrize(("measure", "surface", "element"), SAMPLE)
def test_a_sample_has_the_orders_of_theory(measure: str, surface: str, element: str) -> None:
    rows = list(errors_of(Case("sample", measure, surface, element), (6, 12)))
    actual = manufactured_orders(pd.DataFrame(rows))
    assert actual["near"].all()
    assert off(actual)["order_resultants"] < WITHIN["order_resultants"]


@pytest.mark.slow
def test_moved_nodes_keep_the_order_of_a_measure_whose_shears_are_no_vector() -> None:
    actual = distortion_orders(distortion(("novozhilov",), (8, 16)))
    assert actual["order_displacement"].between(1.9, 2.1).all()
    assert actual["times"].max() < 1.3


@pytest.mark.slow
def test_moved_nodes_keep_the_orders_of_all_measures() -> None:
    actual = distortion_orders(distortion(meshes=(16, 32)))
    assert actual["order_displacement"].between(1.9, 2.05).all()


@pytest.mark.slow
def test_mean_resultants_are_of_the_first_order_on_random_and_trapezoidal_meshes() -> None:
    actual = distortion_orders(distortion(("exact",), (32, 64)))
    smooth = actual["distortion"].isin(("regular", "skew"))
    assert actual[smooth]["order_mean_resultants"].between(1.9, 2.1).all()
    assert actual[~smooth]["order_mean_resultants"].between(0.9, 1.1).all()


@pytest.mark.slow
def test_all_have_the_orders_of_theory() -> None:
    """9 measures x 3 surfaces x 2 elements, and every surface, option of the element, wall and a large rotation."""
    data = manufactured()
    actual = manufactured_orders(data)
    measures = actual[actual["group"] == "measures"]
    assert len(measures) == 9 * 3 * 2
    assert len(actual) == sum(1 for _ in cases())
    assert actual["near"].all()
    assert {name: value for name, value in off(actual).items() if value > WITHIN[name]} == {}
    assert statements()["wrong"].eq("").all()


@pytest.mark.slow
def test_contact_has_its_orders(monkeypatch: pytest.MonkeyPatch) -> None:
    """Displacement 2; pressure and edge 1, the edge off by half an element; the page has all nine measures."""
    monkeypatch.setattr("studies.experiments.manufactured.MEASURES", CONTACT_SAMPLE)
    monkeypatch.setattr("studies.experiments.manufactured.MESHES", (12, 24))
    data = manufactured_contact()
    actual = contact_orders(data)
    assert set(actual["measure"]) == set(CONTACT_SAMPLE)
    assert data["class"].eq("converged").all()
    exact = actual[actual["measure"] == "exact"]
    assert exact["order_displacement"].between(1.9, 2.1).all()
    assert actual["order_displacement"].median() > 1.9
    assert actual["order_pressure"].median() > 0.95
    assert actual["order_edge"].median() > 0.95
    assert actual["edge_elements"].max() < 0.6


@pytest.mark.slow
def test_contact_converges() -> None:
    """The judge agrees, and errors fall."""
    by_name = {}
    for n in (8, 24):
        result = solve(*resolve("manufactured-contact", {"radius": "0.5"}, f"{n}x{n}"))
        assert result.verdict == "converged"
        by_name[n] = result.quantities
    coarse, fine = by_name[8], by_name[24]
    assert 1.9 < np.log(coarse["error_displacement"] / fine["error_displacement"]) / np.log(3) < 2.1
    assert fine["error_pressure"] < 0.5 * coarse["error_pressure"]
    assert fine["error_edge"] < 0.5 * coarse["error_edge"]


@pytest.mark.slow
def test_a_planted_coefficient_stops_the_convergence_and_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """1 % on the drilling terms of Sanders' E22."""
    sanders = MEASURES["sanders"]
    quadratic = sanders.quadratic.copy()
    quadratic[STRAINS.index("E22+")] *= 1.05
    monkeypatch.setitem(MEASURES, "sanders", replace(sanders, quadratic=quadratic))
    actual = manufactured_orders(pd.DataFrame(errors_of(Case("planted", "sanders", "torus"), (6, 12, 24))))
    assert not actual["near"].any()
    assert actual["order_displacement"].iloc[0] < 1.5
    named = {(wrong.strain, wrong.monomial) for wrong in wrong_coefficients(MEASURES["sanders"], STATEMENTS["sanders"])}
    assert named == {("E22+", pair) for pair in ("t2+ t2+", "w1+ w1+", "w2+ w2+", "w1+ w2+")}


def test_a_statement_that_differs_stops_the_convergence(monkeypatch: pytest.MonkeyPatch) -> None:
    """The loads are those of the statement, not of the table."""
    monkeypatch.setattr(stated, "STATEMENTS", {**STATEMENTS, "von-karman": stated.sanders})
    actual = manufactured_orders(pd.DataFrame(errors_of(Case("planted", "von-karman", "torus"), (6, 12))))
    assert not actual["near"].any()


def test_orders_are_exponents() -> None:
    """3 n^-2 and 5 n^-1, on meshes in any order; what has not converged is not near."""
    rows = [
        dict(zip(CASE, ("g", name, "s", "e", ""), strict=True))
        | {"n": n, "class": outcome}
        | {error: (3 if order == 2 else 5) * n**-order for error, order in THEORY.items()}
        for name, outcome in (("good", "converged"), ("bad", "wrong"))
        for n in (32, 8, 16)
    ]
    table = manufactured_orders(pd.DataFrame(rows)).set_index("measure")
    assert list(table["near"]) == [True, False]
    np.testing.assert_allclose(table.loc["good", list(WITHIN)].astype(float), list(THEORY.values()), atol=1e-12)
    assert table.loc["good", "change_displacement"] == pytest.approx(0)
    assert not table["coarse"].any()
    assert table.loc["good", "error_displacement"] == 3 / 32**2
    kinked = pd.DataFrame({"measure": "m", "n": [1, 2, 4], "error_a": [8.0, 4.0, 1.0]})
    assert orders(kinked, ["measure"], ["error_a"])[["order_a", "change_a"]].to_numpy().tolist() == [[2.0, 1.0]]


def test_meshes_are_halved() -> None:
    assert [b / a for a, b in pairwise(MESHES)] == [2, 2]

"""The page of two faces: errors with their orders, requests without an answer, algorithms and costs."""

from __future__ import annotations

from types import SimpleNamespace

from reports.chapters.faces import errors, faces_page
from support.stores.experiments import LOST, SIDES, made_up_faces, pairings


def page() -> str:
    made = made_up_faces()
    return str(faces_page(SimpleNamespace(table=made.__getitem__)))


def test_an_error_stands_with_its_order_and_a_dash_where_there_is_one_slave_only() -> None:
    said = page()
    finest = f"1x{SIDES[-1]}"
    assert f"| two rings | `P_over_ER` | {finest} | 0.03 % | 0.10 % (2.0) | -0.10 % (2.0) | cap-hit | cap-hit |" in said
    assert f"| ring on itself | `P_over_ER` | {finest} | 0.03 % | 0.10 % (2.0) | – | 3.12 % (1.0) | – |" in said


def test_requests_without_an_answer_are_counted_and_listed() -> None:
    said = page()
    assert "Of 9 requests 9 converged with `mortar`, and of as many 7 with `nodes`" in said
    assert said.count("| cap-hit | it is made up |") == 2
    assert "| two rings | `qp` | 2 | unsupported | made up |" in said


def test_algorithms_and_costs_are_beside_what_they_are_compared_with() -> None:
    said = page()
    assert "| ring on itself | 0 (10) | 1.0e-12 (10) | 1.0e-03 (10, 3 steps for 2) |" in said
    assert "| 1280 | 40 | 1.00 | 1.50 |" in said


def test_ironing_is_known_to_what_slabs_and_meshes_differ_by() -> None:
    said = page()
    assert "| solid | 1x120 | 320.0 | 77.0 | 400.0 | 154.0 | 0.385 | 0.010 |" in said
    assert "within 14.3 % of each other" in said
    assert "From 1x60 to 1x120 that of solids changes by 8.3 %" in said


def test_a_panel_is_drawn_for_each_quantity_and_no_point_of_what_failed() -> None:
    drawn = errors(pairings())()
    assert drawn.count("axes_2") == 1
    assert "axes_3" not in drawn
    assert LOST in pairings()["problem"].to_list()

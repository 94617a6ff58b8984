"""Decks as a reader of keywords sees them: whole sets, the loads of the problem, axes of plies."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from studies.exchange.deck import deck, plane_corners
from studies.exchange.of_scene import problem_of
from studies.exchange.problem import Problem

Keyword = tuple[str, list[list[str]]]


def keywords(lines: Iterator[str]) -> list[Keyword]:
    """Every keyword line without comments, with its data lines."""
    values: list[Keyword] = []
    for line in lines:
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            values.append((line, []))
        else:
            values[-1][1].append([word.strip() for word in line.split(",") if word.strip()])
    return values


def data(found: list[Keyword], begins: str) -> list[list[str]]:
    return [row for name, rows in found if name.startswith(begins) for row in rows]


@pytest.fixture(scope="module")
def hemisphere() -> Problem:
    return problem_of("hemisphere", {}, "4x4")


@pytest.fixture(scope="module")
def tyre() -> Problem:
    return problem_of("tyre", {"delta_mm": "5,10"}, "8x8")


def test_mesh_and_sets_are_whole(tyre: Problem) -> None:
    actual = keywords(deck(tyre))
    assert max(len(word) for _, rows in actual for row in rows for word in row[1:]) <= 20  # as CalculiX reads them
    nodes = {int(row[0]): np.array(row[1:], float) for row in data(actual, "*NODE, NSET=BODY")}
    np.testing.assert_allclose(np.array([nodes[i + 1] for i in range(len(nodes))]), tyre.bricks.x, rtol=1e-11)
    rows = data(actual, "*ELEMENT, TYPE=C3D20R")
    flat = np.array([int(word) for row in rows for word in row]).reshape(-1, 21)
    np.testing.assert_array_equal(flat[:, 1:] - 1, tyre.bricks.elements)
    plies = [int(word) for k in range(1, 5) for row in data(actual, f"*ELSET, ELSET=PLY_{k}") for word in row]
    assert sorted(plies) == list(range(1, len(flat) + 1))
    for name, elements in (("INNER", tyre.bricks.inner), ("OUTER", tyre.bricks.outer)):
        own = [int(word) for row in data(actual, f"*ELSET, ELSET=ON_{name}") for word in row]
        np.testing.assert_array_equal(np.array(own) - 1, elements)


def test_every_step_has_all_its_loads(hemisphere: Problem) -> None:
    values = [rows for name, rows in keywords(deck(hemisphere)) if name.startswith("*CLOAD")]
    assert len(values) == len(hemisphere.steps)
    turned = set((hemisphere.supports.nodes[hemisphere.supports.turned] + 1).tolist())
    for rows, step in zip(values, hemisphere.steps, strict=True):
        total = np.zeros(3)
        for node, axis, value in rows:
            assert int(node) not in turned
            total[int(axis) - 1] += float(value)
        np.testing.assert_allclose(total, step.forces.sum(axis=0), atol=1e-9)


def test_a_load_that_ends_is_told_to_be_nothing(hemisphere: Problem) -> None:
    """Else it would stay; and no load is taken away, to grow from nothing again."""
    first, *_, last = hemisphere.steps
    ended = replace(hemisphere, steps=(first, replace(last, forces=np.zeros_like(last.forces))))
    loads = [(name, rows) for name, rows in keywords(deck(ended)) if name.startswith("*CLOAD")]
    assert [name for name, _ in loads] == ["*CLOAD", "*CLOAD"]
    assert [row[:2] for row in loads[0][1]] == [row[:2] for row in loads[1][1]]
    assert {float(row[2]) for row in loads[1][1]} == {0.0}


def test_the_pressure_is_on_every_inner_face_and_pushes_into_the_wall() -> None:
    problem = problem_of("pressurised-sphere", {}, "3x3")
    *_, last = [rows for name, rows in keywords(deck(problem)) if name.startswith("*DLOAD")]
    assert [int(row[0]) - 1 for row in last] == problem.bricks.inner.tolist()
    assert {row[1] for row in last} == {"P1"}
    np.testing.assert_allclose([float(row[2]) for row in last], problem.steps[-1].pressure, rtol=1e-11)
    assert np.all(problem.steps[-1].pressure > 0)


def test_supports_along_turned_axes_are_held_in_them() -> None:
    """The far edge of a sector of a cylinder slides in a plane that is not a coordinate plane."""
    problem = problem_of("pressurised-cylinder", {}, "2x3")
    actual = keywords(deck(problem))
    turned = [int(word) for row in data(actual, "*NSET, NSET=TURNED") for word in row]
    assert sorted(turned) == sorted((problem.supports.nodes[problem.supports.turned] + 1).tolist())
    x = problem.bricks.x[np.array(turned) - 1]
    np.testing.assert_allclose(np.arctan2(x[:, 1], x[:, 0]), np.pi / 6)
    held = next(rows for name, rows in actual if name == "*BOUNDARY")
    assert len(held) == sum(problem.supports.held.sum(axis=1))


def test_fibres_lie_along_their_angle(tyre: Problem) -> None:
    actual = keywords(deck(tyre))
    for number, ply in enumerate(tyre.materials, 1):
        rows = np.array([row for row in data(actual, f"*DISTRIBUTION, NAME=AXES_{number},") if len(row) == 7], float)
        own = rows[:, 0].astype(int) - 1
        assert set(tyre.bricks.ply[own]) == {number - 1}
        first, second = rows[:, 1:4], rows[:, 4:]
        np.testing.assert_allclose(np.sum(first * second, axis=1), 0, atol=1e-11)
        meridian, parallel = tyre.bricks.frame[own, 0], tyre.bricks.frame[own, 1]
        np.testing.assert_allclose(np.sum(first * meridian, axis=1), np.cos(ply.angle), atol=1e-11)
        np.testing.assert_allclose(np.sum(first * parallel, axis=1), np.sin(ply.angle), atol=1e-11)


def test_constants_are_in_their_places(tyre: Problem) -> None:
    rows = data(keywords(deck(tyre)), "*ELASTIC, TYPE=ENGINEERING CONSTANTS")
    settings = tyre.request.settings
    E_L, E_T, G_LT, G_TT, nu_LT, nu_TT = (
        settings.number(key) for key in ("E_L_MPa", "E_T_MPa", "G_LT_MPa", "G_TT_MPa", "nu_LT", "nu_TT")
    )
    assert [float(word) for word in rows[0]] == [E_L, E_T, E_T, nu_LT, nu_LT, nu_TT, G_LT, G_LT]
    assert [float(word) for word in rows[1]] == [G_TT]


def test_the_plane_goes_where_its_steps_say(tyre: Problem) -> None:
    actual, plane = keywords(deck(tyre)), tyre.plane
    assert plane is not None
    corners = plane_corners(tyre, plane)
    np.testing.assert_allclose(corners[:4] @ plane.normal, plane.start)
    assert np.linalg.det(corners[[1, 3, 4]] - corners[0]) > 0  # a brick that is not inside out
    across = corners[:4] - plane.start * plane.normal
    assert np.min(np.linalg.norm(across, axis=1)) > np.max(np.linalg.norm(tyre.bricks.x[:, 1:], axis=1))
    travels = [np.array([float(r[3]) for r in rows]) for name, rows in actual if name == "*BOUNDARY" and len(rows) == 3]
    assert len(travels) == len(tyre.steps)
    for travel, step in zip(travels, tyre.steps, strict=True):
        assert plane.start + travel @ plane.normal == pytest.approx(step.offset)


def test_the_measure_says_large_displacements_and_a_single_row_is_integrated_fully() -> None:
    for mesh, measure, kind in (("6x1", "linear", "C3D20"), ("6x2", "exact", "C3D20R")):
        text = "\n".join(deck(problem_of("cantilever", {}, mesh, measure=measure)))
        assert re.findall(r"TYPE=(C3D20R?),", text) == [kind]
        assert ("NLGEOM" in text) is (measure == "exact")

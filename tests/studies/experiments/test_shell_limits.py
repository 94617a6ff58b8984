"""Shells against solids over the thickness: the bodies against closed forms, the ladder against made-up answers."""

import math

import numpy as np
import pytest

from formulations.section.laminate import Laminate, Ply
from studies.experiments.shell_limits import bending, pressed
from studies.experiments.shell_limits.bodies import DEFAULT, FULL_3D, REISSNER, USUAL, Answer, Solid, Variant
from studies.experiments.shell_limits.ladder import CASES, GOOD, Case, Ladder, rows_of
from studies.scenes.closed_forms.elasticity import golovin_turn, middle_deflection, ovalised
from studies.scenes.data import read_reference

RATIO = 0.2
PRINTED = 1.5e-3  # half a unit of the third digit


def test_solids_find_the_closed_forms() -> None:
    """Two that share nothing, hexahedra and stress functions; another wall is not within the same tolerance."""
    for solid, exact, n, within in (
        (pressed.TUBE.solid, pressed.TUBE.lame, 8, 1e-5),
        (pressed.BALL.solid, pressed.BALL.lame, 4, 5e-4),
        (bending.bar_solid, bending.bar_exact, 32, 1e-3),
        (bending.oval_solid, bending.oval_exact, 32, 1e-3),
        (bending.plate_solid, bending.plate_exact, 4, 5e-3),
    ):
        actual = solid(RATIO, n).values
        assert actual == pytest.approx(exact(RATIO), rel=within)
        assert actual != pytest.approx(exact(2 * RATIO), rel=within)


def test_closed_forms_of_thin_walls() -> None:
    """Navier's bar, and the inextensible ring: D w'''' ... gives R^4/(9 D) under a traction cos 2 theta."""
    E, nu, R, h = 7.0, 0.3, 2.0, 2e-2
    D = E * h**3 / (12 * (1 - nu**2))
    assert golovin_turn(R - h / 2, R + h / 2, E, nu) == pytest.approx(R / D, rel=1e-4)
    assert ovalised(R, R - h / 2, R + h / 2, E, nu) == pytest.approx(R**4 / (9 * D), rel=2e-2)


def test_the_plate_of_elasticity_rebuilds_paganos_table() -> None:
    for row in read_reference("pagano1970_sandwich_and_crossply.csv").to_dict("records"):
        assert bending.plate_exact(1 / row["S"])["w_bar"] == pytest.approx(row["wbar"], rel=PRINTED), row["S"]
    with pytest.raises(ValueError, match="middle surface"):
        middle_deflection((Ply.isotropic(1.0, 0.3, 0.5),) * 2, 10.0, 10.0, 1.0)


def test_the_tube_as_a_shell_has_the_answer_of_two_unknowns() -> None:
    """u = c + d z in plane strain, u/r taken as linear between the faces and the area as that of the middle."""
    E, nu, h = 1.0, pressed.NU, RATIO
    C = Ply.isotropic(E, nu, h).stiffness()
    C = C[np.ix_([1, 3], [1, 3])]  # hoop and across; nothing moves along the axis
    points, weights = np.polynomial.legendre.leggauss(20)
    z, w = h / 2 * points, h / 2 * weights

    def growth(hoop: np.ndarray, area: np.ndarray) -> float:
        """hoop (2, points): strain of c and of d."""
        B = np.stack([hoop, np.stack([0 * z, 1 + 0 * z])])  # (strain, unknown, point)
        K = np.einsum("spg,st,tqg,g->pq", B, C, B, w * area)
        return float(np.linalg.solve(K, (1 - h / 2) * np.array([1.0, -h / 2]))[0]) * E * h

    ends = np.array([-h / 2, h / 2])
    at_faces = np.stack([1 / (1 + ends), ends / (1 + ends)])
    share = z / h + 0.5
    as_shell = growth(at_faces[:, :1] * (1 - share) + at_faces[:, 1:] * share, np.ones_like(z))
    assert pressed.TUBE.shell(RATIO, 4, FULL_3D).values["growth"] == pytest.approx(as_shell, rel=1e-8)


def test_a_wall_of_sublayers_is_the_same_wall() -> None:
    ratio, n = 0.1, 4
    h = ratio * bending.SPAN
    lines = np.linspace(0.0, bending.SPAN, n + 1)
    tips = []
    for laminate in (Laminate.single(Ply.isotropic(bending.E, 0.3, h)), bending.layered(h, 1, 0.3)):
        body = Solid.over(bending.Plate(), lines, bending.STRIP, laminate).hold(1)
        for component in range(3):
            body = body.hold(component, body.mesh.on(0, 0.0))
        forces = body.traction(body.end(0), lambda x, at: np.broadcast_to([0.0, 0.0, 1 / h], x.shape))
        assert forces.sum(axis=0) == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
        tips.append(float(np.sum(forces * body.solve(forces)[0])))
    assert tips[0] == pytest.approx(tips[1], rel=1e-12)
    assert tips[0] == pytest.approx(4 * bending.SPAN**3 * 0.91 / (bending.E * h**3), rel=0.05)


def test_a_body_under_its_weight_weighs_what_it_does_and_is_pressed_on_cartesian_supports_only() -> None:
    lines = np.linspace(0, 1, 2), np.linspace(0, 1, 5)
    body = Solid.over(bending.cylinder(2.0), *lines, bending.wall(0.4, 0.3, USUAL))
    forces = body.body_force(lambda x, at: np.broadcast_to([3.0, 0.0, 0.0], x.shape))
    assert forces.sum(axis=0) == pytest.approx([3.0 * 2.0 * 0.4, 0.0, 0.0], rel=1e-5, abs=1e-12)
    with pytest.raises(ValueError, match="Cartesian axis"):
        pressed.solid_before(pressed.RigidPlane(pressed.AWAY, 3.0), body.hold(1), np.array([0]))


def made_up(n: int) -> Answer:
    """1 + 0.16/n^2: 1 % off with 4 elements, 0.25 % with 8."""
    return Answer({"w": 1 + 0.16 / n**2}, 10 * n)


def test_a_ladder_knows_its_limit_and_its_first_good_mesh() -> None:
    ladder = Ladder(made_up, (2, 4, 8, 16), 2.0)
    assert ladder.limit("w") == pytest.approx(1.0, abs=1e-14)
    assert ladder.left("w") == pytest.approx(0.16 / 256)
    assert ladder.cost("w")[0] == 80
    crooked = Ladder(lambda n: Answer({"w": {2: 1.0, 4: 1.1}.get(n, 1.0)}, n), (2, 4, 8, 16), 2.0)
    assert crooked.cost("w")[0] == 8  # 2 was good by luck
    assert math.isnan(Ladder(lambda n: Answer({"w": float(n)}, n), (1, 2), 2.0).cost("w")[0])
    assert made_up(4).values["w"] - 1 > GOOD > made_up(8).values["w"] - 1


def test_rows_say_what_is_off_and_to_what_that_is_known() -> None:
    def shell(ratio: float, n: int, variant: Variant) -> Answer:
        return Answer({"w": (1 + ratio**2 * variant.shear_correction) * made_up(n).values["w"]}, n)

    case = Case(
        *("made up", "", "h/R", (0.1, 0.2), shell, lambda ratio, n: made_up(n), (4, 8), (8, 16), "why"),
        variants=(REISSNER,),
        orders=(2.0, 2.0),
    )
    rows = list(rows_of(case))
    assert [row["variant"] for row in rows] == 2 * [DEFAULT, REISSNER.name]
    assert [row["error"] for row in rows] == pytest.approx([0.01, 0.01 / 1.2, 0.04, 0.04 / 1.2], abs=1e-12)
    assert rows[0]["known_to"] == pytest.approx(0.16 / 64 + 0.16 / 256)
    assert rows[0]["solid_unknowns"] == 80
    assert "solid_unknowns" not in rows[1]


def test_cases_differ_and_go_from_thin_to_thick() -> None:
    assert len({case.name for case in CASES}) == len(CASES)
    for case in CASES:
        assert list(case.ratios) == sorted(case.ratios)
        assert max(case.ratios) / min(case.ratios) >= 10
        assert min(len(case.shell_meshes), len(case.solid_meshes)) >= 2

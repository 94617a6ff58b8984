"""The public problems: the shipped table against itself, and the small ones again.

Every reference before the judge, state by state: what a table compares is an answer of its problem.

Bars with friction: the strip against closed forms of the bar and of its model, the drum against the capstan.
"""

from typing import Any

import numpy as np
import pandas as pd
import pytest

from contact.coulomb import State
from contact.interchange.friction_oracle import minimise
from contact.interchange.siconos import SiconosError
from contact.verify import judge
from studies.experiments.friction.bars import (
    DRUM_END,
    LENGTH,
    MESHES,
    N0,
    PULL,
    RADIUS,
    TAU,
    Bar,
    capstan_table,
    drum_table,
    front,
    strip_table,
)
from studies.experiments.friction.brush import BLOCKS, WAY, Parking, uneven
from studies.experiments.friction.public_problems import (
    ORACLE,
    UNDECIDED,
    Tried,
    algorithms,
    limited,
    public_table,
    read_any,
    rows,
    small,
    table,
)
from studies.experiments.friction.trusses import SQUEEZE, Wheel
from support.problems.differences import orders
from support.problems.frictional import with_mu


def test_the_shipped_table_is_what_its_module_tells() -> None:
    """Every problem by all, who is not tried with a reason; whoever claims an answer by the exact law is certified."""
    actual = public_table()
    tried, gone = actual[actual["outcome"] != UNDECIDED], actual[actual["outcome"] == UNDECIDED]
    taken = actual[actual["certified"] == "True"]
    assert (actual["problem"].nunique(), tried["problem"].nunique(), taken["problem"].nunique()) == (65, 62, 56)
    assert taken["algorithm"].value_counts().to_dict() == {
        **{"augmented-lagrangian": 45, "lcp": 42, ORACLE: 43, "semismooth": 46, "qp": 26, "trial-and-error": 18}
    }
    assert set(taken.loc[taken["algorithm"] != ORACLE, "agrees"]) == {"True", ""}
    assert (gone["reason"] != "").all()
    assert not set(gone["problem"]) & set(tried["problem"])
    assert set(tried.groupby("problem")["algorithm"].agg(tuple)) == {(ORACLE, *algorithms())}
    claims = actual[(actual["outcome"] == "converged") & ~actual["reason"].str.startswith("by its own law")]
    assert len(claims) > 200
    assert (claims["certified"] == "True").all()
    own = actual[actual["algorithm"] == ORACLE]
    assert (own.loc[own["certified"] != "True", "reason"] != "").all()


@pytest.mark.slow
@pytest.mark.parametrize("names", [slice(0, None, 2), pytest.param(slice(1, None, 2), marks=pytest.mark.slow)])
def test_small_problems_come_out_as_in_the_table(names: slice) -> None:
    kept = public_table().set_index(["problem", "algorithm"])
    for name, problem in list(small().items())[names]:
        for row in rows(name, problem, 60.0):
            for column in ("outcome", "certified", "agrees"):
                assert str(row[column]) == str(kept.loc[(name, row["algorithm"]), column]), (name, row)


def test_one_contact_by_hand() -> None:
    """W = 1, q = (-1, 1, 3), mu = 0.1 of FrictionContact3D_1c: f = 1, slip along (1, 3), friction against it."""
    problem = small()["FrictionContact3D_1c.dat"]
    assert problem.W is not None
    actual = minimise(problem.step())
    f = actual.normal[0]
    direction = actual.friction[0] / np.linalg.norm(actual.friction[0])
    ways = problem.W @ np.array([f, *actual.friction[0]]) + problem.offset
    assert actual.state.tolist() == [State.SLIP]
    assert ways[0] == pytest.approx(0, abs=1e-12)
    assert np.linalg.norm(actual.friction[0]) == pytest.approx(problem.mu[0] * f, rel=1e-12)
    assert direction @ ways[1:] == pytest.approx(-np.linalg.norm(ways[1:]), rel=1e-12)


def test_a_solve_that_does_not_end_stops_nothing() -> None:
    def endless() -> Tried:
        while True:
            pass

    actual = limited(endless, 0.1)
    assert (actual.outcome, actual.reason) == ("time limit", "more than 0.1 s")
    assert limited(lambda: Tried("none"), 0.1).outcome == "none"


def test_files_that_are_none_are_told(tmp_path) -> None:
    (tmp_path / "none.dat").write_text("0 0 0")
    (tmp_path / "none.hdf5").write_bytes(b"\x89HDF\r\n\x1a\n")
    with pytest.raises((SiconosError, OSError)):
        read_any(tmp_path / "none.hdf5")
    (tmp_path / "none.hdf5").unlink()
    actual = table([tmp_path])
    assert actual["outcome"].tolist() == [UNDECIDED]
    assert "the file is not a frictional problem" in actual["reason"][0]


def _models() -> dict[str, tuple[Any, list[float], np.ndarray]]:
    """Bodies, loads, and anchors at rest."""
    strip = Bar(13, LENGTH, 1.0, press=TAU)
    drum = Bar(13, 2 * RADIUS, 0.5, curvature=-1 / RADIUS, tension=-N0, driven=True)
    block, spun, disc = BLOCKS["normal force swells"].brush, uneven(4), Parking("parabolic", 0.5)
    parked, wheel = disc.brush(7), Wheel(24, 0.1, SQUEEZE)
    return {
        "strip": (strip, [PULL, 0.0, -PULL, PULL], strip.rest.anchors),
        "drum": (drum, [-0.02, -10.0], drum.rest.anchors),
        "block": (block, [WAY * k / 6 for k in range(1, 7)], block.candidates.reference),
        "spun": (spun, [0.1, 0.2, 0.3], spun.candidates.reference),
        "parked": (parked, [disc.phi, -disc.phi], parked.candidates.reference),
        "rolled": (wheel, [-0.5, 0.0, 2.0, 4.0, 6.0], np.tile(wheel.truss.nodes[:-1], (2, 1))),
    }


MODELS = _models()


@pytest.mark.parametrize("name", MODELS)
def test_every_state_passes_the_judge(name: str) -> None:
    model, loads, anchors = MODELS[name]
    states = model.follow(loads)
    assert len(states) == len(loads)
    for state in states:
        problem, actual = model.stage_at(state.load, anchors).problem, state.solution
        assert judge(problem, actual.u, actual.pressure, actual.rubbed.force).failures() == []
        anchors = state.anchors


def test_the_judge_would_see_less_friction() -> None:
    """The last state of the strip, its coefficient a little smaller in the problem than in the answer."""
    model, loads, anchors = MODELS["strip"]
    state = model.follow(loads[:1])[0]
    problem, actual = model.stage_at(state.load, anchors).problem, state.solution
    smoother = with_mu(problem, 0.999 * problem.coulomb.mu)
    assert "cone" in judge(smoother, actual.u, actual.pressure, actual.rubbed.force).failures()


ROUNDING = 1e-9


def exact_but_for_the_mesh(table: pd.DataFrame) -> None:
    """What holds on any mesh: the reading of the front, and the closed form of the model."""
    assert (table["outcome"] == "converged").all()
    assert (table["least_N_mm"] >= 0).all()
    np.testing.assert_allclose(table["front_mm"], 40.0, rtol=ROUNDING)
    for name in ("end", "loop"):
        np.testing.assert_allclose(table[f"{name}_error"], table[f"discrete_{name}_error"], rtol=0, atol=ROUNDING)


@pytest.mark.slow
def test_the_error_of_the_strip_follows_from_where_its_front_lies() -> None:
    """And load steps of one sense change nothing."""
    table = strip_table((10, 13, 16), (1,))
    exact_but_for_the_mesh(table)
    q, offset = 0.4 * table["elements"], np.array([0.0, 0.2, 0.4])
    np.testing.assert_allclose(table["offset"], offset, atol=ROUNDING)
    np.testing.assert_allclose(table["counted_error"], -(offset + 0.5) / q, rtol=1e-6)
    np.testing.assert_allclose(table["end_error"], -((offset / q) ** 2), atol=ROUNDING)
    steps = strip_table((8,), (1, 2)).drop(columns=["steps", "iterations", "outcome", "least_N_mm"])
    np.testing.assert_allclose(steps.iloc[1], steps.iloc[0], rtol=1e-8, atol=ROUNDING)


def test_the_front_is_read_where_a_parabola_has_its_vertex() -> None:
    """Also off the nodes, where slip ends at its root before it; and under any uniform friction."""
    bar = Bar(20, 100.0, 1.0, press=TAU)
    x = 5.0 * np.arange(21)
    for zone in (40.0, 43.3, 46.0):
        slip = np.maximum((x - 100 + zone) ** 2 - 1.7, 0.0) * (x > 100 - zone)
        assert front(bar, slip) == pytest.approx(zone)
        assert front(bar, -3 * slip) == pytest.approx(zone)


@pytest.mark.slow
def test_drum_and_capstan() -> None:
    """Partial slip within a thousandth. In gross slip the ratio is that of its own recursion, (1 + a/2)/(1 - a/2) a
    node with a = mu theta/n, by both readings.
    """
    assert pytest.approx(0.03151163, abs=5e-9) == DRUM_END
    drum = drum_table((18,))
    assert (drum["outcome"] == "converged").all()
    assert (drum["end_error"].abs() < 1e-3).all()
    assert (drum["slip_error"].abs() < 5e-3).all()
    table = capstan_table(meshes=(10,))
    assert set(table["side"]) == {"on", "inside"}
    assert (table["outcome"] == "converged").all()
    assert (table["slipping"] == 11).all()
    assert (table["error"].abs() < 0.01).all()
    np.testing.assert_allclose(table["at_spring"], table["ratio"], rtol=1e-6)
    half = (table["mu"] * table["theta_rad"] / table["elements"] / 2).to_numpy(float)
    np.testing.assert_allclose(table["ratio"], ((1 + half) / (1 - half)) ** 10, rtol=1e-9)


@pytest.mark.slow
def test_errors_are_of_second_order() -> None:
    """On meshes on which the front lies alike; where it lies is what the strip's other errors follow from."""
    strip, drum = strip_table(MESHES, (1,)), drum_table(sides=("on",))
    exact_but_for_the_mesh(strip)
    assert (strip[["end_error", "loop_error"]].abs() < [0.005, 0.01]).all(axis=None)
    assert (drum["end_error"].abs() < 1e-3).all()
    actual = (
        orders(strip, ["steps"], "elements", ["back_error"]),
        orders(drum, ["side"], "elements", ["end_error", "slip_error"]),
    )
    np.testing.assert_allclose(actual[0].to_numpy(float), 2, atol=0.01)
    np.testing.assert_allclose(actual[1].to_numpy(float), 2, atol=0.05)

"""Rotations one after another: nothing is left where the measure is exact, and their order may not be exchanged.

Rigid motions over the whole catalogue: every declared law is met, and the famous failures are found.

Derivatives of the tyre at work: what rounding is worth, and an optimum that answers without any confirm.
"""

import math
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from formulations.strains.catalogue import MEASURES
from reports.chapters.what_if import what_if_page
from studies.experiments import rotations, what_if
from studies.experiments.rigid_body import AMOUNTS, SAMPLES, SWEPT, rigid_body_table, rotation_sweep, small_motions
from studies.experiments.rotations import ANGLE, ASTRAY, BACK, Panel, cases, rotations_table, turned
from studies.experiments.specimens import Element

NOTHING = 1e-9  # Newton's iteration ends at forces of 1e-11 of those of strain 1
EXACT = ("exact", "elongation")


def test_rotations_are_those_of_scipy_and_may_not_be_exchanged() -> None:
    """About axes fixed in space, in the order Z, Y, X: lower case there."""
    angles = [ANGLE] * 3
    np.testing.assert_allclose(turned(BACK, 3), Rotation.from_euler("zyx", angles).as_matrix(), atol=1e-15)
    np.testing.assert_allclose(turned(BACK, 6), np.eye(3), atol=1e-15)
    other = Rotation.from_euler("xyz", angles).as_matrix()
    added = Rotation.from_rotvec(angles).as_matrix()
    for wrong in (other, added, turned(ASTRAY, 6) @ turned(BACK, 3)):
        assert np.abs(wrong - turned(BACK, 3)).max() > 0.1


@pytest.mark.slow
def test_every_measure_comes_back_and_only_exact_ones_kept_their_energy_on_the_way() -> None:
    """In another order, the commutator of three rotations, the panel is elsewhere and as strained as before."""
    table = rotations_table()
    assert set(table["measure"]) == set(MEASURES)
    assert len(table.groupby(["measure", "interpolation"])) == len(cases())
    exact = table[(table["measure"] == "exact") & (table["interpolation"] == "isoparametric")]
    assert (exact["outcome"] == "converged").all()
    assert exact["off"].max() < NOTHING
    for (body, path), own in exact.groupby(["body", "path"]):
        assert len(own) == 7
        assert own["away"].iloc[1:6].min() > 0.4  # it has moved by half of its length
        assert path == "back" or own["away"].iloc[-1] > 0.4
        assert own["strain"].max() < NOTHING if body == "free" else own["strain"].min() > 0.05
    back = table[(table["path"] == "back") & (table["leg"] == 6)]
    assert len(back) == 2 * len(cases())
    assert back["off"].max() < NOTHING
    assert back["energy_change"].abs().max() < NOTHING
    there = table[(table["leg"] == 3) & (table["body"] == "strained") & (table["path"] == "back")]
    changes = there.set_index(["measure", "interpolation"])["energy_change"]
    for (measure, interpolation), change in changes.items():
        kept = measure in EXACT and interpolation == "isoparametric"
        assert abs(change) < NOTHING if kept else abs(change) > 0.01
    assert exact["energy_change"].abs().max() < NOTHING
    positions = changes.xs("isoparametric", level="interpolation")
    assert positions["linear"] > positions["von-karman"] > positions["sanders"] > positions["novozhilov"] > 1


@pytest.mark.slow
def test_what_interpolated_components_leave_falls_with_the_second_order(monkeypatch: pytest.MonkeyPatch) -> None:
    """About the axis Z the frame turns with the shell, and nothing is left; about Y and X it does not."""
    element, off = Element("curvilinear", "balanced"), []
    for n in (4, 8, 16):
        monkeypatch.setattr(rotations, "ELEMENTS", n)
        actual = pd.DataFrame(Panel(MEASURES["exact"], element, False, BACK[:3]).run())
        assert actual["strain"][1] < NOTHING
        off.append(actual["off"][3])
    orders = [math.log2(coarse / fine) for coarse, fine in pairwise(off)]
    np.testing.assert_allclose(orders, 2, atol=0.2)


@pytest.mark.slow
def test_large_steps_must_fail_by_another_equilibrium() -> None:
    """Four steps a rotation: on its way back the panel folds at its edges and keeps the fold, five times the energy."""
    element = Element("curvilinear", "balanced")
    panel = Panel(MEASURES["exact"], element, True, BACK)
    few, more = (pd.DataFrame(panel.run(steps)) for steps in (4, rotations.STEPS))
    assert few["energy_change"].iloc[-1] > 1
    assert few["off"].iloc[-1] > 0.1
    assert more["off"].iloc[-1] < NOTHING


LAW = 1e-10


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return rigid_body_table(theta=0.5, slide=0.3)


def test_every_declared_law_is_met(table: pd.DataFrame) -> None:
    assert len(table) == len(MEASURES) * len(SAMPLES) * 4
    stated = table.dropna(subset="declared")
    assert stated.groupby("measure").size().min() >= 12  # of 16
    assert (stated["strain"] - stated["declared"]).abs().max() <= LAW
    assert table[table["measure"].isin(["exact", "elongation"])]["largest"].max() <= 1e-12


def pick(table: pd.DataFrame, measure: str, surface: str, motion: str) -> float:
    row = table.query("measure == @measure and surface == @surface and motion == @motion")
    return float(row["strain"].iloc[0])


def test_the_famous_failures(table: pd.DataFrame) -> None:
    quartic = -((1 - math.cos(0.5)) ** 2) / 2
    assert pick(table, "von-karman", "plate", "out of plane") == pytest.approx(quartic, abs=LAW)
    assert quartic == pytest.approx(-(0.5**4) / 8, rel=0.05)  # theta^4/8
    membrane = (0.3 * math.sin(0.7) / (1 + 0.3 / 2)) ** 2 / 2  # (U sin phi/R)^2/2, on the outer face
    assert pick(table, "donnell", "cylinder", "translation") == pytest.approx(membrane, abs=LAW)
    assert pick(table, "donnell", "cylinder", "about the axis") == pytest.approx(math.cos(0.5) - 1, abs=LAW)
    assert pick(table, "sanders", "cylinder", "drilling") == pytest.approx(quartic, abs=LAW)


def test_swept_strains_stay_on_their_laws_and_return_after_a_full_turn() -> None:
    sweep = rotation_sweep(points=9)
    turn = sweep[sweep["theta_rad"] > 6.28]
    assert len(turn) == len(SWEPT) * len(MEASURES)
    assert turn["strain"].abs().max() <= LAW
    half = sweep.query("measure == 'von-karman' and surface == 'plate' and motion == 'out of plane'").iloc[4]
    assert half["strain"] == pytest.approx(-2.0, abs=LAW)  # at pi von Karman is as wrong as linear
    assert sweep["declared"].notna().all()
    assert (sweep["strain"] - sweep["declared"]).abs().max() <= LAW


def test_small_motions_fall_at_the_rates_of_the_theory() -> None:
    """Half of a Donnell translation leaves a quarter, half of a von Karman rotation a sixteenth: theta^4/8."""
    table = small_motions()
    assert len(table) == len(AMOUNTS) * len(MEASURES) * len(SAMPLES) * 4
    for measure, surface, motion, rate in (
        ("donnell", "cylinder", "translation", 2),
        ("von-karman", "plate", "out of plane", 4),
        ("linear", "torus", "about the axis", 2),
    ):
        double, single = (pick(table[table["amount"] == amount], measure, surface, motion) for amount in (0.1, 0.05))
        assert math.log2(double / single) == pytest.approx(rate, abs=0.01)


def test_half_a_unit_of_the_last_digit() -> None:
    assert [what_if.half_a_unit(each) for each in ("52", "0.15", "510.45")] == pytest.approx([0.5, 0.005, 0.005])


@pytest.mark.slow
def test_no_combination_is_better_than_the_optimum(monkeypatch, tmp_path) -> None:
    """On a coarse mesh: derivatives against 25 answers that know of none; the page says which it was."""
    monkeypatch.setattr(what_if, "MESHES", ("12x14", "14x16"))
    monkeypatch.setattr(what_if, "COUNT", 5)
    monkeypatch.setattr(what_if, "BOTH", ("12x14", "14x16"))
    tables = {name: getattr(what_if, name)() for name in ("what_if", "even_footprint", "every_footprint")}
    asked, every = tables["even_footprint"], tables["every_footprint"]
    own = asked[asked["mesh"] == "12x14"]
    (optimum,) = own[own["optimum"]].to_dict("records")
    allowed = every[every["verdict"] == "converged"]
    for name, least in what_if.LEAST.items():
        allowed = allowed[allowed[name] >= least]
        assert optimum[name] >= least - 1e-6 * abs(least)
    assert 0 < len(allowed) < len(every)
    assert optimum[what_if.GOAL] <= allowed[what_if.GOAL].min()
    for name, table in tables.items():
        table.to_csv(tmp_path / f"{name}.csv", index=False)

    class Stored:
        def table(self, name: str) -> pd.DataFrame:
            return pd.read_csv(tmp_path / f"{name}.csv")

    said = str(what_if_page(Stored()))
    assert f"Of 25 combinations on 12x14, all solved and judged, {len(allowed)} are feasible" in said
    assert f"{optimum['gamma_deg']:.2f} | {optimum['p0_MPa']:.4f}" in said

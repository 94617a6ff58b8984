"""Rigid motions over the whole catalogue: every declared law is met, and the famous failures are found."""

import math

import pandas as pd
import pytest

from formulations.strains.catalogue import MEASURES
from studies.experiments.rigid_body import AMOUNTS, SAMPLES, SWEPT, rigid_body_table, rotation_sweep, small_motions

LAW = 1e-10


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return rigid_body_table(theta=0.5, slide=0.3)


def test_every_declared_law_is_met(table: pd.DataFrame) -> None:
    assert len(table) == len(MEASURES) * len(SAMPLES) * 4
    told = table.dropna(subset="declared")
    assert told.groupby("measure").size().min() >= 12  # of 16
    assert (told["strain"] - told["declared"]).abs().max() <= LAW
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

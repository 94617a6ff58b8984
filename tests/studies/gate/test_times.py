"""Wall time: nights of the same program are silent, a planted slowdown is found, however noisy the machine."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy.stats import mannwhitneyu

from studies.gate.compare import NothingComparedError
from studies.gate.times import FEWEST, compare_times, floor_of
from studies.scenes.complete import complete as resolve
from studies.solving.solve import solve

CELLS, SAMPLES = 100, 10


def night(
    rng: np.random.Generator, noise: float = 0.03, slower: dict[int, float] | None = None, samples: int = SAMPLES
) -> pd.DataFrame:
    """Samples of cells from 1 ms to 10 s: lognormal noise, and one sample in ten that something else has disturbed."""
    rows = []
    for cell, seconds in enumerate(np.geomspace(1e-3, 10, CELLS)):
        taken = seconds * np.exp(noise * rng.normal(size=samples)) * (1 + (slower or {}).get(cell, 0.0))
        taken *= np.where(rng.random(samples) < 0.1, rng.uniform(1, 3, samples), 1)
        rows += [{"label": f"cell {cell}", "seconds": t, "block": i // 5} for i, t in enumerate(taken)]
    return pd.DataFrame(rows)


@pytest.mark.slow
@pytest.mark.parametrize("nights", [1, 5])
def test_nights_of_the_same_raise_no_alarm(nights: int, rng: np.random.Generator) -> None:
    for noise in (0.002, 0.01, 0.05, 0.3):
        for _ in range(nights):
            actual = compare_times(night(rng, noise), night(rng, noise))
            assert set(actual["verdict"]) == {"same"}


@pytest.mark.slow
def test_real_cells_repeated_raise_no_alarm() -> None:
    """Twenty runs of two real solves on whatever machine this is; the two sides take turns, as in the timing lane."""
    requests = {
        "cantilever": resolve("cantilever", {"load_fraction": "0.25"}, "4x1"),
        "roof": resolve("scordelis-lo", {}, "2x2", measure="linear"),
    }
    runs, step = 20, 8
    rows = []
    for _ in range(step * (runs + 1)):
        for label, (scene, request) in requests.items():
            rows.append({"label": label, "seconds": solve(scene, request).timing["total"]})
    pool = pd.DataFrame(rows)
    turn = pool.groupby("label").cumcount()
    for run in range(runs):
        window = pool[(turn >= step * run) & (turn < step * (run + 2))]
        even = turn[window.index] % 2 == 0
        assert set(compare_times(window[even], window[~even])["verdict"]) == {"same"}


def test_a_planted_slowdown_is_found_and_nothing_else(rng: np.random.Generator) -> None:
    planted = {3: 0.15, 50: 0.25, 80: 1.0}
    actual = compare_times(night(rng, 0.01, samples=16), night(rng, 0.01, planted, samples=16))
    assert set(actual["label"][actual["verdict"] == "slower"]) == {f"cell {cell}" for cell in planted}
    row = actual.set_index("label").loc["cell 50"]
    assert row["change"] == pytest.approx(0.25, abs=0.03)
    assert row["p"] < 0.01


def test_p_is_controlled_over_all_cells(rng: np.random.Generator) -> None:
    """Benjamini and Hochberg's step-up, written out."""
    before, now = night(rng), night(rng, slower={7: 0.5})
    sides = [dict(iter(side.groupby("label", sort=False)["seconds"])) for side in (before, now)]
    raw = np.array([mannwhitneyu(sides[1][cell], sides[0][cell], alternative="greater").pvalue for cell in sides[0]])
    order = np.argsort(raw)
    stepped = raw[order] * len(raw) / np.arange(1, len(raw) + 1)
    adjusted = np.empty_like(raw)
    adjusted[order] = np.minimum(np.minimum.accumulate(stepped[::-1])[::-1], 1.0)
    np.testing.assert_allclose(compare_times(before, now)["p"], adjusted, rtol=1e-12)


def test_faster_is_found_only_when_asked_for(rng: np.random.Generator) -> None:
    before, now = night(rng, 0.01), night(rng, 0.01, {7: -0.5})
    assert set(compare_times(before, now)["verdict"]) == {"same"}
    actual = compare_times(before, now, "faster")
    assert list(actual["label"][actual["verdict"] == "faster"]) == ["cell 7"]


def test_a_change_below_the_share_is_none(rng: np.random.Generator) -> None:
    """Significant in rank, too small to matter: 2 % with hardly any noise."""
    before, now = (
        pd.DataFrame({"label": "a", "seconds": seconds * (1 + 1e-5 * rng.normal(size=20))}) for seconds in (1.0, 1.02)
    )
    (row,) = compare_times(before, now).to_dict("records")
    assert row["p"] < 0.01
    assert row["change"] > 3 * row["floor"]
    assert row["verdict"] == "same"


def test_drift_between_blocks_raises_the_floor() -> None:
    """A machine that changes its speed by 10 % between two blocks says nothing about 12 %."""
    steady = np.full(12, 1.0) + 1e-4 * np.arange(12)
    drifting = steady * np.repeat([1.0, 1.1], 6)
    assert floor_of(steady) < 0.001
    assert floor_of(drifting, np.repeat([0, 1], 6)) > 0.09
    before = pd.DataFrame({"label": "a", "seconds": drifting, "block": np.repeat([0, 1], 6)})
    now = before.assign(seconds=1.25 * before["seconds"])
    assert list(compare_times(before, now)["verdict"]) == ["same"]
    calm = before.assign(seconds=steady)
    assert list(compare_times(calm, calm.assign(seconds=1.25 * calm["seconds"]))["verdict"]) == ["slower"]


def test_too_few_samples_are_no_comparison(rng: np.random.Generator) -> None:
    few = night(rng, samples=FEWEST - 1)
    with pytest.raises(NothingComparedError, match="none has 8 samples on both sides"):
        compare_times(few, night(rng))
    mixed = pd.concat([few, pd.DataFrame({"label": "more", "seconds": np.linspace(1, 1.01, 9), "block": 0})])
    verdicts = compare_times(mixed, mixed).set_index("label")["verdict"]
    assert verdicts["more"] == "same"
    assert verdicts["cell 0"] == "too few samples"


def test_blocks_that_are_further_apart_than_halves_are_the_floor() -> None:
    samples, blocks = np.linspace(1.0, 1.2, 100), np.repeat([0, 1], 50)
    assert floor_of(samples) < 0.05
    assert floor_of(samples, blocks) == pytest.approx(0.1 / 1.1, rel=0.02)

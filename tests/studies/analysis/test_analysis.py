"""The analysis on planted data: what is known of it beforehand must come out, flagged, ranked and attributed."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from studies.analysis.advice.choose import advice_table, advise, lines
from studies.analysis.advice.held_out import estimated, held_out, summary
from studies.analysis.advice.questions import asked_question
from studies.analysis.cells.rows import ladders
from studies.analysis.everything import analysed
from studies.analysis.ranking.attribution import INTERACTIONS, REST, shares
from studies.analysis.ranking.fronts import COSTS, WRONG, family_fronts, fronts, on_front
from studies.analysis.ranking.profiles import field, flip_check, pairs_of, problems, profiles, solved, within
from studies.analysis.ranking.unsolved import unsolved
from studies.analysis.suspicious import flags, inert, inert_inputs, printed, walls
from studies.analysis.verify import verified
from studies.complete import complete
from studies.scene import UsageError
from support.stores.sweeps import EXACT, SIZES, cells


def test_two_spellings_of_one_request_are_one_ladder() -> None:
    """What is written, and what is left to its default, in any order."""
    table = cells(tolerances={1e-9: 0.0})
    written = {"solver": "auto", "element": "refined", "tolerance": "1e-09", "load_fraction": "1.0"}
    table["request"] = [
        complete("cantilever", written if n == 16 else {"load_fraction": "1"}, f"{n}x1")[1] for n in table["n1"]
    ]
    (rungs,) = ladders(table)
    assert list(rungs["n1"]) == list(SIZES)
    table.loc[0, "request"] = replace(table["request"][0], newton="plain")
    assert [list(rungs["n1"]) for rungs in ladders(table)] == [list(SIZES[1:])]


def test_a_mesh_hardly_coarser_than_the_next_is_no_rung() -> None:
    (rungs,) = ladders(cells(sizes=(14, 16, 20, 28)))
    assert list(rungs["n1"]) == [14, 20, 28]


def test_the_split_finds_each_planted_part() -> None:
    """Mesh 2/n², measure 3 %, tolerance 1e-2 costs 0.5 %; the reference is exact to 1e-5."""
    table = cells(measures={"exact": 0.0, "linear": 0.03}, tolerances={1e-2: 0.005, 1e-10: 0.0})
    split = verified(table).set_index("label")
    coarse = split.loc["cantilever exact semismooth 8 1e-10"]
    assert coarse["against"] == "reference: exact"
    assert coarse["mesh_error"] == pytest.approx(2 / 64, rel=1e-6)
    assert coarse["error"] == pytest.approx(2 / 64, rel=1e-6)
    assert coarse["formulation_error"] == 0.0
    assert coarse["order"] == pytest.approx(2.0, rel=1e-6)
    assert bool(coarse["asymptotic"])
    assert coarse["largest"] == "mesh"
    loose = split.loc["cantilever exact semismooth 64 0.01"]
    assert loose["solver_error"] == pytest.approx(0.005, rel=1e-6)
    assert loose["formulation_error"] == 0.0  # that of the tightest tolerance
    assert loose["largest"] == "solver"
    other = split.loc["cantilever linear semismooth 64 1e-10"]
    assert other["formulation_error"] == pytest.approx(0.03, rel=1e-4)
    assert other["largest"] == "formulation"
    assert coarse["reference_error"] == 1e-5


def test_without_a_reference_the_exact_measure_is_the_limit() -> None:
    """A load for which the cantilever has no reference: the other measure's loss is still an error."""
    table = cells(setting="load_fraction=0.3", measures={"exact": 0.0, "linear": 0.03})
    split = verified(table).set_index("label")
    exact, linear = (split.loc[f"cantilever {name} semismooth 64 1e-10"] for name in ("exact", "linear"))
    assert exact["against"] == linear["against"] == "limit of cantilever exact semismooth 64 1e-10"
    assert exact["reference"] == pytest.approx(EXACT, rel=1e-9)
    assert linear["error"] == pytest.approx(0.03 + 2 / 64**2, rel=1e-4)
    alone = verified(table[table["measure"] == "linear"])
    assert set(alone["against"]) == {"limit of cantilever linear semismooth 64 1e-10"}
    short = verified(table[(table["measure"] == "linear") & (table["n1"] < 20)])
    assert short["error"].isna().all()
    assert set(short["against"]) == {""}


def test_slow_but_accurate_and_fast_but_wrong_land_where_they_must() -> None:
    sweep = cells()
    slow, fast = sweep.tail(1).copy(), sweep.head(1).copy()
    slow["label"], slow["c.operations"], slow["q.tip_deflection_mm"] = "slow", 1e9, EXACT * (1 + 3e-5)
    slow["request"] = [replace(request, mesh=(512, 1)) for request in slow["request"]]
    fast["label"], fast["c.operations"], fast["q.tip_deflection_mm"] = "fast", 1.0, EXACT * 1.5
    fast["request"] = [replace(request, mesh=(1, 1)) for request in fast["request"]]
    table = pd.concat([sweep, slow, fast], ignore_index=True)
    found = fronts(table, verified(table)).set_index("label")
    assert bool(found.loc["slow", "front.operations"])
    assert found.loc["slow", "flag"] == ""
    assert not found.loc["fast", "front.operations"]
    assert found.loc["fast", "flag"] == "wrong"
    assert found["front.operations"].sum() == 5  # each mesh of the ladder buys accuracy, too


def test_a_claim_that_the_judge_rejects_is_on_no_front() -> None:
    table = cells()
    table.loc[0, "outcome"] = "wrong"
    table.loc[1, "outcome"] = "not-converged"
    table.loc[2, "outcome"] = "unsupported"
    found = fronts(table, verified(table))
    assert list(found["flag"]) == ["wrong", "failed", "unsupported", ""]
    assert not found["front.operations"][:3].any()


def test_two_errors_that_cancel_are_not_accuracy() -> None:
    """A measure that is 30 % off and a mesh that is 30 % off the other way: right by chance, flagged, not advised."""
    table = cells(measures={"exact": 0.0, "linear": 0.3}, mesh_error=lambda n: -0.3 * (8 / n) ** 2)
    split = verified(table)
    lucky = split.set_index("label").loc["cantilever linear semismooth 8 1e-10"]
    assert lucky["error"] < 1e-6
    assert fronts(table, split).set_index("label").loc["cantilever linear semismooth 8 1e-10", "flag"] == "wrong"
    best = advise(asked_question(table, split, "cantilever"), 0.02).best
    assert best is not None
    assert best["measure"] == "exact"


def test_an_error_below_what_the_reference_knows_buys_nothing() -> None:
    table = cells()
    found = fronts(table, verified(table).assign(uncertainty=1.01 * 2 / 16**2))
    assert list(found["front.operations"]) == [True, True, False, False]


def test_the_front_itself() -> None:
    cost = np.array([1.0, 2.0, 2.0, 3.0, 4.0, 5.0, 1.0, np.nan])
    error = np.array([1.0, 0.5, 0.5, 0.7, 0.499, 0.1, np.nan, 0.0])
    assert list(on_front(cost, error)) == [True, True, False, False, False, True, False, False]


def test_a_family_counts_what_all_its_scenes_have() -> None:
    table = pd.concat(
        [
            cells(measures={"exact": 0.0, "linear": 0.02}),
            cells("hemisphere", "inward_mm", 8.178, measures={"exact": 0.0}),
        ]
    )
    found = family_fronts(fronts(table, verified(table)))
    assert set(found["measure"]) == {"exact"}
    assert set(found["family"]) == {"large rotations"}
    assert list(found["scenes"]) == [2] * 4
    coarse = found[found["rung"] == 0].iloc[0]
    assert coarse["error"] == pytest.approx(2 / 64, rel=1e-3)
    assert coarse["cost.operations"] == pytest.approx(1.0)


def test_an_ignored_tolerance_is_flagged_and_one_that_is_read_is_not() -> None:
    reads = cells(tolerances={1e-2: 1e-3, 1e-6: 1e-7, 1e-10: 0.0})
    ignores = cells(contacts={"lcp": 1.0}, tolerances={1e-2: 0.0, 1e-6: 0.0, 1e-10: 0.0})
    for column in ("c.newton_iterations", "c.factorisations", "c.operations"):
        ignores[column] = 7
    at_once = cells("hemisphere", "inward_mm", 8.178, tolerances={1e-2: 0.0, 1e-10: 0.0})
    for column in ("c.newton_iterations", "c.factorisations", "c.operations"):
        at_once[column] = 1
    found = inert(pd.concat([reads, ignores, at_once]), "tolerance").set_index("subject")
    assert found.index.tolist() == ["lcp mixed", "semismooth mixed"]
    assert found.loc["lcp mixed", ["scene", "cases", "of"]].tolist() == ["cantilever", 4, 4]
    assert found.loc["lcp mixed", "cause"] == "not read, or never what stops"
    assert found.loc["semismooth mixed", "scene"] == "hemisphere"
    assert found.loc["semismooth mixed", "cause"] == "one iteration: nothing to stop"


def test_an_input_that_was_varied_in_vain_is_flagged_by_its_name() -> None:
    """Planted: a load that is read by nobody. Measures that differ and another way to one answer are no flags."""
    read = pd.concat([cells(measures={"exact": 0.0, "linear": 1e-3}), cells(contacts={"lcp": 1.0})])
    heavier = cells(setting="load_fraction=0.5", truth=0.7 * EXACT)
    assert inert_inputs(pd.concat([read, heavier], ignore_index=True)).empty
    ignored = cells(setting="load_fraction=0.5")
    (found,) = inert_inputs(pd.concat([read, ignored], ignore_index=True)).to_dict("records")
    assert (found["flag"], found["scene"], found["subject"]) == ("inert input", "cantilever", "load_fraction")
    assert (found["cases"], found["of"], found["size"]) == (4, 4, 2)


def test_a_reference_of_five_digits_is_a_wall() -> None:
    """The truth is 6.6996432; the reference says 6.6996 and claims to be exact to 1e-9."""
    table = cells(truth=6.6996432)
    reference = pd.DataFrame(
        {
            "label": table["label"],
            "quantity": "tip_deflection_mm",
            "value": 6.6996,
            "uncertainty": 1e-9,
            "kind": "read",
            "source": "",
        }
    )
    fine = cells(truth=6.6996432, sizes=(128, 256, 512, 1024))
    assert walls(table, reference).empty  # the mesh is coarser than the digits
    (wall,) = walls(fine, reference.assign(label=list(fine["label"]))).to_dict("records")
    assert wall["cause"] == "5 digits of the reference"
    assert wall["size"] == pytest.approx(4.32e-5 / 6.6996, rel=1e-3)
    exact = reference.assign(label=list(fine["label"]), value=6.6996432)
    assert walls(fine, exact).empty


@pytest.mark.parametrize(("uncertainty", "cause"), [(1e-2, "uncertainty of the reference"), (1e-4, "formulation")])
def test_other_walls_are_told_apart(uncertainty: float, cause: str) -> None:
    table = cells(measures={"exact": 5e-3}, sizes=(32, 64, 128, 256))
    reference = pd.DataFrame(
        {"label": table["label"], "quantity": "tip_deflection_mm", "value": EXACT, "uncertainty": uncertainty}
    )
    (wall,) = walls(table, reference).to_dict("records")
    assert wall["cause"] == cause


@pytest.mark.parametrize(
    ("value", "digits", "last"), [(6.6996, 5, 5e-5), (0.156, 3, 5e-4), (8.0, 1, 0.5), (1200.0, 2, 50.0)]
)
def test_digits_as_printed(value: float, digits: int, last: float) -> None:
    assert printed(value) == (digits, pytest.approx(last))


def test_profiles_of_a_known_field() -> None:
    """a is best in two of four problems and within 2 in three, b fails once."""
    matrix = pd.DataFrame({"a": [1.0, 1.0, 2.0, 9.0], "b": [2.0, np.inf, 1.0, 1.0]})
    shares_within = within(matrix, (1.0, 2.0, 20.0))
    assert list(shares_within["a"]) == [0.5, 0.75, 1.0]
    assert list(shares_within["b"]) == [0.5, 0.75, 0.75]


def two_scenes(contacts: dict[str, float], sizes: tuple[int, ...] = SIZES) -> pd.DataFrame:
    more = cells("hemisphere", "inward_mm", 8.178, contacts=contacts, sizes=sizes)
    return pd.concat([cells(contacts=contacts, sizes=sizes), more], ignore_index=True)


def test_pairs_have_the_planted_ratio() -> None:
    table = two_scenes({"semismooth": 1.0, "lcp": 3.0})
    _, pairs, _ = profiles(fronts(table, verified(table)))
    row = pairs[(pairs["axis"] == "contact") & (pairs["cost"] == "seconds")].iloc[0]
    assert list(row[["a", "b", "problems", "both", "scenes"]]) == ["semismooth", "lcp", 8, 8, 2]
    assert (row["a_better"], row["b_better"]) == (8, 0)
    assert row["ratio_low"] == pytest.approx(3.0) == row["ratio"] == row["ratio_high"] == row["ratio_largest"]


def test_the_largest_problems_may_say_the_opposite() -> None:
    """Twice as quick on many small problems, three times as slow on the five largest."""
    small, large = [(1.0, 0.5)] * 20, [(100.0 + k, 3 * (100.0 + k)) for k in range(5)]
    matrix = pd.DataFrame(small + large, columns=["semismooth", "lcp"])
    matrix.index = pd.MultiIndex.from_tuples([("tyre" if k % 2 else "ring", str(k)) for k in range(25)])
    (row,) = pairs_of(matrix)
    assert (row[-4], row[-1]) == (pytest.approx(0.5), pytest.approx(3.0))


def test_profiles_rank_at_two() -> None:
    table = two_scenes({"semismooth": 1.0, "lcp": 3.0})
    profile, _, flips = profiles(fronts(table, verified(table)))
    at_two = profile[(profile["cost"] == "operations") & np.isclose(profile["factor"], 2.0, atol=0.1)]
    assert set(at_two["share"][at_two["competitor"] == "lcp"]) == {0.0}
    assert set(flips["flips"]) == {""}


def test_a_pair_is_timed_on_what_both_solve_and_failures_are_counted() -> None:
    """lcp fails in one scene: no ratio there, and its share says so; a missing or refused cell is no failure."""
    table = two_scenes({"semismooth": 1.0, "lcp": 3.0})
    table.loc[(table["contact"] == "lcp") & (table["scene"] == "hemisphere"), "outcome"] = "cap-hit"
    table.loc[(table["contact"] == "lcp") & (table["n1"] == 64), "outcome"] = "missing"
    scenes = fronts(table, verified(table))
    _, pairs, _ = profiles(scenes)
    row = pairs[(pairs["axis"] == "contact") & (pairs["cost"] == "seconds")].iloc[0]
    assert list(row[["problems", "both", "scenes"]]) == [6, 3, 1]
    assert np.isnan(row["ratio_low"])  # one scene says nothing about another
    found = solved(scenes).set_index(["competitor", "scene"])
    assert list(found.loc[("lcp", "")]) == ["contact", 6, 3, 0, 0, "3 cap-hit"]
    assert list(found.loc[("lcp", "cantilever")]) == ["contact", 3, 3, 0, 0, ""]
    assert list(found.loc[("semismooth", "")]) == ["contact", 6, 6, 0, 0, ""]


def test_a_path_that_ends_is_no_failure_and_who_has_passed_it_is_told() -> None:
    """lcp ends at a limit point in one scene, on one grid as the other does, and fails on another without a cause."""
    table = two_scenes({"semismooth": 1.0, "lcp": 3.0}).assign(path_end="", path_end_at=np.nan, path_end_by="")
    ended = table["scene"] == "hemisphere"
    ended &= (table["contact"] == "lcp") | (table["n1"] == SIZES[0])
    table.loc[ended, ["outcome", "path_end", "path_end_at", "path_end_by"]] = "not-converged", "limit point", 7.5, "arc"
    failed = ended & (table["n1"] == SIZES[1])
    table.loc[failed, ["outcome", "path_end", "path_end_at"]] = "cap-hit", "", np.nan
    found = solved(fronts(table, verified(table))).set_index(["competitor", "scene"])
    n = len(SIZES)
    assert list(found.loc[("lcp", "hemisphere")]) == ["contact", n, 0, n - 1, n - 2, "1 cap-hit"]
    assert list(found.loc[("semismooth", "hemisphere")]) == ["contact", n, n - 1, 1, 0, ""]
    causes = unsolved(table)
    assert list(causes["cells"]) == [2, *[1] * (n - 1)]
    assert causes.loc[0, ["path_end", "at", "found_by", "contacts"]].tolist() == [
        *("limit point", 7.5, "arc", "semismooth, lcp"),
    ]
    assert causes["path_end"].eq("").sum() == 1


def test_an_interval_is_as_wide_as_the_scenes_differ() -> None:
    """Ratios of 1 in ten problems of one scene and of 3 in two of another: either scene may be drawn alone."""
    index = pd.MultiIndex.from_tuples([("one", i) for i in range(10)] + [("two", i) for i in range(2)])
    matrix = pd.DataFrame({"a": 1.0, "b": [1.0] * 10 + [3.0] * 2}, index=index)
    (row,) = pairs_of(matrix)
    assert row[-4:-1] == (1.0, 1.0, 3.0)


def test_too_few_problems_are_not_ranked() -> None:
    table = cells(contacts={"semismooth": 1.0, "lcp": 3.0})
    profile, _, flips = profiles(fronts(table, verified(table)))
    assert profile.empty
    assert set(flips["problems"]) == {4}
    assert set(flips["ranking"]) == {""}


def test_who_was_not_asked_has_not_failed() -> None:
    """regularised was tried on one mesh of two, lcp refused the other scene: the two others are compared on all."""
    table = cells(contacts={"semismooth": 1.0, "lcp": 3.0, "regularised": 2.0})
    table = table[(table["contact"] != "regularised") | (table["n1"] == 8)]
    more = cells("hemisphere", "inward_mm", 8.178, contacts={"semismooth": 1.0, "lcp": 3.0})
    more.loc[more["contact"] == "lcp", "outcome"] = "not-converged"
    both = pd.concat([table, more], ignore_index=True)
    matrix = problems(field(fronts(both, verified(both)), "contact", "operations"), "contact")
    assert list(matrix.columns) == ["semismooth", "lcp"]
    assert len(matrix) == 8
    assert np.isinf(matrix["lcp"]).sum() == 4
    refused = both.assign(outcome=both["outcome"].replace("not-converged", "unsupported"))
    asked = field(fronts(refused, verified(refused)), "contact", "operations")
    assert len(problems(asked, "contact")) == 4


def test_a_ranking_that_flips_is_seen() -> None:
    """c is the best where a is second: without it a is ahead of b, with it behind."""
    matrix = pd.DataFrame(
        {
            "a": [3.0] * 4 + [1.0, 1.0, 1.0],
            "b": [4.0] * 4 + [1.9, 1.9, 3.0],
            "c": [1.0] * 2 + [1.9] * 2 + [9.0] * 3,
        }
    )
    matrix.loc[2:3, "b"] = 1.0
    turned = {removed: flips for removed, _, flips in flip_check(matrix)}
    assert turned[""] == ""
    assert turned["c"] == "" or "a and b" in turned["c"] or "b and a" in turned["c"]
    worse = pd.DataFrame({"a": [2.5, 2.5, 1.0], "b": [9.0, 9.0, 1.0], "c": [1.0, 1.0, 9.0]})
    worse.loc[2, ["a", "b"]] = [2.5, 1.0]
    turned = {removed: flips for removed, _, flips in flip_check(worse)}
    assert turned["c"] in ("a and b", "b and a")


def planted(rng: np.random.Generator, noise: float) -> tuple[np.ndarray, dict[str, pd.Series], dict[str, float]]:
    """A balanced design of three factors with known sums of squares, an interaction, and noise."""
    design = pd.DataFrame(itertools.product("abc", "xy", range(4), range(4)), columns=["f", "g", "h", "repeat"])
    f = design["f"].map({"a": -3.0, "b": 0.0, "c": 3.0})
    g = design["g"].map({"x": -1.0, "y": 1.0})
    both = 0.5 * f / 3 * g
    parts = {"f": float(np.mean(f**2)), "g": 1.0, "h": 0.0, INTERACTIONS: float(np.mean(both**2)), REST: noise**2}
    values = (f + g + both).to_numpy() + noise * rng.normal(size=len(design))
    total = sum(parts.values())
    factors = {name: design[name].astype(str) for name in "fgh"}
    return values, factors, {name: part / total for name, part in parts.items()}


def test_planted_effects_are_recovered_without_noise(rng: np.random.Generator) -> None:
    values, factors, expected = planted(rng, 0.0)
    for name, _, _, share, low, high in shares(values, factors):
        assert share == pytest.approx(expected[name], abs=1e-9)
        assert low <= share <= high


def test_planted_effects_are_recovered_within_their_intervals() -> None:
    """Of 20 noisy tables with five shares each, nearly all intervals hold the truth, the large effects' always do."""
    held = dict.fromkeys(("f", "g", INTERACTIONS), 0)
    for seed in range(20):
        values, factors, expected = planted(np.random.default_rng(seed), 0.7)
        for name, _, _, _, low, high in shares(values, factors):
            if name in held:
                held[name] += low - 0.01 <= expected[name] <= high + 0.01
            if name == "h":
                assert high < 0.05
    assert held["f"] >= 18
    assert held["g"] >= 18
    assert held[INTERACTIONS] >= 15


def test_too_little_is_not_attributed(rng: np.random.Generator) -> None:
    values, factors, _ = planted(rng, 0.1)
    assert shares(values[:5], {name: labels[:5] for name, labels in factors.items()}) == []
    assert shares(np.ones(96), factors) == []


def test_advice_is_the_cheapest_that_qualifies() -> None:
    table = cells(measures={"exact": 0.0, "linear": 0.03}, contacts={"semismooth": 1.0, "lcp": 2.0})
    split = verified(table)
    question = asked_question(table, split, "cantilever")
    found = advise(question, 0.01)
    assert found.best is not None
    assert found.best["label"] == "cantilever exact semismooth 16 1e-10"  # 2/16² = 0.8 %, 2/8² = 3.1 %
    assert found.runner_up is not None
    assert found.runner_up["label"] == "cantilever exact lcp 16 1e-10"
    assert found.next_step == 0.005
    assert found.next_best is not None
    assert found.next_best["n1"] == 32
    text = "\n".join(lines(found))
    assert "cheapest: exact semismooth mixed refined 16x1, tolerance 1e-10: error at most 0.782 %" in text
    assert "runner-up: exact lcp mixed refined 16x1, tolerance 1e-10: 2 times the seconds" in text
    assert "next step, 0.5 %: exact semismooth mixed refined 32x1, tolerance 1e-10: 2.83 times the seconds" in text


def test_none_qualifies_is_said() -> None:
    table = cells()
    found = advise(asked_question(table, verified(table), "cantilever"), 1e-5)
    assert found.best is None
    text = "\n".join(lines(found))
    assert "none qualifies of 4 cells" in text
    assert "nearest: error at most 0.0498 %" in text


def test_an_uncertain_reference_cannot_show_what_it_does_not_know() -> None:
    """The pinched hemisphere is known to 0.2 %: no mesh proves 0.1 %."""
    table = cells("hemisphere", "inward_mm", 8.178, sizes=(8, 16, 32, 64, 128))
    assert advise(asked_question(table, verified(table), "hemisphere"), 0.001).best is None
    assert advise(asked_question(table, verified(table), "hemisphere"), 0.003).best is not None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"scene": "tyre"}, "scene 'tyre' is not in this campaign; it has cantilever"),
        ({"scene": "cantilever", "quantity": "force_N"}, "no verified quantity 'force_N'; it has tip_deflection_mm"),
        ({"scene": "cantilever", "cost": "beer"}, "cost 'beer' must be one of dofs, seconds, operations"),
        ({"scene": "cantilever", "settings": {"load_fraction": "2"}}, "it was with: load_fraction=1"),
    ],
)
def test_what_cannot_be_advised_is_one_line(arguments: dict, message: str) -> None:
    table = cells()
    with pytest.raises(UsageError, match=message):
        asked_question(table, verified(table), **arguments)


def several_scenes() -> pd.DataFrame:
    """Four scenes that converge with the second order, each with its own constant, and a measure that loses 2 %."""
    known = (
        ("cantilever", "tip_deflection_mm", EXACT, "load_fraction=1", 2.0),
        ("hemisphere", "inward_mm", 8.178, "load_fraction=1", 4.0),
        ("sze-moment", "tip_deflection_mm", 7.639437268410975, "load_fraction=0.5", 0.6),
        ("scordelis-lo", "edge_deflection_mm", 0.3024, "E_MPa=4.32e8", 4.0),
    )
    return pd.concat(
        [
            cells(
                scene,
                quantity,
                truth,
                setting,
                measures={"exact": 0.0, "linear": 0.02},
                contacts={"semismooth": 1.0, "lcp": 1.5},
                mesh_error=lambda n, size=size: size / n**2 * (1 + 2 / n),
            )
            for scene, quantity, truth, setting, size in known
        ],
        ignore_index=True,
    )


def test_advice_for_a_scene_that_was_left_out() -> None:
    table = several_scenes()
    cases = held_out(table, verified(table))
    assert set(cases["scene"]) >= {"cantilever", "hemisphere", "sze-moment"}
    (row,) = summary(cases[cases["headline"]])[lambda rows: rows["quantities"] == "headline"].to_dict("records")
    assert row["met"] >= 0.95
    assert row["median_regret"] < 1.5
    assert 1.0 <= cases["factor"].min() < cases["factor"].max() < 2.0


def test_values_that_go_up_and_down_have_their_limit_between_them() -> None:
    """Errors of +-2/n: by two steps of opposite signs the estimate is the error itself, and is not tripled."""
    table = cells(mesh_error=lambda n: (-1) ** int(math.log2(n)) * 0.2 / n)
    found = estimated(asked_question(table, verified(table), "cantilever")).sort_values("n1")
    assert list(found["between"]) == [False, False, True, True]
    assert (found["estimate"] / found["error"])[2:].to_numpy() == pytest.approx(1.0, rel=0.05)
    straight = cells(mesh_error=lambda n: 0.2 / n)
    assert not estimated(asked_question(straight, verified(straight), "cantilever"))["between"].any()


def test_cells_of_another_grid_have_an_estimate_of_their_own() -> None:
    """Two spacings of the lines on meshes that are not those of one another."""
    table = pd.concat([cells(), cells(sizes=(12, 20, 40))], ignore_index=True)
    uniform = table["n1"].isin((12, 20, 40))
    other = [replace(it, settings=it.settings.with_values(grading="uniform")) for it in table["request"][uniform]]
    table.loc[uniform, "request"] = pd.Series(other, index=table.index[uniform])
    found = estimated(asked_question(table, verified(table), "cantilever"))
    assert len(found) == 7
    assert found["estimate"].notna().all()


def test_an_estimate_that_is_too_small_elsewhere_raises_the_factor() -> None:
    """Scenes whose references are 5 % from their limits teach that estimates are not to be trusted."""
    table = several_scenes()
    table.loc[table["scene"] == "hemisphere", "q.inward_mm"] *= 1.05
    cases = held_out(table, verified(table)).set_index("scene")
    assert cases.loc["cantilever", "factor"].max() > 2 * cases.loc["hemisphere", "factor"].max()


def test_all_tables_of_the_analysis() -> None:
    tables = analysed(several_scenes())
    assert set(tables) == {
        *("verified", "flags", "fronts", "family_fronts", "profiles", "pairs", "flips", "solved", "attribution"),
        *("advice", "held_out", "held_out_summary", "unsolved", "advice_cells", "advice_questions", "disagreements"),
    }
    for name, found in tables.items():  # whole prices alone
        prices = {str(column).partition(".")[2] for column in found if str(column).startswith(("cost.", "front."))}
        assert prices | set(found.get("cost", ())) <= set(COSTS), name
    assert len(tables["fronts"]) == 64
    assert (tables["fronts"]["flag"] == "").all()
    by_factor = (
        tables["attribution"].query("name == 'cantilever' and response == 'operations'").set_index("factor")["share"]
    )
    assert by_factor["mesh"] > 0.9 > by_factor["contact"] > 0.005 > by_factor["measure"]
    with pytest.raises(UsageError, match="nothing to analyse"):
        analysed(several_scenes().assign(outcome="time"))


def test_every_row_of_the_advice_table_holds(rng: np.random.Generator) -> None:
    table = several_scenes()
    split = verified(table)
    found = advice_table(table, split)
    errors = split.set_index("label")["error"]
    given = found[found["label"] != ""]
    assert (errors[given["label"]].to_numpy() <= given["tolerance"].to_numpy()).all()
    assert (found["label"] == "").any()
    assert (given[["seconds", "operations", "unknowns"]] > 0).all(axis=None)
    assert given["operations_seconds_ratio"].between(0.95, np.inf).all()  # what is cheaper by more would be advised
    assert WRONG == 0.1


def test_flags_of_a_clean_table_are_none() -> None:
    assert flags(cells(tolerances={1e-2: 1e-3, 1e-10: 0.0})).empty

"""Shares, means and profiles of a table that fits on a sheet of paper, against values worked out there."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import pandas as pd
import pytest

from studies.arena.solver_summaries import (
    data_profiles,
    effects,
    performance_profiles,
    rank_correlation,
    ranking,
    shifted_mean,
    summary,
)

LIMIT_S = 100.0
# seconds of three solvers on four problems; None: not claimed, negative: claimed falsely in so many seconds
SECONDS: Mapping[str, Sequence[float | None]] = {
    "A": (1.0, 2.0, 3.0, 4.0),
    "B": (2.0, 1.0, None, 8.0),
    "C": (10.0, -0.5, -0.5, None),
}
FACTORISATION_S = (0.5, 1.0, 1.0, 2.0)
UNKNOWNS = (100, 200, 2_000, 20_000)


def made_up(seconds: Mapping[str, Sequence[float | None]] = SECONDS) -> pd.DataFrame:
    rows = []
    for solver, times in seconds.items():
        for i, each in enumerate(times):
            claimed, taken = each is not None, math.nan if each is None else each
            wrong = taken < 0
            about = {"problem": f"p{i}", "kind": "convex", "unknowns": UNKNOWNS[i], "tolerance": 1e-6}
            about |= {
                "claimed": claimed,
                "false": wrong,
                "accuracy": (9e-6, 9e-6, 1e-2)[i] if wrong else 1e-7 if claimed else math.inf,
                "asked": True,
            }
            about |= {"kept": None if solver == "A" else not wrong, "seconds": abs(taken)}
            about |= {
                "factorisation_s": FACTORISATION_S[i],
                "memory_MB": 1.0,
                "iterations": 1,
                "reason": "" if claimed else "killed after 100 s",
            }
            rows.append({"solver": solver, **about})
    return pd.DataFrame(rows)


def at(table: pd.DataFrame, solver: str, size: str = "all") -> pd.DataFrame:
    return table[(table["solver"] == solver) & (table["size"] == size)]


def test_shares_false_claims_and_failures() -> None:
    table = summary(made_up(), LIMIT_S)
    columns = [
        "problems",
        "claimed",
        "solved",
        "solved_share",
        "false",
        "false_tenfold",
        "false_own",
        "failed_at_limit",
    ]
    assert at(table, "A")[columns].to_numpy().tolist() == [[4, 4, 4, 1.0, 0, 0, 0, 0]]
    assert at(table, "B")[columns].to_numpy().tolist() == [[4, 3, 3, 0.75, 0, 0, 0, 1]]
    assert at(table, "C")[columns].to_numpy().tolist() == [[4, 3, 1, 0.25, 2, 1, 2, 3]]
    assert at(table, "C")["worst_claim"].item() == pytest.approx(1e4)
    assert at(table, "B", "large")[columns].to_numpy().tolist() == [[1, 1, 1, 1.0, 0, 0, 0, 0]]
    assert at(table, "B", "medium")["failed_at_limit"].item() == 1
    assert [at(table, solver)["timed_out"].item() for solver in "ABC"] == [0, 1, 1]


def test_what_was_killed_in_a_later_round_is_not_solved() -> None:
    """Its claim of the first round stands in the table beside the accuracy of the worst."""
    table = made_up()
    late = table.assign(accuracy=table["accuracy"].where(table["solver"] != "A", math.inf))
    assert at(summary(late, LIMIT_S), "A")[["claimed", "solved"]].to_numpy().tolist() == [[4, 0]]


def test_shifted_means_by_hand() -> None:
    assert shifted_mean([1.0, 4.0], 0.0) == pytest.approx(2.0)
    assert shifted_mean([0.0, 3.0], 1.0) == pytest.approx(1.0)  # sqrt(1 4) - 1
    assert shifted_mean([0.7] * 5) == pytest.approx(0.7)
    table = summary(made_up(), LIMIT_S)
    by_hand = ((2 + 0.01) * (1 + 0.01) * (100 + 0.01) * (8 + 0.01)) ** 0.25 - 0.01
    assert at(table, "B")["mean_s"].item() == pytest.approx(by_hand)
    by_hand = (10.01 * 100.01**3) ** 0.25 - 0.01  # a quick lie costs as much as no answer
    assert at(table, "C")["mean_s"].item() == pytest.approx(by_hand)


def test_profiles_by_hand() -> None:
    """Ratios to the quickest: A 1 2 1 1, B 2 1 - 2, C 10 - - -; in factorisations: A 2 2 3 2, B 4 1 - 4, C 20 - - -."""
    profiles = performance_profiles(made_up(), (1.0, 2.0, 5.0, 10.0))
    shares = {solver: at(profiles, solver)["share"].tolist() for solver in "ABC"}
    assert shares == {"A": [0.75, 1, 1, 1], "B": [0.25, 0.75, 0.75, 0.75], "C": [0, 0, 0, 0.25]}
    sizes = {size: rows["problems"].iloc[0] for size, rows in profiles.groupby("size")}
    assert sizes == {"all": 4, "small": 2, "medium": 1, "large": 1}
    profiles = data_profiles(made_up(), (1.0, 2.0, 3.0, 4.0, 20.0))
    shares = {solver: at(profiles, solver)["share"].tolist() for solver in "ABC"}
    assert shares == {"A": [0, 0.75, 1, 1, 1], "B": [0.25, 0.25, 0.25, 0.75, 0.75], "C": [0, 0, 0, 0, 0.25]}
    # what nobody solves counts against all
    profiles = performance_profiles(made_up({"A": (1.0, None), "B": (2.0, None)}), (1.0, 100.0))
    assert {solver: at(profiles, solver)["share"].tolist() for solver in "AB"} == {"A": [0.5, 0.5], "B": [0.0, 0.5]}


def test_ranks_and_their_correlation() -> None:
    first = made_up()
    assert ranking(first, LIMIT_S).droplevel([0, 1]).to_dict() == {"A": 1, "B": 2, "C": 3}
    same = rank_correlation(first, first, LIMIT_S)
    assert same[["problems", "solvers", "spearman", "kendall"]].to_numpy().tolist() == [[4, 3, 1.0, 1.0]]
    slower = made_up({name: tuple(t and 3 * t for t in times) for name, times in SECONDS.items()})
    assert rank_correlation(first, slower, LIMIT_S)["spearman"].tolist() == pytest.approx([1.0])
    turned = made_up(dict(zip("CBA", SECONDS.values(), strict=True)))
    assert rank_correlation(first, turned, LIMIT_S)["spearman"].tolist() == pytest.approx([-1.0])
    two_swapped = made_up({"A": SECONDS["B"], "B": SECONDS["A"], "C": SECONDS["C"]})
    off = rank_correlation(first, two_swapped, LIMIT_S)
    assert off["spearman"].tolist() == pytest.approx([0.5])  # 1 - 6 (1 + 1)/(3 8)
    assert off["kendall"].tolist() == pytest.approx([1 / 3])  # two pairs of three in the same order, one turned


def test_problems_of_one_run_alone_do_not_turn_the_ranks() -> None:
    """On the first problem A is quicker than B; on the second, which was put once, B is."""
    whole = made_up({"A": (1.0, 9.0), "B": (2.0, 1.0)})
    assert ranking(whole, LIMIT_S).droplevel([0, 1]).to_dict() == {"A": 2, "B": 1}
    correlation = rank_correlation(whole, whole[whole["problem"] == "p0"], LIMIT_S)
    assert correlation[["problems", "solvers"]].to_numpy().tolist() == [[1, 2]]
    assert correlation["spearman"].item() == pytest.approx(1.0)


def test_who_is_not_installed_has_no_rank_but_a_row() -> None:
    table = made_up()
    absent = table[table["solver"] == "C"].assign(solver="D", asked=False, claimed=False, reason="not installed")
    whole = pd.concat([table, absent])
    row = at(summary(whole, LIMIT_S), "D")
    assert row[["refused", "claimed", "why_not"]].to_numpy().tolist() == [[4, 0, "not installed"]]
    assert "D" not in ranking(whole, LIMIT_S).index.get_level_values("solver")
    assert rank_correlation(table, whole, LIMIT_S)["spearman"].item() == pytest.approx(1.0)


def test_effects_by_hand() -> None:
    rows = [
        ("OSQP: defaults", 2.0, 8, 1),
        ("OSQP: polished", 3.0, 9, 0),
        ("OSQP, scaled: defaults", 1.0, 10, 0),
        ("OSQP, scaled: polished", 0.5, 10, 2),
    ]
    summed = pd.DataFrame(rows, columns=["solver", "mean_s", "solved", "false"])
    summed = summed.assign(tolerance=1e-6, kind="convex", size="all", problems=10)
    table = effects(summed).set_index(["scale", "setting"])
    assert table["time_ratio"].to_dict() == {
        ("OSQP", "defaults"): 1.0,
        ("OSQP", "polished"): 1.5,
        ("OSQP, scaled", "defaults"): 1.0,
        ("OSQP, scaled", "polished"): 0.5,
    }
    assert tuple(table.loc[("OSQP", "polished"), ["more_solved", "more_false"]]) == (1, -1)
    assert tuple(table.loc[("OSQP, scaled", "polished"), ["more_solved", "more_false"]]) == (0, 2)

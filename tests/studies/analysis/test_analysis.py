"""The analysis on planted data: what is known of it beforehand must come out, flagged, ranked and attributed."""

from __future__ import annotations

import math
from dataclasses import replace

import pandas as pd
import pytest

from studies.analysis.advice.choose import advise, lines
from studies.analysis.advice.held_out import estimated, held_out, summary
from studies.analysis.advice.questions import asked_question
from studies.analysis.everything import analysed
from studies.analysis.verify import verified
from studies.ask.scene import UsageError
from studies.run.rows import ladders
from studies.scenes.complete import complete
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
        *("verified", "outcomes", "contact_summary", "held_out", "held_out_summary"),
        *("advice_cells", "advice_questions", "disagreements"),
    }
    with pytest.raises(UsageError, match="nothing to analyse"):
        analysed(several_scenes().assign(outcome="time"))


@pytest.mark.parametrize("tolerance", [0.1, 0.02, 0.005, 0.002])
def test_what_is_advised_is_as_accurate_as_it_says(tolerance: float) -> None:
    """By the errors that were planted, against the references; the price is the least of all that qualify."""
    table = several_scenes()
    split = verified(table)
    errors = split.set_index(["label", "quantity"])["error"]
    for scene in dict.fromkeys(table["scene"]):
        question = asked_question(table, split, scene)
        best = advise(question, tolerance).best
        if best is not None:
            assert errors[best["label"], question.quantity] <= tolerance
            good = question.cells[question.cells["bound"] <= tolerance]
            assert best["price"] <= 1.05 * good["price"].min()
    assert advise(asked_question(table, split, "cantilever"), 0.1).best is not None

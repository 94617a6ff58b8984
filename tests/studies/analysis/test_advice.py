"""Verified errors and advice on planted data: what is known beforehand must come out, ranked by whole prices."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies.analysis.advice.choose import (
    CELLS,
    QUESTIONS,
    Advice,
    advise,
    lines,
    shipped_question,
    shipped_tables,
    worth,
)
from studies.analysis.advice.held_out import estimated, held_out, summary
from studies.analysis.advice.questions import COSTS, asked_question
from studies.analysis.everything import analysed
from studies.analysis.verify import verified
from studies.ask.scene import UsageError
from studies.run.answers import PRICES, ladders
from studies.scenes.complete import complete
from support.stores.convergence import EXACT, SIZES, cells

ROOT = Path(__file__).parents[3]
PARTS = re.compile(r'flops|["](?:cost|front)[.](?!dofs|seconds|operations)[a-z_]+')


@pytest.fixture(scope="module")
def sweep() -> pd.DataFrame:
    """The cantilever by two measures, of which one loses 3 %, and two algorithms, of which one takes twice as much."""
    return cells(measures={"exact": 0.0, "linear": 0.03}, contacts={"semismooth": 1.0, "lcp": 2.0})


@pytest.fixture(scope="module")
def scenes() -> pd.DataFrame:
    """Four scenes that converge with the second order, each with its own constant, and a measure that loses 2 %."""
    known = (
        ("cantilever", "tip_deflection_mm", EXACT, "load_fraction=1", 2.0),
        ("hemisphere", "inward_mm", 8.178, "load_fraction=1", 4.0),
        ("sze-moment", "tip_deflection_mm", 7.639437268410975, "load_fraction=0.5", 0.6),
        ("scordelis-lo", "edge_deflection_mm", 0.3024, "E_MPa=4.32e8", 4.0),
    )
    options = {"measures": {"exact": 0.0, "linear": 0.02}, "contacts": {"semismooth": 1.0, "lcp": 1.5}}
    tables = [
        cells(*scene, **options, mesh_error=lambda n, size=size: size / n**2 * (1 + 2 / n)) for *scene, size in known
    ]
    return pd.concat(tables, ignore_index=True)


def advice(table: pd.DataFrame, error: float, scene: str = "cantilever") -> Advice:
    return advise(asked_question(table, verified(table), scene), error)


# --- errors -----------------------------------------------------------------------------------------------------------


def test_what_is_one_ladder() -> None:
    """Two spellings of one request, but not another iteration; a mesh hardly coarser than the next is not a rung."""
    table = cells(tolerances={1e-9: 0.0})
    written = {"solver": "auto", "element": "refined", "tolerance": "1e-09", "load_fraction": "1.0"}
    table["request"] = [
        complete("cantilever", written if n == 16 else {"load_fraction": "1"}, f"{n}x1")[1] for n in table["n1"]
    ]
    (rungs,) = ladders(table)
    assert list(rungs["n1"]) == list(SIZES)
    table.loc[0, "request"] = replace(table["request"][0], newton="plain")
    assert [list(rungs["n1"]) for rungs in ladders(table)] == [list(SIZES[1:])]
    (rungs,) = ladders(cells(sizes=(14, 16, 20, 28)))
    assert list(rungs["n1"]) == [14, 20, 28]


def test_what_the_formulation_loses_is_told_from_mesh_and_tolerance() -> None:
    """Mesh 2/n², measure 3 %, tolerance 1e-2 costs 0.5 %; the reference is exact to 1e-5."""
    table = cells(measures={"exact": 0.0, "linear": 0.03}, tolerances={1e-2: 0.005, 1e-10: 0.0})
    split = verified(table).set_index("label")
    coarse = split.loc["cantilever exact semismooth 8 1e-10"]
    assert coarse["against"] == "reference: exact"
    assert coarse["error"] == pytest.approx(2 / 64, rel=1e-6)
    assert (coarse["formulation_error"], coarse["uncertainty"]) == (0.0, 1e-5)
    loose = split.loc["cantilever exact semismooth 64 0.01"]
    assert loose["error"] == pytest.approx(0.005 + 2 / 64**2, rel=1e-6)
    assert loose["formulation_error"] == 0.0  # that of the tightest tolerance
    other = split.loc["cantilever linear semismooth 64 1e-10"]
    assert other["formulation_error"] == pytest.approx(0.03, rel=1e-4)


def test_without_a_reference_the_exact_measure_is_the_limit() -> None:
    """A load for which the cantilever has no reference: the other measure's loss is still an error."""
    table = cells(setting="load_fraction=0.3", measures={"exact": 0.0, "linear": 0.03})
    split = verified(table).set_index("label")
    exact, linear = (split.loc[f"cantilever {name} semismooth 64 1e-10"] for name in ("exact", "linear"))
    assert exact["against"] == linear["against"] == "limit of cantilever exact semismooth 64 1e-10"
    assert exact["error"] == pytest.approx(2 / 64**2, rel=1e-4)
    assert linear["error"] == pytest.approx(0.03 + 2 / 64**2, rel=1e-4)
    alone = verified(table[table["measure"] == "linear"])
    assert set(alone["against"]) == {"limit of cantilever linear semismooth 64 1e-10"}
    short = verified(table[(table["measure"] == "linear") & (table["n1"] < 20)])
    assert short["error"].isna().all()
    assert set(short["against"]) == {""}


# --- prices -----------------------------------------------------------------------------------------------------------


def test_nothing_is_ranked_by_a_part_of_what_it_costs() -> None:
    """Seconds and all operations are the prices, everywhere."""
    assert (set(COSTS), set(PRICES)) == ({"dofs", "seconds", "operations"}, {"seconds", "operations"})
    names = {
        f"{path.relative_to(ROOT)}: {hit}"
        for folder in ("studies/analysis", "studies/commands", "reports")
        for path in (ROOT / folder).rglob("*")
        if path.suffix in (".py", ".toml")
        for hit in PARTS.findall(path.read_text(encoding="utf-8"))
    }
    assert names == set()


def test_advice_follows_what_is_paid_and_not_a_part_of_it(sweep: pd.DataFrame) -> None:
    """The one with a tenth of the factorisations, and twice the seconds, is not advised."""
    lcp = sweep["contact"] == "lcp"
    stated = sweep.assign(**{"c.factorisations": np.where(lcp, 1, 10), "w.factorisations": np.where(lcp, 1.0, 10.0)})
    actual = advice(stated, 0.01)
    assert actual.best is not None
    assert actual.by_operations is not None
    assert actual.best["contact"] == actual.by_operations["contact"] == "semismooth"


def test_prices_that_hardly_differ_are_a_tie_that_the_error_decides(sweep: pd.DataFrame) -> None:
    near = sweep["t.seconds"].where(sweep["mesh"] != "32x1", 1.04 * sweep["t.seconds"][sweep["mesh"] == "16x1"].min())
    actual = advice(sweep.assign(**{"t.seconds": near}), 0.01).best
    assert actual is not None
    assert actual["mesh"] == "32x1"


def test_a_mesh_whose_value_crosses_the_reference_is_not_advised(sweep: pd.DataFrame) -> None:
    split = verified(sweep)
    coarsest = sweep["label"][sweep["mesh"] == "8x1"]
    crossing = split.assign(error=split["error"].mask(split["label"].isin(coarsest), 0.0))
    assert (crossing["error"] == 0.0).any()
    plain, planted = (advise(asked_question(sweep, each, "cantilever"), 0.005).best for each in (split, crossing))
    assert plain is not None
    assert planted is not None
    assert planted["mesh"] == plain["mesh"] != "8x1"


# --- advice -----------------------------------------------------------------------------------------------------------


def test_advice_is_the_cheapest_that_qualifies(sweep: pd.DataFrame) -> None:
    """2/16² = 0.8 %, 2/8² = 3.1 %."""
    text = "\n".join(lines(advice(sweep, 0.01)))
    assert "cheapest: exact semismooth mixed refined 16x1, tolerance 1e-10: error at most 0.782 %" in text
    assert "runner-up: exact lcp mixed refined 16x1, tolerance 1e-10: 2 times the seconds" in text
    assert "next step, 0.5 %: exact semismooth mixed refined 32x1, tolerance 1e-10: 2.83 times the seconds" in text
    text = "\n".join(lines(advice(cells(), 1e-5)))
    assert "none qualifies of 4 cells" in text
    assert "nearest: error at most 0.0498 %" in text


def test_an_uncertain_reference_cannot_show_what_it_does_not_know() -> None:
    """The pinched hemisphere is known to 0.2 %: no mesh proves 0.1 %."""
    table = cells("hemisphere", "inward_mm", 8.178, sizes=(8, 16, 32, 64, 128))
    assert advice(table, 0.001, "hemisphere").best is None
    assert advice(table, 0.003, "hemisphere").best is not None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"scene": "tyre"}, "scene 'tyre' is not in this campaign; it has cantilever"),
        ({"scene": "cantilever", "quantity": "force_N"}, "no verified quantity 'force_N'; it has tip_deflection_mm"),
        ({"scene": "cantilever", "cost": "beer"}, "cost 'beer' must be one of dofs, seconds, operations"),
        ({"scene": "cantilever", "settings": {"load_fraction": "2"}}, "it was with: load_fraction=1"),
    ],
)
def test_what_cannot_be_advised_is_one_line_with_and_without_a_store(
    arguments: dict, message: str, sweep: pd.DataFrame, tmp_path: Path
) -> None:
    split = verified(sweep)
    with pytest.raises(UsageError, match=message):
        asked_question(sweep, split, **arguments)
    for name, actual in shipped_tables(sweep, split).items():
        actual.to_csv(tmp_path / f"{name}.csv", index=False)
    with pytest.raises(UsageError, match=message):
        shipped_question(**arguments, directory=tmp_path)


@pytest.mark.parametrize(
    ("measures", "said"), [({"linear": 0.0}, 1), ({"exact": 0.0}, 0), ({"exact": 0, "linear": 0}, 0)]
)
def test_a_measure_that_was_solved_alone_is_not_said_to_be_enough(measures: dict[str, float], said: int) -> None:
    """The closed form of a strip is of linear theory, which is 30 % off from the exact measure."""
    text = list(lines(advice(cells(measures=measures), 0.01)))
    assert sum("the error of linear against exact is not known" in line for line in text) == said


def test_settings_that_were_not_solved_are_named_as_they_are_given(sweep: pd.DataFrame) -> None:
    with pytest.raises(
        UsageError, match=r"cantilever was not solved with load_fraction=0\.3 element=arc; it was with: "
    ):
        asked_question(sweep, verified(sweep), "cantilever", settings={"load_fraction": "0.3", "element": "arc"})


def test_what_is_shipped_advises_the_same(sweep: pd.DataFrame, tmp_path: Path) -> None:
    for name, actual in shipped_tables(sweep, verified(sweep)).items():
        actual.to_csv(tmp_path / f"{name}.csv", index=False)
    assert 0 < len(pd.read_csv(tmp_path / f"{CELLS}.csv")) <= len(sweep)
    for tolerance in (0.01, 1e-6):
        of_store, of_files = (
            advice(sweep, tolerance),
            advise(shipped_question("cantilever", directory=tmp_path), tolerance),
        )
        for name in ("best", "runner_up", "next_best", "by_operations"):
            one, other = getattr(of_store, name), getattr(of_files, name)
            assert (one and one["label"]) == (other and other["label"]), (tolerance, name)
    assert pd.read_csv(tmp_path / f"{QUESTIONS}.csv")["cells"].tolist() == [len(sweep)]


def test_what_is_advised_is_as_accurate_as_it_says(scenes: pd.DataFrame) -> None:
    """By the errors that were planted, against the references; the price is the least of all that qualify."""
    split = verified(scenes)
    errors = split.set_index(["label", "quantity"])["error"]
    advised = 0
    for scene in dict.fromkeys(scenes["scene"]):
        question = asked_question(scenes, split, scene)
        for tolerance in (0.1, 0.02, 0.005, 0.002):
            best = advise(question, tolerance).best
            if best is not None:
                assert errors[best["label"], question.quantity] <= tolerance
                good = question.cells[question.cells["bound"] <= tolerance]
                assert best["price"] <= 1.05 * good["price"].min()
                advised += 1
    assert advised >= 8


# --- scenes that are left out -----------------------------------------------------------------------------------------


def test_advice_for_a_scene_that_was_left_out(scenes: pd.DataFrame) -> None:
    """And one whose reference is 5 % from its limit teaches that estimates are not to be trusted."""
    cases = held_out(scenes, verified(scenes))
    assert set(cases["scene"]) >= {"cantilever", "hemisphere", "sze-moment"}
    (row,) = summary(cases[cases["headline"]])[lambda rows: rows["quantities"] == "headline"].to_dict("records")
    assert row["met"] >= 0.95
    assert row["median_regret"] < 1.5
    assert 1.0 <= cases["factor"].min() < cases["factor"].max() < 2.0
    wrong = scenes["q.inward_mm"].where(scenes["scene"] != "hemisphere", 1.05 * scenes["q.inward_mm"])
    moved = scenes.assign(**{"q.inward_mm": wrong})
    taught = held_out(moved, verified(moved)).set_index("scene")["factor"]
    assert taught["cantilever"].max() > 2 * taught["hemisphere"].max()


def test_values_that_go_up_and_down_have_their_limit_between_them() -> None:
    """Errors of +-2/n: by two steps of opposite signs the estimate is the error itself, and is not tripled."""
    table = cells(mesh_error=lambda n: (-1) ** int(math.log2(n)) * 0.2 / n)
    actual = estimated(asked_question(table, verified(table), "cantilever")).sort_values("n1")
    assert list(actual["between"]) == [False, False, True, True]
    assert (actual["estimate"] / actual["error"])[2:].to_numpy() == pytest.approx(1.0, rel=0.05)
    straight = cells(mesh_error=lambda n: 0.2 / n)
    assert not estimated(asked_question(straight, verified(straight), "cantilever"))["between"].any()


def test_cells_of_another_grid_have_an_estimate_of_their_own() -> None:
    """Two spacings of the lines on meshes that are not those of one another."""
    table = pd.concat([cells(), cells(sizes=(12, 20, 40))], ignore_index=True)
    uniform = table["n1"].isin((12, 20, 40))
    other = [replace(it, settings=it.settings.with_values(grading="uniform")) for it in table["request"][uniform]]
    table.loc[uniform, "request"] = pd.Series(other, index=table.index[uniform])
    actual = estimated(asked_question(table, verified(table), "cantilever"))
    assert len(actual) == 7
    assert actual["estimate"].notna().all()


def test_how_sure_advice_is_has_all_its_numbers() -> None:
    said = worth()
    assert re.search(r"on \d+ scenes left out it met the tolerance in \d+ % of \d+ cases", said)
    assert re.search(r"[\d.]+ times the least price in the median, [\d.]+ in the mean, [\d.]+ at worst", said)


def test_all_tables_of_the_analysis(sweep: pd.DataFrame) -> None:
    assert set(analysed(sweep)) == {
        *("outcomes", "contact_summary", "held_out", "held_out_summary"),
        *("advice_cells", "advice_questions", "disagreements"),
    }
    with pytest.raises(UsageError, match="nothing to analyse"):
        analysed(sweep.assign(outcome="time"))

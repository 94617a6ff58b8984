"""Nothing is ranked by a part of what it costs: seconds and all operations are the prices, everywhere."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies.analysis.advice.choose import CELLS, QUESTIONS, advise, shipped_question, shipped_tables, worth
from studies.analysis.advice.questions import COSTS, asked_question
from studies.analysis.verify import verified
from studies.ask.scene import UsageError
from studies.run.rows import PRICES
from support.stores.sweeps import cells

ROOT = Path(__file__).parents[3]
WHOLE = {"dofs", "seconds", "operations"}
PARTS = re.compile(r'flops|["](?:cost|front)[.](?!dofs|seconds|operations)[a-z_]+')


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return cells(measures={"exact": 0.0, "linear": 0.03}, contacts={"semismooth": 1.0, "lcp": 2.0})


def test_prices_are_whole() -> None:
    assert set(COSTS) == WHOLE
    assert set(PRICES) == {"seconds", "operations"}


@pytest.mark.parametrize("folder", ["studies/analysis", "studies/commands/campaign", "reports"])
def test_no_ranking_and_no_page_names_a_part_of_a_cost(folder: str) -> None:
    found = {
        f"{path.relative_to(ROOT)}: {hit}"
        for path in (ROOT / folder).rglob("*")
        if path.suffix in (".py", ".toml")
        for hit in PARTS.findall(path.read_text(encoding="utf-8"))
    }
    assert found == set()


def test_advice_follows_what_is_paid_and_not_a_part_of_it(table: pd.DataFrame) -> None:
    """The one with a tenth of the factorisations, and twice the seconds, is not advised."""
    lcp = table["contact"] == "lcp"
    told = table.assign(**{"c.factorisations": np.where(lcp, 1, 10), "w.factorisations": np.where(lcp, 1.0, 10.0)})
    found = advise(asked_question(told, verified(told), "cantilever"), 0.01)
    assert found.best is not None
    assert found.best["contact"] == "semismooth"
    assert found.by_operations is not None
    assert found.by_operations["contact"] == "semismooth"


def test_prices_that_hardly_differ_are_a_tie_that_the_error_decides(table: pd.DataFrame) -> None:
    near = table["t.seconds"].where(table["mesh"] != "32x1", 1.04 * table["t.seconds"][table["mesh"] == "16x1"].min())
    told = table.assign(**{"t.seconds": near})
    found = advise(asked_question(told, verified(told), "cantilever"), 0.01)
    assert found.best is not None
    assert found.best["mesh"] == "32x1"


def test_a_mesh_whose_value_crosses_the_reference_is_not_advised(table: pd.DataFrame) -> None:
    split = verified(table)
    coarsest = table["label"][table["mesh"] == "8x1"]
    crossing = split.assign(error=split["error"].mask(split["label"].isin(coarsest), 0.0))
    assert (crossing["error"] == 0.0).any()
    plain, planted = (advise(asked_question(table, each, "cantilever"), 0.005).best for each in (split, crossing))
    assert plain is not None
    assert planted is not None
    assert planted["mesh"] == plain["mesh"] != "8x1"


def test_what_is_shipped_advises_the_same(table: pd.DataFrame, tmp_path: Path) -> None:
    split = verified(table)
    for name, found in shipped_tables(table, split).items():
        found.to_csv(tmp_path / f"{name}.csv", index=False)
    assert 0 < len(pd.read_csv(tmp_path / f"{CELLS}.csv")) <= len(table)
    for tolerance in (0.01, 1e-6):
        of_store = advise(asked_question(table, split, "cantilever"), tolerance)
        of_files = advise(shipped_question("cantilever", directory=tmp_path), tolerance)
        assert (of_store.best is None) == (of_files.best is None)
        for name in ("best", "runner_up", "next_best", "by_operations"):
            one, other = getattr(of_store, name), getattr(of_files, name)
            assert (one and one["label"]) == (other and other["label"]), (tolerance, name)
    assert pd.read_csv(tmp_path / f"{QUESTIONS}.csv")["cells"].tolist() == [len(table)]
    with pytest.raises(UsageError, match="scene 'tyre' is not in this campaign; it has cantilever"):
        shipped_question("tyre", directory=tmp_path)
    with pytest.raises(UsageError, match="it was with: load_fraction=1"):
        shipped_question("cantilever", settings={"load_fraction": "2"}, directory=tmp_path)


def test_how_sure_advice_is_has_all_its_numbers() -> None:
    said = worth()
    assert re.search(r"on \d+ scenes left out it met the tolerance in \d+ % of \d+ cases", said)
    assert re.search(r"[\d.]+ times the least price in the median, [\d.]+ in the mean, [\d.]+ at worst", said)

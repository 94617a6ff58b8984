"""The pages of cost and of other programs: parts that are not the whole, grids that reach an error, stated errors."""

from __future__ import annotations

import inspect
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from reports.chapters.cost import cost_page, errors_stated, programs_page, statements_part
from reports.figures.drawing import drawn
from reports.store import load_store
from studies.analysis.tyre import BEHIND
from studies.output.atomic import write_table
from studies.run.lists import MODELS
from support.pages import edit_json, place, row
from support.stores.campaigns import analysed_again

PARTS = sum(cell.options["model"] != "full" for cell in MODELS)


@pytest.mark.slow
def test_a_part_that_is_not_the_whole_is_counted(own_store: Path) -> None:
    path = place(own_store, "model half angle plies").with_suffix(".json")
    edit_json(path, lambda result: result["steps"][0].update(force_N=result["steps"][0]["force_N"] * (1 + 3e-8)))
    contact = place(own_store, "model mirror isotropic") / "contact.csv"
    table = pd.read_csv(contact)
    table.loc[table.index[0], "active"] = 1 - table.loc[table.index[0], "active"]
    write_table(contact, table)
    analysed_again(own_store)
    text = cost_page(load_store(own_store)).text
    assert f"{PARTS - 2} of {PARTS} parts give the force" in text
    assert row(text, "| angle plies | `half` | 10080 ")[-2:] == ["3.0e-08", "under 1e-09"]
    assert row(text, "| isotropic | `mirror` | 10080 ")[-1] == "inf"


@pytest.mark.slow
def test_the_tables_say_what_the_grids_did(own_store: Path) -> None:
    """Errors at random around both bounds: every grid is looked at beside all that are finer."""
    random = np.random.default_rng(0)
    path = own_store / "tables" / "work_precision.csv"
    grids = pd.read_csv(path)
    grids["error"] = 10 ** random.uniform(-4, -1.5, len(grids)) * random.choice([-1, 1], len(grids))
    grids["total_s"] = random.uniform(0.1, 99.0, len(grids)).round(2)
    write_table(path, grids.sample(frac=1.0, random_state=0))
    analysed_again(own_store)
    text = cost_page(load_store(own_store)).text
    unreached = 0
    for within in (0.01, 0.002):
        for (element, family), own in grids.sort_values("unknowns").groupby(["element", "family"]):
            good = own["error"].abs()[::-1].le(within).cummin()[::-1]  # with all that are finer
            enough = own[good & (np.arange(len(own)) < len(own) - BEHIND)]
            start = f"| {100 * within:g} % | `{element}` | `{family}` |"
            of_unknowns, *of_seconds = (row(line, start) for line in text.splitlines() if line.startswith(start))
            if enough.empty:
                unreached += 1
                assert of_unknowns[4] == "–"
                assert of_seconds == []
            else:
                assert of_unknowns[4] == f"{enough['unknowns'].iloc[0]}"
                assert of_seconds[0][4] == f"{enough['total_s'].iloc[0]:.2f}"
    assert 0 < unreached < 20


# --- stated errors --------------------------------------------------------------------------------------------------


def coverage(wrong: bool) -> pd.DataFrame:
    """Uncertainties twice what limits are off; with one that is not inside, and one that was not reached."""
    rows = []
    for k, asked in enumerate((0.05, 0.01, 0.002)):
        row = {"scene": "cantilever", "settings": "", "quantity": "w", "asked": asked, "reached": True, "reason": ""}
        row |= {"stated": 1.0, "uncertainty": asked, "low": 0.0, "high": 3 * asked, "unknowns": 100 * k, "cost": 1.5}
        row |= {"true": 1.0, "known": 1e-5, "decided": True, "inside": True, "off": asked / 2}
        rows.append(row | {"value_error": asked, "value_decided": True, "value_inside": True})
    if wrong:
        rows.append({**rows[0], "quantity": "N", "value_error": 0.2, "value_inside": False, "cost": 5.0})
        lost = {"quantity": "M", "reached": False, "reason": "no grid is enough", "value_decided": False}
        rows.append({**rows[0], **lost})
    return pd.DataFrame(rows)


@pytest.mark.slow
@pytest.mark.parametrize("wrong", [False, True])
def test_stated_errors_are_counted_and_what_does_not_hold_is_listed(own_store: Path, wrong: bool) -> None:
    write_table(own_store / "tables" / "error_coverage.csv", coverage(wrong))
    analysed_again(own_store)
    text = statements_part(load_store(own_store)).text
    assert f"Of {3 + wrong} different statements on 1 scenes" in text
    assert "3 contain it" in text
    assert f"more than 4 times in {int(wrong)} of {3 + wrong}" in text
    if wrong:
        outside, missed = text.split("Statements that are wrong")[1].split("not reached")
        assert "| `cantilever` | – | `N` | 5.0 % | 20.00 % | 0.00 % to 15.00 % | 2.50 % | 5.00 % |" in outside
        assert "no grid is enough" in missed
    else:
        assert "3.0 times as wide as the error" in text
        assert "in 3 of 3; the uncertainty is 2.0 times its error" in text
        assert "Statements that are wrong" not in text
        assert "not reached" not in text


def test_every_decided_limit_is_a_point() -> None:
    (axes,) = inspect.unwrap(errors_stated)(coverage(wrong=True)).axes
    points = [line for line in axes.lines if line.get_linestyle() == "None"]
    assert sum(len(line.get_xdata()) for line in points) == 4


# --- other programs -------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_peers_are_shown_where_they_were_measured(own_store: Path) -> None:
    shell = ("hemisphere", "footprint", "default", "16x16", 1665, 8.1, 8, 0.2, 0.02, 0.1, 0.04, 3, 1.0)
    peer = ("hemisphere", "kratos", "thick", "20x20", 2646, 8.15, 50, 8.0, 0.1, 5.0, 2.0, 3, 40.0)
    never = ("hemisphere", "kratos", "thin", "8x8", 486, 7.0, 50, 1.0, 0.1, 0.5, 0.2, 3, 5.0)
    columns = ["problem", "program", "family", "mesh", "unknowns", "value", "iterations", "seconds"]
    columns += ["start", "assembly", "factorisation", "runs", "units"]
    linear = [("hypar, 0.01", program, "one", "8x8", *shell[4:]) for program in ("footprint", "kratos")]
    measured = pd.DataFrame([shell, peer, never, *linear], columns=columns)
    judged = measured.assign(within=0.01, bar=50.0, uncertainty=0.002, error=measured["value"] / 8.178 - 1)
    judged["linear"] = judged["problem"] != "hemisphere"
    write_table(own_store / "tables" / "peers.csv", judged)
    assert "Time to an equal error" not in programs_page(load_store(own_store)).text  # not analysed yet
    analysed_again(own_store)
    page = programs_page(load_store(own_store))
    actual = row(page.text, "| hemisphere | `kratos` | thick | 1 % |")
    assert actual[4:] == ["20x20", "2646", "-0.34 %", "8.00", "40.0", "40.0", "200.0", "50", "+0.62 %"]
    assert row(page.text, "| hemisphere | `kratos` | thin | 1 % |")[4:10] == ["–"] * 6
    assert row(page.text, "| hypar, 0.01 |") == ["hypar, 0.01", "8x8", "-0.95 %", "-0.95 %", "0.20 %"]
    with drawn() as figures:
        page.pictures["cost-peers.svg"]()
    (figure,) = figures
    assert [axes.get_title() for axes in figure.axes if axes.get_visible()] == ["hemisphere"]

"""The arena on the page of algorithms: a ranking of made-up tables, with failures, refusals and false claims."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from reports.chapter import conclusions
from reports.chapters.arena import NAMED, arena_part, shown_by_name
from reports.markdown import Part
from reports.store import load_store
from studies.arena.solvers.catalogue import SOLVERS
from support.pages.changed import edit_table


@pytest.fixture
def page(store: Path) -> Part:
    return arena_part(load_store(store))


def test_the_ranking_is_first_and_counts_every_kind(page: Part) -> None:
    """Of OSQP, which refuses what is not convex, and of quadprog, which is killed over one problem."""
    first = page.text[: page.text.index("arena-profiles")]
    assert "4 problems (3 convex, 1 not symmetric), asked for 1e-06" in first
    assert "| semismooth | – | 3/3 | 0 | 0 | 0.018 | 1/1 | 0 | 3 | 0 | – | – |" in first
    assert "| OSQP | – | 3/3 | 0 | 0 | 0.031 | refused | – | 0 | 3 | – | – |" in first
    row = next(line for line in first.splitlines() if line.startswith("| quadprog |"))
    assert row.startswith("| quadprog | – | 2/3 | 0 | 1 |")


def test_a_solver_has_one_line_and_its_other_forms_are_counted(own_store: Path) -> None:
    """The scaled form solves more and stands first; the other one's false claims stay on the page."""

    def with_scaled(found: pd.DataFrame) -> pd.DataFrame:
        own = found[found["solver"] == "quadprog"]
        return pd.concat([found, own.assign(solver="quadprog, scaled", solved=own["problems"])], ignore_index=True)

    edit_table(own_store, "solver_summary", with_scaled)
    rows = [line for line in arena_part(load_store(own_store)).text.splitlines() if line.startswith("| quadprog")]
    assert len(rows) == 1
    assert rows[0].startswith("| quadprog | scaled | 3/3 |")
    assert rows[0].endswith("| 2 | 0 |")


def test_settings_of_osqp(page: Part, own_store: Path) -> None:
    assert "- OSQP, polished: 0 solved, 0 false claims, 1.00 times the time" in page.text.replace("+0", "0")
    (own_store / "tables" / "osqp_effects.csv").unlink()
    assert "### OSQP" not in arena_part(load_store(own_store)).text


def test_failures_are_shown_at_the_limit(page: Part) -> None:
    assert "A solve is killed after 2 s of processor time (8.3 % of all" in page.text  # 3 of 36


def test_the_winner_and_the_default_are_concluded(store: Path) -> None:
    opening = conclusions(load_store(store), "algorithms").text
    assert "semismooth solves most of 3 convex problems to 1e-06: 3, in 0.018 s on average" in opening
    assert "Of 8 claims of 3 solvers and forms 0, by 0 of them, are false" in opening
    assert "`semismooth`, the default here, solves 3 and makes 0 false claims, 0 when asked for 1e-08." in opening
    assert (
        "has 4 frozen contact problems of 2 families, 88 to 20000 unknowns and up to 900 candidates, in 1 MB" in opening
    )
    assert "The answers of 4 are certified by two ways, of 1 by a third one, too." in opening


def test_neither_the_winner_nor_osqp_is_grey(page: Part) -> None:
    names = [f"s{n}" for n in range(20)] + ["OSQP"]
    shares = pd.DataFrame({"solver": names, "share": [n / 20 for n in range(20)] + [0.01]})
    shown = shown_by_name(shares)
    assert shown[0] == "s19"
    assert shown[-1] == "OSQP"
    assert len(shown) == NAMED + 1
    drawn = page.pictures["arena-profiles.svg"]()
    assert drawn.startswith("<?xml")
    assert drawn.count("<svg") == 1


def test_what_was_left_out_is_counted_by_its_reason(page: Part) -> None:
    assert "3 steps were left out before: 2 for the size" in page.text
    assert "| the equations are singular to working precision | 1 |" in page.text
    assert "in 0 steps it cycles" in page.text


def test_steps_on_which_our_default_cycles_are_said(own_store: Path) -> None:
    why = "semismooth: the contact set repeats itself and the fallback did not settle it; lcp: something else"
    row = pd.DataFrame([{"name": "p", "family": "panel", "why": why}])
    edit_table(own_store, "problems_left_out", lambda found: pd.concat([found, row], ignore_index=True))
    assert "in 1 steps it cycles" in arena_part(load_store(own_store)).text


def test_without_a_run_of_solvers_the_page_has_the_collection_and_the_entry(own_store: Path) -> None:
    for name in ("solver_summary", "solver_problems", "solver_profiles", "solver_run", "osqp_effects"):
        (own_store / "tables" / f"{name}.csv").unlink()
    text = arena_part(load_store(own_store)).text
    assert "### Enter your own" in text
    assert "were left out before" in text
    assert "killed" not in text


def test_the_entry_on_the_page_enters(page: Part, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its lines are run; ``my_method`` is whoever reads them."""
    monkeypatch.setattr("studies.arena.solvers.catalogue.SOLVERS", dict(SOLVERS))
    lines = page.text.partition("```python\n")[2].partition("```")[0]
    given = {"my_method": lambda step, tolerance: (np.zeros(2), np.zeros(1), False, 3)}
    exec(lines, given)
    found = given["SOLVERS"]["mine"].answer(None, 1e-6)
    assert (found.claimed, found.iterations) == (False, 3)

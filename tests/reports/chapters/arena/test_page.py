"""The page of the arena: counts of made-up tables by tolerance, size and kind, with failures and refusals in them."""

from __future__ import annotations

from pathlib import Path

import pytest

from reports.chapters.arena.page import arena_page
from reports.markdown import Part
from reports.store.statements import of_page
from reports.store.tables import load_store


@pytest.fixture
def page(store: Path) -> Part:
    return arena_page(load_store(store))


def test_solutions_and_false_claims_by_tolerance(page: Part) -> None:
    assert "4 problems (3 convex, 1 not symmetric) are put" in page.text
    assert "| solver | problems | solved, 1e-04 | solved, 1e-06 | solved, 1e-08 | false, 1e-04 |" in page.text
    assert "| semismooth | 3 | 3 | 3 | 3 | 0 | 0 | 0 |" in page.text
    assert "| OSQP | 3 | 3 | 3 | 0 | 0 | 0 | 3 |" in page.text
    assert "| quadprog | 3 | 2 | 2 | 2 | 0 | 0 | 0 |" in page.text


def test_failures_are_shown_at_the_limit(page: Part) -> None:
    """Of OSQP at 1e-8 all claims are false: the mean is the limit, the worst claim 1e-3 over 1e-8."""
    assert "| OSQP | 3 | 3 | 0 | 0 | 3 | 3 | 0 | 1.0e+05 | 2.000 | 1.0 |" in page.text
    assert "| quadprog | 3 | 1 | 0 | 1 | 0 | 0 | 0 | 1.0e-04 | " in page.text
    assert "A solve is killed after 2 s of processor time (8.3 % of all" in page.text  # 3 of 36


def test_refusals_are_listed_with_their_reason(page: Part) -> None:
    assert "2 solvers refuse all of them" in page.text
    assert "| OSQP | 1 | not symmetric |" in page.text
    assert "| semismooth | 3/3, 0.018 | 1/1, 0.002 |" in page.text
    assert "| OSQP | 3/3, 0.031 | refused |" in page.text


def test_sizes(page: Part) -> None:
    assert "| solver | all | below 1000 | 1000 to 10,000 | above |" in page.text
    assert "| quadprog | 2/3, " in page.text
    assert ", 0.020 | 0/1, 2.000 |" in page.text


def test_settings_of_osqp(page: Part, own_store: Path) -> None:
    assert "| OSQP | polished | 3 | 0 | 0 | 0.031 | 1.00 |" in page.text
    (own_store / "tables" / "osqp_effects.csv").unlink()
    assert "Not measured here; `footprint bench solvers" in arena_page(load_store(own_store)).text


def test_the_page_opens_with_the_number_of_problems(store: Path) -> None:
    opening = of_page(load_store(store), "arena")
    assert "Of 4 frozen contact problems 3 are convex programmes. Of 3 solvers" in opening
    assert "semismooth has the most solutions, 3, in 0.018 s on average; 3 of 8 claims, by 1 solvers, are" in opening


def test_the_figure_names_the_solvers(page: Part) -> None:
    drawn = page.pictures["arena-profiles.svg"]()
    assert drawn.startswith("<?xml")
    assert drawn.count("<svg") == 1


def test_the_collection_opens_the_page(store: Path, page: Part) -> None:
    """Two families; kinds, consistent coupling and touching are counted in each."""
    opening = of_page(load_store(store), "arena")
    assert (
        "has 4 frozen contact problems of 2 families, 88 to 20000 unknowns and up to 900 candidates, in 1 MB" in opening
    )
    assert "The answers of 4 are certified by two ways, of 1 by a third one, too." in opening
    assert "| ring | 2 | 88 to 2,000 | 9 to 90 | 1 | 1 | – | – | 1 | 0.50 |" in page.text
    assert "| tyre | 2 | 300 to 20,000 | 30 to 900 | 1 | – | 1 | 1 | – | 0.50 |" in page.text
    assert page.pictures["arena-collection.svg"]().startswith("<?xml")


def test_what_was_left_out_is_counted_by_its_reason(page: Part) -> None:
    assert "3 steps were left out before the rule could ask whether they are new: 2 for the size" in page.text
    assert "| tyre | … MB are too many | 2 |" in page.text


def test_without_a_run_of_solvers_the_page_says_how_to_make_one(own_store: Path) -> None:
    for name in ("solver_summary", "solver_problems", "solver_profiles", "solver_run"):
        (own_store / "tables" / f"{name}.csv").unlink()
    text = arena_page(load_store(own_store)).text
    assert "Not measured here; `footprint bench solvers" in text
    assert "## The collection" in text

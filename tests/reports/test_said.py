"""What pages say of tables that are made up, and what they say where a table is changed or missing."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from reports.chapters.arena import agreement_part, arena_part
from reports.chapters.cost import cost_page, programs_page
from reports.chapters.extremes import extremes_page
from reports.chapters.friction import friction_page
from reports.chapters.invariance import invariance_page
from reports.chapters.locking import locking_part
from reports.chapters.shell_limits import ring_part
from reports.markdown import Part
from reports.store import Store
from studies.analysis.everything import written
from studies.run.lists import MODELS, agreement
from support.pages import edit_table, row, set_values

PARTS = sum(cell.options["model"] != "full" for cell in MODELS)
OTHERS = sum(cell.label.endswith("exact") and "agreement semismooth " not in cell.label for cell in agreement())
BLOCKS = re.split(r"^%% (.*)\n", (Path(__file__).parent / "said.txt").read_text(encoding="utf-8"), flags=re.MULTILINE)
SAID = dict(zip(BLOCKS[1::2], BLOCKS[2::2], strict=True))  # by page, and by change
PAGES = [name for name in SAID if name.endswith(".md")]


def missed(name: str, text: str) -> list[str]:
    """The lines of a block that a text does not bear out."""
    lines = [each for each in SAID[name].format(parts=PARTS, others=OTHERS).splitlines() if each]
    unsaid = [each for each in lines if each.startswith("not: ")]
    said = [each for each in lines if each not in unsaid]
    return [each for each in said if each not in text] + [each for each in unsaid if each[5:] in text]


@pytest.mark.parametrize("page", PAGES)
def test_a_page_says_what_its_tables_say(files: dict[str, str], page: str) -> None:
    assert missed(page, files[page]) == []


def test_limits_stand_in_one_table_a_line_for_measures_and_one_for_algorithms(files: dict[str, str]) -> None:
    for name in ("thinnest shell", "largest rotation in one step", "smallest travel", "stiffest ε"):
        assert sum(line.startswith(f"| {name}, ") for line in files["extremes.md"].splitlines()) == 2
    assert files["shell-limits.md"].count("| shell exact, ν = 0 |") == 1


def test_beside_dissipation_stands_that_it_converges_with_the_load_step(files: dict[str, str]) -> None:
    tables, _, after = files["friction.md"].partition("**Do not rely on the dissipation of these tables.**")
    assert tables.count("dissipated [N m] |") == 2
    message = "in one step each, on a coarser mesh, the dissipation has an error of +100 %, the force one of -4.0 %"
    assert message in after.partition("\n\n")[0]


def test_rates_of_the_famous_failures(files: dict[str, str], loaded: Store) -> None:
    text = files["invariance.md"]
    assert row(text, "| `von-karman` |")[5:7] == ["-0.125 a^4.00", "-0.500 a^2.00"]
    assert row(text, "| `linear` |")[5:7] == ["-0.500 a^2.00", "-0.500 a^2.00"]
    assert row(text, "| `exact` |")[1:7] == ["0"] * 6
    assert float(row(text, "| `donnell` |")[1]) > 0.1  # a translated cylinder strains
    assert row(text, "| `linear` |")[1] == "0"
    assert row(text, "| plate moved and turned |")[-1] == "`donnell` 0.20"
    powers = loaded.table("rigid_body_powers")
    turned = powers.query("measure == 'linear' and surface == 'plate' and motion == 'drilling'").iloc[0]
    assert turned["strain_rate"] == pytest.approx(2, abs=0.01)


def test_points_of_maps_are_counted_by_class_and_cause(files: dict[str, str], loaded: Store) -> None:
    points = loaded.table("extremes")
    asked = points[points["asked"]]
    counts = asked.groupby(["map", "class"]).size()
    share = f"{100 * len(asked) / len(points):.0f} %"
    assert f"{len(asked)} of {len(points)} points are solved ({share})" in files["extremes.md"]
    failed, good = counts["two", "not converged"], counts["two", "converged"]
    message = f"the iteration limit was reached, the tangent gives no reason ({failed} of {failed})"
    assert f"| Two settings | {good} of {failed + good} | {failed} | 0 | {message} |" in files["extremes.md"]


# --- what is said of a change ---------------------------------------------------------------------------------------

Change = Callable[[Store], object]


def put(table: str, **columns: Any) -> Change:
    """Columns of a table, as values or as functions of the table."""
    return lambda store: edit_table(store.path, table, lambda rows: rows.assign(**columns))


def put_at(table: str, number: int, **columns: Any) -> Change:
    """Values in a row of a table."""
    return lambda store: set_values(store.path, table, number, **columns)


def added(table: str, **columns: Any) -> Change:
    """A row more."""
    return lambda store: edit_table(store.path, table, lambda rows: pd.concat([rows, pd.DataFrame([columns])]))


def without(*tables: str) -> Change:
    """Tables that are not there."""

    def remove(store: Store) -> None:
        for name in tables:
            (store.path / "tables" / f"{name}.csv").unlink()

    return remove


def off_its_law(rows: pd.DataFrame) -> pd.Series:
    case = (rows["measure"] == "sanders") & (rows["motion"] == "drilling")
    return rows["strain"].where(~case, rows["strain"] + 1e-3)


def far_off(rows: pd.DataFrame) -> pd.Series:
    return rows["error"].mask(rows["limit"] == "smallest travel", 1.0)


def wrong_on_springs(store: Store) -> None:
    springs = store.table("friction_klarbring")
    (number,) = springs.index[(springs["case"] == "nothing") & (springs["algorithm"] == "qp")]
    set_values(store.path, "friction_klarbring", number, outcome="converged", found="wrong")


def scaled_too(store: Store) -> None:
    """The scaled form solves more and stands first; the other one's false claims stay on the page."""

    def with_scaled(rows: pd.DataFrame) -> pd.DataFrame:
        own = rows[rows["solver"] == "quadprog"]
        return pd.concat([rows, own.assign(solver="quadprog, scaled", solved=own["problems"])], ignore_index=True)

    edit_table(store.path, "solver_summary", with_scaled)


def answers_that_differ(store: Store, count: int) -> None:
    of = {"scene": "plate-contact", "mesh": "64x1", "quantity": "force_N", "why": "load steps"}
    table = pd.DataFrame([{**of, "difference": size} for size in (0.13, 0.02)])
    written(store.path, "report", {"disagreements": table.iloc[:count]})


ACCIDENT = {"class": "broken by accident", "deviation": 0.25, "reason": "nothing explains it"}
CYCLES = "semismooth: the contact set repeats itself and the fallback did not settle it; lcp: something else"
RUN = ("solver_summary", "solver_problems", "solver_profiles", "solver_run", "osqp_effects")
MISSED = {"map": "each", "points": 289, "distance": math.inf, "unlike": 3}
CHANGES: dict[str, tuple[Callable[[Store], Part], Change]] = {
    "a load that is refused": (friction_page, put_at("friction_dragged", 2, failures="friction_cone")),
    "a wrong claim on springs": (friction_page, wrong_on_springs),
    "no public problems": (friction_page, without("friction_public")),
    "a solver in two forms": (arena_part, scaled_too),
    "no settings of OSQP": (arena_part, without("osqp_effects")),
    "a step on which the default cycles": (
        arena_part,
        added("problems_left_out", name="p", family="panel", why=CYCLES),
    ),
    "no run of solvers": (arena_part, without(*RUN)),
    "answers that differ": (agreement_part, partial(answers_that_differ, count=2)),
    "no answers that differ": (agreement_part, partial(answers_that_differ, count=0)),
    "a certified result that is far off": (extremes_page, put("extremes_limits", error=far_off)),
    "boundaries that were missed": (extremes_page, added("extremes_check", **MISSED)),
    "a measure off its law": (invariance_page, put("rigid_body", strain=off_its_law)),
    "an accident": (invariance_page, put_at("symmetry", 0, **ACCIDENT)),
    "no random cases": (invariance_page, without("fuzz")),
    "errors that do not cancel": (ring_part, put("ring_budget", remainder=-0.1, wrong_reason=False)),
    "a reference that is known less well": (cost_page, put("work_precision", known=0.003)),
    "a reference that is not known well": (cost_page, put("work_precision", known=0.02)),
    "no other programs": (programs_page, without("programs")),
}


def test_every_block_is_of_a_page_or_of_a_change() -> None:
    assert {*SAID} == {*PAGES, *CHANGES}


@pytest.mark.parametrize("change", CHANGES)
def test_a_change_is_said(edited: Store, change: str) -> None:
    page, made = CHANGES[change]
    made(edited)
    assert missed(change, page(replace(edited)).text) == []


def test_elements_better_than_their_yardsticks_are_counted(edited: Store) -> None:
    known = edited.table("membrane_locking")["yardstick_reduced"].notna()
    for lost in (0, 1):
        if lost:
            set_values(edited.path, "membrane_locking", int(known.to_numpy().argmax()), energy_norm_error=0.6)
        text = " ".join(locking_part(replace(edited)).text.split())
        assert f"below those of Elmer's reduced element in {known.sum() - lost} of {known.sum()} cases" in text

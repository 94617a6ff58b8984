"""The measured ring on the page "When is a shell not enough", from forces that are made up."""

from __future__ import annotations

from pathlib import Path

import pytest

from reports.chapters.shell_limits import law_part, ring_part
from reports.figures.drawing import drawn
from reports.markdown import Part
from reports.store import load_store
from support.pages.changed import edit_table


@pytest.fixture(scope="module")
def part(store: Path) -> Part:
    return ring_part(load_store(store))


def test_the_part_says_what_the_tables_say(part: Part) -> None:
    assert "outer radius 63.5 mm, inner 41.5 mm" in part.text
    assert "A ring with free sides carries 25 % less than plane strain" in part.text
    assert "**At 44.5 mm, where 32.033 N were measured [N]**" in part.text
    assert part.text.count("| shell exact, ν = 0 |") == 1
    assert "| solid hencky | 32.70 | +0.67 | +0.02 | 0.00 | 0.00 | " in part.text


def test_agreement_by_errors_that_cancel_is_listed(part: Part) -> None:
    line = "- shell von-karman, ν = 0 at 44.5 mm: +0.34 N from the test, +3.52 N from the solid of its law"
    assert f"{line}, against -3.84 N of the law." in part.text
    assert "- solid hencky at 44.5 mm: +2.0 % in the limit of its meshes, where -0.62 N of friction" in part.text


def test_what_does_not_cancel_is_not_said_to(own_store: Path) -> None:
    edit_table(own_store, "ring_budget", lambda table: table.assign(remainder=-0.1, wrong_reason=False))
    assert "cancel" not in ring_part(load_store(own_store)).text


def test_parts_are_stacked_from_zero(part: Part) -> None:
    with drawn() as figures:
        part.pictures["experiment.svg"]()
    (figure,) = figures
    bars = figure.axes[1].patches
    assert sum(bar.get_height() for bar in bars if bar.get_x() > 2.5) == pytest.approx(-0.09 * 32.033 + 100 / 64**2)


def test_small_strain_is_a_number(store: Path) -> None:
    text = law_part(load_store(store)).text
    assert "by at most 2.0 e where a wall carries by stretching, and 0.10 e where it bends" in text
    assert "| balloon | membrane | 0.010 … 0.100 | 2 | 0.5 % |" in text

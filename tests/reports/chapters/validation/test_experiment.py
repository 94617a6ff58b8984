"""The page of the experiment, from forces that are made up."""

from __future__ import annotations

from pathlib import Path

import pytest

from reports.chapters.validation.experiment import CHAPTER, experiment_page
from reports.figures.drawing import drawn
from reports.markdown import Part
from reports.store.tables import load_store


@pytest.fixture(scope="module")
def page(store: Path) -> Part:
    assert CHAPTER.applies(load_store(store))
    return experiment_page(load_store(store))


def test_the_page_says_what_the_tables_say(page: Part) -> None:
    assert "outer radius 63.5 mm, inner 41.5 mm" in page.text
    assert "Hencky's solid has 32.67 N in the limit of its meshes, +2.0 %" in page.text
    assert "| measured |  | 8.008 | 16.017 | 24.025 | 32.033 |" in page.text
    assert "- shell von-karman, ν = 0 at 44.5 mm: +0.34 N off the test, +3.52 N off the solid" in page.text
    assert "this takes back 92 % of the law's part of -3.84 N" in page.text
    assert "carries 25.0 % less than plane strain" in page.text
    assert page.text.count("| shell exact, ν = 0 |") == 1 + 4 + 4


def test_parts_are_stacked_from_zero(page: Part) -> None:
    with drawn() as figures:
        page.pictures["experiment.svg"]()
    (figure,) = figures
    bars = figure.axes[1].patches
    assert sum(bar.get_height() for bar in bars if bar.get_x() > 2.5) == pytest.approx(-0.09 * 32.033 + 100 / 64**2)


def test_small_strain_is_a_number(page: Part) -> None:
    assert "by at most 2.0 e where a wall carries by stretching, and by at most 0.10 e where it bends" in page.text
    assert "| balloon | membrane | 0.010 … 0.100 | 2 | 0.5 % | 1.0 |" in page.text
    assert "| strip | growth | 2 | 0.1000 | +1.00 % | +0.90 % | 0.1 |" in page.text

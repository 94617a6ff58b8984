"""The page "When is a shell not enough", from a table that is made up."""

from __future__ import annotations

import inspect
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from reports.chapters.shell_limits import errors, limits_page
from reports.reading import StoreError
from reports.store import load_store
from studies.experiments.shell_limits.ladder import DEFAULT
from support.stores.walls import made_up_walls


def test_the_page_counts_what_passes_and_shows_where(store: Path) -> None:
    text = limits_page(load_store(store)).text
    assert "It exceeds 5 % in 1 of 3 scenes; within what was solved the error stays below 1 % in: best." in text
    assert "| bad | w | h/R | 0.10 | 0.22 | 2.0 | closed form | 0.00 % | 5.0 | why it is bad |" in text
    assert "| best | not up to 0.5 |" in text
    assert "the solid takes 7 to 7 times the seconds of the shell, 7 times in the median of 3 scenes." in text


def test_without_its_table_there_is_no_page(own_store: Path) -> None:
    (own_store / "tables" / "shell_boundaries.csv").unlink()
    with pytest.raises(StoreError, match=r"shell_boundaries\.csv"):
        limits_page(load_store(own_store))


def test_the_picture_has_a_line_a_scene_and_both_levels() -> None:
    points = made_up_walls()
    usual = points[points["variant"] == DEFAULT].drop_duplicates("case")
    figure = inspect.unwrap(errors)(points, usual)
    assert isinstance(figure, Figure)
    (axes,) = figure.axes
    bad, better, best, *levels = axes.get_lines()
    assert [line.get_label() for line in (bad, better, best)] == ["bad", "better", "best"]
    assert bad.get_ydata() == pytest.approx([1e-4, 9e-4, 1e-2, 0.25])
    assert len(best.get_ydata()) == 0  # nothing that is told from zero
    assert [float(line.get_ydata()[0]) for line in levels] == [0.01, 0.05]

"""What a reader sees: tables that fit the page, and legends that name all that is drawn."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import rgb_to_hsv, to_rgb
from matplotlib.figure import Figure

from reports.chapter import ALL
from reports.contents import CHAPTERS
from reports.figures.drawing import canvas, drawn, legend_above, looks
from reports.markdown import table
from reports.store import load_store
from support.pages.widths import PAGE, widths

OTHERS = ("index.md",)  # made of other stores, or by other rules


def test_no_table_is_wider_than_the_page(files: dict[str, str]) -> None:
    found = {name: list(widths(text)) for name, text in files.items() if name.endswith(".md") and name not in OTHERS}
    wide = {f"{name}: {title}": width for name, own in found.items() for title, width in own if width > PAGE}
    assert wide == {}
    assert sum(map(len, found.values())) > 60


def test_a_table_that_does_not_fit_is_seen() -> None:
    numbers = [["a word", *["0.123456 (+0.12 %)"] * 9]]
    (found,) = widths(table("Too wide", ["a", *"bcdefghij"], numbers))
    assert found[0] == "Too wide"
    assert found[1] > PAGE
    (words,) = widths(table("As words", ["a", *"bcdefghij"], numbers, words=10))
    assert words[1] < PAGE


def coloured(artist: Artist) -> set[str]:
    """The colours of a line, of points or of a legend's mark that are no shades of grey."""
    names = [getattr(artist, f"get_{kind}")() for kind in ("color", "facecolor") if hasattr(artist, f"get_{kind}")]
    every = [each for name in names for each in (name if getattr(name, "ndim", 1) == 2 else [name])]
    shades = [to_rgb(tuple(each)[:3] if not isinstance(each, str) else each) for each in every if len(each) > 0]
    return {str(tuple(round(float(v), 3) for v in rgb)) for rgb in shades if rgb_to_hsv(rgb)[1] > 0.15}


def unnamed(figure: Figure) -> Iterator[str]:
    """Panels with a label that no legend has, or with two colours of which one is in none."""
    legends = [*figure.legends, *(each for axes in figure.axes if (each := axes.get_legend()) is not None)]
    words = {text.get_text() for legend in legends for text in legend.get_texts()}
    marked = {colour for legend in legends for handle in legend.legend_handles if handle for colour in coloured(handle)}
    for axes in figure.axes:
        labels = {line.get_label() for line in axes.lines if not str(line.get_label()).startswith("_")}
        yield from (f"{axes.get_title()}: {label}" for label in labels - words if labels)
        colours = {colour for line in axes.lines if np.size(line.get_xdata()) > 1 for colour in coloured(line)}
        if len(colours) > 1:
            yield from (f"{axes.get_title()}: {colour}" for colour in colours - marked)


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn")
def test_every_legend_names_every_series(store: Path) -> None:
    loaded = load_store(store)
    lost: set[str] = set()
    for chapter in CHAPTERS:
        if not chapter.applies(loaded):
            continue
        for name, picture in chapter.render(loaded).pictures.items():
            with drawn() as figures:
                picture()
            lost |= {f"{name}, {each}" for figure in figures for each in unnamed(figure)}
    assert loaded.pages == ALL
    assert lost == set()


def lines_of(axes: Axes) -> None:
    for name, look in looks(("exact", "linear", "mine")).items():
        axes.plot([0, 1], [0, 1], **look.whole, label=name)


def test_a_series_without_a_name_is_seen() -> None:
    figure, (axes,) = canvas()
    lines_of(axes)
    assert sorted(unnamed(figure))[-3:] == [": exact", ": linear", ": mine"]
    legend_above(figure, axes)
    assert list(unnamed(figure)) == []
    axes.plot([0, 1], [1, 0], color="#E69F00")
    assert len(list(unnamed(figure))) == 1

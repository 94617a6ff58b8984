"""Pictures: looks that never run out, legends that name all that is drawn, values of points, and bodies in space."""

from __future__ import annotations

import base64
import copy
import io
import json
import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.artist import Artist
from matplotlib.colors import rgb_to_hsv, to_rgb
from matplotlib.figure import Figure
from PIL import Image

from contact.catalogue import ALGORITHMS as OURS
from formulations.strains.catalogue import MEASURES as STRAINS
from reports.chapter import ALL
from reports.contents import CHAPTERS
from reports.figures import drawing
from reports.figures.drawing import KNOWN, canvas, drawn, legend_above, looks, svg, ticks
from reports.figures.relief import View, Window, outline, palette, raster, webp
from reports.html import REPORT
from reports.markdown import table
from reports.site import rendered
from reports.store import Store, load_store
from studies.analysis.everything import analysed
from studies.analysis.outcomes import contact_summary, outcomes
from studies.output.atomic import write_json, write_table
from support.pages import PAGE, widths
from support.stores.convergence import cells

# --- tables that fit, legends ---------------------------------------------------------------------------------------


def test_no_table_is_wider_than_the_page(files: dict[str, str]) -> None:
    """But for page one, which is made of other stores."""
    by_name = {name: list(widths(text)) for name, text in files.items() if name.endswith(".md") and name != "index.md"}
    assert [(name, title) for name, own in by_name.items() for title, width in own if width > PAGE] == []
    assert sum(map(len, by_name.values())) > 60
    numbers = [["a word", *["0.123456 (+0.12 %)"] * 9]]
    (wide,) = widths(table("Too wide", ["a", *"bcdefghij"], numbers))
    (words,) = widths(table("As words", ["a", *"bcdefghij"], numbers, words=10))
    assert wide[0] == "Too wide"
    assert words[1] < PAGE < wide[1]


def coloured(artist: Artist) -> set[str]:
    """The colours of a line, of points or of a legend's mark that are not shades of grey."""
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
def test_every_legend_names_every_series(loaded: Store) -> None:
    lost: set[str] = set()
    for chapter in CHAPTERS:
        if chapter.applies(loaded):
            for name, picture in chapter.render(loaded).pictures.items():
                with drawn() as figures:
                    picture()
                lost |= {f"{name}, {each}" for figure in figures for each in unnamed(figure)}
    assert loaded.pages == ALL
    assert lost == set()


def test_a_series_without_a_name_is_seen() -> None:
    figure, (axes,) = canvas()
    for name, look in looks(("exact", "linear", "mine")).items():
        axes.plot([0, 1], [0, 1], **look.whole, label=name)
    assert sorted(unnamed(figure))[-3:] == [": exact", ": linear", ": mine"]
    legend_above(figure, axes)
    assert list(unnamed(figure)) == []
    axes.plot([0, 1], [1, 0], color="#E69F00")
    assert len(list(unnamed(figure))) == 1


# --- values of points -----------------------------------------------------------------------------------------------


def picture_of(log: bool = False, label: str = "one") -> str:
    @svg
    def picture() -> Figure:
        figure, (first, second) = canvas(2)
        first.plot([1, 2, 3], [1.0, 4.0, 9.0], "o-", label=label)
        first.plot([1, 2], [7.123456, np.nan], "x-")
        first.plot([0, 5], [0, 5])
        first.set(xlabel="travel [mm]", ylabel="force\n[N]", yscale="log" if log else "linear")
        second.scatter([0, 1], [5, 6], label="cloud")
        ticks(second, [0, 1], ["plain", "mixed"])
        return figure

    return picture()()


def test_every_point_of_a_line_and_of_a_cloud_has_its_values() -> None:
    named = [f"one: travel [mm] {x}, force [N] {x * x}" for x in (1, 2, 3)]
    for log in (False, True):
        titles = re.findall(r"<title>(.*?)</title>", picture_of(log))
        assert titles == [*named, "travel [mm] 1, force [N] 7.123", "cloud: plain, 5", "cloud: mixed, 6"]


def test_of_too_many_points_the_named_ones_have_theirs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawing, "MOST", 5)
    assert len(re.findall("<title>", picture_of())) == 5
    monkeypatch.setattr(drawing, "MOST", 4)
    assert re.findall("<title>(.*?),", picture_of(label="_hidden")) == ["cloud: plain", "cloud: mixed"]


# --- measures and algorithms that nobody has heard of ---------------------------------------------------------------

MEASURES = tuple(f"made-up-{number}" for number in range(1, 12))
ALGORITHMS = tuple(f"invented-{number}" for number in range(1, 10))
KNOWN_AS = {"measure": "exact", "algorithm": "semismooth", "contact": "semismooth", "contender": "lcp"}  # by column
EXTENDED = """rigid_body small_motions rotation_sweep rotations symmetry false_success contact_summary outcomes membrane
greco_plate choices measure_limits"""  # tables in which a measure or an algorithm has rows of its own
Names = tuple[str, ...]


def extended(rows: pd.DataFrame, measures: Names, algorithms: Names) -> pd.DataFrame:
    """The rows of one known measure or algorithm again under each made-up name."""
    parts = [rows]
    for column, known in KNOWN_AS.items():
        if column in rows:
            names = measures if column == "measure" else algorithms
            own = rows[rows[column] == (known if (rows[column] == known).any() else "linear")]
            parts += [own.assign(**{column: name}) for name in names]
    if "row" in rows:  # of choices: both kinds in one column
        for axis, known, names in (("measure", "linear", measures), ("algorithm", "lcp", algorithms)):
            parts += [rows[(rows["axis"] == axis) & (rows["name"] == known)].assign(name=name) for name in names]
    return pd.concat(parts, ignore_index=True)


def copied(root: Path, row: dict[str, Any], name: str) -> dict[str, Any]:
    """A row of the index, and its record, as another algorithm would have them."""
    new, record = copy.deepcopy(row), json.loads((root / "cells" / f"{row['id']}.json").read_text())
    new |= {"label": row["label"].replace(record["contact"], name), "id": f"{row['id']}-{name}"}
    new["request"]["contact"] = record["contact"] = name
    write_json(root / "cells" / f"{new['id']}.json", record | {"id": new["id"]})
    shutil.copytree(root / "cells" / row["id"], root / "cells" / new["id"], copy_function=os.link)
    return new


def all_pages(root: Path, measures: Names, algorithms: Names, draw: bool) -> dict[str, str]:
    """Every page, of a store that is changed to one in which the catalogues are longer by these."""
    index = json.loads((root / "campaigns/report.json").read_text())
    known = [row for row in index["cells"] if row["label"].startswith("agreement trial-and-error ")]
    index["cells"] += [copied(root, row, name) for row in known for name in algorithms]
    write_json(root / "campaigns/report.json", index)
    two = {"semismooth": 1.0, "lcp": 2.0}
    tyre = cells(measures={"exact": 0.0, "linear": 0.03}, contacts=two)
    sweep = pd.concat([tyre, cells("hemisphere", "inward_mm", 8.178, contacts=two)], ignore_index=True)
    tables = {"outcomes": outcomes(sweep), "contact_summary": contact_summary(sweep)}
    for name, rows in {**analysed(sweep), **tables}.items():
        write_table(root / "tables" / f"{name}.csv", rows.assign(campaign="report"))
    for path in (root / "tables" / f"{name}.csv" for name in EXTENDED.split()):
        write_table(path, extended(pd.read_csv(path), measures, algorithms))
    return rendered(load_store(root), draw=draw)


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(("all_of_them", "draw"), [(False, False), (True, True)])
def test_every_page_takes_made_up_measures_and_algorithms(all_of_them: bool, draw: bool, own_store: Path) -> None:
    """None is dropped: each is on the pages of its kind, by name."""
    measures, algorithms = (names if all_of_them else names[:2] for names in (MEASURES, ALGORITHMS))
    files = all_pages(own_store, measures, algorithms, draw)
    assert {each.file for each in CHAPTERS} | {"index.md", REPORT} <= set(files)
    for page in ("measures.md", "invariance.md", "index.md"):
        assert [name for name in measures if name not in files[page]] == [], page
    for page in ("algorithms.md", "data.md"):  # page one draws them
        assert [name for name in algorithms if name not in files[page]] == [], page


def test_a_look_is_one_for_all_figures_and_never_runs_out() -> None:
    assert [{*known} - {*names} for known, names in zip(KNOWN, (STRAINS, OURS), strict=True)] == [set(), set()]
    for known in KNOWN:
        whole = looks([*known, *MEASURES])
        assert {name: whole[name] for name in known} == looks(known) == looks(reversed(known))
        assert all(looks([name, "zz"])[name] == whole[name] for name in known)  # alone or among others
    actual = looks([*KNOWN[0], *MEASURES]).values()
    assert len(actual) == len({(each.colour, each.marker) for each in actual}) == len(KNOWN[0]) + len(MEASURES)
    assert len({(each.colour, each.line) for each in actual}) == len(actual)
    assert len({each.colour for each in looks(KNOWN[0]).values()}) == len(KNOWN[0])
    assert len(looks(range(100))) == 100
    ours = looks([*STRAINS, *OURS])  # no algorithm looks like a measure
    assert len({(each.colour, each.marker) for each in ours.values()}) == len(ours)


# --- bodies in space ------------------------------------------------------------------------------------------------

CUBE = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
FACES = np.array([[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]])
SQUARE = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
TWO = np.array([[0, 1, 2, 3], [4, 5, 6, 7]])


def test_the_nearer_face_hides_the_farther_whatever_the_order() -> None:
    seen, values = np.concatenate([0.5 * SQUARE + [0.25, 0.25, 1.0], SQUARE]), np.repeat([2.0, 1.0], 4)
    for quads in (TWO, TWO[::-1]):
        actual = raster(seen, quads, values, Window.around(seen, 40, 40, margin=0.0))
        assert np.isfinite(actual.depth).all()
        assert (actual.value[36:44, 36:44] == 2.0).all()
        assert (actual.value[:12] == 1.0).all()
        assert actual.value.mean() == pytest.approx(1.25, abs=0.03)


def test_two_faces_that_cross_are_cut_along_their_line() -> None:
    one = SQUARE + SQUARE[:, [2, 2, 0]]
    seen = np.concatenate([one, one * [1, 1, -1] + [0, 0, 1]])
    actual = raster(seen, TWO, np.repeat([1.0, 2.0], 4), Window.around(seen, 50, 50, margin=0.0))
    assert (actual.value[:, :48] == 2.0).all()
    assert (actual.value[:, 52:] == 1.0).all()


def test_nothing_is_drawn_outside_and_no_point_inside_is_left_out() -> None:
    for size in (3, 37, 130):
        actual = raster(CUBE[:4], FACES[:1], np.zeros(4), Window.around(CUBE[:4], size, size, margin=0.25))
        there = np.isfinite(actual.depth)
        assert there.mean() == pytest.approx(0.25, abs=1.2 / size)
        rows = np.flatnonzero(there.any(axis=1))
        assert there[rows[0] : rows[-1] + 1][:, np.flatnonzero(there.any(axis=0))].all()


def test_the_outline_of_a_cube_is_its_edges_and_that_of_a_plate_its_rim() -> None:
    assert len(outline(View.of("z", 30, 20).of_points(CUBE), FACES)) == 12
    plate = np.array([[x, y, 0.0] for y in range(4) for x in range(4)], float)
    quads = np.array([[4 * j + i, 4 * j + i + 1, 4 * j + i + 5, 4 * j + i + 4] for j in range(3) for i in range(3)])
    assert len(outline(plate, quads)) == 12


def test_a_view_turns_and_its_vertical_is_up() -> None:
    for name, up in (("z", (0, 0, 1)), ("x", (1, 0, 0)), ("-x", (-1, 0, 0))):
        axes = View.of(name, 40, 25).axes
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-14)
        assert np.linalg.det(axes) == pytest.approx(1.0)
        seen = axes @ np.array(up, float)
        assert seen[0] == pytest.approx(0.0, abs=1e-14)
        assert seen[1] > 0


def test_where_nothing_is_the_picture_is_transparent() -> None:
    """Also with fewer colours than the palette holds."""
    actual = raster(CUBE[:4], FACES[:1], CUBE[:4, 0], Window.around(CUBE[:4], 40, 40, margin=0.25))
    for colours in (np.full((*actual.value.shape, 3), 0.86), palette(actual.value, 0.0, 1.0)):
        image = Image.open(io.BytesIO(base64.b64decode(webp(actual, colours)))).convert("RGBA")
        alpha = np.asarray(image)[..., 3]
        assert image.size == (40, 40)
        assert (alpha[:9] == 0).all()
        assert (alpha[12:28, 12:28] == 255).all()

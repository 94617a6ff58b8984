"""The values behind the points of a picture, as the titles that browsers show where the pointer rests."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from html import escape

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator
from matplotlib.transforms import Transform

PER_INCH = 72  # units of an SVG
MOST = 600  # points that have a title; of more, those of named lines
POINT = re.compile(r'<use xlink:href="[^"]*" x="([^"]*)" y="([^"]*)"([^>]*)/>')

Place = tuple[float, float]


def with_values(figure: Figure, svg: str) -> str:
    """The SVG of a figure that was just drawn; each point of its lines and clouds has a title."""
    found = [each for axes in figure.axes for each in _points(figure, axes)]
    if len(found) > MOST:
        found = [each for each in found if each[1]][:MOST]
    titles: dict[Place, str] = {}
    for at, name, values in found:
        titles.setdefault(at, f"{name}: {values}" if name else values)

    def titled(use: re.Match[str]) -> str:
        words = titles.get((round(float(use[1]), 2), round(float(use[2]), 2)))
        return f"{use[0][:-2]}><title>{escape(words)}</title></use>" if words else use[0]

    return POINT.sub(titled, svg)


def _points(figure: Figure, axes: Axes) -> Iterator[tuple[Place, str, str]]:
    """Place in the picture, name of the line and values of each point that is drawn as a marker."""
    if not axes.get_visible():
        return
    lines: list[tuple[Artist, np.ndarray, Transform]]
    lines = [(line, np.asarray(line.get_xydata(), float), line.get_transform()) for line in axes.lines if _marked(line)]
    clouds = [each for each in axes.collections if isinstance(each, PathCollection)]
    lines += [(each, np.asarray(each.get_offsets(), float), each.get_offset_transform()) for each in clouds]
    x_told, y_told = map(_namer, (axes.xaxis, axes.yaxis))
    scale, height = PER_INCH / figure.dpi, PER_INCH * figure.get_figheight()
    for artist, values, transform in lines:
        label = str(artist.get_label())
        name = "" if label.startswith("_") else label
        with np.errstate(all="ignore"):
            places = transform.transform(values) * scale if len(values) else values
        for (x, y), (at_x, at_y) in zip(values, places, strict=True):
            if np.isfinite([at_x, at_y]).all():
                at = round(at_x, 2), round(height - at_y, 2)
                yield at, name, f"{x_told(x)}, {y_told(y)}"


def _marked(line: Line2D) -> bool:
    return line.get_marker() not in ("None", None, "", " ")


def _namer(axis: Axis) -> Callable[[float], str]:
    """Tells a coordinate: with the name of its axis, or by the word that stands at it."""
    name = axis.get_label_text().replace("\n", " ")
    words: dict[float, str] = {}
    if isinstance(axis.get_major_locator(), FixedLocator):
        labels = (each.get_text().replace("\n", " ") for each in axis.get_majorticklabels())
        places = zip(axis.get_majorticklocs(), labels, strict=False)
        words = {round(at, 6): text for at, text in places if re.match("[A-Za-z]", text)}
    return lambda value: words.get(round(value, 6)) or f"{name} {value:.4g}".strip()

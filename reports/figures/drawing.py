"""The look of all pictures, and their way to SVG: same bytes for the same numbers, no window system, no date.

The values behind the points of a picture are the titles that browsers show where the pointer rests. What is drawn is
not known here.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import wraps
from html import escape
from typing import Any, ParamSpec

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.collections import PathCollection
from matplotlib.colors import Colormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator
from matplotlib.transforms import Transform

P = ParamSpec("P")
Picture = Callable[[], str]  # draws itself as SVG text when it is asked for
# Okabe and Ito's colours, told apart with every common colour blindness
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILION, PURPLE = "#0072B2", "#D55E00", "#CC79A7"
WINE, OLIVE, INDIGO = "#661100", "#999933", "#332288"  # Tol's, told apart from those
COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, WINE, INDIGO, OLIVE)
GREY = "#777777"
COMMENT = re.compile(r"\s*<!--.*?-->", re.DOTALL)
LONG_PLACE = re.compile(r"(?<!scale\()\b\d+\.\d{3,}\b")  # the scale of letters stays
SHADES = 33  # odd: none is between the signs
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
LINES = ("-", "--", ":", "-.")
CLASSICAL = ("exact", "linear", "von-karman", "donnell", "sanders", "novozhilov")
FURTHER = ("moderate-rotation", "thin-green-lagrange", "elongation")
ALGORITHMS = ("trial-and-error", "semismooth", "regularised", "augmented-lagrangian", "qp", "lcp")
KNOWN = ((*CLASSICAL, *FURTHER), ALGORITHMS)  # names with a fixed look, no other's; a new one may do without
STYLE: dict[Any, Any] = {
    "svg.fonttype": "path",  # letters as shapes: the same on every reader's machine
    "svg.hashsalt": "footprint",
    "font.family": "DejaVu Sans",  # comes with matplotlib
    "font.size": 10,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.titlesize": 10,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6,
    "legend.fontsize": 9,
    "lines.linewidth": 1.6,
    "lines.markersize": 5,
    "axes.formatter.use_mathtext": True,
}
PER_INCH = 72  # units of an SVG
MOST = 600  # points that have a title; of more, those of named lines
POINT = re.compile(r'<use xlink:href="[^"]*" x="([^"]*)" y="([^"]*)"([^>]*)/>')
Place = tuple[float, float]


@dataclass(frozen=True)
class Look:
    """How one thing is drawn."""

    colour: str
    marker: str
    line: str

    @property
    def points(self) -> dict[str, Any]:
        """Colour and marker."""
        return {"color": self.colour, "marker": self.marker}

    @property
    def dashes(self) -> dict[str, Any]:
        """Colour and line."""
        return {"color": self.colour, "linestyle": self.line}

    @property
    def whole(self) -> dict[str, Any]:
        """Colour, marker and line."""
        return {**self.points, "linestyle": self.line}


def look(number: int) -> Look:
    """The look of a number: the first nine differ in colour, the next nine from them in marker and line, and so on."""
    shifted = number % len(COLOURS) + number // len(COLOURS)
    return Look(COLOURS[number % len(COLOURS)], MARKERS[shifted % len(MARKERS)], LINES[shifted % len(LINES)])


def looks(names: Iterable[Any]) -> dict[Any, Look]:
    """The look of each name, the same on every figure for measures and algorithms, and never running out.

    Known names have their own; unknown ones beside them come after, by name; where none is known, the order counts.
    """
    unique = list(dict.fromkeys(names))
    known = [name for own in KNOWN for name in own]
    if not set(known) & set(unique):
        known = []
    others = [name for name in unique if name not in known]
    order = known + (sorted(others, key=str) if known else others)
    return {name: look(order.index(name)) for name in unique}


def shades(name: str) -> Colormap:
    """A colour map of few colours, which the eye distinguishes as well as many: each is a shape in the file."""
    return mpl.colormaps[name].resampled(SHADES)


def svg(draw: Callable[P, Figure]) -> Callable[P, Picture]:
    """Makes of a function that draws one that returns its picture, still to be drawn, in the look of all pictures."""

    @wraps(draw)
    def picture(*args: P.args, **options: P.kwargs) -> Picture:
        def drawn_as_text() -> str:
            with mpl.rc_context(STYLE):
                return to_svg(draw(*args, **options))

        return drawn_as_text

    return picture


def canvas(
    panels: int = 1, columns: int = 0, width: float = 7.0, height: float = 4.5, head: float = 0.0, sharey: bool = False
) -> tuple[Figure, list[Axes]]:
    """A figure with its panels, ``columns`` side by side (all of them, if none are said), row after row.

    height: of a row [inch]. head: what the figure has above that.
    """
    columns = columns or panels
    rows = math.ceil(panels / columns)
    figure = Figure(figsize=(width, head + height * rows), layout="constrained")
    every = list(figure.subplots(rows, columns, squeeze=False, sharey=sharey).flat)
    for axes in every[panels:]:
        axes.set_visible(False)
    return figure, every[:panels]


def lines(axes: Axes, curves: Mapping[Any, tuple[Any, Any]], **how: Any) -> None:
    """Lines of x and y by name, with their markers."""
    for name, each in looks(curves).items():
        axes.plot(*curves[name], **{**each.points, **how}, label=name)


def legend_above(figure: Figure, axes: Axes, columns: int = 4) -> None:
    """One legend for all panels, of the names in one of them."""
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=columns)


def ticks(axes: Axes, places: Iterable[float], names: Iterable[str] | None = None) -> None:
    """Ticks along x at these places and at no others, named by their numbers unless they have names."""
    at = list(places)
    axes.set_xticks(at, [f"{each:g}" for each in at] if names is None else list(names))
    axes.set_xticks([], minor=True)


_drawn: ContextVar[list[Figure] | None] = ContextVar("drawn", default=None)


@contextmanager
def drawn() -> Iterator[list[Figure]]:
    """Collects the figures that are turned to SVG inside."""
    figures: list[Figure] = []
    token = _drawn.set(figures)
    try:
        yield figures
    finally:
        _drawn.reset(token)


def to_svg(figure: Figure) -> str:
    """The figure as SVG text."""
    collected = _drawn.get()
    if collected is not None:
        collected.append(figure)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    lines = with_values(figure, _rounded(buffer.getvalue().decode())).splitlines()
    return "\n".join(line.strip() for line in lines) + "\n"


def _rounded(text: str) -> str:
    """Places to a hundredth of a point, which no eye resolves, and no comments."""
    return LONG_PLACE.sub(lambda place: f"{float(place[0]):.2f}", COMMENT.sub("", text))


def with_values(figure: Figure, svg: str) -> str:
    """The SVG of a figure that was just drawn; each point of its lines and clouds has a title."""
    points = [each for axes in figure.axes for each in _points(figure, axes)]
    if len(points) > MOST:
        points = [each for each in points if each[1]][:MOST]
    titles: dict[Place, str] = {}
    for at, name, values in points:
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

"""The look of all pictures, and their way to SVG: same bytes for the same numbers, no window system, no date.

What is drawn is not known here.
"""

from __future__ import annotations

import io
from contextlib import AbstractContextManager
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

# Okabe and Ito's colours, told apart with every common colour blindness
BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, VERMILION, PURPLE = (
    *("#000000", "#E69F00", "#56B4E9", "#009E73"),
    *("#F0E442", "#0072B2", "#D55E00", "#CC79A7"),
)
SERIES = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, BLACK)
MARKERS = ("o", "s", "^", "D", "v", "P", "x")
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


def style() -> AbstractContextManager[None]:
    """The settings inside which a picture must be built and turned to SVG."""
    return mpl.rc_context(STYLE)


def canvas(columns: int = 1, width: float = 7.0, height: float = 4.5, rows: int = 1) -> tuple[Figure, list[Axes]]:
    """A figure with axes side by side, row after row."""
    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, list(figure.subplots(rows, columns, squeeze=False).flat)


def to_svg(figure: Figure) -> str:
    """The figure as SVG text."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    lines = buffer.getvalue().decode().splitlines()
    return "\n".join(line.rstrip() for line in lines) + "\n"

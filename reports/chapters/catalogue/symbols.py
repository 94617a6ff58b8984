"""Supports and loads as symbols of a sketch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from html import escape

import numpy as np
import pandas as pd

from reports.figures.drawing import BLACK, BLUE, GREEN, PURPLE, VERMILION
from reports.figures.relief import View, Window

MOST = 36  # of one kind
LONGEST = 46.0  # points, of an arrow
WORDS: Mapping[str, tuple[str, str]] = {  # colour and meaning
    "clamped": (BLACK, "does not move"),
    "hinged": (GREEN, "middle does not move"),
    "held": (BLUE, "neither face moves along the bar"),
    "middle held": (GREEN, "middle does not move along the bar"),
    "force": (VERMILION, "force"),
    "couple": (PURPLE, "couple about the arrow"),
    "pressure": (VERMILION, "pressure"),
    "plane": (PURPLE, "rigid plane"),
}


def thinned(rows: pd.DataFrame) -> pd.DataFrame:
    """At most MOST of the rows, evenly spread."""
    if len(rows) <= MOST:
        return rows
    return rows.iloc[np.unique(np.linspace(0, len(rows) - 1, MOST).astype(int))]


def symbols(marks: pd.DataFrame, view: View, window: Window) -> Iterator[str]:
    """SVG of all marks but the plane, those of one kind together."""
    for kind, own in marks.groupby("kind", sort=False):
        if kind == "plane":
            continue
        shown = _spread(own) if kind in ("held", "middle held") else thinned(own)
        at = window.place(view.of_points(shown[["x", "y", "z"]].to_numpy(float)))
        along = view.of_points(shown[["dx", "dy", "dz"]].to_numpy(float))
        colour = WORDS[str(kind)][0]
        yield f'<g stroke="{colour}" fill="{colour}" stroke-width="1.4">'
        yield from _drawn(str(kind), at, along)
        yield "</g>"


def _spread(rows: pd.DataFrame) -> pd.DataFrame:
    """Some of the bars of each direction, so that none is left out where a body is held in several."""
    main = rows[["dx", "dy", "dz"]].abs().to_numpy().argmax(axis=1)
    return pd.concat([thinned(own) for _, own in rows.groupby(main)])


def _drawn(kind: str, at: np.ndarray, along: np.ndarray) -> Iterator[str]:
    if kind == "clamped":
        yield from (f'<path d="M{x - 2.5:.1f} {y - 2.5:.1f}h5v5h-5z"/>' for x, y in at)
    elif kind == "hinged":
        yield from (f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="#FFFFFF"/>' for x, y in at)
    elif kind in ("held", "middle held"):
        for (x, y), (dx, dy) in zip(at, 6.0 * along[:, :2] * [1, -1], strict=True):
            yield f'<path d="M{x - dx:.1f} {y - dy:.1f}L{x + dx:.1f} {y + dy:.1f}"/>'
    else:
        sizes = np.linalg.norm(along, axis=1)
        longest = LONGEST if len(at) < 4 else 0.6 * LONGEST
        for point, way in zip(at, longest * along[:, :2] * [1, -1] / sizes.max(initial=1e-300), strict=True):
            yield from arrow(point, point + way, double=kind == "couple")


def arrow(start: np.ndarray, end: np.ndarray, double: bool = False) -> Iterator[str]:
    """From a point to another, with one head, or two for a couple; one that is seen from its end is a dot."""
    length = float(np.hypot(*(end - start)))
    if length < 4:
        yield f'<circle cx="{start[0]:.1f}" cy="{start[1]:.1f}" r="2"/>'
        return
    along = (end - start) / length
    across = np.array([-along[1], along[0]])
    yield f'<path d="M{start[0]:.1f} {start[1]:.1f}L{end[0]:.1f} {end[1]:.1f}" fill="none"/>'
    for tip in (end, end - 6 * along) if double else (end,):
        a, b = tip - 7 * along + 3 * across, tip - 7 * along - 3 * across
        yield f'<path d="M{tip[0]:.1f} {tip[1]:.1f}L{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}z"/>'


def corners_of(normal: np.ndarray, level: float, points: np.ndarray) -> np.ndarray:
    """Corners (4, 3) of a piece of the plane n.x = level, a little wider than the points."""
    first = np.roll(np.abs(normal), 1)
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    low = np.array([(points @ way).min() for way in (first, second)])
    high = np.array([(points @ way).max() for way in (first, second)])
    more = 0.05 * float((high - low).max())
    (a, c), (b, d) = low - more, high + more
    return np.array([level * normal + s * first + t * second for s, t in ((a, c), (b, c), (b, d), (a, d))])


def plane(corners: np.ndarray, view: View, window: Window) -> str:
    """A rigid plane by its corners."""
    at = window.place(view.of_points(corners))
    path = "L".join(f"{x:.1f} {y:.1f}" for x, y in at)
    colour = WORDS["plane"][0]
    return f'<path d="M{path}z" fill="{colour}" fill-opacity="0.10" stroke="{colour}" stroke-width="1"/>'


def legend(kinds: list[str], left: float, top: float) -> Iterator[str]:
    """A line for each kind of mark."""
    for i, kind in enumerate(kinds):
        colour, words = WORDS[kind]
        x, y = left + 235 * (i % 2), top + 17 * (i // 2)
        yield f'<g stroke="{colour}" fill="{colour}" stroke-width="1.4">'
        if kind == "plane":
            yield f'<path d="M{x - 8:.0f} {y - 4:.0f}h16v8h-16z" fill-opacity="0.1"/>'
        elif kind in ("force", "couple", "pressure"):
            yield from arrow(np.array([x - 11.0, y]), np.array([x + 9.0, y]), double=kind == "couple")
        else:
            yield from _drawn(kind, np.array([[x, y]]), np.array([[1.0, 0.0, 0.0]]))
        yield "</g>"
        yield f'<text x="{x + 14:.0f}" y="{y + 4:.0f}" font-size="11" fill="#000000">{escape(words)}</text>'

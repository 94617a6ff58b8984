"""The pictures of a scene: at rest with supports and loads, and deformed with a field; the tyre as it is pressed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial, wraps
from html import escape
from typing import ParamSpec

import numpy as np
import pandas as pd

from reports.figures.drawing import BLACK, BLUE, GREEN, PURPLE, VERMILION, Picture
from reports.figures.relief import BANDS, FROM_BELOW, Body, View, Window, outline, palette, raster, webp
from reports.formats import formatted

P = ParamSpec("P")
WIDE, HIGH, TOP, FOOT = 470, 330, 24, 64  # points: of a panel, above and below it
BAR, STEPS, LENGTH = 170, 2, 24.0  # points: length of the colour bar, its ticks; length of an axis
GREY, LOWER = 0.86, 0.4  # of what bears no value; share of the tyre's points that the filmstrip shows
FONT = "DejaVu Sans,Verdana,sans-serif"
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


def later(draw: Callable[P, str]) -> Callable[P, Picture]:
    """Makes of a function that draws one that returns its picture, still to be drawn."""
    return wraps(draw)(lambda *args, **options: partial(draw, *args, **options))


@later
def sheet_picture(body: Body, marks: pd.DataFrame) -> str:
    """Both panels beside one another."""
    both = [*_at_rest(body, marks, (0, TOP)), *_deformed(body, marks, (WIDE + 20, TOP))]
    return svg(2 * WIDE + 20, HIGH + TOP + FOOT, both)


def svg(width: int, height: int, parts: Sequence[str]) -> str:
    """A picture of SVG elements on white."""
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}"'
    ground = f'<rect width="{width}" height="{height}" fill="#FFFFFF"/>'
    return "\n".join([f'{head} font-family="{FONT}">', ground, *parts, "</svg>\n"])


def text(words: str, x: float, y: float, size: int = 12, anchor: str = "start") -> str:
    """A line of words."""
    return (
        f'<text x="{x:.0f}" y="{y:.0f}" font-size="{size}" text-anchor="{anchor}" fill="#000000">{escape(words)}</text>'
    )


def image(data: str, width: int, height: int, at: tuple[float, float] = (0, 0)) -> str:
    """A raster."""
    place = f'x="{at[0]}" y="{at[1]}" width="{width}" height="{height}"'
    return f'<image {place} href="data:image/webp;base64,{data}"/>'


def _at_rest(body: Body, marks: pd.DataFrame, at: tuple[int, int]) -> Iterator[str]:
    """The sketch."""
    view = body.view
    seen = view.of_points(body.rest)
    planes = [corners_of(n, float((body.rest @ n).max()) + 0.04 * body.size, body.rest) for n in _normals(marks)]
    window = Window.around(np.concatenate([seen, *map(view.of_points, planes)]), WIDE, HIGH, margin=0.13)
    layers = raster(seen, body.quads, np.zeros(len(seen)), window)
    yield text("At rest: supports and loads", at[0] + 4, 16, 13)
    yield f'<g transform="translate({at[0]} {at[1]})">'
    yield from (plane(each, view, window) for each in planes)
    yield image(webp(layers, np.full((*layers.value.shape, 3), GREY)), WIDE, HIGH)
    yield from symbols(marks, view, window)
    yield "</g>"
    yield from axes(view, (at[0] + 34, at[1] + HIGH - 30))
    yield from legend(list(dict.fromkeys(map(str, marks["kind"]))), at[0] + 16, at[1] + HIGH + 14)


def _deformed(body: Body, marks: pd.DataFrame, at: tuple[int, int]) -> Iterator[str]:
    """The body where it has gone, before the outline of where it was."""
    view = body.view
    factor = body.magnified
    moved = body.rest + factor * body.u
    seen, before = view.of_points(moved), view.of_points(body.rest)
    planes = [corners_of(n, float((moved @ n).max()), body.rest) for n in _normals(marks)]
    window = Window.around(np.concatenate([seen, before, *map(view.of_points, planes)]), WIDE, HIGH)
    layers = raster(seen, body.quads, body.moved, window)
    largest = float(body.moved.max())
    factor_text = "" if factor == 1 else f", motion magnified {factor:g} times"
    yield text(f"Deformed{factor_text}; at rest dashed", at[0] + 4, 16, 13)
    yield f'<g transform="translate({at[0]} {at[1]})">'
    yield from (plane(each, view, window) for each in planes)
    yield dashed(before, body.quads, window)
    yield image(webp(layers, palette(layers.value, 0.0, largest)), WIDE, HIGH)
    yield "</g>"
    yield from bar("displacement |u| [mm]", largest, (at[0] + 40, at[1] + HIGH + 10))


def _normals(marks: pd.DataFrame) -> np.ndarray:
    """Of the rigid planes (k, 3)."""
    return marks.loc[marks["kind"] == "plane", ["dx", "dy", "dz"]].to_numpy(float)


def dashed(seen: np.ndarray, quads: np.ndarray, window: Window) -> str:
    """The outline of a body."""
    ends = window.place(seen[outline(seen, quads)])
    path = "".join(f"M{a:.1f} {b:.1f}L{c:.1f} {d:.1f}" for (a, b), (c, d) in ends)
    return f'<path d="{path}" fill="none" stroke="#777777" stroke-width="0.8" stroke-dasharray="4 2"/>'


def bar(words: str, largest: float, at: tuple[float, float]) -> Iterator[str]:
    """The colours from zero to the largest value."""
    x, y = at
    for band, colour in enumerate(palette(np.arange(BANDS) + 0.5, 0.0, float(BANDS))):
        shade = "".join(f"{round(255 * part):02X}" for part in colour)
        place = f'x="{x + band * BAR / BANDS:.1f}" y="{y}" width="{BAR / BANDS + 0.3:.1f}" height="11"'
        yield f'<rect {place} fill="#{shade}"/>'
    for step in range(STEPS + 1):
        value = formatted(largest * step / STEPS, ".3g")
        yield text(value, x + BAR * step / STEPS, y + 25, 11, "middle")
    yield text(words, x + BAR + 26, y + 10, 12)


def axes(view: View, at: tuple[float, float]) -> Iterator[str]:
    """The directions x, y and z."""
    for name, way in zip("xyz", view.of_points(np.eye(3)), strict=True):
        x, y = at[0] + LENGTH * way[0], at[1] - LENGTH * way[1]
        yield f'<path d="M{at[0]:.1f} {at[1]:.1f}L{x:.1f} {y:.1f}" stroke="#444444" stroke-width="1"/>'
        yield text(name, at[0] + 1.35 * LENGTH * way[0], at[1] - 1.35 * LENGTH * way[1] + 4, 11, "middle")


@later
def filmstrip(bodies: Sequence[tuple[str, Body]]) -> str:
    """Bodies under their words with the contact pressure on them, all at one scale and with one bar."""
    width, height, columns = 320, 250, 3
    largest = max(float(body.pressure.max()) for _, body in bodies)
    seen = [FROM_BELOW.of_points(body.rest + body.u) for _, body in bodies]
    every = np.concatenate(seen)
    lower = every[every[:, 1] < np.quantile(every[:, 1], LOWER)]  # where the plane is
    window = Window.around(lower, width, height, margin=0.02)
    parts = []
    for number, ((words, body), points) in enumerate(zip(bodies, seen, strict=True)):
        x, y = width * (number % columns), 20 + (height + 24) * (number // columns)
        layers = raster(points, body.quads, body.pressure, window)
        colours = palette(layers.value, 0.0, largest)
        colours[layers.value <= 0] = GREY
        parts += [text(words, x + width / 2, y, 13, "middle"), image(webp(layers, colours), width, height, (x, y + 4))]
    rows = -(-len(bodies) // columns)
    foot = 20 + rows * (height + 24)
    parts += bar("contact pressure [MPa]; grey: none", largest, (40, foot))
    return svg(columns * width, foot + 36, parts)


@later
def thumbnails(bodies: Sequence[tuple[str, Body]]) -> str:
    """Small pictures of deformed bodies over the names of their scenes."""
    width, height, columns = 240, 170, 4
    parts = []
    for number, (scene, body) in enumerate(bodies):
        x, y = width * (number % columns), (height + 26) * (number // columns)
        seen = body.view.of_points(body.rest + body.magnified * body.u)
        layers = raster(seen, body.quads, body.moved, Window.around(seen, width, height, margin=0.08))
        colours = palette(layers.value, 0.0, float(body.moved.max()))
        parts += [
            image(webp(layers, colours), width, height, (x, y)),
            text(scene, x + width / 2, y + height + 14, 12, "middle"),
        ]
    return svg(columns * width, (height + 26) * -(-len(bodies) // columns), parts)


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

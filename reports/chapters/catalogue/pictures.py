"""The pictures of a scene: at rest with supports and loads, and deformed with a field; the tyre as it is pressed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial, wraps
from html import escape
from typing import ParamSpec

import numpy as np
import pandas as pd

from reports.chapters.catalogue.bodies import FROM_BELOW, Body, view_of
from reports.chapters.catalogue.symbols import corners_of, legend, plane, symbols
from reports.figures.drawing import Picture
from reports.figures.relief import BANDS, View, Window, outline, palette, raster, webp
from reports.formats import formatted

P = ParamSpec("P")
WIDE, HIGH, TOP, FOOT = 470, 330, 24, 64  # points: of a panel, above and below it
BAR, STEPS = 170, 2  # points: length of the colour bar; and its ticks
GREY, LOWER = 0.86, 0.4  # of what bears no value; share of the tyre's points that the filmstrip shows
FONT = "DejaVu Sans,Verdana,sans-serif"


def later(draw: Callable[P, str]) -> Callable[P, Picture]:
    """Makes of a function that draws one that returns its picture, still to be drawn."""
    return wraps(draw)(lambda *args, **options: partial(draw, *args, **options))


@later
def sheet_picture(body: Body, marks: pd.DataFrame, scene: str) -> str:
    """Both panels beside one another."""
    view = view_of(scene)
    both = [*_at_rest(body, marks, view, (0, TOP)), *_deformed(body, marks, view, (WIDE + 20, TOP))]
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


def _at_rest(body: Body, marks: pd.DataFrame, view: View, at: tuple[int, int]) -> Iterator[str]:
    """The sketch."""
    seen = view.of_points(body.rest)
    planes = [corners_of(n, float((body.rest @ n).max()) + 0.04 * body.size, body.rest) for n in _normals(marks)]
    window = Window.around(np.concatenate([seen, *map(view.of_points, planes)]), WIDE, HIGH, margin=0.13)
    found = raster(seen, body.quads, np.zeros(len(seen)), window)
    yield text("At rest: supports and loads", at[0] + 4, 16, 13)
    yield f'<g transform="translate({at[0]} {at[1]})">'
    yield from (plane(each, view, window) for each in planes)
    yield image(webp(found, np.full((*found.value.shape, 3), GREY)), WIDE, HIGH)
    yield from symbols(marks, view, window)
    yield "</g>"
    yield from axes(view, (at[0] + 34, at[1] + HIGH - 30))
    yield from legend(list(dict.fromkeys(map(str, marks["kind"]))), at[0] + 16, at[1] + HIGH + 14)


def _deformed(body: Body, marks: pd.DataFrame, view: View, at: tuple[int, int]) -> Iterator[str]:
    """The body where it has gone, before the outline of where it was."""
    factor = body.magnified
    moved = body.rest + factor * body.u
    seen, before = view.of_points(moved), view.of_points(body.rest)
    planes = [corners_of(n, float((moved @ n).max()), body.rest) for n in _normals(marks)]
    window = Window.around(np.concatenate([seen, before, *map(view.of_points, planes)]), WIDE, HIGH)
    found = raster(seen, body.quads, body.moved, window)
    largest = float(body.moved.max())
    told = "" if factor == 1 else f", motion magnified {factor:g} times"
    yield text(f"Deformed{told}; at rest dashed", at[0] + 4, 16, 13)
    yield f'<g transform="translate({at[0]} {at[1]})">'
    yield from (plane(each, view, window) for each in planes)
    yield dashed(before, body.quads, window)
    yield image(webp(found, palette(found.value, 0.0, largest)), WIDE, HIGH)
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


def axes(view: View, at: tuple[float, float], length: float = 24.0) -> Iterator[str]:
    """The directions x, y and z."""
    for name, way in zip("xyz", view.of_points(np.eye(3)), strict=True):
        x, y = at[0] + length * way[0], at[1] - length * way[1]
        yield f'<path d="M{at[0]:.1f} {at[1]:.1f}L{x:.1f} {y:.1f}" stroke="#444444" stroke-width="1"/>'
        yield text(name, at[0] + 1.35 * length * way[0], at[1] - 1.35 * length * way[1] + 4, 11, "middle")


@later
def filmstrip(bodies: Sequence[tuple[str, Body]], columns: int = 3) -> str:
    """Bodies under their words with the contact pressure on them, all at one scale and with one bar."""
    width, height = 320, 250
    largest = max(float(body.pressure.max()) for _, body in bodies)
    seen = [FROM_BELOW.of_points(body.rest + body.u) for _, body in bodies]
    every = np.concatenate(seen)
    lower = every[every[:, 1] < np.quantile(every[:, 1], LOWER)]  # where the plane is
    window = Window.around(lower, width, height, margin=0.02)
    parts = []
    for number, ((words, body), points) in enumerate(zip(bodies, seen, strict=True)):
        x, y = width * (number % columns), 20 + (height + 24) * (number // columns)
        found = raster(points, body.quads, body.pressure, window)
        colours = palette(found.value, 0.0, largest)
        colours[found.value <= 0] = GREY
        parts += [text(words, x + width / 2, y, 13, "middle"), image(webp(found, colours), width, height, (x, y + 4))]
    rows = -(-len(bodies) // columns)
    foot = 20 + rows * (height + 24)
    parts += bar("contact pressure [MPa]; grey: none", largest, (40, foot))
    return svg(columns * width, foot + 36, parts)


@later
def thumbnails(bodies: Sequence[tuple[str, Body]], columns: int = 4) -> str:
    """Small pictures of deformed bodies over the names of their scenes."""
    width, height = 240, 170
    parts = []
    for number, (scene, body) in enumerate(bodies):
        x, y = width * (number % columns), (height + 26) * (number // columns)
        seen = view_of(scene).of_points(body.rest + body.magnified * body.u)
        found = raster(seen, body.quads, body.moved, Window.around(seen, width, height, margin=0.08))
        colours = palette(found.value, 0.0, float(body.moved.max()))
        parts += [
            image(webp(found, colours), width, height, (x, y)),
            text(scene, x + width / 2, y + height + 14, 12, "middle"),
        ]
    return svg(columns * width, (height + 26) * -(-len(bodies) // columns), parts)

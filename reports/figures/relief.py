"""A body in space as a picture: seen from far away, the nearest of its faces at every point, lit from the viewer.

Faces hide one another by their depth at every point of the picture, so that no order of drawing can be wrong. Scenes
have fixed views; small motions are magnified.
"""

from __future__ import annotations

import base64
import io
import math
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from PIL import Image

FINER = 2  # points of the raster a point of the picture, each way
BANDS = 16  # of colour
COLOURS = 48  # of a picture, with its shades
AMBIENT = 0.62  # of the light that a face seen from the side still has
LINE, LINE_SHADE, DENSE = (
    0.55,
    0.45,
    4.5,
)  # half width and strength of the lines between faces; none where they are closer
SPACING = 0.8  # points of the raster between samples of a face
SAMPLES = np.array([2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64, 91, 128, 181, 256, 512, 1024, 2048])  # along its sides
TURN = np.cos(np.deg2rad(40.0))  # two faces that turn by more meet in an edge
SMALL, SHOWN = 0.028, 0.12  # motions below the one share of the size of a body are shown as about the other


@dataclass(frozen=True, eq=False)
class View:
    """From where a body is seen: the rows of ``axes`` (3, 3) point right, up, and to the viewer."""

    axes: np.ndarray

    @classmethod
    def of(cls, up: str = "z", azimuth: float = -55.0, elevation: float = 26.0) -> View:
        """``up`` [a coordinate axis, as "-x"] is vertical; angles [deg] around it and above the horizon."""
        vertical = np.eye(3)["xyz".index(up[-1])] * (-1.0 if up.startswith("-") else 1.0) + 0.0
        first = np.roll(np.abs(vertical), 1)
        second = np.cross(vertical, first)
        turn, rise = np.deg2rad(azimuth), np.deg2rad(elevation)
        towards = np.cos(rise) * (np.cos(turn) * first + np.sin(turn) * second) + np.sin(rise) * vertical
        right = np.cross(vertical, towards)
        right /= np.linalg.norm(right)
        return cls(np.stack([right, np.cross(towards, right), towards]))

    def of_points(self, points: np.ndarray) -> np.ndarray:
        """Right, up and depth (..., 3) of points."""
        return points @ self.axes.T


@dataclass(frozen=True)
class Window:
    """The part of the seen plane that a picture of ``width`` by ``height`` shows: its centre, and points a length."""

    width: int
    height: int
    centre: tuple[float, float]
    scale: float

    @classmethod
    def around(cls, seen: np.ndarray, width: int, height: int, margin: float = 0.06) -> Window:
        """All of the seen points (n, 3), equal scales, with a margin on every side."""
        low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
        free = 1 - 2 * margin
        extent = np.maximum(high - low, 1e-12 * max(1.0, float(np.abs(seen).max())))
        scale = float(np.min(free * np.array([width, height]) / extent))
        middle = 0.5 * (low + high)
        return cls(width, height, (float(middle[0]), float(middle[1])), scale)

    def place(self, seen: np.ndarray) -> np.ndarray:
        """Points of the picture (..., 2), from its upper left corner."""
        right = self.width / 2 + self.scale * (seen[..., 0] - self.centre[0])
        down = self.height / 2 - self.scale * (seen[..., 1] - self.centre[1])
        return np.stack([right, down], axis=-1)


def palette(values: np.ndarray, low: float, high: float) -> np.ndarray:
    """Colours (..., 3) in 0 to 1, in bands between two values."""
    share = np.clip((values - low) / (high - low), 0.0, 1.0) if high > low else np.zeros_like(values)
    band = (np.minimum(np.floor(share * BANDS), BANDS - 1) + 0.5) / BANDS
    return np.asarray(mpl.colormaps["viridis"](band))[..., :3]


@dataclass(frozen=True, eq=False)
class Raster:
    """What is nearest at every point: depth (-inf where nothing is), value and light of its face, whether on a line."""

    depth: np.ndarray
    value: np.ndarray
    light: np.ndarray
    line: np.ndarray


def raster(seen: np.ndarray, quads: np.ndarray, values: np.ndarray, window: Window) -> Raster:
    """Quadrilaterals (q, 4) of seen points (n, 3) with values (n,), as bilinear patches.

    Every patch is sampled closer than the points of the raster lie, and what is nearest is written last.
    """
    at = np.concatenate([FINER * window.place(seen), seen[:, 2:], values[:, None]], axis=1)[quads]  # (q, 4, 4)
    lights = AMBIENT + (1 - AMBIENT) * np.abs(_normals(seen, quads)[:, 2])
    sides = np.linalg.norm(at[:, :, :2] - np.roll(at[:, :, :2], -1, axis=1), axis=-1)
    along, across = (np.maximum(sides[:, i], sides[:, i + 2]) for i in (0, 1))
    lined = float(np.median(sides)) > FINER * DENSE
    counts = np.searchsorted(SAMPLES, np.stack([along, across], axis=-1) / SPACING)
    pieces = []
    for pair in np.unique(counts, axis=0):
        same = np.all(counts == pair, axis=1)
        own = (at[same], lights[same], along[same], across[same])
        pieces.append(_samples(*own, *(int(SAMPLES[min(i, len(SAMPLES) - 1)]) for i in pair)))
    x, y, depth, value, light, line = np.concatenate(pieces, axis=1)
    shape = (FINER * window.height, FINER * window.width)
    inside = (x >= 0) & (x < shape[1]) & (y >= 0) & (y < shape[0])
    order = np.flatnonzero(inside)[np.argsort(depth[inside], kind="stable")]
    where = y[order].astype(np.intp) * shape[1] + x[order].astype(np.intp)
    layers = Raster(np.full(shape, -np.inf), np.zeros(shape), np.zeros(shape), np.zeros(shape, bool))
    for layer, each in (
        (layers.depth, depth),
        (layers.value, value),
        (layers.light, light),
        (layers.line, line * lined),
    ):
        layer.ravel()[where] = each[order]
    return layers


def _samples(at: np.ndarray, lights: np.ndarray, along: np.ndarray, across: np.ndarray, n: int, m: int) -> np.ndarray:
    """Place, depth, value, light and whether on a line (6, k) of n by m samples of patches (q, 4 corners, 4)."""
    s, t = np.repeat((np.arange(n) + 0.5) / n, m), np.tile((np.arange(m) + 0.5) / m, n)
    shares = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])
    x, y, depth, value = np.einsum("qcf,ck->fqk", at, shares)
    edge = np.minimum(np.minimum(s, 1 - s) * along[:, None], np.minimum(t, 1 - t) * across[:, None])
    light = np.broadcast_to(lights[:, None], x.shape)
    return np.stack([np.floor(x), np.floor(y), depth, value, light, edge < FINER * LINE]).reshape(6, -1)


def _normals(seen: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Unit normals (q, 3)."""
    normals = np.cross(seen[quads[:, 2]] - seen[quads[:, 0]], seen[quads[:, 3]] - seen[quads[:, 1]])
    length = np.linalg.norm(normals, axis=1)
    return np.asarray(normals / np.where(length > 0, length, 1.0)[:, None])


def webp(layers: Raster, colours: np.ndarray) -> str:
    """The picture as base64 of a lossless WebP with few colours, clear where nothing is; colours (..., 3) of points."""
    there = np.isfinite(layers.depth)
    lit = colours * (layers.light * np.where(layers.line, 1 - LINE_SHADE, 1.0))[..., None]
    lit = np.where(there[..., None], lit, 1.0)
    height, width = (n // FINER for n in there.shape)
    mean = lit.reshape(height, FINER, width, FINER, 3).mean(axis=(1, 3))
    seen = there.reshape(height, FINER, width, FINER).any(axis=(1, 3))
    few = Image.fromarray(np.round(255 * mean).astype(np.uint8)).quantize(COLOURS, dither=Image.Dither.NONE)
    opaque = np.dstack([np.asarray(few.convert("RGB")), np.where(seen, 255, 0).astype(np.uint8)])
    opaque[~seen] = 0
    file = io.BytesIO()
    Image.fromarray(opaque).save(file, format="webp", lossless=True, quality=100, method=6)
    return base64.b64encode(file.getvalue()).decode("ascii")


def outline(seen: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Segments (k, 2) of points: where a body ends, is bent sharply, or turns from the viewer."""
    normals = _normals(seen, quads)
    ends = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    forward = ends[:, 0] < ends[:, 1]
    keys, inverse, counts = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(inverse.ravel(), kind="stable")
    face = np.repeat(np.arange(len(quads)), 4)[order]
    # two faces run through their common side in opposite ways where both normals point out
    sign = np.where(forward, 1.0, -1.0)[order]
    starts = np.cumsum(counts) - counts
    alone = counts != 2
    a, b = face[starts], face[np.minimum(starts + 1, len(face) - 1)]
    way = -sign[starts] * sign[np.minimum(starts + 1, len(face) - 1)]
    bent = np.einsum("ij,ij->i", normals[a], normals[b]) * way < TURN
    turned = normals[a, 2] * normals[b, 2] * way < 0
    return keys[alone | bent | turned]


FROM_BELOW = View.of("-x", 42.0, -24.0)  # of the tyre, so that its patch is seen


@dataclass(frozen=True, eq=False)
class Body:
    """Points at rest (n, 3) with displacement and pressure, the quadrilaterals (q, 4) of its skin, and its view."""

    rest: np.ndarray
    u: np.ndarray
    pressure: np.ndarray
    quads: np.ndarray
    view: View

    @property
    def size(self) -> float:
        """Diagonal of its box."""
        return float(np.linalg.norm(np.ptp(self.rest, axis=0)))

    @property
    def moved(self) -> np.ndarray:
        """Length of the displacements (n,)."""
        return np.asarray(np.linalg.norm(self.u, axis=1))

    @property
    def magnified(self) -> float:
        """1, or for small motions a round number that shows them."""
        largest = float(self.moved.max())
        if largest == 0 or largest > SMALL * self.size:
            return 1.0
        wanted = SHOWN * self.size / largest
        power = 10.0 ** math.floor(math.log10(wanted))
        return next(power * digit for digit in (5, 2, 1) if power * digit <= wanted)

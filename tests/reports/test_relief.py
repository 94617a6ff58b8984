"""Bodies in space: what is nearer hides what is farther, whatever the order; outlines; windows."""

from __future__ import annotations

import base64
import io

import numpy as np
import pytest
from PIL import Image

from reports.figures.relief import View, Window, outline, palette, raster, webp

CUBE = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
FACES = np.array([[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]])
FRONT = View(np.eye(3))


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_the_nearer_face_hides_the_farther(order: tuple[int, int]) -> None:
    near = np.array([[0.25, 0.25, 1.0], [0.75, 0.25, 1.0], [0.75, 0.75, 1.0], [0.25, 0.75, 1.0]])
    far = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    quads = np.array([[0, 1, 2, 3], [4, 5, 6, 7]])[list(order)]
    seen, values = np.concatenate([near, far]), np.repeat([2.0, 1.0], 4)
    found = raster(seen, quads, values, Window.around(seen, 40, 40, margin=0.0))
    assert np.isfinite(found.depth).all()
    middle, rim = found.value[36:44, 36:44], found.value[:12]
    assert (middle == 2.0).all()
    assert (rim == 1.0).all()
    assert found.value.mean() == pytest.approx(1.25, abs=0.03)


def test_two_faces_that_cross_are_cut_along_their_line() -> None:
    one = np.array([[0, 0, 0], [1, 0, 1], [1, 1, 1], [0, 1, 0]], float)
    two = one * [1, 1, -1] + [0, 0, 1]
    seen = np.concatenate([one, two])
    quads = np.array([[0, 1, 2, 3], [4, 5, 6, 7]])
    found = raster(seen, quads, np.repeat([1.0, 2.0], 4), Window.around(seen, 50, 50, margin=0.0))
    assert (found.value[:, :48] == 2.0).all()
    assert (found.value[:, 52:] == 1.0).all()


def test_nothing_is_drawn_outside_and_no_point_inside_is_left_out() -> None:
    for size in (3, 37, 130):
        found = raster(CUBE[:4], FACES[:1], np.zeros(4), Window.around(CUBE[:4], size, size, margin=0.25))
        there = np.isfinite(found.depth)
        assert there.mean() == pytest.approx(0.25, abs=1.2 / size)
        rows = np.flatnonzero(there.any(axis=1))
        assert there[rows[0] : rows[-1] + 1][:, np.flatnonzero(there.any(axis=0))].all()


def test_the_outline_of_a_cube_is_its_edges_and_that_of_a_plate_its_rim() -> None:
    assert len(outline(View.of("z", 30, 20).of_points(CUBE), FACES)) == 12
    plate = np.array([[x, y, 0.0] for y in range(4) for x in range(4)], float)
    quads = np.array([[4 * j + i, 4 * j + i + 1, 4 * j + i + 5, 4 * j + i + 4] for j in range(3) for i in range(3)])
    assert len(outline(FRONT.of_points(plate), quads)) == 12


@pytest.mark.parametrize(("name", "up"), [("z", (0, 0, 1)), ("x", (1, 0, 0)), ("-x", (-1, 0, 0))])
def test_a_view_turns_and_its_vertical_is_up(name: str, up: tuple[float, float, float]) -> None:
    axes = View.of(name, 40, 25).axes
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    seen = axes @ np.array(up, float)
    assert seen[0] == pytest.approx(0.0, abs=1e-14)
    assert seen[1] > 0


@pytest.mark.parametrize("grey", [True, False])
def test_where_nothing_is_the_picture_is_transparent(grey: bool) -> None:
    """Also with fewer colours than the palette holds."""
    found = raster(CUBE[:4], FACES[:1], CUBE[:4, 0], Window.around(CUBE[:4], 40, 40, margin=0.25))
    colours = np.full((*found.value.shape, 3), 0.86) if grey else palette(found.value, 0.0, 1.0)
    image = Image.open(io.BytesIO(base64.b64decode(webp(found, colours)))).convert("RGBA")
    alpha = np.asarray(image)[..., 3]
    assert image.size == (40, 40)
    assert (alpha[:9] == 0).all()
    assert (alpha[12:28, 12:28] == 255).all()

"""Cut meshes, and normals from positions, against the surfaces that the nodes were taken from."""

from collections.abc import Callable

import numpy as np
import pytest

from formulations.geometry.quad_cuts import cut, nodal_normals

Point = tuple[np.ndarray, np.ndarray]  # (N, 3) each: positions and unit normals
OFF = ((-0.6, 0.7), (-0.4, 0.9))  # ends of both coordinates
RATE = 0.9


def unit(x: np.ndarray) -> np.ndarray:
    return x / np.linalg.norm(x, axis=-1, keepdims=True)


def cylinder(a: np.ndarray, b: np.ndarray) -> Point:
    n = np.stack([np.cos(a), np.sin(a), 0 * a], axis=-1)
    return n + np.stack([0 * a, 0 * a, b], axis=-1), n


def sphere(a: np.ndarray, b: np.ndarray) -> Point:
    x = np.stack([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)], axis=-1)
    return x, x


def twisted(a: np.ndarray, b: np.ndarray) -> Point:
    """A strip along z whose lines of b turn with a: (b cos ka, b sin ka, a)."""
    k = RATE
    x = np.stack([b * np.cos(k * a), b * np.sin(k * a), a], axis=-1)
    along = np.stack([-b * k * np.sin(k * a), b * k * np.cos(k * a), np.ones_like(a)], axis=-1)
    across = np.stack([np.cos(k * a), np.sin(k * a), 0 * a], axis=-1)
    return x, unit(np.cross(along, across))


def off_cylinder(x: np.ndarray) -> Point:
    return np.linalg.norm(x[:, :2], axis=-1) - 1, unit(x * [1, 1, 0])


def off_sphere(x: np.ndarray) -> Point:
    return np.linalg.norm(x, axis=-1) - 1, unit(x)


def off_twisted(x: np.ndarray) -> Point:
    a, k = x[:, 2], RATE
    off = -x[:, 0] * np.sin(k * a) + x[:, 1] * np.cos(k * a)
    return off, twisted(a, x[:, 0] * np.cos(k * a) + x[:, 1] * np.sin(k * a))[1]


def skewed(shape: Callable[[np.ndarray, np.ndarray], Point], m: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """m x m elements that follow no lines of curvature; the rim stays on lines of the coordinates."""
    s, t = np.meshgrid(*2 * [np.linspace(0, 1, m + 1)], indexing="ij")
    bump = 0.6 * s * (1 - s) * t * (1 - t)
    at = [low + (high - low) * (c + way * bump) for (low, high), c, way in zip(OFF, (s, t), (1, -0.7), strict=True)]
    x, n = shape(at[0].ravel(), at[1].ravel())
    number = np.arange(s.size).reshape(s.shape)
    elements = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    return x, n, elements


@pytest.mark.parametrize(
    ("shape", "off", "cap"),
    [(cylinder, off_cylinder, 1e-6), (sphere, off_sphere, 5e-6), (twisted, off_twisted, 1e-6)],
    ids=("cylinder", "sphere", "twisted strip"),
)
def test_new_nodes_lie_on_the_surface_to_the_fourth_order(shape, off, cap) -> None:
    """Beside a rim that curves within its surface to the third; normals to one order less."""
    meshes, far, turn = (8, 16), [], []
    for m in meshes:
        x, n, elements = skewed(shape, m)
        fine = cut(x, n, elements, 3, 20.0)
        assert np.array_equal(fine.middle[: len(x)], x)
        assert np.array_equal(fine.normals[: len(x)], n)
        assert np.allclose(np.einsum("ms,msx->mx", fine.shares, x[fine.around]), fine.middle, rtol=0, atol=0.03)
        inside = np.pad(np.ones((m - 2, m - 2), bool), 1).ravel()
        nodes = np.unique(fine.elements.reshape(m * m, -1)[inside])
        distance, normals = off(fine.middle)
        far.append((np.abs(distance).max(), np.abs(distance[nodes]).max()))
        turn.append(np.linalg.norm(fine.normals - normals, axis=-1).max())
    everywhere, within = np.log2(np.divide(*far))
    assert everywhere > 2.9
    assert within > 3.4 or shape is cylinder  # whose nodes inside are nearer than the lines of the mesh are smooth
    assert far[-1][1] < cap
    assert np.log2(turn[0] / turn[1]) > 1.8


def test_an_arc_of_a_circle_and_a_hole_in_a_plate_are_met() -> None:
    a = np.linspace(0, np.pi / 2, 7)
    ring = np.stack([np.cos(a), np.sin(a), 0 * a], axis=-1)
    x, n = np.concatenate([ring, 2 * ring]), np.broadcast_to([0.0, 0.0, -1.0], (14, 3))
    elements = np.stack([np.arange(6), np.arange(1, 7), np.arange(8, 14), np.arange(7, 13)], axis=-1)
    fine = cut(x, np.array(n), elements, 2, 20.0)
    radius = np.linalg.norm(fine.middle, axis=-1)
    rim = np.abs(radius - 1) < 0.1
    assert np.count_nonzero(rim) == 13
    assert np.allclose(radius[rim], 1, rtol=0, atol=1e-12)  # the corners at both ends are those of the last arc
    assert np.allclose(fine.normals, n[0], rtol=0, atol=1e-12)
    angular = cut(x, np.array(n), elements, 2, 10.0)  # above which a rim of 15 degrees is one of corners
    assert np.linalg.norm(angular.middle, axis=-1).min() == pytest.approx(np.cos(np.pi / 24), rel=1e-12)


@pytest.mark.parametrize("shape", [cylinder, sphere, twisted])
def test_normals_from_positions_are_of_the_second_order_up_to_the_rim(shape) -> None:
    off = []
    for m in (8, 16):
        x, n, elements = skewed(shape, m)
        actual = nodal_normals(x, elements, n, np.zeros(len(x), bool))
        off.append(np.linalg.norm(actual - n, axis=-1).reshape(m + 1, m + 1))
    assert off[1].max() < (1e-13 if shape is sphere else 1e-3)
    if shape is not sphere:
        assert np.log2(off[0].max() / off[1].max()) > 1.7
    else:
        given = np.zeros(len(x), bool)
        given[[3, 0]] = True
        assert np.array_equal(nodal_normals(x, elements, -n, given)[given], -n[given])


def notched(m: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (N, 2) and elements of an L of squares of side 1/m, whose inner corner three elements share."""
    number: dict[tuple[int, int], int] = {}
    elements = [
        [number.setdefault((i + a, j + b), len(number)) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        for i in range(m)
        for j in range(m)
        if min(i, j) < m // 2
    ]
    return np.array(list(number), float) / m, np.array(elements)


def test_the_normal_at_an_inner_corner_is_of_the_second_order_and_exact_on_a_sphere() -> None:
    def surface(plan: np.ndarray, kind: str) -> tuple[np.ndarray, np.ndarray]:
        x, y = plan.T
        if kind == "sphere":
            p = np.stack([x - 0.2, y - 0.1, np.sqrt(9 - (x - 0.2) ** 2 - (y - 0.1) ** 2)], axis=-1)
            return p, p / 3
        n = np.stack([-x - 0.3 * y, -0.3 * x + 0.4 * y, np.ones_like(x)], axis=-1)
        z = 0.5 * x**2 + 0.3 * x * y - 0.2 * y**2
        return np.stack([x, y, z], axis=-1), n / np.linalg.norm(n, axis=-1, keepdims=True)

    off = {"sphere": [], "saddle": []}
    for m in (8, 16):
        plan, elements = notched(m)
        at = int(np.argmin(np.linalg.norm(plan - 0.5, axis=-1)))
        for kind, errors in off.items():
            x, n = surface(plan, kind)
            actual = nodal_normals(x, elements, n, np.zeros(len(x), bool))
            assert np.isfinite(actual).all()
            errors.append(np.linalg.norm(actual[at] - n[at]))
    assert max(off["sphere"]) < 1e-13
    assert off["saddle"][1] < 2e-3
    assert np.log2(off["saddle"][0] / off["saddle"][1]) > 1.7

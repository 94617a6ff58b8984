"""Reference surfaces in orthogonal principal coordinates (a1, a2): Lamé parameters, curvatures, frame, position.

A surface knows nothing of thickness, material or mesh. Add one by giving its position and the five functions
A1, A2, k1, k2 and B of :class:`Geometry`; any surface of revolution needs only its meridian.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np


@dataclass(frozen=True, eq=False)
class Geometry:
    """First and second fundamental forms at points; every array is (..., 2) over the two directions.

    A: Lamé parameters A_a [length per coordinate].  k: principal curvatures [1/length], de3/(A_a da_a) = k_a e_a.
    B: B_a = (dA_g/da_a)/(A_1 A_2), g != a [1/length] (B_1 belongs to dA_2/da_1).
    """

    A: np.ndarray
    k: np.ndarray
    B: np.ndarray


class Surface(Protocol):
    """What the element and the scenes ask of a surface."""

    def geometry(self, a1: np.ndarray, a2: np.ndarray) -> Geometry:
        """Lamé parameters, curvatures and B at the points."""
        ...

    def position(self, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        """Cartesian position (..., 3)."""
        ...

    def frame(self, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        """Unit vectors (..., 3, 3): row i is e_{i+1} in Cartesian components; e3 is the outward normal.

        (e1, e2, e3) may be left-handed (it is for the surfaces of revolution below).
        """
        ...


@dataclass(frozen=True)
class Plate:
    """The plane x = a1, y = a2, z = 0 with e3 = e_z."""

    def geometry(self, a1: np.ndarray, a2: np.ndarray) -> Geometry:
        """A = 1, k = B = 0."""
        shape = (*np.broadcast_shapes(np.shape(a1), np.shape(a2)), 2)
        return Geometry(A=np.ones(shape), k=np.zeros(shape), B=np.zeros(shape))

    def position(self, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        """(a1, a2, 0)."""
        a1, a2 = np.broadcast_arrays(np.asarray(a1, float), np.asarray(a2, float))
        return np.stack([a1, a2, np.zeros_like(a1)], axis=-1)

    def frame(self, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        """The Cartesian frame."""
        shape = np.broadcast_shapes(np.shape(a1), np.shape(a2))
        return np.broadcast_to(np.eye(3), (*shape, 3, 3)).copy()


@dataclass(frozen=True)
class MeridianPoint:
    """Radius r and height z of a meridian with their first and second derivatives by a1."""

    r: np.ndarray
    z: np.ndarray
    dr: np.ndarray
    dz: np.ndarray
    ddr: np.ndarray
    ddz: np.ndarray


@dataclass(frozen=True)
class SurfaceOfRevolution:
    """Meridian (r(a1), z(a1)) turned about the z axis by the angle a2 [rad].

    x = (r cos a2, r sin a2, z);  A1 = sqrt(r'^2 + z'^2), A2 = r;
    k1 = (r' z'' - z' r'')/A1^3, k2 = z'/(A1 r);  B1 = r'/(A1 r), B2 = 0.
    The normal e3 = (z', -r')/A1 points outwards when z grows along the meridian; (e1, e2, e3) is left-handed.
    Source: any text on surfaces of revolution, e.g. Novozhilov, Thin Shell Theory (1964), ch. 1.
    """

    meridian: Callable[[np.ndarray], MeridianPoint]

    def geometry(self, a1: np.ndarray, a2: np.ndarray) -> Geometry:
        """The closed forms of the class docstring."""
        a1, a2 = np.broadcast_arrays(np.asarray(a1, float), np.asarray(a2, float))
        m = self.meridian(a1)
        length = np.hypot(m.dr, m.dz)
        zero = np.zeros_like(a1)
        return Geometry(
            A=np.stack([length, m.r], axis=-1),
            k=np.stack([(m.dr * m.ddz - m.dz * m.ddr) / length**3, m.dz / (length * m.r)], axis=-1),
            B=np.stack([m.dr / (length * m.r), zero], axis=-1),
        )

    def position(self, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        """(r cos a2, r sin a2, z)."""
        a1, a2 = np.broadcast_arrays(np.asarray(a1, float), np.asarray(a2, float))
        m = self.meridian(a1)
        return np.stack([m.r * np.cos(a2), m.r * np.sin(a2), m.z], axis=-1)

    def frame(self, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        """e1 along the meridian, e2 along the parallel, e3 outwards."""
        a1, a2 = np.broadcast_arrays(np.asarray(a1, float), np.asarray(a2, float))
        m = self.meridian(a1)
        length = np.hypot(m.dr, m.dz)
        cos, sin, zero = np.cos(a2), np.sin(a2), np.zeros_like(a1)
        r1, z1 = m.dr / length, m.dz / length
        e1 = np.stack([r1 * cos, r1 * sin, z1], axis=-1)
        e2 = np.stack([-sin, cos, zero], axis=-1)
        e3 = np.stack([z1 * cos, z1 * sin, -r1], axis=-1)
        return np.stack([e1, e2, e3], axis=-2)


def torus(axis_radius: float, tube_radius: float) -> SurfaceOfRevolution:
    """Torus: r = Rc + R1 cos a1, z = R1 sin a1, with a1 [rad] from the outer equator.

    axis_radius Rc: distance from the axis to the centre of the tube; tube_radius R1.
    """

    def meridian(a1: np.ndarray) -> MeridianPoint:
        rc, rs = tube_radius * np.cos(a1), tube_radius * np.sin(a1)
        return MeridianPoint(r=axis_radius + rc, z=rs, dr=-rs, dz=rc, ddr=-rc, ddz=-rs)

    return SurfaceOfRevolution(meridian)


def sphere(radius: float) -> SurfaceOfRevolution:
    """Sphere with a1 [rad] the latitude from the equator: the torus whose tube is centred on the axis."""
    return torus(0.0, radius)


def cylinder(radius: float) -> SurfaceOfRevolution:
    """Circular cylinder with a1 [length] along the axis and a2 [rad] around it."""

    def meridian(a1: np.ndarray) -> MeridianPoint:
        one, zero = np.ones_like(a1), np.zeros_like(a1)
        return MeridianPoint(r=radius * one, z=a1, dr=zero, dz=one, ddr=zero, ddz=zero)

    return SurfaceOfRevolution(meridian)

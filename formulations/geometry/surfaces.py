"""Reference surfaces in orthogonal principal coordinates (a1, a2): Lamé parameters, curvatures, frame, position.

A surface knows nothing of thickness, material or mesh. Add one by giving its position and the five functions
A1, A2, k1, k2 and B of :class:`Geometry`; any surface of revolution needs only its meridian (:class:`MeridianPoint`).

Coordinate lines must be lines of curvature. The hyperbolic paraboloid z = x^2 - y^2 over a square in (x, y) cannot
enter: its Cartesian lines are not orthogonal (x,1 . x,2 = -4xy), and no other coordinates help, for its edges x = const
are not lines of curvature (Joachimsthal: the plane meets the surface at an angle that varies along the edge).
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


def elliptic_torus(axis_radius: float, radial: float, axial: float) -> SurfaceOfRevolution:
    """Torus of elliptic section: r = Rc + a cos a1, z = b sin a1; a1 is the ellipse's eccentric angle [rad].

    axis_radius Rc: from the axis to the centre of the section; radial a, axial b: the half axes of the section.
    A1 = sqrt(a^2 sin^2 a1 + b^2 cos^2 a1), k1 = a b/A1^3, k2 = b cos a1/(A1 r), B1 = -a sin a1/(A1 r).
    """

    def meridian(a1: np.ndarray) -> MeridianPoint:
        c, s = np.cos(a1), np.sin(a1)
        rc, rs, zc, zs = radial * c, radial * s, axial * c, axial * s
        return MeridianPoint(r=axis_radius + rc, z=zs, dr=-rs, dz=zc, ddr=-rc, ddz=-zs)

    return SurfaceOfRevolution(meridian)


def torus(axis_radius: float, tube_radius: float) -> SurfaceOfRevolution:
    """Torus: r = Rc + R1 cos a1, z = R1 sin a1, with a1 [rad] from the outer equator.

    axis_radius Rc: distance from the axis to the centre of the tube; tube_radius R1.
    """
    return elliptic_torus(axis_radius, tube_radius, tube_radius)


def sphere(radius: float) -> SurfaceOfRevolution:
    """Sphere with a1 [rad] the latitude from the equator: the torus whose tube is centred on the axis."""
    return torus(0.0, radius)


def _straight(r0: float, dr: float, dz: float) -> SurfaceOfRevolution:
    """Straight meridian r = r0 + dr a1, z = dz a1 with dr^2 + dz^2 = 1."""

    def meridian(a1: np.ndarray) -> MeridianPoint:
        one, zero = np.ones_like(a1), np.zeros_like(a1)
        return MeridianPoint(r=r0 + dr * a1, z=dz * a1, dr=dr * one, dz=dz * one, ddr=zero, ddz=zero)

    return SurfaceOfRevolution(meridian)


def cylinder(radius: float) -> SurfaceOfRevolution:
    """Circular cylinder with a1 [length] along the axis and a2 [rad] around it."""
    return _straight(radius, 0.0, 1.0)


def annulus() -> SurfaceOfRevolution:
    """The plane z = 0 in polar coordinates: a1 [length] the distance from the centre, a2 [rad] the polar angle.

    A1 = 1, A2 = a1, k = 0, B1 = 1/a1. The normal e3 = (z', -r')/A1 is -e_z: the outer face looks and is pushed down.
    """
    return _straight(0.0, 1.0, 0.0)


def cone(half_angle: float) -> SurfaceOfRevolution:
    """Cone with a1 [length] the distance from the apex along a generator; half_angle [rad] between it and the axis.

    r = a1 sin, z = a1 cos: A1 = 1, A2 = a1 sin, k1 = 0, k2 = cot/a1, B1 = 1/a1. Raises ValueError outside (0, pi/2).
    """
    if not 0 < half_angle < np.pi / 2:
        raise ValueError(f"half_angle = {half_angle:g} must lie in (0, pi/2)")
    return _straight(0.0, np.sin(half_angle), np.cos(half_angle))


def hyperboloid(waist: float, height: float) -> SurfaceOfRevolution:
    """Hyperboloid of one sheet r^2/a^2 - z^2/c^2 = 1 with a1 [length] = z; waist a = r(0), height c.

    With A1^2 = 1 + (a^2 z/(c^2 r))^2: k1 = -a^4/(c^2 r^3 A1^3), k2 = 1/(r A1), B1 = a^2 z/(c^2 r^2 A1).
    """
    slope = (waist / height) ** 2

    def meridian(a1: np.ndarray) -> MeridianPoint:
        r, one = np.sqrt(waist**2 + slope * a1**2), np.ones_like(a1)
        return MeridianPoint(r=r, z=a1, dr=slope * a1 / r, dz=one, ddr=slope * waist**2 / r**3, ddz=0 * one)

    return SurfaceOfRevolution(meridian)


@dataclass(frozen=True, eq=False)
class NodalSurface:
    """A surface known at the nodes of a mesh alone; its coordinate a1 is the number of a node.

    middle, normals (N, 3): positions and unit normals.  frames (N, 3, 3): rows are the directions of the displacement
    components, the Cartesian ones unless a support needs others.  axes (N, 2, 3): those of the laminate along the
    surface, near enough: the element projects them on itself.
    """

    middle: np.ndarray
    normals: np.ndarray
    frames: np.ndarray
    axes: np.ndarray

    @classmethod
    def of(cls, middle: np.ndarray, normals: np.ndarray, first: np.ndarray) -> NodalSurface:
        """In Cartesian components; ``first`` (3,) or (N, 3): the first axis of the laminate, the second follows it."""
        first = np.broadcast_to(first, middle.shape)
        axes = np.stack([first, np.cross(normals, first)], axis=1)
        return cls(middle, normals, np.broadcast_to(np.eye(3), (len(middle), 3, 3)), axes)

    def geometry(self, a1: np.ndarray, a2: np.ndarray) -> Geometry:
        """Raises TypeError: nodes have neither Lamé parameters nor curvatures."""
        raise TypeError("a surface of nodes has no lines of curvature")

    def position(self, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        """Of the nodes."""
        return np.asarray(self.middle[_numbers(a1)])

    def frame(self, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        """Of the displacement components at the nodes."""
        return np.asarray(self.frames[_numbers(a1)])


def _numbers(a1: np.ndarray) -> np.ndarray:
    return np.rint(a1).astype(np.intp)


def normal(surface: Surface, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
    """Unit normal (..., 3)."""
    return surface.normals[_numbers(a1)] if isinstance(surface, NodalSurface) else surface.frame(a1, a2)[..., 2, :]


def laminate_axes(surface: Surface, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
    """The axes (..., 2, 3) along the surface from which the angles of plies count."""
    return surface.axes[_numbers(a1)] if isinstance(surface, NodalSurface) else surface.frame(a1, a2)[..., :2, :]

"""A membrane over half a sphere: deflection, contact radius and force in closed form.

On the unit disc, u = 0 on its edge, the tension 1 and no load: u >= phi, the sphere phi = sqrt(r0^2 - r^2), beyond
r = 0.9 r0 continued by its tangent. In contact u = phi; beyond, -lap u = 0 gives u = A ln r. Value and slope are
continuous at the contact radius a::

    A ln a = sqrt(r0^2 - a^2),    A/a = -a/sqrt(r0^2 - a^2)    =>    a^2 (1 - ln a) = r0^2,    A = -a^2/phi(a)

The pressure is p = -lap phi = 2/phi + r^2/phi^3 and its resultant -2 pi A. For r0 = 1/2 the numbers of MFEM's example
36 (Keith, Surowiec, Found. Comput. Math. (2024), arXiv:2307.12444): a = 0.348982574111686, A = -0.340129705945858.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq

SPHERICAL = 0.9  # share of its radius up to which the obstacle is the sphere


@dataclass(frozen=True)
class SphereObstacle:
    """The membrane over the sphere of radius r0; contact_radius a, factor A of the logarithm outside.

    Raises ValueError unless 0 < r0 and the contact ends on the sphere (r0 < 0.879).
    """

    r0: float = 0.5
    contact_radius: float = field(init=False)
    factor: float = field(init=False)

    def __post_init__(self) -> None:
        limit = SPHERICAL * self.r0
        if not 0 < self.r0 < 1 or _excess(limit, self.r0) <= 0:
            raise ValueError(f"r0 = {self.r0:g} must lie in (0, 0.879): the contact would leave the sphere")
        a = brentq(_excess, 1e-3 * self.r0**2, limit, args=(self.r0,), xtol=1e-16, rtol=1e-15)
        object.__setattr__(self, "contact_radius", float(a))
        object.__setattr__(self, "factor", float(-(a**2) / np.sqrt(self.r0**2 - a**2)))

    @property
    def force(self) -> float:
        """Resultant of the pressure."""
        return float(-2 * np.pi * self.factor)

    def height(self, r: np.ndarray) -> np.ndarray:
        """phi(r)."""
        b = SPHERICAL * self.r0
        top = np.sqrt(self.r0**2 - b**2)
        return np.where(r <= b, np.sqrt(self.r0**2 - np.minimum(r, b) ** 2), top - b / top * (r - b))

    def deflection(self, r: np.ndarray) -> np.ndarray:
        """u(r)."""
        outside = self.factor * np.log(np.maximum(r, self.contact_radius))
        return np.where(r <= self.contact_radius, self.height(r), outside)

    def slope(self, r: np.ndarray) -> np.ndarray:
        """u'(r)."""
        inside = np.minimum(r, self.contact_radius)
        on_sphere = -inside / np.sqrt(self.r0**2 - inside**2)
        return np.where(r <= self.contact_radius, on_sphere, self.factor / np.maximum(r, self.contact_radius))

    def radius_under(self, force: float) -> float:
        """The contact radius a at which the resultant is the force: 2 pi a^2/sqrt(r0^2 - a^2)."""
        squared = (force / (2 * np.pi)) ** 2
        return float(np.sqrt(0.5 * (np.sqrt(squared**2 + 4 * squared * self.r0**2) - squared)))


def _excess(a: float, r0: float) -> float:
    """a^2 (1 - ln a) - r0^2; grows with a < 1."""
    return float(a**2 * (1 - np.log(a)) - r0**2)

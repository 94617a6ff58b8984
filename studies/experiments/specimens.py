"""The bodies that laws are tried on: small shells of every element option, a skew laminate, a surface turned round."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.element.strain_operator import INTERPOLATIONS
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Geometry, Surface
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.measure import StrainMeasure
from formulations.strains.quantities import FULL


@dataclass(frozen=True)
class Element:
    """The options of the element."""

    interpolation: str = "curvilinear"
    thickness_strain: str = "projected"
    membrane: str = "compatible"

    def suits(self, measure: StrainMeasure) -> bool:
        """Interpolated positions know no gradients that leave something out."""
        return self.interpolation != "isoparametric" or measure.kinematics == FULL

    def shell(
        self,
        measure: StrainMeasure,
        surface: Surface,
        grid: Grid,
        layup: Laminate,
        supports: Supports | None = None,
        **loads: Any,
    ) -> ShellModel:
        """A shell of these options, free where no supports are given."""
        held = (supports or Supports.none(grid)).masks
        discretisation = Discretisation.build(
            surface, grid, layup, *held, kinematics=measure.kinematics, interpolation=self.interpolation
        )
        return ShellModel(
            discretisation, measure, thickness_strain=self.thickness_strain, membrane=self.membrane, **loads
        )


ELEMENTS = tuple(Element(*options) for options in product(INTERPOLATIONS, THICKNESS_STRAINS, MEMBRANES))


def layup(*, swapped: bool = False, length: float = 1.0, stress: float = 1.0) -> Laminate:
    """Two unequal plies that are nowhere symmetric; with the axes exchanged, in other units of length and stress."""
    plies = []
    for angle, h in ((0.6, 0.11), (-0.9, 0.07)):
        E_L, E_T, G_LT, G_TT = (stress * modulus for modulus in (30.0, 8.0, 4.0, 3.0))
        turned = math.pi / 2 - angle if swapped else angle
        plies.append(Ply(E_L, E_T, G_LT, G_TT, 0.3, 0.4, turned, length * h))
    return Laminate(tuple(plies), -0.05 * length)


@dataclass(frozen=True)
class Swapped:
    """A surface with its two coordinates exchanged."""

    surface: Surface

    def geometry(self, a1: np.ndarray, a2: np.ndarray) -> Geometry:
        """A, k and B with their last axis turned round."""
        g = self.surface.geometry(a2, a1)
        return Geometry(A=g.A[..., ::-1], k=g.k[..., ::-1], B=g.B[..., ::-1])

    def position(self, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        """The same points."""
        return self.surface.position(a2, a1)

    def frame(self, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        """e2, e1, e3."""
        return self.surface.frame(a2, a1)[..., [1, 0, 2], :]

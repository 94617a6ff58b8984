"""Walls that differ, and the geometry of elements on a grid, of its walls and of surfaces inside them.

No support and no pattern enters here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from formulations.element.strain_operator import ElementGeometry
from formulations.geometry.grid import CORNERS, Grid
from formulations.geometry.surfaces import Surface, laminate_axes, normal
from formulations.section.laminate import Laminate
from formulations.strains.quantities import Kinematics

if TYPE_CHECKING:
    from formulations.element.quad_sampling import NodalFaces
    from formulations.element.walls.geometry import WallGeometry
    from formulations.section.sampling import Sampling


@dataclass(frozen=True, eq=False)
class Walls:
    """laminates: those that there are.  kind (E,): which of them an element has.  thickness (E, 4): at its corners.

    The reference surface divides all of them in the same ratio. Where elements that meet differ, their walls step: each
    has its own thickness about the reference surface, and all follow the one director of the node.
    """

    laminates: tuple[Laminate, ...]
    kind: np.ndarray
    thickness: np.ndarray

    def stiffness(self, section: str) -> np.ndarray:
        """D (k, 11, 11) of the laminates, each in its own thickness."""
        return np.array([laminate.stiffness(section) for laminate in self.laminates])

    @property
    def growth(self) -> np.ndarray:
        """(E, 4) thickness at the corners over that of the laminate."""
        return self.thickness / np.array([laminate.thickness for laminate in self.laminates])[self.kind][:, None]

    def at_nodes(self, elements: np.ndarray, n_nodes: int) -> np.ndarray:
        """Distance (N,) between the faces of the nodes: the mean over the elements (E, 4) around."""
        corners = elements.ravel()
        total = np.bincount(corners, weights=self.thickness.ravel(), minlength=n_nodes)
        return np.asarray(total / np.bincount(corners, minlength=n_nodes))


def at_faces(laminate: Laminate, walls: Walls | None, grid: Grid) -> np.ndarray:
    """Distances (N or 1, 2) of both faces of the nodes from the reference surface."""
    d = np.array([[laminate.d_minus, laminate.d_plus]])
    return d if walls is None else d / laminate.thickness * walls.at_nodes(grid.elements, grid.n_nodes)[:, None]


def geometry_on(
    surface: Surface,
    grid: Grid,
    laminate: Laminate,
    kinematics: Kinematics,
    interpolation: str,
    walls: Walls | None,
) -> ElementGeometry:
    """That of elements of this interpolation, see :class:`formulations.discretisation.Discretisation`."""
    if interpolation != "quads":
        return ElementGeometry.build(surface, grid, laminate, kinematics, interpolation)
    if grid.hanging is not None:
        raise ValueError("quadrilaterals have no hanging nodes: cut every one of them")
    from formulations.element.quad_geometry import QuadGeometry  # loaded with quadrilaterals alone

    return QuadGeometry.of(_nodal_faces(surface, grid, laminate, walls), kinematics)


def wall_on(
    surface: Surface,
    grid: Grid,
    laminate: Laminate,
    sampling: Sampling,
    geometry: ElementGeometry,
    walls: Walls | None,
) -> WallGeometry:
    """That of surfaces inside the wall; raises ValueError where quadrilaterals have walls that differ."""
    from formulations.element.walls.geometry import WallGeometry  # loaded with surfaces inside the wall alone
    from formulations.element.walls.quad_wall import QuadWall

    if geometry.interpolation != "quads":
        return WallGeometry.of(surface, grid, sampling, geometry)
    if walls is not None:
        raise ValueError("surfaces inside the wall need the same wall everywhere")
    return QuadWall.of_faces(_nodal_faces(surface, grid, laminate, None), sampling, geometry.kinematics)


def _nodal_faces(surface: Surface, grid: Grid, laminate: Laminate, walls: Walls | None) -> NodalFaces:
    from formulations.element.quad_sampling import NodalFaces

    at = np.moveaxis(grid.points(CORNERS), -1, 0)
    of_node = at_faces(laminate, walls, grid)
    if walls is None:
        d = of_node = np.broadcast_to(of_node, (*grid.elements.shape, 2))
    else:
        of_node = of_node[grid.elements]
        d = np.array([laminate.d_minus, laminate.d_plus]) / laminate.thickness * walls.thickness[..., None]
    axes = surface.frame(*at), laminate_axes(surface, *at)
    return NodalFaces(surface.position(*at), normal(surface, *at), *axes, d, of_node)

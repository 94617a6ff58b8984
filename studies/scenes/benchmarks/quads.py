"""Shells known by a map of the unit square alone: what scenes share whose grid lines follow no lines of curvature.

A scene gives the positions of its middle surface over (s, t) in [0, 1]^2. Nodes are moved, where they are to be, in the
square before they are mapped, so that they stay on the surface and on its edges; normals are those of the map. All
displacements are Cartesian: supports hold components along x, y and z, and planes of symmetry are normal to these. No
value to compare with enters here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid, QuadGrid
from formulations.geometry.surfaces import NodalSurface
from formulations.section.laminate import Laminate
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from studies.ask.request import Request, Value
from studies.ask.scene import SOLVER, Declared, SceneModel, Setting, UsageError
from studies.scenes.element import LINES, ON_QUADS, check_wall, even_grid
from studies.scenes.statics import LOAD_FRACTION, StaticModel

SHEAR = Setting.positive("shear_correction", 1.0, "factor on the shear stiffness; 1000: Kirchhoff", 1e4)
SETTINGS = (LINES, LOAD_FRACTION, SHEAR, *ON_QUADS, SOLVER)
Map = Callable[[np.ndarray, np.ndarray], np.ndarray]  # (s, t) -> positions (..., 3)
STEP = 1e-6  # of the central differences of the map; their error is of the order of 1e-11 of its size


class OnQuads(Declared):
    """A scene of this family."""

    lines_of_curvature: bool = False  # whether it may be put on these, too

    def complete(self, settings: Mapping[str, Value]) -> dict[str, Value]:
        """Raises UsageError for an interpolation that needs lines of curvature."""
        interpolation = settings["interpolation"]
        if interpolation != "quads" and not self.lines_of_curvature:
            raise UsageError(
                f"interpolation = {interpolation} needs lines of curvature, which {self.name} has none of; "
                "it must be quads (element=quads)"
            )
        return dict(settings)


@dataclass(frozen=True, eq=False)
class MappedShell:
    """The discretisation of a mapped square; ``square``: its nodes in (s, t), ``middle`` (N, 3): in space."""

    body: Discretisation
    square: Grid
    middle: np.ndarray

    @classmethod
    def of(
        cls,
        request: Request,
        mapped: Map,
        laminate: Laminate,
        supported: Callable[[Supports, Grid], Supports],
        closer: Sequence[bool] = (False, False, True, True),
    ) -> MappedShell:
        """On the mesh asked for. supported(free, square): the supports, of components along x, y, z.

        closer: to which edges lines get closer, if they do to any: the first and the last s, then those of t.

        Raises UsageError for a mesh that is cut in places.
        """
        if request.leaves:
            raise UsageError(f"{request.scene}: quadrilaterals have no hanging nodes, refine by --mesh")
        square = even_grid(request, (0.0, 1.0), (0.0, 1.0), closer)
        s, t = square.nodes.T
        middle = mapped(s, t)
        along, across = _tangents(mapped, s, t)
        normals = np.cross(along, across)
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        first = along / np.linalg.norm(along, axis=-1, keepdims=True)
        held, hinged = supported(Supports.none(square), square).masks
        body = Discretisation.build(
            NodalSurface.of(middle, normals, first),
            replace(QuadGrid.over(square.elements), node_shape=getattr(square, "node_shape", None)),
            laminate,
            held,
            hinged,
            MEASURES[request.measure].kinematics,
            "quads",
            ordered=True,
            surfaces=check_wall(request, laminate),
        )
        return cls(body, square, middle)

    def edge_forces(self, axis: int, end: float, force: Sequence[float]) -> np.ndarray:
        """(N, 6): a uniform dead force [N], (3,) in all, on the edge s = end (axis 0) or t = end; half on either face.

        F_i = force l_i/l with half of the lengths of both sides of a node.
        """
        nodes = self.square.on_line(axis, end)
        nodes = nodes[np.argsort(self.square.nodes[nodes, 1 - axis])]
        sides = np.linalg.norm(np.diff(self.middle[nodes], axis=0), axis=-1)
        share = 0.5 * (np.append(sides, 0.0) + np.append(0.0, sides)) / sides.sum()
        forces = np.zeros((self.square.n_nodes, 6))
        forces[nodes] = share[:, None] * np.repeat(0.5 * np.asarray(force), 2)
        return forces

    def mean_motion(self, u: np.ndarray, nodes: np.ndarray | int) -> np.ndarray:
        """(3,) displacement of some nodes, the mean over them and both faces."""
        return np.mean([face[np.atleast_1d(nodes)].mean(axis=0) for face in self.body.cartesian(u)], axis=0)


def pulled_strip(request: Request, mapped: Map, wall: Laminate, axis: int, force: float) -> SceneModel:
    """Clamped at s = 0, a dead force [N] along x, y or z on s = 1, half on each face; its end is read along that."""
    strip = MappedShell.of(request, mapped, wall, lambda supports, square: supports.clamped(square.on_line(0, 0.0)))
    tip = strip.square.on_line(0, 1.0)

    def at_tip(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
        return {"tip_deflection_mm": float(strip.mean_motion(u, tip)[axis])}

    return StaticModel.of(request, strip.body, at_tip, forces=strip.edge_forces(0, 1.0, force * np.eye(3)[axis]))


def _tangents(mapped: Map, s: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives (N, 3) of the map by s and by t."""
    along = (mapped(s + STEP, t) - mapped(s - STEP, t)) / (2 * STEP)
    across = (mapped(s, t + STEP) - mapped(s, t - STEP)) / (2 * STEP)
    return along, across

"""A scene in neutral terms: what any other program needs to solve the same body under the same loads.

Units are mm, N and MPa. How a scene comes to be one is in :mod:`.of_scene` and :mod:`.of_body`; no syntax of a file
and no solution may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from formulations.section.laminate import Laminate, Ply
from studies.ask.request import Request, UsageError
from studies.exchange.bricks import INNER, Bricks

ALONG = 1e-12  # what rounding takes off a unit vector along an axis


@dataclass(frozen=True)
class Material:
    """An orthotropic ply: E_i, G_ij [MPa], nu_ij the contraction along j under tension along i; axis 3 lies across.

    angle [rad]: of axis 1 from a1 towards a2.  thickness [mm].
    """

    E: tuple[float, float, float]
    nu: tuple[float, float, float]  # 12, 13, 23
    G: tuple[float, float, float]  # 12, 13, 23
    angle: float
    thickness: float

    @property
    def isotropic(self) -> bool:
        """Whether two constants tell it."""
        G = self.E[0] / (2 * (1 + self.nu[0]))
        same = (*self.E, *(G_ij / G * self.E[0] for G_ij in self.G))
        return bool(np.allclose(same, self.E[0], rtol=1e-12) and np.allclose(self.nu, self.nu[0], rtol=1e-12))


def materials(laminate: Laminate) -> tuple[Material, ...]:
    """The plies from inside; a shear correction of the section is one of G_13 and G_23.

    Raises UsageError for a kind of ply that has no such constants.
    """
    correction = float(getattr(laminate, "shear_correction", 1.0))
    found = []
    for ply in laminate.plies:
        if not isinstance(ply, Ply):
            raise UsageError(
                f"plies of kind {type(ply).__name__} cannot be exported, only those with moduli along axes"
            )
        G = (ply.G_LT, correction * ply.G_LT, correction * ply.G_TT)
        nu = (ply.nu_LT, ply.nu_LT, ply.nu_TT)
        found.append(Material((ply.E_L, ply.E_T, ply.E_T), nu, G, ply.angle, ply.thickness))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class Supports:
    """nodes (k,), each once; axes (k, 3, 3): rows along which held (k, 3) bool says that a node does not move."""

    nodes: np.ndarray
    axes: np.ndarray
    held: np.ndarray

    @cached_property
    def turned(self) -> np.ndarray:
        """(k,) bool: the nodes that are held along a direction that is no Cartesian axis, and not along all three."""
        straight = np.asarray(np.abs(self.axes).max(axis=-1) > 1 - ALONG)
        return np.asarray(np.any(self.held & ~straight, axis=1) & ~self.held.all(axis=1))

    @cached_property
    def cartesian(self) -> np.ndarray:
        """(k, 3) bool: the Cartesian components that are held; of the nodes that are not ``turned``."""
        along = np.abs(self.axes).argmax(axis=-1)
        found = np.zeros_like(self.held)
        for i in range(3):
            found[np.arange(len(found)), along[:, i]] |= self.held[:, i]
        return found | np.all(self.held, axis=1, keepdims=True)

    def along_axes(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (N, 3) at all nodes, those at ``turned`` ones along their axes."""
        nodes, found = self.nodes[self.turned], vectors.copy()
        found[nodes] = np.einsum("kix,kx->ki", self.axes[self.turned], vectors[nodes])
        return found


@dataclass(frozen=True, eq=False)
class LoadStep:
    """All loads at the end of a step, whole and not added to those before; between two steps they vary linearly.

    load: value of the problem's key, None where no quantity is reported.  pressure (F,) [MPa]: on the inner faces of
    ``bricks.inner``, outwards, on the deformed area where the analysis is nonlinear.  forces (N, 3) [N]: dead.
    offset [mm]: n.x of the plane.
    """

    name: str
    load: float | None
    pressure: np.ndarray
    forces: np.ndarray
    offset: float | None = None


@dataclass(frozen=True, eq=False)
class Plane:
    """A rigid plane without friction: the body stays at n.x <= offset.  start [mm]: its offset at rest."""

    normal: np.ndarray
    start: float


@dataclass(frozen=True, eq=False)
class Problem:
    """Body, plies, supports, steps and plane.

    key: what the steps are counted by, as in the scene's results.  shell (n, 2): nodes on the inner and on the outer
    face at the nodes of the shell's grid; None of a scene that is a solid.  touched [mm]: n.x of the plane that just
    touches after the first step, by our own solution, from which the travel of a tyre counts; else None.  crown: node
    where it touches first.  copies: how often the part lies in the tyre, whose whole force is reported; else 1.
    """

    request: Request
    title: str
    key: str
    bricks: Bricks
    materials: tuple[Material, ...]
    supports: Supports
    steps: tuple[LoadStep, ...]
    plane: Plane | None = None
    shell: np.ndarray | None = None
    touched: float | None = None
    crown: int | None = None
    copies: int = 1

    @property
    def nonlinear(self) -> bool:
        """Whether displacements are large: the measure is not the linear one."""
        return self.request.measure != "linear"

    def step_at(self, load: float) -> LoadStep | None:
        """The step that ends at a load, if any does."""
        return next((step for step in self.steps if step.load is not None and np.isclose(step.load, load)), None)

    def pressure_forces(self, step: LoadStep, u: np.ndarray | None) -> np.ndarray | None:
        """Forces (N, 3) [N] of the pressure of a step, on the area displaced by u (N, 3) where displacements are large.

        None where u is wanted and not known at all nodes of the inner faces.
        """
        if not self.nonlinear or not step.pressure.any():
            return self.bricks.pressure_forces(step.pressure)
        if u is None or not np.all(np.isfinite(u[self.bricks.face_nodes(INNER)])):
            return None
        return self.bricks.pressure_forces(step.pressure, u)

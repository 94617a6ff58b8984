"""What grids that are coarser than the layer at an edge cannot say of a limit: how much that layer gives way.

Where no couple holds the director along an edge, as at a free one or one that is held midway alone, twist turns into
shear within ::

    b = sqrt(D66/S),      h/sqrt(12) of an isotropic wall of the thickness h

with the stiffnesses to twist D66 [N mm] and to shear S [N/mm]. The strip of the width b has lost its energy of twist,
so that of all, and displacements under given forces, change by the part ::

    s = sum over edges of  f 1/2 D66 (2 K_ns)^2 b l / U,      f = z^2/(z^2 + Z),  z = a/b

of them: exact for a strip under torsion, whose stiffness is that of Kirchhoff times 1 - 2 b/width tanh(width/(2 b))
(Reissner, J. Appl. Mech. 12 (1945) A69). K_ns: twist in the element along the edge, which is l long and a across it.
f: what is left of it on a grid, which falls with the square of a only once a is smaller than b; a twisted strip whose
elements are 34 b to 1.1 b long has it with Z from 24 to 31. Grids of half and a quarter of the elements show little of
it where all are longer. Nothing is solved here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from formulations.geometry.surfaces import laminate_axes
from formulations.shell import ShellModel
from formulations.strains.quantities import N_E
from studies.ask.scene import ShellSceneModel
from studies.solving.refinement.limits import SAFETY, Estimate
from studies.solving.refinement.nested import Sketch
from studies.solving.refinement.records import SHEAR
from studies.solving.result import Result

LEFT = 24.0  # Z
TWIST = slice(4, 6)  # 2E12 of both faces
BENT = np.array([-1.0, 1.0])  # strains of both faces that bend or twist the wall alone
SAID = 1e-3  # of the displacements: what is worth a sentence


@dataclass(frozen=True)
class EdgeLayer:
    """width, length [mm]: least b and largest a.  left, before: s of the last grid, and of the first of all."""

    width: float
    length: float
    left: float
    before: float

    @classmethod
    def of(cls, result: Result | Sketch, coarser: float) -> EdgeLayer | None:
        """At the last load; coarser: the elements of the first grid over those of the last. None without such edges."""
        if not isinstance(result.model, ShellSceneModel) or result.end is None:
            return None
        shell = result.model.moved(result.end.point.requested).shell
        u = result.end.stage.lifted(result.end.point.solution).u
        strains, area = shell.mean_strains(u), shell.discretisation.geometry.weight
        energy = 0.5 * float(np.sum(area * np.sum(strains * shell.mean_resultants(u), axis=1)))
        elements, ends = _soft_edges(shell)
        if not len(elements) or not energy > 0:
            return None
        D = shell.discretisation.stiffness(shell.section)
        D = np.broadcast_to(D.mean(axis=1) if D.ndim == 4 else D, (len(area), N_E, N_E))[elements]
        h = np.linalg.norm(np.subtract(*shell.discretisation.positions())[ends], axis=-1).mean(axis=1)
        twist = h**2 / 4 * np.einsum("i,eij,j->e", BENT, D[:, TWIST, TWIST], BENT)
        b = np.sqrt(twist / np.sqrt(np.prod([D[:, rows, rows].sum((1, 2)) for rows in SHEAR], axis=0)))
        k, length = _twist_along(shell, strains[elements] / h[:, None], ends)
        lost, z = 2 * twist * k**2 * b * length / energy, area[elements] / length / b
        left, before = (float(np.sum(lost * x**2 / (x**2 + LEFT))) for x in (z, coarser * z))
        return cls(float(b.min()), float((z * b).max()), left, before)

    def within(self, known: Estimate, changed: float) -> Estimate:
        """The limit of a displacement with what this may move it by; changed: from the first grid to the last.

        That is no more than the part of s that is left over the part that the grids have shown, of that change.
        """
        shown = self.before - self.left
        most = changed * self.left / shown if shown > 0 else np.inf
        more = SAFETY * min(self.left * abs(known.limit), most) / (abs(known.limit) or 1.0)
        return replace(known, uncertainty=known.uncertainty + more)

    @property
    def said(self) -> str:
        """A sentence; empty where it is not worth one."""
        if self.left <= SAID:
            return ""
        layer = f"edges with a free director have a boundary layer of {self.width:.2g} mm"
        missed = f"displacements may be in error by {100 * self.left:.2g} %"
        return f"{layer}, elements there are {self.length:.2g} mm: {missed}"


def _soft_edges(shell: ShellModel) -> tuple[np.ndarray, np.ndarray]:
    """Elements (k,) and both nodes (k, 2) of their edges that are no other's and along which the director may turn."""
    elements = shell.discretisation.grid.elements
    held = np.asarray(shell.discretisation.map.held.reshape(-1, 3, 2).all(axis=2))
    ends = np.stack([elements, np.roll(elements, -1, axis=1)], axis=-1).reshape(-1, 2)
    _, number, count = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True)
    x = np.mean(shell.discretisation.positions(), axis=0)
    along = x[ends[:, 1]] - x[ends[:, 0]]
    frames = shell.discretisation.surface.frame(*shell.discretisation.grid.nodes.T)[ends]
    free = np.where(held[ends], 0.0, np.einsum("enix,ex->eni", frames, along))
    soft = (np.sum(free**2, axis=-1) > 0.5 * np.sum(along**2, axis=-1)[:, None]).all(axis=1)
    rim = np.flatnonzero((count[number.ravel()] == 1) & soft)
    return rim // elements.shape[1], ends[rim]


def _twist_along(shell: ShellModel, strains: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """K_ns (k,) [1/mm] from mean strains over h (k, 11) in the axes of the laminate, and lengths (k,) of the edges."""
    x = np.mean(shell.discretisation.positions(), axis=0)
    along = x[ends[:, 1]] - x[ends[:, 0]]
    axes = laminate_axes(shell.discretisation.surface, *shell.discretisation.grid.nodes.T)[ends].mean(axis=1)
    c, s = np.einsum("eax,ex->ae", axes, along)
    k11, k22, k12 = (strains[:, rows] @ BENT for rows in (slice(0, 2), slice(2, 4), TWIST))
    return (c * s * (k22 - k11) + (c**2 - s**2) * k12 / 2) / (c**2 + s**2), np.linalg.norm(along, axis=1)

"""What is read off a state of a shell: displacements, strains, resultants, stresses, and forces of its supports.

All is a function of the free displacements; nothing is linearised here, see :mod:`formulations.shell`.
"""

from abc import ABC, abstractmethod

import numpy as np

from formulations.discretisation import Discretisation
from formulations.element.modal import ModalElement
from formulations.element.strain_operator import shape_functions
from formulations.section.laminate import PLANE, strain_rotation

SEEN = 0.5  # of the volume of an element at rest: chords see 2/pi of it on a quarter of a circle, none on half of one


class ShellReadings(ABC):
    """Of a shell with these parts; ``_dead``: element forces of its dead loads."""

    discretisation: Discretisation
    section: str
    forces: np.ndarray | None
    prescribed: np.ndarray | None
    _element: ModalElement
    _dead: np.ndarray

    @abstractmethod
    def element_forces(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray | None]:
        """Element forces (E, 24), and external ones that follow (or None)."""

    def displacements(self, u: np.ndarray) -> np.ndarray:
        """All face displacements (N, 6), the prescribed ones included."""
        return self.discretisation.expand(u, self.prescribed)

    def nodal_displacements(self, u: np.ndarray) -> np.ndarray:
        """The same, (N, 6 and more): those of surfaces inside the wall follow those of the faces."""
        shell = self.discretisation
        if shell.wall is None:
            return self.displacements(u)
        faces, inside = np.split(shell.map.everywhere(u, self.prescribed), [shell.map.n_faces])
        return np.hstack([each.reshape(shell.grid.n_nodes, -1) for each in (faces, inside)])

    def volume_ratios(self, u: np.ndarray) -> np.ndarray:
        """Volumes (E,) of the elements at u over those at rest, (x,1 x x,2) . (x+ - x-) at their centres, x midway.

        Below zero where an element is turned inside out, as where the inner face lies beyond the outer. NaN where the
        element is so curved at rest that its chords see less than SEEN of its volume.
        """
        shell = self.discretisation
        rest = np.array(shell.positions())
        slopes = 2.0 * shape_functions(np.zeros((1, 2)))[1][0]  # along both middle lines, from side to side

        def volumes(faces: np.ndarray) -> np.ndarray:
            inner, outer = faces[:, shell.grid.elements]
            along, other = np.einsum("br,erx->bex", slopes, 0.5 * (inner + outer))
            return np.sum(np.cross(along, other) * np.mean(outer - inner, axis=1), axis=-1)

        before, after = volumes(rest), volumes(rest + shell.cartesian(u, self.prescribed))
        seen = np.abs(before) >= SEEN * shell.geometry.weight * shell.laminate.thickness
        return np.divide(after, before, out=np.full(len(before), np.nan), where=seen)

    def resultants(self, u: np.ndarray) -> np.ndarray:
        """Mode resultants H (E, 22) [N/mm], in the order of :data:`formulations.element.mixed.MODES`.

        With surfaces inside the wall (E, 15 T), in that of :mod:`formulations.element.walls.modes`.
        """
        return self._element.resultants(self.mode_strains(u))

    def mode_strains(self, u: np.ndarray) -> np.ndarray:
        """Mode strains E (E, 22), or (E, 15 T) as :meth:`resultants`."""
        return self._element.mode_strains(self.discretisation.geometry, self._element_vectors(u))

    def gauss_strains(self, u: np.ndarray) -> np.ndarray:
        """Strains (E, 4, 11) of the modes at the Gauss points, in the axes of the laminate."""
        return self._element.at_gauss(self.discretisation.geometry, self.mode_strains(u))

    def strains_at(self, u: np.ndarray, xi: np.ndarray) -> np.ndarray:
        """Strains (E, p, 11) of the modes at points xi (p, 2) of the reference square: bilinear, as the modes are."""
        through_gauss, _ = shape_functions(np.sqrt(3.0) * xi)
        return np.einsum("pg,egi->epi", through_gauss, self.gauss_strains(u))

    def mean_strains(self, u: np.ndarray) -> np.ndarray:
        """Means E (E, 11) over the elements, in the axes of the laminate."""
        return self._element.mean_strains(self.discretisation.geometry, self.mode_strains(u))

    def mean_resultants(self, u: np.ndarray) -> np.ndarray:
        """Means H (E, 11) [N/mm] over the elements, in the axes of the laminate."""
        return self._element.mean_resultants(self.discretisation.geometry, self.mode_strains(u))

    def wall_stresses(self, u: np.ndarray, taken: np.ndarray) -> np.ndarray:
        """Mean S (E, plies, k, 6) [MPa]: 11, 22, 12, 13, 23, 33 along the coordinates, with surfaces inside the wall.

        taken (plies, k, T): the places, see :meth:`formulations.section.sampling.Sampling.taken`.
        """
        from formulations.element.walls.sampling_element import SamplingElement

        assert isinstance(self._element, SamplingElement)
        return self._element.stresses(self.mode_strains(u), taken)

    def ply_stresses(self, u: np.ndarray) -> np.ndarray:
        """Mean S_LL, S_TT, S_LT [MPa] along and across the fibres on both sides of each ply, (E, plies, 2, 3)."""
        shell = self.discretisation
        if shell.wall is None:
            return shell.stresses(self.mean_strains(u), self.section)
        sides = np.array([shell.wall.sampling.taken(k, np.array(d)) for k, d in enumerate(shell.wall.sampling.ends)])
        S = self.wall_stresses(u, sides)[..., :3]
        turns = [np.linalg.inv(strain_rotation(ply.angle)[PLANE, PLANE]) for ply in shell.laminate.plies]
        return np.einsum("epsi,pij->epsj", S, np.array(turns))

    def strain_change(self, u: np.ndarray, du: np.ndarray) -> np.ndarray:
        """B(u) du (E, 22): the change of the mode strains along the free displacements du, to first order."""
        B = self._element.mode_gradient(self.discretisation.geometry, self._element_vectors(u))
        return along(B, self._at(u), du)

    def reactions(self, u: np.ndarray) -> np.ndarray:
        """Forces (N, 6) of the supports on the shell in equilibrium at u [N], in the local frames; 0 where free.

        A hinge midway between the faces acts on both alike. Nodal forces put on a support itself are not counted.
        """
        force, external = self.element_forces(u)
        return self._reactions(self._at(u), less(force, self._loads(external)))

    def _reactions(self, shell: Discretisation, total: np.ndarray) -> np.ndarray:
        nodal = shell.nodal(total)
        on_hinges = np.repeat(nodal.reshape(-1, 3, 2).mean(axis=2), 2, axis=1)
        return np.where(shell.map.held, nodal, np.where(shell.map.hinged, on_hinges, 0.0))

    def left_to_foundation(self, u: np.ndarray) -> np.ndarray:
        """The first less the second of :meth:`outside_and_spurious`, (3,) [N]: what a foundation balances."""
        return np.subtract(*self.outside_and_spurious(u))

    def outside_and_spurious(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Resultants (3,) [N], Cartesian, at u: of loads and supports on the shell, and of what it does inside.

        Dead forces on a hinge do not count. In equilibrium with a foundation, its force + the first = the second. That
        is nothing where the interpolation can translate the shell without strain: "isoparametric", or on a plate. Where
        components along a curved surface are interpolated it can not, and the sum falls with the square of the mesh.
        """
        force, external = self.element_forces(u)
        loads, shell = self._loads(external), self._at(u)
        nodal = shell.nodal(loads) + self._reactions(shell, less(force, loads))
        if self.forces is not None:
            nodal += np.where(self.discretisation.map.hinged, 0.0, self.discretisation.map.placed(self.forces))
        return self._resultant(nodal), self._resultant(shell.nodal(force))

    def _resultant(self, nodal: np.ndarray) -> np.ndarray:
        """Cartesian sum (3,) of forces (N, 6) in the local frames."""
        frame = self.discretisation.surface.frame(*self.discretisation.grid.nodes.T)
        return np.einsum("nif,nij->j", nodal.reshape(-1, 3, 2), frame)

    def _at(self, u: np.ndarray) -> Discretisation:
        return self.discretisation.at(self.displacements(u))

    def _element_vectors(self, u: np.ndarray) -> np.ndarray:
        return self.discretisation.of_elements(u, self.prescribed)

    def _loads(self, external: np.ndarray | None) -> np.ndarray:
        return self._dead if external is None else less(self._dead, -external)


def less(force: np.ndarray, loads: np.ndarray) -> np.ndarray:
    """Forces on elements without loads, which may be of their faces alone, (E, 24)."""
    if force.shape == loads.shape:
        return np.asarray(force - loads)
    left = force.copy()
    left[:, : loads.shape[1]] -= loads
    return left


def along(B: np.ndarray, shell: Discretisation, du: np.ndarray) -> np.ndarray:
    """B dv (E, 22) of the displacements that the free ones du bring."""
    return np.matmul(B, shell.moved(du)[..., None])[..., 0]

"""A surface on a grid, its supports and the sparse pattern: what every load and every measure on it share.

No measure, no load and no contact may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from formulations.conditions.boundary import Hangers
from formulations.conditions.dof_map import DofMap, Images
from formulations.element.on_grid import Walls, at_faces, geometry_on, wall_on
from formulations.element.sparsity import Pattern
from formulations.element.strain_operator import GAUSS, N_DOF, ElementGeometry, shape_functions
from formulations.geometry.grid import Grid, QuadGrid
from formulations.geometry.nested_dissection import elimination_order
from formulations.geometry.surfaces import Surface, normal
from formulations.section.laminate import BETWEEN_FACES, Laminate
from formulations.strains.quantities import FULL, N_V, Kinematics

if TYPE_CHECKING:
    from formulations.element.walls.geometry import WallGeometry
    from formulations.section.sampling import Sampling


@dataclass(frozen=True, eq=False)
class Discretisation:
    """Geometry on the grid, supports, and the sparse pattern; laminate: of the walls the first, where they differ.

    dofs (E, 24 and more): displacements of the elements, those of the faces first.  wall: what surfaces between the
    faces need beside the geometry, None where there are none.  met: the same with another turn of its hanging nodes.
    """

    surface: Surface
    grid: Grid
    laminate: Laminate
    map: DofMap
    geometry: ElementGeometry = field(repr=False)
    dofs: np.ndarray = field(repr=False)
    scratch: tuple[np.ndarray, np.ndarray] = field(repr=False)
    ordered: bool = False
    hangers: Hangers | None = None
    walls: Walls | None = None
    wall: WallGeometry | None = field(default=None, repr=False)
    met: Discretisation | None = field(default=None, repr=False)

    @classmethod
    def build(
        cls,
        surface: Surface,
        grid: Grid,
        laminate: Laminate,
        fixed: np.ndarray,
        hinged: np.ndarray | None = None,
        kinematics: Kinematics = FULL,
        interpolation: str = "curvilinear",
        images: Images | None = None,
        *,
        ordered: bool = False,
        walls: Walls | None = None,
        surfaces: str = BETWEEN_FACES,
    ) -> Discretisation:
        """``fixed`` (N, 6) bool: face displacements held at zero; ``hinged`` (N, 3) and images: see :class:`DofMap`.

        ``interpolation``: "curvilinear" (the paper) or "isoparametric", see :class:`ElementGeometry`, or "quads", see
        :class:`QuadGeometry`, for meshes that follow no lines of curvature.  ``ordered``: number the unknowns by nested
        dissection, so that a factorisation may keep their order; else as the nodes are.  ``walls``: of quads, where
        they differ; the laminate is the first of them.  ``surfaces``: see :class:`Sampling`; raises ValueError where
        quadrilaterals or hanging nodes know none inside the wall.
        """
        order = None
        if ordered:
            followed = None if images is None else images.followed
            positions = surface.position(*grid.nodes.T) if isinstance(grid, QuadGrid) else None
            order = elimination_order(grid, followed, positions)
        hangers = Hangers.of(grid, surface, laminate, interpolation, fixed, hinged)
        carried = None if hangers is None else hangers.matrix(np.zeros((grid.n_nodes, N_V)))
        sampling = None if surfaces == BETWEEN_FACES else _sampling(laminate, surfaces)
        inside = () if sampling is None else sampling.inside
        dof_map = DofMap.build(fixed, hinged, images, order, carried, inside)
        dofs = (grid.elements[:, :, None] * N_V + np.arange(N_V)).reshape(-1, N_DOF)
        if inside:
            places = np.arange(grid.n_nodes * len(inside) * 3).reshape(grid.n_nodes, len(inside), 3)
            dofs = np.hstack([dofs, fixed.size + places[grid.elements].swapaxes(1, 2).reshape(len(dofs), -1)])
        scratch = (np.empty(dofs.shape), np.empty((*dofs.shape, dofs.shape[1])))
        geometry = geometry_on(surface, grid, laminate, kinematics, interpolation, walls)
        wall = None if sampling is None else wall_on(surface, grid, laminate, sampling, geometry, walls)
        parts = (surface, grid, laminate, dof_map, geometry, dofs, scratch)
        return cls(*parts, ordered, hangers, walls, wall)

    def leaving_out(self, kinematics: Kinematics) -> Discretisation:
        """The same grid with other gradients."""
        interpolation = self.geometry.interpolation
        geometry = geometry_on(self.surface, self.grid, self.laminate, kinematics, interpolation, self.walls)
        parts = (self.surface, self.grid, self.laminate)
        wall = self.wall and wall_on(*parts, self.wall.sampling, geometry, self.walls)
        return replace(self, geometry=geometry, wall=wall)

    def stiffness(self, section: str) -> np.ndarray:
        """D of the wall [N/mm], (11, 11), or at the Gauss points of each element (E, 4, 11, 11) where walls differ."""
        if self.walls is None:
            return self.laminate.stiffness(section)
        if section not in self._stiffness:  # the same array for all steps of a path
            growth = self.walls.growth @ shape_functions(GAUSS)[0].T
            own = self.walls.stiffness(section)[self.walls.kind]
            self._stiffness[section] = growth[..., None, None] * own[:, None]
        return self._stiffness[section]

    def stiffness_at(self, nodes: np.ndarray, section: str) -> np.ndarray:
        """D of the wall [N/mm] at nodes (k,), (k, 11, 11): the mean over the elements around."""
        D = self.stiffness(section)
        if D.ndim == 2:
            return np.broadcast_to(D, (len(nodes), *D.shape))
        around = ((self.grid.elements == node).any(axis=1) for node in nodes)
        return np.array([D[each].mean(axis=(0, 1)) for each in around]).reshape(-1, *D.shape[2:])

    def stresses(self, strains: np.ndarray, section: str) -> np.ndarray:
        """Of the plies, (E, plies, 2, 3), of strains (E, 11), see :meth:`Laminate.stresses`; 0 beyond the last ply."""
        if self.walls is None:
            return self.laminate.stresses(strains, section)
        laminates, kind = self.walls.laminates, self.walls.kind
        stress = np.zeros((len(strains), max(len(each.plies) for each in laminates), 2, 3))
        for k, laminate in enumerate(laminates):
            stress[kind == k, : len(laminate.plies)] = laminate.stresses(strains[kind == k], section)
        return stress

    @cached_property
    def _stiffness(self) -> dict[str, np.ndarray]:
        return {}

    @property
    def n_free(self) -> int:
        """Number of unknowns."""
        return self.map.n

    def at(self, v: np.ndarray) -> Discretisation:
        """The same where forces and stiffnesses are met at the displacements v (N, 6), by which hanging nodes turn."""
        if self.hangers is None:
            return self
        dof_map = self.map.carrying(self.hangers.matrix(v))
        return replace(self, map=dof_map, met=self)

    @cached_property
    def pattern(self) -> Pattern:
        """Where the entries of element matrices go; not every grid is assembled on."""
        constrained = self.map.of_elements(self.dofs)
        if self.met is not None:
            return self.met.pattern.constraining(constrained)
        return Pattern.build(self.map.number[self.dofs], self.map.n, constrained)

    def linearised(self) -> Discretisation:
        """The same for a linear measure: hanging nodes do not turn."""
        return self if self.hangers is None else replace(self, hangers=self.hangers.linearised())

    def of_elements(self, u: np.ndarray, prescribed: np.ndarray | None = None) -> np.ndarray:
        """Displacements (E, 24 and more) of the elements."""
        if self.wall is None:
            return self.expand(u, prescribed).ravel()[self.dofs]
        return self.map.everywhere(u, prescribed)[self.dofs]

    def moved(self, du: np.ndarray) -> np.ndarray:
        """What changes du of the unknowns are to the elements, (E, 24 and more), to first order."""
        v = self.map.expand(du).ravel() if self.wall is None else self.map.everywhere(du)
        return np.asarray(v[self.dofs])

    def expand(self, u: np.ndarray, prescribed: np.ndarray | None = None) -> np.ndarray:
        """All face displacements (N, 6) from the unknowns; held ones are zero, or ``prescribed`` (N, 6)."""
        if self.hangers is None and prescribed is None:
            return self.map.expand(u)
        v = self.map.placed(u) if prescribed is None else self.map.placed(u) + prescribed
        return v if self.hangers is None else self.hangers.place(v)

    def reduce(self, forces: np.ndarray) -> np.ndarray:
        """Forces (n,) on the unknowns from nodal forces (N, 6) in the local frames."""
        return self.map.gather(forces)

    def gather(self, element_vectors: np.ndarray) -> np.ndarray:
        """Sum element vectors, (E, 24) of the faces or whole ones, into forces (n,) on the unknowns."""
        if element_vectors.shape[1] > N_DOF:
            return self.map.gather(self._summed(element_vectors, len(self.map.number)))
        return self.map.gather(self.nodal(element_vectors))

    def nodal(self, element_vectors: np.ndarray) -> np.ndarray:
        """Sum element vectors into nodal forces (N, 6), those on held displacements included.

        Forces on surfaces inside the wall are shared by the faces, the more the closer they are.
        """
        if element_vectors.shape[1] > N_DOF:
            return self.map.on_faces(self._summed(element_vectors, len(self.map.number)))
        return self.map.hand_on(self.on_nodes(element_vectors))

    def on_nodes(self, element_vectors: np.ndarray) -> np.ndarray:
        """Sum element vectors (E, 24) into nodal forces (N, 6), those on hanging nodes where they are."""
        return self._summed(element_vectors[:, :N_DOF], self.grid.n_nodes * N_V).reshape(-1, N_V)

    def _summed(self, element_vectors: np.ndarray, n: int) -> np.ndarray:
        dofs = self.dofs[:, : element_vectors.shape[1]]
        return np.bincount(dofs.ravel(), weights=element_vectors.ravel(), minlength=n)

    def assemble(self, element_matrices: np.ndarray) -> sparse.csc_matrix:
        """Sum element matrices (E, 24 and more, 24 and more) into the CSC matrix of the unknowns."""
        return self.pattern.assemble(element_matrices)

    def displacement_operator(self, nodes: np.ndarray, face: int) -> sparse.csr_matrix:
        """Sparse (3m, n): Cartesian displacements of the nodes on a face (0 inner, 1 outer) from the unknowns."""
        frame = self.surface.frame(self.grid.nodes[nodes, 0], self.grid.nodes[nodes, 1])
        rows = np.broadcast_to(np.arange(3 * len(nodes)).reshape(-1, 1, 3), frame.shape)  # (m, i, x)
        dofs = N_V * nodes[:, None] + 2 * np.arange(3) + face
        columns = np.broadcast_to(dofs[:, :, None], frame.shape)
        shape = (3 * len(nodes), len(self.map.number))
        full = sparse.coo_matrix((frame.ravel(), (rows.ravel(), columns.ravel())), shape=shape)
        return sparse.csr_matrix(full.tocsr() @ self.map.matrix())

    def cartesian(self, u: np.ndarray, prescribed: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Cartesian displacements (N, 3) of the inner and of the outer face; ``prescribed`` as in :meth:`expand`."""
        v = self.expand(u, prescribed)
        frame = self.surface.frame(self.grid.nodes[:, 0], self.grid.nodes[:, 1])
        inner, outer = (np.einsum("...i,...ij->...j", v[:, face::2], frame) for face in (0, 1))
        return inner, outer

    def at_distance(self, u: np.ndarray, d: float, prescribed: np.ndarray | None = None) -> np.ndarray:
        """Displacements (N, 3) in the local frames of the surface at the distance d from the reference surface."""
        faces = self.expand(u, prescribed).reshape(-1, 3, 2)
        if self.wall is None:
            outer = (d - self.laminate.d_minus) / self.laminate.thickness
            return np.asarray(faces @ [1 - outer, outer])
        inside = self.map.everywhere(u, prescribed)[self.map.n_faces :].reshape(len(faces), -1, 3)
        shares = self.wall.sampling.displaced(d)
        return np.asarray(faces @ shares[[0, -1]] + np.einsum("s,nsi->ni", shares[1:-1], inside))

    def positions(self) -> tuple[np.ndarray, np.ndarray]:
        """Cartesian reference positions (N, 3) of the inner and of the outer face."""
        a1, a2 = self.grid.nodes.T
        x, e3 = self.surface.position(a1, a2), normal(self.surface, a1, a2)
        d = at_faces(self.laminate, self.walls, self.grid)
        return x + d[..., :1] * e3, x + d[..., 1:] * e3

    def gauss_frames(self) -> np.ndarray:
        """Frames (E, 4, 3, 3) at the Gauss points, to whose directions ``geometry.value`` belongs."""
        return self.geometry.frames_on(self.surface, self.grid)

    def left_handed(self) -> np.ndarray:
        """(E,) bool: whether the corners of an element go round against its normal."""
        return self.geometry.left_handed_on(self.surface, self.grid)

    def nodal_areas(self, face: str) -> np.ndarray:
        """Area (N,) of the nodes, int N_r dA, of the "mid" surface (mubar) or of the "outer" face."""
        shares = self.geometry.corner_areas(face).ravel()
        areas = np.bincount(self.grid.elements.ravel(), weights=shares, minlength=self.grid.n_nodes)
        return areas if self.grid.hanging is None else self.grid.hanging.shares.T @ areas

    def nodal_mass(self, face: str) -> sparse.csr_matrix:
        """Consistent matrix (N, N) of int N_r N_s dA on the same areas; its row sums are the nodal areas."""
        rows = np.repeat(self.grid.elements, 4, axis=1).ravel()
        columns = np.tile(self.grid.elements, (1, 4)).ravel()
        n = self.grid.n_nodes
        mass = sparse.coo_matrix((self.geometry.corner_mass(face).ravel(), (rows, columns)), shape=(n, n)).tocsr()
        if self.grid.hanging is None:
            return mass
        shares = self.grid.hanging.shares
        return sparse.csr_matrix(shares.T @ mass @ shares)


def _sampling(laminate: Laminate, surfaces: str) -> Sampling:
    from formulations.section.sampling import Sampling  # loaded with surfaces inside the wall alone

    return Sampling.of(laminate, surfaces)

"""The shell model: surface, grid, section, measure, supports and loads as one function of the free displacements.

``linearise(u, memory)`` serves ANY measure, plain and mixed Newton. Parts are frozen records; state goes in and comes
out; the only mutable things are scratch arrays whose contents never survive a call. No contact may enter here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse
from scipy.linalg import norm

from formulations.element import N_DOF, ElementGeometry, MixedElement
from formulations.grid import Grid
from formulations.laminate import Laminate
from formulations.loads import Pressure
from formulations.measure import StrainMeasure
from formulations.quantities import N_E, N_V
from formulations.surface import Surface

NEWTONS = ("plain", "mixed")


@dataclass(frozen=True, eq=False)
class Linearisation:
    """Residual r(u) (n,) = internal - external force [N], tangent dr/du (n, n) CSC [N/mm], force scale [N].

    ``scale`` is the larger norm of the internal and the external force: residuals are judged relative to it.
    ``remember(du)`` returns the memory to pass on after the step du (None where nothing is remembered).
    """

    residual: np.ndarray
    tangent: sparse.csc_matrix
    scale: float
    remember: Callable[[np.ndarray], object]


@dataclass(frozen=True, eq=False)
class Discretisation:
    """Geometry on the grid, supports, and the sparse pattern with the slots of every element entry."""

    surface: Surface
    grid: Grid
    laminate: Laminate
    free: np.ndarray
    geometry: ElementGeometry = field(repr=False)
    dofs: np.ndarray = field(repr=False)
    indptr: np.ndarray = field(repr=False)
    indices: np.ndarray = field(repr=False)
    slots: np.ndarray = field(repr=False)
    scratch: tuple[np.ndarray, np.ndarray] = field(repr=False)

    @classmethod
    def build(cls, surface: Surface, grid: Grid, laminate: Laminate, fixed: np.ndarray) -> Discretisation:
        """``fixed`` (N, 6) bool: the face displacements held at zero. Raises ValueError when nothing is free."""
        free = np.flatnonzero(~fixed.ravel())
        if len(free) == 0:
            raise ValueError("every displacement is held: nothing to solve")
        number = np.full(fixed.size, -1, dtype=np.intp)
        number[free] = np.arange(len(free))
        dofs = (grid.elements[:, :, None] * N_V + np.arange(N_V)).reshape(-1, N_DOF)
        indptr, indices, slots = _pattern(number[dofs], len(free))
        n = len(dofs)
        scratch = (np.empty((n, N_DOF)), np.empty((n, N_DOF, N_DOF)))
        geometry = ElementGeometry.build(surface, grid, laminate)
        return cls(surface, grid, laminate, free, geometry, dofs, indptr, indices, slots, scratch)

    @property
    def n_free(self) -> int:
        """Number of unknowns."""
        return len(self.free)

    def expand(self, u: np.ndarray) -> np.ndarray:
        """All face displacements (N, 6) from the free ones; held ones are zero."""
        full = np.zeros(self.grid.n_nodes * N_V)
        full[self.free] = u
        return full.reshape(-1, N_V)

    def gather(self, element_vectors: np.ndarray) -> np.ndarray:
        """Sum element vectors (E, 24) into the free ones (n,)."""
        full = np.bincount(self.dofs.ravel(), weights=element_vectors.ravel(), minlength=self.grid.n_nodes * N_V)
        return full[self.free]

    def assemble(self, element_matrices: np.ndarray) -> sparse.csc_matrix:
        """Sum element matrices (E, 24, 24) into the free CSC matrix through the slots found once."""
        nnz = len(self.indices)
        data = np.bincount(self.slots, weights=element_matrices.ravel(), minlength=nnz + 1)[:nnz]
        return sparse.csc_matrix((data, self.indices, self.indptr), shape=(self.n_free, self.n_free))

    def displacement_operator(self, nodes: np.ndarray, face: int) -> sparse.csr_matrix:
        """Sparse (3m, n): Cartesian displacements of the nodes on a face (0 inner, 1 outer) from the free u."""
        frame = self.surface.frame(self.grid.nodes[nodes, 0], self.grid.nodes[nodes, 1])
        rows = np.broadcast_to(np.arange(3 * len(nodes)).reshape(-1, 1, 3), frame.shape)  # (m, i, x)
        dofs = N_V * nodes[:, None] + 2 * np.arange(3) + face
        columns = np.broadcast_to(dofs[:, :, None], frame.shape)
        shape = (3 * len(nodes), self.grid.n_nodes * N_V)
        full = sparse.coo_matrix((frame.ravel(), (rows.ravel(), columns.ravel())), shape=shape)
        return full.tocsc()[:, self.free].tocsr()

    def cartesian(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Cartesian displacements (N, 3) of the inner and of the outer face."""
        v = self.expand(u)
        frame = self.surface.frame(self.grid.nodes[:, 0], self.grid.nodes[:, 1])
        inner, outer = (np.einsum("...i,...ij->...j", v[:, face::2], frame) for face in (0, 1))
        return inner, outer

    def positions(self) -> tuple[np.ndarray, np.ndarray]:
        """Cartesian reference positions (N, 3) of the inner and of the outer face."""
        a1, a2 = self.grid.nodes.T
        x, normal = self.surface.position(a1, a2), self.surface.frame(a1, a2)[:, 2]
        return x + self.laminate.d_minus * normal, x + self.laminate.d_plus * normal

    def nodal_areas(self, face: str) -> np.ndarray:
        """Area (N,) of the nodes, int N_r dA, of the "mid" surface (mubar) or of the "outer" face."""
        area = {"mid": self.geometry.weight, "outer": self.geometry.face_weight[:, 1]}[face]
        shares = np.repeat(0.25 * area, 4)
        return np.bincount(self.grid.elements.ravel(), weights=shares, minlength=self.grid.n_nodes)

    def nodal_mass(self, face: str) -> sparse.csr_matrix:
        """Consistent matrix (N, N) of int N_r N_s dA on the same areas; its row sums are the nodal areas."""
        area = {"mid": self.geometry.weight, "outer": self.geometry.face_weight[:, 1]}[face]
        line = np.array([[2, 1], [1, 2]]) / 6
        square = np.kron(line, line)[np.ix_((0, 1, 3, 2), (0, 1, 3, 2))]  # tensor order to the order of the corners
        rows = np.repeat(self.grid.elements, 4, axis=1).ravel()
        columns = np.tile(self.grid.elements, (1, 4)).ravel()
        values = (area[:, None, None] * square).ravel()
        n = self.grid.n_nodes
        return sparse.coo_matrix((values, (rows, columns)), shape=(n, n)).tocsr()


def _pattern(number: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """CSC pattern of the free matrix and the slot of every element entry; held entries go to one slot past the end."""
    row, column = np.broadcast_arrays(number[:, :, None], number[:, None, :])
    held = ((row < 0) | (column < 0)).ravel()
    keys = column.ravel().astype(np.int64) * n + row.ravel()
    keys[held] = n * n
    unique, slots = np.unique(keys, return_inverse=True)
    entries = unique[unique < n * n]
    indptr = np.searchsorted(entries, np.arange(n + 1, dtype=np.int64) * n)
    return indptr.astype(np.int32), (entries % n).astype(np.int32), slots.ravel().astype(np.intp)


@dataclass(frozen=True, eq=False)
class ShellModel:
    """A loaded shell.

    forces (n,): dead nodal forces on the free displacements, in the local frames [N].  initial (11,): resultants H0 of
    the reference state [N/mm].  newton: "plain" or "mixed" (the resultants predicted by the last linear step build the
    geometric stiffness; THEORY: mixed-integration-point strategy of Magisano, Leonetti, Garcea 2017).
    """

    discretisation: Discretisation
    measure: StrainMeasure
    section: str = "constant-s33"
    newton: str = "mixed"
    pressure: Pressure | None = None
    forces: np.ndarray | None = None
    initial: np.ndarray | None = None
    _element: MixedElement = field(init=False, repr=False)
    _dead: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if self.newton not in NEWTONS:
            raise ValueError(f"newton {self.newton!r} is not one of {', '.join(NEWTONS)}")
        shell = self.discretisation
        initial = np.zeros(N_E) if self.initial is None else np.asarray(self.initial, float)
        element = MixedElement.build(self.measure, shell.laminate.stiffness(self.section), initial)
        constant = element.linear_initial_force(shell.geometry)
        if self.pressure is not None and not self.pressure.follower:
            constant = constant + self.pressure.dead_force(shell.geometry)
        dead = shell.gather(constant)
        object.__setattr__(self, "_element", element)
        object.__setattr__(self, "_dead", dead if self.forces is None else dead + self.forces)

    def scaled(self, factor: float) -> ShellModel:
        """The same shell under ``factor`` times its pressure and forces."""
        pressure = None if self.pressure is None else replace(self.pressure, value=factor * self.pressure.value)
        forces = None if self.forces is None else factor * self.forces
        return replace(self, pressure=pressure, forces=forces)

    def linearise(self, u: np.ndarray, memory: object = None) -> Linearisation:
        """Residual, tangent and what to remember at the free displacements u (n,).

        ``memory`` is what ``remember`` of the last step returned, or None. Only the mixed Newton uses it.
        """
        force, external, tangent = self.element_contributions(u, memory)
        internal = self.discretisation.gather(force)
        outside = self._dead if external is None else self._dead + self.discretisation.gather(external)
        return Linearisation(
            residual=internal - outside,
            tangent=self.discretisation.assemble(tangent),
            scale=float(max(norm(internal, check_finite=False), norm(outside, check_finite=False))),
            remember=lambda du: self._predict(u, du),
        )

    def energy(self, u: np.ndarray) -> float:
        """Strain energy minus the work of the dead loads [N mm]; the potential when D is symmetric and H0 zero."""
        strain_energy = self._element.energy(self.discretisation.geometry, self._element_vectors(u))
        return strain_energy - float(self._dead @ u)

    def resultants(self, u: np.ndarray) -> np.ndarray:
        """Mode resultants H (E, 22) [N/mm]; the first 11 are the element means in the order of the strains."""
        strains = self._element.mode_strains(self.discretisation.geometry, self._element_vectors(u))
        return self._element.resultants(strains)

    def element_contributions(self, u: np.ndarray, memory: object) -> tuple[np.ndarray, np.ndarray | None, np.ndarray]:
        """Element forces, external element forces that follow (or None), element tangents."""
        geometry, (force, tangent) = self.discretisation.geometry, self.discretisation.scratch
        v = self._element_vectors(u)
        predicted = memory if isinstance(memory, np.ndarray) else None
        self._element.integrate(geometry, v, predicted, force, tangent)
        if self.pressure is None or not self.pressure.follower:
            return force, None, tangent
        external = np.zeros_like(force)
        self.pressure.follower_force(geometry, v, external, tangent)
        return force, external, tangent

    def _predict(self, u: np.ndarray, du: np.ndarray) -> np.ndarray | None:
        """H* = D (E(u) + B(u) du), (E, 22), for the mixed Newton."""
        if self.newton == "plain":
            return None
        v, dv = self._element_vectors(u), self._element_vectors(du)
        return self._element.resultants(self._element.mode_strains(self.discretisation.geometry, v, dv))

    def _element_vectors(self, u: np.ndarray) -> np.ndarray:
        return self.discretisation.expand(u).ravel()[self.discretisation.dofs]

"""The 3D judge: the same body as a shell, meshed with triquadratic hexahedra between its two faces.

Total Lagrangian with a law of :mod:`formulations.section.laws` for each ply, Cartesian displacements, isoparametric
geometry (so every rigid motion is exact). It shares surfaces, plies and loads with the shell but no kinematic
assumption; no shell element and no contact may enter here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse
from scipy.linalg import norm

from formulations.element.sparsity import Pattern
from formulations.loads import Pressure
from formulations.operations import product, spend
from formulations.section.laminate import Laminate, Ply
from formulations.section.laws import StVenantKirchhoff
from formulations.section.material import VOIGT, Law, tensor
from formulations.shell import Linearisation
from formulations.solid_mesh import CUBE, SQUARE, SolidMesh

CHUNK = 16  # elements a pass


@dataclass(frozen=True, eq=False)
class SolidDiscretisation:
    """Mesh, material and supports of a body; ``fixed`` (N, 3) bool holds Cartesian displacements.

    free (n,): the flat displacements that are unknown.  dofs (E, 81): flat displacements of the elements.
    gradients (E, 27 points, 27 nodes, 3): of N along the local axes; volumes (E, 27 points); laws: one a ply.
    A :meth:`section` has 9 points, 9 nodes and 27 displacements an element instead.
    """

    mesh: SolidMesh
    fixed: np.ndarray
    free: np.ndarray
    dofs: np.ndarray = field(repr=False)
    pattern: Pattern = field(repr=False)
    gradients: np.ndarray = field(repr=False)
    volumes: np.ndarray = field(repr=False)
    laws: tuple[Law, ...]

    @classmethod
    def build(
        cls,
        mesh: SolidMesh,
        laminate: Laminate,
        fixed: np.ndarray,
        law: Callable[[Ply], Law] = StVenantKirchhoff.of,
    ) -> SolidDiscretisation:
        """Number the unknowns and evaluate the reference geometry; law: makes that of a ply, which may refuse it."""
        free = np.flatnonzero(~fixed.ravel())
        number = np.full(fixed.size, -1, dtype=np.intp)
        number[free] = np.arange(len(free))
        dofs = _flat(mesh.elements)
        jacobian = np.einsum("gnd,enx->egdx", CUBE.slope, mesh.x[mesh.elements])
        along_x = np.einsum("gnd,egxd->egnx", CUBE.slope, np.linalg.inv(jacobian))
        volumes = CUBE.weights * np.abs(np.linalg.det(jacobian))
        gradients = np.einsum("egnx,egix->egni", along_x, mesh.frame)
        laws = tuple(law(ply) for ply in laminate.plies)
        return cls(mesh, fixed, free, dofs, Pattern.build(number[dofs], len(free)), gradients, volumes, laws)

    def section(self) -> SolidDiscretisation:
        """The same where all nodes of one (a2, a3) move alike, by the elements of the lowest a1 and their nodes there.

        For a body that is drawn out along a1, with elements of one length along it: one Gauss point, the middle one.
        """
        low = self.mesh.parameter[self.mesh.elements[:, 0], 0]
        own, middle = np.flatnonzero(np.isclose(low, low.min())), slice(9, 18)
        elements = self.mesh.elements[own, :9]
        mesh = replace(self.mesh, elements=elements, frame=self.mesh.frame[own, middle], ply=self.mesh.ply[own])
        of_columns = self.gradients[own, middle].reshape(len(own), 9, 3, 9, 3).sum(axis=2)
        volumes = self.volumes[own].reshape(-1, 3, 9).sum(axis=1) * (len(low) // len(own))
        fixed = self.fixed | ~np.isin(np.arange(len(self.fixed)), elements)[:, None]
        free, dofs = np.flatnonzero(~fixed.ravel()), _flat(elements)
        number = np.full(fixed.size, -1, dtype=np.intp)
        number[free] = np.arange(len(free))
        pattern = Pattern.build(number[dofs], len(free))
        return SolidDiscretisation(mesh, fixed, free, dofs, pattern, of_columns, volumes, self.laws)

    @property
    def n_free(self) -> int:
        """Number of unknowns."""
        return len(self.free)

    def expand(self, u: np.ndarray) -> np.ndarray:
        """All displacements (N, 3) from the free ones."""
        full = np.zeros(self.fixed.size)
        full[self.free] = u
        return full.reshape(-1, 3)

    def displacement_operator(self, nodes: np.ndarray) -> sparse.csr_matrix:
        """Sparse (3m, n): Cartesian displacements of the nodes from the free u."""
        selection = sparse.eye_array(self.fixed.size, format="csr")[_flat(nodes[:, None]).ravel()]
        return sparse.csr_matrix(selection[:, self.free])

    def nodal(self, dofs: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """Sum forces on the flat displacements ``dofs``, arrays of one shape, into (3N,)."""
        return np.bincount(dofs.ravel(), weights=forces.ravel(), minlength=self.fixed.size)

    def internal(self, full: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Internal force (E, 81) and tangent (E, 81, 81) at the displacements (N, 3)."""
        (count, points, nodes, _), k = self.gradients.shape, self.dofs.shape[1]
        force, tangent = np.empty((count, k)), np.empty((count, k, k))
        # F, dE/du, C dE/du, the material and the geometric part at every point
        each = 4 * product(nodes, 3, 3) + product(6, 6, k) + product(k, 6, k) + product(nodes, nodes, 3)
        spend(points * count * each)
        for law, part in self._passes():
            G, volume = self.gradients[part], self.volumes[part]
            F, strain = self._strained(full, part)
            stress, C = law.response(strain)
            stress = stress * volume[..., None]
            B = _strain_gradient(F, G)
            flat = B.reshape(len(part), -1, k)
            CB = np.matmul(C, B * volume[..., None, None]).reshape(flat.shape)
            force[part] = np.einsum("egp,egpk->ek", stress, B)
            initial = np.einsum("egni,egij,egmj->enm", G, tensor(stress), G, optimize=True)
            block = np.matmul(flat.transpose(0, 2, 1), CB)
            of_nodes = block.reshape(-1, nodes, 3, nodes, 3)
            for x in range(3):
                of_nodes[:, :, x, :, x] += initial
            tangent[part] = block
        return force, tangent

    def internal_force(self, full: np.ndarray) -> np.ndarray:
        """The force (E, 81) of :meth:`internal` alone."""
        force = np.empty(self.dofs.shape)
        for law, part in self._passes():
            F, strain = self._strained(full, part)
            stress = law.response(strain)[0] * self.volumes[part][..., None]
            force[part] = np.einsum("egp,egpk->ek", stress, _strain_gradient(F, self.gradients[part]))
        return force

    def energy(self, full: np.ndarray) -> float:
        """Strain energy [N mm] at the displacements (N, 3)."""
        parts = ((law, part, self._strained(full, part)[1]) for law, part in self._passes())
        return float(sum(np.sum(law.energy(strain) * self.volumes[part]) for law, part, strain in parts))

    def _strained(self, full: np.ndarray, part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """F (e, 27, 3, 3) and Green's strain (e, 27, 6) of elements."""
        F = self.deformation(full, part)
        return F, np.stack([_green(F, i, j) * (1 if i == j else 2) for i, j in VOIGT], axis=-1)

    def deformation(self, full: np.ndarray, part: np.ndarray) -> np.ndarray:
        """F (e, 27, 3, 3) of elements at the displacements (N, 3): Cartesian rows, columns along the local axes."""
        F = np.einsum("enx,egni->egxi", full[self.mesh.elements[part]], self.gradients[part])
        F += self.mesh.frame[part].swapaxes(-1, -2)
        return F

    def stretches(self, full: np.ndarray) -> np.ndarray:
        """Principal stretches (E, 27, 3) at the Gauss points, increasing; what is there inverted has a negative one."""
        F = self.deformation(full, np.arange(len(self.volumes)))
        principal = np.linalg.svd(F, compute_uv=False)[..., ::-1].copy()
        principal[..., 0] *= np.sign(np.linalg.det(F)) * self.mesh.orientation
        return principal

    def _passes(self) -> Iterator[tuple[Law, np.ndarray]]:
        """Elements (e,) of one ply with its law, a few at a time."""
        for ply, law in enumerate(self.laws):
            own = np.flatnonzero(self.mesh.ply == ply)
            most = CHUNK * 81 // self.dofs.shape[1]
            for start in range(0, len(own), most):
                yield law, own[start : start + most]


@dataclass(frozen=True, eq=False)
class SolidModel:
    """A loaded body with the same ``linearise`` as the shell; forces (n,): dead, on the free displacements.

    Pressure must be on the true face ("face"): there is no mid surface to weight it with; raises ValueError otherwise.
    """

    discretisation: SolidDiscretisation
    pressure: Pressure | None = None
    forces: np.ndarray | None = None

    def __post_init__(self) -> None:
        if self.pressure is not None and self.pressure.area != "face":
            raise ValueError("a solid carries pressure on its true face only: area 'face'")

    @property
    def ordered(self) -> bool:
        """False: the unknowns are numbered as the nodes are, a factorisation has to look for an order."""
        return False

    def scaled(self, factor: float) -> SolidModel:
        """The same body under ``factor`` times its loads."""
        forces = None if self.forces is None else factor * self.forces
        return replace(self, pressure=self.pressure and self.pressure.scaled(factor), forces=forces)

    def linearise(self, u: np.ndarray, memory: object = None) -> Linearisation:
        """Residual and tangent at u (n,); ``memory`` is not used."""
        body = self.discretisation
        full = body.expand(u)
        force, tangent = body.internal(full)
        outside = np.zeros(body.fixed.size)
        matrix = body.pattern.assemble(tangent)
        if self.pressure is not None:
            load, load_tangent = self._pressure_load(self.pressure, full)
            outside += load
            if load_tangent is not None:
                matrix = sparse.csc_matrix(matrix - load_tangent)
        internal = body.nodal(body.dofs, force)[body.free]
        external = outside[body.free] + (0.0 if self.forces is None else self.forces)
        return Linearisation(
            residual=internal - external,
            tangent=matrix,
            scale=float(max(norm(internal, check_finite=False), norm(external, check_finite=False))),
            remember=lambda du: None,
        )

    def residual(self, u: np.ndarray) -> np.ndarray:
        """The residual of :meth:`linearise` alone."""
        body = self.discretisation
        full = body.expand(u)
        outside = np.zeros(body.fixed.size) if self.pressure is None else self._pressure_load(self.pressure, full)[0]
        internal = body.nodal(body.dofs, body.internal_force(full)) - outside
        return internal[body.free] - (0.0 if self.forces is None else self.forces)

    def energy(self, u: np.ndarray) -> float:
        """Strain energy minus the work of the dead loads [N mm], the potential of the residual where there is one."""
        full = self.discretisation.expand(u)
        outside = 0.0 if self.pressure is None else float(self._pressure_load(self.pressure, full)[0] @ full.ravel())
        return self.discretisation.energy(full) - outside - (0.0 if self.forces is None else float(self.forces @ u))

    @property
    def conservative(self) -> bool:
        """Whether :meth:`energy` is the potential of the residual: the pressure does not follow the body."""
        return self.pressure is None or not self.pressure.follower

    def _pressure_load(self, pressure: Pressure, full: np.ndarray) -> tuple[np.ndarray, sparse.csc_matrix | None]:
        """Nodal forces (3N,) of p n dA on the inner face; with ``follower`` their derivative on the free unknowns."""
        body, mesh = self.discretisation, self.discretisation.mesh
        tangents, normal = mesh.area_vectors(mesh.x + full if pressure.follower else mesh.x, mesh.inner)
        shares = pressure.value * np.einsum("g,gn,fgx->fnx", SQUARE.weights, SQUARE.value, normal)
        dofs = _flat(mesh.inner)
        load = body.nodal(dofs, shares)
        if not pressure.follower:
            return load, None
        # d(t1 x t2) = dt1 x t2 + t1 x dt2, with dt_d = N_m,d e_y for each node m and component y
        unit = np.eye(3)
        first, second = np.cross(unit, tangents[..., 1:, :]), np.cross(tangents[..., :1, :], unit)
        turn = np.einsum("gm,fgyx->fgmxy", SQUARE.slope[..., 0], first)
        turn += np.einsum("gm,fgyx->fgmxy", SQUARE.slope[..., 1], second)
        factor = pressure.value * mesh.orientation
        blocks = factor * np.einsum("g,gn,fgmxy->fnxmy", SQUARE.weights, SQUARE.value, turn).reshape(len(dofs), 27, 27)
        rows, columns = np.repeat(dofs, 27, axis=1), np.tile(dofs, (1, 27))
        shape = (body.fixed.size, body.fixed.size)
        matrix = sparse.coo_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=shape).tocsc()
        return load, matrix[body.free][:, body.free].tocsc()


def _flat(nodes: np.ndarray) -> np.ndarray:
    """Flat displacements (k, 3j) of nodes (k, j)."""
    return (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), -1)


def _green(F: np.ndarray, i: int, j: int) -> np.ndarray:
    """E_ij (e, g) = (F^T F - 1)_ij/2."""
    return np.asarray(0.5 * (np.einsum("egx,egx->eg", F[..., i], F[..., j]) - (i == j)))


def _strain_gradient(F: np.ndarray, G: np.ndarray) -> np.ndarray:
    """dE/du (e, g, 6, 3k) of k nodes in Voigt order with engineering shears."""
    rows = []
    for i, j in VOIGT:
        row = np.einsum("egx,egn->egnx", F[..., i], G[..., j])
        rows.append(row if i == j else row + np.einsum("egx,egn->egnx", F[..., j], G[..., i]))
    return np.stack(rows, axis=2).reshape(*F.shape[:2], 6, -1)

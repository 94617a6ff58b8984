"""Nodes of a solid that follow others, x_i = sum_j T_ij x_j: faces that may meet others, and plane strain.

Under a uniform pressure a quadratic face loads its corners by 1/36 of it, the middles of its sides by 1/9 and its own
by 4/9; a contact of bilinear patches passes 1/4 to each corner. A face that may meet others is therefore bilinear: its
nodes between corners follow them, and the elements behind it keep all others (transition elements), so that they are
right under a uniform pressure to the last digit. The position of a node is tied as its displacement is.
Where nothing varies along a1, as in plane strain, all nodes behind such a face follow one of their a1. Where
planes of symmetry are oblique, displacements are those along axes of each node.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse
from scipy.spatial.transform import Rotation

from formulations.section.laminate import Laminate, Ply
from formulations.section.laws import StVenantKirchhoff
from formulations.section.material import Law
from formulations.shell import Linearisation
from formulations.solid.body import SolidDiscretisation, SolidModel
from formulations.solid_mesh import SolidMesh

CORNERS = (0, 6, 8, 2)  # of a face in the order of SQUARE: (-1, -1), (1, -1), (1, 1), (-1, 1)
# of which four nodes the others are the mean: those of a side have its ends twice
BETWEEN = {1: (0, 2, 0, 2), 3: (0, 6, 0, 6), 5: (2, 8, 2, 8), 7: (6, 8, 6, 8), 4: CORNERS}


def straight_face(n: int, face: np.ndarray) -> sparse.csr_matrix:
    """T (n, n) of a face (F, 9): its nodes between corners are the means of these; all others stay their own."""
    T = sparse.eye_array(n, format="csr")
    middle = np.concatenate([face[:, at] for at in BETWEEN])
    ends = np.concatenate([face[:, list(BETWEEN[at])] for at in BETWEEN])
    follows, first = np.unique(middle, return_index=True)  # two elements share the middle of a side
    means = sparse.csr_matrix(
        (np.full(4 * len(first), 0.25), ends[first].ravel(), 4 * np.arange(len(first) + 1)), shape=(len(first), n)
    )
    own = sparse.diags_array(np.where(np.isin(np.arange(n), follows), 0.0, 1.0))
    return sparse.csr_matrix(own + T[:, follows] @ means)


def uniform_along(mesh: SolidMesh, apart: np.ndarray) -> sparse.csr_matrix:
    """T (N, N): all nodes of one (a2, a3) follow one of them, but for those (k,) that are ``apart``."""
    leads = np.arange(len(mesh.x))
    at = np.round(mesh.parameter[:, 1:], 9)
    _, first, column = np.unique(at, axis=0, return_index=True, return_inverse=True)
    leads = first[column.ravel()]
    leads[apart] = apart
    return sparse.csr_matrix(sparse.eye_array(len(leads), format="csr")[leads])


def about_z(angle: np.ndarray) -> sparse.csr_matrix:
    """(3N, 3N): Cartesian displacements of nodes from those along axes of their own, turned about z by angle (N,)."""
    turn = Rotation.from_rotvec(np.outer(angle, [0.0, 0.0, 1.0])).as_matrix()
    blocks = sparse.bsr_matrix((turn, np.arange(len(turn)), np.arange(len(turn) + 1)))
    rotation = sparse.csr_matrix(blocks)
    rotation.eliminate_zeros()
    return rotation


@dataclass(frozen=True, eq=False)
class TiedSolid:
    """A loaded solid, one ``face`` (F, 9) of which may meet others, by its unknowns that follow no others.

    back (B, 9): a face on the other side that may meet others, too.

    operator P (n of the solid, n): r = P^T r_solid, K = P^T K_solid P, for all displacements of the solid are P u.
    section: in plane strain, what has the same r and K for less; its own displacements are others of u.
    """

    solid: SolidModel
    laminate: Laminate
    face: np.ndarray
    operator: sparse.csr_matrix
    back: np.ndarray
    section: tuple[SolidModel, sparse.csr_matrix] | None = None

    @classmethod
    def build(
        cls,
        mesh: SolidMesh,
        laminate: Laminate,
        fixed: np.ndarray,
        face: np.ndarray,
        *,
        uniform: bool = False,
        plane: bool = False,
        turned: np.ndarray | None = None,
        back: np.ndarray | None = None,
        law: Callable[[Ply], Law] = StVenantKirchhoff.of,
    ) -> TiedSolid:
        """Of a mesh with its supports (N, 3) bool; a node that follows others must be held where all of them are.

        face (F, 9): what may meet others, of one of its faces, or quadrilaterals of others as well, turned alike.
        back (B, 9): and of the one on the other side.
        uniform: whether nothing varies along a1 behind the face, nor at it where it is ``plane``: whoever meets such a
        face has one candidate for all nodes of one (a2, a3).  turned (N,): angles [rad] about z of the axes along which
        displacements are unknown and ``fixed``.
        Raises ValueError where an element is so bent that it is inside out with a straight face.
        """
        back = face[:0] if back is None else back
        straight = straight_face(len(mesh.x), np.concatenate([face, back]))
        mesh = replace(mesh, x=straight @ mesh.x)
        if np.any(mesh.orientation * mesh.jacobian_determinants() <= 0):
            raise ValueError("elements are inside out behind a face that is straight: the mesh is too coarse along it")
        apart = np.zeros(0, np.intp) if plane else np.unique(face)
        T = straight @ uniform_along(mesh, apart) if uniform or plane else straight
        whole = sparse.csr_matrix(sparse.kron(T, sparse.eye_array(3), format="csr"))
        at_rest = fixed
        if turned is not None:
            whole = sparse.csr_matrix(whole @ about_z(turned))
            at_rest = fixed & ((turned == 0.0)[:, None] | np.array([False, False, True]))
        body = SolidDiscretisation.build(mesh, laminate, at_rest, law)
        leading = np.zeros(fixed.size, bool)
        leading[np.unique(whole.indices)] = True
        chosen = np.flatnonzero(~fixed.ravel() & leading)
        P, section = sparse.csr_matrix(whole[body.free][:, chosen]), None
        if plane:
            cut = body.section()
            section = SolidModel(cut), sparse.csr_matrix(whole[cut.free][:, chosen])
        return cls(SolidModel(body), laminate, face, P, back, section)

    @property
    def _acting(self) -> tuple[SolidModel, sparse.csr_matrix]:
        """Whose residual and tangent are worked out, and its displacements from the unknowns."""
        return self.section or (self.solid, self.operator)

    @property
    def n_free(self) -> int:
        """Number of unknowns."""
        return int(self.operator.shape[1])

    @property
    def conservative(self) -> bool:
        """As the solid is."""
        return self.solid.conservative

    def linearise(self, u: np.ndarray, memory: object = None) -> Linearisation:
        """Residual and tangent at u (n,)."""
        solid, P = self._acting
        lin = solid.linearise(P @ u, memory)
        return replace(lin, residual=P.T @ lin.residual, tangent=sparse.csc_matrix(P.T @ lin.tangent @ P))

    def residual(self, u: np.ndarray) -> np.ndarray:
        """That of :meth:`linearise` alone."""
        solid, P = self._acting
        return np.asarray(P.T @ solid.residual(P @ u))

    def energy(self, u: np.ndarray) -> float:
        """That of the solid."""
        solid, P = self._acting
        return solid.energy(P @ u)

    def expand(self, u: np.ndarray) -> np.ndarray:
        """Displacements (N, 3) of all nodes."""
        return self.solid.discretisation.expand(self.operator @ u)

    def between(self, values: np.ndarray) -> np.ndarray:
        """Values (N,) at corners of the face, interpolated to its other nodes."""
        return np.asarray(straight_face(len(values), np.concatenate([self.face, self.back])) @ values)

    @property
    def patches(self) -> np.ndarray:
        """Corners (F, 4) of the face in the order of a bilinear patch, a_1 x a_2 out of the body."""
        return self._outwards(self.face)

    @property
    def behind(self) -> np.ndarray:
        """Those (B, 4) of the face on the other side."""
        return self._outwards(self.back)

    def _outwards(self, face: np.ndarray) -> np.ndarray:
        mesh, corners = self.solid.discretisation.mesh, face[:, list(CORNERS)]
        outwards = (mesh.orientation > 0) == bool(np.isin(face[0], mesh.outer).all())
        return corners if outwards else corners[:, ::-1]

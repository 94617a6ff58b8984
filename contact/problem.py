"""The contact problem and its answer; no algorithm and no mechanics may enter here.

Find u (n,) and pressures p (m,) with::

    r(u) = G(u)^T W p,    g(u) >= 0,    p >= 0,    p g = 0,        G = dg/du

r is internal minus external force [N], g the gap [mm] at the candidate nodes, W = diag(weights) (``lumped``) or a
consistent matrix [mm^2]. With a finite epsilon [MPa/mm] the law p = epsilon <-g> replaces the last three.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np
from scipy import sparse

if TYPE_CHECKING:  # loaded with candidates, with friction, and with an algorithm
    from contact.coulomb import Coulomb, Friction
    from contact.parameters import Parameter
    from contact.swept import Passable, Surface


class Linearised(Protocol):
    """What a mechanical model returns at u; :class:`Linearisation`, or a model's own record with these fields."""

    @property
    def residual(self) -> np.ndarray:
        """Internal minus external force r (n,)."""

    @property
    def tangent(self) -> sparse.csc_matrix:
        """dr/du (n, n)."""

    @property
    def scale(self) -> float:
        """Size of the forces in balance [N]; relative residuals are measured by it."""

    @property
    def remember(self) -> Callable[[np.ndarray], object]:
        """Memory to pass on after a step du; opaque to every algorithm."""


class Faces(Protocol):
    """Two faces that press each other, or several pairs of them, as the judge looks at them."""

    @property
    def parts(self) -> tuple[tuple[Faces, slice], ...]:
        """Each pair by itself and which candidates are its own."""

    def positions(self, u: np.ndarray) -> np.ndarray:
        """All points (k, 3) of both [mm]."""

    def forces(self, u: np.ndarray, nodal: np.ndarray) -> np.ndarray:
        """Forces (k, 3) [N] on all of them by those of the candidates (m,)."""

    def measured(self, u: np.ndarray) -> np.ndarray:
        """Gaps (m,) [mm] from distances that are measured anew."""

    @property
    def mirrors(self) -> np.ndarray:
        """Unit normals (r, 3) of planes of symmetry that gaps know of: about what they leave, moments balance."""


Linearise = Callable[[np.ndarray, object], Linearised]  # (u, memory)


def _nothing(du: np.ndarray) -> object:
    return None


@dataclass(frozen=True, eq=False)
class Linearisation:
    """r (n,), dr/du (n, n), force scale [N] and the maker of a memory: :class:`Linearised` as a record."""

    residual: np.ndarray
    tangent: sparse.csc_matrix
    scale: float
    remember: Callable[[np.ndarray], object] = _nothing


def linear_mechanics(K: sparse.csc_matrix, f: np.ndarray, scale: float | None = None) -> Linearise:
    """The model r = K u - f; its scale is the larger of |K u| and |f| unless another is given."""

    def linearise(u: np.ndarray, memory: object) -> Linearisation:
        internal = K @ u
        size = max(float(np.linalg.norm(internal)), float(np.linalg.norm(f))) if scale is None else scale
        return Linearisation(internal - f, K, size)

    return linearise


class Overlooked(Protocol):
    """What the elements of a body leave out of its tangent, so that they have motions that are none of the body."""

    @property
    def stiffness(self) -> tuple[sparse.csc_matrix, sparse.csc_matrix]:
        """(n, n) of it, for motions along the first and the second coordinate: symmetric, no eigenvalue negative."""

    @property
    def order(self) -> np.ndarray | None:
        """Unknowns (n,) in an order of elimination of the tangent with that stiffness; None: as they are."""

    def alternating(self, modes: np.ndarray) -> int:
        """How many of the motions that the modes (n, k) span alternate from element to element, as they do."""

    @property
    def cuts(self) -> tuple[int, int]:
        """In how many parts elements must be cut along both coordinates for the stress not to drive them."""

    @property
    def aspect(self) -> float:
        """The largest length of an element that is driven over the one across; 0 where none is."""


@dataclass(frozen=True, eq=False)
class ContactProblem:
    """One contact problem at fixed loads; all callables are pure.

    linearise(u, memory) -> Linearised;  gap(u) -> (m,);  gap_jacobian(u) -> (m, n) CSR;  weights (m,) [mm^2];
    coupling: consistent W (m, m), or None for diag(weights);  gap_curvature(u, f) -> (n, n) CSC, the sum over the
    nodes of f_i d2g_i/du2 for nodal contact forces f, or None when the gap is linear in u.

    The rest only lets the judge see more, where there is such a thing: energy(u) -> [N mm], the potential of r, that is
    r = d energy/du;  directions(u) -> (m, 3), unit vectors in which the foundation pushes the candidates;  others(u) ->
    (3,) [N], the resultant of all loads and supports on the body, of everything but the foundation;  residual(u) ->
    r (n,) alone, where that costs less than a linearisation.

    only(chosen): the same problem with the ``chosen`` candidates (m,) bool alone, where the others then carry no
    pressure; None where they cannot be told apart.  gap_size: size [mm] of what a gap is a difference of, the position
    of the foundation included, wherever u is: the gap has the rounding of it; 0 where it has that of g and G u alone.

    element_modes(u) -> what elements leave out of the tangent at u, for what they do by themselves to be told apart.

    volume_ratios(u) -> (E,), volumes of the elements at u over those at rest; None where no strain is finite.

    ordered: the unknowns are numbered so that elimination in their order fills in little; factorisations keep it.

    driven: how many unknowns, the last ones, move the foundation: gaps depend on them, its forces leave them out.
    travel: on a path on which only the foundation moves, the problem in (u, t) with its parameter t for such an
    unknown, whose row is empty; the parameter is counted as on the path.

    multipliers: how many unknowns, the last ones, are multipliers of conditions on the others: as many eigenvalues of a
    tangent are negative that belong to no motion, see :mod:`contact.control`.

    standing: the foundation and the candidates in a frame in which it stands still, or two faces that both move; None
    where no straight way of a candidate leads through it, as through a plane.

    guide (n,): a known state close to the solution, given for every load of a path: a step starts from the last state
    plus the change of the guide, and the balance of energy counts from it, without friction; None where that is rest.

    faces: of two bodies that both deform, or of one that meets itself: the judge measures gaps anew, and the balance of
    what each does to the other; None before a foundation.

    surface: what friction would act on, in a frame that is shifted with the foundation; None where nobody has said.
    coulomb: the law of friction, None for none.
    """

    linearise: Linearise
    gap: Callable[[np.ndarray], np.ndarray]
    gap_jacobian: Callable[[np.ndarray], sparse.csr_matrix]
    weights: np.ndarray
    coupling: sparse.csr_matrix | None = None
    gap_curvature: Callable[[np.ndarray, np.ndarray], sparse.csc_matrix] | None = None
    energy: Callable[[np.ndarray], float] | None = None
    directions: Callable[[np.ndarray], np.ndarray] | None = None
    others: Callable[[np.ndarray], np.ndarray] | None = None
    residual: Callable[[np.ndarray], np.ndarray] | None = None
    only: Callable[[np.ndarray], ContactProblem] | None = None
    gap_size: float = 0.0
    element_modes: Callable[[np.ndarray], Overlooked] | None = None
    volume_ratios: Callable[[np.ndarray], np.ndarray] | None = None
    ordered: bool = False
    driven: int = 0
    multipliers: int = 0
    travel: Callable[[], ContactProblem] | None = None
    standing: Passable | None = None
    guide: np.ndarray | None = None
    faces: Faces | None = None
    surface: Surface | None = None
    coulomb: Coulomb | None = None

    @property
    def weight_matrix(self) -> sparse.csc_array | sparse.csr_matrix:
        """W (m, m) [mm^2]."""
        return sparse.diags_array(self.weights, format="csc") if self.coupling is None else self.coupling

    def nodal_forces(self, pressure: np.ndarray) -> np.ndarray:
        """Normal forces f = W p (m,) [N] of the foundation on the candidate nodes."""
        return self.weights * pressure if self.coupling is None else self.coupling @ pressure

    def push(self, u: np.ndarray) -> sparse.csr_matrix:
        """The rows (m, n) of G by which contact forces act: no force on what moves the foundation."""
        return sparse.csr_matrix(self.gap_jacobian(u) @ self._body(len(u))) if self.driven else self.gap_jacobian(u)

    def stiffness(self, lin: Linearised, u: np.ndarray, pressure: np.ndarray) -> sparse.csc_matrix:
        """K (n, n): the tangent less what the curvature of the gap takes off it under the pressures (m,)."""
        if self.gap_curvature is None:
            return lin.tangent
        turned = self.gap_curvature(u, self.nodal_forces(pressure))
        return sparse.csc_matrix(lin.tangent - (self._body(len(u)) @ turned if self.driven else turned))

    def contact_force(self, u: np.ndarray, pressure: np.ndarray, friction: np.ndarray | None = None) -> np.ndarray:
        """G^T W p + S^T t (n,): the force of the foundation on the unknowns; friction (m, 2) [N], where there is."""
        pushed = np.asarray(self.push(u).T @ self.nodal_forces(pressure))
        if friction is None or self.coulomb is None:
            return pushed
        return np.asarray(pushed + self.coulomb.slip_jacobian(u).T @ friction.ravel())

    def since(self, anchors: np.ndarray) -> ContactProblem:
        """The problem with friction whose slips are counted from these anchors (m, 3)."""
        assert self.coulomb is not None
        return replace(self, coulomb=self.coulomb.since(anchors))

    def watched(self, look: Callable[[], None]) -> ContactProblem:
        """The problem, which calls ``look`` before every linearisation: what that raises ends the solve."""
        only, travel = self.only, self.travel

        def linearise(u: np.ndarray, memory: object) -> Linearised:
            look()
            return self.linearise(u, memory)

        return replace(
            self,
            linearise=linearise,
            only=None if only is None else lambda chosen: only(chosen).watched(look),
            travel=None if travel is None else lambda: travel().watched(look),
        )

    @property
    def unfit_for_friction(self) -> str | None:
        """Why the friction that a problem has has no place in it, or None."""
        if self.coulomb is None:
            return None
        if self.coulomb.mu.shape != self.weights.shape:
            return f"mu must be {len(self.weights)} numbers in [0, inf]"
        if self.coupling is not None:
            return "friction needs lumped coupling: each normal force a candidate's own"
        return "friction needs a foundation whose travel is given" if self.driven else None

    def _body(self, n: int) -> sparse.dia_array:
        """Projector (n, n) onto the unknowns of the body."""
        return sparse.diags_array((np.arange(n) < n - self.driven).astype(float))


def without_contact(linearise: Linearise, n: int, *, ordered: bool = False) -> ContactProblem:
    """A problem of n unknowns with no candidate: plain equilibrium r(u) = 0."""
    empty = sparse.csr_matrix((0, n))
    nowhere = np.zeros((0, 3))
    return ContactProblem(
        linearise, lambda u: np.zeros(0), lambda u: empty, np.zeros(0), directions=lambda u: nowhere, ordered=ordered
    )


class Outcome(enum.Enum):
    """How a solve ended; the value is the sentence a user reads."""

    CONVERGED = "converged"
    ITERATION_LIMIT = "the iteration limit was reached before equilibrium"
    DIVERGED = "the residual is no longer finite or has grown without bound"
    SINGULAR = "the linear system is singular to working precision"
    ROUNDING = "rounding alone keeps the forces further out of balance than can be excused"
    CYCLING = "the contact set repeats itself and the fallback did not settle it"
    ALTERNATING = "Newton's iterates alternate between two points, as where a gap has a kink between them"
    UNSOLVED = "the linearised contact problem was not solved"
    REFUSED = "the algorithm does not apply"
    LIMIT_POINT = "the path turns back before the requested load"
    STEP_LIMIT = "the load step was cut to its smallest size and still failed"
    GIVEN_UP = "failed attempts have cost as much as twenty good steps"
    INTERRUPTED = "interrupted by the user"
    WRONG = "the judge refuses a state that was claimed to be converged"

    @property
    def converged(self) -> bool:
        """True for CONVERGED only."""
        return self is Outcome.CONVERGED

    @property
    def word(self) -> str:
        """As it stands in records and tables."""
        return self.name.lower().replace("_", "-")


@dataclass(frozen=True, eq=False)
class ContactSolution:
    """u (n,), pressure (m,) [MPa], contact set (m,) bool, outcome, counters, and one history row an iteration.

    friction: None where there is none, or where the path has not come to it yet.
    """

    u: np.ndarray
    pressure: np.ndarray
    active: np.ndarray
    outcome: Outcome
    counters: Mapping[str, float] = field(default_factory=dict)
    history: tuple[Mapping[str, Any], ...] = ()
    friction: Friction | None = None

    @property
    def rubbed(self) -> Friction:
        """The friction of a problem that has some."""
        assert self.friction is not None
        return self.friction

    @classmethod
    def at_rest(cls, n: int, m: int) -> ContactSolution:
        """The unloaded state: the start of every path."""
        return cls(np.zeros(n), np.zeros(m), np.zeros(m, bool), Outcome.CONVERGED)


class ContactAlgorithm(Protocol):
    """One algorithm: a frozen record of parameters.

    name: in the catalogue.  parameters: those of its fields that a user may set.  epsilon: regularisation [MPa/mm];
    infinity enforces the constraint exactly.
    """

    name: ClassVar[str]
    parameters: ClassVar[tuple[Parameter, ...]]

    def __init__(self, **parameters: Any) -> None: ...

    @property
    def epsilon(self) -> float:
        """Of the law p = epsilon <-g>."""

    def supports(self, problem: ContactProblem) -> str | None:
        """None, or the reason why the algorithm does not apply to the problem."""

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Solve from the displacement, pressure and set of ``start``; failure is a value, not an exception."""

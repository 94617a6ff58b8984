"""The GRECO plate: an elastic square on a rigid plane, pressed from above and pushed from the left, with friction and
without.

40 x 40 mm, plane strain, small strain, E = 130,000 MPa, nu = 0.2; u_x = 0 on the right side, its lower corner fixed;
50 MPa on the top, 150 MPa on the left side. Without friction its stress is uniform and everything is known::

    sigma_x = -p_left, sigma_y = -p_top,  e_x = (1 + nu)/E ((1 - nu) sigma_x - nu sigma_y),  u_x = e_x (x - L)

so the bottom must carry p_top to the last digit on any mesh. Two other loads on the top have no closed form: one that
rises to the right keeps all of the bottom pressed, which is then a plane of symmetry; one that pulls on the left lifts
that corner off.

With mu = 1 it is open, slides and sticks in one contact, and separates families of algorithms: slips and friction here
are those of graded meshes of 9-node quadrilaterals, 64x64 and 96x96 alike. With mu = inf who touches is tied to where
it touched. From rest, who never leaves its place is tied there, and what is left is linear: nodes that touch have no
displacement, the others no force. Every set of nodes can be tried, by elimination alone. There may be one for which no
node is pulled and none penetrates, or none: existence ends at a large coefficient (Klarbring, Ing.-Archiv 60 (1990)
529-541), and the plate has such meshes.
Source: Code_Aster SSNV128; Feijoo, Barbosa, Zouain.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import product

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS, is_exact
from contact.coulomb import State
from contact.operations import SPENT
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, linear_mechanics
from studies.experiments import Row, tabulated
from studies.experiments.friction.klarbring import algorithms, in_plane
from studies.scenes.element import spaced_lines

SIDE, E, NU, TOP, LEFT = 40.0, 1.3e5, 0.2, 50.0, 150.0  # mm, MPa
ELEMENTS = {"Q1": "ElementQuad1", "Q2": "ElementQuad2"}
LOADS: dict[str, Callable[[np.ndarray], np.ndarray]] = {  # the pressure on the top over TOP at x
    "uniform": np.ones_like,
    "rising": lambda x: 0.5 + x / SIDE,
    "lifting": lambda x: 4 * x / SIDE - 1.5,
}
EXACT = tuple(filter(is_exact, ALGORITHMS))
PLACES = (0.0, 1.25, 5.0, 7.5, 11.25)  # mm
SLIPS = (2.8603e-2, 2.7226e-2, 2.2868e-2, 1.9808e-2, 1.5414e-2)  # mm, there, with mu = 1
STIFF = 1e8  # MPa/mm, of regularised: penetrations of 1e-6 mm beside slips of 1e-2 mm
TIED = (("Q1", 4), ("Q1", 6), ("Q1", 8), ("Q1", 10), ("Q2", 4), ("Q2", 5))


def slip(x: np.ndarray | float) -> np.ndarray | float:
    """u_x [mm] under the uniform load, without friction."""
    return (1 + NU) / E * (-(1 - NU) * LEFT + NU * TOP) * (x - SIDE)


class GrecoPlate:
    """The discrete square: n x n elements, lines closer towards the left and the bottom; every length is 1 mm thick.

    mirrored: with its image below the plane and without any contact, for whoever wants to know the answer.
    stiffness (n, n) [N/mm] of the free displacements ``free``, forces (N,) [N] of all; x (m,): places of the
    candidates, all nodes of the bottom but the fixed corner; across, along (m, n): their displacements off the plane
    and along it; weights (m,) [mm^2].
    """

    def __init__(self, element: str, n: int, load: str = "uniform", *, mirrored: bool = False) -> None:
        import skfem
        from skfem.models.elasticity import lame_parameters, linear_elasticity

        lines = spaced_lines(0, SIDE, n, to_start=True)
        mesh = skfem.MeshQuad.init_tensor(lines, np.concatenate([-lines[:0:-1], lines]) if mirrored else lines)
        self.basis = skfem.Basis(mesh, skfem.ElementVector(getattr(skfem, ELEMENTS[element])()))
        K = sparse.csc_matrix(linear_elasticity(*lame_parameters(E, NU)).assemble(self.basis))
        (X, Y), component = self.basis.doflocs, np.zeros(self.basis.N, int)
        component[self.basis.get_dofs(elements=True).all(["u^2"])] = 1
        bottom, right = np.isclose(Y, 0), np.isclose(X, SIDE)
        self.free = free = np.flatnonzero(~(right & ((component == 0) | bottom)))
        touching = (np.flatnonzero(bottom & ~right & (component == c)) for c in (1, 0))
        normal, tangent = (dofs[np.argsort(X[dofs])] for dofs in touching)
        self.stiffness, self.forces, self.x = K[free][:, free], self._load(LOADS[load]), X[normal]
        self.across, self.along = _selection(normal, free), _selection(tangent, free)
        on_plane = mesh.facets_satisfying(lambda x: np.isclose(x[1], 0), boundaries_only=not mirrored)
        self.weights = self._integrated(on_plane, lambda v, w: v[1])[normal]

    def _load(self, shape: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """Nodal forces (N,) of both pressures [N]; an image has its own."""
        sides: list[tuple[int, float, Callable]] = [
            (0, 0.0, lambda v, w: LEFT * v[0]),
            (1, SIDE, lambda v, w: -TOP * shape(w.x[0]) * v[1]),
            (1, -SIDE, lambda v, w: TOP * shape(w.x[0]) * v[1]),
        ]
        forces = np.zeros(self.basis.N)
        for axis, at, form in sides:
            facets = self.basis.mesh.facets_satisfying(lambda x, i=axis, at=at: np.isclose(x[i], at), True)
            forces = forces + self._integrated(facets, form, intorder=6) if len(facets) else forces
        return forces

    def _integrated(self, facets: np.ndarray, form: Callable, **options: int) -> np.ndarray:
        """A linear form (N,) on facets."""
        from skfem import FacetBasis, LinearForm

        return LinearForm(form).assemble(FacetBasis(self.basis.mesh, self.basis.elem, facets=facets, **options))

    def problem(self, mu: float | None = None) -> ContactProblem:
        """The plate on the plane; mu: of friction, if any."""
        K, f, G = self.stiffness, self.forces[self.free], self.across
        contact = ContactProblem(linear_mechanics(K, f), lambda u: G @ u, lambda u: G, self.weights)
        return contact if mu is None else in_plane(contact, self.along, mu)

    def solve(self, algorithm: ContactAlgorithm, mu: float | None = None) -> ContactSolution:
        """From rest."""
        return algorithm.solve(self.problem(mu), ContactSolution.at_rest(len(self.free), len(self.x)))


def _selection(chosen: np.ndarray, free: np.ndarray) -> sparse.csr_matrix:
    """(m, n): the chosen ones of all displacements from the free ones."""
    columns, ones = np.searchsorted(free, chosen), np.ones(len(chosen))
    return sparse.csr_matrix((ones, (np.arange(len(chosen)), columns)), shape=(len(chosen), len(free)))


@tabulated
def greco_table() -> Iterator[Row]:
    """Without friction: every load on every mesh by every exact algorithm.

    slip_mm: u_x of the lower left corner.  pressure_error: of p_top under the uniform load, relative, else NaN.  apart:
    the largest difference of u from that of the first algorithm, over the largest u.
    """
    for element, n, load in product(ELEMENTS, (8, 16, 32), LOADS):
        plate, first = GrecoPlate(element, n, load), None
        for name in EXACT:
            solution = plate.solve(ALGORITHMS[name](epsilon=math.inf))
            first = solution.u if first is None else first
            off = float(np.max(np.abs(solution.pressure / TOP - 1)))
            yield {
                **{"element": element, "elements": n, "load": load, "algorithm": name},
                **{"outcome": solution.outcome.word, "slip_mm": float((plate.along @ solution.u)[0])},
                "pressure_error": off if load == "uniform" else math.nan,
                "apart": float(np.max(np.abs(solution.u - first)) / np.max(np.abs(first))),
            }


@tabulated
def friction_table(meshes: Sequence[int] = (16, 32)) -> Iterator[Row]:
    """mu = 1: all algorithms on 9-node quadrilaterals: worst relative error of the five slips, sum of friction, cost.

    operations: in millions, by :mod:`contact.operations`.
    """
    for n in meshes:
        plate = GrecoPlate("Q2", n)
        for algorithm in algorithms(STIFF):
            before = SPENT.total()
            solution = plate.solve(algorithm, 1.0)
            spent = (SPENT.total() - before) / 1e6
            slips = np.interp(PLACES, plate.x, plate.along @ solution.u)
            row = {"elements": n, "algorithm": algorithm.name, "outcome": solution.outcome.word}
            row |= {key: solution.counters[key] for key in ("newton_iterations", "factorisations")}
            row |= {"operations": spent, "error": np.max(np.abs(slips / SLIPS - 1))}
            row |= {f"slip_{place:g}": slip for place, slip in zip(PLACES, slips, strict=True)}
            yield row | {"friction_N": float(np.sum(solution.rubbed.force[:, 0]))}


def tied(plate: GrecoPlate) -> list[tuple[np.ndarray, np.ndarray]]:
    """Every answer with mu = inf: u (n,), and who is tied (m,) bool; 2^m sets are tried on the nodes that may touch."""
    m, f = len(plate.x), plate.forces[plate.free]
    touching = np.concatenate([plate.across.indices, plate.along.indices])
    inside = np.setdiff1d(np.arange(len(f)), touching)
    K = plate.stiffness.tocsr()
    factor = splu(K[inside][:, inside].tocsc())
    beside = K[inside][:, touching].toarray()
    condensed = K[touching][:, touching].toarray() - beside.T @ factor.solve(beside)
    load = f[touching] - beside.T @ factor.solve(f[inside])
    answers = []
    for each in product((False, True), repeat=m):
        holds = np.array(each)
        free = np.flatnonzero(~np.tile(holds, 2))
        at = np.zeros(2 * m)
        at[free] = np.linalg.solve(condensed[np.ix_(free, free)], load[free])
        if np.all(np.where(holds, (condensed @ at - load)[:m], at[:m]) >= 0):
            u = np.zeros(len(f))
            u[touching], u[inside] = at, factor.solve(f[inside] - beside @ at)
            answers.append((u, holds))
    return answers


@tabulated
def tied_table(cases: Sequence[tuple[str, int]] = TIED) -> Iterator[Row]:
    """mu = inf under every load on each (element, elements), beside all answers of :func:`tied`.

    answers: how many there are.  tied: nodes of the first; otherwise: nodes that do something else; difference: of u
    from it, over its largest; NaN where there is none.  iterations: of Newton.
    """
    for (element, n), load in product(cases, LOADS):
        plate = GrecoPlate(element, n, load)
        answers, solution = tied(plate), plate.solve(Semismooth(), math.inf)
        row = {"elements": n, "element": element, "load": load, "nodes": len(plate.x), "answers": len(answers)}
        row |= {"outcome": solution.outcome.word, "iterations": solution.counters["newton_iterations"]}
        row |= {"tied": math.nan, "otherwise": math.nan, "difference": math.nan}
        if answers:
            u, holds = answers[0]
            row |= {"tied": int(holds.sum()), "otherwise": int(np.sum((solution.rubbed.state == State.STICK) != holds))}
            row |= {"difference": float(np.max(np.abs(solution.u - u)) / np.max(np.abs(u)))}
        yield row

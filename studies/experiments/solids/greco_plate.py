"""The GRECO plate without friction: an elastic square on a rigid plane, pressed from above and pushed from the left.

40 x 40 mm, plane strain, small strain, E = 130,000 MPa, nu = 0.2; u_x = 0 on the right side, its lower corner fixed;
50 MPa on the top, 150 MPa on the left side. With friction it separates four families of algorithms (Code_Aster SSNV128;
Feijoo, Barbosa, Zouain); without, its stress is uniform and everything is known::

    sigma_x = -p_left, sigma_y = -p_top,  e_x = (1 + nu)/E ((1 - nu) sigma_x - nu sigma_y),  u_x = e_x (x - L)

so the bottom must carry p_top to the last digit on any mesh. Two other loads on the top have no closed form: one that
rises to the right keeps all of the bottom pressed, which is then a plane of symmetry; one that pulls on the left lifts
that corner off. Friction will need the slips, :attr:`GrecoPlate.along`; nothing here has any.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem, ContactSolution, linear_mechanics
from studies.scenes.element import spaced_lines

if TYPE_CHECKING:
    from skfem import Basis

SIDE, E, NU, TOP, LEFT = 40.0, 1.3e5, 0.2, 50.0, 150.0  # mm, MPa
ELEMENTS = {"Q1": "ElementQuad1", "Q2": "ElementQuad2"}
LOADS: dict[str, Callable[[np.ndarray], np.ndarray]] = {  # the pressure on the top over TOP at x
    "uniform": np.ones_like,
    "rising": lambda x: 0.5 + x / SIDE,
    "lifting": lambda x: 4 * x / SIDE - 1.5,
}
EXACT = tuple(name for name in ALGORITHMS if name != "regularised")


def slip(x: np.ndarray | float) -> np.ndarray | float:
    """u_x [mm] under the uniform load, without friction."""
    return (1 + NU) / E * (-(1 - NU) * LEFT + NU * TOP) * (x - SIDE)


@dataclass(frozen=True, eq=False)
class GrecoPlate:
    """The discrete square: n x n elements, lines closer towards the left and the bottom; every length is 1 mm thick.

    mirrored: with its image below the plane and without any contact, for whoever wants to know the answer.
    K (n, n) [N/mm], f (n,) [N] of the free displacements; x (m,): places of the candidates, all nodes of the bottom but
    the fixed corner; across, along (m, n): their displacements off the plane and along it; weights (m,) [mm^2].
    """

    element: str
    n: int
    load: str = "uniform"
    mirrored: bool = False
    basis: Basis = field(init=False, repr=False)
    free: np.ndarray = field(init=False, repr=False)
    stiffness: sparse.csc_matrix = field(init=False, repr=False)
    forces: np.ndarray = field(init=False, repr=False)
    x: np.ndarray = field(init=False, repr=False)
    across: sparse.csr_matrix = field(init=False, repr=False)
    along: sparse.csr_matrix = field(init=False, repr=False)
    weights: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        import skfem
        from skfem.models.elasticity import lame_parameters, linear_elasticity

        lines = spaced_lines(0, SIDE, self.n, to_start=True)
        both = np.concatenate([-lines[:0:-1], lines]) if self.mirrored else lines
        mesh = skfem.MeshQuad.init_tensor(lines, both)
        scalar = getattr(skfem, ELEMENTS[self.element])()
        basis = skfem.Basis(mesh, skfem.ElementVector(scalar))
        K = sparse.csc_matrix(linear_elasticity(*lame_parameters(E, NU)).assemble(basis))
        (X, Y), component = basis.doflocs, np.zeros(basis.N, int)
        component[basis.get_dofs(elements=True).all(["u^2"])] = 1
        bottom = np.isclose(Y, 0)
        held = np.isclose(X, SIDE) & ((component == 0) | bottom)
        free = np.flatnonzero(~held)
        normal, tangent = (free[(bottom & (component == c))[free] & ~np.isclose(X[free], SIDE)] for c in (1, 0))
        normal, tangent = normal[np.argsort(X[normal])], tangent[np.argsort(X[tangent])]
        known = {
            **{"basis": basis, "free": free, "stiffness": K[free][:, free], "forces": self._load(basis)},
            **{"x": X[normal], "across": _selection(normal, free), "along": _selection(tangent, free)},
            "weights": self._edge(basis, np.isclose(Y, 0) & (component == 1))[normal],
        }
        for name, value in known.items():
            object.__setattr__(self, name, value)

    @property
    def problem(self) -> ContactProblem:
        """The plate on the plane."""
        K, f, G = self.stiffness, self.forces[self.free], self.across
        return ContactProblem(linear_mechanics(K, f), lambda u: G @ u, lambda u: G, self.weights)

    def solve(self, algorithm: str) -> ContactSolution:
        """From rest, the constraint exact."""
        problem = self.problem
        rest = ContactSolution.at_rest(len(self.free), len(self.x))
        return ALGORITHMS[algorithm](epsilon=math.inf).solve(problem, rest)

    def _load(self, basis: Basis) -> np.ndarray:
        """Nodal forces (N,) of both pressures [N]; an image has its own."""
        from skfem import FacetBasis, LinearForm

        shape = LOADS[self.load]

        def on(side: Callable[[np.ndarray], np.ndarray], form: Callable) -> np.ndarray:
            facets = basis.mesh.facets_satisfying(side, boundaries_only=True)
            return LinearForm(form).assemble(FacetBasis(basis.mesh, basis.elem, facets=facets, intorder=6))

        forces = on(lambda x: np.isclose(x[0], 0), lambda v, w: LEFT * v[0])
        forces = forces + on(lambda x: np.isclose(x[1], SIDE), lambda v, w: -TOP * shape(w.x[0]) * v[1])
        if self.mirrored:
            forces = forces + on(lambda x: np.isclose(x[1], -SIDE), lambda v, w: TOP * shape(w.x[0]) * v[1])
        return forces

    def _edge(self, basis: Basis, chosen: np.ndarray) -> np.ndarray:
        """(N,) int N_r dx along y = 0 of the chosen functions."""
        from skfem import FacetBasis, LinearForm

        facets = basis.mesh.facets_satisfying(lambda x: np.isclose(x[1], 0), boundaries_only=not self.mirrored)
        whole = LinearForm(lambda v, w: v[1]).assemble(FacetBasis(basis.mesh, basis.elem, facets=facets))
        return np.where(chosen, whole, 0.0)


def greco_table(
    elements: Sequence[str] = tuple(ELEMENTS), meshes: Sequence[int] = (8, 16, 32), algorithms: Sequence[str] = EXACT
) -> pd.DataFrame:
    """Every load on every mesh by every exact algorithm.

    slip_mm: u_x of the lower left corner; force_N: of the plane on all but the fixed corner, per mm; lift_mm: the
    largest gap; edge_mm: x of the first pressed node.  pressure_error: of p_top under the uniform load, relative, else
    NaN.  apart: the largest difference of u from that of the first algorithm, over the largest u.
    """
    rows = []
    for element, n, load in product(elements, meshes, LOADS):
        plate, first = GrecoPlate(element, n, load), None
        for name in algorithms:
            found = plate.solve(name)
            first = found.u if first is None else first
            off = float(np.max(np.abs(found.pressure / TOP - 1)))
            rows.append(
                {
                    **{"element": element, "elements": n, "load": load, "algorithm": name},
                    **{"outcome": found.outcome.word, "iterations": found.counters["newton_iterations"]},
                    "slip_mm": float((plate.along @ found.u)[0]),
                    "force_N": float(plate.weights @ found.pressure),
                    "lift_mm": float((plate.across @ found.u).max()),
                    "edge_mm": float(plate.x[found.active].min()),
                    "pressure_error": off if load == "uniform" else math.nan,
                    "apart": float(np.max(np.abs(found.u - first)) / np.max(np.abs(first))),
                }
            )
    return pd.DataFrame(rows)


def _selection(chosen: np.ndarray, free: np.ndarray) -> sparse.csr_matrix:
    """(m, n): the chosen ones of all displacements from the free ones."""
    columns, ones = np.searchsorted(free, chosen), np.ones(len(chosen))
    return sparse.csr_matrix((ones, (np.arange(len(chosen)), columns)), shape=(len(chosen), len(free)))

"""A membrane over a sphere, whose contact radius is known: orders of the error with every exact algorithm.

Linear triangles (P1), bilinear (Q1) and biquadratic quadrilaterals (Q2) of scikit-fem on a quarter of the disc;
the obstacle is kept at the nodes. Boundary values are the exact ones, so that the polygon costs nothing. The solution
has a jump in its second derivative on the rim of contact: it lies in H^s for s < 5/2 only.
Theory: order 1 in the energy and 2 in the mean square for P1 and Q1 (Falk, Math. Comp. 28 (1974) 963), 3/2 in the
energy for quadratics (Brezzi, Hager, Raviart, Numer. Math. 28 (1977) 431).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from scipy import sparse

from contact.catalogue import ALGORITHMS, is_exact
from contact.problem import ContactSolution
from studies.experiments.obstacles import Bounded
from studies.scenes.closed_forms.contact import SphereObstacle

if TYPE_CHECKING:
    from skfem import Basis, MeshQuad

ELEMENTS = {"P1": "ElementTriP1", "Q1": "ElementQuad1", "Q2": "ElementQuad2"}
MESHES = {"P1": (2, 3, 4, 5), "Q1": (2, 3, 4, 5), "Q2": (1, 2, 3, 4)}  # refinements of three quadrilaterals
EXACT = tuple(filter(is_exact, ALGORITHMS))
LARGEST = {"lcp": 1000}  # unknowns; from there on its pivots, one at a time, take a hundred times as long as all others
ERRORS = ("l2", "h1", "force", "radius")
INTEGRATION = 8  # degree; what is integrated is smooth but for the elements on the rim


def quarter_disc(level: int) -> MeshQuad:
    """Three quadrilaterals over x, y >= 0, refined; the nodes of the edge lie on the circle."""
    from skfem import MeshQuad  # slow to load

    d, c = 0.4, math.sqrt(0.5)
    x = np.array([[0, 0.5, d, 0, 1, c, 0], [0, 0, d, 0.5, 0, c, 1]])
    mesh = MeshQuad(x, np.array([[0, 1, 2, 3], [1, 4, 5, 2], [2, 5, 6, 3]]).T)
    for _ in range(level):
        mesh = mesh.refined(1)
        points, edge = mesh.p.copy(), np.unique(mesh.facets[:, _on_circle(mesh)])
        points[:, edge] /= np.linalg.norm(points[:, edge], axis=0)
        mesh = MeshQuad(points, mesh.t)
    return mesh


def _on_circle(mesh: Any) -> np.ndarray:
    """Facets of the edge of the disc: on the boundary, and on neither axis."""
    facets = mesh.boundary_facets()
    middle = mesh.p[:, mesh.facets[:, facets]].mean(axis=1)
    return facets[middle.min(axis=0) > 1e-12]


@dataclass(frozen=True, eq=False)
class Membrane:
    """The discrete problem: basis of scikit-fem, interior dofs, radii (n,) of all dofs, the body of the interior."""

    exact: SphereObstacle
    basis: Basis
    interior: np.ndarray
    radii: np.ndarray
    body: Bounded

    @classmethod
    def build(cls, element: str, level: int, exact: SphereObstacle) -> Membrane:
        """The stiffness of the Laplacian on the quarter, symmetric about both axes."""
        import skfem
        from skfem.models.poisson import laplace

        mesh = quarter_disc(level) if element.startswith("Q") else quarter_disc(level).to_meshtri()
        basis = skfem.Basis(mesh, getattr(skfem, ELEMENTS[element])(), intorder=INTEGRATION)
        K = sparse.csc_matrix(laplace.assemble(basis))
        edge = basis.get_dofs(_on_circle(mesh)).all()
        interior, radii = np.setdiff1d(np.arange(basis.N), edge), np.linalg.norm(basis.doflocs, axis=0)
        f = -K[interior][:, edge] @ exact.deflection(radii[edge])
        low = exact.height(radii[interior])
        start = np.maximum(low, 0.0)
        body = Bounded(
            f"membrane {element} {level}", K[interior][:, interior], f, low, np.full(len(low), np.inf), start
        )
        return cls(exact, basis, interior, radii, body)

    def errors(self, solution: ContactSolution) -> dict[str, float]:
        """L2 and H1 errors of u; relative ones of the resultant and of the radius of the disc of the same contact area.

        radius_by_force: the contact radius that belongs to the resultant, for the eye.
        """
        from skfem import BilinearForm, Functional

        u = self.exact.deflection(self.radii)
        u[self.interior] = solution.u
        field = self.basis.interpolate(u)
        r = np.linalg.norm(self.basis.global_coordinates(), axis=0)
        along = self.exact.slope(r) * self.basis.global_coordinates() / np.maximum(r, 1e-300)
        value = Functional(lambda w: (w.u - self.exact.deflection(r)) ** 2).assemble(self.basis, u=field)
        slope = Functional(lambda w: np.sum((w.u.grad - along) ** 2, axis=0)).assemble(self.basis, u=field)
        shares = BilinearForm(lambda v, w, _: v * w).assemble(self.basis).sum(axis=1)
        force = 4 * float(solution.pressure.sum())
        area = 4 * float(np.asarray(shares).ravel()[self.interior][solution.active].sum())
        return {
            "l2": math.sqrt(value),
            "h1": math.sqrt(slope),
            "force": abs(force / self.exact.force - 1),
            "radius": abs(math.sqrt(area / math.pi) / self.exact.contact_radius - 1),
            "radius_by_force": self.exact.radius_under(force),
        }


def membrane_table(meshes: Mapping[str, Sequence[int]] = MESHES, algorithms: Sequence[str] = EXACT) -> pd.DataFrame:
    """Errors over the meshes for every exact algorithm, and the orders fitted to all meshes of an element.

    meshes: refinements by element.  unknowns, contact_nodes, iterations; apart: the largest difference of u from that
    of the first algorithm, over the largest u.  l2, h1, force, radius: see :meth:`Membrane.errors`; the orders: least
    squares of the logarithms. Single halvings would give orders that jump, as the rim passes between the nodes.
    """
    exact, rows = SphereObstacle(), []
    for element, levels in meshes.items():
        for level in levels:
            membrane, first = Membrane.build(element, level, exact), None
            for name in algorithms:
                if len(membrane.interior) > LARGEST.get(name, math.inf):
                    continue
                solution = ALGORITHMS[name](epsilon=math.inf).solve(membrane.body.problem(), membrane.body.begin())
                first = solution.u if first is None else first
                row = {
                    **{"element": element, "level": level, "algorithm": name, "unknowns": len(membrane.interior)},
                    **{"outcome": solution.outcome.word, "contact_nodes": int(solution.active.sum())},
                    "iterations": solution.counters["newton_iterations"],
                    "apart": float(np.max(np.abs(solution.u - first)) / np.max(np.abs(first))),
                }
                rows.append(row | membrane.errors(solution))
    table = pd.DataFrame(rows)
    families = table.groupby(["element", "algorithm"], sort=False)
    return table.assign(**{f"order_{key}": families[key].transform(_order) for key in ERRORS})


def _order(errors: pd.Series) -> float:
    """Of errors on meshes that halve; NaN for one mesh."""
    return -float(np.polyfit(range(len(errors)), np.log2(errors), 1)[0]) if len(errors) > 1 else math.nan

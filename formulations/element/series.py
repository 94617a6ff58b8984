"""The element along a path that is a power series: what the orders before k put into the equilibrium of order k.

With v = sum v_k a^k, the strains of a quadratic measure on the modes are E_k = B_0 v_k + E'_k, the resultants
H_k = D E_k, and the internal force is sum f_k a^k with f_k = K_T v_k + r_k::

    E'_k = P 1/2 sum_{i=1}^{k-1} q_i Q q_{k-i}
    r_k = B_0^T W D E'_k + Q_op^T sum_{i=1}^{k-1} (Q q_i)^T P^T W H_{k-i}

P samples and projects (Gauss points, nodes for E33, relaxation), W are the weights of the modes. The modes are strains
of the displacements and nothing is condensed that depends on the state: with all f_k balanced the path is that of the
discrete equilibrium itself. Source: Cochelin, Potier-Ferry, Int. J. Numer. Meth. Engng 37 (1994) 1187-1203. No support,
no load and no equation to solve may enter here.
"""

import numpy as np

from formulations.element.mixed import MODE_WEIGHTS, N_M, MixedElement
from formulations.element.strain_operator import N_DOF, N_GAUSS, ElementGeometry
from formulations.operations import product, spend
from formulations.strains.measure import QuadraticMeasure
from formulations.strains.products import Products
from formulations.strains.quantities import N_E, N_Q, N_V


class ElementSeries:
    """The recurrence at nodal displacements v_0 (E, 24); :meth:`add` is given v_1, v_2, ... in turn.

    order: the largest k.  Raises ValueError for a measure that is not quadratic.
    """

    def __init__(self, element: MixedElement, geometry: ElementGeometry, v: np.ndarray, order: int) -> None:
        if not isinstance(element.measure, QuadraticMeasure) or not isinstance(element.through, QuadraticMeasure):
            raise ValueError(f"measure {element.measure.name} is not quadratic")
        self._element, self._geometry = element, geometry
        points = N_GAUSS * len(v)
        self._products = Products(element.measure, order, points)
        self._through = None if element.nodal is None else Products(element.through, order, points)
        self._weight = MODE_WEIGHTS * geometry.weight[:, None]
        self._B = element.mode_gradient(geometry, v)
        self._higher = np.zeros((len(v), N_M))
        self._k = 0

    def add(self, v: np.ndarray) -> np.ndarray:
        """r_{k+1} (E, 24) once v_k (E, 24) is known."""
        element, geometry = self._element, self._geometry
        self._k += 1
        k, n = self._k, len(v)
        spend(n * (2 * product(N_M, N_DOF) + 2 * product(N_GAUSS * N_Q, N_DOF) + 8 * N_GAUSS * N_Q * k))
        q = np.matmul(geometry.Q, v[..., None])[..., 0]
        self._products.q[k] = q.reshape(-1, N_Q).T
        strains = np.matmul(self._B, v[..., None])[..., 0] + self._higher
        at_gauss, at_nodes = element.sampled_work(geometry, self._weight * element.resultants(strains))
        self._products.H[k] = at_gauss.reshape(-1, N_E).T
        samples = self._products.strain(k + 1).T.reshape(-1, N_GAUSS, N_E)
        nodal = None
        if self._through is not None and at_nodes is not None:
            self._through.q[k] = (v.reshape(-1, N_V) @ geometry.director.T).T
            self._through.H[k] = at_nodes.reshape(1, -1)
            nodal = self._through.strain(k + 1).reshape(-1, 4)
        self._higher = element.on_modes(geometry, samples, nodal)
        force = np.matmul((self._weight * element.resultants(self._higher))[:, None], self._B)[:, 0]
        along = self._products.force(k + 1).T.reshape(-1, 1, N_GAUSS * N_Q)
        force += np.matmul(along, geometry.Q)[:, 0]
        if self._through is not None:
            by_beta = self._through.force(k + 1).T @ geometry.director
            force += by_beta.reshape(-1, N_DOF)
        return force

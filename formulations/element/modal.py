"""What the mixed elements share: loops over the elements, a chunk at a time, whatever their modes and laws are.

An element takes strains somewhere, projects them on its modes (mode strains E, resultants H = dW/dE over the weights of
the modes), and knows of each chunk: what the displacements bring there, B = dE/dv, the response of the law, and the
geometric stiffness of resultants. No mode, no law and no place where strains are taken may enter here.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from formulations.element.strain_operator import ElementGeometry
from formulations.operations import spend
from formulations.strains.measure import StrainMeasure

ALL = slice(None)  # elements
Samples = tuple[np.ndarray, ...]  # of q, or of derivatives by it, at the points where an element takes its strains


class Operations(NamedTuple):
    """Of an element: its strains; B; forces; the tangent; and what one derivative of a quadratic measure takes."""

    sampled: int
    differentiated: int
    balanced: int
    stiffened: int
    of_measure: int


@dataclass(frozen=True, eq=False)
class Stiffness:
    """Derivative of weighted resultants by strains: blocks (n, n) or (e, n, n) along the diagonal."""

    blocks: tuple[np.ndarray, ...]

    def times(self, strains: np.ndarray) -> np.ndarray:
        """(e, m, j) of (e, m, j)."""
        product, start = np.empty_like(strains), 0
        for block in self.blocks:
            rows = slice(start, start + block.shape[-1])
            np.matmul(block, strains[:, rows], out=product[:, rows])
            start = rows.stop
        return product


class ModalElement(ABC):
    """m modes and d displacements an element."""

    measure: StrainMeasure

    @property
    @abstractmethod
    def mode_weights(self) -> np.ndarray:
        """(m,): H dE times them is work an area."""

    @property
    def n_modes(self) -> int:
        """m."""
        return len(self.mode_weights)

    @property
    @abstractmethod
    def powers(self) -> list[tuple[int, int]]:
        """(r1, r2) of the mode xi1^r1 xi2^r2 of each mode strain."""

    @abstractmethod
    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """H (e, m) [N/mm] of mode strains (e, m), of the elements of the part."""

    @abstractmethod
    def mean_resultants(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means H (E, 11) over the elements, as of two faces, of mode strains (E, m)."""

    @abstractmethod
    def mean_strains(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means E (E, 11) over the elements, as of two faces, of mode strains (E, m)."""

    @abstractmethod
    def at_gauss(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Strains (E, 4, 11) at the Gauss points, as of two faces, of mode strains (E, m)."""

    @abstractmethod
    def energy(self, geometry: ElementGeometry, v: np.ndarray) -> float:
        """Strain energy of the whole grid [N mm], H0 excluded."""

    @property
    @abstractmethod
    def _operations(self) -> Operations: ...

    @abstractmethod
    def _areas(self, geometry: ElementGeometry) -> np.ndarray:
        """(E,) by which resultants count."""

    @abstractmethod
    def _initial(self, part: slice) -> np.ndarray:
        """H0 on the modes (m,), or of each element of the part."""

    @abstractmethod
    def _response(self, strains: np.ndarray, part: slice) -> tuple[np.ndarray, Stiffness]:
        """H (e, m) and its weighted derivative."""

    @abstractmethod
    def _gradients(self, geometry: ElementGeometry, part: slice, v: np.ndarray) -> Samples:
        """What the displacements v (E, d) bring where strains are taken."""

    @abstractmethod
    def _strains(self, geometry: ElementGeometry, part: slice, samples: Samples) -> tuple[np.ndarray, Samples]:
        """Mode strains (e, m), and dE/dq where they are taken."""

    @abstractmethod
    def _mode_gradient(
        self, geometry: ElementGeometry, part: slice, gradients: Samples, samples: Samples, out: np.ndarray
    ) -> None:
        """B (e, m, d); may use up the gradients."""

    @abstractmethod
    def _stiffen(
        self, tangent: np.ndarray, work: np.ndarray, geometry: ElementGeometry, part: slice, samples: Samples
    ) -> None:
        """Add the geometric stiffness of weighted resultants times area ``work`` (e, m) to the tangent (e, d, d)."""

    @property
    def linear(self) -> bool:
        """Whether resultants are linear in the strains."""
        return True

    def change(self, geometry: ElementGeometry, strains: np.ndarray, slopes: list[Stiffness]) -> np.ndarray:
        """dH (E, m) of dE (E, m), by dH/dE where it was last integrated, a chunk after the other."""
        if self.linear:
            return self.resultants(strains)
        parts = zip(geometry.chunks(), slopes, strict=True)
        by_parts = [slope.times(strains[part, :, None])[..., 0] for part, slope in parts]
        return np.concatenate(by_parts) / self.mode_weights

    def mode_strains(self, geometry: ElementGeometry, v: np.ndarray) -> np.ndarray:
        """Mode strains E (E, m) of nodal displacements v (E, d)."""
        self._spend(len(v), self._operations.sampled)
        strains = np.empty((len(v), self.n_modes))
        for part in geometry.chunks():
            strains[part], _ = self._strains(geometry, part, self._gradients(geometry, part, v))
        return strains

    def mode_gradient(self, geometry: ElementGeometry, v: np.ndarray) -> np.ndarray:
        """B = dE/dv (E, m, d) at nodal displacements v (E, d)."""
        self._spend(len(v), self._operations.sampled + self._operations.differentiated)
        B = np.empty((len(v), self.n_modes, v.shape[1]))
        for part in geometry.chunks():
            samples = self._gradients(geometry, part, v)
            _, gradients = self._strains(geometry, part, samples)
            self._mode_gradient(geometry, part, gradients, samples, out=B[part])
        return B

    def linear_initial_force(self, geometry: ElementGeometry, n_dof: int) -> np.ndarray:
        """The work of H0 on the linear strains, (E, d): balanced in the reference state, so it is taken off."""
        at_rest = np.zeros((len(geometry.Q), n_dof))
        initial = self._initial(ALL)
        if not np.any(initial):
            return at_rest
        areas, B = self._areas(geometry)[:, None], self.mode_gradient(geometry, at_rest)
        if initial.ndim == 1:
            return areas * ((self.mode_weights * initial) @ B)
        return np.matmul((self.mode_weights * initial * areas)[:, None], B)[:, 0]

    def integrate(
        self,
        geometry: ElementGeometry,
        v: np.ndarray,
        predicted: np.ndarray | None,
        force: np.ndarray,
        tangent: np.ndarray | None = None,
        mode_gradient: np.ndarray | None = None,
        slopes: list[Stiffness] | None = None,
    ) -> np.ndarray:
        """Resultants H (E, m) at v (E, d); force, tangent and B = dE/dv are written into the arrays.

        ``predicted`` (E, m): the resultants that build the geometric stiffness; None takes H(v).  force (E, d);
        tangent (E, d, d), mode_gradient (E, m, d), slopes (dH/dE of each chunk, weighted, is added): not
        wanted where None.
        """
        counted = self._operations
        self._spend(len(v), counted.sampled + counted.differentiated + counted.balanced)
        if tangent is not None:
            self._spend(len(v), counted.stiffened)
        resultants = np.empty((len(v), self.n_modes))
        for part in geometry.chunks():
            area, initial = self._areas(geometry)[part, None], self._initial(part)
            samples = self._gradients(geometry, part, v)
            strains, gradients = self._strains(geometry, part, samples)
            B = np.empty((len(area), self.n_modes, v.shape[1])) if mode_gradient is None else mode_gradient[part]
            self._mode_gradient(geometry, part, gradients, samples, out=B)
            if tangent is None:
                H = self.resultants(strains, part)
            else:
                H, stiffness = self._response(strains, part)
                DB = stiffness.times(B)
                DB *= area[..., None]
                np.matmul(B.swapaxes(1, 2), DB, out=tangent[part])
                if slopes is not None:
                    slopes.append(stiffness)
            resultants[part] = H
            force[part] = np.matmul((self.mode_weights * (H + initial) * area)[:, None], B)[:, 0]
            if tangent is not None:
                building = H if predicted is None else predicted[part]
                self._stiffen(tangent[part], self.mode_weights * (building + initial) * area, geometry, part, samples)
        return resultants

    def _spend(self, elements: int, each: int) -> None:
        """Count operations, and of the measure one derivative with them."""
        spend(elements * (each + getattr(self.measure, "work", 1.0) * self._operations.of_measure))

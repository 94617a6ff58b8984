"""The mixed four-node element with any number of surfaces through its wall.

As :mod:`formulations.element.mixed`, with bilinear displacements of every surface of a
:class:`formulations.section.sampling.Sampling` and six strains on every surface where strains are taken, by the same
table of the measure: the rows of one face, with beta = du/dd on that surface. E33 and the shears are those of every
surface, so that the plain three-dimensional law bends without locking from three surfaces on; 2E_a3 is the physical
shear, without the factor zeta_a/zbar_a of two faces. Options are those of the element between two faces: of E33 a share
is taken at the nodes, surface by surface; of E11 on the mode 01 and E22 on 10 the mean through the wall is relaxed.

The element sees a measure and a law only through their protocols; no surface, load or support may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product as pairs_of

import numpy as np

from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.element.strain_operator import N_GAUSS, ElementGeometry
from formulations.element.wall_geometry import N_SURFACE, WallGeometry
from formulations.element.wall_modes import (
    ALL,
    FACTORS,
    N_OF_SURFACE,
    N_ROWS,
    ON_CORNERS,
    ON_GAUSS,
    POWERS,
    ROWS,
    LinearLaw,
    WallLaw,
    mode_slices,
    strains_at,
)
from formulations.operations import product, spend
from formulations.section.sampling import Sampling
from formulations.strains.measure import StrainFunction, StrainMeasure, restricted, strain_and_gradient
from formulations.strains.quantities import BETA, N_BETA, N_E, N_Q, OF_SURFACE, STRAINS_OF_SURFACE

N_OWN, N_ALL = len(OF_SURFACE), len(OF_SURFACE) + N_BETA
OF_ONE = np.array([*OF_SURFACE, *range(N_Q)[BETA]])  # quantities of one surface among those of two faces
E33 = N_ROWS - 1
RELAXED = (1, 2)  # the modes whose first row a relaxed element shrinks: E11 on 01, E22 on 10
CHUNK = 64  # elements per pass
Samples = tuple[np.ndarray, np.ndarray]  # q at the Gauss points (e, T, 4, 9), beta at the nodes (e, T, 4, 3)


@dataclass(frozen=True, eq=False)
class SamplingElement:
    """own, through: the six strains of a surface by its nine quantities, and E33 by beta at a node.

    projection (13, 24): mode strains of a surface from those at its four Gauss points; nodal (4, 4): modes of E33 from
    its values at the nodes, None where it is not taken there.  initial (13 T,): resultants H0 of the reference state.
    spread (S^2, 4 T): blocks of the geometric stiffness, surface by surface, from those of strains.
    """

    measure: StrainMeasure
    wall: WallGeometry
    law: WallLaw
    own: StrainFunction
    through: StrainFunction
    projection: np.ndarray
    nodal: np.ndarray | None
    relaxed: bool
    initial: np.ndarray
    spread: np.ndarray

    @classmethod
    def build(
        cls,
        measure: StrainMeasure,
        wall: WallGeometry,
        law: WallLaw,
        initial: np.ndarray,
        thickness_strain: str = "projected",
        membrane: str = "compatible",
    ) -> SamplingElement:
        """Raises ValueError for an option that does not exist.  initial (11,): H0 as of two faces [N/mm]."""
        if thickness_strain not in THICKNESS_STRAINS:
            raise ValueError(f"thickness strain {thickness_strain!r} is not one of {', '.join(THICKNESS_STRAINS)}")
        if membrane not in MEMBRANES:
            raise ValueError(f"membrane {membrane!r} is not one of {', '.join(MEMBRANES)}")
        share, T = THICKNESS_STRAINS[thickness_strain], len(wall.sampling.strained)
        projection = []
        for rows, factor, at in zip(ROWS, FACTORS, ON_GAUSS, strict=True):
            for row in rows:
                unit = np.zeros((N_GAUSS, N_ROWS))
                unit[:, row] = (1 - share * (row == E33)) * factor * at / N_GAUSS
                projection.append(unit.ravel())
        at_rest = np.zeros(N_OF_SURFACE * T)
        at_rest[: N_ROWS * T] = wall.sampling.linear_stress(initial).ravel()
        return cls(
            measure=measure,
            wall=wall,
            law=law,
            own=restricted(measure, np.array(STRAINS_OF_SURFACE), OF_ONE),
            through=restricted(measure, np.array(STRAINS_OF_SURFACE[E33:]), np.arange(N_Q)[BETA]),
            projection=np.array(projection),
            nodal=share * ON_CORNERS / N_GAUSS if share else None,
            relaxed=membrane == "relaxed",
            initial=at_rest,
            spread=_spread(wall.sampling),
        )

    @property
    def n_modes(self) -> int:
        """Mode strains of an element."""
        return len(self.initial)

    @property
    def powers(self) -> list[tuple[int, int]]:
        """(r1, r2) of each."""
        T = len(self.wall.sampling.strained)
        return [mode for mode, rows in zip(POWERS, ROWS, strict=True) for _ in range(T * len(rows))]

    @property
    def n_dof(self) -> int:
        """Displacements of an element."""
        return self.wall.n_dof

    def mode_strains(self, geometry: ElementGeometry, v: np.ndarray) -> np.ndarray:
        """Mode strains E (E, 13 T) of nodal displacements v (E, 12 S)."""
        strains = np.empty((len(v), self.n_modes))
        for part in self._chunks():
            strains[part], _ = self._strains(geometry, part, self._gradients(part, v))
        return strains

    def mode_gradient(self, geometry: ElementGeometry, v: np.ndarray) -> np.ndarray:
        """B = dE/dv (E, 13 T, 12 S) at nodal displacements v (E, 12 S)."""
        B = np.empty((len(v), self.n_modes, self.n_dof))
        for part in self._chunks():
            samples = self._gradients(part, v)
            self._mode_gradient(geometry, part, self._strains(geometry, part, samples)[1], samples, out=B[part])
        return B

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """H (e, 13 T) [N/mm] of the elements of the part, by the law."""
        return self.law.resultants(strains, part)

    def mean_resultants(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means H (E, 11) over the elements, as of two faces: int N^-+ S dd, and of S33."""
        T = len(self.wall.sampling.strained)
        H = self.resultants(strains)[:, : N_ROWS * T].reshape(-1, T, N_ROWS)
        of_faces = np.einsum("ft,etr->erf", self.wall.sampling.to_faces, H[..., :E33]).reshape(len(H), -1)
        return np.concatenate([of_faces, H[..., E33].sum(axis=1, keepdims=True)], axis=1)

    def mean_strains(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means E (E, 11) over the elements, of both faces, and of E33 through the wall."""
        return _as_of_faces(self.wall.sampling, strains_at(strains, np.eye(4)[:, :1])[:, 0])

    def at_gauss(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Strains (E, 4, 11) at the Gauss points, of both faces, and of E33 through the wall."""
        return _as_of_faces(self.wall.sampling, strains_at(strains, ON_GAUSS))

    def stresses(self, strains: np.ndarray, taken: np.ndarray) -> np.ndarray:
        """Mean S (E, plies, k, 6) [MPa] at places in each ply: 11, 22, 12, 13, 23, 33, along the coordinates.

        taken (plies, k, T): see :meth:`formulations.section.sampling.Sampling.taken`.
        """
        mean = strains_at(strains, np.eye(4)[:, :1])[:, 0]
        return self.law.stresses(np.einsum("pkt,etr->epkr", taken, mean))

    def energy(self, geometry: ElementGeometry, v: np.ndarray) -> float:
        """Strain energy of the whole grid [N mm], H0 excluded."""
        return float(self.wall.area @ self.law.energy(self.mode_strains(geometry, v)))

    def linear_initial_force(self, geometry: ElementGeometry) -> np.ndarray:
        """The work of H0 on the linear strains, (E, 12 S): balanced in the reference state, so it is taken off."""
        at_rest = np.zeros((len(self.wall.area), self.n_dof))
        if not np.any(self.initial):
            return at_rest
        return self.wall.area[:, None] * (self.initial @ self.mode_gradient(geometry, at_rest))

    def slopes(self, elements: int) -> np.ndarray | None:
        """Room for what :meth:`change` needs of elements; None where a law is linear."""
        return None if isinstance(self.law, LinearLaw) else np.empty((elements, self.n_modes, self.n_modes))

    def change(self, strains: np.ndarray, slopes: np.ndarray | None) -> np.ndarray:
        """dH (E, 13 T) of small dE (E, 13 T) by dH/dE where it was last integrated."""
        return self.resultants(strains) if slopes is None else np.matmul(slopes, strains[..., None])[..., 0]

    def integrate(
        self,
        geometry: ElementGeometry,
        v: np.ndarray,
        predicted: np.ndarray | None,
        force: np.ndarray,
        tangent: np.ndarray | None = None,
        mode_gradient: np.ndarray | None = None,
        slopes: np.ndarray | None = None,
    ) -> np.ndarray:
        """Resultants H (E, 13 T) at v (E, 12 S); force, tangent, B = dE/dv and dH/dE are written into the arrays.

        As :meth:`formulations.element.mixed.MixedElement.integrate`.
        """
        self._spend(len(v), tangent is not None)
        resultants = np.empty((len(v), self.n_modes))
        for part in self._chunks():
            area = self.wall.area[part, None]
            samples = self._gradients(part, v)
            strains, gradient = self._strains(geometry, part, samples)
            B = np.empty((len(area), self.n_modes, self.n_dof)) if mode_gradient is None else mode_gradient[part]
            self._mode_gradient(geometry, part, gradient, samples, out=B)
            if tangent is None:
                H = resultants[part] = self.law.resultants(strains, part)
            else:
                H, D = self.law.response(strains, part)
                resultants[part] = H
                DB = D.times(B)
                DB *= area[..., None]
                np.matmul(B.swapaxes(1, 2), DB, out=tangent[part])
                if slopes is not None:
                    slopes[part] = D.blocks[0]
            force[part] = np.matmul(((H + self.initial) * area)[:, None], B)[:, 0]
            if tangent is not None:
                build = H if predicted is None else predicted[part]
                self._stiffen(tangent[part], (build + self.initial) * area, geometry, part, samples)
        return resultants

    def _chunks(self) -> list[slice]:
        n = len(self.wall.area)
        return [slice(start, min(start + CHUNK, n)) for start in range(0, n, CHUNK)]

    def _spend(self, elements: int, tangent: bool) -> None:
        """Count operations by the shapes of the products, as of a quadratic measure."""
        T, S, m, n = len(self.wall.sampling.strained), len(self.wall.sampling.at), self.n_modes, self.n_dof
        each = T * N_GAUSS * (product(N_ROWS, N_ALL, N_SURFACE) + 2 * product(N_ROWS, N_ALL, N_ALL))
        each += T * product(N_OF_SURFACE, N_GAUSS * N_ROWS, 2 * N_SURFACE) + product(m, n)
        if tangent:
            each += sum(product(T * len(rows), T * len(rows), n) for rows in ROWS) + product(n, m, n)
            each += 3 * T * N_GAUSS * product(N_SURFACE, N_ALL, N_SURFACE) + product(S * S, 4 * T, N_SURFACE**2)
        spend(elements * each)

    def _gradients(self, part: slice, v: np.ndarray) -> Samples:
        wall, sampling = self.wall, self.wall.sampling
        of_surfaces = wall.by_surface(v[part])
        n, T = len(of_surfaces), len(sampling.strained)
        q = np.empty((n, T, N_GAUSS, N_ALL))
        q[..., :N_OWN] = np.matmul(wall.own[part], of_surfaces[:, sampling.on, :, None]).reshape(n, T, N_GAUSS, N_OWN)
        along = np.matmul(sampling.slope, of_surfaces)
        q[..., N_OWN:] = np.matmul(along, self._value(part).swapaxes(1, 2)).reshape(n, T, N_GAUSS, N_BETA)
        return q, along.reshape(n, T, 4, N_BETA)

    def _value(self, part: slice) -> np.ndarray:
        return self.wall.value if len(self.wall.value) == 1 else self.wall.value[part]

    def _strains(self, geometry: ElementGeometry, part: slice, samples: Samples) -> tuple[np.ndarray, np.ndarray]:
        """Mode strains (e, 13 T), and dE/dq (e, T, 4, 6, 9) at the Gauss points."""
        q, beta = samples
        offset = None if self.wall.offset is None else self.wall.offset[part]
        strain, gradient = strain_and_gradient(self.own, q, offset)
        of_surfaces = strain.reshape(*strain.shape[:2], -1) @ self.projection.T
        if self.nodal is not None:
            of_surfaces[..., OF_E33] += self.through.strain(beta)[..., 0] @ self.nodal.T
        strains = _by_mode(of_surfaces)
        self._relax(strains, geometry, part)
        return strains, gradient

    def _mode_gradient(
        self, geometry: ElementGeometry, part: slice, gradient: np.ndarray, samples: Samples, out: np.ndarray
    ) -> None:
        """B (e, 13 T, 12 S): derivative of the mode strains by the nodal displacements."""
        sampling, (q, beta) = self.wall.sampling, samples
        n, T = q.shape[:2]
        at_points = self.wall.own[part].reshape(n, T, N_GAUSS, N_OWN, N_SURFACE)
        taken = np.matmul(gradient[..., :N_OWN], at_points).reshape(n, T, -1, N_SURFACE)
        own = np.matmul(self.projection, taken)
        value = self._value(part).reshape(-1, 1, N_GAUSS, N_BETA, N_SURFACE)
        taken = np.matmul(gradient[..., N_OWN:], value).reshape(n, T, -1, N_SURFACE)
        along = np.matmul(self.projection, taken)
        if self.nodal is not None:
            of_nodes = self.nodal[:, :, None] * self.through.gradient(beta)[:, :, None, :, 0]
            along[:, :, OF_E33] += of_nodes.reshape(n, T, 4, N_SURFACE)
        for surface, columns in enumerate(self.wall.columns):
            by = sampling.slope[:, surface, None, None] * along
            here = sampling.on == surface
            by[:, here] += own[:, here]
            out[:, :, columns] = _by_mode(by)
        self._relax(out, geometry, part)

    def _stiffen(
        self, tangent: np.ndarray, work: np.ndarray, geometry: ElementGeometry, part: slice, samples: Samples
    ) -> None:
        """Add the geometric stiffness of resultants times area ``work`` (e, 13 T) to the tangent (e, 12 S, 12 S)."""
        q, beta = samples
        n, T = q.shape[:2]
        self._relax(work, geometry, part, transposed=True)
        of_surfaces = _by_surface(work, T)
        at_gauss = (of_surfaces @ self.projection).reshape(n, T, N_GAUSS, N_ROWS)
        M = self.own.contract(q if self.wall.offset is None else self.wall.offset[part] + q, at_gauss)
        at_points = self.wall.own[part].reshape(n, T, N_GAUSS, N_OWN, N_SURFACE)
        value = self._value(part).reshape(-1, 1, N_GAUSS, N_BETA, N_SURFACE)
        blocks = np.empty((n, 4, T, N_SURFACE, N_SURFACE))
        own = self.wall.own[part].swapaxes(2, 3)
        np.matmul(own, np.matmul(M[..., :N_OWN, :N_OWN], at_points).reshape(n, T, -1, N_SURFACE), out=blocks[:, 0])
        along = np.matmul(M[..., N_OWN:], value)
        np.matmul(own, along[..., :N_OWN, :].reshape(n, T, -1, N_SURFACE), out=blocks[:, 1])
        blocks[:, 2] = blocks[:, 1].swapaxes(-1, -2)
        taken = self._value(part).swapaxes(1, 2)[:, None]
        np.matmul(taken, along[..., N_OWN:, :].reshape(n, T, -1, N_SURFACE), out=blocks[:, 3])
        if self.nodal is not None:
            of_nodes = self.through.contract(beta, (of_surfaces[..., OF_E33] @ self.nodal)[..., None])
            np.einsum("etrirj->etrij", blocks[:, 3].reshape(n, T, 4, N_BETA, 4, N_BETA))[...] += of_nodes
        sums = np.matmul(self.spread, blocks.reshape(n, 4 * T, -1))
        surfaces = self.wall.columns
        for place, (one, other) in enumerate(pairs_of(surfaces, repeat=2)):
            tangent[:, one, other] += sums[:, place].reshape(n, N_SURFACE, N_SURFACE)

    def _relax(self, modes: np.ndarray, geometry: ElementGeometry, part: slice, *, transposed: bool = False) -> None:
        """Shrink the mean through the wall of E11 on the mode 01 and of E22 on the mode 10, in place."""
        if not self.relaxed:
            return
        means = self.wall.sampling.means
        blocks = mode_slices(len(means))
        for a, mode in enumerate(RELAXED):
            rows = slice(blocks[mode].start, blocks[mode].stop, len(ROWS[mode]))
            taken, given = (np.ones_like(means), means) if transposed else (means, np.ones_like(means))
            shrink = 1.0 - np.sqrt(geometry.relaxation[part, a])
            mean = np.einsum("t,et...->e...", taken, modes[:, rows])
            modes[:, rows] -= np.einsum("e,t,e...->et...", shrink, given, mean)


OF_E33 = np.cumsum([0, *(len(rows) for rows in ROWS)])[1:] - 1  # E33 is the last row of every mode


def _by_mode(of_surfaces: np.ndarray) -> np.ndarray:
    """(e, 13 T, ...) of (e, T, 13, ...)."""
    n, _T, _, *rest = of_surfaces.shape
    ends = np.cumsum([len(rows) for rows in ROWS])[:-1]
    return np.concatenate([part.reshape(n, -1, *rest) for part in np.split(of_surfaces, ends, axis=2)], axis=1)


def _by_surface(modes: np.ndarray, T: int) -> np.ndarray:
    """(e, T, 13) of (e, 13 T)."""
    return np.concatenate([modes[:, block].reshape(len(modes), T, -1) for block in mode_slices(T)], axis=2)


def _as_of_faces(sampling: Sampling, strains: np.ndarray) -> np.ndarray:
    """(..., 11) as between two faces, of (..., T, 6)."""
    found = np.empty((*strains.shape[:-2], N_E))
    found[..., 0 : E33 * 2 : 2], found[..., 1 : E33 * 2 : 2] = strains[..., 0, :E33], strains[..., -1, :E33]
    found[..., -1] = strains[..., E33] @ sampling.means
    return found


def _spread(sampling: Sampling) -> np.ndarray:
    """(S^2, 4 T): of strains taken on t, what l, w, t give to its surface, they with beta, beta with them, and beta."""
    here = np.eye(len(sampling.at))[sampling.on]
    slope = sampling.slope
    pairs = [np.einsum("tj,tk->jkt", *pair) for pair in ((here, here), (here, slope), (slope, here), (slope, slope))]
    return np.concatenate(pairs, axis=-1).reshape(len(sampling.at) ** 2, -1)

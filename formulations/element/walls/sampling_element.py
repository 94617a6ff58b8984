"""The mixed four-node element with any number of surfaces through its wall.

As :mod:`formulations.element.mixed`, with bilinear displacements of every surface of a
:class:`formulations.section.sampling.Sampling` and six strains on every surface where strains are taken, by the same
table of the measure: the rows of one face, with beta = du/dd on that surface. E33 and the shears are those of every
surface, so that the plain three-dimensional law bends without locking from three surfaces on; 2E_a3 is the physical
shear, without the factor zeta_a/zbar_a of two faces. Modes and laws are those of
:mod:`formulations.element.walls.modes`; of E11 on the mode 01 and E22 on 10 the mean through the wall is relaxed.

The element sees a measure and a law only through their protocols; no surface, load or support may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product as pairs_of

import numpy as np

from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.element.modal import ALL, ModalElement, Operations, Samples, Stiffness
from formulations.element.strain_operator import ElementGeometry
from formulations.element.walls.geometry import N_SURFACE, FaceDirector, WallGeometry
from formulations.element.walls.law import WallLaw
from formulations.element.walls.modes import (
    E33,
    N_OF_SURFACE,
    N_ROWS,
    OF_E33,
    POWERS,
    ROWS,
    by_mode,
    by_surface,
    mode_slices,
    on_every_surface,
    strains_at,
)
from formulations.operations import product
from formulations.section.sampling import Sampling
from formulations.strains.measure import StrainFunction, StrainMeasure, restricted, strain_and_gradient
from formulations.strains.quantities import BETA, N_BETA, N_E, N_Q, OF_SURFACE, STRAINS_OF_SURFACE

N_OWN, N_ALL = len(OF_SURFACE), len(OF_SURFACE) + N_BETA
OF_ONE = np.array([*OF_SURFACE, *range(N_Q)[BETA]])  # quantities of one surface among those of two faces
MIDDLE = np.eye(len(POWERS))[:, :1]  # of the element, where the mode 00 is 1 and all others 0
# modes and places among their rows of what a mean through the wall is taken off, along a1 and along a2: in part, of E11
# on 01 and of E22 on 10, by a relaxed element; wholly, of 2E13 zeta_1 on 10 and of 2E23 zeta_2 on 01
MEMBRANE, SHEAR = ((1, 0), (2, 0)), ((2, 1), (1, 2))


@dataclass(frozen=True, eq=False)
class SamplingElement(ModalElement):
    """own: the six strains of a surface by its nine quantities.

    director: what E33 at the nodes adds, None where nothing is taken there.  initial (15 T,): resultants H0 of the
    reference state.  spread (S^2, 4 T): blocks of the geometric stiffness, surface by surface, from those of strains.
    """

    measure: StrainMeasure
    wall: WallGeometry
    law: WallLaw
    own: StrainFunction
    director: FaceDirector | None
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
        at_rest = np.zeros(N_OF_SURFACE * T)
        at_rest[: N_ROWS * T] = wall.sampling.linear_stress(initial).ravel()
        through = restricted(measure, np.array(STRAINS_OF_SURFACE[E33:]), np.arange(N_Q)[BETA])
        return cls(
            measure=measure,
            wall=wall,
            law=law,
            own=restricted(measure, np.array(STRAINS_OF_SURFACE), OF_ONE),
            director=FaceDirector.of(wall, through, share) if share else None,
            relaxed=membrane == "relaxed",
            initial=at_rest,
            spread=_spread(wall.sampling),
        )

    @property
    def mode_weights(self) -> np.ndarray:
        """1: resultants are weighted."""
        return np.ones(len(self.initial))

    @property
    def powers(self) -> list[tuple[int, int]]:
        """(r1, r2) of each."""
        T = len(self.wall.sampling.strained)
        return [mode for mode, rows in zip(POWERS, ROWS, strict=True) for _ in range(T * len(rows))]

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """By the law."""
        return self.law.resultants(strains, part)

    def mean_resultants(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means H (E, 11) over the elements, as of two faces: int N^-+ S dd, and of S33."""
        T = len(self.wall.sampling.strained)
        H = self.resultants(strains)[:, : N_ROWS * T].reshape(-1, T, N_ROWS)
        of_faces = np.einsum("ft,etr->erf", self.wall.sampling.to_faces, H[..., :E33]).reshape(len(H), -1)
        return np.concatenate([of_faces, H[..., E33].sum(axis=1, keepdims=True)], axis=1)

    def mean_strains(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means E (E, 11) over the elements, of both faces, and of E33 through the wall."""
        return _as_of_faces(self.wall.sampling, strains_at(strains, MIDDLE)[:, 0])

    def at_gauss(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Strains (E, 4, 11) at the Gauss points, of both faces, and of E33 through the wall."""
        return _as_of_faces(self.wall.sampling, self.wall.at_gauss(strains))

    def stresses(self, strains: np.ndarray, taken: np.ndarray) -> np.ndarray:
        """Mean S (E, plies, k, 6) [MPa] at places in each ply: 11, 22, 12, 13, 23, 33, along the coordinates.

        taken (plies, k, T): see :meth:`formulations.section.sampling.Sampling.taken`.
        """
        return self.law.stresses(strains_at(strains, MIDDLE)[:, 0], taken)

    def energy(self, geometry: ElementGeometry, v: np.ndarray) -> float:
        """Strain energy of the whole grid [N mm], H0 excluded."""
        return float(self.wall.area @ self.law.energy(self.mode_strains(geometry, v)))

    @property
    def linear(self) -> bool:
        """Of the law."""
        return self.law.uniform.linear

    @property
    def _operations(self) -> Operations:
        T, S, m, n = len(self.wall.sampling.strained), len(self.wall.sampling.at), self.n_modes, self.wall.n_dof
        points = T * self.wall.n_points
        stiffened = sum(product(T * len(rows), T * len(rows), n) for rows in ROWS) + product(n, m, n)
        stiffened += 3 * points * product(N_SURFACE, N_ALL, N_SURFACE) + product(S * S, 4 * T, N_SURFACE**2)
        return Operations(
            sampled=points * product(N_ROWS, N_ALL),
            differentiated=points * product(N_ROWS, N_ALL, N_SURFACE)
            + T * product(N_OF_SURFACE, self.wall.n_points * N_ROWS, 2 * N_SURFACE),
            balanced=product(m, n),
            stiffened=stiffened,
            of_measure=points * product(N_ROWS, N_ALL, N_ALL),
        )

    def _areas(self, geometry: ElementGeometry) -> np.ndarray:
        return self.wall.area

    def _initial(self, part: slice) -> np.ndarray:
        return self.initial

    def _response(self, strains: np.ndarray, part: slice) -> tuple[np.ndarray, Stiffness]:
        return self.law.response(strains, part)

    def _gradients(self, geometry: ElementGeometry, part: slice, v: np.ndarray) -> Samples:
        """q at the Gauss points of every surface (e, T, 4, 9), and beta of the director of the faces (e, 8, 3)."""
        wall, sampling = self.wall, self.wall.sampling
        of_surfaces = wall.by_surface(v[part])
        n, T = len(of_surfaces), len(sampling.strained)
        q = np.empty((n, T, self.wall.n_points, N_ALL))
        q[..., :N_OWN] = np.matmul(wall.own[part], of_surfaces[:, sampling.on, :, None]).reshape(
            n, T, self.wall.n_points, N_OWN
        )
        along = np.matmul(sampling.slope, of_surfaces)
        q[..., N_OWN:] = np.matmul(along, wall.value_of(part).swapaxes(1, 2)).reshape(n, T, self.wall.n_points, N_BETA)
        return q, np.empty(0) if self.director is None else self.director.beta(of_surfaces, part)

    def _strains(self, geometry: ElementGeometry, part: slice, samples: Samples) -> tuple[np.ndarray, Samples]:
        """Mode strains (e, 15 T), and dE/dq (e, T, 4, 6, 9) at the Gauss points."""
        q, beta = samples
        offset = None if self.wall.offset is None else self.wall.offset[part]
        strain, gradient = strain_and_gradient(self.own, q, offset)
        taken, projection = strain.reshape(*strain.shape[:2], -1), self.wall.projection_of(part)
        alike = projection.ndim == 2
        of_surfaces = taken @ projection.T if alike else np.matmul(projection, taken[..., None])[..., 0]
        if self.director is not None:
            of_surfaces[..., OF_E33] += self.director.strains(beta, part)[:, None]
        strains = by_mode(of_surfaces)
        self._relax(strains, geometry, part)
        return strains, (gradient,)

    def _mode_gradient(
        self, geometry: ElementGeometry, part: slice, gradients: Samples, samples: Samples, out: np.ndarray
    ) -> None:
        sampling, (gradient,), (q, beta) = self.wall.sampling, gradients, samples
        projection = self.wall.projection_of(part)
        n, T = q.shape[:2]
        at_points = self.wall.own[part].reshape(n, T, self.wall.n_points, N_OWN, N_SURFACE)
        taken = np.matmul(gradient[..., :N_OWN], at_points).reshape(n, T, -1, N_SURFACE)
        own = np.matmul(projection, taken)
        value = self.wall.value_of(part).reshape(-1, 1, self.wall.n_points, N_BETA, N_SURFACE)
        taken = np.matmul(gradient[..., N_OWN:], value).reshape(n, T, -1, N_SURFACE)
        along = np.matmul(projection, taken)
        for surface, columns in enumerate(self.wall.columns):
            by = sampling.slope[:, surface, None, None] * along
            here = sampling.on == surface
            by[:, here] += own[:, here]
            out[:, :, columns] = by_mode(by)
        if self.director is not None:
            self.director.add_gradient(out, beta, part)
        self._relax(out, geometry, part)

    def _stiffen(
        self, tangent: np.ndarray, work: np.ndarray, geometry: ElementGeometry, part: slice, samples: Samples
    ) -> None:
        q, beta = samples
        n, T = q.shape[:2]
        self._relax(work, geometry, part, transposed=True)
        of_surfaces = by_surface(work, T)
        projection = self.wall.projection_of(part)
        alike = projection.ndim == 2
        taken = of_surfaces @ projection if alike else np.matmul(of_surfaces[..., None, :], projection)
        H = taken.reshape(n, T, self.wall.n_points, N_ROWS)
        M = self.own.contract(q if self.wall.offset is None else self.wall.offset[part] + q, H)
        at_points = self.wall.own[part].reshape(n, T, self.wall.n_points, N_OWN, N_SURFACE)
        value = self.wall.value_of(part)
        blocks = np.empty((n, 4, T, N_SURFACE, N_SURFACE))
        own = self.wall.own[part].swapaxes(2, 3)
        np.matmul(own, np.matmul(M[..., :N_OWN, :N_OWN], at_points).reshape(n, T, -1, N_SURFACE), out=blocks[:, 0])
        along = np.matmul(M[..., N_OWN:], value.reshape(-1, 1, self.wall.n_points, N_BETA, N_SURFACE))
        np.matmul(own, along[..., :N_OWN, :].reshape(n, T, -1, N_SURFACE), out=blocks[:, 1])
        blocks[:, 2] = blocks[:, 1].swapaxes(-1, -2)
        of_beta = along[..., N_OWN:, :].reshape(n, T, -1, N_SURFACE)
        np.matmul(value.swapaxes(1, 2)[:, None], of_beta, out=blocks[:, 3])
        sums = np.matmul(self.spread, blocks.reshape(n, 4 * T, -1))
        for place, (one, other) in enumerate(pairs_of(self.wall.columns, repeat=2)):
            tangent[:, one, other] += sums[:, place].reshape(n, N_SURFACE, N_SURFACE)
        if self.director is not None:
            self.director.stiffen(tangent, of_surfaces[..., OF_E33].sum(axis=1), beta, part)

    def _relax(self, modes: np.ndarray, geometry: ElementGeometry, part: slice, *, transposed: bool = False) -> None:
        """Take off means through the wall, in place: see :data:`MEMBRANE`."""
        means, stretch = self.wall.sampling.means, self.wall.stretch[part]
        blocks = mode_slices(len(means))
        for a, (mode, column) in enumerate(MEMBRANE if self.relaxed else ()):
            shrink = 1.0 - np.sqrt(geometry.relaxation[part, a, None])
            _take_off(modes[:, on_every_surface(blocks[mode], mode, column)], means, shrink, transposed=transposed)
        for a, (mode, column) in enumerate(SHEAR):
            taken, given = means * stretch[:, a], 1.0 / stretch[:, a]
            _take_off(modes[:, on_every_surface(blocks[mode], mode, column)], taken, given, transposed=transposed)


def _take_off(rows: np.ndarray, taken: np.ndarray, given: np.ndarray, *, transposed: bool) -> None:
    """Subtract given_t sum_s taken_s x_s from x (e, T, ...), or the transpose."""
    shape = (len(rows), rows.shape[1])
    first, second = (np.broadcast_to(each, shape) for each in ((given, taken) if transposed else (taken, given)))
    mean = np.einsum("et,et...->e...", first, rows)
    rows -= np.einsum("et,e...->et...", second, mean)


def _as_of_faces(sampling: Sampling, strains: np.ndarray) -> np.ndarray:
    """(..., 11) as between two faces, of (..., T, 6)."""
    reduced = np.empty((*strains.shape[:-2], N_E))
    reduced[..., 0 : E33 * 2 : 2], reduced[..., 1 : E33 * 2 : 2] = strains[..., 0, :E33], strains[..., -1, :E33]
    reduced[..., -1] = strains[..., E33] @ sampling.means
    return reduced


def _spread(sampling: Sampling) -> np.ndarray:
    """(S^2, 4 T): of strains taken on t, what l, w, t give to its surface, they with beta, beta with them, and beta."""
    here = np.eye(len(sampling.at))[sampling.on]
    slope = sampling.slope
    pairs = [np.einsum("tj,tk->jkt", *pair) for pair in ((here, here), (here, slope), (slope, here), (slope, slope))]
    return np.concatenate(pairs, axis=-1).reshape(len(sampling.at) ** 2, -1)

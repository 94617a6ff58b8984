"""The mixed four-node element with any number of surfaces through its wall.

As :mod:`formulations.element.mixed`, with bilinear displacements of every surface of a
:class:`formulations.section.sampling.Sampling` and six strains on every surface where strains are taken, by the same
table of the measure: the rows of one face, with beta = du/dd on that surface. E33 and the shears are those of every
surface, so that the plain three-dimensional law bends without locking from three surfaces on; 2E_a3 is the physical
shear, without the factor zeta_a/zbar_a of two faces. Modes are those of :mod:`formulations.element.wall_modes`.

Options are those of the element between two faces. Of E33 of the director of the faces, (v+ - v-)/h, a share is taken
at the nodes and not at the Gauss points: it is that director which is too short between nodes that turn, and were the
E33 of every surface taken there, pressure across the wall would drive those inside to and fro. Of E11 on the mode 01
and E22 on 10 the mean through the wall is relaxed.

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
    Stiffness,
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
# modes and places among their rows of what a mean through the wall is taken off, along a1 and along a2: in part, of E11
# on 01 and of E22 on 10, by a relaxed element; wholly, of 2E13 zeta_1 on 10 and of 2E23 zeta_2 on 01
MEMBRANE, SHEAR = ((1, 0), (2, 0)), ((2, 1), (1, 2))
CHUNK = 128  # elements per pass
# q at the Gauss points (e, T, 4, 9), and of the director of the faces there and at the nodes (e, 8, 3)
Samples = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class SamplingElement:
    """own, through: the six strains of a surface by its nine quantities, and E33 by beta at a node.

    projection (15, 24): mode strains of a surface from those at its four Gauss points.  director (4, 8): what E33 of
    the director of the faces at the Gauss points and at the nodes adds to the modes of E33 of every surface, None where
    nothing is taken at the nodes.  initial (15 T,): resultants H0 of the reference state.  spread (S^2, 4 T): blocks of
    the geometric stiffness, surface by surface, from those of strains.
    """

    measure: StrainMeasure
    wall: WallGeometry
    law: WallLaw
    own: StrainFunction
    through: StrainFunction
    projection: np.ndarray
    director: np.ndarray | None
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
                unit[:, row] = factor * at / N_GAUSS
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
            director=share / N_GAUSS * np.hstack([-FACTORS[:, None] * ON_GAUSS, ON_CORNERS]) if share else None,
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
        """Mode strains E (E, 15 T) of nodal displacements v (E, 12 S)."""
        strains = np.empty((len(v), self.n_modes))
        for part in self._chunks():
            strains[part], _ = self._strains(geometry, part, self._gradients(part, v))
        return strains

    def mode_gradient(self, geometry: ElementGeometry, v: np.ndarray) -> np.ndarray:
        """B = dE/dv (E, 15 T, 12 S) at nodal displacements v (E, 12 S)."""
        B = np.empty((len(v), self.n_modes, self.n_dof))
        for part in self._chunks():
            samples = self._gradients(part, v)
            self._mode_gradient(geometry, part, self._strains(geometry, part, samples)[1], samples, out=B[part])
        return B

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """H (e, 15 T) [N/mm] of the elements of the part, by the law."""
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

    def at_points(self, strains: np.ndarray, xi: np.ndarray) -> np.ndarray:
        """Strains (E, p, 11) at points xi (p, 2), of both faces, and of E33 through the wall."""
        values = np.array([xi[:, 0] ** r1 * xi[:, 1] ** r2 for r1, r2 in POWERS])
        return _as_of_faces(self.wall.sampling, strains_at(strains, values))

    def stresses(self, strains: np.ndarray, taken: np.ndarray) -> np.ndarray:
        """Mean S (E, plies, k, 6) [MPa] at places in each ply: 11, 22, 12, 13, 23, 33, along the coordinates.

        taken (plies, k, T): see :meth:`formulations.section.sampling.Sampling.taken`.
        """
        mean = strains_at(strains, np.eye(4)[:, :1])[:, 0]
        return self.law.uniform.stresses(np.einsum("pkt,etr->epkr", taken, mean))

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
        """Room for what :meth:`change` needs of elements, dH/dE on the mode 00; None where the law is linear."""
        n = N_ROWS * len(self.wall.sampling.strained)
        return None if self.law.uniform.linear else np.empty((elements, n, n))

    def change(self, strains: np.ndarray, slopes: np.ndarray | None) -> np.ndarray:
        """dH (E, 15 T) of small dE (E, 15 T) by dH/dE where it was last integrated."""
        if slopes is None:
            return self.resultants(strains)
        return Stiffness((slopes, *self.law.linear)).times(strains[..., None])[..., 0]

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
        """Resultants H (E, 15 T) at v (E, 12 S); force, tangent, B = dE/dv and dH/dE are written into the arrays.

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
        along, value = np.matmul(sampling.slope, of_surfaces), self._value(part)
        q[..., N_OWN:] = np.matmul(along, value.swapaxes(1, 2)).reshape(n, T, N_GAUSS, N_BETA)
        at_nodes = (of_surfaces[:, -1] - of_surfaces[:, 0]) / sampling.laminate.thickness
        at_gauss = np.matmul(value, at_nodes[..., None])
        return q, np.concatenate([at_gauss.reshape(n, 4, N_BETA), at_nodes.reshape(n, 4, N_BETA)], axis=1)

    def _director_rest(self, part: slice) -> np.ndarray | None:
        """(e, 8, 3) of the interpolated positions: at the nodes the director is the true one."""
        if self.wall.offset is None:
            return None
        at_gauss = self.wall.offset[part, 0, :, N_OWN:]
        return np.concatenate([at_gauss, np.zeros_like(at_gauss)], axis=1)

    def _value(self, part: slice) -> np.ndarray:
        return self.wall.value if len(self.wall.value) == 1 else self.wall.value[part]

    def _strains(self, geometry: ElementGeometry, part: slice, samples: Samples) -> tuple[np.ndarray, np.ndarray]:
        """Mode strains (e, 15 T), and dE/dq (e, T, 4, 6, 9) at the Gauss points."""
        q, beta = samples
        offset = None if self.wall.offset is None else self.wall.offset[part]
        strain, gradient = strain_and_gradient(self.own, q, offset)
        of_surfaces = strain.reshape(*strain.shape[:2], -1) @ self.projection.T
        if self.director is not None:
            lengthened, _ = strain_and_gradient(self.through, beta, self._director_rest(part))
            of_surfaces[..., OF_E33] += (lengthened[..., 0] @ self.director.T)[:, None]
        strains = _by_mode(of_surfaces)
        self._relax(strains, geometry, part)
        return strains, gradient

    def _mode_gradient(
        self, geometry: ElementGeometry, part: slice, gradient: np.ndarray, samples: Samples, out: np.ndarray
    ) -> None:
        """B (e, 15 T, 12 S): derivative of the mode strains by the nodal displacements."""
        sampling, (q, beta) = self.wall.sampling, samples
        n, T = q.shape[:2]
        at_points = self.wall.own[part].reshape(n, T, N_GAUSS, N_OWN, N_SURFACE)
        taken = np.matmul(gradient[..., :N_OWN], at_points).reshape(n, T, -1, N_SURFACE)
        own = np.matmul(self.projection, taken)
        value = self._value(part).reshape(-1, 1, N_GAUSS, N_BETA, N_SURFACE)
        taken = np.matmul(gradient[..., N_OWN:], value).reshape(n, T, -1, N_SURFACE)
        along = np.matmul(self.projection, taken)
        for surface, columns in enumerate(self.wall.columns):
            by = sampling.slope[:, surface, None, None] * along
            here = sampling.on == surface
            by[:, here] += own[:, here]
            out[:, :, columns] = _by_mode(by)
        if self.director is not None:
            rest = self._director_rest(part)
            slope = self.through.gradient(beta if rest is None else rest + beta)[..., 0, :]
            lengthening = np.matmul(self.director[:, :4], np.matmul(slope[:, :4, None], value[:, 0])[:, :, 0])
            lengthening += (self.director[:, 4:, None] * slope[:, None, 4:]).reshape(n, 4, N_SURFACE)
            lengthening /= sampling.laminate.thickness
            for mode, (block, rows) in enumerate(zip(mode_slices(T), ROWS, strict=True)):
                here = out[:, _every(block, mode, len(rows) - 1)]
                here[:, :, self.wall.columns[0]] -= lengthening[:, None, mode]
                here[:, :, self.wall.columns[-1]] += lengthening[:, None, mode]
        self._relax(out, geometry, part)

    def _stiffen(
        self, tangent: np.ndarray, work: np.ndarray, geometry: ElementGeometry, part: slice, samples: Samples
    ) -> None:
        """Add the geometric stiffness of resultants times area ``work`` (e, 15 T) to the tangent (e, 12 S, 12 S)."""
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
        sums = np.matmul(self.spread, blocks.reshape(n, 4 * T, -1))
        surfaces = self.wall.columns
        for place, (one, other) in enumerate(pairs_of(surfaces, repeat=2)):
            tangent[:, one, other] += sums[:, place].reshape(n, N_SURFACE, N_SURFACE)
        if self.director is not None:
            self._stiffen_director(tangent, of_surfaces[..., OF_E33].sum(axis=1), part, beta)

    def _stiffen_director(self, tangent: np.ndarray, across: np.ndarray, part: slice, beta: np.ndarray) -> None:
        """The same of resultants of E33 (e, 4), whose mode strains the director of the faces adds to."""
        assert self.director is not None
        n, rest, value = len(across), self._director_rest(part), self._value(part)
        M = self.through.contract(beta if rest is None else rest + beta, (across @ self.director)[..., None])
        turned = np.matmul(M[:, :4], value.reshape(-1, N_GAUSS, N_BETA, N_SURFACE)).reshape(n, -1, N_SURFACE)
        own = np.matmul(value.swapaxes(1, 2), turned)
        np.einsum("erirj->erij", own.reshape(n, 4, N_BETA, 4, N_BETA))[...] += M[:, 4:]
        own /= self.wall.sampling.laminate.thickness**2
        inner, outer = self.wall.columns[0], self.wall.columns[-1]
        for one, other, sign in ((inner, inner, 1), (inner, outer, -1), (outer, inner, -1), (outer, outer, 1)):
            tangent[:, one, other] += sign * own

    def _relax(self, modes: np.ndarray, geometry: ElementGeometry, part: slice, *, transposed: bool = False) -> None:
        """Take off means through the wall, in place: see :data:`MEMBRANE`."""
        means, stretch = self.wall.sampling.means, self.wall.stretch[part]
        blocks = mode_slices(len(means))
        for a, (mode, column) in enumerate(MEMBRANE if self.relaxed else ()):
            shrink = 1.0 - np.sqrt(geometry.relaxation[part, a, None])
            _take_off(modes[:, _every(blocks[mode], mode, column)], means, shrink, transposed=transposed)
        for a, (mode, column) in enumerate(SHEAR):
            taken, given = means * stretch[:, a], 1.0 / stretch[:, a]
            _take_off(modes[:, _every(blocks[mode], mode, column)], taken, given, transposed=transposed)


def _every(block: slice, mode: int, column: int) -> slice:
    """One row of a mode on every surface."""
    return slice(block.start + column, block.stop, len(ROWS[mode]))


def _take_off(rows: np.ndarray, taken: np.ndarray, given: np.ndarray, *, transposed: bool) -> None:
    """Subtract given_t sum_s taken_s x_s from x (e, T, ...), or the transpose."""
    shape = (len(rows), rows.shape[1])
    first, second = (np.broadcast_to(each, shape) for each in ((given, taken) if transposed else (taken, given)))
    mean = np.einsum("et,et...->e...", first, rows)
    rows -= np.einsum("et,e...->et...", second, mean)


OF_E33 = np.cumsum([0, *(len(rows) for rows in ROWS)])[1:] - 1  # E33 is the last row of every mode


def _by_mode(of_surfaces: np.ndarray) -> np.ndarray:
    """(e, 15 T, ...) of (e, T, 15, ...)."""
    n, _T, _, *rest = of_surfaces.shape
    ends = np.cumsum([len(rows) for rows in ROWS])[:-1]
    return np.concatenate([part.reshape(n, -1, *rest) for part in np.split(of_surfaces, ends, axis=2)], axis=1)


def _by_surface(modes: np.ndarray, T: int) -> np.ndarray:
    """(e, T, 15) of (e, 15 T)."""
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

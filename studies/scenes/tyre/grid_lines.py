"""Grid lines of a tyre: equally spaced, finer in a fixed patch, or spaced by an estimate of the error.

Every choice is symmetric about 0 with a node at (0, 0), as the parts of a tyre need it.

The estimate: solve on a coarse grid, estimate, redistribute, and once more. The goal is the contact force. The travel
delta of the foundation drives the tyre, so the force is the derivative of the energy E stored at equilibrium,
F = dE/d delta: its error is the derivative of the error of the energy, and its adjoint is the rate of the
displacements, u' = du/d delta. With the recovery error dE of the strains an element contributes at most 2 |dE| |dE'| in
the norm of D (Cauchy-Schwarz): the dual-weighted estimate of a quadratic energy (Becker, Rannacher, Acta Numerica 10
(2001) 1-102, with the recovered error for the residual). u' is the secant of two travels. Where the rim of the patch
crosses an element, pressure and gap meet; what that costs is added there. The sizes of the passes are averaged: a
coarse grid sees one position of the rim between its lines, the next another.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contact.algorithms.semismooth import Semismooth
from formulations.element.strain_operator import CORNER_MASS
from formulations.geometry.grid import CORNERS, Grid, TensorGrid, graded_lines
from formulations.recovery import energy_products, recovery_errors, refined
from formulations.shell import ShellModel
from formulations.strains.quantities import N_V
from studies.ask.request import Request, Settings
from studies.ask.scene import Setting, UsageError
from studies.scenes.element import MOVED_NODES
from studies.scenes.tyre.model import TyreModel, inflated_shell
from studies.scenes.tyre.parts import base_of, part_of
from studies.scenes.tyre.press import PATH_SETTINGS
from studies.scenes.walk import Visited, walk

GRADINGS = ("patch", "uniform", "adapted")
SPACING = "spacing of the grid lines: finer in the patch, uniform, or by error estimate"
GRADING = Setting.one_of("grading", GRADINGS, "patch", SPACING)
GROWTH = 1.6  # neighbouring elements differ by no more
STEEPEST = 0.99 * float(np.log(GROWTH))  # |dh/dx| of the size, whose exp is the ratio of neighbours; 1 % for sampling
FLOOR = 0.1  # of the mean error density: a coarse grid does not see all that its largest elements miss
FINE = 4000  # samples of a size along a line
COARSE = (20, 20)
PASSES = 2
SECANT = 0.1  # of the travel, for the rate of the displacements
LOOSE = 1e-3  # of the forces: what the estimate of an error leaves is far more
LARGEST = (np.pi / 8, np.pi / 8)  # rad, along psi and phi: what no estimate of a coarse grid may exceed


def tyre_lines(mesh: tuple[int, int], clamp_deg: float, grading: str = "patch") -> tuple[np.ndarray, np.ndarray]:
    """Grid lines psi, phi [rad] of an N x M mesh, "uniform" or "patch", that in the proportions of 42x40.

    psi: 12, 18, 12 elements between -clamp, -0.375 clamp, 0.375 clamp, clamp; phi: 11, 18, 11 between -180, -22.5,
    22.5, 180 degrees. Raises UsageError unless both numbers are even, so that a node lies at (0, 0), and at least 6.
    """
    n1, n2 = checked_mesh(mesh)
    if grading == "uniform":
        return _centred(np.linspace(-clamp_deg, clamp_deg, n1 + 1)), _centred(np.linspace(-180, 180, n2 + 1))
    side1, side2 = round(n1 * 12 / 42), round(n2 * 11 / 40)
    middle = 0.375 * clamp_deg
    psi = graded_lines([-clamp_deg, -middle, middle, clamp_deg], [side1, n1 - 2 * side1, side1])
    phi = graded_lines([-180, -22.5, 22.5, 180], [side2, n2 - 2 * side2, side2])
    return _centred(psi), _centred(phi)


def _centred(lines: np.ndarray) -> np.ndarray:
    """Lines in rad of those in degrees; the middle one is 0 to the last digit, for it is an edge of a quarter."""
    return np.deg2rad(0.5 * (lines - lines[::-1]))


def checked_mesh(mesh: tuple[int, int]) -> tuple[int, int]:
    """The mesh; raises UsageError unless both numbers are even and at least 6."""
    n1, n2 = mesh
    if n1 % 2 or n2 % 2 or min(mesh) < 6:
        raise UsageError(f"mesh {n1}x{n2}: both numbers must be even and at least 6")
    return n1, n2


@dataclass(frozen=True, eq=False)
class LineSize:
    """Wanted element size along one half [0, end] of a line, up to a factor, and what an element size costs.

    at (k,): coordinates from 0 to end; shape (k,): the size there, any unit.  error [N]: C in an error C/n^2 when n
    elements are spaced so over both halves.
    """

    at: np.ndarray
    shape: np.ndarray
    error: float

    @classmethod
    def equidistributing(cls, lines: np.ndarray, errors: np.ndarray) -> LineSize:
        """From the errors (n,) [N] of the elements between lines (n + 1,), symmetric about 0 or from there on.

        An element of the size h with the error density e h^2 costs e h^3: the least sum for a given number of elements
        has h ~ e^(-1/3), and is (int e^(1/3) dx)^3/n^2. The two halves are added, and a kernel of [1, 2, 1] smooths e.
        """
        h = np.diff(lines)
        density = errors / h**3
        if lines[0] < -1e-12:
            density, h = (density + density[::-1])[len(h) // 2 :], h[len(h) // 2 :]
        around = np.concatenate([density[:1], density, density[-1:]])
        density = 0.25 * around[:-2] + 0.5 * density + 0.25 * around[2:]
        floored = np.maximum(density, FLOOR * float(density @ h) / float(np.sum(h)))
        middles = np.cumsum(h) - 0.5 * h
        at = np.linspace(0.0, float(lines[-1]), FINE)
        shape = np.exp(-np.interp(at, middles, np.log(floored)) / 3)
        error = 4 * float(np.trapezoid(1 / shape, at)) ** 2 * float(density @ (h * floored ** (-2 / 3)))
        return cls(at, shape, error)

    @classmethod
    def mean(cls, sizes: Sequence[LineSize]) -> LineSize:
        """Geometric mean: where the rim happens to lie between the lines of one grid averages out."""
        shapes = np.array([size.shape / size.shape.mean() for size in sizes])
        errors = np.array([size.error for size in sizes])
        return cls(sizes[0].at, np.exp(np.log(shapes).mean(axis=0)), float(np.exp(np.log(errors).mean())))

    def lines(self, n: int, largest: float) -> np.ndarray:
        """The n + 1 lines from -end to end; neighbours differ by no more than 1.6, sizes stay below ``largest``.

        The size is the largest below c times the wanted one whose slope stays below STEEPEST; c such that n fit.
        """

        def number(c: float) -> np.ndarray:
            size = _gentle(np.minimum(c * self.shape, largest), self.at)
            steps = 0.5 * (1 / size[1:] + 1 / size[:-1]) * np.diff(self.at)
            return np.append(0.0, np.cumsum(steps))

        low, high = -60.0, 60.0  # of ln c: the number falls with it
        for _ in range(60):  # halves, down to rounding
            middle = 0.5 * (low + high)
            low, high = (middle, high) if number(float(np.exp(middle)))[-1] > n / 2 else (low, middle)
        count = number(float(np.exp(high)))
        half = np.interp(np.linspace(0.0, count[-1], n // 2 + 1), count, self.at)
        half[-1] = self.at[-1]
        return np.concatenate([-half[:0:-1], half])


def _gentle(size: np.ndarray, at: np.ndarray) -> np.ndarray:
    """The largest function below ``size`` (k,) with a slope of at most STEEPEST at the equally spaced points."""
    rise = STEEPEST * (at - at[0])
    forwards = np.minimum.accumulate(size - rise) + rise
    return np.minimum.accumulate((forwards + rise)[::-1])[::-1] - rise


@dataclass(frozen=True, eq=False)
class TyreSizes:
    """Sizes along psi and phi."""

    psi: LineSize
    phi: LineSize

    @classmethod
    def estimated(cls, request: Request) -> TyreSizes:
        """From PASSES coarse solutions at the last travel of the request.

        Raises UsageError when a coarse tyre cannot be pressed so far, or is not pressed at all.
        """
        deltas = request.numbers("delta_mm")
        if deltas == (0.0,):
            raise UsageError(
                "an adapted mesh follows the contact: delta_mm = 0 has none, take grading=patch or uniform"
            )
        # two travels suffice, and nodes are moved only from the lines that are estimated here
        left_out = {setting.key for setting in (*PATH_SETTINGS, *MOVED_NODES)}
        by_travel = Settings({key: value for key, value in request.settings.items() if key not in left_out})
        settings = by_travel.with_values(delta_mm=((1 - SECANT) * deltas[-1], deltas[-1]))
        coarse = replace(request, settings=settings, mesh=COARSE, model=base_of(settings))
        lines = tyre_lines(COARSE, request.number("clamp_deg"))
        estimates: list[TyreSizes] = []
        for _ in range(PASSES):
            estimates.append(cls(*_estimate(coarse, *lines)))
            lines = estimates[-1].lines(estimates[-1].proportioned(COARSE[0] * COARSE[1]))
        return cls(LineSize.mean([f.psi for f in estimates]), LineSize.mean([f.phi for f in estimates]))

    def lines(self, mesh: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
        """Grid lines psi, phi [rad]."""
        return self.psi.lines(mesh[0], LARGEST[0]), self.phi.lines(mesh[1], LARGEST[1])

    def proportioned(self, elements: float) -> tuple[int, int]:
        """The even counts, n1 n2 near ``elements``, of the least error C1/n1^2 + C2/n2^2: n1/n2 = sqrt(C1/C2)."""
        ratio = np.sqrt(self.psi.error / self.phi.error)
        ratio = float(np.clip(ratio, 0.25, 4.0))
        n1, n2 = (max(6, 2 * round(float(n) / 2)) for n in (np.sqrt(elements * ratio), np.sqrt(elements / ratio)))
        return n1, n2


def _estimate(request: Request, psi: np.ndarray, phi: np.ndarray) -> tuple[LineSize, LineSize]:
    """Sizes along psi and phi from the error of the force in each element, summed across the other direction."""
    model = TyreModel.on(request, psi, phi)
    grid, whole = model.part.grid, Grid.tensor(psi, phi, periodic=True)
    assert isinstance(grid, TensorGrid)
    before, state = pressed(request, model)
    rim = 0.5 * (rim_errors(model, before) + rim_errors(model, state))
    sizes = []
    for axis, lines in enumerate(grid.lines):
        finer = part_of(request.model, *(refined(line) if k == axis else line for k, line in enumerate((psi, phi))))
        errors = strain_errors(model, before, state, inflated_shell(request, finer), whole, axis) + rim[:, axis]
        by_line = errors.reshape([len(each) - 1 for each in grid.lines]).sum(axis=1 - axis)
        sizes.append(LineSize.equidistributing(lines, model.part.copies * by_line))
    return sizes[0], sizes[1]


def strain_errors(
    model: TyreModel, before: Visited, state: Visited, finer: ShellModel, whole: TensorGrid, axis: int
) -> np.ndarray:
    """(E,) [N]: what the size of each element along one coordinate adds to the error of the force, 2 |dE| |dE'|."""
    part, shell = model.part, model.shell
    signs = part.sign[:, ::-1]  # of a1, a2, normal, which are z, y, x at the crown

    def error(at: Visited) -> np.ndarray:
        v = part.view @ shell.nodal_displacements(at.state.u)
        v[:, :N_V] *= np.repeat(signs, 2, axis=1)  # of both faces
        v[:, N_V:] *= np.tile(signs, (v.shape[1] - N_V) // 3)  # of surfaces between them
        return recovery_errors(shell, at.state.u, finer, axis, (whole, v))

    dE, dE_before = error(state), error(before)
    return 2 * energy_products(model.shell, dE, (dE - dE_before) / (state.point.requested - before.point.requested))


def rim_errors(model: TyreModel, state: Visited) -> np.ndarray:
    """(E, 2) [N]: w = int p g dA of an element is lost or won each time the rim passes one more line of nodes.

    The rim a moves by a' = a/(2 delta), as that of a parabola cut by a plane does, past a'/h lines per travel: w a'/h,
    split by how much the gap changes along a1 and a2 inside the element.
    """
    grid, geometry = model.shell.discretisation.grid, model.shell.discretisation.geometry
    merged, pressure, gap = model.part.merging(), model.outer_pressure(state.state), np.zeros(grid.n_nodes)
    gap[model.nodes] = state.problem.gap(state.state.u)
    p, g = pressure[grid.elements], gap[merged][grid.elements]
    w = np.maximum(geometry.weight * np.einsum("er,rs,es->e", p, CORNER_MASS, g), 0.0)
    slope = np.stack([(g @ CORNERS[:, a]) ** 2 for a in (0, 1)], axis=-1)
    share = slope / np.maximum(slope.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    rim = np.max(np.abs(grid.nodes[merged][np.flatnonzero(pressure > 0)]), axis=0, initial=0.0)
    return w[:, None] * share * rim / (2 * state.point.requested) / (2 * grid.half)


def pressed(request: Request, model: TyreModel) -> list[Visited]:
    """The states at the travels of the request; raises UsageError when one is not reached."""
    algorithm = Semismooth(epsilon=request.number("epsilon"), tolerance=LOOSE, solver=request.choice("solver"))
    visited = list(walk(model.stages(), algorithm, request.steps))
    last = visited[-1]
    if not last.converged:
        raise UsageError(f"grading 'adapted': the path of the coarse tyre stops at {last.point.reached:g}")
    return [each for each in visited if each.stage is last.stage]

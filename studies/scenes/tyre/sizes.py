"""Element sizes of a tyre that follow the need: solve on a coarse grid, estimate, redistribute, and once more.

The goal is the contact force. The travel delta of the foundation drives the tyre, so the force is the derivative of
the energy E stored at equilibrium, F = dE/d delta: its error is the derivative of the error of the energy, and its
adjoint is the rate of the displacements, u' = du/d delta. With the recovery error dE of the strains an element
contributes at most 2 |dE| |dE'| in the norm of D (Cauchy-Schwarz): the dual-weighted estimate of a quadratic energy
(Becker, Rannacher, Acta Numerica 10 (2001) 1-102, with the recovered error for the residual). u' is the secant of two
travels. Where the rim of the patch crosses an element, pressure and gap meet; what that costs is added there.
The sizes of the passes are averaged: a coarse grid sees one position of the rim between its lines, the next another.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contact.algorithms.semismooth import Semismooth
from formulations.element.strain_operator import CORNER_MASS
from formulations.geometry.grid import CORNERS
from formulations.recovery import energy_products, recovery_errors, refined
from studies.ask.request import Request, Settings
from studies.ask.scene import UsageError
from studies.scenes.tyre import press_path
from studies.scenes.tyre.grid_lines import LineSize, tyre_lines
from studies.scenes.tyre.model import TyreModel
from studies.scenes.walk import Visited, walk

COARSE = (20, 20)
PASSES = 2
SECANT = 0.1  # of the travel, for the rate of the displacements
LARGEST = (np.pi / 8, np.pi / 8)  # rad, along psi and phi: what no estimate of a coarse grid may exceed


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
        by_arc = {setting.key for setting in press_path.SETTINGS}  # two travels are all that is wanted of the path
        by_travel = Settings({key: value for key, value in request.settings.items() if key not in by_arc})
        settings = by_travel.with_values(delta_mm=((1 - SECANT) * deltas[-1], deltas[-1]))
        coarse = replace(request, settings=settings, mesh=COARSE, model="full")
        lines = tyre_lines(COARSE, request.number("clamp_deg"))
        found: list[TyreSizes] = []
        for _ in range(PASSES):
            found.append(cls(*_estimate(coarse, *lines)))
            lines = found[-1].lines(found[-1].proportioned(COARSE[0] * COARSE[1]))
        return cls(LineSize.mean([f.psi for f in found]), LineSize.mean([f.phi for f in found]))

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
    before, state = pressed(request, model)
    finer = (TyreModel.on(request, refined(psi), phi), TyreModel.on(request, psi, refined(phi)))
    rim = 0.5 * (rim_errors(model, before) + rim_errors(model, state))
    shape = (len(psi) - 1, len(phi) - 1)
    found = []
    for axis, lines in enumerate((psi, phi)):
        errors = strain_errors(model, before, state, finer[axis], axis) + rim[:, axis]
        found.append(LineSize.equidistributing(lines, errors.reshape(shape).sum(axis=1 - axis)))
    return found[0], found[1]


def strain_errors(model: TyreModel, before: Visited, state: Visited, finer: TyreModel, axis: int) -> np.ndarray:
    """(E,) [N]: what the size of each element along one coordinate adds to the error of the force, 2 |dE| |dE'|."""
    dE, dE_before = (recovery_errors(model.shell, at.state.u, finer.shell, axis) for at in (state, before))
    return 2 * energy_products(model.shell, dE, (dE - dE_before) / (state.point.requested - before.point.requested))


def rim_errors(model: TyreModel, state: Visited) -> np.ndarray:
    """(E, 2) [N]: w = int p g dA of an element is lost or won each time the rim passes one more line of nodes.

    The rim a moves by a' = a/(2 delta), as that of a parabola cut by a plane does, past a'/h lines per travel: w a'/h,
    split by how much the gap changes along a1 and a2 inside the element.
    """
    grid, geometry = model.shell.discretisation.grid, model.shell.discretisation.geometry
    own, pressure, gap = model.part.merging(), model.outer_pressure(state.state), np.zeros(grid.n_nodes)
    gap[model.nodes] = state.problem.gap(state.state.u)
    p, g = pressure[grid.elements], gap[own][grid.elements]
    w = np.maximum(geometry.weight * np.einsum("er,rs,es->e", p, CORNER_MASS, g), 0.0)
    slope = np.stack([(g @ CORNERS[:, a]) ** 2 for a in (0, 1)], axis=-1)
    share = slope / np.maximum(slope.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    rim = np.max(np.abs(grid.nodes[own][np.flatnonzero(pressure > 0)]), axis=0, initial=0.0)
    return w[:, None] * share * rim / (2 * state.point.requested) / (2 * grid.half)


def pressed(request: Request, model: TyreModel) -> list[Visited]:
    """The states at the travels of the request; raises UsageError when one is not reached."""
    algorithm = Semismooth(
        epsilon=request.number("epsilon"), tolerance=request.number("tolerance"), solver=request.choice("solver")
    )
    visited = list(walk(model.stages(), algorithm, request.steps))
    last = visited[-1]
    if not last.converged:
        raise UsageError(f"grading 'adapted': the coarse tyre is not pressed beyond {last.point.reached:g}")
    return [each for each in visited if each.stage is last.stage]

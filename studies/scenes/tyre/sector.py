"""A sector |phi| <= cut of a tyre: its lines, what it may be cut to, and what the cut changes.

The sector ends with the seam of a half tyre, moved from phi = pi to the cut: a tyre with its contact again every 2 cut.
What the contact has changed, d = u - u_inflated, decays along phi, in waves; it travels to the cut and back before the
force feels it, so the error of the force is of second order in the amplitude there. On a line of stiffness
k0 tanh(kappa cut) instead of k0 the energy changes by the order of what lies beyond the cut when the amplitude there,
with the energy e per angle, goes on to decay::

    W = copies e(cut)/rate,    |dF|/F = |dW/d delta|/F <= SAFETY 4 W/(F delta)

with W growing no faster than delta^4: it is of second order in a force that grows less than as delta^2. A rate fitted
to waves is arbitrary; DECAY/cut is taken instead, the mean rate measured on the tyres of the tests, and twice the sum.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from contact.problem import ContactProblem, ContactSolution
from formulations.shell import ShellModel
from studies.ask.request import Request, Settings
from studies.ask.scene import Begun, Observation, Setting, Stage, UsageError
from studies.scenes.tyre.parts import Part

SECTOR = Setting.positive(
    "sector_deg", None, "cut angle of the model sector", 180, open_high=True, otherwise="sector 90"
)
DEFAULT_DEG = 90.0
NEAR = 0.9  # of the cut: the energy of the elements from there on stands for that at the cut
DECAY = 8.0  # e-folds of the energy from the contact to the cut
SAFETY = 2.0


def settle_sector(model: str, settings: Settings) -> Settings:
    """The settings with the cut of a sector; raises UsageError for a cut without a sector."""
    if model == "sector":
        return settings.with_values(sector_deg=settings.get("sector_deg", DEFAULT_DEG))
    if "sector_deg" in settings:
        raise UsageError(f"sector_deg needs --model sector, got {model}")
    return settings


def cut_of(request: Request) -> float:
    """The cut [rad]."""
    return float(np.deg2rad(request.number("sector_deg")))


def with_line_at(phi: np.ndarray, cut: float) -> np.ndarray:
    """The lines phi (n,), symmetric about 0, the nearest ones moved to +-cut.

    Raises UsageError when fewer than two elements lie on each side of the contact.
    """
    half = phi[len(phi) // 2 :].copy()
    nearest = int(np.argmin(np.abs(half[:-1] - cut)))
    if nearest < 2:
        raise UsageError(f"sector_deg = {np.rad2deg(cut):g} leaves fewer than two elements on a side: refine the mesh")
    half[nearest] = cut
    return np.concatenate([-half[:0:-1], half])


def within(phi: np.ndarray, cut: float) -> np.ndarray:
    """The lines with |phi| <= cut."""
    return phi[np.abs(phi) <= cut * (1 + 1e-12)]


def check_reach(cut: float, radius: float, delta: float) -> None:
    """Raise UsageError when a plane cuts so deep into the circle of this radius [mm] that it meets the cut."""
    reach = float(np.arccos(max(1.0 - delta / radius, -1.0)))
    if cut <= reach:
        raise UsageError(
            f"sector_deg = {np.rad2deg(cut):g} must be above {np.rad2deg(reach):.3g}: "
            f"the patch at delta_mm = {delta:g} may reach it"
        )


def check_patch(part: Part, active: np.ndarray) -> None:
    """Raise UsageError when a node (N,) of the part in contact lies in the last element before the cut."""
    phi = np.unique(part.grid.nodes[:, 1])
    if np.any(active & (part.grid.nodes[:, 1] > phi[-3] + 1e-9)):
        raise UsageError(f"sector_deg = {np.rad2deg(part.cut):g} is too small: the patch reaches the cut")


def sector_stage(
    stage: Stage, shell: ShellModel, part: Part, pressure: Callable[[ContactSolution], np.ndarray]
) -> Stage:
    """The stage that presses a tyre, with the error of the cut beside the force; pressure (N,) of a solution."""
    inflated: list[np.ndarray] = []

    def begin(previous: ContactSolution | None) -> Begun:
        problem_at, start = stage.begin(previous)
        inflated[:] = [start.u]
        return problem_at, start

    def observe(problem: ContactProblem, state: ContactSolution, delta: float) -> Observation:
        check_patch(part, pressure(state) > 0)
        observation = stage.observe(problem, state, delta)
        estimate = truncation_estimate(shell, part, inflated[0], state.u, delta, observation.quantities["force_N"])
        truncation = {"truncation_estimate": estimate}
        return replace(
            observation, quantities=observation.quantities | truncation, step={**(observation.step or {}), **truncation}
        )

    return replace(stage, begin=begin, observe=observe)


def truncation_estimate(
    shell: ShellModel, part: Part, inflated: np.ndarray, u: np.ndarray, delta: float, force: float
) -> float:
    """Relative error of the force [-] that the cut makes, estimated to be a bound."""
    phi, density = disturbance(shell, part, u - inflated, inflated)
    at_cut = float(np.mean(density[phi >= min(NEAR * part.cut, phi[-1])]))
    return SAFETY * 4.0 * part.copies * at_cut * part.cut / DECAY / (abs(force) * delta)


def disturbance(shell: ShellModel, part: Part, d: np.ndarray, inflated: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middles [rad] of the columns of elements, and the energy 1/2 d K d of d [N mm] in each over its width.

    K: tangent of the inflated shell, its tension included.
    """
    tangent = shell.element_contributions(inflated, None)[2]
    v = shell.discretisation.of_elements(d)
    energy = 0.5 * np.einsum("ei,eij,ej->e", v, tangent, v)
    grid = part.grid
    middles, column = np.unique(np.round(grid.centre[:, 1], 12), return_inverse=True)
    widths = 2 * grid.half[np.unique(column, return_index=True)[1], 1]
    sums = np.abs(np.bincount(column, weights=energy)) / widths
    return middles, sums

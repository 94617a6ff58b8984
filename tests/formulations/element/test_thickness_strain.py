"""The moment of one thin element whose directors turn, to the third order of the angle: what each share of E33 costs.

Derived for a thin strip. Directors have the length L at the nodes and turn by phi on top of the angle phi0 at rest;
interpolated linearly they are shorter between the nodes, L^2 (1 - sin^2(angle/2) (1 - xi^2)), where ``angle`` is phi
for components in the rotating frame (curvilinear) and phi0 + phi for Cartesian ones (isoparametric). The mean of E33
vanishes: L^2 = 1 + (1 - s)/6 phi^2, or (1 - s)/6 ((phi0 + phi)^2 - phi0^2). The change of curvature is
2 L sin(phi/2) + phi0 (L cos(phi/2) - 1), or (2 L sin((phi0 + phi)/2) - 2 sin(phi0/2)) times the chord over the arc; the
moment is D/2l times the derivative of its square.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.element.mixed import THICKNESS_STRAINS
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate, cylinder
from formulations.loads.pressure import Couples
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from support.problems.shells import newton

E, H = 1e6, 1e-3  # MPa, mm; nu = 0, the element is 1 mm long
MOMENTS = np.array([-0.3, -0.2, -0.1, 0.1, 0.2, 0.3])  # M l/D
HIGHER = 1e-3  # of a coefficient: the next ones are of the order phi0^2


def turned(moment: float, phi0: float, interpolation: str, thickness_strain: str) -> float:
    """The angle phi by which end couples bend one element further; phi0 = 0: a plate."""
    side = phi0 or 1.0
    grid = Grid.tensor(np.array([0.0, 1.0]), np.array([0.0, side]))
    start, end = grid.on_line(1, 0.0), grid.on_line(1, side)
    supports = Supports.none(grid).hold(np.arange(4), (0,)).symmetric(start, 1).hinged(start, (2,))
    surface, strip = cylinder(1 / phi0) if phi0 else Plate(), Laminate.single(Ply.isotropic(E, 0.0, H))
    shell = Discretisation.build(surface, grid, strip, *supports.masks, interpolation=interpolation)
    couples = Couples(end, np.full(2, moment * E * H**3 / 24), np.tile([-1.0, 0.0, 0.0], (2, 1)), H)
    model = ShellModel(
        shell, MEASURES["exact"], newton="mixed", couples=couples, thickness_strain=thickness_strain, membrane="relaxed"
    )
    u = np.zeros(shell.n_free)
    for part in (0.5, 1.0):
        u = newton(model.scaled(part), u, within=1e-11)
    v = shell.expand(u)[end[0]]
    return math.atan2((v[3] - v[2]) / H, 1 + (v[5] - v[4]) / H)


@pytest.mark.parametrize("thickness_strain", THICKNESS_STRAINS)
@pytest.mark.parametrize("phi0", [0.0, 0.1])
@pytest.mark.parametrize("interpolation", ["curvilinear", "isoparametric"])
def test_moment_of_an_element_to_the_third_order(interpolation, phi0, thickness_strain) -> None:
    """Half at the nodes is what cancels phi^3, in flat and in curved elements."""
    s = THICKNESS_STRAINS[thickness_strain]
    phi = np.array([turned(moment, phi0, interpolation, thickness_strain) for moment in MOMENTS])
    sign = np.sign(phi @ MOMENTS)  # of the sense of the couples
    found = np.linalg.lstsq(np.stack([phi**k for k in range(1, 6)], axis=1), sign * MOMENTS, rcond=None)[0][:3]
    if interpolation == "curvilinear":
        expected = [1.0, -(1 + 2 * s) / 8 * phi0, 1 / 6 - s / 3]
    else:
        expected = [1 - s / 3 * phi0**2, 3 / 8 * (1 - 2 * s) * phi0, 1 / 6 - s / 3]
    assert found == pytest.approx(expected, abs=HIGHER)
    assert abs(found[2]) <= HIGHER or thickness_strain != "balanced"

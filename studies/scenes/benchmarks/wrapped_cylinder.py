"""NAFEMS R0031/2: a thick cylinder wrapped with hoop windings, under inner pressure; Lamé's solution for its layers.

A metal liner from 23 to 25 mm, windings from 25 to 27 mm whose fibres run around; 200 MPa inside. Layers without stress
along the axis, those of a slice, have 1564.5, 1429.0, 880.5 and 756.3 MPa of hoop stress from inside to outside; the
benchmark prints 1565.3, 1429.7, 874.7 and 759.1. Between fixed ends a long cylinder has no strain along the axis
instead. Both are of small displacements: at 200 MPa measures of large ones differ by up to 1.2 %. Nothing varies around
or along: all that a shell can miss is the wall.
"""

from collections.abc import Mapping

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.loads.pressure import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.ask.scene import SOLVER, Declared, Reference, Request, SceneModel, Setting
from studies.scenes.closed_forms.thick_walls import Layer, layered_tube
from studies.scenes.data import references
from studies.scenes.element import of_wall, patch
from studies.scenes.statics import LOAD_FRACTION, StaticModel

INNER, BETWEEN, OUTER, PRESSURE = 23.0, 25.0, 27.0, 200.0  # mm, MPa
LINER = Ply.isotropic(2.1e5, 0.3, BETWEEN - INNER)
WINDINGS = Ply(1.3e5, 5e3, 1e4, 2e3, 0.25, 0.25, np.pi / 2, OUTER - BETWEEN)  # shears are not printed, nor needed
SECTOR = np.pi / 18
ENDS = {"free": 0.02, "fixed": 2.0}  # mm: length of the slice; much shorter than the wall is thick, or any
PLACES = ("inside", "liner", "windings", "outside")
HOOP: Mapping[str, str] = {
    "hoop_inside_MPa": "hoop stress at 23 mm",
    "hoop_liner_MPa": "hoop stress at 25 mm, in the liner",
    "hoop_windings_MPa": "hoop stress at 25 mm, in the windings",
    "hoop_outside_MPa": "hoop stress at 27 mm",
}
NAFEMS = "NAFEMS R0031 (1995), test 2, in a vendor's verification manual"
PRINTED = (1565.3, 1429.7, 874.7, 759.1)


def lame(ends: str) -> dict[str, float]:
    """The hoop stresses of the layers by closed form."""
    layers = []
    for ply, radius in ((LINER, BETWEEN), (WINDINGS, OUTER)):
        C = ply.stiffness()
        layers.append(Layer(C if ends == "fixed" else C - np.outer(C[:, 0], C[0]) / C[0, 0], radius))
    sides = layered_tube(layers, INNER, PRESSURE)
    return dict(zip(HOOP, np.ravel(sides).tolist(), strict=True))


def _references() -> tuple[Reference, ...]:
    exact = [({"ends": ends, "measure": "linear"}, lame(ends)) for ends in ENDS]
    printed = [({"ends": "free", "measure": "linear"}, dict(zip(HOOP, PRINTED, strict=True)))]
    return references("exact", "Lamé's equations for orthotropic layers", 1e-6, exact) + references(
        "read", NAFEMS, 0.01, printed
    )


class WrappedCylinder(Declared):
    """A sector of a slice; a1 along the axis."""

    name = "wrapped-cylinder"
    title = "Wrapped thick cylinder under inner pressure (NAFEMS R0031/2)"
    default_mesh = (1, 4)
    settings = (
        LOAD_FRACTION,
        Setting.one_of("ends", ENDS, "free", "along the axis: a slice without stress, or a length without strain"),
        *of_wall("3/ply", "svk"),
        SOLVER,
    )
    references = _references()
    quantities = HOOP

    def build(self, request: Request) -> SceneModel:
        """Pressure on the true inner face."""
        laminate = Laminate((LINER, WINDINGS), INNER - BETWEEN)
        end = "free" if request.choice("ends") == "free" else "symmetric"
        span = (0.0, ENDS[request.choice("ends")])
        edges = ("symmetric", end, "symmetric", "symmetric")
        sector = patch(request, cylinder(BETWEEN), span, (0.0, SECTOR), laminate, edges)
        return StaticModel.of(request, sector, _hoop, pressure=Pressure(PRESSURE, area="face"))


def _hoop(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
    """Means over all elements, which are alike."""
    liner, windings = shell.ply_stresses(u).mean(axis=0)  # (side, along and across the fibres)
    return dict(zip(HOOP, map(float, (*liner[:, 1], *windings[:, 0])), strict=True))


SCENES = (WrappedCylinder(),)

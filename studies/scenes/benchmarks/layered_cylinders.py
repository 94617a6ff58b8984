"""Layered cylinders under inner pressure against elasticity: a cross-ply one in waves, and a thick wrapped one."""

from collections.abc import Mapping

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.loads import Pressure
from formulations.section.laminate import SURFACES, Laminate, Ply
from formulations.shell import ShellModel
from formulations.wall_stresses import S13, S23, WallStresses
from studies.ask.scene import SOLVER, Declared, Reference, Request, SceneModel, Setting
from studies.scenes.benchmarks.pagano import DEFLECTION, E_L, E_T, G_LT, G_TT, NU, H
from studies.scenes.closed_forms.elasticity import Layer, layered_tube, through_wall
from studies.scenes.data import references
from studies.scenes.element import of_wall, patch
from studies.scenes.statics import LOAD_FRACTION, StaticModel, area_load, elements_at, loaded_shell

LENGTH, WAVES = 4.0, 4  # over the radius, and around
PLIES = tuple(Ply(E_L, E_T, G_LT, G_TT, NU, NU, angle, H / 3) for angle in (np.pi / 2, 0.0, np.pi / 2))
RATIOS = 2.0, 4.0, 10.0, 50.0, 100.0, 500.0
NAMES = ("w_bar", "sigma_theta_inner_bar", "sigma_theta_outer_bar", "tau_xz_bar", "tau_thetaz_bar")


def exact(S: float) -> dict[str, float]:
    """The elasticity solution."""
    R = S * H
    sides = through_wall(PLIES, np.pi / (LENGTH * R), WAVES / R, (-1.0, 0.0), 1 / R)
    (inner, *_), (_, middle, _), (*_, outer) = sides
    return _normalised(S, 1.0, middle[2], inner[7], outer[7], middle[4], middle[5])


def _normalised(S: float, p0: float, w: float, *stresses: float) -> dict[str, float]:
    """w and the hoop stresses inside and outside; then the shears across the wall, if there are any."""
    unit = np.array([E_L / (H * S**4), S**-2, S**-2, 1 / S, 1 / S])[: 1 + len(stresses)]
    return dict(zip(NAMES, map(float, 10 / p0 * unit * [w, *stresses]), strict=False))


class LaminatedCylinder(Declared):
    """Varadan and Bhaskar's cross-ply cylinder [90/0/90], simply supported, under sinusoidal pressure inside.

    The reference is three-dimensional and valid for every ratio S = R/h of radius to thickness. The equations are
    solved layer by layer with the local curvature, see :func:`studies.scenes.closed_forms.elasticity.through_wall`.
    They agree with the printed deflections (recalled) to the last digit. As for Pagano's plate, two faces are too stiff
    where shear counts. Three surfaces per ply suffice from S = 10 on; at S = 2, with four, errors of 0.4 % in the
    deflection and 4 % in the stresses remain.

    An eighth of a wave: a1 = x from a support to the middle, a2 from a nodal line to a crest.
    """

    name = "laminated-cylinder"
    title = "Cross-ply cylinder under sinusoidal pressure inside (Varadan, Bhaskar 1991)"
    default_mesh = (16, 16)
    settings = (
        Setting("S", 10.0, "radius of the middle surface over thickness, R/h", low=1, high=1000),
        *of_wall("3/ply", "svk", SURFACES),
        SOLVER,
    )
    references = references("exact", "elasticity from ply to ply", 1e-5, [({"S": S}, exact(S)) for S in RATIOS])
    quantities = {
        "w_bar": "10 E_L w/(p0 h S^4), w of the middle surface on a crest in the middle of the cylinder",
        "sigma_theta_inner_bar": "10 sigma_theta/(p0 S^2) on the inner face there",
        "sigma_theta_outer_bar": "10 sigma_theta/(p0 S^2) on the outer face there",
        "tau_xz_bar": "10 tau_xz/(p0 S) on the middle surface, on a crest at a support",
        "tau_thetaz_bar": "10 tau_thetaz/(p0 S) on the middle surface, on a line at rest in the middle of the cylinder",
        "tau_xz_bar_equilibrium": "the same by equilibrium, with surfaces inside the wall",
        "tau_thetaz_bar_equilibrium": "the same by equilibrium, with surfaces inside the wall",
    }

    def build(self, request: Request) -> SceneModel:
        """p0 sin(pi x/L) sin(4 theta) acts on the true inner face; the ends cannot move in their planes."""
        S = request.number("S")
        R, laminate = S * H, Laminate(PLIES, -H / 2)
        ends = (0.0, LENGTH * R / 2), (0.0, np.pi / (2 * WAVES))
        edges = ("end-of-solid", "symmetric", "end-of-solid", "symmetric")
        piece = patch(request, cylinder(R), *ends, laminate, edges)
        p0 = 10 * E_L * DEFLECTION / S**4

        def pressure(x: np.ndarray, theta: np.ndarray) -> np.ndarray:
            size = p0 * (1 - 0.5 / S) * np.sin(np.pi * x / (LENGTH * R)) * np.sin(WAVES * theta)
            return size[..., None] * np.stack([np.cos(theta), np.sin(theta), np.zeros_like(theta)], axis=-1)

        shell = loaded_shell(piece, request, forces=area_load(piece, pressure, shares=(1.0, 0.0)))
        return StaticModel(shell, (1.0,), lambda shell, u: _read_waves(shell, u, S, p0))


def _read_waves(shell: ShellModel, u: np.ndarray, S: float, p0: float) -> dict[str, float]:
    """Means over the elements at the corners."""
    grid = shell.discretisation.grid
    (x0, rest), (middle, crest) = grid.nodes.min(axis=0), grid.nodes.max(axis=0)
    on_crest, at_support, at_rest = (elements_at(grid, *at)[0] for at in ((middle, crest), (x0, crest), (middle, rest)))
    hoop = shell.ply_stresses(u)[on_crest, :, :, 0]
    w = shell.discretisation.at_distance(u, 0.0)[grid.node_at(middle, crest), 2]
    if shell.discretisation.wall is None:
        return _normalised(S, p0, w, hoop[0, 0], hoop[-1, 1])
    stresses = WallStresses.of(shell, u)
    d = len(stresses.d) // 2
    law = stresses.law[at_support, d, S13], stresses.law[at_rest, d, S23]
    readings = _normalised(S, p0, w, hoop[0, 0], hoop[-1, 1], *law)
    names = (f"{name}_equilibrium" for name in NAMES[3:])
    balanced = stresses.equilibrium[at_support, d, 0], stresses.equilibrium[at_rest, d, 1]
    return readings | {name: float(10 * tau / (p0 * S)) for name, tau in zip(names, balanced, strict=True)}


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
    """NAFEMS R0031/2: a thick cylinder wrapped with hoop windings, under inner pressure; Lamé's solution for its
    layers.

    A metal liner reaches from 23 to 25 mm, windings with hoop fibres from 25 to 27 mm; the pressure inside is 200 MPa.
    In a slice, whose layers have no axial stress, the hoop stresses from inside to outside are 1564.5, 1429.0, 880.5
    and 756.3 MPa; the benchmark prints 1565.3, 1429.7, 874.7 and 759.1. A long cylinder between fixed ends has no axial
    strain instead. Both solutions are for small displacements: at 200 MPa measures of large ones differ by up to 1.2 %.
    Nothing varies around or along, so a shell can err only in the variation through the wall.

    A sector of a slice; a1 along the axis.
    """

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
        """The pressure acts on the true inner face."""
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


SCENES = (
    WrappedCylinder(),
    LaminatedCylinder(),
)

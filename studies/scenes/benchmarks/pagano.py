"""Pagano's cross-ply plate [0/90/0], simply supported, under a sinusoidal pressure: the elasticity solution.

The reference is three-dimensional and valid for every span-to-thickness ratio S = a/h. A shell of two faces has one
director and no shear correction. Its shear strain is constant through plies whose shear moduli differ by a factor of
2.5, so it is stiffer than the plate, the more so the thicker the plate. sigma_x follows from the strain and S33 of the
section's law, the transverse shear stresses from the equilibrium of each ply, since a constant shear strain carries no
local shear stress. With surfaces inside the wall all stresses follow from the law; the shear stresses are also given by
equilibrium.
"""

import numpy as np

from formulations.geometry.surfaces import Plate
from formulations.section.laminate import BETWEEN_FACES, Laminate, Ply
from formulations.shell import ShellModel
from formulations.wall_stresses import S11, S13, S23, WallStresses
from studies.ask.declarations import LINEAR, Ladder, ShellLimit, meshes
from studies.ask.scene import Declared, Reference, Request, SceneModel, Setting, UsageError
from studies.scenes.data import Row, reference_rows, references
from studies.scenes.element import centred_laminate, patch, surfaces_of
from studies.scenes.statics import SHELL_SETTINGS, StaticModel, area_load, elements_at, loaded_shell

# MPa; nu_LT = nu_TT. Recalled (Pagano's usual graphite-epoxy); the tests rebuild his table from them to its last digit
E_L, E_T, G_LT, G_TT, NU = 25.0, 1.0, 0.5, 0.2, 0.25
ANGLES = (0.0, np.pi / 2, 0.0)
H = 1.0  # mm
DEFLECTION = 1e-6  # w/(h w_bar): the load that gives it is small enough for every measure to be linear

SQUARE = {  # b = a: S: (w, sigma_x, tau_xz, tau_yz)
    4.0: (2.005911, 0.800840, 0.255902, 0.217181),
    10.0: (0.753030, 0.590592, 0.357305, 0.122753),
    20.0: (0.516388, 0.552389, 0.384602, 0.093771),
    100.0: (0.434722, 0.539255, 0.394686, 0.082819),
}

COLUMNS = {"wbar": "w_bar", "sigma_x": "sigma_x_bar", "tau_xz": "tau_xz_bar", "tau_yz": "tau_yz_bar"}


def cross_plies(ratio: float = E_L / E_T) -> tuple[Ply, ...]:
    """From the bottom to the top, with E_L = ``ratio`` E_T."""
    return tuple(Ply(ratio * E_T, E_T, G_LT, G_TT, NU, NU, angle, H / len(ANGLES)) for angle in ANGLES)


def _references() -> tuple[Reference, ...]:
    source = "Pagano, J. Compos. Mater. 4 (1970) 20, table 2, in the helper notebook of the package panels"
    rows: list[Row] = [
        (
            {"S": row["S"], "E_ratio": E_L / E_T, "aspect": 3.0},
            {quantity: row[column] for column, quantity in COLUMNS.items()},
        )
        for row in reference_rows("pagano1970_sandwich_and_crossply.csv")
    ]
    square: list[Row] = [
        ({"S": S, "E_ratio": E_L / E_T, "aspect": 1.0}, dict(zip(COLUMNS.values(), values, strict=True)))
        for S, values in SQUARE.items()
    ]
    layerwise = "polynomials of each ply in a Fourier mode, which meet the table of Pagano (1970)"
    return references("read", source, 5e-3, rows) + references("computed", layerwise, 1e-5, square)


class Pagano(Declared):
    """A quarter: a1 = x in [0, a/2], a2 = y in [0, b/2]; the pressure acts on the outer face along +z."""

    name = "pagano"
    title = "Simply supported cross-ply plate under a sinusoidal pressure (Pagano 1970)"
    default_mesh = (16, 16)
    settings = (
        Setting("S", 100.0, "span over thickness, a/h", low=2, high=1000),
        Setting("aspect", 3.0, "width over span, b/a", low=0.1, high=10),
        Setting("E_ratio", E_L / E_T, "modulus along the fibres over that across them, 1 MPa", low=1, high=1e9),
        *SHELL_SETTINGS,
    )
    references = _references()
    quantities = {
        "w_bar": "100 E_T w/(q0 h S^4), w at the middle of the plate",
        "sigma_x_bar": "sigma_x/(q0 S^2) on the upper face at the middle of the plate",
        "tau_xz_bar": "tau_xz/(q0 S) in the middle plane at x = 0, y = b/2",
        "tau_yz_bar": "tau_yz/(q0 S) in the middle plane at x = a/2, y = 0",
        "tau_xz_bar_equilibrium": "the same by equilibrium, with surfaces inside the wall",
        "tau_yz_bar_equilibrium": "the same by equilibrium, with surfaces inside the wall",
    }
    ladders = tuple(
        Ladder(LINEAR, meshes(8, 8), ("w_bar", "sigma_x_bar"), "linear", {"S": S}, name=f"pagano-S{S}")
        for S in ("10", "100")
    )
    shell_limit = ShellLimit("cross-ply plate", lambda settings: 1 / settings.number("S"))

    def build(self, request: Request) -> SceneModel:
        """q0 sin(pi x/a) sin(pi y/b) acts on the outer face; the edges x = 0 and y = 0 cannot move in their planes.

        A wall of two faces is held there at its middle surface. Raises UsageError for moved nodes with surfaces inside
        it.
        """
        S = request.number("S")
        a, b = S * H, request.number("aspect") * S * H
        plies = cross_plies(request.number("E_ratio"))
        inside = surfaces_of(request) != BETWEEN_FACES
        if inside and request.settings.get("distort"):
            raise UsageError("distort: stresses by equilibrium through the wall need undistorted grid lines")
        edge = "end-of-solid" if inside else "hard-diaphragm"
        edges = (edge, "symmetric", edge, "symmetric")
        quarter = patch(request, Plate(), (0, a / 2), (0, b / 2), centred_laminate(request, *plies), edges)
        q0 = 100 * E_T * DEFLECTION / S**4

        def pressure(x: np.ndarray, y: np.ndarray) -> np.ndarray:
            return q0 * (np.sin(np.pi * x / a) * np.sin(np.pi * y / b))[..., None] * [0.0, 0.0, 1.0]

        shell = loaded_shell(quarter, request, forces=area_load(quarter, pressure, shares=(0.0, 1.0)))
        read = _normalised if shell.discretisation.wall is None else _through_the_wall
        return StaticModel(shell, (1.0,), lambda shell, u: read(shell, u, S, q0))


def _through_the_wall(shell: ShellModel, u: np.ndarray, S: float, q0: float) -> dict[str, float]:
    """Pagano's numbers by the law of surfaces inside the wall, and the shears by equilibrium."""
    grid = shell.discretisation.grid
    (x0, y0), (x1, y1) = grid.nodes.min(axis=0), grid.nodes.max(axis=0)
    corners = [grid.node_at(*point) for point in ((x1, y1), (x0, y1), (x1, y0))]
    at_centre, at_x0, at_y0 = (elements_at(grid, *grid.nodes[corner])[0] for corner in corners)
    stresses = WallStresses.of(shell, u)
    middle = len(stresses.d) // 2
    shears = {
        "tau_xz_bar": stresses.law[at_x0, middle, S13],
        "tau_yz_bar": stresses.law[at_y0, middle, S23],
        "tau_xz_bar_equilibrium": stresses.equilibrium[at_x0, middle, 0],
        "tau_yz_bar_equilibrium": stresses.equilibrium[at_y0, middle, 1],
    }
    w = shell.discretisation.at_distance(u, 0.0)[corners[0], 2]
    return {
        "w_bar": float(100 * E_T * w / (q0 * H * S**4)),
        "sigma_x_bar": float(stresses.law[at_centre, -1, S11] / (q0 * S**2)),
        **{name: float(tau / (q0 * S)) for name, tau in shears.items()},
    }


def _normalised(shell: ShellModel, u: np.ndarray, S: float, q0: float) -> dict[str, float]:
    """Pagano's numbers: w_bar = 100 E_T w/(q0 h S^4), sigma_x/(q0 S^2), tau_xz/(q0 S), tau_yz/(q0 S).

    The derivatives at an edge are those between the mean of its last element and the zero on the edge itself.
    """
    grid, laminate = shell.discretisation.grid, shell.discretisation.laminate
    (x0, y0), (x1, y1) = grid.nodes.min(axis=0), grid.nodes.max(axis=0)
    corners = [grid.node_at(*point) for point in ((x1, y1), (x0, y1), (x1, y0))]
    w = shell.discretisation.expand(u)[corners[0], 4:].mean()
    elements = [elements_at(grid, *grid.nodes[corner])[0] for corner in corners]
    H_mean = shell.mean_resultants(u)[elements, :11]
    at_centre, at_x0, at_y0 = (_ply_stresses(laminate, shell.section, resultants) for resultants in H_mean)
    half_x0, half_y0 = grid.half[elements[1:]]
    # sigma_x and sigma_y vanish on the supports, tau_xy on the symmetry lines
    tau_xz = _shear_at_middle(laminate, at_x0[..., 0] / half_x0[0] - at_x0[..., 2] / half_x0[1])
    tau_yz = _shear_at_middle(laminate, at_y0[..., 1] / half_y0[1] - at_y0[..., 2] / half_y0[0])
    return {
        "w_bar": float(100 * E_T * w / (q0 * H * S**4)),
        "sigma_x_bar": float(at_centre[-1, 1, 0] / (q0 * S**2)),
        "tau_xz_bar": tau_xz / (q0 * S),
        "tau_yz_bar": tau_yz / (q0 * S),
    }


def _ply_stresses(laminate: Laminate, section: str, resultants: np.ndarray) -> np.ndarray:
    """sigma_x, sigma_y, tau_xy (plies, 2, 3) at the bottom and the top of each ply from mean resultants (11,).

    sigma = Q E + c S33 with the plane-stress stiffness Q, c = b_ij33/b_3333 and S33 = H33/h, the section's own law.
    """
    strains = np.linalg.solve(laminate.stiffness(section), resultants)
    inner, outer = strains[:6:2], strains[1:6:2]
    interfaces = np.append(0.0, np.cumsum([ply.thickness for ply in laminate.plies])) / laminate.thickness
    stresses = np.empty((len(laminate.plies), 2, 3))
    for k, ply in enumerate(laminate.plies):
        stiffness = ply.stiffness()
        c = stiffness[:3, 3] / stiffness[3, 3]
        Q = stiffness[:3, :3] - np.outer(c, stiffness[3, :3])
        for end, upper in enumerate(interfaces[k : k + 2]):
            stresses[k, end] = Q @ ((1 - upper) * inner + upper * outer) + c * resultants[10] / laminate.thickness
    return stresses


def _shear_at_middle(laminate: Laminate, divergence: np.ndarray) -> float:
    """Transverse shear stress at z = 0 in equilibrium with the divergence (plies, 2) of the in-plane stresses.

    tau(0) = -int_{-h/2}^0 (d sigma) dz; linear in every ply and even or odd about z = 0, so half of the middle ply,
    from its bottom to its mean, completes the integral.
    """
    middle = len(laminate.plies) // 2
    below = sum(ply.thickness * ends.mean() for ply, ends in zip(laminate.plies[:middle], divergence, strict=False))
    bottom, top = divergence[middle]
    half = 0.5 * laminate.plies[middle].thickness * (0.75 * bottom + 0.25 * top)
    return float(-(below + half))


SCENES = (Pagano(),)

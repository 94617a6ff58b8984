"""A clamped panel pressed by a plane or a ball: a small, fast scene for extreme settings.

The panel is a square piece of a cylinder, a sphere or a plate, stretched along a1 by ``aspect``, and inflated while it
is pressed. It has no reference: it tests where a solution is obtained, and whether the judge accepts it.
"""

from dataclasses import replace

import numpy as np

from contact.obstacles.drum_sphere import Sphere
from contact.obstacles.foundation import Foundation, RigidPlane
from formulations.conditions.boundary import Supports
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate, Surface, cylinder, sphere
from formulations.loads import Pressure
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import CRUSHED, Sheet, ShellLimit
from studies.ask.scene import EPSILON, SOLVER, Declared, Request, SceneModel, Setting, Units, UsageError
from studies.scenes.contact.base import OUTER, ContactModel, Touch
from studies.scenes.element import ELEMENT, discretise, moved_nodes
from studies.scenes.statics import loaded_shell

E, RADIUS, HALF = 100.0, 100.0, 25.0  # MPa across the fibres, mm, mm: half the width of the panel
SHAPES = ("cylinder", "sphere", "plate")

SETTINGS = (
    Setting("shape", "cylinder", "shape of the panel", "choice", choices=SHAPES),
    Setting("h_over_R", 0.02, "thickness over the radius, 100 mm", low=1e-8, high=0.5),
    Setting("aspect", 1.0, "length of an element over its width", low=1e-6, high=1e6),
    Setting(
        "irregular", 0.0, "0: even grid lines; near 1: pairs of lines nearly coincide", low=0, high=1, open_high=True
    ),
    Setting("E_ratio", 1.0, "modulus along the fibres over that across them, 100 MPa; 1: isotropic", low=1, high=1e9),
    Setting("gamma_deg", 30.0, "angle of the fibres from a1", low=-90, high=90),
    Setting("nu", 0.3, "Poisson ratio", low=-1, high=0.5, open_low=True, open_high=True),
    Setting("inflation", 0.0, "pressure inside, over E h/R", low=-100, high=100),
    Setting("load", "dead", "whether the pressure follows the wall", "choice", choices=("dead", "follower")),
    Setting("delta_mm", 1.0, "travel of the foundation from first touch", low=-100, high=1000),
    Setting("foundation", "plane", "rigid obstacle that presses", "choice", choices=("plane", "ball")),
    Setting("ball_mm", 20.0, "radius of the ball", low=0, high=1e6, open_low=True),
    Setting("length_unit", 1.0, "length units in 1 mm", low=1e-12, high=1e12),
    Setting("stress_unit", 1.0, "stress units in 1 MPa", low=1e-12, high=1e12),
    replace(EPSILON, help="regularisation, in the units of the problem; inf enforces exactly", unit="MPa/mm"),
    *ELEMENT,
    SOLVER,
)


def lines(n: int, half: float, irregular: float) -> np.ndarray:
    """Grid lines (n + 1,) over +-half, every second one moved towards its neighbour; the middle one stays."""
    t = np.linspace(-half, half, n + 1)
    inner = np.arange(1, n)
    moved = inner[(inner - n // 2) % 2 == 1]
    t[moved] += irregular * 2 * half / n
    return t


class Panel(Declared):
    """a1 along the generators of a cylinder, a2 around; the foundation moves along -e_x, for a plate along -e_z."""

    name = "panel"
    title = "Clamped panel pressed by a plane or a ball, for extremes"
    default_mesh = (6, 6)
    settings = SETTINGS
    quantities = {"peak_MPa": "largest contact pressure at a node"}
    slides: bool = True
    sheet = Sheet("x", 40.0, 28.0, mesh="12x12", settings={"delta_mm": "5"})
    shell_limit = ShellLimit(CRUSHED, lambda settings: settings.number("h_over_R"), same=False)

    def build(self, request: Request) -> SceneModel:
        """Pressure and travel increase together; results are in mm, N, MPa whatever the units of the problem."""
        n1, n2 = request.mesh
        if min(n1, n2) < 2:
            raise UsageError(f"mesh {n1}x{n2} must have at least 2 elements along each side: its edges are clamped")
        unit, stress = request.number("length_unit"), request.number("stress_unit")
        units = Units(unit, stress)
        surface, halves = _shape(request, unit)
        across = lines(n2, halves[1], request.number("irregular"))
        grid = moved_nodes(request, Grid.tensor(lines(n1, halves[0], request.number("irregular")), across))
        supports = Supports.of_edges(grid, *["clamped"] * 4)
        edge = np.flatnonzero(supports.held.any(axis=1))
        h = RADIUS * request.number("h_over_R") * unit
        discretisation = discretise(request, surface, grid, _wall(request, h, stress), *supports.masks)
        p = request.number("inflation") * E * stress * h / (RADIUS * unit)
        shell = loaded_shell(discretisation, request, pressure=Pressure(p, request.choice("load") == "follower", "mid"))
        outer = np.delete(discretisation.positions()[OUTER], edge, axis=0)
        normal = np.array([0.0, 0.0, 1.0]) if request.choice("shape") == "plate" else np.array([1.0, 0.0, 0.0])
        front, delta = float(np.max(outer @ normal)), request.number("delta_mm") * unit
        ball = request.number("ball_mm") * unit if request.choice("foundation") == "ball" else None

        def foundation(t: float) -> Foundation:
            at = front - t * delta
            return RigidPlane(normal, at) if ball is None else Sphere((at + ball) * normal, ball)

        def measured(t: float, touch: Touch) -> dict[str, float]:
            force, peak = float(touch.force.sum()), float(np.max(touch.pressure))
            return {"force_N": force / units.force, "peak_MPa": peak / stress}

        return ContactModel(shell, edge, (1.0,), foundation, measured, units=units)


def _shape(request: Request, unit: float) -> tuple[Surface, tuple[float, float]]:
    """The surface, and half of its extent along a1 and a2."""
    n1, n2 = request.mesh
    along = HALF * n1 / n2 * request.number("aspect")
    shape = request.choice("shape")
    if shape == "plate":
        return Plate(), (along * unit, HALF * unit)
    if shape == "cylinder":
        return cylinder(RADIUS * unit), (along * unit, HALF / RADIUS)
    if along > 1.5 * RADIUS:
        raise UsageError(f"aspect = {request.number('aspect'):g} extends the panel beyond the poles of its sphere")
    return sphere(RADIUS * unit), (along / RADIUS, HALF / RADIUS)


def _wall(request: Request, h: float, stress: float) -> Laminate:
    """One ply about its middle; raises UsageError where it is not elastic."""
    ratio, nu = request.number("E_ratio"), request.number("nu")
    G = E * stress / (2 * (1 + nu))
    try:
        if ratio == 1:
            ply = Ply.isotropic(E * stress, nu, h)
        else:
            ply = Ply(ratio * E * stress, E * stress, G, G, nu, nu, np.deg2rad(request.number("gamma_deg")), h)
    except ValueError as error:
        raise UsageError(str(error)) from None
    return Laminate((ply,), -h / 2)


SCENES = (Panel(),)

"""Ring between two rigid plates: the elastica, whose flattened part carries no pressure at all.

The model is a quarter of the ring, whose plate moves inwards; the middle lines of both contacts are 2 (R - delta)
apart. Over the flat part bending alone keeps the ring straight. It touches there without pressure, and strict
complementarity fails; the ends of the flat part carry all load. The elastica neither stretches nor shears: at delta =
R/2 the P of this wall is lower by the fraction 2.4 (h/R)^2, which is 2.4e-4 for h = R/100 (measured).
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import CONTACT, CRUSHED, Ladder, Sheet, ShellLimit, meshes, thickness_over
from studies.ask.scene import EPSILON, SOLVER, Declared, Reference, Request, SceneModel, Setting
from studies.scenes.closed_forms.contact import flattened_ring
from studies.scenes.contact.base import ON_RIM, RIM_LINES, ContactModel, Touch, contact_lines
from studies.scenes.data import Row, references
from studies.scenes.element import ELEMENT, discretise, grid_over, spaced_lines
from studies.scenes.statics import loaded_shell

E, RADIUS, THIN, WIDTH = 1.2e6, 100.0, 1.0, 10.0  # MPa, mm; nu = 0
AWAY = np.array([1.0, 0.0, 0.0])

READ = ("P_R2_over_EI", "P_H2_over_EI", "flat_half_length")
DELTAS = (35.0, 40.0, 50.0)
TRAVELS = Setting.positive("delta_mm", DELTAS, "travel of each plate from first touch", 80.0, kind="floats")
THICKNESS = Setting("h_mm", THIN, "thickness; the elastica holds for h/R to zero", low=1e-6, high=20)


def elastica(source: str, known_to: float, names: Iterable[str], **held: float | str) -> tuple[Reference, ...]:
    """What a thin ring has of these quantities at DELTAS, and other settings that it is ``held`` at."""
    rows: list[Row] = []
    for delta in DELTAS:
        (load, flat), height = flattened_ring(1 - delta / RADIUS), 1 - delta / RADIUS
        values = {"P_R2_over_EI": load, "P_H2_over_EI": 4 * load * height**2, "flat_half_length": flat}
        values["second_over_first"] = 1.0  # of rings in a row
        at = {"delta_mm": delta, "h_mm": THIN, **held, "measure": "exact"}
        rows.append((at, {name: values[name] for name in names}))
    return references("exact", source, known_to, rows)


def flattened(delta: float, h: float, force: np.ndarray, y: np.ndarray) -> dict[str, float]:
    """What is read of the forces (m,) [N] on a quarter at y (m,) [mm] from the middle of the contact."""
    total = float(force.sum())
    load = 2 * total * RADIUS**2 / (E * h**3 / 12 * WIDTH)
    centre = float(force @ np.abs(y)) / total / RADIUS if total > 0 else 0.0
    height = 2 * (1 - delta / RADIUS)
    return {"P_R2_over_EI": load, "P_H2_over_EI": load * height**2, "flat_half_length": centre}


def lines_around(request: Request, count: int) -> np.ndarray:
    """Of a quarter, from the middle of the contact."""
    on_grid, height = replace(request, mesh=(request.mesh[0], count)), 1 - request.numbers("delta_mm")[-1] / RADIUS
    return contact_lines(on_grid, 1, (0, np.pi / 2), lambda: flattened_ring(height)[1])


def part_on(request: Request, h: float, grid: Grid) -> Discretisation:
    """A part of the ring from a2 = 0 on between planes of symmetry, a quarter or more.

    Nothing else keeps a half where it is along its own middle plane, and nothing pushes there: it is held.
    """
    supports, right = Supports.of_edges(grid, *("symmetric",) * 4), np.pi / 2
    if grid.ends[1, 1] > right + 1e-9:
        supports = supports.hold(grid.on_line(1, right), [1], ["inner"])
    return discretise(request, cylinder(RADIUS), grid, Laminate.single(Ply.isotropic(E, 0.0, h)), *supports.masks)


def part_around(request: Request, h: float, around: np.ndarray) -> Discretisation:
    """The same on these lines around, and those asked for along the axis."""
    return part_on(request, h, grid_over(request, spaced_lines(0, WIDTH, request.mesh[0]), around))


def may_touch(grid: Grid) -> np.ndarray:
    """Nodes of a quarter that are not on its middle plane."""
    return np.setdiff1d(grid.free_nodes, grid.on_line(1, np.pi / 2))


class Ring(Declared):
    """a1 along the axis, a2 from the plate over a quarter of the ring."""

    name = "ring"
    title = "Ring flattened between rigid plates"
    default_mesh = (1, 64)
    settings = (TRAVELS, THICKNESS, RIM_LINES, EPSILON, *ELEMENT, SOLVER)
    references = elastica("inextensible elastica, elliptic integrals", 3e-4, READ)
    quantities = {
        "P_R2_over_EI": "force of a plate times R^2/(E I)",
        "P_H2_over_EI": "force of a plate times the square of the distance of the middle lines of contact, over E I",
        "flat_half_length": "centre of the nodal contact forces from the middle of the flat part, over R",
    }
    ladders = (
        Ladder(
            CONTACT,
            meshes(2, 20, 3),
            ("P_H2_over_EI", "flat_half_length"),
            settings={"delta_mm": "50", **ON_RIM},
            coarser=("1x10",),
        ),
    )
    sheet = Sheet("-x", -62.0, 14.0)
    shell_limit = ShellLimit(CRUSHED, thickness_over(RADIUS, "h_mm"))

    def build(self, request: Request) -> SceneModel:
        """All four sides are symmetric; P is the whole force of a plate."""
        h, deltas = request.number("h_mm"), request.numbers("delta_mm")
        quarter = part_around(request, h, lines_around(request, request.mesh[1]))
        shell, side = loaded_shell(quarter, request), quarter.grid.on_line(1, np.pi / 2)

        def measured(delta: float, touch: Touch) -> dict[str, float]:
            return flattened(delta, h, touch.force, touch.candidates.positions(touch.u)[:, 1])

        def plate(delta: float) -> RigidPlane:
            return RigidPlane(AWAY, RADIUS + h / 2 - delta)

        return ContactModel(shell, side, deltas, plate, measured, key="delta_mm", body_at=lambda delta: shell)


SCENES = (Ring(),)

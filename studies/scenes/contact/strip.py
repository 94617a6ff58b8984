"""Strips against a flat obstacle: one clamped and pressed on it, one heavy and lifted off it."""

from dataclasses import replace

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.conditions.boundary import Supports
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import Ply
from formulations.shell import ShellModel
from studies.ask.declarations import CONTACT, FULL, LONG, PRESSED, Ladder, ShellLimit, thickness_over
from studies.ask.scene import EPSILON, SOLVER, Declared, Reference, Request, SceneModel, Setting
from studies.scenes.closed_forms.contact import lifted_strip, strip_contact
from studies.scenes.contact.base import ON_RIM, RIM_LINES, ContactModel, Touch, contact_lines
from studies.scenes.data import At, reference_rows, references
from studies.scenes.element import ELEMENT, ShearCorrected, discretise, grid_over, on_grid, spaced_lines
from studies.scenes.statics import area_load, loaded_shell

E, A, B, H, GAP = 1200.0, 100.0, 10.0, 1.0, 1.0  # MPa, mm; nu = 0; half span, width, thickness, gap
D = E * H**3 / 12  # N mm
Q0 = 24 * D * GAP / A**4  # MPa, the pressure at which Euler and Bernoulli's strip touches
UP = np.array([0.0, 0.0, 1.0])

NO_SHEAR = 0.001  # lam/a of Euler and Bernoulli's strip
LAMBDA = Setting("lam_over_a", 0.1, f"sqrt(D/S) over the half span; {NO_SHEAR:g}: no shear", low=NO_SHEAR, high=1)
PRESSURES = Setting("load_fraction", (2.0, 5.0, 10.0), "pressures to report, over 24 D g/a^4", "floats", 0.0, 100.0)
STRIPS = ("16x1", "32x1", "64x1", "128x1")  # nothing varies across
FILE = "contact_clamped_strip_flat_obstacle.csv"
SOURCE = "closed form of beam theory, checked by beam elements of exact stiffness"


def shear_correction(lam: float) -> float:
    """The kappa with lam = sqrt(D/S) [mm] for S = kappa E h/2."""
    return H**2 / (6 * lam**2)


def strip_wall(lam: float) -> ShearCorrected:
    """The wall about its middle, with the shear stiffness of ``lam`` [mm]."""
    return ShearCorrected((Ply.isotropic(E, 0.0, H),), -H / 2, shear_correction(lam))


def contact_edge(x: np.ndarray, pressure: np.ndarray) -> tuple[float, float]:
    """Where contact begins and the pressure there, from equally spaced nodes x (n,) that touch towards the end.

    A lumped node collects the pressure of half an element on either side; the first one of as much of its width as
    touches, so its share of the pressure that its neighbours extrapolate to places the edge within the element. Only
    where the elements resolve the boundary layer is that better than the nodes tell. NaN with less than three nodes.
    """
    first = int(np.argmax(pressure > 0))
    if not np.all(pressure[first : first + 3] > 0) or first + 3 > len(x):
        return float("nan"), float("nan")
    spacing, (p0, p1, p2) = x[1] - x[0], pressure[first : first + 3]
    share = float(np.clip(p0 / max(2 * p1 - p2, p0), 0.0, 1.0))
    begins = float(x[first] + (0.5 - share) * spacing)
    return begins, float(p1 + (p1 - p2) * (x[first + 1] - begins) / spacing)


def middle_line(touch: Touch, unit: float) -> tuple[np.ndarray, np.ndarray]:
    """a1 over ``unit`` and pressure of the candidates with a2 = 0."""
    one = touch.at[:, 1] == 0.0
    return touch.at[one, 0] / unit, touch.pressure[one]


def _references() -> tuple[Reference, ...]:
    """Every row of the table with a contact zone; of lam = 0 the force, for lam/a = 0.001, which differs by 1e-5."""
    tabulated: tuple[Reference, ...] = ()
    for lam, q, length, _, edge, force in (tuple(row.values()) for row in reference_rows(FILE)):
        at: At = {"lam_over_a": lam or NO_SHEAR, "load_fraction": q, "measure": "linear"}
        if lam > 0:
            values = {"half_force": force, "free_length": length, "edge_pressure": edge}
            tabulated += references("exact", SOURCE, 1e-6, [(at, values)])
        elif q > 3:
            tabulated += references("exact", SOURCE, 1e-4, [(at, {"half_force": force})])
    return tabulated


class ClampedStrip(Declared):
    """Clamped-clamped strip pressed on a flat obstacle: Timoshenko's contact zone, Euler-Bernoulli's edge force.

    The model is half of the strip. ``lam_over_a``, not the thin wall, sets its shear stiffness: lam = sqrt(D/S) =
    h/sqrt(6 kappa) with the shear correction kappa. The strip can therefore be so thin that its squeeze under the
    contact pressure, of the order (h/a)^4 of the gap, is invisible. Where lam is smaller than the length of the
    squeeze, (2 D h/E)^(1/4) = 0.64 h for a wall of stiffness 2 E/h, the squeeze and not the shear spreads the edge
    force over this length, and no load is lost.

    a1 from the clamp to the middle; the plane is above.
    """

    name = "strip-contact"
    title = "Clamped strip pressed on a flat obstacle"
    default_mesh = (64, 1)
    settings = (PRESSURES, LAMBDA, RIM_LINES, EPSILON, *ELEMENT, SOLVER)
    references = _references()
    quantities = {
        "half_force": "contact force of the half strip over D g/a^3 of its width",
        "free_length": "from the clamp to the begin of contact, over the half span a",
        "edge_pressure": "contact pressure at the begin of contact over D g/a^4",
    }
    ladders = (
        # lam so large that the elements resolve the pressure at the rim before they resolve the wall's squeeze
        Ladder(
            CONTACT,
            STRIPS,
            ("half_force", "free_length", "edge_pressure"),
            "linear",
            {"load_fraction": "5", "lam_over_a": "0.2", **ON_RIM},
        ),
        Ladder(
            CONTACT,
            STRIPS,
            ("half_force",),
            "linear",
            {"load_fraction": "5", "lam_over_a": "0.001"},
            name="strip-contact-no-shear",
        ),
    )
    shell_limit = ShellLimit(PRESSED, thickness_over(A, H))

    def build(self, request: Request) -> SceneModel:
        """Half of the pressure acts on each face; results are over the half span a and D g/a^3, D g/a^4."""
        lam, last = request.number("lam_over_a"), request.numbers("load_fraction")[-1]
        edges = ("clamped", "symmetric", "symmetric", "symmetric")

        def rim() -> float:
            return A * strip_contact(24 * last, lam if lam > NO_SHEAR else 0.0).free_length

        grid = grid_over(request, contact_lines(request, 0, (0, A), rim), spaced_lines(0, B, request.mesh[1]))
        half = on_grid(request, Plate(), grid, strip_wall(A * lam), edges)
        shell = loaded_shell(half, request, forces=area_load(half, lambda a1, a2: Q0 * UP))

        def measured(q: float, touch: Touch) -> dict[str, float]:
            x, pressure = middle_line(touch, A)
            begins, at_edge = contact_edge(x, pressure * A**4 / (D * GAP))
            half_force = float(touch.force.sum()) * A**3 / (B * D * GAP)
            return {"half_force": half_force, "free_length": begins, "edge_pressure": at_edge}

        clamp, plane = half.grid.on_line(0, 0.0), RigidPlane(UP, H / 2 + GAP)
        pressures = request.numbers("load_fraction")
        return ContactModel(shell, clamp, pressures, lambda q: plane, measured, at_rim=("edge_pressure",))


UNIT, LIFT = 100.0, 1.0  # mm: (D delta/q)^(1/4) and delta at load fraction 1
WEIGHT = D * LIFT / UNIT**4  # MPa
LENGTH = 4 * UNIT  # beyond 3 UNIT nothing happens

LENGTHS = Setting("lam_over_unit", 0.2, "sqrt(D/S) over (D delta/q)^(1/4)", low=0.01, high=1)
LIFTS = Setting("load_fraction", (1.0,), "lifts to report", "floats", 0.0, 4.0, open_low=True)
BEAMS = "closed form of beam theory, checked by beam elements"


REFERENCES = tuple(
    Reference(name, value, {"lam_over_unit": lam, "load_fraction": 1.0, "measure": "linear"}, "exact", BEAMS, 1e-6)
    for lam in (0.2, 0.5)
    for name, value in zip(("free_length", "lift_force"), lifted_strip(lam), strict=True)
)


class HeavyStrip(Declared):
    """Heavy strip on a rigid plane, lifted at one end: free length and lifting force of a Timoshenko beam.

    The model is upside down: the weight presses the outer face against the plane above, the lift pulls it off.

    a1 from the lifted end, which may turn, to the other end, which lies on the plane.
    """

    name = "heavy-strip"
    title = "Heavy strip on a plane, lifted at one end"
    default_mesh = (64, 1)
    settings = (LIFTS, LENGTHS, RIM_LINES, EPSILON, *ELEMENT, SOLVER)
    references = REFERENCES
    quantities = {
        "free_length": "from the lifted end to the begin of contact, over (D delta/q)^(1/4)",
        "lift_force": "force that lifts the end, over q (D delta/q)^(1/4) of the width",
    }
    ladders = (Ladder(CONTACT, LONG, ("lift_force", "free_length"), "linear", {**FULL, **ON_RIM}),)

    def build(self, request: Request) -> SceneModel:
        """The full weight acts from the start; the end is displaced.

        Lengths are over (D delta/q)^(1/4) at load fraction 1, the lift over q times that length and the width.
        """
        lam, highest = request.number("lam_over_unit"), request.numbers("load_fraction")[-1]
        unit = highest**0.25  # the length that a lift scales with, over UNIT

        def rim() -> float:
            return UNIT * unit * lifted_strip(lam / unit)[0]

        grid = grid_over(request, contact_lines(request, 0, (0, LENGTH), rim), spaced_lines(0, B, request.mesh[1]))
        end = grid.on_line(0, 0.0)
        supports = Supports.of_edges(grid, "free", "symmetric", "symmetric", "symmetric").hold(end, (2,))
        wall = strip_wall(UNIT * lam)
        strip = discretise(request, Plate(), grid, wall, *supports.masks)
        shell = loaded_shell(strip, request, forces=area_load(strip, lambda a1, a2: WEIGHT * UP))
        total = WEIGHT * LENGTH * B

        def lifted(t: float) -> ShellModel:
            prescribed = np.zeros((grid.n_nodes, 6))
            prescribed[end, 4:] = -t * LIFT
            return replace(shell, prescribed=prescribed)

        def measured(t: float, touch: Touch) -> dict[str, float]:
            x, pressure = middle_line(touch, UNIT)
            begins, _ = contact_edge(x, pressure / WEIGHT)
            lift = (total - float(touch.force.sum())) / (WEIGHT * UNIT * B)  # what the plane does not carry
            return {"free_length": begins, "lift_force": lift}

        plane, lifts = RigidPlane(UP, H / 2), request.numbers("load_fraction")
        return ContactModel(shell, end, lifts, lambda t: plane, measured, body_at=lifted, lying=True)


SCENES = (
    ClampedStrip(),
    HeavyStrip(),
)

"""Clamped-clamped strip pressed on a flat obstacle: Timoshenko's contact zone, Euler and Bernoulli's edge force.

Half of the strip. Its shear stiffness is not that of the thin wall but what ``lam_over_a`` asks for, lam = sqrt(D/S) =
h/sqrt(6 kappa) with the shear correction kappa. So the strip can be so thin that its squeeze under the contact
pressure, of the order (h/a)^4 of the gap, does not show. Where lam is smaller than that, the squeeze and not the shear
spreads the edge force: on a wall of stiffness 2 E/h over the length (2 D h/E)^(1/4) = 0.64 h, and no load is lost.
"""

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import Ply
from studies.ask.declarations import CONTACT, PRESSED, Ladder, ShellLimit, thickness_over
from studies.ask.scene import EPSILON, SOLVER, Declared, Reference, Request, SceneModel, Setting
from studies.scenes.closed_forms.contact import strip_contact
from studies.scenes.contact.base import ON_RIM, RIM_LINES, ContactModel, Touch, contact_lines
from studies.scenes.data import At, reference_rows, references
from studies.scenes.element import ELEMENT, ShearCorrected, grid_over, on_grid, spaced_lines
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
    """a1 from the clamp to the middle; the plane is above."""

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
        """Half of the pressure on each face; results in units of the half span a and of D g/a^3, D g/a^4."""
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
        return ContactModel(shell, clamp, request.numbers("load_fraction"), lambda q: plane, measured)


SCENES = (ClampedStrip(),)

"""Ladders: scenes on three or more meshes, what is read off them, and the cells that climb them.

The same ladders serve every element and every table over all scenes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from studies.campaigns.cell import Cell

LABEL = "convergence {ladder} {mesh} {element}"
FULL_LOAD = {"load_fraction": "1"}


@dataclass(frozen=True)
class Ladder:
    """A scene on meshes from coarse to fine; the size of their elements falls as 1 over the first number.

    quantities: what is judged, the first one is the scene's headline. at: the step where they are read, KEY=VALUE;
    without one, the last step. family: whose picture they are in. settings, measure: as for ``footprint solve``.
    """

    name: str
    scene: str
    family: str
    meshes: tuple[str, ...]
    quantities: tuple[str, ...]
    settings: Mapping[str, str] = field(default_factory=dict)
    measure: str = "exact"
    at: str = ""


def _halved(n1: int, n2: int, count: int = 4) -> tuple[str, ...]:
    """``count`` meshes, each halving the elements of the one before."""
    return tuple(f"{n1 * 2**k}x{n2 * 2**k}" for k in range(count))


def _linear(name: str, scene: str, quantities: tuple[str, ...], **settings: str) -> Ladder:
    return Ladder(name, scene, "linear shells", _halved(8, 8), quantities, settings, measure="linear")


_ROTATIONS, _SNAP, _CLOSED, _TYRE = "large rotations", "snap through", "closed forms", "tyre"
_CONTACT = "contact"
_TYRE_MESHES = ("28x26", "42x40", "56x54", "84x80")  # all close to the same grading
_ROOF_MESHES = ("4x4", "8x8", "16x16", "24x24")  # a whole curve each: 32x32 costs three times 24x24
ISOTROPIC = {
    **{"E_MPa": "20", "nu": "0.45", "plies": "1", "ply_thickness_mm": "4.8"},
    **{"load": "follower", "pressure_area": "face"},
}
_STRIPS = ("16x1", "32x1", "64x1", "128x1")  # nothing varies across
_PRESSED, _CLOSED_RING = {"load_fraction": "5"}, {"delta_mm": "50"}
_TIP = ("tip_deflection_mm", "tip_shortening_mm")
_WALL = ("stretch", "thickness_ratio")
_RESULTANTS = tuple(f"N_{name}_{place}_N_per_mm" for place in ("crown", "inner") for name in ("phi", "theta"))

LADDERS = (
    Ladder("cantilever", "cantilever", _ROTATIONS, _halved(32, 2), _TIP, FULL_LOAD),
    Ladder("sze-moment", "sze-moment", _ROTATIONS, _halved(32, 1), _TIP, {"load_fraction": "0.5"}),
    Ladder("sze-annulus", "sze-annulus", _ROTATIONS, _halved(5, 40), ("w_B_mm", "w_A_mm"), FULL_LOAD),
    Ladder("hemisphere", "hemisphere", _ROTATIONS, _halved(16, 16), ("inward_mm", "outward_mm"), FULL_LOAD),
    Ladder(
        "sze-pullout",
        "sze-pullout",
        _ROTATIONS,
        ("8x12", "16x24", "24x36", "32x48"),
        ("w_A_mm", "u_B_mm", "u_C_mm"),
        FULL_LOAD,
    ),
    *(
        Ladder(f"roof-{letter}", f"roof-{letter}", _SNAP, _ROOF_MESHES, ("limit_load_fraction", "limit_w_C_mm"))
        for letter in "abcdef"
    ),
    Ladder(
        "shallow-cap",
        "shallow-cap",
        _SNAP,
        ("8x2", "16x2", "32x2", "64x2"),  # nothing varies around the axis
        ("limit_load_fraction", "limit_w_apex_mm"),
    ),
    _linear("scordelis-lo", "scordelis-lo", ("edge_deflection_mm",)),
    _linear("pinched-cylinder", "pinched-cylinder", ("deflection_mm",), shear_correction="1000"),
    *(_linear(f"pagano-S{S}", "pagano", ("w_bar", "sigma_x_bar"), S=f"{S}") for S in (10, 100)),
    *(
        Ladder(f"pressurised-cylinder-{ends}", "pressurised-cylinder", _CLOSED, _halved(2, 4), _WALL, settings)
        for ends in ("fixed", "open")
        for settings in [{**FULL_LOAD, "ends": ends}]
    ),
    Ladder("pressurised-sphere", "pressurised-sphere", _CLOSED, _halved(2, 2), _WALL, FULL_LOAD),
    Ladder(
        "pressurised-torus",
        "pressurised-torus",
        _CLOSED,
        ("32x1", "64x1", "128x1", "256x1"),  # one element around the axis: nothing varies there
        _RESULTANTS,
    ),
    *(
        Ladder(name, "strip-contact", _CONTACT, _STRIPS, quantities, {"load_fraction": "5", **shear}, "linear")
        for name, quantities, shear in (
            ("strip-contact", ("half_force", "free_length", "edge_pressure"), {}),
            ("strip-contact-no-shear", ("half_force",), {"lam_over_a": "0.001"}),
        )
    ),
    Ladder("heavy-strip", "heavy-strip", _CONTACT, _STRIPS, ("lift_force", "free_length"), FULL_LOAD, "linear"),
    Ladder(
        "plate-contact", "plate-contact", _CONTACT, _STRIPS, ("contact_force", "contact_radius"), _PRESSED, "linear"
    ),
    Ladder(
        "ring", "ring", _CONTACT, ("1x16", "2x32", "3x48", "4x64"), ("P_H2_over_EI", "flat_half_length"), _CLOSED_RING
    ),
    Ladder("tyre", "tyre", _TYRE, _TYRE_MESHES, ("force_N", "centre_pressure_MPa"), {"delta_mm": "20"}),
    Ladder(
        "tyre-isotropic", "tyre", _TYRE, _TYRE_MESHES, ("force_N", "centre_pressure_MPa"), ISOTROPIC, at="delta_mm=10"
    ),
)

BENCHMARKS = (  # with the element of the paper, at every load of the published tables
    Ladder("cantilever", "cantilever", "benchmarks", ("16x1", "32x2", "64x4"), ("tip_shortening_mm", _TIP[0])),
    Ladder("hemisphere", "hemisphere", "benchmarks", _halved(16, 16, 3), ("outward_mm", "inward_mm")),
)


def cells(element_settings: Mapping[str, str], element_label: str, *, finest: bool = True) -> tuple[Cell, ...]:
    """The cells of all ladders with one element; their labels are those that the pages ask for.

    ``finest``: with the last mesh of each ladder, which costs more than all others together.
    """
    return tuple(
        Cell(
            LABEL.format(ladder=ladder.name, mesh=mesh, element=element_label),
            ladder.scene,
            {"measure": ladder.measure, "mesh": mesh},
            {**ladder.settings, **element_settings},
        )
        for ladder in LADDERS
        for mesh in ladder.meshes[: None if finest else -1]
    )

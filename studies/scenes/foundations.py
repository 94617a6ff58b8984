"""What a shell is pressed on: the plane, a drum from outside or inside, a sphere, a cleat across its way.

All face the crown of a tyre along -e_x, their foremost point where the plane would touch first; the axis of a drum is
parallel to that of the tyre, and so is a cleat. Other shells have other directions. Keys that do not belong to the
foundation asked for are refused.
"""

from collections.abc import Mapping

import numpy as np

from contact.obstacles.cleat import Profile, cleat
from contact.obstacles.drum_sphere import Drum, Sphere
from contact.obstacles.foundation import Foundation, RigidPlane
from studies.ask.request import Value
from studies.ask.scene import Setting, UsageError

NORMAL = np.array([1.0, 0.0, 0.0])
AXIS = np.array([0.0, 0.0, 1.0])
TRAVEL = np.array([0.0, 1.0, 0.0])
PARAMETERS: dict[str, dict[str, Value]] = {
    "plane": {},
    "drum": {"foundation_radius_mm": 854.0},
    "hollow-drum": {"foundation_radius_mm": 854.0},
    "sphere": {"foundation_radius_mm": 100.0},
    "cleat": {"cleat_height_mm": 10.0, "cleat_top_mm": 20.0, "cleat_flank_deg": 60.0, "cleat_rounding_mm": 4.0},
}
SETTINGS = (
    Setting.one_of("foundation", PARAMETERS, "plane", "rigid obstacle that the shell is pressed on"),
    Setting.positive(
        "foundation_radius_mm", None, "radius of a drum or a sphere", 1e6, otherwise="drum 854, sphere 100"
    ),
    Setting.positive("cleat_height_mm", None, "height of a cleat", 1e3, otherwise="cleat 10"),
    Setting.positive("cleat_top_mm", None, "top width of a cleat", 1e4, otherwise="cleat 20"),
    Setting(
        "cleat_flank_deg", None, "angle of the flanks of a cleat from the plane", low=1, high=90, otherwise="cleat 60"
    ),
    Setting.positive("cleat_rounding_mm", None, "radius of all corners of a cleat", 1e3, otherwise="cleat 4"),
)


def complete(settings: Mapping[str, Value]) -> dict[str, Value]:
    """Add the measures of the foundation that were left open; raises UsageError on those of another."""
    defaults = PARAMETERS[str(settings["foundation"])]
    foreign = [key for measures in PARAMETERS.values() for key in measures if key in settings and key not in defaults]
    if foreign:
        raise UsageError(f"a foundation {settings['foundation']!r} has no {foreign[0]}")
    return {**defaults, **settings}


def foundation(
    settings: Mapping[str, Value], normal: np.ndarray = NORMAL, axis: np.ndarray = AXIS, across: np.ndarray = TRAVEL
) -> Foundation:
    """The foundation with its foremost point at the origin; raises UsageError on measures that do not fit together.

    normal: from the shell to it; axis: of a drum, or along a cleat; across: at right angles to both; unit vectors (3,).
    """
    name, size = str(settings["foundation"]), {key: float(v) for key, v in settings.items() if isinstance(v, float)}
    if name == "plane":
        return RigidPlane(normal, 0.0)
    if name == "cleat":
        try:
            pieces = cleat(*(size[key] for key in PARAMETERS["cleat"]))
        except ValueError as error:
            raise UsageError(f"no such cleat: {error}") from None
        return Profile(normal, size["cleat_height_mm"], across, 0.0, pieces)
    radius = size["foundation_radius_mm"]
    if name == "sphere":
        return Sphere(radius * normal, radius)
    hollow = name == "hollow-drum"
    return Drum((-radius if hollow else radius) * normal, axis, radius, hollow)

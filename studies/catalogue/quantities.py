"""What quantities mean, and where they are read: those that any scene may have; its own a scene declares."""

from __future__ import annotations

from collections.abc import Mapping

from studies.scenes import SCENES

UNITS = ("N_per_mm", "mm", "MPa", "deg", "N")
ALL: Mapping[str, str] = {  # of any scene
    "force_N": "contact force, the sum of the nodal pressures times their areas",
    "contact_nodes": "nodes that touch",
    "limit_points": "limit points of the load on the curve",
    "limit_load_fraction": "load fraction at the first limit point",
    "load_limit_point": "load fraction at which the path ends at a limit point",
}


def definition(scene: str, quantity: str) -> str:
    """What a quantity is and where it is read; a value at a limit point says so."""
    of_limit = quantity.startswith("limit_") and quantity not in ALL
    bare = quantity.removeprefix("limit_") if of_limit else quantity
    declared: Mapping[str, str] = getattr(SCENES[scene], "quantities", {})
    own = {**ALL, **declared}
    said = next((text for name, text in own.items() if bare == name or bare.startswith(f"{name}_")), "see the scene")
    return f"{said}, at the first limit point" if of_limit else said


def unit(quantity: str) -> str:
    """The unit that a name ends in; 1 for a number without one."""
    found = next((name for name in UNITS if quantity.endswith(f"_{name}")), "1")
    return found.replace("_per_", "/")

"""What the quantities of the scenes mean, and where they are read, as the table quantities.toml has it.

The scenes' own words come first: what a class or module says of a quantity stands on its sheet, too.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

KNOWN = tomllib.loads(Path(__file__).with_name("quantities.toml").read_text(encoding="utf-8"))
ALL, OF_SCENE = KNOWN["any"], KNOWN["scene"]  # {quantity: its meaning}, of any scene, and by scene
UNITS = ("N_per_mm", "mm", "MPa", "deg", "N")
FAMILIES = ("semicylinder", "roof", "crushed-ring", "tyre")  # scenes whose names begin with it share its quantities


def definition(scene: str, quantity: str) -> str:
    """What a quantity is and where it is read; a value at a limit point says so."""
    of_limit = quantity.startswith("limit_") and quantity not in ALL
    bare = quantity.removeprefix("limit_") if of_limit else quantity
    family = next((name for name in FAMILIES if scene == name or scene.startswith(f"{name}-")), scene)
    own = {**ALL, **OF_SCENE.get(family, {})}
    said = next((text for name, text in own.items() if bare == name or bare.startswith(f"{name}_")), "")
    place = next((name for name in ("outer", "crown", "inner") if scene == "pressurised-torus" and name in bare), "")
    words = [
        said or "see the scene",
        *([f"at the {place} {'' if place == 'crown' else 'equator'}".strip()] if place else []),
    ]
    return ", ".join([*words, *(["at the first limit point"] if of_limit else [])])


def unit(quantity: str) -> str:
    """The unit that a name ends in; 1 for a number without one."""
    found = next((name for name in UNITS if quantity.endswith(f"_{name}")), "1")
    return found.replace("_per_", "/")

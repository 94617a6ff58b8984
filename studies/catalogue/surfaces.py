"""A reference surface in words: which one, its formula and its sizes, read from the functions that made it."""

from __future__ import annotations

import inspect
import math
from dataclasses import dataclass

from formulations.geometry.surfaces import Plate, Surface, SurfaceOfRevolution

Values = dict[str, float]
TORUS = "x = (r cos a2, r sin a2, z), r = {axis_radius:.6g} + {radial:.6g} cos a1, z = {axial:.6g} sin a1; a1, a2 [rad]"
HYPERBOLOID = "r² = {waist:.6g}² + {slope:.6g} z², z = a1 [mm], turned about z by a2 [rad]"


@dataclass(frozen=True)
class Shape:
    """kind: its name.  formula: its points from a1 and a2.  axes: the unit of a1 and of a2."""

    kind: str
    formula: str
    axes: tuple[str, str]


def shape_of(surface: Surface) -> Shape:
    """The words; of a surface from outside, the name of its class and the first line that it says of itself."""
    if isinstance(surface, Plate):
        return Shape("plane", "x = a1, y = a2, z = 0 [mm]", ("mm", "mm"))
    if isinstance(surface, SurfaceOfRevolution):
        made_by, _, _ = surface.meridian.__qualname__.partition(".")
        sizes = inspect.getclosurevars(surface.meridian).nonlocals
        known = {"_straight": _straight, "elliptic_torus": _torus, "hyperboloid": _hyperboloid}.get(made_by)
        if known is not None:
            return known({name: float(value) for name, value in sizes.items()})
    said = (inspect.getdoc(type(surface)) or type(surface).__name__).splitlines()[0]
    return Shape(type(surface).__name__, said, ("", ""))


def _straight(sizes: Values) -> Shape:
    r0, dr, dz = sizes["r0"], sizes["dr"], sizes["dz"]
    if dr == 0:
        words = f"x = ({r0:.6g} cos a2, {r0:.6g} sin a2, a1), a1 [mm], a2 [rad]"
        return Shape(f"circular cylinder of radius {r0:.6g} mm", words, ("mm", "rad"))
    if dz == 0:
        return Shape("plane in polar coordinates", "x = (a1 cos a2, a1 sin a2, 0), a1 [mm], a2 [rad]", ("mm", "rad"))
    angle = math.degrees(math.atan2(dr, dz))
    words = f"r = {dr:.6g} a1, z = {dz:.6g} a1, a1 [mm], turned about z by a2 [rad]"
    return Shape(f"circular cone of half angle {angle:.6g} deg", words, ("mm", "rad"))


def _torus(sizes: Values) -> Shape:
    formula = TORUS.format(**sizes)
    round_tube = sizes["radial"] == sizes["axial"]
    if sizes["axis_radius"] == 0 and round_tube:
        return Shape(f"sphere of radius {sizes['radial']:.6g} mm", formula, ("rad", "rad"))
    tube = f"{sizes['radial']:.6g}" if round_tube else f"{sizes['radial']:.6g} by {sizes['axial']:.6g}"
    named = f"torus: tube of radius {tube} mm, its centre {sizes['axis_radius']:.6g} mm from the axis"
    return Shape(named, formula, ("rad", "rad"))


def _hyperboloid(sizes: Values) -> Shape:
    return Shape(f"hyperboloid of one sheet, waist {sizes['waist']:.6g} mm", HYPERBOLOID.format(**sizes), ("mm", "rad"))

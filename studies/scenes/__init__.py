"""The catalogue of scenes: one file a scene, one line here."""

from __future__ import annotations

from studies.scene import Scene
from studies.scenes.cantilever import Cantilever
from studies.scenes.cap import ShallowSphericalCap
from studies.scenes.contact_heavy import HeavyStrip
from studies.scenes.contact_plate import PlateContact
from studies.scenes.contact_ring import Ring
from studies.scenes.contact_strip import ClampedStrip
from studies.scenes.hemisphere import Hemisphere
from studies.scenes.linear_cylinder import PinchedCylinder
from studies.scenes.linear_pagano import Pagano
from studies.scenes.linear_roof import ScordelisLo
from studies.scenes.panel import Panel
from studies.scenes.pressurised import PressurisedCylinder, PressurisedSphere, PressurisedTorus
from studies.scenes.roofs import ROOFS
from studies.scenes.sze_annulus import SlitAnnulus
from studies.scenes.sze_moment import RolledCantilever
from studies.scenes.sze_pullout import PullOut
from studies.scenes.tyre import Tyre
from studies.scenes.tyre_solid import SolidTyre

FIRST: tuple[Scene, ...] = (Tyre(), Cantilever(), Hemisphere())
NONLINEAR: tuple[Scene, ...] = (SlitAnnulus(), RolledCantilever(), PullOut(), *ROOFS, ShallowSphericalCap())
PRESSURISED: tuple[Scene, ...] = (PressurisedCylinder(), PressurisedSphere(), PressurisedTorus())
LINEAR: tuple[Scene, ...] = (ScordelisLo(), PinchedCylinder(), Pagano())
CONTACT: tuple[Scene, ...] = (ClampedStrip(), HeavyStrip(), PlateContact(), Ring(), Panel())
SOLID: tuple[Scene, ...] = (SolidTyre(),)
SCENES: dict[str, Scene] = {
    scene.name: scene for scene in (*FIRST, *NONLINEAR, *PRESSURISED, *LINEAR, *CONTACT, *SOLID)
}

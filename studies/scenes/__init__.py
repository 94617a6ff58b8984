"""The catalogue of scenes: one file a scene, one line here."""

from __future__ import annotations

from studies.scene import Scene
from studies.scenes.benchmarks.cantilever import Cantilever
from studies.scenes.benchmarks.hemisphere import Hemisphere
from studies.scenes.benchmarks.hyperboloid import FreeHyperboloid
from studies.scenes.benchmarks.pagano import Pagano
from studies.scenes.benchmarks.pinched_cylinder import PinchedCylinder
from studies.scenes.benchmarks.pressurised import PressurisedCylinder, PressurisedSphere, PressurisedTorus
from studies.scenes.benchmarks.roofs import ROOFS
from studies.scenes.benchmarks.scordelis_lo import ScordelisLo
from studies.scenes.benchmarks.shallow_cap import ShallowSphericalCap
from studies.scenes.benchmarks.sze.annulus import SlitAnnulus
from studies.scenes.benchmarks.sze.moment import RolledCantilever
from studies.scenes.benchmarks.sze.pinched import PinchedBetweenDiaphragms
from studies.scenes.benchmarks.sze.pullout import PullOut
from studies.scenes.benchmarks.sze.semicylinder import SEMICYLINDERS
from studies.scenes.contact.crushed_ring import CrushedRing
from studies.scenes.contact.crushed_ring_solid import SolidRing
from studies.scenes.contact.heavy_strip import HeavyStrip
from studies.scenes.contact.panel import Panel
from studies.scenes.contact.plate import PlateContact
from studies.scenes.contact.ring import Ring
from studies.scenes.contact.strip import ClampedStrip
from studies.scenes.manufactured.contact_scene import ManufacturedContact
from studies.scenes.manufactured.scene import Manufactured
from studies.scenes.tyre.scene import Tyre
from studies.scenes.tyre.solid import SolidTyre

_ALL: tuple[Scene, ...] = (
    *(Tyre(), Cantilever(), Hemisphere()),
    *(SlitAnnulus(), RolledCantilever(), PullOut(), PinchedBetweenDiaphragms(), *SEMICYLINDERS),  # nonlinear
    *(*ROOFS, ShallowSphericalCap()),
    *(PressurisedCylinder(), PressurisedSphere(), PressurisedTorus()),
    *(ScordelisLo(), PinchedCylinder(), FreeHyperboloid(), Pagano()),  # linear
    *(ClampedStrip(), HeavyStrip(), PlateContact(), Ring(), Panel()),  # contact
    *(CrushedRing(), SolidRing()),  # an experiment
    SolidTyre(),
    *(Manufactured(), ManufacturedContact()),
)
SCENES: dict[str, Scene] = {scene.name: scene for scene in _ALL}

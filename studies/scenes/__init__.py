"""The catalogue of scenes, a line each. A module is loaded when one of its scenes is asked for."""

from collections.abc import Mapping
from types import ModuleType

from contact.catalogue import Catalogue
from studies.ask.scene import Scene

MODULES: Mapping[str, str] = {  # whose SCENES have the scene of a name
    "tyre": "studies.scenes.tyre.scene",
    "cantilever": "studies.scenes.benchmarks.cantilever",
    "hemisphere": "studies.scenes.benchmarks.hemisphere",
    # nonlinear
    "sze-annulus": "studies.scenes.benchmarks.sze",
    "sze-moment": "studies.scenes.benchmarks.sze",
    "sze-pullout": "studies.scenes.benchmarks.snapping",
    "sze-pinched": "studies.scenes.benchmarks.sze",
    "semicylinder": "studies.scenes.benchmarks.sze",
    "semicylinder-0-90-0": "studies.scenes.benchmarks.sze",
    "semicylinder-90-0-90": "studies.scenes.benchmarks.sze",
    **{f"roof-{letter}": "studies.scenes.benchmarks.snapping" for letter in "abcdef"},
    "shallow-cap": "studies.scenes.benchmarks.shallow_cap",
    "pressurised-cylinder": "studies.scenes.benchmarks.pressurised",
    "pressurised-sphere": "studies.scenes.benchmarks.pressurised",
    "pressurised-torus": "studies.scenes.benchmarks.pressurised",
    "inflated-membrane": "studies.scenes.benchmarks.inflated_membrane",
    "rubber-tube": "studies.scenes.benchmarks.rubber",
    "rubber-sphere": "studies.scenes.benchmarks.rubber",
    "pinched-rubber": "studies.scenes.benchmarks.rubber",
    # linear
    "scordelis-lo": "studies.scenes.benchmarks.obstacle_course",
    "pinched-cylinder": "studies.scenes.benchmarks.obstacle_course",
    "free-hyperboloid": "studies.scenes.benchmarks.hyperboloid",
    "pagano": "studies.scenes.benchmarks.pagano",
    "wrapped-cylinder": "studies.scenes.benchmarks.layered_cylinders",
    "laminated-strip": "studies.scenes.benchmarks.laminated_plates",
    "sandwich-plate": "studies.scenes.benchmarks.laminated_plates",
    "laminated-cylinder": "studies.scenes.benchmarks.layered_cylinders",
    # on quadrilaterals that follow no lines of curvature
    "twisted-beam": "studies.scenes.benchmarks.pulled_strips",
    "raasch-hook": "studies.scenes.benchmarks.pulled_strips",
    "hypar": "studies.scenes.benchmarks.quad_plates",
    "morley-skew-plate": "studies.scenes.benchmarks.quad_plates",
    "slender-beam": "studies.scenes.benchmarks.pulled_strips",
    # contact
    "strip-contact": "studies.scenes.contact.strip",
    "heavy-strip": "studies.scenes.contact.strip",
    "plate-contact": "studies.scenes.contact.plate",
    "ring": "studies.scenes.contact.ring",
    "collapsing-tube": "studies.scenes.contact.collapsing_tube",
    "walled-column": "studies.scenes.contact.walled_column",
    "two-rings": "studies.scenes.faces.two_rings",
    "pinched-ring": "studies.scenes.faces.pinched_ring",
    "stack": "studies.scenes.faces.stack",
    "half-spheres": "studies.scenes.faces.half_spheres",
    "face-patch": "studies.scenes.faces.face_patch",
    "crossed-tubes": "studies.scenes.faces.crossed_tubes",
    "two-cylinders": "studies.scenes.faces.two_cylinders",
    "ironing": "studies.scenes.faces.ironing",
    "ring-on-layer": "studies.scenes.faces.ring_on_layer",
    "tyre-on-plate": "studies.scenes.faces.tyre_on_plate",
    "tyre-on-drum": "studies.scenes.faces.tyre_on_drum",
    "roller": "studies.scenes.contact.roller",
    "panel": "studies.scenes.contact.panel",
    "pressed-panel": "studies.scenes.contact.pressed_panel",
    # an experiment, and solids
    "crushed-ring": "studies.scenes.contact.crushed_ring",
    "crushed-ring-solid": "studies.scenes.contact.crushed_ring_solid",
    "tyre-solid": "studies.scenes.tyre.solid",
    # exact solutions that are given
    "manufactured": "studies.scenes.manufactured.scene",
    "manufactured-contact": "studies.scenes.manufactured.contact_scene",
}


def _scene_of(module: ModuleType, name: str) -> Scene:
    scenes: tuple[Scene, ...] = module.SCENES
    return next(each for each in scenes if each.name == name)


SCENES: Catalogue[Scene] = Catalogue(MODULES, _scene_of)

"""Raasch's hook: a thick curved strip of two arcs of opposite curvature, clamped at one end, sheared at the other.

It bends, twists and shears across the wall at once; shells whose drilling rotation is coupled to the twist do not
converge. With nu = 0.35; values for 0.3 are in use, too. The limit here is 0.992 of the solids', with a shear
correction of 5/6 it is 0.998: a strip in torsion shears across its wall in layers along its edges, h/sqrt(12 kappa)
wide, which take 2 h/(b sqrt(12 kappa)) of its stiffness, with 5/6 as much as in a solid. Elements that are wider than
the layers are too stiff by the first order of their width, 0.970 on 56x8; lines=edges has 0.987 there.
Source: Knight, AIAA J. 35 (1997) 1281-1285; 5.022 by solids of 20 nodes and 5.02 by another program are as read in
FinEtoolsFlexStructures.
"""

from collections.abc import Mapping

import numpy as np

from formulations.section.laminate import Ply
from studies.ask.scene import Reference, Request, SceneModel, Sheet
from studies.scenes.benchmarks.quads import SETTINGS, OnQuads, pulled_strip
from studies.scenes.element import centred_laminate

E, NU, H, WIDTH = 3300.0, 0.35, 2.0, 20.0  # MPa, -, mm, mm
RADII, ANGLES = (14.0, 46.0), np.deg2rad([60.0, 150.0])
FORCE = 1.0  # N, along the width
AT: Mapping[str, float | str] = {"load_fraction": 1.0, "measure": "linear"}
SOLID = "solids of 20 nodes, in FinEtoolsFlexStructures"


def hook(s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """s: of the whole angle, 210 degrees, of which the small arc has 60; z = 20 mm t."""
    angle = ANGLES.sum() * s
    (r, R), first = RADII, ANGLES[0]
    small = np.stack([r * np.sin(angle), r * (1 - np.cos(angle))], axis=-1)
    back = 2 * first - angle  # heading on the large arc, which turns the other way
    middle = (r + R) * np.array([np.sin(first), -np.cos(first)]) + [0.0, r]
    large = middle + R * np.stack([-np.sin(back), np.cos(back)], axis=-1)
    return np.concatenate([np.where((angle < first)[..., None], small, large), WIDTH * t[..., None]], axis=-1)


class RaaschHook(OnQuads):
    """s from the clamp along both arcs by their angle, t along z; 7 elements, or a multiple, meet where arcs do."""

    name = "raasch-hook"
    title = "Raasch's hook under a shear force at its end"
    default_mesh = (56, 8)
    settings = SETTINGS
    references = (Reference("tip_deflection_mm", 5.02201, AT, "read", SOLID, 0.01),)
    quantities = {"tip_deflection_mm": "along the width (z), mean over the loaded end and both faces"}
    sheet = Sheet(azimuth=-60.0, elevation=35.0, listed=False)

    def build(self, request: Request) -> SceneModel:
        """The force is spread over the end, half on each face."""
        wall = centred_laminate(request, Ply.isotropic(E, NU, H))
        return pulled_strip(request, hook, wall, 2, FORCE)


SCENES = (RaaschHook(),)

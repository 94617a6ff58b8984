"""An element option: a quarter of the thickness strain is sampled at the nodes."""

from formulations.element.mixed import THICKNESS_STRAINS

THICKNESS_STRAINS["halfway"] = 0.25

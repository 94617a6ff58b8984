"""The options of the element as settings that every shell scene has, and the presets that name combinations of them."""

from __future__ import annotations

import numpy as np

from formulations.conditions.dof_map import Images
from formulations.discretisation import Discretisation
from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.element.strain_operator import INTERPOLATIONS
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Surface
from formulations.section.laminate import Laminate
from formulations.strains.catalogue import MEASURES
from formulations.strains.quantities import FULL
from studies.request import Request
from studies.scene import Setting, UsageError

PRESETS = {
    "paper": {"interpolation": "curvilinear", "thickness_strain": "projected", "membrane": "compatible"},
    "refined": {"interpolation": "curvilinear", "thickness_strain": "nodal", "membrane": "relaxed"},
}
SAMPLINGS = tuple(THICKNESS_STRAINS)
BY_NAME = "by element"
ELEMENT = (
    Setting(
        "element",
        "refined",
        "interpolation, thickness_strain and membrane by one name",
        "choice",
        choices=tuple(PRESETS),
        presets=PRESETS,
    ),
    Setting(
        "interpolation",
        None,
        "what is interpolated: components or positions",
        "choice",
        choices=INTERPOLATIONS,
        otherwise=BY_NAME,
    ),
    Setting(
        "thickness_strain",
        None,
        "where the thickness strain E33 is sampled",
        "choice",
        choices=SAMPLINGS,
        otherwise=BY_NAME,
    ),
    Setting("membrane", None, "linear modes of the membrane strain", "choice", choices=MEMBRANES, otherwise=BY_NAME),
)


def even_grid(request: Request, a1: tuple[float, float], a2: tuple[float, float]) -> Grid:
    """The mesh asked for, evenly spaced between the ends of both coordinates."""
    n1, n2 = request.mesh
    return Grid.tensor(np.linspace(*a1, n1 + 1), np.linspace(*a2, n2 + 1))


def discretise(
    request: Request,
    surface: Surface,
    grid: Grid,
    laminate: Laminate,
    fixed: np.ndarray,
    hinged: np.ndarray | None = None,
    images: Images | None = None,
) -> Discretisation:
    """The discretisation with the interpolation asked for, its unknowns numbered for elimination.

    Raises UsageError for a measure that leaves gradients out where positions are interpolated.
    """
    interpolation = request.choice("interpolation")
    kinematics = MEASURES[request.measure].kinematics
    if interpolation == "isoparametric" and kinematics != FULL:
        whole = ", ".join(name for name, measure in MEASURES.items() if measure.kinematics == FULL)
        raise UsageError(f"interpolation 'isoparametric' needs a measure with full gradients: one of {whole}")
    return Discretisation.build(surface, grid, laminate, fixed, hinged, kinematics, interpolation, images, ordered=True)

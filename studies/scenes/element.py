"""The options of the element as settings that every shell scene has, and the presets that name combinations of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from formulations.conditions.boundary import Supports
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
OPTIONS: tuple[tuple[str, Iterable[str], str], ...] = (
    ("interpolation", INTERPOLATIONS, "what is interpolated: components or positions"),
    ("thickness_strain", THICKNESS_STRAINS, "where the thickness strain E33 is sampled"),
    ("membrane", MEMBRANES, "linear modes of the membrane strain"),
)
BY_ONE_NAME = "interpolation, thickness_strain and membrane by one name"
ELEMENT = (
    Setting.one_of("element", PRESETS, "refined", BY_ONE_NAME, presets=PRESETS),
    *(Setting.one_of(key, choices, None, text, otherwise="by element") for key, choices, text in OPTIONS),
)
Span = tuple[float, float]  # both ends of a coordinate


def even_grid(request: Request, a1: Span, a2: Span) -> Grid:
    """The mesh asked for, evenly spaced between the ends of both coordinates."""
    n1, n2 = request.mesh
    return Grid.tensor(np.linspace(*a1, n1 + 1), np.linspace(*a2, n2 + 1))


def patch(
    request: Request, surface: Surface, a1: Span, a2: Span, laminate: Laminate, edges: Sequence[str]
) -> Discretisation:
    """A piece of a surface on the mesh asked for, evenly spaced; edges: see :meth:`Supports.of_edges`."""
    grid = even_grid(request, a1, a2)
    return discretise(request, surface, grid, laminate, *Supports.of_edges(grid, *edges).masks)


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

"""What the shells of scenes are discretised with: options of the element as settings, grids, walls, supports."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.conditions.dof_map import AllHeldError, Images
from formulations.discretisation import Discretisation
from formulations.element.mixed import MEMBRANES, SHEAR_ROWS, THICKNESS_STRAINS
from formulations.element.strain_operator import INTERPOLATIONS, ON_LINES
from formulations.geometry.grid import DISTORTIONS, LARGEST, FoldedQuadError, Grid, QuadGrid, TensorGrid, distorted
from formulations.geometry.surfaces import Surface
from formulations.section.laminate import BETWEEN_FACES, LAWS, LINEAR, SECTIONS, SURFACES, Laminate, Ply
from formulations.shell import BENDINGS
from formulations.strains.catalogue import EXACT, MEASURES
from formulations.strains.quantities import FULL, N_E
from studies.ask.request import Request, text_of
from studies.ask.scene import Setting, UsageError

if TYPE_CHECKING:
    from formulations.geometry.quadtree import Quadtree

PRESETS = {
    "paper": {"interpolation": "curvilinear", "thickness_strain": "projected", "membrane": "compatible"},
    "refined": {"interpolation": "curvilinear", "thickness_strain": "balanced", "membrane": "relaxed"},
}
# bends coarse elements far, for a tenth more seconds
COARSE = {"arc": {**PRESETS["refined"], "thickness_strain": "nodal", "bending": "arc"}}
# no choice on a grid, where it has the error of the others for more seconds
ON_MESHES = {"quads": {**PRESETS["refined"], "interpolation": "quads"}}
ELEMENTS = {**PRESETS, **COARSE, **ON_MESHES}
OPTIONS: tuple[tuple[str, Iterable[str], str], ...] = (
    (
        "interpolation",
        INTERPOLATIONS,
        "interpolation of components or positions, on lines of curvature or on any quadrilaterals",
    ),
    ("thickness_strain", THICKNESS_STRAINS, "where the thickness strain E33 is sampled"),
    ("membrane", MEMBRANES, "linear modes of the membrane strain"),
)
BY_ONE_NAME = "preset of interpolation, thickness_strain and membrane"
SHEAR = "shear_correction"
WALL = (
    Setting.one_of(
        "surfaces", SURFACES, None, "surfaces with displacements through the wall: in all, or per ply", otherwise="2"
    ),
    Setting.one_of(
        "law", LAWS.keys(), None, "material law of the plies; needs surfaces inside the wall", otherwise=LINEAR
    ),
)
MOVED_NODES = (
    Setting(
        "distort",
        None,
        "distance by which nodes are moved, over the size of an element",
        low=0,
        high=LARGEST,
        otherwise="0",
    ),
    Setting.one_of("distortion", DISTORTIONS, None, "pattern of the moved nodes; with distort", otherwise="random"),
)


def _of_element(presets: Mapping[str, Mapping[str, str]], interpolations: Iterable[str]) -> tuple[Setting, ...]:
    options = ((key, interpolations if key == "interpolation" else choices, text) for key, choices, text in OPTIONS)
    return (
        Setting.one_of("element", presets, "refined", BY_ONE_NAME, presets=presets),
        *(Setting.one_of(key, choices, None, text, otherwise="by element") for key, choices, text in options),
    )


def of_wall(surfaces: str, law: str, among: Sequence[str] = SURFACES[1:]) -> tuple[Setting, ...]:
    """The settings of the element of a scene whose wall has surfaces inside it, and these defaults.

    among: the numbers of surfaces that the scene offers.
    """
    inside, met = WALL
    return (
        *_of_element(PRESETS, ON_LINES),
        replace(inside, choices=tuple(among), default=surfaces, otherwise=""),
        replace(met, default=law, otherwise=""),
    )


BENDING = Setting.one_of(
    "bending",
    BENDINGS,
    None,
    "bending of the chord or of the arc of a folding element; with thickness_strain=nodal",
    otherwise=BENDINGS[0],
)
TWO_FACES = (*_of_element(ELEMENTS, INTERPOLATIONS), BENDING, *MOVED_NODES)  # and no others
ELEMENT = (*TWO_FACES, *WALL)
ON_QUADS = (
    *(
        replace(setting, default="quads") if setting.key == "element" else setting
        for setting in _of_element({**PRESETS, **ON_MESHES}, INTERPOLATIONS)
    ),
    *MOVED_NODES,
    *WALL,
)
LINES = Setting.one_of("lines", ("even", "edges"), "even", "grid lines: evenly spaced, or closer towards edges")
GREEN = EXACT.name
Span = tuple[float, float]  # both ends of a coordinate


@dataclass(frozen=True)
class ShearCorrected(Laminate):
    """A laminate whose stiffness against the mean transverse shear is multiplied by ``shear_correction``.

    The paper's section has none (factor 1). 5/6 is Reissner's for a homogeneous plate; a factor of 1000 makes a thin
    shell one of Kirchhoff, to isolate the shear in a difference from a thin-shell reference. The DIFFERENCE of the
    shear between the faces is left alone: it is the gradient of the thickness stretch, no shear force belongs to it.
    """

    shear_correction: float = 1.0

    def stiffness(self, section: str = "constant-s33") -> np.ndarray:
        """D (11, 11) [N/mm] of the laminate, the mean of the shears of both faces scaled on either side of D."""
        mean = np.kron(np.eye(2), np.full((2, 2), 0.5))
        scale = np.eye(N_E)
        scale[SHEAR_ROWS, SHEAR_ROWS] += (np.sqrt(self.shear_correction) - 1.0) * mean
        return scale @ super().stiffness(section) @ scale


def centred_laminate(request: Request, *plies: Ply) -> ShearCorrected:
    """The plies about their middle surface with the shear correction asked for."""
    thickness = sum(ply.thickness for ply in plies)
    return ShearCorrected(plies, -0.5 * thickness, request.number("shear_correction"))


def even_grid(request: Request, a1: Span, a2: Span, closer: Sequence[bool] = (False,) * 4) -> Grid:
    """The mesh asked for between the ends of both coordinates, evenly spaced unless it has LINES; refined as asked.

    closer: whether the lines are to get closer towards the first and the last a1, and the first and the last a2.
    """
    n1, n2 = request.mesh
    towards = closer if request.settings.get("lines") == "edges" else (False,) * 4
    lines = spaced_lines(*a1, n1, *towards[:2]), spaced_lines(*a2, n2, *towards[2:])
    return grid_over(request, *lines)


def grid_over(request: Request, lines1: np.ndarray, lines2: np.ndarray) -> Grid:
    """The grid of these lines, refined as asked, or with its nodes moved; raises UsageError for both."""
    if request.leaves:
        return moved_nodes(request, tree_over(request, lines1, lines2).grid())
    return moved_nodes(request, Grid.tensor(lines1, lines2))


def moved_nodes(request: Request, grid: Grid, stay: np.ndarray | None = None) -> Grid:
    """The grid with its nodes moved as asked, but for those that ``stay``; raises UsageError for one with leaves."""
    if "distort" not in request.settings:
        if "distortion" in request.settings:
            raise UsageError(f"distortion = {request.choice('distortion')} needs distort above 0")
        return grid
    if not isinstance(grid, TensorGrid):
        raise UsageError("distort: quadrilaterals have no hanging nodes")
    return distorted(grid, str(request.settings.get("distortion", "random")), request.number("distort"), stay)


def spaced_lines(start: float, end: float, n: int, to_start: bool = False, to_end: bool = False) -> np.ndarray:
    """n + 1 lines, evenly spaced, or closer towards one end or both; those of 2 n contain them.

    x(s) = sin(pi s/2) from 0 to 1 towards the end, at even s, and (1 - cos pi s)/2 towards both. The maps are smooth,
    so the order stays. The last elements are of the size (pi/n)^2/8 or /4: they come down to the layers that a shell
    with shear has at its edges, as wide as the wall is thick, while most others are far larger.
    """
    s = np.linspace(0.0, 1.0, n + 1)
    if to_start and to_end:
        s = (1 - np.cos(np.pi * s)) / 2
    elif to_end:
        s = np.sin(np.pi / 2 * s)
    elif to_start:
        s = 1 - np.sin(np.pi / 2 * (1 - s))
    lines = start + (end - start) * s
    lines[-1] = end
    return lines


def tree_over(request: Request, lines1: np.ndarray, lines2: np.ndarray, *, periodic: bool = False) -> Quadtree:
    """The tree asked for; a coordinate with one element is not cut: nothing varies along it."""
    from formulations.geometry.quadtree import Quadtree  # loaded with a refined grid alone

    first, second = len(lines1) > 2, len(lines2) > 2
    cut = first or not second, second or not first
    return Quadtree.over(lines1, lines2, periodic=periodic, cut=cut, leaves=request.leaves)


def patch(
    request: Request, surface: Surface, a1: Span, a2: Span, laminate: Laminate, edges: Sequence[str]
) -> Discretisation:
    """A piece of a surface on the mesh asked for; edges: see :meth:`Supports.of_edges`; a symmetry plane is none."""
    closer = [word != "symmetric" for word in edges]
    return on_grid(request, surface, even_grid(request, a1, a2, closer), laminate, edges)


def on_grid(request: Request, surface: Surface, grid: Grid, laminate: Laminate, edges: Sequence[str]) -> Discretisation:
    """A piece of a surface on a grid; edges: see :meth:`Supports.of_edges`."""
    return discretise(request, surface, grid, laminate, *Supports.of_edges(grid, *edges).masks)


def law_of(request: Request) -> str:
    """The law of the plies of a shell."""
    return str(request.settings.get("law", LINEAR))


def check_wall(request: Request, laminate: Laminate) -> str:
    """The surfaces through the wall; raises UsageError where other settings or the plies rule them, or the law, out."""
    surfaces, law = surfaces_of(request), law_of(request)
    if surfaces == BETWEEN_FACES:
        if law != LINEAR:
            raise UsageError(f"law = {law} needs surfaces = 3 or more")
        return surfaces
    if isinstance(laminate, ShearCorrected) and laminate.shear_correction != request.settings.get(SHEAR, 1.0):
        raise UsageError(f"surfaces = {surfaces}: the shear correction of this wall applies to two faces only")
    for key, value, needed in (
        ("section", request.settings.get("section"), (None, SECTIONS[0])),
        (SHEAR, request.settings.get(SHEAR), (None, 1.0)),
    ):
        if value not in needed:
            raise UsageError(f"surfaces = {surfaces}: {key} = {text_of(value)} applies to two faces only")
    if request.leaves:
        raise UsageError(f"surfaces = {surfaces}: hanging nodes allow two faces only")
    if law == LINEAR:
        return surfaces
    if request.measure != GREEN:
        raise UsageError(
            f"law = {law} is a function of Green's strain: it needs measure {GREEN}, got {request.measure}"
        )
    try:
        for ply in laminate.plies:
            LAWS[law](ply)
    except ValueError as error:
        raise UsageError(f"law = {law}: {error}") from None
    return surfaces


def bending_of(request: Request) -> str:
    """Of chords or of arcs; raises UsageError where other settings rule arcs out."""
    bending = str(request.settings.get("bending", BENDINGS[0]))
    if bending != BENDINGS[0]:
        from formulations.element.arc_element import refusal  # loaded with arcs alone

        options = request.choice("thickness_strain"), request.choice("interpolation"), MEASURES[request.measure]
        why = refusal(*options, two_faces=surfaces_of(request) == BETWEEN_FACES)
        if why:
            raise UsageError(f"bending = {bending}: {why}")
    return bending


def surfaces_of(request: Request) -> str:
    """How many surfaces there are through the wall."""
    return str(request.settings.get("surfaces", BETWEEN_FACES))


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

    Raises UsageError for a measure that leaves gradients out where positions are interpolated, and for a mesh with
    folded elements or with no displacement that is free.
    """
    interpolation = request.choice("interpolation")
    if ("distort" in request.settings) != isinstance(grid, QuadGrid):
        raise UsageError(f"distort: {request.scene} has grid lines that must not be moved")
    if interpolation == "quads" and request.leaves:
        raise UsageError("interpolation = quads: quadrilaterals have no hanging nodes")
    if isinstance(grid, QuadGrid) and interpolation != "quads":
        raise UsageError(f"distort needs interpolation = quads (element=quads), got {interpolation}")
    kinematics = MEASURES[request.measure].kinematics
    if interpolation == "isoparametric" and kinematics != FULL:
        whole = ", ".join(name for name, measure in MEASURES.items() if measure.kinematics == FULL)
        raise UsageError(f"interpolation 'isoparametric' needs a measure with full gradients: one of {whole}")
    options, surfaces = (kinematics, interpolation, images), check_wall(request, laminate)
    try:
        return Discretisation.build(surface, grid, laminate, fixed, hinged, *options, ordered=True, surfaces=surfaces)
    except (AllHeldError, FoldedQuadError) as error:
        raise UsageError(f"mesh {request.mesh_text}: {error}") from None

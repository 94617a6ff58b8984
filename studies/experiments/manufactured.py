"""Manufactured solutions on meshes that are refined: errors that are known, for every measure, surface and element.

Each row is one solve of a scene of :mod:`studies.scenes.manufactured`; orders are fitted to them elsewhere.

And on meshes of quadrilaterals that follow no coordinates: what moving the nodes costs, by measure, option and shell.
Nodes are moved as :mod:`formulations.geometry.grid` says; an amount of 0 is the same
element on the grid as it is, so that the difference is the distortion's alone.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, product

from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.geometry.grid import DISTORTIONS
from formulations.section.laminate import SECTIONS
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import QuadraticMeasure
from formulations.strains.quantities import FULL
from studies.experiments import Row, tabulated
from studies.scenes.complete import complete
from studies.scenes.element import ON_MESHES, PRESETS
from studies.scenes.manufactured.statements import PIECES, STATEMENTS, wrong_coefficients
from studies.solving.solve import solve

MESHES = (8, 16, 32)
SURFACES = ("cylinder", "torus", "inner-torus")  # of positive, none and negative Gaussian curvature
CONTACT_SURFACES, FINEST_ON = ("plate", "cylinder", "torus"), "cylinder"
FAR = "150"  # degrees: for measures that a rotation does not strain
OBJECTIVE = ("exact", "thin-green-lagrange", "elongation")
FULL_GRADIENTS = tuple(name for name, measure in MEASURES.items() if measure.kinematics == FULL)


@dataclass(frozen=True)
class Case:
    """A measure on a piece of a surface with an element; ``settings``: what is not the default."""

    group: str
    measure: str
    surface: str
    element: str = "refined"
    settings: Mapping[str, str] = field(default_factory=dict)

    @property
    def said(self) -> dict[str, str]:
        """What tells it from the others."""
        words = " ".join(f"{key}={value}" for key, value in self.settings.items())
        named = {name: getattr(self, name) for name in ("group", "measure", "surface", "element")}
        return named | {"settings": words}


def cases() -> Iterator[Case]:
    """All measures on three surfaces with both elements; then one thing at a time."""
    for measure, surface, element in product(MEASURES, SURFACES, PRESETS):
        yield Case("measures", measure, surface, element)
    for surface in PIECES:
        if surface not in SURFACES:
            yield Case("surfaces", "exact", surface)
    for measure in FULL_GRADIENTS:
        yield Case("isoparametric", measure, "torus", settings={"interpolation": "isoparametric"})
    for measure, interpolation in product(OBJECTIVE, ("curvilinear", "isoparametric")):
        if measure in FULL_GRADIENTS or interpolation == "curvilinear":
            settings = {"interpolation": interpolation, "rotation_deg": FAR}
            yield Case("large rotation", measure, "inner-torus", settings=settings)
    for interpolation, strain, membrane in product(("curvilinear", "isoparametric"), THICKNESS_STRAINS, MEMBRANES):
        settings = {"interpolation": interpolation, "thickness_strain": strain, "membrane": membrane}
        yield Case("element options", "exact", "cylinder", settings=settings)
    for section, layup in product(SECTIONS, ("skew", "isotropic")):
        yield Case("walls", "exact", "cylinder", settings={"section": section, "layup": layup})


@tabulated
def manufactured() -> Iterator[Row]:
    """A row a case and mesh: n elements along either coordinate, what :func:`errors` measures, and the outcome."""
    for case in cases():
        yield from errors_of(case)


def errors_of(case: Case, meshes: tuple[int, ...] = MESHES) -> Iterator[Row]:
    """The rows of a case."""
    for n in meshes:
        settings = {"surface": case.surface, "element": case.element, **case.settings}
        result = solve(*complete("manufactured", settings, f"{n}x{n}", measure=case.measure))
        yield {**case.said, "n": n, **result.quantities, "class": result.verdict}


@tabulated
def manufactured_contact() -> Iterator[Row]:
    """A row a measure, surface, mesh and radius of contact, with the errors of pressure and edge, too.

    All measures on one surface, the exact one on three of them, and there on one mesh more.
    """
    own = product(("exact",), CONTACT_SURFACES, MESHES)
    others = product((name for name in MEASURES if name != "exact"), (FINEST_ON,), MESHES)
    for measure, surface, n in chain(own, [("exact", FINEST_ON, 2 * MESHES[-1])], others):
        result = solve(*complete("manufactured-contact", {"surface": surface}, f"{n}x{n}", measure=measure))
        case = {"measure": measure, "surface": surface, "n": n, "class": result.verdict}
        for step in result.steps:
            errors = {key: step[key] for key in step if key.startswith("error_") or key == "radius"}
            yield {**case, **errors, "newton_iterations": step["newton_iterations"]}


@tabulated
def statements() -> Iterator[Row]:
    """A row a coefficient of a table that is not what its measure states, and one a measure without any."""
    for name, measure in MEASURES.items():
        if isinstance(measure, QuadraticMeasure):
            wrong = [str(each) for each in wrong_coefficients(measure, STATEMENTS[name])]
            yield from ({"measure": name, "wrong": words} for words in wrong or [""])


AMOUNTS = (0.06, 0.12, 0.24)  # from 0.25 on an element of a random mesh can be concave
MOVED_MESHES = (16, 32, 64)
SURFACE = "torus"
DEFAULT = ON_MESHES["quads"]
OPTIONS = tuple(
    {**DEFAULT, "thickness_strain": strain, "membrane": membrane}
    for strain, membrane in product(THICKNESS_STRAINS, MEMBRANES)
)
SHELLS: Mapping[str, tuple[str, int, int]] = {  # what is read off, and the elements of the coarser mesh
    "scordelis-lo": ("edge_deflection_mm", 16, 16),
    "pinched-cylinder": ("deflection_mm", 16, 16),
    "hemisphere": ("outward_mm", 16, 16),
    "sze-annulus": ("w_B_mm", 6, 48),
    "cantilever": ("tip_deflection_mm", 16, 4),
    "raasch-hook": ("tip_deflection_mm", 56, 8),
    "hypar": ("tip_deflection_mm", 32, 16),
    "twisted-beam": ("tip_deflection_mm", 24, 4),
    "morley-skew-plate": ("w_bar", 16, 16),
}


def ways(amounts: Sequence[float]) -> Iterator[tuple[str, float]]:
    """How nodes are moved and how far: not at all, then each way by each amount."""
    yield "regular", 0.0
    yield from product(DISTORTIONS, amounts)


def moved(kind: str, amount: float) -> dict[str, str]:
    """The settings of a moved mesh."""
    return {"distortion": kind, "distort": f"{amount:g}"} if amount else {}


@tabulated
def distortion(measures: Sequence[str] = tuple(MEASURES), meshes: Sequence[int] = MOVED_MESHES) -> Iterator[Row]:
    """Errors of manufactured solutions on a torus: a row a measure, distortion and mesh of n x n elements.

    error_*: as the scene of manufactured solutions reads them.
    """
    for measure, (kind, amount), n in product(measures, ways(AMOUNTS[1:]), meshes):
        settings = {"surface": SURFACE, "element": "quads", **moved(kind, amount)}
        result = solve(*complete("manufactured", settings, f"{n}x{n}", measure=measure))
        case = {"measure": measure, "distortion": kind, "amount": amount, "n": n}
        yield {**case, **result.quantities, "class": result.verdict}


@tabulated
def distorted_shells(shells: Sequence[str] = tuple(SHELLS)) -> Iterator[Row]:
    """Deflections of linear shells: the default element on two meshes, the second twice as fine, each option on one.

    change: value over that of the same element on the same mesh whose nodes stay, less 1.
    """
    cases: list[tuple[dict[str, str], int, Sequence[float]]] = [(DEFAULT, 1, AMOUNTS), (DEFAULT, 2, AMOUNTS)]
    cases += [(options, 1, AMOUNTS[1:2]) for options in OPTIONS if options != DEFAULT]
    for scene, (options, finer, amounts) in product(shells, cases):
        quantity, n1, n2 = SHELLS[scene]
        mesh, still = f"{n1 * finer}x{n2 * finer}", 0.0
        for kind, amount in ways(amounts):
            result = solve(*complete(scene, {**options, **moved(kind, amount)}, mesh, measure="linear"))
            value = float(result.quantities[quantity])
            still = still if amount else value
            case = {"scene": scene, "quantity": quantity, "mesh": mesh, "finer": finer, **options}
            seen = {"distortion": kind, "amount": amount, "value": value, "change": value / still - 1}
            yield {**case, **seen, "class": result.verdict}

"""Manufactured solutions on meshes that are refined: errors that are known, for every measure, surface and element.

Each row is one solve of a scene of :mod:`studies.scenes.manufactured`; orders are fitted to them elsewhere.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import chain, product

from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.section.laminate import SECTIONS
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import QuadraticMeasure
from formulations.strains.quantities import FULL
from studies.experiments import Row, tabulated
from studies.scenes.complete import complete
from studies.scenes.element import PRESETS
from studies.scenes.manufactured.patches import PIECES
from studies.scenes.manufactured.statements import STATEMENTS, wrong_coefficients
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

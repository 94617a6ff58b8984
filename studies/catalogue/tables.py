"""All tables of the sheets: scenes, measures and algorithms as their own words and data have them, and answers."""

from __future__ import annotations

import inspect
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields
from fractions import Fraction
from pathlib import Path

import pandas as pd

from contact.catalogue import ALGORITHMS
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import QuadraticMeasure, RigidBodyLaw, StrainMeasure
from formulations.strains.quantities import QUANTITIES, STRAINS
from studies.ask.scene import has_contact, models_of, sheet_of
from studies.catalogue.bodies import Built, built_models, drawn_bodies, marks
from studies.catalogue.descriptions import (
    describe,
    kinematics_of,
    law_text,
    meaning_of,
    paragraphs,
    plain_text,
    said_of_scene,
)
from studies.catalogue.values import answered, values
from studies.catalogue.words import loads, obstacle, shape_of, solid_supports, supports
from studies.run.answers import Answers
from studies.run.lists import SHEETS
from studies.scenes import SCENES
from studies.scenes.element import ShearCorrected
from studies.scenes.faces.model import FacesModel

PARTS = ("kind", "part", "meaning", "about", "source", "module", "up", "azimuth_deg", "elevation_deg")
SETTINGS = ("kind", "part", "key", "meaning", "unit", "range", "default")
FACTS = ("scene", "section", "item", "said")
CONSTANTS = ("E_L", "E_T", "E_N", "G_LT", "G_LN", "G_TT", "nu_LT", "nu_LN", "nu_TT")
PLIES = ("scene", "ply", "thickness_mm", "angle_deg", *CONSTANTS)
TERMS = ("measure", "strain", "formula", "dropped")
LAWS = ("measure", "motion", "law", "at_tenth")


def parts() -> pd.DataFrame:
    """PARTS: a row a part of the three catalogues, in their order; about: paragraphs, a blank line between them.

    up, azimuth_deg, elevation_deg: from where a scene is seen.
    """
    scenes = []
    for name, scene in SCENES.items():
        sheet = sheet_of(scene)
        view = (sheet.up, sheet.azimuth, sheet.elevation)
        scenes.append(("scene", name, meaning_of(name), said_of_scene(scene), "", _module(scene), *view))
    measures = [
        ("measure", name, meaning_of(name), _about_measure(each), each.reference, _module(each))
        for name, each in MEASURES.items()
    ]
    algorithms = []
    for name, algorithm in ALGORITHMS.items():
        _, *about = paragraphs(algorithm())
        whole = "\n\n".join(about)
        text, _, source = whole.partition("Source: ")
        when = plain_text(inspect.getdoc(algorithm.supports) or "")
        algorithms.append(
            ("algorithm", name, meaning_of(name), f"{text.strip()}\n\n{when}", source, _module(algorithm()))
        )
    rows = [*scenes, *((*row, None, None, None) for row in (*measures, *algorithms))]
    return pd.DataFrame(rows, columns=list(PARTS))


def _module(part: object) -> str:
    return type(part).__module__


def _about_measure(measure: StrainMeasure) -> str:
    """What its slopes and stretches leave out, and its stress."""
    slope, stretch = kinematics_of(measure)
    text = f"Slope {slope}; stretch of a face at the distance d from the reference surface {stretch}."
    return f"{text}\n\n{_conjugate(measure)}"


def _conjugate(measure: StrainMeasure) -> str:
    """To which strain the resultants of a measure are conjugate."""
    forces = (
        "The forces are the derivative of the energy ½ E·D·E by the displacements, so that the resultants H = D E do"
    )
    forces += " the work of the very strains above whatever they leave out, and a symmetric D has a symmetric tangent."
    if getattr(measure, "formulas", None) == getattr(MEASURES["exact"], "formulas", ()):
        return f"{forces} H are resultants of the second Piola-Kirchhoff stress, conjugate to the strain of Green."
    return f"{forces} They are resultants of the second Piola-Kirchhoff stress only as far as the strains are Green's."


def terms() -> pd.DataFrame:
    """TERMS: the formula of every strain of a face by every measure, and what the exact one has beside that."""
    rows = []
    whole = _monomials(MEASURES["exact"])
    for name, measure in MEASURES.items():
        formulas: dict[str, str] = getattr(measure, "formulas", {})
        own = _monomials(measure)
        for strain, formula in formulas.items():
            lacks = "" if own is None or whole is None else " ".join(_lacking(whole[strain], own[strain]))
            rows.append((name, strain, formula, lacks))
    return pd.DataFrame(rows, columns=list(TERMS))


def _monomials(measure: StrainMeasure) -> dict[str, dict[str, float]] | None:
    """Coefficients by strain and monomial, of a quadratic measure."""
    if not isinstance(measure, QuadraticMeasure):
        return None
    names = [quantity.rstrip("-+") for quantity in QUANTITIES]
    coefficients: dict[str, dict[str, float]] = {}
    for row, strain in enumerate(STRAINS):
        if strain.endswith("-"):
            continue
        linear = {names[i]: float(measure.linear[row, i]) for i in measure.linear[row].nonzero()[0]}
        Q = measure.quadratic[row]
        pairs = {
            (f"{names[i]}²" if i == j else f"{names[i]} {names[j]}"): float(Q[i, j]) / (2 if i == j else 1)
            for i, j in zip(*Q.nonzero(), strict=True)
            if i <= j
        }
        coefficients[strain.rstrip("+")] = linear | pairs
    return coefficients


def _lacking(whole: dict[str, float], own: dict[str, float]) -> Iterator[str]:
    """The terms of one that the other has not, as they stand in a sum."""
    for monomial in dict.fromkeys((*whole, *own)):
        off = whole.get(monomial, 0.0) - own.get(monomial, 0.0)
        if off:
            size = Fraction(abs(off)).limit_denominator(1000)
            yield f"{'+' if off > 0 else '-'} {'' if size == 1 else f'{size} '}{monomial}"


def laws() -> pd.DataFrame:
    """LAWS: the strain that a rigid motion leaves by the law of every measure, and its value at 0.1, zeta = 1.05."""
    rows = [
        (name, motion.name, law_text(law, motion.name), getattr(law, motion.name)(0.1, 1.05))
        for name, law in ((name, measure.rigid_body_law) for name, measure in MEASURES.items())
        for motion in fields(RigidBodyLaw)
    ]
    return pd.DataFrame(rows, columns=list(LAWS))


def settings() -> pd.DataFrame:
    """SETTINGS: of scenes and algorithms."""
    described = [describe(name) for name in (*SCENES, *ALGORITHMS)]
    rows = [(each.kind, each.name, *row) for each in described for row in each.rows]
    return pd.DataFrame(rows, columns=list(SETTINGS))


def facts(built: Sequence[Built]) -> pd.DataFrame:
    """FACTS: what the model of a sheet's cell is made of, as sentences by section and item."""
    rows = [(each.cell.scene, *fact) for each in built for fact in _facts(each)]
    return pd.DataFrame(rows, columns=list(FACTS))


def _facts(built: Built) -> Iterator[tuple[str, str, str]]:
    body, scene = built.body, built.scene
    n1, n2 = scene.default_mesh
    yield "Model", "default mesh", f"{n1}x{n2} elements along a1 and a2"
    yield "Model", "parts that can be solved", ", ".join(models_of(scene))
    yield "Model", "contact", "yes" if has_contact(scene) else "none"
    if isinstance(body, ShellModel):
        yield from _shell_facts(body, by_share=any(each.key == "load_fraction" for each in scene.settings))
    elif body is not None:
        yield "Geometry", "body", f"{len(body.mesh.elements)} triquadratic hexahedra between the two faces of the wall"
        yield from (("Supports", where, said) for where, said in solid_supports(body))
    if built.laminate is not None:
        yield from _wall_facts(built.laminate)
    if built.foundation is not None:
        yield "Contact", "foundation", obstacle(built.foundation)
    if isinstance(built.model, FacesModel):
        yield "Contact", "faces", f"{built.model.said}; both deform"


def _shell_facts(shell: ShellModel, *, by_share: bool) -> Iterator[tuple[str, str, str]]:
    body = shell.discretisation
    shape = shape_of(body.surface)
    yield "Geometry", "reference surface", shape.kind
    yield "Geometry", "points", shape.formula
    for axis, (low, high) in enumerate(body.grid.ends):
        unit = f" {shape.axes[axis]}" if shape.axes[axis] else ""
        turned = f" ({math.degrees(low):.6g} to {math.degrees(high):.6g} deg)" if shape.axes[axis] == "rad" else ""
        yield "Geometry", f"a{axis + 1}", f"from {low + 0.0:.6g} to {high:.6g}{unit}{turned}"
    yield from (("Supports", where, said) for where, said in supports(body))
    yield from (("Load of load fraction 1" if by_share else "Load", kind, said) for kind, said in loads(shell))
    yield "Material", "law through the thickness", shell.section


def _wall_facts(wall: Laminate) -> Iterator[tuple[str, str, str]]:
    offset = f"faces at {wall.d_minus:.6g} and {wall.d_plus:.6g} mm from the reference surface along the normal"
    yield "Material", "thickness", f"{wall.thickness:.6g} mm; {offset}"
    if isinstance(wall, ShearCorrected) and wall.shear_correction != 1:
        yield "Material", "shear correction", f"{wall.shear_correction:.6g} on the mean transverse shear stiffness"


def plies(built: Sequence[Built]) -> pd.DataFrame:
    """PLIES: of every wall from the inside out."""
    rows = [
        (each.cell.scene, number, *_ply(ply))
        for each in built
        if each.laminate is not None
        for number, ply in enumerate(each.laminate.plies, start=1)
    ]
    return pd.DataFrame(rows, columns=list(PLIES))


def _ply(ply: Ply) -> tuple[float, ...]:
    return (ply.thickness, math.degrees(ply.angle), *ply.moduli, *ply.shears, *ply.poisson)


def catalogue_tables(
    store: Path, campaign: str, convergence: pd.DataFrame, models: Iterable[Built] | None = None
) -> dict[str, pd.DataFrame]:
    """By name; none for a campaign without such cells.  models: of all scenes, unless some are given."""
    answers = Answers.of(store, campaign)
    if not any(row.get("group") == SHEETS for row in answers.planned.values()):
        return {}
    built = list(built_models() if models is None else models)
    points, quads = drawn_bodies(answers)
    return {
        "sheet_parts": parts(),
        "sheet_settings": settings(),
        "sheet_facts": facts(built),
        "sheet_plies": plies(built),
        "sheet_terms": terms(),
        "sheet_laws": laws(),
        "sheet_values": values(answers, convergence),
        "sheet_answers": answered(answers),
        "sheet_marks": marks(built),
        "sheet_points": points,
        "sheet_quads": quads,
    }

"""The cells behind the pages of the report, as named lists that campaigns are put together from."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

from contact.catalogue import ALGORITHMS
from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.element.strain_operator import ON_LINES
from studies.ask.request import text_of
from studies.run.scene_cells import BENCHMARKS as BENCHMARK_LADDERS
from studies.run.scene_cells import ladder_cells, share_cells, sheet_cells
from studies.scenes.complete import Cell
from studies.scenes.tyre.scene import ISOTROPIC

_PAPER = {"element": "paper"}


def enforcements(default: float) -> tuple[tuple[str, str], ...]:
    """The exact condition, which all algorithms must agree on, and what an algorithm does if not told otherwise."""
    return (("exact", "inf"),) if math.isinf(default) else (("exact", "inf"), ("epsilon", text_of(default)))


def _tyre(label: str, settings: Mapping[str, str] | None = None, **options: Any) -> Cell:
    """All of the tyre, so that its symmetry is a finding, unless ``model`` says otherwise."""
    return Cell(label, "tyre", {"model": "full", **options}, {**_PAPER, **(settings or {})})


def _of(group: str, cells: Iterable[Cell]) -> tuple[Cell, ...]:
    """Cells that say which list they are of."""
    return tuple(replace(cell, group=group) for cell in cells)


_TO_20 = {"delta_mm": "20"}
_ANSWERS = {"exact": {"epsilon": "inf"}, "epsilon": {"epsilon": "1e4"}}

TYRE = (
    _tyre("paper", {"delta_mm": ",".join(str(d) for d in (5, 10, 15, *range(20, 28)))}),
    _tyre("linear", measure="linear"),
    *(
        _tyre(f"{measure} {contact} {newton} {kind}", {**_TO_20, **epsilon}, **options)
        for measure in ("exact", "linear")
        for contact in ("semismooth", "trial-and-error")
        for newton in (("mixed", "plain") if measure == "exact" else ("mixed",))
        for kind, epsilon in _ANSWERS.items()
        for options in [
            {"measure": measure, "contact": contact, "newton": newton, "steps": 4 if newton == "plain" else 1}
        ]
    ),
    _tyre("fine", _TO_20, mesh="84x80"),
    _tyre("isotropic", ISOTROPIC),
    _tyre("isotropic fine", ISOTROPIC, mesh="84x80"),
)
_NEAR = {"delta_mm": "20,21,22,23,24,25"}  # mm, travels at which the printed table may be meant
_FACE = {"load": "follower", "pressure_area": "face"}
READINGS = (  # the paper's tyre with one thing changed, beside its printed table
    *(_tyre(f"reading {measure}", _NEAR, measure=measure) for measure in ("von-karman", "sanders", "donnell")),
    _tyre("reading linear", {"delta_mm": "14,16,18,19,20,21,22,24"}, measure="linear"),
    _tyre("reading 84x80", _NEAR, mesh="84x80"),
    _tyre("reading face area", {**_NEAR, "pressure_area": "face"}),
    _tyre("reading follower", {**_NEAR, **_FACE}),
    _tyre("reading full-3d", {**_NEAR, "section": "full-3d"}),
    _tyre("reading consistent", {**_NEAR, "coupling": "consistent"}),
    *(  # data within their rounding
        _tyre(f"reading {key} {value}", {**_NEAR, key: value})
        for key, values in (
            ("gamma_deg", ("51.5", "52.5")),
            ("ply_thickness_mm", ("1.15", "1.25")),
            ("p0_MPa", ("0.145", "0.155")),
        )
        for value in values
    ),
)
BUDGETED = {"follower": _FACE, "full-3d": {"section": "full-3d"}, "nonsymmetric": {"section": "nonsymmetric"}}
BUDGET_MESHES = ("28x26", "42x40", "84x80")
BUDGET = tuple(  # what another load or section changes, on three meshes, over the cells of one step
    _tyre(f"budget {name} {mesh}", {**_TO_20, **settings}, mesh=mesh, model="half")
    for name, settings in BUDGETED.items()
    for mesh in BUDGET_MESHES
)
SOLID = (
    *(Cell(f"solid {mesh}", "tyre-solid", {"mesh": mesh}) for mesh in ("14x18", "28x36", "56x72")),  # each is nested
    Cell("solid penalty", "tyre-solid", {"mesh": "28x36"}, {"epsilon": "20"}),  # as in the reference by NGSolve
    _tyre("isotropic coarse", ISOTROPIC, mesh="28x26"),
)
_WHOLE_LOAD = {"load_fraction": "1", **_PAPER}
BENCHMARKS = (
    *(
        Cell(f"{ladder.name} {mesh.split('x')[0]}", ladder.scene, {"mesh": mesh}, _PAPER)
        for ladder in BENCHMARK_LADDERS
        for mesh in ladder.meshes
    ),
    Cell("hemisphere one step mixed", "hemisphere", {"newton": "mixed"}, _WHOLE_LOAD),
    Cell(
        *("hemisphere one step plain", "hemisphere", {"newton": "plain"}, _WHOLE_LOAD),
        expected="plain Newton cannot take the whole load in one step; the step has to be cut",
    ),
    Cell("hemisphere twenty steps plain", "hemisphere", {"newton": "plain", "steps": 20}, _WHOLE_LOAD),
)


OPTIONS = tuple(
    Cell(f"hemisphere {n} {' '.join(chosen)}", "hemisphere", {"mesh": f"{n}x{n}"}, {"load_fraction": "1", **options})
    for chosen in product(ON_LINES, THICKNESS_STRAINS, MEMBRANES)
    for options in [dict(zip(("interpolation", "thickness_strain", "membrane"), chosen, strict=True))]
    for n in (8, 16, 32)
)


CONVERGENCE = (
    *ladder_cells({"element": "refined"}, "refined"),
    *ladder_cells({"element": "paper"}, "paper", finest=False),
)
_WAYS: dict[str, tuple[str, dict[str, str]]] = {  # settings that change how an algorithm gets there
    "semismooth, settle 1": ("semismooth", {"settle": "1"}),
    "qp, eps 1e-3": ("qp", {"eps": "1e-3"}),
    "qp, clarabel": ("qp", {"backend": "clarabel"}),
    "qp, full": ("qp", {"system": "full"}),
    "lcp, active-set": ("lcp", {"method": "active-set"}),
    "lcp, nnls": ("lcp", {"method": "nnls"}),
    "lcp, full": ("lcp", {"system": "full"}),
}


def agreement() -> tuple[Cell, ...]:
    """Every algorithm of the catalogue as it is, and by the other ways, for two loads and two sections."""
    return _of(
        "agreement",
        (
            _tyre(
                f"agreement {way} {load['load']} {section} {kind}",
                {**load, "section": section, "delta_mm": "5,10,15,20", "epsilon": epsilon, **settings},
                contact=contact,
                model="half",
            )
            for way, (contact, settings) in ({name: (name, {}) for name in ALGORITHMS} | _WAYS).items()
            for kind, epsilon in enforcements(math.inf if settings else ALGORITHMS[contact]().epsilon)
            for load in ({"load": "dead"}, {"load": "follower", "pressure_area": "mid"})
            for section in ("constant-s33", "nonsymmetric")
        ),
    )


_EXACT = {"epsilon": "inf"}


def _one_step(way: str, mesh: str, settle: dict[str, str], expected: str = "") -> Cell:
    """Inflation, then 20 mm at once."""
    settings = {**_TO_20, **_EXACT, **settle}
    cell = _tyre(f"one step {way} {mesh}", settings, mesh=mesh, contact="semismooth", model="half")
    return replace(cell, expected=expected)


_SETTLED = {"settle": "1"}
_FAR = _tyre("far", {"delta_mm": "20,25,30,35,40", **_EXACT}, contact="semismooth", model="half")
ROBUSTNESS = _of(
    "agreement",
    (
        *(_one_step("semismooth", mesh, {}) for mesh in ("28x26", "42x40", "84x80")),
        *(_one_step("semismooth, settle 1", mesh, _SETTLED) for mesh in ("28x26", "42x40")),
        _one_step("semismooth, settle 1", "84x80", _SETTLED, "the textbook's method chases sets far from the solution"),
        replace(_FAR, expected="asked for more travel than there is"),
    ),
)
MODELS = _of(
    "models",
    (  # what a part of the tyre saves, and that it changes nothing
        *(_tyre(f"model {model} angle plies", _TO_20, model=model) for model in ("full", "half")),
        *(
            _tyre(f"model {model} isotropic", {**ISOTROPIC, **_TO_20}, model=model)
            for model in ("full", "half", "mirror", "quarter")
        ),
    ),
)


@dataclass(frozen=True)
class CellList:
    """A list that campaigns are put together from: its cells, and the tables of the whole store that belong to them.

    cells: made when they are asked for; catalogues grow.
    """

    title: str
    cells: Callable[[], Iterable[Cell]] = tuple
    tables: tuple[str, ...] = ()


LISTS: dict[str, CellList] = {
    "tyre": CellList(
        "The paper's tyre: travels, loads, sections, both Newton iterations, finer meshes",
        lambda: (*TYRE, *READINGS, *BUDGET),
    ),
    "benchmarks": CellList("Scenes without contact against exact and published values", lambda: BENCHMARKS),
    "measures": CellList(
        "Every strain measure under growing loads, and all options of the element",
        lambda: OPTIONS,
        ("rigid_body", "small_motions", "rotation_sweep", "rotations"),
    ),
    "solid": CellList(
        "The isotropic tyre as a shell and as a solid",
        lambda: (*(cell for cell in TYRE if cell.label.startswith("isotropic")), *SOLID),
    ),
    "convergence": CellList("Ladders of meshes: orders, limits, errors", lambda: CONVERGENCE),
    "shares": CellList("Every sampling of the thickness strain, on two meshes each", share_cells),
    "agreement": CellList(
        "Every contact algorithm on one tyre, by loads and sections, and by other ways",
        lambda: (*agreement(), *ROBUSTNESS),
        ("epsilon", "cycles", "false_success", "membrane", "greco_plate"),
    ),
    "models": CellList("Parts of the tyre beside the whole, and what they save", lambda: MODELS, ("work_precision",)),
    "sheets": CellList("The pictures of the scenes' sheets", sheet_cells),
    "choices": CellList("What is enough in each regime of deformation, to 5 and 1 % (a table)", tables=("choices",)),
    "statements": CellList("How often the interval of an error holds (a table)", tables=("error_coverage",)),
    "experiment": CellList("A crushed ring that was measured (tables)", tables=("crushed_ring", "law_strain")),
    "truth": CellList(
        "Manufactured solutions (tables)",
        tables=("manufactured", "manufactured_contact", "manufactured_statements"),
    ),
    "distortion": CellList(
        "Meshes that follow no coordinates: what moved nodes cost (tables)", tables=("distortion", "distorted_shells")
    ),
    "limits": CellList("Where a shell is not enough (a table)", tables=("shell_limits",)),
    "what-if": CellList(
        "What a change of its data does to the tyre, and its most even footprint (tables)",
        tables=("what_if", "even_footprint", "every_footprint"),
    ),
    "faults": CellList("After how many random cases planted faults are found (a table)", tables=("fuzz_faults",)),
    "arena": CellList("The collection of frozen contact problems (tables)", tables=("problems", "problems_left_out")),
    "faces": CellList(
        "Two faces that meet: pairings, slaves, algorithms, cost, half-spheres, ironing (tables)",
        tables=("faces", "faces_algorithms", "faces_cost", "faces_spheres", "faces_ironing"),
    ),
    "friction": CellList(
        "Friction: the tyre dragged and turned, closed forms, agreement (tables)",
        tables=(
            "friction_dragged",
            "friction_turned",
            "friction_patch",
            "friction_steps",
            "friction_symmetry",
            "friction_crushed_ring",
            "friction_cost",
            "friction_agreement",
            "friction_greco",
            "friction_klarbring",
            "friction_strip",
            "friction_drum",
            "friction_capstan",
            "friction_parking",
            "friction_rolling",
            "friction_path",
            "friction_joint_motion",
            "friction_tied",
            "friction_public",
        ),
    ),
}
LISTS["report"] = CellList(
    "All of these lists but statements, and the tables of all pages",
    lambda: (
        *(*TYRE, *READINGS, *BUDGET, *SOLID, *BENCHMARKS, *OPTIONS, *CONVERGENCE),
        *(*agreement(), *ROBUSTNESS, *MODELS, *share_cells(), *sheet_cells()),
    ),
    (
        *(table for name, each in LISTS.items() if name != "statements" for table in each.tables),
        *("thickness_locking", "shear_locking", "curved_beam", "membrane_locking"),
        *("symmetry", "mirror", "extremes", "extremes_maps", "extremes_check", "extremes_limits"),
    ),
)

"""The cells behind the pages of the report, as named lists that campaigns are put together from (lists.toml)."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
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


CELLS: dict[str, Callable[[], Iterable[Cell]]] = {  # made when they are asked for; catalogues grow
    "tyre": lambda: (*TYRE, *READINGS, *BUDGET),
    "benchmarks": lambda: BENCHMARKS,
    "measures": lambda: OPTIONS,
    "solid": lambda: (*(cell for cell in TYRE if cell.label.startswith("isotropic")), *SOLID),
    "convergence": lambda: CONVERGENCE,
    "shares": share_cells,
    "agreement": lambda: (*agreement(), *ROBUSTNESS),
    "models": lambda: MODELS,
    "sheets": sheet_cells,
    "report": lambda: (
        *(*TYRE, *READINGS, *BUDGET, *SOLID, *BENCHMARKS, *OPTIONS, *CONVERGENCE),
        *(*agreement(), *ROBUSTNESS, *MODELS, *share_cells(), *sheet_cells()),
    ),
}


@dataclass(frozen=True)
class CellList:
    """A list that campaigns are put together from.

    tables: of the whole store that belong to it, and by which function, ``module:name``, each is made.
    """

    title: str
    cells: Callable[[], Iterable[Cell]]
    tables: Mapping[str, str]


DECLARED = tomllib.loads(Path(__file__).with_name("lists.toml").read_text(encoding="utf-8"))
LISTS = {name: CellList(it["title"], CELLS.get(name, tuple), it.get("tables", {})) for name, it in DECLARED.items()}
MAKERS = {table: maker for each in LISTS.values() for table, maker in each.tables.items()}
LISTS["report"] = replace(
    LISTS["report"], tables={name: maker for name, maker in MAKERS.items() if name not in LISTS["statements"].tables}
)

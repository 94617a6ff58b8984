"""The cells behind the pages of the report, as named lists that campaigns are put together from (lists.toml)."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

from contact.catalogue import ALGORITHMS
from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.element.strain_operator import ON_LINES
from studies.ask.request import text_of
from studies.run.scene_cells import BENCHMARKS as BENCHMARK_LADDERS
from studies.run.scene_cells import ladder_cells, share_cells, sheet_cells
from studies.scenes.complete import Cell

_PAPER = {"element": "paper"}


def enforcements(default: float) -> tuple[tuple[str, str], ...]:
    """The exact condition, which all algorithms must agree on, and what an algorithm does by default."""
    return (("exact", "inf"),) if math.isinf(default) else (("exact", "inf"), ("epsilon", text_of(default)))


OF_A_CELL = ("measure", "contact", "newton", "mesh", "model", "steps")  # its options; all else are settings
ONE_BY_ONE = tomllib.loads(Path(__file__).with_name("cells.toml").read_text(encoding="utf-8"))


def _cells(part: str) -> Iterator[Cell]:
    """Those of a part of cells.toml."""
    for label, own in ONE_BY_ONE[part]["cells"].items():
        settings = {**ONE_BY_ONE[part]["shared"], **own}
        scene, expected, group = (settings.pop(name, "") for name in ("scene", "expected", "group"))
        options = {name: settings.pop(name) for name in list(settings) if name in OF_A_CELL}
        yield Cell(label, scene, options, settings, expected=expected, group=group)


PARTS = ("tyre", "readings", "solid", "robustness", "models")
TYRE, READINGS, SOLID, ROBUSTNESS, MODELS = (tuple(_cells(part)) for part in PARTS)
_FACE = {"load": "follower", "pressure_area": "face"}
BUDGETED = {"follower": _FACE, "full-3d": {"section": "full-3d"}, "nonsymmetric": {"section": "nonsymmetric"}}
BUDGET_MESHES = ("28x26", "42x40", "84x80")
BUDGET = tuple(  # what another load or section changes, on three meshes, over the cells of one step
    Cell(f"budget {name} {mesh}", "tyre", {"model": "half", "mesh": mesh}, {**_PAPER, "delta_mm": "20", **settings})
    for name, settings in BUDGETED.items()
    for mesh in BUDGET_MESHES
)
BENCHMARKS = (
    *(
        Cell(f"{ladder.name} {mesh.split('x')[0]}", ladder.scene, {"mesh": mesh}, _PAPER)
        for ladder in BENCHMARK_LADDERS
        for mesh in ladder.meshes
    ),
    *_cells("benchmarks"),
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
    return tuple(
        Cell(
            f"agreement {way} {load['load']} {section} {kind}",
            "tyre",
            {"model": "half", "contact": contact},
            {**_PAPER, **load, "section": section, "delta_mm": "5,10,15,20", "epsilon": epsilon, **settings},
            group="agreement",
        )
        for way, (contact, settings) in ({name: (name, {}) for name in ALGORITHMS} | _WAYS).items()
        for kind, epsilon in enforcements(math.inf if settings else ALGORITHMS[contact]().epsilon)
        for load in ({"load": "dead"}, {"load": "follower", "pressure_area": "mid"})
        for section in ("constant-s33", "nonsymmetric")
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

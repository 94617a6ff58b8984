"""Named lists of cells that campaigns are put together from (lists.toml), among them those that every scene has.

Ladders: the same serve every element and every table over all scenes.

Shares, which are sampled at the nodes: every ladder's scene at its whole load. The meshes are half of the scene's
default one each way, where an element's own error shows, and the default one, which has to confirm what the coarse one
says of limit points.

Sheets: each is its scene at the whole load with the measure it is meant for, on a mesh whose fields fit on a page; the
tyre also at the travels of a filmstrip.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from contact.catalogue import ALGORITHMS
from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.element.strain_operator import ON_LINES
from studies.ask.declarations import BENCHMARKS as PUBLISHED
from studies.ask.declarations import Ladder
from studies.ask.request import text_of
from studies.ask.scene import ladders_of, sheet_of
from studies.scenes import SCENES
from studies.scenes.complete import Cell

if TYPE_CHECKING:
    import pandas as pd

LADDER_LABEL = "convergence {ladder} {mesh} {element}"
CLIMBED = tomllib.loads(Path(__file__).with_name("ladders.toml").read_text(encoding="utf-8"))


def _declared(family: str, scenes: Iterable[str]) -> tuple[Ladder, ...]:
    return tuple(ladder for name in scenes for ladder in ladders_of(SCENES[name]) if ladder.family == family)


LADDERS = tuple(ladder for family, scenes in CLIMBED.items() for ladder in _declared(family, scenes))
BENCHMARKS = _declared(PUBLISHED, ("cantilever", "hemisphere"))


def ladder_cells(element_settings: Mapping[str, str], element_label: str, *, finest: bool = True) -> tuple[Cell, ...]:
    """The cells of all ladders with one element; their labels are those that the pages ask for.

    ``finest``: with the last mesh of each ladder, which costs more than all others together.
    """
    return tuple(
        Cell(
            LADDER_LABEL.format(ladder=ladder.name, mesh=mesh, element=element_label),
            ladder.scene,
            {"measure": ladder.measure, "mesh": mesh},
            {**ladder.settings, **element_settings},
        )
        for ladder in LADDERS
        for mesh in ladder.climbed(finest=finest)
    )


SHARE_LABEL, SHARES = "share {ladder} {mesh} {share}", "shares"
COARSE = {"tyre": "20x20"}  # even numbers only
COMPARED = tuple(ladder for ladder in LADDERS if ladder.settings.get("interpolation", "curvilinear") == "curvilinear")


def meshes_of(ladder: Ladder) -> tuple[str, str]:
    """Half of the default mesh of its scene, and that mesh."""
    n1, n2 = SCENES[ladder.scene].default_mesh
    return COARSE.get(ladder.scene, f"{max(1, n1 // 2)}x{max(1, n2 // 2)}"), f"{n1}x{n2}"


def read_at(ladder: Ladder) -> dict[str, float]:
    """The step where its quantities are read, which is the one that its limit is of; empty: the whole path."""
    if ladder.at:
        key, _, value = ladder.at.partition("=")
        return {key: float(value)}
    return {key: float(ladder.settings[key]) for key in ladder.whole if key in ladder.settings and key != "until"}


def share_cells() -> Iterator[Cell]:
    """Both meshes with every share; all else as in the default element."""
    for ladder in COMPARED:
        settings = {**ladder.settings, **ladder.whole}
        for mesh in meshes_of(ladder):
            for share in THICKNESS_STRAINS:
                label = SHARE_LABEL.format(ladder=ladder.name, mesh=mesh, share=share)
                options = {"measure": ladder.measure, "mesh": mesh}
                settings["thickness_strain"] = share
                yield Cell(label, ladder.scene, options, dict(settings), artefacts=False, group=SHARES)


SHEET_LABEL, FRAME, SHEETS = "sheet {scene}", "sheet tyre at {delta} mm", "sheets"
FRAMES = ("1", "4", "8", "12", "16", "20")  # mm of travel


def sheet_cell(name: str) -> Cell:
    """The cell of a scene's sheet, for any scene of the catalogue."""
    scene = SCENES[name]
    ladder, sheet = next(iter(ladders_of(scene)), None), sheet_of(scene)
    n1, n2 = scene.default_mesh
    options = {"measure": ladder.measure} if ladder else {}
    options |= {"mesh": sheet.mesh or f"{n1}x{n2}", **({"model": sheet.model} if sheet.model else {})}
    settings = {**ladder.settings, **ladder.whole} if ladder else {}
    return Cell(SHEET_LABEL.format(scene=name), name, options, {**settings, **sheet.settings}, group=SHEETS)


def frames() -> Iterator[Cell]:
    """The tyre of its sheet at the travels of the filmstrip."""
    last = sheet_cell("tyre")
    for delta in FRAMES:
        label, settings = FRAME.format(delta=delta), {**last.settings, "delta_mm": delta}
        yield Cell(label, "tyre", last.options, settings, group=SHEETS)


def sheet_cells() -> Iterator[Cell]:
    """All of those that are listed."""
    yield from (sheet_cell(name) for name, scene in SCENES.items() if sheet_of(scene).listed)
    yield from frames()


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
BENCHMARK_CELLS = (
    *(
        Cell(f"{ladder.name} {mesh.split('x')[0]}", ladder.scene, {"mesh": mesh}, _PAPER)
        for ladder in BENCHMARKS
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
    "benchmarks": lambda: BENCHMARK_CELLS,
    "measures": lambda: OPTIONS,
    "solid": lambda: (*(cell for cell in TYRE if cell.label.startswith("isotropic")), *SOLID),
    "convergence": lambda: CONVERGENCE,
    "shares": share_cells,
    "agreement": lambda: (*agreement(), *ROBUSTNESS),
    "models": lambda: MODELS,
    "sheets": sheet_cells,
    "report": lambda: (
        *(*TYRE, *READINGS, *BUDGET, *SOLID, *BENCHMARK_CELLS, *OPTIONS, *CONVERGENCE),
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


def add_tables(name: str, title: str, *makers: Callable[..., pd.DataFrame]) -> None:
    """Put a list of tables of one's own beside these; a table is named like the function that makes it.

    Raises ValueError for a name that is taken.
    """
    tables = {make.__name__: f"{make.__module__}:{make.__name__}" for make in makers}
    for taken in sorted(LISTS.keys() & {name} | MAKERS.keys() & tables.keys()):
        raise ValueError(f"{taken!r} is the name of a list or a table already")
    LISTS[name] = CellList(title, tuple, tables)
    MAKERS.update(tables)

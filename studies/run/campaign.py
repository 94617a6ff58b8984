"""What a campaign is: lists of cells by name, and crosses of everything with everything, as a short TOML file says.

::

    title = "..."
    lists = ["benchmarks"]        # of studies/run/lists.py, with the tables that belong to them
    pages = "all"                 # the pages of the report; without it, the short ones of any campaign
    modules = ["my_scenes"]       # beside the file, run with --trust: they put scenes and algorithms into catalogues

    [[cross]]
    name = "sweep"                # how its labels begin
    measures = "all"
    contacts = ["semismooth", "qp"]
    tolerances = [1e-3, 1e-9]
    set = { element = "paper" }
    [cross.scenes.tyre]           # what is said here counts for this scene, before what is said above
    meshes = ["12x12", "16x14"]
    set = { delta_mm = "20" }

Axes: ``measures contacts newtons models meshes`` are options of ``footprint solve``, ``sections loads elements epsilons
tolerances`` settings, and ``vary = { KEY = [...] }`` makes an axis of any other setting.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contact.catalogue import ALGORITHMS
from contact.interchange.untrusted import read_toml
from formulations.shell import NEWTONS
from formulations.strains.catalogue import MEASURES
from studies.ask.request import Request, text_of
from studies.ask.scene import UsageError, has_contact
from studies.run.lists import LISTS
from studies.run.schema import KINDS, fault
from studies.scenes import SCENES
from studies.scenes.complete import Cell
from studies.scenes.plugins import load, used

SHIPPED = Path(__file__).parent / "shipped"
OPTIONS = {"measures": "measure", "contacts": "contact", "newtons": "newton", "models": "model", "meshes": "mesh"}
SETTINGS = {
    **{"sections": "section", "loads": "load", "elements": "element"},
    **{"epsilons": "epsilon", "tolerances": "tolerance"},
}
CATALOGUES: dict[str, Mapping[str, Any]] = {
    "measures": MEASURES,
    "contacts": ALGORITHMS,
    "newtons": dict.fromkeys(NEWTONS),
    "scenes": SCENES,
}
MOST_CELLS, MOST_KEYS, LONGEST_LABEL = 100_000, 100, 1000


@dataclass(frozen=True)
class Campaign:
    """Cells by unique labels, tables of the whole store."""

    name: str
    title: str
    cells: tuple[Cell, ...]
    tables: tuple[str, ...] = ()
    pages: str = ""


def find(name: str, *, trust: bool = False) -> Campaign:
    """A shipped campaign, a list of cells, or a TOML file by its path; raises UsageError.

    trust: modules that the file names are imported; without it such a file is refused.
    """
    path = SHIPPED / f"{name}.toml"
    if path.exists():
        return read(path)
    if name in LISTS:
        listed = LISTS[name]
        return Campaign(name, listed.title, tuple(listed.cells()), tuple(listed.tables))
    if name.endswith(".toml"):
        return read(Path(name), trust=trust)
    raise UsageError(f"campaign {name!r} must be one of {', '.join(names())}, or the path of a .toml file")


def names() -> list[str]:
    """Those that need no file of one's own."""
    return [*(path.stem for path in sorted(SHIPPED.glob("*.toml"))), *LISTS]


def read(path: Path, *, trust: bool = False) -> Campaign:
    """The campaign of a TOML file, named like the file; trust: its modules are imported. Raises UsageError."""
    try:
        data = read_toml(path)
    except OSError as error:
        raise UsageError(f"campaign {path}: {error.strerror}") from None
    except ValueError as error:
        raise UsageError(f"campaign {path}: {' '.join(str(error).split())}") from None
    _known(path, data, "file_of_a_campaign")
    if wrong := fault(data, KINDS["file_of_a_campaign"]):
        raise UsageError(f"campaign {path}: {wrong}")
    _load_modules(path, data.get("modules", []), trust=trust)
    lists = [LISTS[name] for name in _listed(path, data, "lists", LISTS)]
    cells = [cell for listed in lists for cell in listed.cells()]
    for cross in data.get("cross", []):
        cells += _crossed(path, cross, MOST_CELLS - len(cells))
    unique = _without_repeats(path, cells)
    tables = tuple(dict.fromkeys(table for listed in lists for table in listed.tables))
    if not unique and not tables:
        raise UsageError(f"campaign {path} has nothing to solve: it needs lists, or [[cross]] with scenes")
    return Campaign(path.stem, data.get("title", path.stem), unique, tables, data.get("pages", ""))


def _load_modules(path: Path, names: Sequence[str], *, trust: bool) -> None:
    """Import a user's own modules, in the folder of the campaign, beside those in use; raises UsageError."""
    folder, files = path.parent.resolve(), []
    for name in names:
        if not name.isidentifier():
            raise UsageError(f"campaign {path}: modules has {name!r}, which must be the name of a module beside it")
        package = folder / name / "__init__.py"
        files.append(package if package.exists() else folder / f"{name}.py")
        if not files[-1].resolve().is_relative_to(folder):
            raise UsageError(f"campaign {path}: {files[-1]} leads out of the folder of the campaign")
    if files and not trust:
        ran = ", ".join(file.name for file in files)
        raise UsageError(f"campaign {path} runs {ran} beside it: allow this by footprint run --trust")
    if files:
        load((*used(), *files))


def _crossed(path: Path, cross: Mapping[str, Any], most: int) -> Iterator[Cell]:
    """The cells of one cross, at most so many, scene by scene; the last axis varies fastest.

    Of a scene without contact the contact algorithms are no axis.
    """
    _known(path, cross, "cross")
    if not isinstance(cross.get("scenes"), Mapping):
        raise UsageError(f"campaign {path}: a cross needs its scenes, as tables [cross.scenes.NAME]")
    for scene in _listed(path, {"scenes": list(cross["scenes"])}, "scenes", SCENES):
        own = cross["scenes"][scene]
        _known(path, own, "of_a_scene")
        held = own.get("set", {})
        asked = {**cross, **own, "vary": {**cross.get("vary", {}), **own.get("vary", {})}}
        constant = {**cross.get("set", {}), **held}
        varied = [set(_axes(path, level)) for level in (cross, own)]
        for level, keys in zip((cross, own), varied, strict=True):
            for key in keys & set(level.get("set", {})):
                raise UsageError(f"campaign {path}: {key} of {scene} is both a setting and an axis: keep one of them")
        axes = {key: values for key, values in _axes(path, asked).items() if key in varied[1] or key not in held}
        if "contact" in axes and not has_contact(SCENES[scene]):
            axes["contact"] = [Request.contact]  # one stands for all: the others would solve the same
        most -= math.prod(map(len, axes.values()))
        longest = len(scene) + sum(max(map(len, values), default=0) + len(key) for key, values in axes.items())
        if most < 0 or len(axes) + len(constant) > MOST_KEYS or longest > LONGEST_LABEL:
            bounds = f"{MOST_CELLS} cells, {MOST_KEYS} settings of a cell, {LONGEST_LABEL} letters of a label"
            raise UsageError(f"campaign {path} exceeds a limit: {bounds}")
        steps = {"steps": asked["steps"]} if "steps" in asked else {}
        for values in itertools.product(*axes.values()):
            chosen = dict(zip(axes, values, strict=True))
            options = {key: value for key, value in chosen.items() if key in OPTIONS.values()}
            settings = {key: value for key, value in chosen.items() if key not in options}
            parts = [*options.values(), *(f"{key}={value}" for key, value in settings.items())]
            label = " ".join([str(cross.get("name", "cross")), scene, *parts])
            given = {key: text_of(value) for key, value in constant.items()} | settings
            yield Cell(label, scene, {**options, **steps}, given, artefacts=False)


def _axes(path: Path, asked: Mapping[str, Any]) -> dict[str, list[str]]:
    """Values by option or setting."""
    vary = asked.get("vary", {})
    named = {name: key for name, key in {**OPTIONS, **SETTINGS}.items() if name in asked}
    axes = {key: _listed(path, asked, name, CATALOGUES.get(name)) for name, key in named.items()}
    axes |= {key: _listed(path, vary, key, None) for key in vary}
    for key, values in axes.items():
        if not values:
            raise UsageError(f"campaign {path}: the axis {key} has no value")
    return axes


def _listed(path: Path, data: Mapping[str, Any], name: str, catalogue: Mapping[str, Any] | None) -> list[str]:
    """The values of a key as text, each of the catalogue if there is one; "all" stands for it."""
    values = data.get(name, [])
    if values == "all" and catalogue is not None:
        return list(catalogue)
    if not isinstance(values, list):
        raise UsageError(f"campaign {path}: {name} = {values!r} must be a list" + (' or "all"' if catalogue else ""))
    for value in values:
        if catalogue is not None and value not in catalogue:
            raise UsageError(f"campaign {path}: {value!r} in {name} must be one of {', '.join(catalogue)}")
    return [text_of(value) for value in values]


def _known(path: Path, data: Mapping[str, Any], kind: str) -> None:
    keys = KINDS[kind]
    assert isinstance(keys, Mapping)
    for key in data:
        if key not in keys:
            raise UsageError(f"campaign {path}: key {key!r} must be one of {', '.join(keys)}")


def _without_repeats(path: Path, cells: list[Cell]) -> tuple[Cell, ...]:
    """The cells; the same one of two lists counts once. Raises UsageError for one label of two cells."""
    by_label: dict[str, Cell] = {}
    for cell in cells:
        if by_label.setdefault(cell.label, cell) != cell:
            raise UsageError(f"campaign {path}: two cells have the label {cell.label!r}")
    return tuple(by_label.values())

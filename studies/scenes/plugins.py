"""Parts from outside: Python files, named by ``--use`` or by a campaign, and entry points of installed packages.

A file puts its parts into the catalogues when it is imported, a line each, as ours do. An entry point of a group below
names one part; its name is that of the part. What a part computes does not enter here.
"""

import importlib
import re
import shlex
import sys
import traceback
from collections.abc import Iterable, Iterator, Mapping, MutableMapping
from contextlib import contextmanager, suppress
from importlib.metadata import EntryPoint, entry_points
from inspect import signature
from operator import attrgetter
from pathlib import Path
from typing import Any

from contact.algorithms.base import ContractError
from contact.catalogue import ALGORITHMS
from formulations.section.laminate import LAWS
from formulations.strains.catalogue import MEASURES
from studies.ask.request import PartError, Request, UsageError
from studies.ask.scene import Scene, SceneModel, Setting
from studies.scenes import SCENES

NAME = re.compile(r"\w[\w .,+=-]{0,79}")  # of a part: a word of commands, tables and files
UNEXPECTED = re.compile(r"([\w.]+)\(\) got an unexpected keyword argument ")
OURS = ("contact", "formulations", "reports", "studies")


@contextmanager
def blamed(contact: str, measure: str = "exact", scene: Scene | None = None) -> Iterator[None]:
    """Raise PartError for an exception or an invalid answer of a part from outside.

    Where no part is from outside, an exception is a fault of the suite and is passed on unchanged.
    """
    try:
        yield
    except (UsageError, MemoryError):
        raise
    except ContractError as error:
        raise PartError(str(error)) from error
    except (Exception, SystemExit) as error:
        message = _said(error, _from_outside(contact, measure, scene))
        if message is None:
            raise
        raise PartError(message) from error


def built(scene: Scene, request: Request) -> SceneModel:
    """What the scene builds of a request; raises UsageError, and PartError where a scene from outside breaks."""
    with blamed(request.contact, request.measure, scene):
        return scene.build(request)


def _from_outside(contact: str, measure: str, scene: Scene | None) -> dict[str, str]:
    """The modules of the parts that are not ours, by what the parts are called."""
    modules = {
        f"contact algorithm {contact!r}": ALGORITHMS[contact].__module__,
        f"measure {measure!r}": type(MEASURES[measure]).__module__,
    }
    if scene is not None:
        modules[f"scene {scene.name!r}"] = type(scene).__module__
    return {part: module for part, module in modules.items() if module.partition(".")[0] not in OURS}


def _said(error: BaseException, parts: dict[str, str]) -> str | None:
    """The line: of the part in whose file it was raised, or of all that are from outside where it was in none."""
    what = _line(error)
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        for part, module in parts.items():
            if frame.filename == getattr(sys.modules.get(module), "__file__", None):
                return f"{part}: {Path(frame.filename).name}:{frame.lineno}: {what}"
    return f"{' or '.join(parts)}: {what}" if parts else None


GROUPS: dict[str, MutableMapping[str, Any]] = {
    "footprint.measures": MEASURES,
    "footprint.contact": ALGORITHMS,
    "footprint.scenes": SCENES,
    "footprint.laws": LAWS,
}
NEEDED = {  # of a part, beside its name
    "footprint.measures": ("reference", "rigid_body_law", "kinematics", "strain", "gradient", "contract"),
    "footprint.contact": ("parameters", "epsilon", "supports", "solve"),
    "footprint.scenes": ("title", "default_mesh", "settings", "references", "build"),
    "footprint.laws": ("__call__",),
}
TAKEN = "the name is taken by another part; choose another one"
_used: list[str] = []  # the files of --use and of campaigns, which worker processes and printed commands need, too
_module_of: dict[tuple[str, str], str] = {}  # the module that a part came with, by group and name
_entered: set[EntryPoint] = set()


def load(files: Iterable[str | Path] = ()) -> None:
    """Put the parts of all entry points and of these files into the catalogues; raises UsageError."""
    load_entry_points()
    paths = [Path(file).resolve() for file in files]
    for path in paths:
        load_file(path)
    _used[:] = map(str, paths)


def load_entry_points() -> None:
    """Put the parts of all entry points into the catalogues, each once; raises UsageError."""
    known = entry_points()  # of all groups: each question reads the names of everything that is installed
    for group, catalogue in GROUPS.items():
        for entry in known.select(group=group):
            if entry not in _entered:
                _enter(entry, group, catalogue)
                _entered.add(entry)


def used() -> tuple[str, ...]:
    """The files that :func:`load` was last given."""
    return tuple(_used)


def use_options() -> list[str]:
    """The words of a printed command by which it finds these files: by their paths from here, if they are below."""
    here = Path.cwd()
    paths = (path.relative_to(here) if path.is_relative_to(here) else path for path in map(Path, _used))
    return [f"--use {shlex.quote(str(path))}" for path in paths]


def load_file(path: Path) -> None:
    """Import one file, whose folder is searched for what it imports; raises UsageError naming it."""
    package = path.parent if path.name == "__init__.py" else path.with_suffix("")
    name, folder = package.name, str(package.parent)
    if not path.is_file():
        raise UsageError(f"plug-in {path}: no such file")
    if folder not in sys.path:
        sys.path.insert(0, folder)
    before = {group: dict(catalogue) for group, catalogue in GROUPS.items()}
    try:
        module = importlib.import_module(name)
    except (Exception, SystemExit) as error:
        raise UsageError(f"plug-in {path}: {_line(error)}") from error
    if Path(str(module.__file__)).resolve() != path:
        raise UsageError(f"plug-in {path}: the name {name!r} is taken by {module.__file__}; rename the file")
    added = [
        (group, part)
        for group, catalogue in GROUPS.items()
        for part in catalogue.keys() - {key for key, known in before[group].items() if catalogue.get(key) is known}
    ]
    try:
        for group, part in added:
            _check_named(f"plug-in {path}: {part!r} of {group}", group, part, before[group])
    except UsageError:  # the next file, or the next try with this one, finds all as it was
        for group, part in added:
            GROUPS[group].pop(part)
            GROUPS[group].update({part: before[group][part]} if part in before[group] else {})
        sys.modules.pop(name, None)
        raise
    _module_of.update(dict.fromkeys(added, name))


def _check_named(label: str, group: str, name: str, before: Mapping[str, Any]) -> None:
    part = GROUPS[group][name]
    if not isinstance(name, str) or not NAME.fullmatch(name):
        raise UsageError(f"{label}: the name must be 1 to 80 letters, digits, spaces and any of _ . , + = -")
    if name in before:
        raise UsageError(f"{label}: {TAKEN}")
    if getattr(part, "name", name) != name:
        raise UsageError(f"{label}: the name of the part is {part.name!r}")
    _check(label, group, part)


def modules_of(measure: str, contact: str, scene: str, law: str = "") -> set[str]:
    """The modules from outside that these parts came with."""
    named_parts = zip(GROUPS, (measure, contact, scene, law), strict=True)
    return {_module_of[part] for part in named_parts if part in _module_of}


def modules() -> set[str]:
    """The modules of all parts from outside."""
    return set(_module_of.values())


def _enter(entry: EntryPoint, group: str, catalogue: MutableMapping[str, Any]) -> None:
    label = f"plug-in {entry.name!r} of {group} ({entry.value})"
    before = catalogue.get(entry.name)
    try:
        part = entry.load()
    except (Exception, SystemExit) as error:
        raise UsageError(f"{label}: {_line(error)}") from error
    name = getattr(part, "name", None)
    if name != entry.name:
        raise UsageError(f"{label}: the name of the part is {name!r}")
    if before is not None and before is not part:
        raise UsageError(f"{label}: {TAKEN}")
    _check(label, group, part)
    catalogue[entry.name] = part
    _module_of[group, entry.name] = entry.module


def _check(label: str, group: str, part: Any) -> None:
    """Raises UsageError for a part that is not complete, or has a default out of its range.

    An algorithm is a class, and each parameter a field of it; a measure and a scene are instances.
    """
    missing = [name for name in NEEDED[group] if not hasattr(part, name)]
    if missing:
        raise UsageError(f"{label}: the part has no {', '.join(missing)}")
    if group == "footprint.contact":
        missing = [each.key for each in getattr(part, "parameters", ()) if not hasattr(part, each.key)]
        if missing or not isinstance(part, type):
            what = f"no default for {', '.join(missing)}" if missing else "to be a class, not an instance"
            raise UsageError(f"{label}: the part has {what}")
        try:
            part()
        except Exception as error:
            raise UsageError(f"{label}: with its defaults: {_line(error)}") from error
    elif group in ("footprint.measures", "footprint.scenes") and isinstance(part, type):
        raise UsageError(f"{label}: the part has to be an instance, not a class")
    elif group == "footprint.scenes" and not _is_mesh(mesh := getattr(part, "default_mesh", None)):
        raise UsageError(f"{label}: default_mesh has to be two whole numbers from 1, not {mesh!r}")
    try:
        for setting in _settings(group, part):
            setting.parse(setting.default)
    except ValueError as error:
        raise UsageError(f"{label}: default {error}") from None


def _settings(group: str, part: Any) -> list[Setting]:
    """What a user may set of an algorithm or a scene, but for what the scene works out."""
    if group == "footprint.contact":
        return [Setting.of(each, getattr(part, each.key)) for each in part.parameters]
    return [each for each in part.settings if each.default is not None] if group == "footprint.scenes" else []


def _is_mesh(mesh: object) -> bool:
    return isinstance(mesh, tuple | list) and len(mesh) == 2 and all(isinstance(n, int) and n > 0 for n in mesh)


def _line(error: BaseException) -> str:
    """What it is and says; of an argument that a call does not know, with the names that it does."""
    line, names = " ".join(f"{type(error).__name__}: {error}".split()), _arguments(error)
    return f"{line}; there are {', '.join(names)}" if names else line


def _arguments(error: BaseException) -> list[str]:
    """Those of what is ours, where that was called with an unknown one; else none, as of its namesake in the caller."""
    called = UNEXPECTED.match(str(error)) if isinstance(error, TypeError) else None
    if called is None:
        return []
    *_, (caller, _) = traceback.walk_tb(error.__traceback__)
    own = (caller.f_globals | caller.f_locals).get(called[1].partition(".")[0])
    if own is not None and str(getattr(own, "__module__", "")).partition(".")[0] not in OURS:
        return []
    for name in [name for name in sys.modules if name.partition(".")[0] in OURS]:
        with suppress(AttributeError):
            part = attrgetter(called[1])(sys.modules[name])
            if part.__module__ == name:
                return [each for each in signature(part).parameters if each != "self"]
    return []

"""Which sources decide a result: the import closure of what computes it, and the hash of its statements.

Every import of our own modules counts, wherever in a file it stands, and their names in quotes, and the packages that a
module lies in; so does a file of data beside a module that it names as ``Path(__file__).with_name("...")``. What is
imported for annotations alone is never executed, and a module without statements does nothing: neither counts. For a
cell some modules are not followed: see BESIDE_A_CELL, and of parts of ours ONLY_WITH.
"""

from __future__ import annotations

import ast
import hashlib
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
PACKAGES = ("formulations", "contact", "studies")
MODULE = re.compile(rf"({'|'.join(PACKAGES)})(\.\w+)+")
BESIDE_A_CELL = (
    *("studies.scenes", "contact.catalogue"),  # they name all of theirs, and a cell names its own
    # they decide the request, which is hashed as such, or what it is compared with
    *("studies.scenes.complete", "studies.ask.scene", "studies.ask.declarations", "studies.scenes.data"),
    *("studies", "studies.scenes.plugins"),
    *("studies.output", "studies.output.provenance"),  # they tell of a solve, and do nothing in it
    "studies.solving.fields",  # it writes what a solve by itself has seen, of which a cell keeps less
    *("contact.interchange", "contact.interchange.*"),  # of frozen problems, which a cell does not keep
)
# what nothing else executes than what a request says that it has
ONLY_WITH: Mapping[str, tuple[str, ...]] = {
    "friction": (
        *("contact.coulomb", "contact.slip", "contact.verify_friction", "contact.newton.friction_*"),
        *("contact.algorithms.tresca", "contact.continuation.friction_path"),
        *("studies.scenes.friction_readings", "studies.solving.friction_stages"),
    ),
    "candidates": (  # for contact: sets of them, and a foundation that moves or is passed through
        *(f"contact.newton.{name}" for name in ("condensed", "exchange", "held", "pivots", "saddle")),
        *("contact.solvers.lcp_pivoting", "contact.swept", "contact.continuation.turning_points"),
    ),
    "surfaces between the faces": (  # and a solid
        *("formulations.element.walls.*", "formulations.wall_stresses"),
        *(f"formulations.section.{name}" for name in ("laws", "material", "sampling")),
    ),
    "quadrilaterals": ("formulations.element.quad_*",),
    "bending along arcs": ("formulations.element.arc_element",),
    "hanging nodes": ("formulations.geometry.arcs", "formulations.geometry.quadtree"),
}


def sources_hash(modules: Iterable[str], root: Path = ROOT, *, without: tuple[str, ...] = ()) -> str:
    """Hash of the sources, by module name, of the closure of ``modules``; neither machine nor place enter."""
    named = frozenset(modules)
    ours = all(name.split(".")[0] in PACKAGES for name in named)
    return _hash(named, root, without) if ours else _digest(named, root, without)  # a file of a user's may change


@cache
def _hash(modules: frozenset[str], root: Path, without: tuple[str, ...]) -> str:
    return _digest(modules, root, without)


def _digest(modules: frozenset[str], root: Path, without: tuple[str, ...]) -> str:
    digest = hashlib.sha256()
    for name, hashes in hashed(modules, root, without=without).items():
        digest.update(f"{name} {hashes}\n".encode())
    return digest.hexdigest()


def hashed(modules: Iterable[str], root: Path = ROOT, *, without: tuple[str, ...] = ()) -> dict[str, str]:
    """Those of the closure that have statements, sorted by name: the hash of these, and of the data beside them."""
    hashes = {}
    for name in sorted(closure(modules, root, without=without)):
        path = _path_of(name, root)
        assert path is not None
        source = _read(path.read_bytes(), "")
        if source.statements:
            data = (place.read_bytes() for file in source.beside if (place := path.with_name(file)).is_file())
            hashes[name] = " ".join((source.statements, *(hashlib.sha256(each).hexdigest() for each in data)))
    return hashes


def closure(modules: Iterable[str], root: Path = ROOT, *, without: tuple[str, ...] = ()) -> set[str]:
    """Names of all our modules that ``modules`` import, directly or not, with themselves, but no name like ``without``.

    A module outside our packages counts when it is named (a part of a user's own), and what it imports from its folder.
    """
    names: set[str] = set()
    ahead = [name for name in modules if _path_of(name, root) is not None]
    while ahead:
        name = ahead.pop()
        if name not in names and not any(fnmatchcase(name, each) for each in without):
            names.add(name)
            ahead += () if name in PACKAGES else _imports(name, root)  # those re-export what a notebook calls
    return names


def data_of(name: str, root: Path = ROOT) -> list[Path]:
    """Tables and lists that a module may read: beside it, and in packages of ours that it imports itself.

    What a module beside them names as its own counts with that module alone.
    """
    path = _path_of(name, root)
    if path is None:
        return []
    places = [_our_path(each, root) for each in _ours(name, path, root)] if root in path.parents else []
    folders = {path.parent, *(place.parent for place in places if place and place.name == "__init__.py")}
    named = {folder / file for folder in folders for each in folder.glob("*.py") for file in _beside(each)}
    return sorted({file for folder in folders for file in folder.iterdir() if file.suffix in (".csv", ".json")} - named)


def _beside(path: Path) -> tuple[str, ...]:
    return _read(path.read_bytes(), "").beside


def _imports(name: str, root: Path) -> tuple[str, ...]:
    """Our modules that a module imports, with the packages they lie in; those from its folder of one from outside."""
    path = _path_of(name, root)
    assert path is not None
    if name.split(".")[0] in PACKAGES:
        return _ours(name, path, root)
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    beside = {each for each in _read(path.read_bytes(), package).imports if each.split(".")[0] not in PACKAGES}
    places = {each: _path_of(each, root) for each in beside}
    return (*_ours(name, path, root), *(each for each, at in places.items() if at and path.parent in at.parents))


@cache
def _ours(name: str, path: Path, root: Path) -> tuple[str, ...]:
    named = set(_read(path.read_bytes(), "").imports)
    parents = {
        ".".join(parts[:i]) for each in (*named, name) for parts in [each.split(".")] for i in range(1, len(parts))
    }
    ours = (each for each in named | parents if each.split(".")[0] in PACKAGES)
    return tuple(sorted(each for each in ours if _path_of(each, root) is not None))


class _Source(NamedTuple):
    """Of a module: the hash of its statements without comments, docstrings and layout, empty where it has none; what it
    imports; files of data beside it.
    """

    statements: str
    imports: tuple[str, ...]
    beside: tuple[str, ...]


@cache
def _read(source: bytes, package: str) -> _Source:
    """What a module does."""
    tree = ast.parse(source)
    nodes = list(ast.walk(tree))
    named, beside = tuple(_named(nodes, package)), tuple(_data(nodes))
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    for node in nodes:
        if isinstance(node, documented) and ast.get_docstring(node):
            node.body[:1] = [] if len(node.body) > 1 or isinstance(node, ast.Module) else [ast.Pass()]
    code = ast.unparse(tree).removeprefix("from __future__ import annotations")
    return _Source(hashlib.sha256(code.encode()).hexdigest() if code.strip() else "", named, beside)


def _data(nodes: Sequence[ast.AST]) -> Iterator[str]:
    """Names of files beside a module, those that it spells out."""
    for node in nodes:
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute) or node.func.attr != "with_name":
            continue
        if ast.unparse(node.func) == "Path(__file__).with_name":
            values = (each.value for each in node.args if isinstance(each, ast.Constant))
            yield from (
                name for name in values if isinstance(name, str) and "\0" not in name and Path(name).name == name
            )


def _named(nodes: Sequence[ast.AST], package: str = "") -> Iterator[str]:
    """What is imported to be executed: modules, and names that may be modules; relative ones in a package."""
    annotating = _only_annotating(nodes)
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.Constant) and MODULE.fullmatch(name := str(node.value)):
            yield name  # of a catalogue that loads what is asked for
        elif isinstance(node, ast.ImportFrom) and (package or not node.level):
            parents = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            module = ".".join((*parents, *([node.module] if node.module else [])))
            names = [alias.name for alias in node.names if alias.asname or alias.name not in annotating]
            if names:
                yield module
                yield from (f"{module}.{name}" for name in names)


def _only_annotating(nodes: Sequence[ast.AST]) -> set[str]:
    """Names that stand in annotations and nowhere else, in no list of what is exported either; none where annotations
    are evaluated.
    """
    if not any(isinstance(node, ast.ImportFrom) and node.module == "__future__" for node in nodes):
        return set()
    annotations = [getattr(node, name, None) for node in nodes for name in ("annotation", "returns")]
    inside = {id(part) for each in annotations if each is not None for part in ast.walk(each)}
    names = [node for node in nodes if isinstance(node, ast.Name)]
    texts = {node.value for node in nodes if isinstance(node, ast.Constant)}
    used = {node.id for node in names if id(node) not in inside} | texts
    return {node.id for node in names if id(node) in inside} - used


def _path_of(name: str, root: Path) -> Path | None:
    """The file of a module; None when there is none, as of a name inside a module."""
    if name.split(".")[0] in PACKAGES:
        return _our_path(name, root)
    file = getattr(sys.modules.get(name), "__file__", None)
    return Path(file) if file else None


@cache
def _our_path(name: str, root: Path) -> Path | None:
    base = root.joinpath(*name.split("."))
    return next((path for path in (base.with_suffix(".py"), base / "__init__.py") if path.is_file()), None)

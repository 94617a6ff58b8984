"""Which sources decide a result: the import closure of what computes it, and the hash of its statements.

Every import of our own modules counts, wherever in a file it stands, and the packages that a module lies in. For a
cell the catalogue of scenes is not followed: it imports all of them, and a cell is solved by its own scene alone. Nor,
without friction, what is imported with it alone.
"""

from __future__ import annotations

import ast
import hashlib
import sys
from collections.abc import Iterable, Iterator
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("formulations", "contact", "studies")
CATALOGUE = ("studies.scenes",)
FRICTION = ("contact.friction", "contact.friction.*", "studies.friction.stages")


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
    for name in sorted(closure(modules, root, without=without)):
        path = _path_of(name, root)
        assert path is not None
        digest.update(f"{name} {_read(path.read_bytes(), '')[0]}\n".encode())
    return digest.hexdigest()


def closure(modules: Iterable[str], root: Path = ROOT, *, without: tuple[str, ...] = ()) -> set[str]:
    """Names of all our modules that ``modules`` import, directly or not, with themselves, but no name like ``without``.

    A module outside our packages counts when it is named (a part of a user's own), and what it imports from its folder.
    """
    found: set[str] = set()
    ahead = [name for name in modules if _path_of(name, root) is not None]
    while ahead:
        name = ahead.pop()
        if name not in found and not any(fnmatchcase(name, each) for each in without):
            found.add(name)
            ahead += () if name in PACKAGES else _imports(name, root)  # those re-export what a notebook calls
    return found


def packages_of(name: str, root: Path = ROOT) -> set[Path]:
    """Folders of our packages that a module of ours imports itself, where the data lie that it may read."""
    path = _path_of(name, root)
    places = [_our_path(each, root) for each in _ours(name, path, root)] if path and root in path.parents else []
    return {place.parent for place in places if place is not None and place.name == "__init__.py"}


def _imports(name: str, root: Path) -> tuple[str, ...]:
    """Our modules that a module imports, with the packages they lie in; those from its folder of one from outside."""
    path = _path_of(name, root)
    assert path is not None
    if name.split(".")[0] in PACKAGES:
        return _ours(name, path, root)
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    beside = {each for each in _read(path.read_bytes(), package)[1] if each.split(".")[0] not in PACKAGES}
    places = {each: _path_of(each, root) for each in beside}
    return (*_ours(name, path, root), *(each for each, at in places.items() if at and path.parent in at.parents))


@cache
def _ours(name: str, path: Path, root: Path) -> tuple[str, ...]:
    named = set(_read(path.read_bytes(), "")[1])
    parents = {
        ".".join(parts[:i]) for each in (*named, name) for parts in [each.split(".")] for i in range(1, len(parts))
    }
    ours = (each for each in named | parents if each.split(".")[0] in PACKAGES)
    return tuple(sorted(each for each in ours if _path_of(each, root) is not None))


@cache
def _read(source: bytes, package: str) -> tuple[str, tuple[str, ...]]:
    """What a module does, as a hash of its source without comments, docstrings and layout; and what it imports."""
    tree = ast.parse(source)
    named = tuple(_named(tree, package))
    documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    for node in ast.walk(tree):
        if isinstance(node, documented) and ast.get_docstring(node):
            node.body[:1] = [] if len(node.body) > 1 or isinstance(node, ast.Module) else [ast.Pass()]
    return hashlib.sha256(ast.unparse(tree).encode()).hexdigest(), named


def _named(tree: ast.Module, package: str = "") -> Iterator[str]:
    """Everything that is imported: modules, and names that may be modules; relative ones in a package."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and (package or not node.level):
            parents = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            module = ".".join((*parents, *([node.module] if node.module else [])))
            yield module
            yield from (f"{module}.{alias.name}" for alias in node.names)


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

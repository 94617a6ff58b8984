"""Which sources decide a result: the import closure of what computes it, and its hash.

Every import of our own modules counts, wherever in a file it stands, and the packages that a module lies in. For a
cell the catalogue of scenes is not followed: it imports all of them, and a cell is solved by its own scene alone.
"""

from __future__ import annotations

import ast
import hashlib
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("formulations", "contact", "studies")
CATALOGUE = "studies.scenes"


def sources_hash(modules: Iterable[str], root: Path = ROOT, *, without: str = "") -> str:
    """Hash of the sources, by module name, of the closure of ``modules``; neither machine nor place enter."""
    return _hash(frozenset(modules), root, without)


@cache
def _hash(modules: frozenset[str], root: Path, without: str) -> str:
    digest = hashlib.sha256()
    for name in sorted(closure(modules, root, without=without)):
        path = _path_of(name, root)
        assert path is not None
        digest.update(f"{name} {hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return digest.hexdigest()


def closure(modules: Iterable[str], root: Path = ROOT, *, without: str = "") -> set[str]:
    """Names of all our modules that ``modules`` import, directly or not, with themselves; ``without`` is not followed.

    A module outside our packages counts when it is named (a scene of a user's own), not when it is imported.
    """
    found: set[str] = set()
    ahead = [name for name in modules if _path_of(name, root) is not None]
    while ahead:
        name = ahead.pop()
        if name not in found and name != without:
            found.add(name)
            ahead += _imports(name, root)
    return found


@cache
def _imports(name: str, root: Path) -> tuple[str, ...]:
    """Our modules that a module imports, with the packages they lie in."""
    path = _path_of(name, root)
    assert path is not None
    named = set(_named(ast.parse(path.read_bytes())))
    parents = {
        ".".join(parts[:i]) for each in (*named, name) for parts in [each.split(".")] for i in range(1, len(parts))
    }
    ours = (each for each in named | parents if each.split(".")[0] in PACKAGES)
    return tuple(sorted(each for each in ours if _path_of(each, root) is not None))


def _named(tree: ast.Module) -> Iterator[str]:
    """Everything that is imported: modules, and names that may be modules."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@cache
def _path_of(name: str, root: Path) -> Path | None:
    """The file of a module; None when there is none, as of a name inside a module."""
    if name.split(".")[0] not in PACKAGES:
        loaded = sys.modules.get(name)
        file = getattr(loaded, "__file__", None)
        return Path(file) if file else None
    base = root.joinpath(*name.split("."))
    return next((path for path in (base.with_suffix(".py"), base / "__init__.py") if path.is_file()), None)

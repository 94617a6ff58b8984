"""Sources of ours as trees: what a file imports, wherever in it."""

from __future__ import annotations

import ast
from functools import cache

DYNAMIC = ("import_module", "__import__", "resolve_name")
BLOCKS = ("body", "orelse", "handlers", "finalbody", "cases")  # where statements stand in a statement


@cache
def nodes_of(source: str) -> list[ast.AST]:
    """All statements of a file, and its expressions, too, where one of them may import."""
    if any(name in source for name in DYNAMIC):
        return list(ast.walk(ast.parse(source)))
    found: list[ast.AST] = [ast.parse(source)]
    for node in found:  # which grows
        found += [each for name in BLOCKS for each in getattr(node, name, ())]
    return found

"""Sources of ours as trees: what a file imports, wherever in it.

The blocks of a page of the documentation: commands, Python, files, and what the tests do not run.
"""

from __future__ import annotations

import ast
import re
import shlex
from dataclasses import dataclass
from functools import cache
from pathlib import Path

DYNAMIC = ("import_module", "__import__", "resolve_name")
BLOCKS = ("body", "orelse", "handlers", "finalbody", "cases")  # where statements stand in a statement


@cache
def nodes_of(source: str) -> list[ast.AST]:
    """All statements of a file, and its expressions, too, where one of them may import."""
    if any(name in source for name in DYNAMIC):
        return list(ast.walk(ast.parse(source)))
    values: list[ast.AST] = [ast.parse(source)]
    for node in values:  # which grows
        values += [each for name in BLOCKS for each in getattr(node, name, ())]
    return values


ROOT = Path(__file__).parents[2]
README, MANUAL = ROOT / "README.md", ROOT / "reports" / "manual"
PAGES = [README, *sorted(MANUAL.glob("*.md"))]
BLOCK = re.compile(r'(<!-- not run: [^>]+ -->\n)?^```(\w+)(?: title="([\w.]+)")?\n(.*?)^```', re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Block:
    """language: of the fence. title: the file that it is, or nothing. run: False below a reason not to."""

    language: str
    title: str
    text: str
    run: bool


def blocks(page: Path) -> list[Block]:
    actual = BLOCK.findall(page.read_text(encoding="utf-8"))
    return [Block(language, title, text, not reason) for reason, language, title, text in actual]


def file_of(page: str, title: str) -> str:
    """The text of a file on a page of the manual."""
    (actual,) = (each.text for each in blocks(MANUAL / f"{page}.md") if each.title == title)
    return actual


def lines(block: Block) -> list[tuple[str, int]]:
    """Each command of a block for the shell, with the exit code that its comment states; it may go on below."""
    values = []
    for line in block.text.replace("\\\n", " ").splitlines():
        command, _, comment = line.partition("  #")
        stated = re.search(r"^ exit (\d)", comment)
        values.append((command.strip(), int(stated[1]) if stated else 0))
    return [each for each in values if each[0]]


def commands(page: Path) -> list[list[str]]:
    """The words of every command ``footprint``, run or not."""
    shell = (each for each in blocks(page) if each.language == "sh")
    stated = (shlex.split(line, comments=True) for block in shell for line, _ in lines(block) if "footprint " in line)
    return [words[1:] for words in stated if words and words[0] == "footprint"]

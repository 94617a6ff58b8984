"""What the site adds to its Markdown as ``make docs`` builds it: a hook of MkDocs, which nothing of ours imports.

README, CONTRIBUTING and CHANGELOG become pages, the docstrings of all packages the API, formulas MathML, so that no
script is fetched. Links of the pages are those of the sources: what leads to code leads to its place in the API.
"""

from __future__ import annotations

import ast
import logging
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from posixpath import dirname, join, normpath, relpath
from typing import Any

ROOT = Path(__file__).parents[1]
PACKAGES = ("formulations", "contact", "studies", "reports")
MOUNTED = {"README.md": "index.md", ".github/CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
LEFT_OUT = ("studies.arena.template", "studies.footprint", "reports.documentation")  # files of a user, the door, this
LINK = re.compile(r"\[([^\[\]]+)\]\(([^)#\s]+)(#[^)\s]*)?\)")
FENCED = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
ROLE = re.compile(r":(?:mod|class|func|meth|attr|data):<code>~?([^<]+)</code>")
FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)


def on_files(files: Any, config: Any) -> Any:
    """Put the pages that lie elsewhere, and those of the API, beside the others."""
    from mkdocs.structure.files import File

    for source, name in MOUNTED.items():
        text = (ROOT / source).read_text(encoding="utf-8")
        files.append(File.generated(config, name, content=text))
    for name, text in api_pages().items():
        files.append(File.generated(config, name, content=text))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Links as the site has its pages; code is left alone."""
    name = page.file.src_uri
    places = {mounted: source for source, mounted in MOUNTED.items()}
    here = dirname(places.get(name, f"reports/{name}"))
    if name.startswith("api/"):
        return markdown

    def moved(match: re.Match[str]) -> str:
        if "://" in match[2]:
            return match[0]
        path = normpath(join(here, match[2]))
        if not (ROOT / path).exists():
            logging.getLogger("mkdocs").warning("%s: no file %s", name, path)  # an error where the build is strict
        target = site_name(path)
        return f"[{match[1]}]({relpath(target, dirname(name) or '.')}{match[3] or ''})" if target else match[1]

    fences = FENCED.findall(markdown)
    parts = [LINK.sub(moved, part) for part in FENCED.split(markdown)]
    return "".join(part + fence for part, fence in zip(parts, [*fences, ""], strict=True))


def on_page_content(html: str, page: Any, config: Any, files: Any) -> str:
    """Formulas as MathML, and names that docstrings refer to without their roles."""
    from latex2mathml.converter import convert

    html = ROLE.sub(r"<code>\1</code>", html)

    def drawn(match: re.Match[str]) -> str:
        return str(convert(match[2], display="block" if match[1] == "div" else "inline"))

    return FORMULA.sub(drawn, html)


def site_name(path: str) -> str | None:
    """Where a file of the tree is on the site: itself, the page that it became, its room of the API; None elsewhere."""
    if path in MOUNTED:
        return MOUNTED[path]
    if path.startswith(("reports/manual", "reports/pages")):
        return path.removeprefix("reports/")
    parts = path.split("/")
    if parts[0] in PACKAGES and (ROOT / path).suffix in ("", ".py"):
        return f"api/{room_of('.'.join(parts).removesuffix('.py').removesuffix('.__init__'))}.md"
    return None


@cache
def modules() -> dict[str, Path]:
    """Every public module of the four packages by its name."""
    paths = {}
    for path in (path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        if not name.startswith(LEFT_OUT):
            paths[name] = path
    return paths


def room_of(module: str) -> str:
    """The page of a module: its package and the first folder or file in it."""
    return ".".join(module.split(".")[:2])


def api_pages() -> dict[str, str]:
    """A page a room, a heading a module, and the list of them; first the names for users."""
    rooms: dict[str, list[str]] = {}
    for name in modules():
        rooms.setdefault(room_of(name), []).append(name)
    pages = {f"api/{room}.md": "\n".join([f"# {room}", "", *map(_directive, names)]) for room, names in rooms.items()}
    door = [f"::: {name}" for name in users_names()]
    text = "All names for users come from one package, `import footprint`. Parts of one's own import from the others.\n"
    pages["api/footprint.md"] = "\n\n".join(["# footprint", text, *door, ""])
    lines = [f"- [`{room}`]({room}.md): {_summary(modules()[room])}" for room in rooms]
    pages["api/index.md"] = "\n".join(["# API", "", "- [`footprint`](footprint.md): the names for users", *lines, ""])
    return pages


def users_names() -> Iterator[str]:
    """What ``import footprint`` has, each where it is defined."""
    tree = ast.parse((ROOT / "studies" / "footprint" / "__init__.py").read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("studies."):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _directive(module: str) -> str:
    """What is read from a module."""
    return "\n".join([f"## {module}", "", f"::: {module}", "    options:", "      show_root_heading: false", ""])


def _summary(path: Path) -> str:
    """The first sentence of a module."""
    said = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(said.split("\n\n")[0].split()).replace("``", "`")

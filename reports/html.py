"""All pages as ONE file of HTML that needs nothing else: style, script and pictures are in it, no network is.

Without a script the pages stand below one another; with it, one at a time, and a click on the head of a table sorts it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import partial
from html import escape
from pathlib import Path

from reports.dialect import to_html

REPORT = "report.html"
LARGEST = 8 * 2**20  # bytes
ASSETS = Path(__file__).parent / "assets"


def report_html(pages: Mapping[str, str], titles: Mapping[str, str], pictures: Mapping[str, str]) -> str:
    """The file from texts and titles of the pages by file name, and the SVG of their pictures by name.

    Raises ValueError for a link or a picture that leads nowhere, and for a file that has become too large.
    """
    prefixes = {name: f"p{number}" for number, name in enumerate(sorted(pictures))}
    inlined = {name: inlined_svg(svg, prefixes[name]) for name, svg in pictures.items()}
    sections = []
    for name, text in pages.items():
        body = to_html(text, partial(_target, name, pages), partial(_picture, inlined), partial(_anchor, name))
        sections.append(f'<section id="{_page(name)}">\n{body}\n</section>')
    links = "\n".join(f'<a href="#{_page(name)}">{escape(titles[name])}</a>' for name in pages)
    style, script = ((ASSETS / name).read_text(encoding="utf-8").strip() for name in ("report.css", "report.js"))
    whole = f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<link rel="icon" href="data:,">
<title>Footprint: results</title>
<style>
{style}
</style>
</head>
<body>
<nav>
{links}
</nav>
<main>
{chr(10).join(sections)}
</main>
<script>
{script}
</script>
</body>
</html>
"""
    _check_targets(whole)
    if len(whole.encode()) > LARGEST:
        raise ValueError(f"{REPORT} has {len(whole.encode())} bytes, more than {LARGEST}")
    return whole


def _page(name: str) -> str:
    return name.removesuffix(".md")


def _anchor(page: str, fragment: str) -> str:
    """The id of a heading: unlike those of other pages."""
    return f"{_page(page)}--{fragment}"


def _target(page: str, pages: Mapping[str, str], to: str) -> str:
    """Where a link of a page leads within the file."""
    name, _, fragment = to.partition("#")
    if name and name not in pages:
        raise ValueError(f"{page}: a link to {to}, which is no page")
    return f"#{_anchor(name or page, fragment)}" if fragment else f"#{_page(name)}"


def _picture(inlined: Mapping[str, str], name: str, words: str) -> str:
    if name not in inlined:
        raise ValueError(f"no picture {name!r}")
    return f"{inlined[name]}<figcaption>{escape(words)}</figcaption>"


def inlined_svg(svg: str, prefix: str) -> str:
    """An SVG element whose ids begin with ``prefix``, so that two pictures never share one; without what HTML has no
    use for. Raises ValueError for a picture that asks for another file.
    """
    body = svg[svg.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>\s*", "", body, flags=re.DOTALL)
    body = re.sub(r'\bid="([^"]+)"', rf'id="{prefix}-\1"', body)
    body = re.sub(r'(xlink:href|href)="#([^"]+)"', rf'\1="#{prefix}-\2"', body)
    body = re.sub(r"url\(#([^)]+)\)", rf"url(#{prefix}-\1)", body)
    foreign = re.search(r'(?:href|src)="(?!#|data:)([^"]{0,40})|url\((?!#|data:)([^)]{0,40})', body)
    if foreign:
        raise ValueError(f"a picture asks for {foreign[1] or foreign[2]!r}")
    return "\n".join(line for line in body.splitlines() if line).strip()


def _check_targets(whole: str) -> None:
    ids = re.findall(r'\bid="([^"]+)"', whole)
    if len(ids) != len(set(ids)):
        twice = sorted({name for name in ids if ids.count(name) > 1})[:3]
        raise ValueError(f"an id appears twice: {', '.join(twice)}")
    lost = sorted(set(re.findall(r'<a href="#([^"]+)"', whole)) - set(ids))
    if lost:
        raise ValueError(f"links lead nowhere: {', '.join(lost)}")

"""The file as a whole: navigation, the pages with their contents, the foot, style and script."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from html import escape
from pathlib import Path
from posixpath import dirname, join, normpath
from types import MappingProxyType

from reports.html.convert import to_html, words
from reports.html.pictures import Pictures

REPORT = "report.html"
OUTSIDE = "https://github.com/"
LARGEST = 8 * 2**20  # bytes
ASSETS = Path(__file__).parent / "assets"
STYLES = ("page.css", "tables.css", "print.css")
SCRIPTS = ("pages.js", "tables.js", "search.js", "scheme.js")
HEADING = re.compile(r'<h([23]) id="([^"]+)">(.*?)</h\1>')
SHOWN = re.compile(r"\]\((?:[^()\s]*/)?figures/([^()\s]+)\)")  # a picture on a page
FEWEST = 3  # headings from which a page has a list of them
DATA = "data/"  # files beside the pages: what leads there stays words, for they do not come with this one


def report_html(
    pages: Mapping[str, str],
    titles: Mapping[str, str],
    pictures: Mapping[str, str],
    groups: Mapping[str, Sequence[str]] = MappingProxyType({}),
    foot: str = "",
    above: Mapping[str, str] = MappingProxyType({}),
) -> str:
    """The file from texts and titles of the pages by file name, and the SVG of their pictures by name.

    groups: the pages that are linked at the top of each, by the title of their group; the first page is linked before
    them. foot: what stands below every page. above: the page that lists a page, by file name. Raises ValueError for a
    link or a picture that leads nowhere, and for a file that has become too large.
    """
    drawn = Pictures(pictures, Counter(at for text in pages.values() for at in SHOWN.findall(text)))
    sections = (_section(name, text, pages, drawn, _up(above.get(name), titles)) for name, text in pages.items())
    whole = (
        (ASSETS / "report.html")
        .read_text(encoding="utf-8")
        .format(
            styles=_assets(STYLES),
            navigation="\n".join(_navigation(pages, titles, groups)),
            shared=drawn.shared(),
            sections="\n".join(sections),
            foot=to_html(foot, partial(_target, "", pages), drawn.figure, partial(_anchor, "")) if foot else "",
            scripts=_assets(SCRIPTS),
        )
    )
    _check_targets(whole)
    if len(whole.encode()) > LARGEST:
        raise ValueError(f"{REPORT} has {len(whole.encode())} bytes, more than {LARGEST}")
    return whole


def _assets(names: Sequence[str]) -> str:
    return "\n".join((ASSETS / name).read_text(encoding="utf-8").strip() for name in names)


def _navigation(
    pages: Mapping[str, str], titles: Mapping[str, str], groups: Mapping[str, Sequence[str]]
) -> Iterator[str]:
    """Links to the first page and, in menus, to those of the groups."""
    yield _linked(next(iter(pages)), titles)
    for group, names in groups.items():
        items = "".join(f"<li>{_linked(name, titles)}</li>" for name in names)
        yield f'<details class="menu"><summary>{escape(group)}</summary><ul>{items}</ul></details>'


def _linked(name: str, titles: Mapping[str, str]) -> str:
    return f'<a href="#{_page(name)}">{escape(titles[name])}</a>'


def _up(name: str | None, titles: Mapping[str, str]) -> str:
    """The way to the page that lists this one; none for a page of the navigation."""
    return f'<p class="up">↑ {_linked(name, titles)}</p>\n' if name else ""


def _section(name: str, text: str, pages: Mapping[str, str], drawn: Pictures, up: str) -> str:
    """A page, its contents below its title."""
    body = to_html(text, partial(_target, name, pages), drawn.figure, partial(_anchor, name))
    body = body.replace("</h1>", f"</h1>\n{_contents(body)}", 1)
    return f'<section id="{_page(name)}">\n{up}{body}\n</section>'


def _contents(body: str) -> str:
    """Links to the headings of a page; nothing where there are few."""
    found = HEADING.findall(body)
    if len(found) < FEWEST:
        return ""
    items = "".join(f'<li class="h{level}"><a href="#{at}">{words(inner)}</a></li>' for level, at, inner in found)
    return (
        f'<nav class="contents" aria-label="On this page"><details><summary>On this page</summary><ul>{items}</ul>'
        "</details></nav>"
    )


def _page(name: str) -> str:
    return name.removesuffix(".md")


def _anchor(page: str, fragment: str) -> str:
    """The id of a heading: unlike those of other pages."""
    return f"{_page(page)}--{fragment}"


def _target(page: str, pages: Mapping[str, str], to: str) -> str:
    """Where a link of a page leads within the file; nowhere for a file of data; out of it to a thread in public."""
    if to.startswith(OUTSIDE):
        return to
    name, _, fragment = to.partition("#")
    name = name and normpath(join(dirname(page), name))
    if name.startswith(DATA):
        return ""
    if name and name not in pages:
        raise ValueError(f"{page}: a link to {to}, which is no page")
    return f"#{_anchor(name or page, fragment)}" if fragment else f"#{_page(name)}"


def _check_targets(whole: str) -> None:
    ids = re.findall(r'\bid="([^"]+)"', whole)
    if len(ids) != len(set(ids)):
        twice = sorted({name for name in ids if ids.count(name) > 1})[:3]
        raise ValueError(f"an id appears twice: {', '.join(twice)}")
    lost = sorted(set(re.findall(r'<a [^>]*href="#([^"]+)"', whole)) - set(ids))
    if lost:
        raise ValueError(f"links lead nowhere: {', '.join(lost)}")

"""All pages as ONE file of HTML that needs nothing else: style, script and pictures are in it, no network is.

Without a script the pages stand below one another; with it, one at a time, with a search over all of them, tables that
sort and filter, and a dark scheme. A page is the dialect of :mod:`reports.markdown` and nothing else.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from html import escape
from pathlib import Path
from posixpath import dirname, join, normpath
from types import MappingProxyType
from urllib.parse import unquote

from markdown_it import MarkdownIt
from markdown_it.renderer import RendererHTML
from markdown_it.token import Token

from reports.figures.inline import Pictures
from reports.markdown import END_MACHINE, MACHINE

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
MARKDOWN, RENDERER = MarkdownIt("commonmark").enable("table").disable(["html_inline", "autolink"]), RendererHTML()
FOLD = re.compile(r"<details><summary>(.+)</summary>|</details>")  # the only HTML of a page, beside comments
Link = Callable[[str], str]  # where a link of the page leads to; nothing for one that leads out of the file
Picture = Callable[[str, str], str]  # file name and words to HTML


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
    headings = HEADING.findall(body)
    if len(headings) < FEWEST:
        return ""
    items = "".join(f'<li class="h{level}"><a href="#{at}">{words(inner)}</a></li>' for level, at, inner in headings)
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
        raise ValueError(f"{page}: a link to {to}, which is not a page")
    return f"#{_anchor(name or page, fragment)}" if fragment else f"#{_page(name)}"


def _check_targets(whole: str) -> None:
    ids = re.findall(r'\bid="([^"]+)"', whole)
    if len(ids) != len(set(ids)):
        twice = sorted({name for name in ids if ids.count(name) > 1})[:3]
        raise ValueError(f"an id appears twice: {', '.join(twice)}")
    lost = sorted(set(re.findall(r'<a [^>]*href="#([^"]+)"', whole)) - set(ids))
    if lost:
        raise ValueError(f"links lead nowhere: {', '.join(lost)}")


def to_html(text: str, link: Link, picture: Picture, anchor: Link) -> str:
    """A page; anchor: the id of a heading from its fragment. Raises ValueError for HTML that is not a fold."""
    tokens = MARKDOWN.parse(text)
    kept: list[Token] = []
    for i, token in enumerate(tokens):
        _lead(token.children or (), link)
        if token.type == "heading_open":
            token.attrs["id"] = anchor(fragment(tokens[i + 1]))
        elif token.type == "html_block":
            token.content = _fold(token.content)
        elif token.type in ("th_open", "td_open"):
            token.attrs = {"class": "n"} if "right" in str(token.attrs.get("style")) else {}
        kept.append(token)
    return RENDERER.render(list(_figures_and_captions(kept, picture)), MARKDOWN.options, {})


def _lead(children: Sequence[Token], link: Link) -> None:
    """Give links their targets; one without becomes typed words."""
    words = False
    for child in children:
        if child.type == "link_open":
            to = link(unquote(str(child.attrs["href"])))
            words, child.attrs["href"] = not to, to
            child.tag, child.attrs = ("code", {}) if words else (child.tag, child.attrs)
        elif child.type == "link_close" and words:
            child.tag, words = "code", False


def _figures_and_captions(tokens: list[Token], picture: Picture) -> Iterator[Token]:
    """A paragraph that is a picture becomes a figure, one in bold above a table its caption."""
    at, caption = 0, ""
    while at < len(tokens):
        token = tokens[at]
        children = _children(tokens[at + 1]) if token.type == "paragraph_open" else []
        kinds = [child.type for child in children]
        if kinds == ["image"]:
            name = str(children[0].attrs["src"]).rpartition("figures/")[2]
            yield _html(f"<figure>{picture(name, children[0].content)}</figure>\n")
            at += 3
        elif token.type == "paragraph_open" and is_title(tokens[at + 1]) and tokens[at + 3].type == "table_open":
            caption = f"<caption>{RENDERER.renderInline(children[1:-1], MARKDOWN.options, {})}</caption>"
            at += 3
        elif token.type == "inline" and [child.type for child in _children(token)] == ["image"]:
            image = _children(token)[0]  # in a table: pictures side by side
            yield _html(f"<figure>{picture(str(image.attrs['src']).rpartition('figures/')[2], image.content)}</figure>")
            at += 1
        elif token.type in ("table_open", "table_close"):
            yield _html(f'<div class="wide"><table>{caption}\n' if token.type == "table_open" else "</table></div>\n")
            at, caption = at + 1, ""
        else:
            yield token
            at += 1


def _children(token: Token) -> list[Token]:
    return [child for child in token.children or () if child.type != "text" or child.content]


def is_title(token: Token) -> bool:
    """Is the content of a paragraph all in bold?"""
    kinds = [child.type for child in _children(token)]
    return kinds[:1] == ["strong_open"] and kinds.index("strong_close") == len(kinds) - 1


def _html(content: str) -> Token:
    return Token("html_block", "", 0, content=content)


def _fold(content: str) -> str:
    """The opening or the end of a fold; nothing for the comments around machine blocks."""
    line = content.strip()
    if line in (MACHINE, END_MACHINE):
        return ""
    match = FOLD.fullmatch(line)
    if match is None:
        raise ValueError(f"HTML in a page: {line!r}")
    return f"<details><summary>{MARKDOWN.renderInline(match[1])}</summary>\n" if match[1] else "</details>\n"


def fragment(heading: Token) -> str:
    """The fragment that a heading is linked by, as on GitHub."""
    words = "".join(child.content for child in heading.children or ())
    return re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")


def words(inner: str) -> str:
    """HTML without its links, as a link may hold it."""
    return re.sub(r"</?a\b[^>]*>", "", inner)

"""All pages as ONE file of HTML that needs nothing else: style, script and pictures are in it, no network is.

Without a script the pages stand below one another; with it, one at a time, and a click on the head of a table sorts it.
"""

from __future__ import annotations

import re
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

from reports.markdown import END_MACHINE, MACHINE

REPORT = "report.html"
LARGEST = 8 * 2**20  # bytes
ASSETS = Path(__file__).parent / "assets"
MARKDOWN, RENDERER = MarkdownIt("commonmark").enable("table"), RendererHTML()
FOLD = re.compile(r"<details><summary>(.+)</summary>|</details>")  # the only HTML of a page, beside comments

Link = Callable[[str], str]  # where a link of the page leads to
Picture = Callable[[str, str], str]  # file name and words to HTML


def report_html(
    pages: Mapping[str, str],
    titles: Mapping[str, str],
    pictures: Mapping[str, str],
    groups: Mapping[str, Sequence[str]] = MappingProxyType({}),
) -> str:
    """The file from texts and titles of the pages by file name, and the SVG of their pictures by name.

    groups: the pages that are linked at the top of each, by the title of their group; the first page is linked before
    them. Raises ValueError for a link or a picture that leads nowhere, and for a file that has become too large.
    """
    prefixes = {name: f"p{number}" for number, name in enumerate(sorted(pictures))}
    inlined = {name: inlined_svg(svg, prefixes[name]) for name, svg in pictures.items()}
    sections = []
    for name, text in pages.items():
        body = to_html(text, partial(_target, name, pages), partial(_picture, inlined), partial(_anchor, name))
        sections.append(f'<section id="{_page(name)}">\n{body}\n</section>')
    links = "\n".join(_navigation(pages, titles, groups))
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


def _navigation(
    pages: Mapping[str, str], titles: Mapping[str, str], groups: Mapping[str, Sequence[str]]
) -> Iterator[str]:
    """Links to the first page and to those of the groups."""
    yield _linked(next(iter(pages)), titles)
    for group, names in groups.items():
        yield f'<span class="group"><b>{escape(group)}</b> {" ".join(_linked(name, titles) for name in names)}</span>'


def _linked(name: str, titles: Mapping[str, str]) -> str:
    return f'<a href="#{_page(name)}">{escape(titles[name])}</a>'


def to_html(text: str, link: Link, picture: Picture, anchor: Link) -> str:
    """A page; anchor: the id of a heading from its fragment. Raises ValueError for HTML that is no fold."""
    tokens = MARKDOWN.parse(text)
    kept: list[Token] = []
    for i, token in enumerate(tokens):
        for child in token.children or ():
            if child.type == "link_open":
                child.attrs["href"] = link(unquote(str(child.attrs["href"])))
        if token.type == "heading_open":
            token.attrs["id"] = anchor(fragment(tokens[i + 1]))
        elif token.type == "html_block":
            token.content = _fold(token.content)
        elif token.type in ("th_open", "td_open"):
            token.attrs = {"class": "n"} if "right" in str(token.attrs.get("style")) else {}
        kept.append(token)
    return RENDERER.render(list(_figures_and_captions(kept, picture)), MARKDOWN.options, {})


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
    found = FOLD.fullmatch(line)
    if found is None:
        raise ValueError(f"HTML in a page: {line!r}")
    return f"<details><summary>{MARKDOWN.renderInline(found[1])}</summary>\n" if found[1] else "</details>\n"


def fragment(heading: Token) -> str:
    """The fragment that a heading is linked by, as on GitHub."""
    words = "".join(child.content for child in heading.children or ())
    return re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")


def _page(name: str) -> str:
    return name.removesuffix(".md")


def _anchor(page: str, fragment: str) -> str:
    """The id of a heading: unlike those of other pages."""
    return f"{_page(page)}--{fragment}"


def _target(page: str, pages: Mapping[str, str], to: str) -> str:
    """Where a link of a page leads within the file."""
    name, _, fragment = to.partition("#")
    name = name and normpath(join(dirname(page), name))
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

"""A page of Markdown as HTML: the dialect of :mod:`reports.markdown` and nothing else."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from urllib.parse import unquote

from markdown_it import MarkdownIt
from markdown_it.renderer import RendererHTML
from markdown_it.token import Token

from reports.markdown import END_MACHINE, MACHINE

MARKDOWN, RENDERER = MarkdownIt("commonmark").enable("table").disable(["html_inline", "autolink"]), RendererHTML()
FOLD = re.compile(r"<details><summary>(.+)</summary>|</details>")  # the only HTML of a page, beside comments

Link = Callable[[str], str]  # where a link of the page leads to; nothing for one that leads out of the file
Picture = Callable[[str, str], str]  # file name and words to HTML


def to_html(text: str, link: Link, picture: Picture, anchor: Link) -> str:
    """A page; anchor: the id of a heading from its fragment. Raises ValueError for HTML that is no fold."""
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


def words(inner: str) -> str:
    """HTML without its links, as a link may hold it."""
    return re.sub(r"</?a\b[^>]*>", "", inner)

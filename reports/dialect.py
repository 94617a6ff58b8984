"""The Markdown that the pages are written in, and nothing else, as HTML; what it does not know raises ValueError.

Known: headings of up to three levels, paragraphs, lists with - or 1., tables under a bold title, pictures on a line of
their own, fenced commands, folds, the comments around machine blocks; and within a line bold, italic, code and links.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from html import escape

from reports.markdown import END_MACHINE, MACHINE

INLINE = re.compile(
    r"`(?P<code>[^`]+)`|\*\*(?P<bold>[^*]+)\*\*|\*(?P<italic>[^*]+)\*|\[(?P<text>[^]]*)\]\((?P<to>[^)\s]+)\)"
)
HEADING, PICTURE = re.compile(r"(#{1,3}) (.+)"), re.compile(r"!\[(.*)\]\(figures/([\w.-]+\.svg)\)")
OPEN_FOLD, CLOSE_FOLD = re.compile(r"<details><summary>(.+)</summary>"), "</details>"
ITEM = re.compile(r"(?:-|\d+\.) (.+)")
RULE = re.compile(r"\|( :?-+:? \|)+")
NEEDS_A_MEANING = re.compile(r"[`*]")

Link = Callable[[str], str]  # where a link of the page leads to
Picture = Callable[[str, str], str]  # file name and words to HTML


def to_html(text: str, link: Link, picture: Picture, anchor: Callable[[str], str]) -> str:
    """A page; anchor: the id of a heading from its fragment."""
    return "\n".join(_blocks(iter(_paragraphs(text)), link, picture, anchor))


def fragment(heading: str) -> str:
    """The fragment that a heading is linked by, as on GitHub."""
    return re.sub(r"[^\w\- ]", "", re.sub(INLINE, lambda m: next(g for g in m.groups() if g), heading).lower()).replace(
        " ", "-"
    )


def _paragraphs(text: str) -> list[list[str]]:
    """Lines between empty lines; a fence keeps its own."""
    found: list[list[str]] = [[]]
    fenced = False
    for line in text.splitlines():
        if line.startswith("```"):
            fenced = not fenced
        if line or fenced:
            found[-1].append(line)
        elif found[-1]:
            found.append([])
    if fenced:
        raise ValueError("a fence is not closed")
    return [lines for lines in found if lines]


def _blocks(
    paragraphs: Iterator[list[str]], link: Link, picture: Picture, anchor: Callable[[str], str]
) -> Iterator[str]:
    title = ""
    for lines in paragraphs:
        first, alone = lines[0], len(lines) == 1
        if title and not first.startswith("| "):
            raise ValueError(f"no table under {title!r}")
        if alone and first in (MACHINE, END_MACHINE):
            continue
        if alone and (heading := HEADING.fullmatch(first)):
            level, words = len(heading[1]), heading[2]
            yield f'<h{level} id="{escape(anchor(fragment(words)))}">{inline(words, link)}</h{level}>'
        elif alone and (shown := PICTURE.fullmatch(first)):
            yield f"<figure>{picture(shown[2], shown[1])}</figure>"
        elif alone and (fold := OPEN_FOLD.fullmatch(first)):
            yield f"<details><summary>{inline(fold[1], link)}</summary>"
        elif alone and first == CLOSE_FOLD:
            yield CLOSE_FOLD
        elif first.startswith("```"):
            if lines[-1] != "```":
                raise ValueError(f"text after a fence: {lines[-1]!r}")
            yield f"<pre>{escape(chr(10).join(lines[1:-1]))}</pre>"
        elif first.startswith("| "):
            yield _table(lines, title, link)
            title = ""
        elif alone and re.fullmatch(r"\*\*[^*]+\*\*", first):
            title = first[2:-2]
        elif ITEM.fullmatch(first):
            yield _list(lines, link)
        elif re.match(r"[#>|<!]|\s|(?:- )", first):
            raise ValueError(f"not the dialect of the pages: {first!r}")
        else:
            yield f"<p>{inline(' '.join(lines), link)}</p>"
    if title:
        raise ValueError(f"no table under {title!r}")


def _table(lines: list[str], title: str, link: Link) -> str:
    """A table with its title as caption; the columns of numbers are aligned to the right."""
    if len(lines) < 2 or not RULE.fullmatch(lines[1]):
        raise ValueError(f"a table without a rule: {lines[0]!r}")
    header, rule, *body = ([entry.strip() for entry in line[1:-1].split(" | ")] for line in lines)
    right = [' class="n"' if entry.startswith("-") and entry.endswith(":") else "" for entry in rule]
    rows = []
    for tag, entries in (("th", header), *(("td", row) for row in body)):
        if len(entries) != len(rule):
            raise ValueError(f"{len(entries)} entries for {len(rule)} columns: {entries}")
        cells = (f"<{tag}{own}>{inline(entry, link)}</{tag}>" for entry, own in zip(entries, right, strict=True))
        rows.append(f"<tr>{''.join(cells)}</tr>")
    caption = f"<caption>{inline(title, link)}</caption>" if title else ""
    head, rest = rows[0], "\n".join(rows[1:])
    return f'<div class="wide"><table>{caption}<thead>{head}</thead><tbody>\n{rest}\n</tbody></table></div>'


def _list(lines: list[str], link: Link) -> str:
    """Items, a line each, all of the same kind."""
    kind = "ul" if lines[0].startswith("- ") else "ol"
    items = []
    for line in lines:
        item = ITEM.fullmatch(line)
        if item is None or line.startswith("- ") != (kind == "ul"):
            raise ValueError(f"no item of a list: {line!r}")
        items.append(f"<li>{inline(item[1], link)}</li>")
    return f"<{kind}>\n" + "\n".join(items) + f"\n</{kind}>"


def inline(text: str, link: Link) -> str:
    """Bold, italic, code and links; raises ValueError for a mark that opens nothing."""
    parts, at = [], 0
    for found in INLINE.finditer(text):
        parts += [_plain(text[at : found.start()]), _marked(found, link)]
        at = found.end()
    return "".join([*parts, _plain(text[at:])])


def _marked(found: re.Match[str], link: Link) -> str:
    if (code := found["code"]) is not None:
        return f"<code>{escape(code)}</code>"
    if (to := found["to"]) is not None:
        return f'<a href="{escape(link(to))}">{inline(found["text"], link)}</a>'
    tag = "strong" if found["bold"] is not None else "em"
    return f"<{tag}>{inline(found['bold'] or found['italic'], link)}</{tag}>"


def _plain(text: str) -> str:
    if NEEDS_A_MEANING.search(text):
        raise ValueError(f"a mark that marks nothing: {text!r}")
    return escape(text, quote=False)

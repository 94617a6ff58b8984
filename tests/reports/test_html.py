"""The pages as one HTML file: every piece of the dialect, what it refuses, links within the file, and its pictures."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import pytest

from reports import html
from reports.contents import CHAPTERS
from reports.figures.inline import Pictures, inlined_svg
from reports.html import LARGEST, MARKDOWN, REPORT, is_title, report_html, to_html
from reports.markdown import commands, machine, picture, table

SVG = '<?xml version="1.0"?>\n<!DOCTYPE svg>\n<svg xmlns="http://www.w3.org/2000/svg"><metadata>who</metadata>\n{0}</svg>\n'


def converted(text: str) -> str:
    return to_html(text, lambda to: f"#{to}", lambda name, words: f"[{name}|{words}]", lambda name: name)


PIECES = {
    "# One *word*": '<h1 id="one-word">One <em>word</em></h1>',
    "### From ε to a [link](x.md)": '<h3 id="from-ε-to-a-link">From ε to a <a href="#x.md">link</a></h3>',
    "two\nlines & a < b": "<p>two\nlines &amp; a &lt; b</p>",
    "**bold** and `a*b`": "<p><strong>bold</strong> and <code>a*b</code></p>",
    "**bold.** More": "<p><strong>bold.</strong> More</p>",
    "- one\n- [two](y.md#z)": '<ul>\n<li>one</li>\n<li><a href="#y.md#z">two</a></li>\n</ul>',
    "1. one\n2. two": "<ol>\n<li>one</li>\n<li>two</li>\n</ol>",
    picture("a.svg", "words", str).text: "<figure>[a.svg|words]</figure>",
    "```sh\na <b>\n\nc\n```": '<pre><code class="language-sh">a &lt;b&gt;\n\nc\n</code></pre>',
    machine("text"): "<p>text</p>",
    commands(["x --y"]): (
        "<details><summary>Commands that reproduce these numbers</summary>\n"
        '<pre><code class="language-sh">x --y\n</code></pre>\n</details>'
    ),
}


def test_every_piece_of_the_dialect() -> None:
    assert {text: converted(text).strip() for text in PIECES} == PIECES


def test_a_table_has_its_title_and_knows_its_numbers() -> None:
    made = converted(table("A `title`", ["name", "value [-]"], [["`x`", "1.5"], ["p = 0", ""]])).replace("\n", "")
    assert made.startswith('<div class="wide"><table><caption>A <code>title</code></caption><thead>')
    assert '<tr><th>name</th><th class="n">value [-]</th></tr>' in made
    assert '<tr><td><code>x</code></td><td class="n">1.5</td></tr>' in made
    assert '<tr><td>p = 0</td><td class="n"></td></tr>' in made
    assert made.endswith("</tbody></table></div>")


def test_html_of_its_own_is_refused() -> None:
    with pytest.raises(ValueError, match="HTML in a page: '<div>raw</div>'"):
        converted("<div>raw</div>")
    assert converted("a <b>raw</b> <https://x.example>") == (
        "<p>a &lt;b&gt;raw&lt;/b&gt; &lt;https://x.example&gt;</p>\n"
    )


BLOCKS = """heading_open paragraph_open inline html_block fence ordered_list_open bullet_list_open list_item_open
table_open thead_open tbody_open tr_open th_open td_open"""
INLINE = "text softbreak code_inline strong_open em_open link_open image"


def faults(text: str) -> list[str]:
    """What a page must not have: blocks and marks of another kind, marks that mark nothing, titles without a table."""
    tokens = MARKDOWN.parse(text)
    children = [child for token in tokens for child in token.children or ()]
    values = [each.type for each in tokens if each.nesting >= 0 and each.type not in BLOCKS.split()]
    values += [each.type for each in children if each.nesting >= 0 and each.type not in INLINE.split()]
    values += [each.content for each in children if each.type == "text" and re.search(r"[`*]|^\| |^#+ ", each.content)]
    titles = [(token, after) for token, after in zip(tokens, tokens[2:], strict=False) if is_title(token)]
    values += [token.content for token, after in titles if after.type != "table_open"]
    return values


def test_pages_are_plain(files: dict[str, str]) -> None:
    """And what a store of ours says stays as it is: no character of it has to be written by its number."""
    for text in ("a * b", "an `open code", "> quoted", "    indented", "**A title**\n\nno table", "| a |\n| 1 |"):
        assert faults(text), text
    for name, text in files.items():
        if name.endswith(".md"):
            assert faults(text) == [], name
            assert re.findall(".{0,30}&#.{0,30}", text) == [], name


# --- pictures -------------------------------------------------------------------------------------------------------


def test_ids_of_two_pictures_are_never_the_same() -> None:
    """Those that nothing asks for are gone."""
    body = '<g id="idle"/><path id="a"/><use xlink:href="#a" clip-path="url(#b)"/><clipPath id="b"/>'
    one, two = (inlined_svg(SVG.format(body), prefix, {}) for prefix in ("p0", "p1"))
    assert '<g/><path id="p0-a"/><use href="#p0-a" clip-path="url(#p0-b)"/><clipPath id="p0-b"/>' in one
    assert set(re.findall(r'id="([^"]+)"', one)) & set(re.findall(r'id="([^"]+)"', two)) == set()


def test_a_picture_that_asks_for_another_file_is_refused() -> None:
    for body in ('<image href="http://x/y.png"/>', '<use xlink:href="other.svg#a"/>', '<a fill="url(x)"/>'):
        with pytest.raises(ValueError, match="a picture asks for"):
            inlined_svg(SVG.format(body), "p0", {})


LETTER = '<defs>\n<path id="A-1" d="M 2034 4250\nQ 1547 1.23456 z\n" transform="scale(0.015625)"/>\n</defs>'


def test_letters_are_in_the_file_once_and_pictures_are_small() -> None:
    body = (
        LETTER
        + '<g id="x"><use xlink:href="#A-1" x="1.23456" transform="translate(10.123456 -0.051) scale(0.1 -0.1)"/></g>'
    )
    both = Pictures({"a.svg": SVG.format(body), "b.svg": SVG.format(body)}, {})
    assert both.shared().count('<path id="s0" d="M2034 4250Q1547 1.23z" transform="scale(0.015625)"/>') == 1
    shown = both.figure("a.svg", "words")
    assert '<g><use href="#s0" x="1.23" transform="translate(10.12 -0.05) scale(0.1 -0.1)"/></g>' in shown
    assert "A-1" not in shown
    assert "who" not in shown
    alone = Pictures({"a.svg": SVG.format(body)}, {})
    assert 'href="#p0-A-1"' in alone.figure("a.svg", "words")
    assert "<path" not in alone.shared()


def test_a_picture_is_named_by_its_caption() -> None:
    made = Pictures({"a.svg": SVG.format("")}, {}).figure("a.svg", 'a < "b"')
    assert made.startswith('<svg class="plot" role="img" aria-label="a &lt; &quot;b&quot;" xmlns=')
    assert made.endswith("</svg><figcaption>a &lt; &quot;b&quot;</figcaption>")


def test_a_picture_that_is_shown_twice_is_in_the_file_once() -> None:
    svg = SVG.format('<path d="M 0 0"/>').replace("<svg ", '<svg width="9" viewBox="0 0 9 9" ')
    made = Pictures({"a.svg": svg}, {"a.svg": 2})
    assert made.shared().count('<symbol id="p0" viewBox="0 0 9 9">\n<path d="M0 0"/>') == 1
    shown = made.figure("a.svg", "words")
    assert 'viewBox="0 0 9 9"' in shown
    assert '><use href="#p0"/></svg><figcaption>' in shown
    assert "<path" not in shown


def test_a_plot_takes_the_colours_of_the_scheme_and_a_map_keeps_its_own() -> None:
    style = '<path style="fill: #ffffff; stroke: #0072b2"/>'
    plot, field = (Pictures({"a": SVG.format(body)}, {}).figure("a", "") for body in (style, f"<image/>{style}"))
    assert 'class="plot"' in plot
    assert 'style="fill:var(--paper);stroke:#0072b2"' in plot
    assert 'class="own"' in field
    assert 'style="fill:#ffffff;stroke:#0072b2"' in field


def test_a_look_that_many_shapes_have_is_in_the_file_once() -> None:
    body = '<path style="fill: #0072b2; stroke: #ffffff"/>' * 4 + '<path style="fill: none"/>'
    made = Pictures({"a.svg": SVG.format(body)}, {})
    assert "<style>.q0{fill:#0072b2;stroke:var(--paper)}</style>" in made.shared()
    shown = made.figure("a.svg", "")
    assert shown.count('<path class="q0"/>') == 4
    assert shown.count('<path style="fill:none"/>') == 1


# --- the file -------------------------------------------------------------------------------------------------------


def small(text: str = "", **pictures: str) -> str:
    pages = {"index.md": f"# All\n\n{text}", "tyre.md": "# Tyre\n\n## A part"}
    return report_html(
        pages, {"index.md": "All", "tyre.md": "Tyre"}, {f"{name}.svg": svg for name, svg in pictures.items()}
    )


def test_links_lead_within_the_file() -> None:
    made = small("to [it](tyre.md), [a part](tyre.md#a-part), [here](#all)")
    assert '<a href="#tyre">it</a>, <a href="#tyre--a-part">a part</a>, <a href="#index--all">here</a>' in made
    assert '<h2 id="tyre--a-part">' in made
    assert ".md" not in made


def test_a_page_has_its_contents_below_its_title() -> None:
    made = small("## One `x`\n\n### Two [of](tyre.md) them\n\n## Three")
    listed = '<li class="h2"><a href="#index--one-x">One <code>x</code></a></li>'
    assert f'<ul>{listed}<li class="h3"><a href="#index--two-of-them">Two of them</a></li>' in made
    assert made.count('aria-label="On this page"') == 1  # few headings need no list


def test_files_of_data_are_named_and_not_linked() -> None:
    assert "<p>in <code>all <em>answers</em></code>, <a" in small("in [all *answers*](data/a.csv), [x](tyre.md)")


def test_the_foot_stands_below_all_pages() -> None:
    pages, titles = {"index.md": "# All"}, {"index.md": "All"}
    made = report_html(pages, titles, {}, foot="*at [it](index.md#all)*")
    foot = made[made.index("<footer>") : made.index("</footer>")]
    assert '<em>at <a href="#index--all">it</a></em>' in foot


LOST = {
    "[x](nowhere.md)": "index.md: a link to nowhere.md, which is not a page",
    "[x](tyre.md#nothing)": "links lead nowhere: tyre--nothing",
    "![x](figures/none.svg)": "no picture 'none.svg'",
    "## All": "an id appears twice: index--all",
}


def test_what_leads_nowhere_is_refused() -> None:
    for text, says in LOST.items():
        with pytest.raises(ValueError, match=re.escape(says)):
            small(text)


def test_a_thread_in_public_is_linked_and_nothing_else_outside() -> None:
    assert '<a href="https://github.com/a/b/issues/1">a</a>' in small("[a](https://github.com/a/b/issues/1)")
    with pytest.raises(ValueError, match="which is not a page"):
        small("[a](https://example.org/b)")


def test_pages_of_a_folder_link_from_where_they_are() -> None:
    pages = {"index.md": "[A](a/one.md)", "a/one.md": "# One\n\n[up](../index.md), [two](two.md#part)"}
    pages["a/two.md"] = "# Two\n\n## Part\n\n![x](../figures/x.svg)"
    titles = {"index.md": "All", "a/one.md": "One", "a/two.md": "Two"}
    made = report_html(pages, titles, {"x.svg": SVG.format("")}, {"Some": ["a/one.md"]}, above={"a/two.md": "a/one.md"})
    assert '<a href="#a/one">A</a>' in made
    assert '<a href="#index">up</a>, <a href="#a/two--part">two</a>' in made
    assert made.count("<figure><svg") == 1
    assert '<summary>Some</summary><ul><li><a href="#a/one">One</a></li></ul>' in made
    assert '<section id="a/two">\n<p class="up">↑ <a href="#a/one">One</a></p>' in made
    assert made.count('class="up"') == 1
    assert '<a href="#a/two">' not in made


def test_a_file_that_is_too_large_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(html, "LARGEST", 3000)
    with pytest.raises(ValueError, match="bytes, more than 3000"):
        small("word " * 3000)


class Reader(HTMLParser):
    """Open elements, in order; every end must match, and nothing is fetched."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.fetched: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "link", "br", "hr", "img"):
            self.open.append(tag)
        for name, value in attrs:
            if tag == "a" and str(value).startswith(html.OUTSIDE):
                continue  # fetched by who follows it
            if name in ("src", "href", "xlink:href") and not str(value).startswith(("#", "data:")):
                self.fetched.append(str(value))

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.mark.parametrize("pages", ["files", pytest.param("drawn", marks=pytest.mark.slow)])
def test_all_pages_in_one_file_that_fetches_nothing(pages: str, request: pytest.FixtureRequest) -> None:
    files = request.getfixturevalue(pages)
    whole = files[REPORT]
    reader = Reader()
    reader.feed(whole)
    assert reader.open == []
    assert reader.fetched == []
    assert not re.search(r"@import|url\((?!#|data:)|fetch\(|XMLHttpRequest|WebSocket|<iframe", whole)
    assert [each.name for each in CHAPTERS if each.always and f'<section id="{each.name}">' not in whole] == []
    assert len(whole.encode()) < LARGEST
    assert whole.count("<table>") == sum(text.count("\n| :--") for name, text in files.items() if name.endswith(".md"))
    shown = sum(text.count("figures/") for name, text in files.items() if name.endswith(".md"))
    assert whole.count("<figure>") == shown

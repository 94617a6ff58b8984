"""What a stranger's store says is text on a page: neither HTML nor Markdown makes anything else of it."""

from __future__ import annotations

import json
import shutil
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from markdown_it import MarkdownIt

from reports.files import as_prose, as_words
from studies.cli import main
from studies.run.archive import Archive
from support.stores.elsewhere import solved

EVIL = "http://evil.example/"
PAYLOADS = (
    "<script>alert(2)</script>",
    "<img src=x onerror=alert(1)>",
    f'</td></tr></table><iframe src="{EVIL}">',
    '" onmouseover="alert(1)',
    f"see [click]({EVIL})",
    "see [click](index.md)",
    f"![p]({EVIL}p.png)",
    f"[x]: {EVIL}",
    f"<{EVIL}> {EVIL} www.evil.example me@evil.example @me",
    "a | b | c",
    "\\| \\<b> \\`",
    "`code` ``` ~~~ x",
    "$x^$ $\\frac$ \\$",
    "**bold** _it_ ~~no~~ *a*",
    "# head > quote",
    "<!-- machine -->",
    "</details><details><summary>x</summary>",
    "&lt;script&gt; &#60;img src=x&#62; &amp;",
    "{0.__class__} {label}",
)
TINY = """
title = "tiny"
[[cross]]
name = "a"
measures = ["exact", "linear"]
contacts = ["semismooth", "qp"]
[cross.scenes.strip-contact]
meshes = ["2x1", "4x1", "8x1"]
set = { load_fraction = "5" }
"""
GITHUB = MarkdownIt("gfm-like", {"linkify": False, "html": True})


class Outline(HTMLParser):
    """Every element with the names of its attributes, and where it leads; the text of all."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, ...]] = []
        self.text = ""
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        leads = [str(value) for name, value in attrs if name in ("href", "src")]
        self.elements.append((tag, *(name for name, _ in attrs), *leads))

    def handle_data(self, data: str) -> None:
        self.text += data


def planted(store: Path, payloads: tuple[str, ...]) -> None:
    """A cell for each payload, which crashed and says it, everywhere that a plan, a failure and a record have words."""
    archive = Archive(store)
    path = archive.index_path("tiny")
    plan = json.loads(path.read_text())
    plan["title"] = payloads[0]
    row = plan["cells"][0]
    for i, said in enumerate(payloads):
        own = {"label": f"{i} {said}", "id": f"planted-{i}", "command": said, "expected": said, "files": False}
        plan["cells"].append({**row, **own, "request": None, "settings": {"load_fraction": said}})
        archive.note_failure(f"planted-{i}", {"class": "crash", "reason": said})
        plan["cells"].append({**row, "label": f"{i} refused {said}", "id": None, "reason": said, "request": None})
    path.write_text(json.dumps(plan))
    record_path = archive.record_path(row["id"])
    record: dict[str, Any] = json.loads(record_path.read_text())
    record |= {"class": "not-converged", "outcome": "stalled", "reason": " ".join(payloads)}
    record["notes"], record["cuts"] = [*payloads], [*payloads]
    record["provenance"] |= {"commit": " ".join(payloads[:6]), "machine": dict.fromkeys(("cpu", "system"), payloads[1])}
    record["provenance"]["packages"] = {payloads[1]: payloads[2]}
    record_path.write_text(json.dumps(record))


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Of a store that says harmless words, and of the same that says what would do harm; both analysed."""
    folder = tmp_path_factory.mktemp("pages")
    clean = solved(folder, "tiny", TINY)
    for name, payloads in (("hostile", PAYLOADS), ("harmless", tuple(f"word {i}" for i in range(len(PAYLOADS))))):
        store = Path(shutil.copytree(clean, folder / name))
        planted(store, payloads)
        assert main(["analyse", "tiny", "--store", str(store)]) == 0
        assert main(["report", "--store", str(store), "--out", str(folder / f"{name}-pages")]) == 0
    return folder / "hostile-pages", folder / "harmless-pages"


@pytest.mark.slow
def test_html_has_the_elements_of_harmless_words_and_no_other(pages: tuple[Path, Path]) -> None:
    hostile, harmless = (Outline((each / "report.html").read_text(encoding="utf-8")) for each in pages)
    assert hostile.elements == harmless.elements
    for said in PAYLOADS:
        assert said in hostile.text, said


@pytest.mark.slow
def test_markdown_has_the_pieces_of_harmless_words_and_no_other(pages: tuple[Path, Path]) -> None:
    """As GitHub reads it."""
    names = sorted(path.relative_to(pages[0]).as_posix() for path in pages[0].rglob("*.md"))
    assert names == sorted(path.relative_to(pages[1]).as_posix() for path in pages[1].rglob("*.md"))
    for name in names:
        texts = [(each / name).read_text(encoding="utf-8") for each in pages]
        assert EVIL not in texts[0]
        hostile, harmless = ([_kinds(token) for token in GITHUB.parse(text)] for text in texts)
        assert hostile == harmless, name


def _kinds(token: Any) -> tuple[str, ...]:
    """The kind of a token, and of what is in it; halves of a text are one text."""
    kinds = [token.type]
    for child in token.children or ():
        kind = "text" if child.type in ("text", "text_special") else child.type
        if kind != "text" or kinds[-1] != "text":
            kinds.append(kind)
    return tuple(kinds)


@pytest.mark.parametrize("said", PAYLOADS)
def test_words_are_one_text(said: str) -> None:
    """In a paragraph, and in a column of a table, they read as they were written."""
    (_, paragraph, _) = GITHUB.parse(as_words(said))
    assert _kinds(paragraph) == ("inline", "text")
    assert "".join(child.content for child in paragraph.children or ()) == said
    table = [token for token in GITHUB.parse(f"| a |\n| - |\n| {as_words(said)} |") if token.type == "inline"]
    assert [_kinds(token) for token in table] == [("inline", "text")] * 2
    assert "".join(child.content for child in table[1].children or ()) == said


@pytest.mark.parametrize("said", PAYLOADS)
def test_prose_has_neither_html_nor_links(said: str) -> None:
    kinds = {kind for token in GITHUB.parse(as_prose(said)) for kind in _kinds(token)}
    assert not {"html_inline", "html_block", "link_open", "image", "s_open"} & kinds

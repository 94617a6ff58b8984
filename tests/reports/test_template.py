"""Templates: fields, repeated rows, what is left out when it is empty, pictures of parts; and those of the pages."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from reports import markdown
from reports.markdown import END_MACHINE, FOLDER, FOR, MACHINE, Part, Template

RECORDS = [
    {"a.b": math.nan, "kkt": {"tension": 0.0}, "name": ""},
    {"a.b": -1e-9, "kkt": {"tension": 2e-9}, "name": "x"},
]
TABLE = """\
**Title**

| a | b | c | d |
| :-- | --: | --: | --: |
for rows: | {a.b:+.1%} | {kkt[tension]:.1e} of {name}
  | {name:code} | {a.b:own} |
"""


@pytest.fixture
def made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A template of one block with this text."""

    def of(text: str, **named) -> Template:
        (tmp_path / "one.md").write_text(f"%% block\n{text}", encoding="utf-8")
        monkeypatch.setattr(markdown, "FOLDER", tmp_path)
        return Template("one", **named)

    return of


def test_a_row_stands_for_each_record_with_a_dash_for_what_is_not_there(made) -> None:
    text = made(TABLE, own=lambda value: "own")("block", rows=RECORDS).text
    assert text.splitlines()[4:] == ["| – | 0 of  | – | own |", "| 0.0 % | 2.0e-09 of x | `x` | own |"]


@pytest.mark.parametrize(
    ("text", "left"),
    [
        (f"Before.\n\n{TABLE}\nAfter.", "Before.\n\nAfter."),
        (f"{MACHINE}\n\n{TABLE}\n{END_MACHINE}\n\nAfter.", "After."),
        (f"<details><summary>So many</summary>\n\n{MACHINE}\n\n{{none}}\n\n{END_MACHINE}\n\n</details>", ""),
        ("One. {none} Two. {none}", "One. Two."),
        ("| a |\n| :-- |\nfor rows: | {x} |\n| the end |", "| a |\n| :-- |\n| the end |"),
    ],
)
def test_what_is_empty_leaves_no_trace(made, text: str, left: str) -> None:
    assert made(text)("block", rows=[], none="").text == left


def test_lines_are_joined_but_not_items_rows_and_code(made) -> None:
    text = "a\nb\n\n- c\n  d\n- e\n\n| f |\n| :-- |\n| g |\n\n```sh\nh {{i}}\n\nj\n```"
    kept = "a b\n\n- c d\n- e\n\n| f |\n| :-- |\n| g |\n\n```sh\nh {i}\n\nj\n```"
    assert made(text)("block").text == kept


def test_pictures_of_parts_come_with_them(made) -> None:
    inner = Part("![x](figures/x.svg)", {"x.svg": lambda: "<x/>"})
    part = made("{inner}\n\n![y](figures/y.svg)")("block", {"y.svg": lambda: "<y/>"}, inner=inner)
    assert part.text == "![x](figures/x.svg)\n\n![y](figures/y.svg)"
    assert {name: draw() for name, draw in part.pictures.items()} == {"x.svg": "<x/>", "y.svg": "<y/>"}


@pytest.mark.parametrize("name", sorted(path.stem for path in FOLDER.glob("*.md")))
def test_every_table_has_as_many_heads_as_columns(name: str) -> None:
    for block, paragraphs in Template(name).blocks.items():
        for lines in (each for each in paragraphs if each[0].startswith("| ")):
            rows = [FOR.sub(r"\2", line) for line in lines]
            assert len({row.count(" | ") for row in rows}) == 1, f"{name}, {block}: {rows[0]}"

"""The page of a change: pictures that differ, and no others, side by side."""

from __future__ import annotations

import re
from pathlib import Path

import pandas as pd
import pytest

from reports import change
from reports.change import change_html

SVG = '<svg viewBox="0 0 9 9"><metadata>{made}</metadata><path id="m{made}" d="M {x} 1 L 3 4"/></svg>'
VALUES = {"relative error": pd.DataFrame({"A": [0.1, 0.2], "B": [0.1, 0.4]})}
SAID = "### Campaign quick, A → B\n\n**Worse (1)**\n\n| cell |\n| :-- |\n| ring |\n"


def files(**drawn: str) -> dict[str, str]:
    """Pages that show pictures of these names."""
    lines = (f"![Picture {name}](figures/{name}.svg)" for name in drawn)
    return {"index.md": "# Title\n\n" + "\n\n".join(lines)} | {f"figures/{n}.svg": svg for n, svg in drawn.items()}


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> str:
    sides = {
        Path("before"): files(
            same=SVG.format(made="a", x=1), near=SVG.format(made="a", x=2), moved=SVG.format(made="a", x=1)
        ),
        Path("now"): files(
            same=SVG.format(made="b", x=1), near=SVG.format(made="b", x=2.3), moved=SVG.format(made="b", x=7), new=SVG
        ),
    }
    monkeypatch.setattr(change, "files_of", lambda store, campaign: sides[store])
    return change_html(SAID, VALUES, *sides, "quick")


def test_pictures_that_differ_stand_side_by_side(page: str) -> None:
    assert "2 of 4 pictures differ." in page
    shown = re.findall(r'aria-label="([AB]: [^"]+)"', page)
    assert shown == ["A: Picture moved", "B: Picture moved", "B: Picture new"]
    row = re.search(r"<td>\s*<figure>.*?</tr>", page, re.S)
    assert row is not None
    assert row[0].count("<figure>") == 2


def test_what_the_gate_says_is_the_page(page: str) -> None:
    assert "<h1 id" in page
    assert "<caption>Worse (1)</caption>" in page


def test_a_store_that_cannot_be_shown_leaves_the_words(tmp_path: Path) -> None:
    (tmp_path / "<b>").mkdir()
    page = change_html(SAID, VALUES, tmp_path / "<b>", tmp_path / "<b>", "quick")
    assert "Worse (1)" in page
    assert "None: " in page
    assert "<b>" not in page

"""The page of a change: what two stores of a campaign say, and the pictures that differ, side by side, in ONE file.

What has changed beyond its bounds comes in words from the gate, with the values of both; nothing is judged here.
Pictures of the pages differ where a mark has moved by more than a PIXEL, or something is drawn that was not.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, BLUE, canvas, svg
from reports.files import StoreError, as_words
from reports.html import SHOWN, report_html
from reports.site import FIGURES, NUMBER, files_of

PAGE, OVER = "change.md", "change.svg"
PIXEL = 1.0
MADE = re.compile(r"<metadata>.*?</metadata>", re.S)  # when, and by which version
NAMES = re.compile(r'\bid="[^"]*"|href="#[^"]*"|url\(#[^)]*\)')
CAPTION = re.compile(r"!\[([^\]]*)\]\((?:[^()\s]*/)?" + FIGURES + r"/([^()\s]+)\)")
MOST = 24  # pictures a side: a page is looked through, an archive is not


def change_html(said: str, values: Mapping[str, pd.DataFrame], before: Path, now: Path, campaign: str) -> str:
    """The HTML of what the gate has ``said`` (Markdown) and of the pictures of both stores that differ.

    values: by what they are, a row a cell with columns A and B.  A store that these pages cannot show, as one of an
    older version, leaves the words alone, with the reason.
    """
    svgs = {OVER: change_picture(values)()}
    sections = [
        f"# {said.lstrip('# ').strip()}",
        f"![What the cells of both have, A and B]({FIGURES}/{OVER})",
        "## Pictures",
    ]
    try:
        sides = [_pictures(store, campaign) for store in (before, now)]
    except StoreError as error:
        sections.append(f"None: {as_words(str(error))}")
    else:
        names = list(dict.fromkeys([*sides[0], *sides[1]]))
        moved = [name for name in names if _differ(*(side.get(name) for side in sides))]
        more = f", the first {MOST} of which are below" if len(moved) > MOST else ""
        count = (
            f"{len(moved)} of {len(names)} pictures differ{more}." if names else "The pages of this campaign have none."
        )
        sections += [count, *_rows(moved[:MOST], *sides)]
        for i, side in enumerate(sides):
            svgs |= {_named(i, name): side[name][0] for name in moved[:MOST] if name in side}
    return report_html({PAGE: "\n\n".join(sections) + "\n"}, {PAGE: f"Campaign {campaign}, A → B"}, svgs)


@svg
def change_picture(values: Mapping[str, pd.DataFrame]) -> Figure:
    """A over B, a panel for each kind of value, on logarithmic axes: what has not changed lies on the diagonal."""
    figure, panels = canvas(len(values), width=8.0, height=4.0)
    for axes, (name, pair) in zip(panels, values.items(), strict=True):
        own = pair[(pair["A"] > 0) & (pair["B"] > 0)]
        axes.loglog(own["A"], own["B"], "o", color=BLUE, alpha=0.6)
        if len(own):
            ends = [own[["A", "B"]].min().min(), own[["A", "B"]].max().max()]
            axes.plot(ends, ends, "-", color=BLACK, linewidth=0.8)
        axes.set(xlabel=f"{name}, A", ylabel=f"{name}, B")
    return figure


def _pictures(store: Path, campaign: str) -> dict[str, tuple[str, str]]:
    """SVG and caption by file name, in the order of the pages; raises StoreError."""
    files = files_of(store, campaign)
    texts = [text for name, text in files.items() if name.endswith(".md")]
    words = {name: caption for text in texts for caption, name in CAPTION.findall(text)}
    pages = dict.fromkeys(name for text in texts for name in SHOWN.findall(text))
    return {name: (files[f"{FIGURES}/{name}"], words.get(name, name)) for name in pages if f"{FIGURES}/{name}" in files}


def _differ(one: tuple[str, str] | None, other: tuple[str, str] | None) -> bool:
    """Whether something is drawn that was not, or elsewhere; names within a picture, which are hashes, say nothing."""
    if one is None or other is None:
        return True
    a, b = (NAMES.sub("", MADE.sub("", svg)) for svg, _ in (one, other))
    if NUMBER.sub("#", a) != NUMBER.sub("#", b):
        return True
    pairs = zip(NUMBER.findall(a), NUMBER.findall(b), strict=True)
    return any(abs(float(x) - float(y)) > PIXEL for x, y in pairs)


def _rows(names: list[str], before: Mapping[str, tuple[str, str]], now: Mapping[str, tuple[str, str]]) -> Iterator[str]:
    for name in names:
        caption = (now.get(name) or before[name])[1]
        cells = (
            f"![{word}: {caption}]({FIGURES}/{_named(i, name)})" if name in side else "not drawn"
            for i, (word, side) in enumerate((("A", before), ("B", now)))
        )
        yield f"| A | B |\n|---|---|\n| {' | '.join(cells)} |"


def _named(side: int, name: str) -> str:
    return f"{'ab'[side]}-{name}"

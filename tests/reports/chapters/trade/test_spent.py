"""The section on where a solve spends its time, from tables made up here."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from reports.chapters.trade.spent import parts_of, said_of_bars, said_of_parts, spent_part, time_by_parts
from reports.figures.drawing import drawn
from reports.store.tables import load_store
from studies.bench.rounds import BROKEN, COLUMNS, HOLDS, NO_BAR, Group, Line, in_rounds
from studies.store.atomic import write_table


def table(*rows: tuple[object, ...]) -> pd.DataFrame:
    return pd.DataFrame(rows, columns=list(COLUMNS))


def number(line: str, what: str, median: float, at_most: float = NO_BAR, holds: str = "", group: str = "solve: half"):
    return group, line, what, median, 0.9 * median, 1.2 * median, at_most, holds


MADE_UP = table(
    number("splu", "units", 1.0, group="unit"),
    number("splu", "ms", 97.4, group="unit"),
    number("qp", "units", 10.0),
    number("qp", "x semismooth", 2.0, 1.3, BROKEN),
    number("qp", "force_N", 1956.5599),
    number("qp", "part assembly", 0.99),
    number("qp", "part contact", 6.0),
    number("qp", "part rest", 3.01),
    number("start to files", "units", 4.0, 6.0, HOLDS, group="command"),
    number("start to files", "part start and files", 3.0, group="command"),
    number("start to files", "part contact", 1.0, group="command"),
)


def test_parts_are_named_from_the_largest_and_small_ones_are_not() -> None:
    parts = parts_of(MADE_UP)
    assert parts.columns.tolist() == ["assembly", "contact", "rest", "start and files"]
    assert parts.loc["start to files"].tolist() == [0.0, 1.0, 0.0, 3.0]
    assert said_of_parts(parts).splitlines() == [
        "- `qp`, 10.0 units: contact 60 %, rest 30 %",
        "- `start to files`, 4.0 units: start and files 75 %, contact 25 %",
    ]


def test_bars_are_counted_and_those_broken_are_named() -> None:
    bars = MADE_UP[MADE_UP["at_most"].notna()]
    said = said_of_bars(bars)
    assert said.startswith("1 of 2 bars hold, but not:")
    assert said.splitlines()[2:] == ["- solve: half, `qp`: x semismooth 2, at most 1.3"]
    assert said_of_bars(bars[bars["holds"] == HOLDS]) == "1 of 1 bars hold."


def test_the_page_shows_what_was_measured(own_store: Path) -> None:
    assert "Not measured here; `footprint bench --table" in spent_part(load_store(own_store)).text
    write_table(own_store / "tables" / "costs.csv", MADE_UP)
    text = spent_part(load_store(own_store)).text
    assert "takes 97 ms here" in text
    assert "| `qp` | 10 | 9 | 12 | 1956.56 |" in text  # what has a bar is in the table of bars alone
    assert "| solve: half | `qp` | x semismooth | 2 | 1.8 | 2.4 | 1.3 | BROKEN |" in text
    assert "| command | `start to files` | units | 4 | 3.6 | 4.8 | 6 | holds |" in text


def test_the_picture_has_every_part_where_the_one_before_it_ends() -> None:
    with drawn() as figures:
        time_by_parts(parts_of(MADE_UP))()
    (axes,) = figures[0].axes
    ends = {(bar.get_y(), round(bar.get_x() + bar.get_width(), 9)) for bar in axes.patches}
    assert {end for _, end in ends} >= {10.0, 4.0}
    assert len(axes.patches) == 8


@pytest.mark.parametrize("bar", [0.5, 2.0])
def test_a_table_that_was_measured_is_one_that_is_shown(own_store: Path, bar: float) -> None:
    """What the runner makes of lines of its own goes all the way."""
    clock = iter(range(1000))

    def see(done: object, seconds: float) -> dict[str, float]:
        return {"ms": seconds, "part x_s": seconds}

    lines = [Line("a", lambda: None, see, most={"units": bar})]
    measured = in_rounds([Group("g", lines)], lambda: None, 2, clock=lambda: float(next(clock)))
    write_table(own_store / "tables" / "costs.csv", measured)
    text = spent_part(load_store(own_store)).text
    assert "- `a`, 1.0 units: x 100 %" in text
    assert ("1 of 1 bars hold." in text) is (bar > 1)

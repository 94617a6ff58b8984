"""What stands at the foot of every page: counts of cells, commits, date, versions, machine; the same everywhere."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from reports.cells import Cell
from reports.compare import differences
from reports.html import REPORT
from reports.markdown import END_MACHINE, MACHINE
from reports.origin import completeness, completeness_line, foot, origin
from reports.store import Store

MADE: dict[str, Any] = {
    "version": "1.0",
    "commit": "0123456789abcdef",
    "modified": False,
    "packages": {"numpy": "2.4", "osqp": "1.1", "ngsolve": None},
    "blas": {"numpy": "openblas 0.3", "scipy": "openblas 0.4", "threads": "1"},
    "machine": {"cpu": "One CPU", "cores": 2, "memory_GiB": 23.5, "system": "Linux", "python": "3.11.7"},
    "date": "2026-11-23T08:09:10+00:00",
}
OLD = {"version": "1.0", "commit": "abc", "packages": {"numpy": "2.3"}, "machine": {"cores": 2}}


def store(*made: dict[str, Any], refused: int = 1) -> Store:
    """A cell for each that tells of its origin, the first two of one record, and some refused before they were run."""
    cells = [
        Cell(
            str(i), "roof", "", Path(str(max(i, 1))), {"provenance": told, "timing_s": {"total": 2.0}}, "converged", ""
        )
        for i, told in enumerate(made)
    ]
    cells += [Cell(f"refused {i}", "roof", "", Path("none"), {}, "unsupported", "why") for i in range(refused)]
    return Store(Path(), "some", (), tuple(cells), "Some cells")


def test_the_foot_tells_of_one_origin_without_counts() -> None:
    told = "; ".join(
        [
            "*some: 4 cells planned: 3 converged, 1 unsupported",
            "footprint 1.0, commit 0123456789ab",
            "solved 2026-11-23 08:09 UTC",
            "One CPU, 2 cores, 23.5 GiB, Linux, Python 3.11.7",
            "BLAS openblas 0.3 (numpy), openblas 0.4 (scipy), threads: 1",
            "numpy 2.4, osqp 1.1.*",
        ]
    )
    assert foot(store(MADE, MADE, MADE)) == f"{MACHINE}\n\n{told}\n\n{END_MACHINE}"


def test_several_origins_are_named_with_their_cells() -> None:
    later = {**MADE, "commit": "fedcba9876543210", "modified": True, "date": "2026-11-23T09:00:00+00:00"}
    text = foot(store(MADE, MADE, later, OLD))
    assert "commit 0123456789ab: 2 cells; fedcba987654 (modified): 1 cells; abc: 1 cells;" in text
    assert "solved 2026-11-23 08:09 to 2026-11-23 09:00 UTC" in text
    assert "numpy 2.4, osqp 1.1, numpy 2.3.*" in text


def test_counts_of_cells_are_the_same_wherever_they_stand() -> None:
    """A record that two cells share counts for both, but its time is spent once."""
    loaded = store(MADE, MADE, MADE, OLD, refused=2)
    assert completeness_line(loaded) == "some: 6 cells planned: 4 converged, 2 unsupported"
    assert completeness_line(loaded) in foot(loaded)
    assert "| all | 6 | 4 | 2 |" in completeness(loaded).text
    assert "| commit | 0123456789abcdef: 3 cells; abc: 1 cells |" in origin(loaded)
    assert "processor time of all cells [s] | 6.00, 0 |" in origin(loaded).replace("0.00", "0")


def test_a_campaign_without_a_record_has_a_foot() -> None:
    assert foot(store()) == f"{MACHINE}\n\n*some: 1 cells planned: 1 unsupported.*\n\n{END_MACHINE}"


def test_every_page_ends_with_the_foot_which_is_not_compared(files: dict[str, str]) -> None:
    pages = {name: text for name, text in files.items() if name.endswith(".md")}
    ends = {text[text.rindex(MACHINE) :] for text in pages.values()}
    assert len(ends) == 1
    (end,) = ends
    assert "cells planned: " in end
    assert "commit unknown" in end
    text = pages["index.md"]
    assert differences("index.md", text, text.replace(end, foot(store(MADE)) + "\n")) == []


def test_the_one_file_has_the_foot_once(files: dict[str, str]) -> None:
    """And says under which licence it is, and where a citation stands."""
    whole = files[REPORT]
    end = whole[whole.index("<footer>") : whole.index("</footer>")]
    assert "cells planned: " in end
    assert whole.count("footprint 0, commit unknown") == 1
    assert "MIT licence" in end
    assert 'href="#data--licence-and-citation"' in end

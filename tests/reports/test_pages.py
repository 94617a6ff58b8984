"""The pages of a store made up here: written whole, compared, damaged; nothing is solved."""

from __future__ import annotations

import math
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from reports.chapter import INDEX_TITLE, Chapter
from reports.compare import differences
from reports.contents import CHAPTERS
from reports.figures.result_figures import draw_result
from reports.files import as_bytes
from reports.html import REPORT
from reports.markdown import END_MACHINE, Part
from reports.origin import summary_table
from reports.reading import StoreError
from reports.site import check_pages, compare_pages, rendered, write_pages
from reports.store import load_store
from studies.output.atomic import write_table, write_text
from studies.run.campaigns.report_cells import LISTS
from support.pages.changed import edit_json, place

PAGES = ["index.md", *(each.file for each in CHAPTERS)]


def replace_in(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    write_text(path, text.replace(old, new, 1))


def as_solved(directory: Path) -> Path:
    """The directory of a cell as ``footprint solve`` would have written it."""
    shutil.copy(directory.with_suffix(".json"), directory / "result.json")
    return directory


PAPER = next(number for number, cell in enumerate(LISTS["report"].cells()) if cell.label == "paper")
DAMAGES: dict[str, tuple[Callable[[Path], object], str]] = {
    "no store": (lambda root: shutil.rmtree(root), "no such directory"),
    "no index": (lambda root: (root / "campaigns/report.json").unlink(), ": no campaign"),
    "schema": (lambda root: edit_json(root / "campaigns/report.json", lambda d: d.update(schema=99)), "schema 99"),
    "cell missing": (
        lambda root: (root / f"cells/{PAPER}.json").unlink(),
        "no record of cell 'paper' (missing: not solved yet), which",
    ),
    "cell corrupt": (lambda root: write_text(root / "cells/3.json", "{"), "3.json: cannot be read"),
    "not a record": (lambda root: write_text(root / "cells/3.json", "[]"), "expected a record"),
    "key": (lambda root: edit_json(root / "cells/3.json", lambda d: d.pop("steps")), "3.json: lacks steps"),
    "step": (
        lambda root: edit_json(root / "cells/3.json", lambda d: d["steps"][0].pop("force_N")),
        "3.json: lacks force_N",
    ),
    "table missing": (lambda root: (root / "cells/0/contact.csv").unlink(), "contact.csv: missing"),
    "table empty": (lambda root: write_text(root / "cells/0/contact.csv", ""), "contact.csv: cannot be read"),
    "column": (lambda root: write_text(root / "cells/0/contact.csv", "a,b\n1,2\n"), "lacks the columns delta_mm"),
    "no orders": (lambda root: (root / "tables/convergence.csv").unlink(), "convergence.csv: missing"),
    "of another campaign": (
        lambda root: replace_in(root / "tables/rules.csv", ",report", ",another"),
        "rules.csv: not of campaign 'report'",
    ),
    "no locking": (lambda root: (root / "tables/membrane_locking.csv").unlink(), "membrane_locking.csv: missing"),
    "column of a table": (
        lambda root: write_text(root / "tables/rotation_sweep.csv", "measure\nexact\n"),
        "invariance.md lacks ",
    ),
    "request": (
        lambda root: edit_json(root / "campaigns/report.json", lambda d: d["cells"].pop(0)),
        "has no cell with scene tyre, membrane compatible,",
    ),
}


FEW = ("no store", "no index", "cell missing", "cell corrupt", "key", "table missing", "column of a table")


@pytest.mark.usefixtures("unasked")
@pytest.mark.parametrize(
    ("damage", "says"),
    [pytest.param(*each, marks=[] if name in FEW else pytest.mark.slow, id=name) for name, each in DAMAGES.items()],
)
def test_a_damaged_store_is_one_clear_line_and_nothing_is_written(
    own_store: Path, tmp_path: Path, damage: Callable[[Path], object], says: str
) -> None:
    damage(own_store)
    with pytest.raises(StoreError) as caught:
        write_pages(own_store, tmp_path / "out")
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
@pytest.mark.usefixtures("unasked")
def test_pages_are_the_same_bytes_every_time(store: Path, files: dict[str, str], tmp_path: Path) -> None:
    same_bytes(store, files, tmp_path)


@pytest.mark.slow
def test_pictures_are_the_same_bytes_every_time(store: Path, drawn: dict[str, str], tmp_path: Path) -> None:
    same_bytes(store, drawn, tmp_path)


def same_bytes(store: Path, files: dict[str, str], tmp_path: Path) -> None:
    written = write_pages(store, tmp_path)
    assert [path.relative_to(tmp_path).as_posix() for path in written] == list(files)
    assert {*PAGES} == {name for name in files if name.endswith(".md") and not name.startswith("sheets/")}
    for path, text in zip(written, files.values(), strict=True):
        assert path.read_bytes() == as_bytes(path.name, text), path.name
    assert not list(tmp_path.rglob(".part-*"))


def test_which_algorithm_is_faster_moves_nothing_outside_of_what_is_of_the_machine(own_store: Path) -> None:
    """Rows stand in the order of their seconds, which another machine may have in another order."""
    path = own_store / "tables" / "contact_summary.csv"
    here = str(summary_table(load_store(own_store)))
    write_table(path, pd.read_csv(path)[::-1])
    there = str(summary_table(load_store(own_store)))
    assert here != there
    assert differences("page", here, there) == []


def test_every_page_links_to_every_other(files: dict[str, str]) -> None:
    for name in PAGES:
        assert [other for other in PAGES if other != name and f"]({other})" not in files[name]] == []


def test_a_page_has_one_name(files: dict[str, str]) -> None:
    """The same in its heading, in the links of other pages and in the lists of pages."""
    for each in CHAPTERS:
        if each.file in files:
            assert files[each.file].startswith(f"# {each.title}\n")
    assert files["index.md"].startswith(f"# {INDEX_TITLE}\n")
    titles = [each.title for each in CHAPTERS]
    assert len(set(titles)) == len(titles)


@pytest.mark.slow
def test_a_page_from_outside_is_one_entry_of_the_list(store: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = "# My page\n\nText.\n\n![x](figures/x.svg)"
    own = Chapter("mine", "My page", "what a stranger asks.", lambda store: Part(text), needs=("cycles",))
    drawn = Part(text.replace("My page", "Sheet"), {"x.svg": lambda: "<svg/>"})
    sheet = Chapter("sheets/one", "Sheet", "one of many.", lambda store: drawn, under="mine")
    needy = Chapter("needy", "Another", "what has no table.", lambda store: Part("# No"), needs=("nothing",))
    monkeypatch.setattr("reports.site.CHAPTERS", [*CHAPTERS, own, sheet, needy])
    files = rendered(load_store(store), draw=False)
    assert files["mine.md"].startswith("# My page\n\n[Results](index.md) — **Answers:** [")
    assert "**More:**" not in files["mine.md"]
    assert " — **More:** [My page](mine.md)\n" in files["tyre.md"]
    up = "[Results](../index.md) · up: [My page](../mine.md)"
    assert files["sheets/one.md"].startswith(f"# Sheet\n\n{up} — **Answers:** [")
    assert "](../figures/x.svg)" in files["sheets/one.md"]
    assert "sheets/one.md" not in files["tyre.md"] + files["index.md"]
    assert "- [My page](mine.md): what a stranger asks." in files["index.md"]
    assert '<section id="mine">' in files[REPORT]
    assert "needy.md" not in files


@pytest.mark.slow
def test_committed_pages_agree_with_their_store(store: Path, out: Path) -> None:
    """Pictures are not compared."""
    assert check_pages(store, out) == []
    assert f"{out / 'nowhere'}: no page to compare" in check_pages(store, out / "nowhere")


def test_every_picture_of_a_page_is_written_and_every_written_picture_is_shown(files: dict[str, str]) -> None:
    pages = "\n".join(text for name, text in files.items() if name.endswith(".md"))
    shown = set(re.findall(r"\]\((?:\.\./)?(figures/[^)]+)\)", pages))
    assert shown == {name for name in files if name.endswith(".svg")}


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn")
def test_cells_that_did_not_converge_are_shown(own_store: Path) -> None:
    """All fail but the one without which there is no page; what was never reached is not in the store."""
    for i, cell in enumerate(LISTS["report"].cells()):
        if cell.label == "paper":
            continue
        directory = own_store / "cells" / str(i)
        failed = {"outcome": "cycling", "class": "not-converged", "reason": "press at 20: it cycles"}
        failed |= {"steps": [], "quantities": {}}
        edit_json(directory.with_suffix(".json"), lambda result, failed=failed: result.update(failed))
        for name in ("contact.csv", "profile.csv"):
            (directory / name).unlink(missing_ok=True)
    files = rendered(load_store(own_store))
    assert "| exact trial-and-error plain exact | not-converged | press at 20: it cycles |" in files["data.md"]
    nans = {name: re.findall(r".*\bnan\b.*", text)[:2] for name, text in files.items() if name.endswith(".md")}
    assert {name: found for name, found in nans.items() if found} == {}


def test_without_the_travel_of_the_printed_table_there_is_no_page(own_store: Path) -> None:
    path = own_store / "cells" / f"{PAPER}.json"
    edit_json(path, lambda result: result.update(steps=result["steps"][:3], reason="it cycles"))
    with pytest.raises(StoreError, match="cell 'paper' has no step at delta_mm = 20: it cycles"):
        rendered(load_store(own_store), draw=False)


PAPER_TYRE = {"scene": "tyre", "measure": "exact", "contact": "semismooth", "newton": "mixed", "mesh": "42x40"}


def test_a_cell_is_found_by_its_request(own_store: Path) -> None:
    loaded = load_store(own_store)
    rest = {
        "load": "dead",
        "coupling": "lumped",
        "section": "constant-s33",
        "E_L_MPa": 510.45,
        "model": "full",
        "membrane": "compatible",
    }
    base = loaded.find(**PAPER_TYRE, **rest, delta_mm=20, epsilon=math.inf)
    assert base.label == "exact semismooth mixed exact"  # and not the one that asks for the same under another label
    path = [5.0, 10.0, 15.0, *range(20, 28)]
    assert loaded.find(**PAPER_TYRE, **rest, delta_mm=path).label == "paper"
    assert [cell.result["mesh"] for cell in loaded.select(scene="tyre-solid", epsilon=math.inf)] == [
        "14x18",
        "28x36",
        "56x72",
    ]
    with pytest.raises(
        StoreError, match=r"has \d cells \('hemisphere 64', .* with scene hemisphere, mesh 64x64; the pages need one"
    ):
        loaded.find(scene="hemisphere", mesh="64x64")
    with pytest.raises(StoreError, match="has no cell with scene tyre, measure odd; the pages need one"):
        loaded.find(scene="tyre", measure="odd")
    (own_store / "cells/0.json").unlink()
    with pytest.raises(StoreError, match="no record of cell 'paper' \\(missing: not solved yet\\)"):
        load_store(own_store).find(**PAPER_TYRE, **rest, delta_mm=path)


def test_a_changed_digit_is_found_with_page_and_line(files: dict[str, str], out: Path) -> None:
    text = files["tyre.md"].splitlines()
    number = next(i for i, line in enumerate(text, start=1) if "2000.00" in line)
    replace_in(out / "tyre.md", "2000.00", "2000.07")
    (found,) = compare_pages(files, out)
    assert found.startswith(f"tyre.md:{number}: committed ")
    assert "2000.07" in found


def test_what_the_machine_decides_is_not_compared(files: dict[str, str], out: Path) -> None:
    replace_in(out / "cost.md", " 8.00 |", " 7.00 |")
    replace_in(out / "index.md", "numpy 2", "numpy 3")
    assert compare_pages(files, out) == []


def test_a_picture_of_what_was_measured_may_come_and_go(files: dict[str, str], out: Path) -> None:
    shown = files["cost.md"].replace(END_MACHINE, f"![words](figures/new.svg)\n{END_MACHINE}", 1)
    fresh = {**files, "cost.md": shown, "figures/new.svg": "<svg/>"}
    assert compare_pages(fresh, out) == []
    (out / "figures" / "new.svg").write_text("<svg/>")
    (found,) = compare_pages(files, out)  # no page shows it
    assert found == f"figures/new.svg: in {out}, but no longer made"
    write_text(out / "cost.md", shown)
    assert compare_pages(files, out) == []
    stated = {**fresh, "tyre.md": files["tyre.md"] + "![words](figures/new.svg)"}
    (out / "figures" / "new.svg").unlink()
    assert f"figures/new.svg: missing in {out}" in compare_pages(stated, out)


def test_words_are_compared(files: dict[str, str], out: Path) -> None:
    replace_in(out / "index.md", "Interchangeable", "Exchangeable")
    (found,) = compare_pages(files, out)
    assert found.startswith("index.md:")


def test_missing_and_surplus_files_are_found(files: dict[str, str], out: Path) -> None:
    (out / "tyre.md").unlink()
    (out / "old.md").write_text("old")
    picture = next(iter(files))
    (out / picture).unlink()
    found = compare_pages(files, out)
    assert [line.split(":")[0] for line in found] == [picture, "tyre.md", "old.md"]


def test_comparing_no_page_at_all_is_a_difference(files: dict[str, str], tmp_path: Path) -> None:
    assert f"{tmp_path}: no page to compare" in compare_pages(files, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize(("label", "count"), [("exact semismooth mixed exact", 4), ("hemisphere 16", 1)])
def test_pictures_of_one_result(own_store: Path, label: str, count: int) -> None:
    directory = as_solved(next(cell for cell in load_store(own_store).cells if cell.label == label).directory)
    drawn = draw_result(directory)
    assert len(drawn) == count
    assert all(path.parent == directory / "figures" and path.read_text().startswith("<?xml") for path in drawn)


def test_a_result_without_a_step_has_no_picture(own_store: Path) -> None:
    directory = as_solved(own_store / "cells/0")
    edit_json(directory / "result.json", lambda result: result.update(steps=[]))
    assert draw_result(directory) == []
    with pytest.raises(StoreError, match=r"result\.json: missing"):
        draw_result(own_store)


@pytest.mark.slow
def test_a_state_that_is_not_certified_is_counted_and_named(own_store: Path) -> None:
    (page,) = (each for each in CHAPTERS if each.name == "convergence")
    text = page.render(load_store(own_store)).text
    count = int(re.search(r"of each of the (\d+) states", text)[1])
    assert f"certifies {count} of them" in text
    assert "Not certified" not in text
    path = place(own_store, "hemisphere 16").with_suffix(".json")
    edit_json(path, lambda result: result["steps"][-1].update(failures=["energy"]))
    text = page.render(load_store(own_store)).text
    assert f"certifies {count - 1} of them" in text
    assert "Not certified, for energy: states of hemisphere." in text

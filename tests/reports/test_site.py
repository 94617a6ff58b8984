"""The site as a whole: written whole or not at all, compared, linked; numbers, templates and the foot of every page."""

from __future__ import annotations

import gzip
import math
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from reports import markdown, site
from reports.chapter import INDEX_TITLE, Chapter
from reports.chapters.gallery import sheets
from reports.contents import CHAPTERS
from reports.figures.result_figures import draw_result
from reports.files import StoreError, as_bytes
from reports.formats import digits, fixed, percent, scientific, share
from reports.html import REPORT
from reports.markdown import END_MACHINE, FOLDER, FOR, MACHINE, Part, Template, machine, prose
from reports.origin import completeness, completeness_line, foot, origin
from reports.site import check_pages, compare_pages, differences, rendered, same_number, write_pages
from reports.store import Cell, Store, load_store
from studies.output.atomic import write_text
from studies.run.lists import LISTS
from support.pages import edit_json

PAGES = ["index.md", *(each.file for each in CHAPTERS)]
PAPER = next(number for number, cell in enumerate(LISTS["report"].cells()) if cell.label == "paper")

# --- what is wrong with a store -------------------------------------------------------------------------------------


def with_paper(store: Store, **values: Any) -> Store:
    """The store with another cell in the place of the paper's tyre."""
    planned = list(store.planned)
    planned[PAPER] = replace(planned[PAPER], **values)
    return replace(store, planned=tuple(planned))


def without_table(name: str) -> Callable[[Store], None]:
    return lambda store: (store.path / "tables" / f"{name}.csv").unlink()


def written_over(name: str, text: str) -> Callable[[Store], None]:
    return lambda store: write_text(store.path / "tables" / f"{name}.csv", text)


def of_another(store: Store) -> None:
    rules = (store.path / "tables/rules.csv").read_text(encoding="utf-8")
    write_text(store.path / "tables/rules.csv", rules.replace(",report", ",another"))


def steps_lost(store: Store) -> Store:
    result = {**store.planned[PAPER].result, "reason": "it cycles"}
    return with_paper(store, result={**result, "steps": result["steps"][:3]})


DAMAGES: dict[str, tuple[Callable[[Store], Store | None], str]] = {
    "cell missing": (
        lambda store: with_paper(store, result={}, ended="missing", reason="not solved yet"),
        "no record of cell 'paper' (missing: not solved yet), which",
    ),
    "steps missing": (steps_lost, "cell 'paper' has no step at delta_mm = 20: it cycles"),
    "not asked for": (
        lambda store: replace(store, planned=tuple(c for c in store.planned if c.label != "paper")),
        "has no cell 'paper', which the pages need",
    ),
    "no orders": (without_table("convergence"), "convergence.csv: missing"),
    "no locking": (without_table("membrane_locking"), "membrane_locking.csv: missing"),
    "no boundaries": (without_table("shell_boundaries"), "shell_boundaries.csv: missing"),
    "of another campaign": (of_another, "rules.csv: not of campaign 'report'"),
    "empty table": (written_over("rotation_sweep", ""), "rotation_sweep.csv: cannot be read"),
    "column of a table": (written_over("rotation_sweep", "measure\nexact\n"), "invariance.md lacks "),
}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.slow if name in ("not asked for", "steps missing") else ())
        for name in DAMAGES
    ],
)
def test_a_damaged_store_is_one_clear_line_and_nothing_is_written(
    edited: Store, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    damage, says = DAMAGES[name]
    damaged = damage(edited) or edited
    monkeypatch.setattr("reports.site.load_store", lambda path, campaign: damaged)
    monkeypatch.setattr("reports.site.rendered", lambda store, **options: rendered(store, draw=False))
    with pytest.raises(StoreError) as caught:
        write_pages(damaged.path, tmp_path / "out")
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_a_table_of_a_cell_is_checked(loaded: Store, tmp_path: Path) -> None:
    cell = replace(loaded.planned[PAPER], directory=tmp_path)
    for text, says in ((None, "missing"), ("", "cannot be read"), ("a,b\n1,2\n", "lacks the columns delta_mm")):
        if text is not None:
            write_text(tmp_path / "contact.csv", text)
        with pytest.raises(StoreError, match=rf"contact\.csv: {says}"):
            cell.table("contact")
    with pytest.raises(StoreError, match="no such directory"):
        load_store(tmp_path / "nowhere")


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn")
def test_cells_that_did_not_converge_are_shown(own_store: Path) -> None:
    """All fail but the one without which there is no page; what was never reached is not in the store."""
    failed = {"outcome": "cycling", "class": "not-converged", "reason": "press at 20: it cycles"}
    failed |= {"steps": [], "quantities": {}}
    for i, cell in enumerate(LISTS["report"].cells()):
        if cell.label != "paper":
            edit_json(own_store / "cells" / f"{i}.json", lambda result: result.update(failed))
            for name in ("contact.csv", "profile.csv"):
                (own_store / "cells" / str(i) / name).unlink(missing_ok=True)
    files = rendered(load_store(own_store))
    assert "| exact trial-and-error plain exact | not-converged | press at 20: it cycles |" in files["data.md"]
    nans = {name: re.findall(r".*\bnan\b.*", text)[:2] for name, text in files.items() if name.endswith(".md")}
    assert {name: actual for name, actual in nans.items() if actual} == {}


# --- all pages ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_pages_and_pictures_are_the_same_bytes_every_time(
    loaded: Store, files: dict[str, str], drawn: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of sheets are of one kind: one of them is drawn again. What is written is what is rendered."""
    texts = {name: text for name, text in files.items() if name.endswith(".md")}
    assert texts.items() <= drawn.items()
    chapters = [*(each for each in CHAPTERS if each.applies(loaded)), sheets(loaded)[0]]
    pictures = {name: each for chapter in chapters for name, each in chapter.render(loaded).pictures.items()}
    assert [name for name, each in pictures.items() if each() != drawn[f"figures/{name}"]] == []
    monkeypatch.setattr("reports.site.rendered", lambda store, *, draw=True: drawn if draw else files)
    written = write_pages(loaded.path, tmp_path)
    assert [path.relative_to(tmp_path).as_posix() for path in written] == list(drawn)
    for path, text in zip(written, drawn.values(), strict=True):
        assert path.read_bytes() == as_bytes(path.name, text), path.name
    assert not list(tmp_path.rglob(".part-*"))
    assert check_pages(loaded.path, tmp_path) == []


def test_compressed_files_are_the_same_bytes_every_time() -> None:
    assert as_bytes("a.csv.gz", "text") == as_bytes("a.csv.gz", "text")
    assert gzip.decompress(as_bytes("a.csv.gz", "tëxt")).decode() == "tëxt"
    assert as_bytes("a.csv", "tëxt") == "tëxt".encode()


def test_every_page_has_one_name_and_links_to_every_other_and_to_its_pictures(files: dict[str, str]) -> None:
    assert {*PAGES} == {name for name in files if name.endswith(".md") and not name.startswith("sheets/")}
    titles = {INDEX_TITLE, *(each.title for each in CHAPTERS)}
    assert len(titles) == len(PAGES)
    for name, title in zip(PAGES, [INDEX_TITLE, *(each.title for each in CHAPTERS)], strict=True):
        assert files[name].startswith(f"# {title}\n")
        assert [other for other in PAGES if other != name and f"]({other})" not in files[name]] == []
    pages = "\n".join(text for name, text in files.items() if name.endswith(".md"))
    shown = set(re.findall(r"\]\((?:\.\./)?(figures/[^)]+)\)", pages))
    assert shown == {name for name in files if name.endswith(".svg")}


@pytest.mark.slow
def test_a_page_from_outside_is_one_entry_of_the_list(loaded: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    text = "# My page\n\nText.\n\n![x](figures/x.svg)"
    own = Chapter("mine", "My page", "what a stranger asks.", lambda store: Part(text), needs=("cycles",))
    drawn = Part(text.replace("My page", "Sheet"), {"x.svg": lambda: "<svg/>"})
    sheet = Chapter("sheets/one", "Sheet", "one of many.", lambda store: drawn, under="mine")
    needy = Chapter("needy", "Another", "what has no table.", lambda store: Part("# No"), needs=("nothing",))
    monkeypatch.setattr("reports.site.CHAPTERS", [*CHAPTERS, own, sheet, needy])
    files = rendered(loaded, draw=False)
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
@pytest.mark.parametrize(("label", "count"), [("exact semismooth mixed exact", 4), ("hemisphere 16", 1)])
def test_pictures_of_one_result(own_store: Path, label: str, count: int) -> None:
    """As ``footprint solve`` would have written it."""
    directory = next(cell for cell in load_store(own_store).cells if cell.label == label).directory
    directory.mkdir(exist_ok=True)  # of a cell without tables there is none
    shutil.copy(directory.with_suffix(".json"), directory / "result.json")
    drawn = draw_result(directory)
    assert len(drawn) == count
    assert all(path.parent == directory / "figures" and path.read_text().startswith("<?xml") for path in drawn)


def test_a_result_without_a_step_has_no_picture(store: Path, tmp_path: Path) -> None:
    with pytest.raises(StoreError, match=r"result\.json: missing"):
        draw_result(tmp_path)
    shutil.copy(store / "cells/0.json", tmp_path / "result.json")
    edit_json(tmp_path / "result.json", lambda result: result.update(steps=[]))
    assert draw_result(tmp_path) == []


# --- pages compared -------------------------------------------------------------------------------------------------

ONE = f"# One\n\nWords and 2000.00 N.\n\n![x](figures/x.svg)\n\n{machine('took 8.00 s')}\n"
MADE = {"figures/x.svg": "<svg/>", "one.md": ONE, "sheets/two.md": "# Two\n", "report.html": "<html/>"}


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """The pages as committed."""
    for name, text in MADE.items():
        write_text(tmp_path / name, text)
    return tmp_path


def test_pages_agree_but_for_what_the_machine_decides(out: Path) -> None:
    assert compare_pages(MADE, out) == []
    assert compare_pages({**MADE, "one.md": ONE.replace("8.00 s", "7.00 s"), "report.html": "other"}, out) == []
    assert compare_pages(MADE, out / "nowhere")[-1] == f"{out / 'nowhere'}: no page to compare"


def test_words_and_digits_are_compared(out: Path) -> None:
    (number,) = compare_pages({**MADE, "one.md": ONE.replace("2000.00", "2000.07")}, out)
    assert number.startswith("one.md:3: committed 'Words and 2000.00")
    assert "2000.07" in number
    (words,) = compare_pages({**MADE, "one.md": ONE.replace("Words", "Phrases")}, out)
    assert words.startswith("one.md:3: ")


def test_missing_and_surplus_files_are_found(out: Path) -> None:
    (out / "one.md").unlink()
    (out / "figures/x.svg").unlink()
    (out / "old.md").write_text("old")
    assert [line.split(":")[0] for line in compare_pages(MADE, out)] == ["figures/x.svg", "one.md", "old.md"]


def test_a_picture_of_what_was_measured_may_come_and_go(out: Path) -> None:
    shown = ONE.replace(END_MACHINE, f"![words](figures/new.svg)\n{END_MACHINE}", 1)
    fresh = {**MADE, "one.md": shown, "figures/new.svg": "<svg/>"}
    assert compare_pages(fresh, out) == []
    write_text(out / "figures" / "new.svg", "<svg/>")
    assert compare_pages(MADE, out) == [f"figures/new.svg: in {out}, but no longer made"]  # no page shows it
    write_text(out / "one.md", shown)
    assert compare_pages(MADE, out) == []
    (out / "figures" / "new.svg").unlink()
    stated = {**fresh, "sheets/two.md": "# Two\n![words](figures/new.svg)"}
    assert f"figures/new.svg: missing in {out}" in compare_pages(stated, out)


ALIKE = {
    ("12.34", "12.35"): True,
    ("12.34", "12.36"): False,
    ("211", "212"): False,
    ("211", "211"): True,
    ("1959.049892", "1959.049999"): True,
    ("1959.049892", "1959.149892"): False,
    ("3.0e-13", "7.1e-09"): True,
    ("0", "7.1e-09"): True,
    ("0", "0.3"): False,
    ("3.0e-13", "2.0e-08"): False,
    ("-8.02e-07", "-8.03e-07"): True,
    ("-8.02e-07", "+8.02e-07"): False,
}


def test_numbers_agree_to_their_last_digit() -> None:
    assert {pair: same_number(*pair) for pair in ALIKE} == ALIKE


def test_inserted_and_lost_lines_are_differences_of_their_own() -> None:
    assert len(differences("p.md", "a 1\nb 2\n", "a 1\nnew\nb 2\n")) == 1
    assert differences("p.md", "a 1\nb 2\n", "b 2\n") == ["p.md:1: committed 'a 1', regenerated ''"]
    assert differences("p.md", f"x\n{machine('9 s')}\ny 1", f"x\n{machine('8 s')}\n\ny 1") != []
    assert differences("p.md", f"x\n{machine('9 s')}", "x") != []


# --- numbers, prose, templates --------------------------------------------------------------------------------------


def test_zero_has_no_sign_in_any_format() -> None:
    assert fixed(-0.0004, 2) == "0.00"
    assert percent(-1e-9) == "0.00 %"
    assert (percent(-0.0123), percent(0.0123), share(-0.0123)) == ("-1.23 %", "+1.23 %", "-1.23 %")
    assert digits(-0.0, 3) == "0.00"
    assert scientific(-0.0) == "0"
    assert fixed(None, 2) == scientific(None) == percent(None) == "–"


def test_prose_joins_lines_but_not_items() -> None:
    assert prose("a\nb\n\n- c\n  d\n- e") == "a b\n\n- c d\n- e"


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


LEFT = {  # of a text with nothing to fill in
    f"Before.\n\n{TABLE}\nAfter.": "Before.\n\nAfter.",
    f"{MACHINE}\n\n{TABLE}\n{END_MACHINE}\n\nAfter.": "After.",
    f"<details><summary>So many</summary>\n\n{MACHINE}\n\n{{none}}\n\n{END_MACHINE}\n\n</details>": "",
    "One. {none} Two. {none}": "One. Two.",
    "| a |\n| :-- |\nfor rows: | {x} |\n| the end |": "| a |\n| :-- |\n| the end |",
}


def test_what_is_empty_leaves_no_trace(made) -> None:
    assert {text: made(text)("block", rows=[], none="").text for text in LEFT} == LEFT


def test_lines_are_joined_but_not_items_rows_and_code(made) -> None:
    text = "a\nb\n\n- c\n  d\n- e\n\n| f |\n| :-- |\n| g |\n\n```sh\nh {{i}}\n\nj\n```"
    kept = "a b\n\n- c d\n- e\n\n| f |\n| :-- |\n| g |\n\n```sh\nh {i}\n\nj\n```"
    assert made(text)("block").text == kept


def test_pictures_of_parts_come_with_them(made) -> None:
    inner = Part("![x](figures/x.svg)", {"x.svg": lambda: "<x/>"})
    part = made("{inner}\n\n![y](figures/y.svg)")("block", {"y.svg": lambda: "<y/>"}, inner=inner)
    assert part.text == "![x](figures/x.svg)\n\n![y](figures/y.svg)"
    assert {name: draw() for name, draw in part.pictures.items()} == {"x.svg": "<x/>", "y.svg": "<y/>"}


def test_every_table_of_a_template_has_as_many_heads_as_columns() -> None:
    for name in sorted(path.stem for path in FOLDER.glob("*.md")):
        for block, paragraphs in Template(name).blocks.items():
            for lines in (each for each in paragraphs if each[0].startswith("| ")):
                rows = [FOR.sub(r"\2", line) for line in lines]
                assert len({len(re.findall(r" \|(?= )", row)) for row in rows}) == 1, f"{name}, {block}: {rows[0]}"


# --- the foot of every page -----------------------------------------------------------------------------------------

ORIGIN: dict[str, Any] = {
    "version": "1.0",
    "commit": "0123456789abcdef",
    "modified": False,
    "packages": {"numpy": "2.4", "osqp": "1.1", "ngsolve": None},
    "blas": {"numpy": "openblas 0.3", "scipy": "openblas 0.4", "threads": "1"},
    "machine": {"cpu": "One CPU", "cores": 2, "memory_GiB": 23.5, "system": "Linux", "python": "3.11.7"},
    "date": "2026-11-23T08:09:10+00:00",
}
OLD = {"version": "1.0", "commit": "abc", "packages": {"numpy": "2.3"}, "machine": {"cores": 2}}
FOOT = """\
*some: 4 cells planned: 3 converged, 1 unsupported; footprint 1.0, commit 0123456789ab; solved 2026-11-23 08:09 UTC; \
One CPU, 2 cores, 23.5 GiB, Linux, Python 3.11.7; BLAS openblas 0.3 (numpy), openblas 0.4 (scipy), threads: 1; \
numpy 2.4, osqp 1.1.*"""


def solved_by(*made: dict[str, Any], refused: int = 1) -> Store:
    """A cell for each that tells of its origin, the first two of one record, and some refused before they were run."""
    cells = []
    for i, stated in enumerate(made):
        result = {"provenance": stated, "timing_s": {"total": 2.0}}
        cells.append(Cell(str(i), "roof", "", Path(str(max(i, 1))), result, "converged", ""))
    cells += [Cell(f"refused {i}", "roof", "", Path("none"), {}, "unsupported", "why") for i in range(refused)]
    return Store(Path(), "some", tuple(cells), "Some cells")


def test_the_foot_tells_of_one_origin_without_counts() -> None:
    assert foot(solved_by(ORIGIN, ORIGIN, ORIGIN)) == machine(FOOT)
    assert foot(solved_by()) == machine("*some: 1 cells planned: 1 unsupported.*")


def test_several_origins_are_named_with_their_cells() -> None:
    later = {**ORIGIN, "commit": "fedcba9876543210", "modified": True, "date": "2026-11-23T09:00:00+00:00"}
    text = foot(solved_by(ORIGIN, ORIGIN, later, OLD))
    assert "commit 0123456789ab: 2 cells; fedcba987654 (modified): 1 cells; abc: 1 cells;" in text
    assert "solved 2026-11-23 08:09 to 2026-11-23 09:00 UTC" in text
    assert "numpy 2.4, osqp 1.1, numpy 2.3.*" in text


def test_counts_of_cells_are_the_same_wherever_they_stand() -> None:
    """A record that two cells share counts for both, but its time is spent once."""
    loaded = solved_by(ORIGIN, ORIGIN, ORIGIN, OLD, refused=2)
    assert completeness_line(loaded) == "some: 6 cells planned: 4 converged, 2 unsupported"
    assert completeness_line(loaded) in foot(loaded)
    assert "| all | 6 | 4 | 2 |" in completeness(loaded).text
    assert "| commit | 0123456789abcdef: 3 cells; abc: 1 cells |" in origin(loaded)
    assert "processor time of all cells [s] | 6.00, 0 |" in origin(loaded).replace("0.00", "0")


def test_every_page_ends_with_the_foot_and_the_one_file_has_it_once(files: dict[str, str]) -> None:
    """The one file says under which licence it is, too, and where a citation stands."""
    (end,) = {text[text.rindex(MACHINE) :] for name, text in files.items() if name.endswith(".md")}
    assert "cells planned: " in end
    assert "commit unknown" in end
    text = files["index.md"]
    assert differences("index.md", text, text.replace(end, foot(solved_by(ORIGIN)) + "\n")) == []
    whole = files[REPORT]
    end = whole[whole.index("<footer>") : whole.index("</footer>")]
    assert "cells planned: " in end
    assert whole.count("footprint 0, commit unknown") == 1
    assert "MIT licence" in end
    assert 'href="#data--licence-and-citation"' in end


def test_who_changes_a_table_of_a_cell_changes_it_for_nobody_else(tmp_path: Path) -> None:
    (tmp_path / "curve.csv").write_text("newton_iterations,limit_point\n3,0\n", encoding="utf-8")
    cell = Cell("a", "ring", "", tmp_path, {}, "converged", "")
    changed = cell.table("curve")
    changed["limit_point"] = 1
    assert cell.table("curve")["limit_point"].tolist() == [0]


@pytest.mark.parametrize("name", ["/a.md", "../a.md", "figures/../../a.svg"])
def test_no_page_is_written_outside_its_folder(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(site, "load_store", lambda *_: Store(tmp_path, "a", ()))
    monkeypatch.setattr(site, "rendered", lambda *_, **__: {name: ""})
    with pytest.raises(StoreError, match="leads out of its folder"):
        write_pages(tmp_path, tmp_path / "out")

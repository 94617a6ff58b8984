"""Commands, Python and files of README and manual work as they are printed, and the site is made of them."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

import studies.footprint
from reports import documentation
from studies.cli import main
from support.sources import MANUAL, PAGES, README, ROOT, Block, blocks, lines

WHOLE = 8  # of the pages have no block that is run


def run_lines(block: Block) -> None:
    """``footprint`` in this process, everything else by the shell."""
    for line, code in lines(block):
        words = shlex.split(line)
        if words[0] == "footprint":
            try:
                ended = main(words[1:])
            except SystemExit as error:  # --version, and words that are none
                ended = int(str(error.code))
        else:
            ended = subprocess.run(
                ["bash", "-c", line.replace("python ", f"{sys.executable} ")], check=False
            ).returncode
        assert ended == code, line


def run_page(page: Path) -> None:
    names: dict[str, object] = {"__name__": "page"}
    for block in blocks(page):
        if block.title:
            Path(block.title).write_text(block.text, encoding="utf-8")
        elif block.run and block.language == "python":
            exec(block.text, names)
        elif block.run and block.language == "sh":
            run_lines(block)


RUN = [page for page in PAGES if page != README and any(each.run and not each.title for each in blocks(page))]


@pytest.mark.slow
@pytest.mark.parametrize("page", RUN, ids=lambda page: page.stem)
def test_a_page_works_as_it_is_printed(page, tmp_path, monkeypatch, put_back) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "footprint", studies.footprint)  # as the build lays it down
    run_page(page)


@pytest.mark.slow
@pytest.mark.parametrize("notebook", sorted(MANUAL.glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_runs(notebook, tmp_path, monkeypatch) -> None:
    """As plain Python; nothing that was put out is kept in it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "footprint", studies.footprint)
    cells = [each for each in json.loads(notebook.read_text(encoding="utf-8"))["cells"] if each["cell_type"] == "code"]
    assert not any(each["outputs"] for each in cells)
    exec("".join("".join([*each["source"], "\n"]) for each in cells), {"__name__": "notebook"})


def test_most_pages_are_run() -> None:
    assert len(RUN) >= len(PAGES) - WHOLE


def test_a_wrong_exit_code_and_a_wrong_snippet_are_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for text in ("footprint show nothing", "footprint list scenes    # exit 2", "false"):
        with pytest.raises(AssertionError, match=text.split("  ")[0]):
            run_lines(Block("sh", "", text, True))
    page = tmp_path / "page.md"
    page.write_text("```python\nassert 1 + 1 == 3\n```\n")
    with pytest.raises(AssertionError):
        run_page(page)
    page.write_text("<!-- not run: wrong -->\n```python\nassert 1 + 1 == 3\n```\n")
    run_page(page)


def test_every_page_of_the_manual_is_listed() -> None:
    listed = (ROOT / ".github" / "mkdocs.yml").read_text(encoding="utf-8")
    assert [page.name for page in MANUAL.glob("*.md") if f": manual/{page.name}\n" not in listed] == []


@pytest.mark.slow
def test_the_api_has_every_public_module() -> None:
    """A heading each; the names in it are those that have no underscore."""
    pages = documentation.api_pages()
    text = "\n".join(pages.values())
    packages = ("formulations", "contact", "studies", "reports")
    paths = (path.relative_to(ROOT) for package in packages for path in (ROOT / package).rglob("*.py"))
    names = {".".join(path.with_suffix("").parts).removesuffix(".__init__") for path in paths}
    shown = {line.removeprefix("## ") for line in text.splitlines() if line.startswith("## ")}
    assert {name for name in names - shown if not name.startswith(documentation.LEFT_OUT)} == set()
    assert {name.rsplit(".", 1)[1] for name in documentation.users_names()} == set(studies.footprint.__all__)
    assert all(f"::: {name}\n" in pages["api/footprint.md"] for name in documentation.users_names())

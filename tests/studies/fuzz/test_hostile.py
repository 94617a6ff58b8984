"""Files from elsewhere, spoilt at random: each is taken, or refused in a line, and nothing of them is live."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Callable, Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep
from reports.files import as_words
from reports.html import to_html
from reports.markdown import joined, table
from studies.ask.scene import UsageError
from studies.cli import main
from studies.commands import FAILED, NOT_CONVERGED, OK, WRONG_USE
from studies.run.campaign import read
from support.stores import spoiling

CAMPAIGN = """title = "t"
pages = "all"
lists = ["epsilon"]

[[cross]]
name = "sweep"
measures = ["exact"]
contacts = ["semismooth", "qp"]
tolerances = [1e-3, 1e-9]
set = { element = "paper" }
[cross.scenes.panel]
meshes = ["2x2"]
set = { delta_mm = "0.5" }
"""
ONE = '[[cross]]\nname = "t"\n[cross.scenes.panel]\nmeshes = ["2x2"]\n'
ANSWER = {"du": [0.1, 0.2], "pressure": [3.0], "claims": {"accuracy": 1e-9, "force": 1.5, "pressed": [0]}}
DRAWS = [range(12), pytest.param(range(12, 40), marks=pytest.mark.slow)]
each_draw = pytest.mark.parametrize("draws", DRAWS, ids=["few", "many"])
LIVE = {"script", "img", "figure", "a", "svg", "iframe", "object", "embed", "form", "style", "link", "meta", "base"}
Say = Callable[[], str]


class Tags(HTMLParser):
    """Names of the tags of a page, and of the attributes that would run."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.names: set[str] = set()
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.names |= {tag, *(name for name, _ in attrs if name.startswith("on"))}


@pytest.fixture(scope="module")
def theirs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of a campaign of one small cell, with its fields."""
    folder = tmp_path_factory.mktemp("theirs")
    (folder / "one.toml").write_text(ONE)
    assert main(["run", str(folder / "one.toml"), "--store", str(folder / "store"), "--fields"]) == OK
    return folder / "store"


@pytest.fixture(scope="module")
def step(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A frozen step of two unknowns and one candidate."""
    K, G = sparse.csc_matrix(np.diag([2.0, 3.0])), sparse.csr_matrix(np.array([[1.0, 0.0]]))
    path = tmp_path_factory.mktemp("step") / "step.npz"
    one = np.ones(1)
    FrozenStep(K, np.array([1.0, -1.0]), G, -0.1 * one, 0.5 * one, 1.0, None, {"scene": "panel"}).write(path)
    return path


@pytest.fixture
def say(capsys: pytest.CaptureFixture[str]) -> Say:
    """What a command prints, checked: printable, one line where it refuses."""

    def said(*words: str) -> str:
        code = main([str(word) for word in words])
        out, err = capsys.readouterr()
        assert code in (OK, FAILED, WRONG_USE, NOT_CONVERGED)
        for line in (*out.splitlines(), *err.splitlines()):
            assert line.isprintable(), line[:200]
        if code == WRONG_USE:
            assert err.count("\n") == 1, err[:500]
        assert len(out) + len(err) < 20_000
        return out + err

    return said


def _spoilt(data: Any, text: str, rng: np.random.Generator) -> bytes:
    """A document with one strange value, or some bits of its text turned."""
    return spoiling.json_text(data, rng).encode() if rng.random() < 0.8 else spoiling.flipped(text.encode(), rng)


@each_draw
def test_spoilt_stores_are_taken_or_refused_in_a_line(draws: range, theirs: Path, tmp_path: Path, say: Say) -> None:
    for seed in draws:
        rng, there, here = np.random.default_rng([1, seed]), tmp_path / f"there {seed}", tmp_path / f"here {seed}"
        shutil.copytree(theirs, there)
        files = sorted([*(there / "cells").glob("*.json"), *(there / "campaigns").glob("*.json")])
        path = files[rng.integers(len(files))]
        text = path.read_text()
        path.write_bytes(_spoilt(json.loads(text), text, rng))
        say("merge", there, "--store", here)
        for taken in (*here.glob("cells/*.json"), *here.glob("campaigns/*.json"), *here.glob("failures/*.json")):
            _lies_still(json.loads(taken.read_text()))


def test_what_is_written_into_a_page_lies_still() -> None:
    """Every text that a record could hold, in a table."""
    _lies_still([*spoiling.MARKUP, *(text for text in spoiling.CONTROL if text != "\ud800")])


def test_what_is_not_written_out_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fault that is planted: pictures and links of a store reach a page; HTML would be stopped there."""
    monkeypatch.setattr(sys.modules[__name__], "as_words", str)
    for text in spoiling.MARKUP[2:4]:
        with pytest.raises(AssertionError):
            _lies_still([text])


@each_draw
def test_spoilt_answers_are_judged_or_refused_in_a_line(draws: range, step: Path, tmp_path: Path, say: Say) -> None:
    path = tmp_path / "answer.json"
    for seed in draws:
        path.write_bytes(_spoilt(ANSWER, json.dumps(ANSWER), np.random.default_rng([2, seed])))
        say("problems", "judge", step, path)


@each_draw
def test_spoilt_steps_are_solved_or_refused_in_a_line(draws: range, step: Path, tmp_path: Path, say: Say) -> None:
    path = tmp_path / "step.npz"
    for seed in draws:
        path.write_bytes(spoiling.npz(step.read_bytes(), np.random.default_rng([3, seed])))
        say("resolve", path)


@each_draw
def test_spoilt_campaigns_are_read_or_refused_in_a_line(draws: range, tmp_path: Path) -> None:
    path = tmp_path / "sweep.toml"
    for seed in draws:
        path.write_text(spoiling.toml_text(CAMPAIGN, np.random.default_rng([4, seed])), encoding="utf-8")
        assert "\n" not in _said(path), seed


def _said(path: Path) -> str:
    """Why a campaign is refused; nothing where it is read."""
    try:
        read(path)
    except UsageError as error:
        return str(error)
    return ""


def _lies_still(data: Any) -> None:
    """No text of a document becomes more than text in a page, once it is read as a page reads its store."""
    page = joined(table("Texts", ["place", "text"], [["a", as_words(text)] for text in _texts(data)])).text
    assert not Tags(to_html(page, str, lambda name, words: "", str)).names & LIVE


def _texts(data: Any) -> Iterator[str]:
    if isinstance(data, dict | list):
        for each in [*data, *data.values()] if isinstance(data, dict) else data:
            yield from _texts(each)
    elif isinstance(data, str):
        yield data

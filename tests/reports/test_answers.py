"""Ten questions of someone who knows shells but not this suite: each answer stands on page one, or one click away.

And what page one says is what the pages say that it links to.
"""

from __future__ import annotations

import re
from itertools import pairwise

import pytest

from contact.catalogue import ALGORITHMS
from formulations.strains.catalogue import MEASURES
from reports.chapter import Said, statements
from reports.contents import CHAPTERS
from reports.site import NUMBER
from reports.store import Store
from studies.analysis.statements.tables import read_questions

TRIAL = r"does not converge on \d+ of \d+ problems, on \w+|converges on all \d+"
TEN = {  # question: name of the sentence that answers it, and words that it must have
    "Which strain measure do I need for 20 mm of tyre at 5 %?": (
        "tyre-measure",
        r"20 mm of travel of the tyre within 5 %",
    ),
    "What does a better grid save?": (
        "grids-of-the-tyre",
        r"within 1 % of its limit from \d+ unknowns on with uniform grids",
    ),
    "Which contact algorithm, and when not?": (
        "which-algorithm",
        r"Take `[\w-]+`: it converges on [0-9.]+ % of \d+ problems",
    ),
    "How far is the force of the tyre known?": ("force-known", r"in the limit of its grids, known to [\d.]+ %"),
    'Does "solved" of OSQP mean solved?': (
        "false-solved",
        r'OSQP alone .* "solved" on \d+ small contact problems.* \d+ fail the judge',
    ),
    "On which scenes does trial-and-error not converge?": ("trial-and-error-ends", TRIAL),
    "Is the paper's table reproduced?": ("printed-table", r"is not reproduced at the stated travel"),
    "What does 1 % cost?": ("one-per-cent", r"An error of 1 % takes [\d.]+ times the seconds of 5 %"),
    "What is the exact problem of a scene, and where is a picture of it?": (
        "scenes",
        r"(?:has|have) a sheet: geometry, material",
    ),
    "How sure is advice?": ("advice", r"meets the tolerance in \d+ % of \d+ cases"),
}
ELSEWHERE = {  # rest on tables, or rows of them, that no page test makes up
    *("another-solver", "another-algorithm", "units")
}
BODY = re.compile(r"\]\(([\w-]+\.md)")


@pytest.fixture(scope="module")
def said(loaded: Store) -> dict[str, Said]:
    return {each.name: each for each in statements(loaded)}


def one_click(files: dict[str, str]) -> list[str]:
    """Page one, and every page that a link on it leads to."""
    return ["index.md", *dict.fromkeys(BODY.findall(files["index.md"]))]


def test_a_reader_finds_every_answer_with_one_click(files: dict[str, str], said: dict[str, Said]) -> None:
    for question, (name, answer) in TEN.items():
        text = said[name].text
        assert re.search(answer, text), question
        assert any(text in files[page] for page in one_click(files)), f"{question}: on no page one click away"


def test_nothing_is_said_twice(said: dict[str, Said]) -> None:
    texts = [each.text for each in said.values()]
    assert not {text for text in texts if texts.count(text) > 1}


def test_page_one_says_what_the_paper_s_algorithm_lacks(said: dict[str, Said]) -> None:
    assert "the paper's algorithm with a detector of cycles added" in said["trial-and-error-ends"].text


def test_every_page_opens_with_its_answer(files: dict[str, str], said: dict[str, Said]) -> None:
    """Between its heading and the links to other pages; pages that list things have a text of their own."""
    lists = {"index.md", "claims.md", "gallery.md", "data.md", "programs.md"}
    for each in CHAPTERS:
        if each.file in files and each.file not in lists and not each.under:
            opening = files[each.file].split("\n\n[Results](", 1)[0]
            assert any(one.text in opening for one in said.values() if one.page == each.name), each.file


def test_a_number_of_page_one_is_the_same_on_the_page_it_links_to(files: dict[str, str], said: dict[str, Said]) -> None:
    """Whole sentences: each stands on its own page as it stands on page one, with the same numbers in it."""
    shown = [one for one in said.values() if one.text in files["index.md"] and f"{one.page}.md" in files]
    assert len(shown) > 10
    for one in shown:
        assert one.text in files[f"{one.page}.md"], one.name


def test_numbers_of_page_one_are_those_of_tables(files: dict[str, str], said: dict[str, Said]) -> None:
    """What page one says in numbers stands in a table of the page that it links to, too, as far as it is rounded."""
    one = said["origin-of-travel"]
    assert one.text in files["index.md"]
    tables = "\n".join(line for line in files[f"{one.page}.md"].splitlines() if line.startswith("|"))
    assert lost(one.text, tables) == []
    assert lost("off by 1.4 % of 20 mm", "| 20 | 1.41 |") == []
    assert lost("off by 1.4 % of 20 mm", "| 20 | 1.46 |") == ["1.4"]


def lost(sentence: str, page: str) -> list[str]:
    """Numbers of a sentence that no number of a page rounds to."""
    there = [float(number) for number in NUMBER.findall(page)]
    return [text for text in NUMBER.findall(sentence) if not any(rounds_to(number, text) for number in there)]


def rounds_to(number: float, text: str) -> bool:
    if "e" in text:
        return f"{number:.0e}" == f"{float(text):.0e}"
    decimals = len(text.partition(".")[2])
    return abs(abs(number) - abs(float(text))) <= 0.5 * 10.0**-decimals * (1 + 1e-9)


def test_asks_say_what_answers_them_or_what_is_missing(said: dict[str, Said]) -> None:
    asks = read_questions()
    for ask in asks:
        assert ask.get("answers") or ask.get("missing"), ask["question"]
        assert all(re.fullmatch(r"[\w.-]+/[\w.-]+#\d+", each) or "#" not in each for each in ask["threads"].split(", "))
        assert "answers" not in ask or ask["command"]
    assert sum("answers" in ask for ask in asks) >= 12
    known = {name for each in asks for name in each.get("answers", [])}
    assert known - set(said) <= ELSEWHERE


def test_every_column_of_page_one_is_in_the_glossary_or_plain(files: dict[str, str]) -> None:
    """Heads of the tables on page one: their nouns are explained, or everyday words."""
    glossary = files["data.md"].partition("**Words**")[2].partition("## Data")[0]
    words = [line.split("|")[1] for line in glossary.splitlines() if line.startswith("| ")]
    explained = " ".join([*words, PLAIN, *MEASURES, *ALGORITHMS]).lower()
    for line in files["index.md"].splitlines():
        if line.startswith("| ") and ":--" not in line and line in heads_of(files["index.md"]):
            for word in re.findall(r"[a-z]{3,}", line.lower()):
                assert word in explained or word.rstrip("s") in explained, word


PLAIN = """use not when changed change read from force measure algorithm solved share over the default most within why
solve shells shallow tyre large rotations ring contact where numbers made unknowns nothing semismooth and cells commit
machine what seconds error mesh element problem regime"""


def heads_of(text: str) -> set[str]:
    lines = text.splitlines()
    return {line for line, below in pairwise(lines) if below.startswith("| :--")}

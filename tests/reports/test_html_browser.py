"""The HTML of all pages in a real browser without a network: no error, no request, and what a reader does by hand.

Pages change, tables sort and filter, words are found, colours change, everything prints; all by keyboard, and whatever
can be used has a name for who cannot see it.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from reports.contents import CHAPTERS
from reports.html import REPORT
from support.browser import CHROMIUM, PATIENCE, Browser

NAMES = ["index", *(each.name for each in CHAPTERS if each.always)]
pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")]


@pytest.fixture(scope="module")
def browser(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """The report of a made-up store, or the one that FOOTPRINT_REPORT names, opened."""
    root = tmp_path_factory.mktemp("browser")
    page = Path(os.environ.get("FOOTPRINT_REPORT") or root / REPORT).absolute()
    if "FOOTPRINT_REPORT" not in os.environ:
        page.write_text(request.getfixturevalue("drawn")[REPORT], encoding="utf-8")
    opened = Browser(root / "profile")
    try:
        opened.call("Page.navigate", url=page.as_uri())
        opened.wait_for("Page.loadEventFired")
        yield opened
    finally:
        opened.close()


def shown(browser: Browser) -> list[str]:
    return browser.run("[...document.querySelectorAll('section')].filter(s => s.offsetHeight > 0).map(s => s.id)")


def follow(browser: Browser, script: str) -> None:
    """Click, then wait until the address has been acted on."""
    browser.run(f"new Promise(done => {{ addEventListener('hashchange', () => setTimeout(done, 50)); {script} }})")


def test_pages_change_by_their_links(browser: Browser) -> None:
    assert shown(browser) == ["index"]
    for name in [*NAMES[1:], "index"]:
        follow(browser, f"document.querySelector('nav a[href=\"#{name}\"]').click()")
        assert shown(browser) == [name]
        assert browser.run("document.querySelector('nav [aria-current]').hash") == f"#{name}"
    follow(browser, "location.hash = 'convergence--which-element'")
    assert shown(browser) == ["convergence"]
    assert 0 <= browser.run("document.getElementById('convergence--which-element').getBoundingClientRect().top") < 300


NUMERIC = """[...document.querySelectorAll('table:has(tbody)')].flatMap((table, at) =>
  [...table.tHead.rows[0].cells].map((head, column) => {
    const texts = [...table.tBodies[0].rows].map(row => row.cells[column].textContent);
    const right = head.className === 'n' && texts.every(text => /^[-+]?[0-9.]+$/.test(text));
    return { at, column, many: right ? new Set(texts).size : 0 };
  })).find(each => each.many > 4)"""
ROWS = "document.querySelectorAll('table:has(tbody)')[{0}].tBodies[0].rows"
COLUMN = f"[...{ROWS}].map(row => row.cells[{{1}}].textContent)"
HEADS = "document.querySelectorAll('table:has(tbody)')[{0}].tHead.rows[0].cells"


def click(browser: Browser, table: int, column: int) -> list[str]:
    browser.run(f"{HEADS.format(table)}[{column}].firstChild.click()")
    return browser.run(COLUMN.format(table, column))


def test_tables_sort_on_a_click(browser: Browser) -> None:
    """Numbers by their size, words by their letters; a second click the other way round."""
    solution = browser.run(NUMERIC)
    table, column = solution["at"], solution["column"]
    rising, falling = click(browser, table, column), click(browser, table, column)
    assert [float(x) for x in rising] == sorted(map(float, rising))
    assert [float(x) for x in falling] == sorted(map(float, rising), reverse=True)
    assert rising != falling
    words = click(browser, table, 0)
    assert words == sorted(words)
    heads = browser.run(f"[...{HEADS.format(table)}].map(head => head.ariaSort)")
    assert [h for h in heads if h] == ["ascending"]


def test_every_table_sorts_by_every_column(browser: Browser) -> None:
    assert browser.run("document.querySelectorAll('th button').length") > 100
    browser.run("document.querySelectorAll('th button').forEach(button => button.click())")
    assert browser.run("document.querySelectorAll('table:has(tbody)').length") == browser.run(
        "document.querySelectorAll('th[aria-sort]').length"
    )


def test_nothing_is_wider_than_the_window(browser: Browser) -> None:
    """At 1000 px a wide table scrolls by itself and a picture shrinks; the page does not scroll sideways."""
    for name in NAMES:
        browser.run(f"location.hash = '{name}'")
        time.sleep(0.05)
        assert browser.run("document.documentElement.scrollWidth") <= 1000
    assert browser.run("Math.max(...[...document.querySelectorAll('svg')].map(s => s.clientWidth))") <= 1000
    assert browser.run("document.querySelectorAll('figure > svg').length") > 20


TABLE = """(() => {
  const bar = document.querySelector('.tools'), field = bar.querySelector('input');
  let wide = bar;
  while (!wide.classList.contains('wide')) wide = wide.nextElementSibling;
  const rows = [...wide.querySelector('tbody').rows];
  if (WORDS !== null) {
    field.value = WORDS;
    field.dispatchEvent(new Event('input'));
  }
  const left = rows.filter(row => !row.hidden).map(row => row.textContent);
  return { left, all: rows.length, first: rows[1].cells[0].textContent, told: bar.querySelector('span').textContent };
})()"""


def test_a_table_keeps_the_rows_that_have_the_words(browser: Browser) -> None:
    """The count beside the field says how many."""
    words = browser.run(TABLE.replace("WORDS", "null"))["first"]
    solution = browser.run(TABLE.replace("WORDS", json.dumps(words.upper())))
    assert all(words in row for row in solution["left"])
    assert 1 <= len(solution["left"]) <= solution["all"]
    assert solution["told"] == f"{len(solution['left'])} of {solution['all']} rows"
    nothing = browser.run(TABLE.replace("WORDS", "'no such words'"))
    assert nothing["told"] == f"0 of {solution['all']} rows"
    assert len(browser.run(TABLE.replace("WORDS", "''"))["left"]) == solution["all"]


def press(browser: Browser, key: str, text: str = "") -> None:
    code = {"Enter": 13, "Escape": 27, "ArrowDown": 40}.get(key, 0)
    for kind in ("keyDown", "keyUp"):
        stated = {"text": text} if text and kind == "keyDown" else {}
        browser.call("Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code, **stated)


def go(browser: Browser, name: str) -> None:
    """To a page, whichever is shown; until it has been acted on."""
    browser.run(f"document.activeElement.blur(); location.hash = '{name}'")
    until(browser, f"document.getElementById('{name}').classList.contains('shown')")


def until(browser: Browser, condition: str) -> None:
    end = time.monotonic() + PATIENCE
    while not browser.run(condition):
        assert time.monotonic() < end, condition
        time.sleep(0.05)


def focus(browser: Browser, what: str) -> object:
    return browser.run(f"document.activeElement.{what}")


def test_words_are_found_by_keyboard(browser: Browser) -> None:
    """A slash, the words, an arrow and the return key lead to the place; escape closes."""
    go(browser, "tyre")
    press(browser, "/", "/")
    assert focus(browser, "ariaLabel") == "Search all pages"
    browser.call("Input.insertText", text="donnell omit")
    until(browser, "!document.querySelector('.found').hidden")
    places = browser.run("[...document.querySelectorAll('.found a')].map(a => a.textContent.toLowerCase())")
    assert places
    assert all("donnell" in place for place in places)
    assert browser.run("document.querySelector('.found [role=status]').textContent").endswith("places")
    press(browser, "ArrowDown")
    assert focus(browser, "closest('.found').id") == "found"
    press(browser, "Enter", "\r")
    until(browser, "document.getElementById('invariance').classList.contains('shown')")
    assert focus(browser, "getBoundingClientRect().top") < browser.run("innerHeight")
    assert focus(browser, "getBoundingClientRect().bottom") > 0
    closed = "document.querySelector('.found').hidden"
    assert browser.run(closed)
    press(browser, "/", "/")
    browser.run("document.activeElement.dispatchEvent(new Event('input'))")
    until(browser, f"!{closed}")
    press(browser, "Escape")
    assert browser.run(closed)


def is_light(browser: Browser) -> bool:
    stated = browser.run("getComputedStyle(document.body).backgroundColor").removeprefix("rgb(").removesuffix(")")
    levels = [int(each) for each in stated.split(",")]
    assert min(levels) > 200 or max(levels) < 60
    return min(levels) > 200


def system(browser: Browser, scheme: str, media: str = "") -> None:
    feature = {"name": "prefers-color-scheme", "value": scheme}
    browser.call("Emulation.setEmulatedMedia", media=media, features=[feature])


def test_colours_follow_the_system_and_the_switch(browser: Browser) -> None:
    """The ink of pictures, too."""
    system(browser, "light")
    assert is_light(browser)
    ink = "getComputedStyle(document.querySelector('svg.plot')).fill"
    light = browser.run(ink)
    system(browser, "dark")
    assert not is_light(browser)
    for words in ("dark", "light", "auto"):
        browser.run("document.querySelector('.controls button').click()")
        assert f"Colours: {words}." in browser.run("document.querySelector('.controls button').ariaLabel")
        assert is_light(browser) == (words == "light")
        assert (browser.run(ink) == light) == (words == "light")
    system(browser, "light")


CAPTION = 60  # px, at the most; above the head
FROZEN = """[...document.querySelectorAll('.shown .freeze')].filter(wide => wide.offsetWidth).map(wide => {
  wide.scrollTo(90, 300);
  const head = wide.querySelector('th').getBoundingClientRect(), box = wide.getBoundingClientRect();
  const [left, top] = [head.left - box.left, head.top - box.top];
  return { left, top, down: wide.scrollTop, hint: wide.previousElementSibling.className, focus: wide.tabIndex };
})"""


def test_heads_of_tables_and_first_columns_stay(browser: Browser) -> None:
    """A wide table scrolls under its head and beside its first column, says so, and is reached by keyboard."""
    browser.call("Emulation.setDeviceMetricsOverride", width=600, height=500, deviceScaleFactor=1, mobile=False)
    values = []
    for name in NAMES:
        go(browser, name)
        values += browser.run(FROZEN)
    browser.call("Emulation.clearDeviceMetricsOverride")
    assert len(values) > 3
    for each in values:
        assert abs(each["left"]) <= 2
        assert abs(each["top"]) <= 2 or each["down"] < CAPTION
        assert (each["hint"], each["focus"]) == ("hint", 0)
    assert any(each["down"] > CAPTION for each in values)


def test_contents_lead_to_the_headings_of_the_page(browser: Browser) -> None:
    go(browser, "invariance")
    links = "[...document.querySelectorAll('.shown .contents a')]"
    listed = browser.run(f"{links}.map(a => [decodeURIComponent(a.hash.slice(1)), a.textContent])")
    heads = browser.run("[...document.querySelectorAll('.shown h2, .shown h3')].map(h => [h.id, h.textContent])")
    assert listed == heads
    follow(browser, f"{links}[2].click()")
    assert focus(browser, "id") == heads[2][0]


ON_SCREEN_ONLY = "header, .contents, .tools, .hint, footer button"


def test_everything_prints(browser: Browser) -> None:
    """All pages, or the one that is shown; in light colours, without what only a screen has."""
    system(browser, "dark", "print")
    assert len(shown(browser)) == browser.run("document.querySelectorAll('section').length")
    assert is_light(browser)
    heights = browser.run(f"[...document.querySelectorAll('{ON_SCREEN_ONLY}')].map(e => e.offsetHeight)")
    assert set(heights) == {0}
    browser.run("document.body.classList.add('alone')")
    assert len(shown(browser)) == 1
    browser.run("document.body.classList.remove('alone')")
    system(browser, "light")


NAMED = {"button", "link", "searchbox", "combobox", "img", "image", "region", "navigation", "heading", "columnheader"}


def test_whatever_can_be_used_or_seen_has_a_name(browser: Browser) -> None:
    """As a screen reader has it, on pages of every kind."""
    roles = set()
    for name in ("index", "tyre", "invariance", "data"):
        go(browser, name)
        browser.call("Accessibility.enable")
        nodes = browser.call("Accessibility.getFullAXTree")["nodes"]
        browser.call("Accessibility.disable")
        messages = [
            (each["role"]["value"], each.get("name", {}).get("value", "")) for each in nodes if not each["ignored"]
        ]
        assert [role for role, words in messages if role in NAMED and not words.strip()] == [], name
        roles |= {role for role, _ in messages}
    assert {"button", "link", "combobox", "navigation", "heading", "columnheader"} <= roles
    assert {"img", "image"} & roles
    assert {"banner", "main", "contentinfo"} <= roles


def test_the_navigation_can_be_skipped(browser: Browser) -> None:
    go(browser, "tyre")
    browser.run("document.querySelector('.skip').focus()")
    assert focus(browser, "getBoundingClientRect().left") >= 0
    press(browser, "Enter", "\r")
    until(browser, "document.activeElement.id === 'main'")
    assert shown(browser) == ["tyre"]


def test_no_error_and_no_request_but_for_the_file(browser: Browser, tmp_path: Path) -> None:
    """The last one: whatever the others have caused is in its list of events."""
    browser.run("location.hash = 'index'")
    browser.screenshot(Path(os.environ.get("FOOTPRINT_SHOTS") or tmp_path) / "index.png")
    asked = [event["request"]["url"] for event in browser.of("Network.requestWillBeSent")]
    assert [url for url in asked if not url.startswith(("file://", "data:"))] == []
    assert len(asked) >= 1
    assert browser.of("Runtime.exceptionThrown") == []
    assert browser.of("Runtime.consoleAPICalled") == []
    assert [entry for entry in browser.of("Log.entryAdded") if entry["entry"]["level"] in ("error", "warning")] == []

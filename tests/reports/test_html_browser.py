"""The HTML of all pages in a real browser without a network: no error, no request, tables sort, pages change."""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from reports.contents import CHAPTERS
from reports.html import REPORT

CHROMIUM = next(
    (path for name in ("chromium", "chromium-browser", "google-chrome") if (path := shutil.which(name))), None
)
NAMES = ["index", *(each.name for each in CHAPTERS if each.always)]
pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")]
PATIENCE = 60.0  # s, for any answer
FLAGS = (
    *("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run", "--disable-sync"),
    *("--disable-dev-shm-usage", "--disable-background-networking", "--disable-component-update"),
    *("--host-resolver-rules=MAP * ~NOTFOUND", "--proxy-server=127.0.0.1:9", "--remote-debugging-pipe"),
)


class Browser:
    """Chromium by its debugging protocol through two pipes: JSON with a zero byte after each message."""

    def __init__(self, profile: Path) -> None:
        (theirs, self.to), (self.from_, ours) = os.pipe(), os.pipe()

        def arrange() -> None:
            high = [os.dup(fd) for fd in (theirs, ours)]  # neither may be lost when the other takes its number
            os.dup2(high[0], 3)
            os.dup2(high[1], 4)

        command = [str(CHROMIUM), *FLAGS, f"--user-data-dir={profile}", "--window-size=1000,800", "about:blank"]
        quiet = subprocess.DEVNULL
        self.process = subprocess.Popen(command, preexec_fn=arrange, close_fds=False, stdout=quiet, stderr=quiet)
        os.close(theirs)
        os.close(ours)
        self.count, self.rest, self.events = 0, b"", []
        target = next(t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page")
        attached = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)
        self.session: str | None = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        offline = {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0}
        self.call("Network.emulateNetworkConditions", **offline)

    session: str | None = None

    def call(self, method: str, **params: Any) -> dict[str, Any]:
        self.count += 1
        message = {"id": self.count, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("id") == self.count:
                assert "error" not in answer, answer
                return answer["result"]
            self.events.append(answer)

    def read(self) -> dict[str, Any]:
        while b"\0" not in self.rest:
            ready, _, _ = select.select([self.from_], [], [], PATIENCE)
            assert ready, "the browser does not answer"
            self.rest += os.read(self.from_, 1 << 20)
        message, _, self.rest = self.rest.partition(b"\0")
        return json.loads(message)

    def wait_for(self, method: str) -> None:
        while not any(event.get("method") == method for event in self.events):
            self.events.append(self.read())

    def run(self, script: str) -> Any:
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def of(self, method: str) -> list[dict[str, Any]]:
        return [event["params"] for event in self.events if event.get("method") == method]

    def screenshot(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(base64.b64decode(self.call("Page.captureScreenshot")["data"]))

    def close(self) -> None:
        self.process.terminate()
        self.process.wait(10)
        os.close(self.to)
        os.close(self.from_)


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


COLUMN = "[...document.querySelectorAll('#rigid-body table')[0].tBodies[0].rows].map(r => r.cells[{0}].textContent)"


def click(browser: Browser, column: int) -> list[str]:
    browser.run(f"document.querySelectorAll('#rigid-body table')[0].tHead.rows[0].cells[{column}].firstChild.click()")
    return browser.run(COLUMN.format(column))


def test_tables_sort_on_a_click(browser: Browser) -> None:
    before = browser.run(COLUMN.format(1))
    rising, falling = click(browser, 1), click(browser, 1)
    assert [float(x) for x in rising] == sorted(map(float, before))
    assert [float(x) for x in falling] == sorted(map(float, before), reverse=True)
    assert rising != before
    words = click(browser, 0)
    assert words == sorted(words)
    heads = browser.run(
        "[...document.querySelectorAll('#rigid-body table')[0].tHead.rows[0].cells].map(h => h.ariaSort)"
    )
    assert [h for h in heads if h] == ["ascending"]


def test_every_table_sorts_by_every_column(browser: Browser) -> None:
    assert browser.run("document.querySelectorAll('th button').length") > 100
    browser.run("document.querySelectorAll('th button').forEach(button => button.click())")
    assert browser.run("document.querySelectorAll('table').length") == browser.run(
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

"""A browser that reaches no network, and every wait in it bounded."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.browser import pages

sync_api = pytest.importorskip("playwright.sync_api")
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
FLAGS = ("--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader")  # fmt: skip
STOPPED_MS = 600e3  # a page that has not answered by then never will, however busy the machine is
SHOWS_IT = """frame =>
  ['picture', 'scene', 'orbit'].map(name => document.getElementById(`explorer-${name}`))
    .filter(home => !home.hidden)
    .every(home => home.querySelector('canvas').dataset.frame === frame)
  && document.querySelectorAll('.now').length > 0
  && [...document.querySelectorAll('.now')].every(line => line.dataset.frame === frame)"""


@pytest.fixture(scope="session")
def browser() -> Iterator:
    """Return the system's Chromium; skip where there is none."""
    if CHROMIUM is None:
        pytest.skip("no chromium: apt-get install chromium, then run this again")
    with sync_api.sync_playwright() as playwright:
        started = playwright.chromium.launch(
            executable_path=CHROMIUM, args=list(FLAGS), timeout=STOPPED_MS
        )
        yield started
        started.close()


@pytest.fixture(scope="session")
def made(tmp_path_factory) -> pages.Pages:
    """Return pages by name, each made when it is first asked for."""
    return pages.Pages(tmp_path_factory.mktemp("pages"))


class Opened:
    """A page in a browser, and what it asked for and said."""

    def __init__(self, browser, path: Path, **options) -> None:
        self.path = path
        self.context = browser.new_context(offline=True, **options)
        self.context.set_default_timeout(STOPPED_MS)
        self.page = self.context.new_page()
        self.said: list[str] = []
        self.asked: list[str] = []
        self.page.on("console", lambda each: self.said.append(f"{each.type}: {each.text}"))
        self.page.on("pageerror", lambda each: self.said.append(str(each)))
        self.page.on("request", lambda each: self.asked.append(each.url))
        self.page.goto(path.as_uri())
        self.explored = self.page.locator("#explorer-section").count() > 0
        if self.explored and options.get("java_script_enabled", True):
            self.page.wait_for_selector("#explorer-section[data-ready]")
            self.wait_for(SHOWS_IT, self.frame(0))

    def frame(self, place: int) -> str:
        """Return the number of a frame, as text."""
        return self.page.evaluate(
            "place => String(JSON.parse(document.getElementById('explorer-data').textContent)"
            ".frames[place].frame)",
            place,
        )

    def wait_for(self, holds: str, given: object = None) -> None:
        """Wait until a function in the page holds: `wait_for_function` would need `eval`."""
        left_ms = STOPPED_MS
        while not self.page.evaluate(holds, given):
            assert left_ms > 0, f"the page never came to {holds} of {given}; it said {self.said}"
            self.page.wait_for_timeout(50)
            left_ms -= 50

    def wait_for_place(self, place: int) -> None:
        """Wait until picture, scene and plots all show the frame at a place of the slider."""
        self.wait_for(SHOWS_IT, self.frame(place))

    def value(self, name: str, key: str) -> str:
        """Return what a canvas tells of itself."""
        return self.page.locator(f"#explorer-{name} canvas").get_attribute(f"data-{key}")

    def pixels(self, name: str) -> str:
        """Return a canvas as text, once it is drawn, a scene once it is drawn fine."""
        if name != "picture":
            self.page.wait_for_timeout(50)
            fine = "name => document.querySelector(`#explorer-${name} canvas`).dataset.fine"
            self.wait_for(f"name => ({fine})(name) === 'yes'", name)
        return self.page.evaluate(
            "name => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => "
            "done(document.querySelector(`#explorer-${name} canvas`).toDataURL()))))",
            name,
        )

    def faults(self) -> list[str]:
        """Return what the page complained of and what it asked for beside itself."""
        foreign = [url for url in self.asked if not url.startswith("data:")]
        stray = [url for url in foreign if url.partition("#")[0] != self.path.as_uri()]
        return [*self.said, *stray]


@pytest.fixture
def opened(browser, made) -> Iterator:
    """Return a function that opens a page by its name, with a context's options."""
    there = []

    def opens(name: str = "pair", **options) -> Opened:
        there.append(Opened(browser, made[name], **options))
        return there[-1]

    yield opens
    for each in there:
        each.context.close()

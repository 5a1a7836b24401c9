"""A browser that reaches no network, and a page of a small dataset."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from bench import api
from tests.support.patience import HANGS_S
from tests.support.synthetic_dataset import (
    lost_estimate,
    solved_estimate,
    write_dataset,
    write_variant,
)

sync_api = pytest.importorskip("playwright.sync_api")
HOSTILE = "<img src=x onerror=\"document.title='taken'\"></script><script>document.title='taken'"
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
FLAGS = ("--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader")  # fmt: skip


@pytest.fixture(scope="session")
def page_path(tmp_path_factory) -> Path:
    """Return a report of six frames by two pipelines; best has no pose of frame 3."""
    dataset = write_dataset(tmp_path_factory.mktemp("page") / "data", frames=6, width_px=128)
    rng = np.random.default_rng(7)
    for label, sigma_px in (("best", 0.05), ("paper", 0.4)):

        def said(truth, label=label, sigma_px=sigma_px):
            if label == "best" and truth.frame == 3:
                return lost_estimate(truth, HOSTILE)
            return solved_estimate(dataset, truth, np.full(2, sigma_px), rng)

        write_variant(dataset, label, said)
    path = dataset.folder / "dataset.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "case": HOSTILE}))
    api.score(dataset.folder)
    return api.report(dataset.folder)


@pytest.fixture(scope="session")
def browser() -> Iterator:
    """Return the system's Chromium; skip where there is none."""
    if CHROMIUM is None:
        pytest.skip("no chromium: apt-get install chromium, then run this again")
    with sync_api.sync_playwright() as playwright:
        started = playwright.chromium.launch(
            executable_path=CHROMIUM, args=list(FLAGS), timeout=1e3 * HANGS_S
        )
        yield started
        started.close()


class Opened:
    """A page in a browser, and what it asked for and said."""

    def __init__(self, browser, path: Path, **options) -> None:
        self.context = browser.new_context(offline=True, **options)
        self.context.set_default_timeout(1e3 * HANGS_S)
        self.page = self.context.new_page()
        self.said: list[str] = []
        self.asked: list[str] = []
        self.page.on("console", lambda each: self.said.append(f"{each.type}: {each.text}"))
        self.page.on("pageerror", lambda each: self.said.append(str(each)))
        self.page.on("request", lambda each: self.asked.append(each.url))
        self.page.goto(path.as_uri())
        self.page.wait_for_selector("#explorer-section[data-ready]")
        self.wait_for_frame("0")

    def wait_for_frame(self, frame: str) -> None:
        """Wait until picture, scene and plots all show a frame."""
        shows_it = """frame => ['picture', 'scene'].every(name =>
             document.querySelector(`#explorer-${name} canvas`).dataset.frame === frame)
           && document.querySelectorAll('.now').length > 0
           && [...document.querySelectorAll('.now')].every(x =>
             Number(x.dataset.time) === 10 * Number(frame))"""
        while not self.page.evaluate(shows_it, frame):  # wait_for_function would need `eval`
            self.page.wait_for_timeout(50)

    def value(self, name: str, key: str) -> str:
        """Return what a canvas tells of itself."""
        return self.page.locator(f"#explorer-{name} canvas").get_attribute(f"data-{key}")

    def pixels(self, name: str) -> str:
        """Return a canvas as text."""
        return self.page.evaluate(f"document.querySelector('#explorer-{name} canvas').toDataURL()")


@pytest.fixture
def opened(browser, page_path) -> Iterator:
    """Return a function that opens the page with a context's options."""
    pages = []

    def opens(**options) -> Opened:
        pages.append(Opened(browser, page_path, **options))
        return pages[-1]

    yield opens
    for each in pages:
        each.context.close()

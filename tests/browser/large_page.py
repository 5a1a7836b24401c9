"""How fast a page of 1,000 frames and 100 runs is in a browser without a GPU.

``python -m tests.browser.large_page [PAGE]`` prints how long it takes to load, and how many steps
of the slider, turns of the scene and changes of the run a second show, and what each costs the
processors of all the browser's processes. Frames and run 0 are a
dataset that was estimated, scored and reported; the other 99 runs are drawn here, in the page's
own form. Numbers are of this machine at this moment, those of processors less so than those of
the clock: nothing is asserted.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from playwright.sync_api import sync_playwright

from bench.report.explorer import data
from models.plain_console import plain_console
from tests.browser import pages
from tests.browser.conftest import CHROMIUM
from tests.support.synthetic_dataset import solved_estimate, write_dataset, write_variant

FRAMES, RUNS, LABEL = 1000, 100, "best"
WIDTH_PX = 256
STEPS, LOADS, WARM_UP = 60, 3, 10
TIMEOUT_MS = 600e3
WITHOUT_GPU = ("--no-sandbox", "--disable-dev-shm-usage", "--enable-unsafe-swiftshader")
PAGE = {"width": 1400, "height": 900}
IN_SIGHT = """x => { const box = x.getBoundingClientRect();
  return box.bottom > 0 && box.top < innerHeight && box.width + box.height > 0; }"""
SLIDER = f"""async steps => {{
  const slider = document.getElementById('explorer-slider');
  const drawn = () => new Promise(done => requestAnimationFrame(done));
  const seen = [...document.querySelectorAll('.explorer-views canvas, .now')].filter({IN_SIGHT});
  const began = performance.now();
  for (let k = 0; k < steps; k++) {{
    const frame = String((k * 37) % {FRAMES});
    slider.value = frame;
    slider.dispatchEvent(new Event('input'));
    do {{ await drawn(); }} while (!seen.every(each => each.dataset.frame === frame));
  }}
  return 1000 * steps / (performance.now() - began);
}}"""
TURNS = """async steps => {
  const canvas = document.querySelector('#explorer-scene canvas');
  const drawn = () => new Promise(done => requestAnimationFrame(done));
  const began = performance.now();
  for (let k = 0; k < steps; k++) {
    canvas.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft' }));
    await drawn();
  }
  return 1000 * steps / (performance.now() - began);
}"""
RUN = """async steps => {
  const select = document.getElementById('explorer-run');
  const drawn = () => new Promise(done => requestAnimationFrame(done));
  const began = performance.now();
  for (let k = 0; k < steps; k++) {
    select.value = 1 + k;
    select.dispatchEvent(new Event('change'));
    await drawn();
  }
  return 1000 * steps / (performance.now() - began);
}"""
MEASURED = (
    ("slider, picture and scene in sight", SLIDER, ".explorer-views"),
    ("slider, plots in sight", SLIDER, "#explorer-plots"),
    ("scene turned", TURNS, ".explorer-views"),
    ("run chosen, plots in sight", RUN, "#explorer-plots"),
)
RESTED_MS = 1500


def made(home: Path) -> Path:
    """Return the page.

    Parameters
    ----------
    home : Path
        A folder that does not exist yet.
    """
    dataset, rng = write_dataset(home, FRAMES, width_px=WIDTH_PX), np.random.default_rng(1)
    write_variant(
        dataset, LABEL, lambda truth: solved_estimate(dataset, truth, np.full(2, 0.1), rng)
    )
    really = data.other_runs
    data.other_runs = lambda *_: {LABEL: [_run(each, rng) for each in range(1, RUNS)]}
    try:
        return pages.reported(home)
    finally:
        data.other_runs = really


def _run(number_of: int, rng: np.random.Generator) -> dict[str, Any]:
    sizes = [[float(f"{x:.5g}") for x in rng.gamma(2.0, scale, FRAMES)] for scale in (0.7, 0.02)]
    return {"run": number_of, "verdicts": [None] * FRAMES, "reasons": [None] * FRAMES, "poses": [],
            "sizes": sizes}  # fmt: skip


def main() -> None:
    """Make the page and measure it."""
    console = plain_console()
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        path = Path(sys.argv[1]) if len(sys.argv) > 1 else made(Path(folder) / "large")
        console.print(f"{FRAMES} frames, {RUNS} runs: {path.stat().st_size / 1e6:.1f} MB")
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(WITHOUT_GPU))
        processes = browser.new_browser_cdp_session()

        def spent_s() -> float:
            told = processes.send("SystemInfo.getProcessInfo")["processInfo"]
            return sum(each["cpuTime"] for each in told)

        loads, spent = [], []
        for place in range(LOADS):
            page = browser.new_page(viewport=PAGE)
            page.set_default_timeout(TIMEOUT_MS)
            began, before = perf_counter(), spent_s()
            page.goto(path.as_uri())
            page.wait_for_selector("#explorer-section[data-ready]")
            loads.append(perf_counter() - began)
            spent.append(spent_s() - before)
            if place < LOADS - 1:
                page.close()
        console.print(
            f"load until it can be used: {median(loads):.2f} s, {median(spent):.2f} s of processors"
        )
        for name, program, place in MEASURED:
            page.evaluate(f"document.querySelector('{place}').scrollIntoView()")
            page.evaluate(program, WARM_UP)
            page.wait_for_timeout(RESTED_MS)
            before = spent_s()
            rate = page.evaluate(program, STEPS)
            each_ms = 1e3 * (spent_s() - before) / STEPS
            console.print(f"{name}: {rate:.1f} a second, {each_ms:.0f} ms of processors each")
        console.print(f"on {os.cpu_count()} cores, load average {os.getloadavg()[0]:.1f}")
        browser.close()


if __name__ == "__main__":
    main()

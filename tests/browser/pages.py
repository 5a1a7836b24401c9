"""One small page of each kind, without a renderer, whose names are hostile where users name."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from rich.console import Console

from bench import api
from bench.suites.vinag2018.cases import LEO
from bench.suites.vinag2018.flight_dataset import write_flight
from bench.suites.volpe2017.plan import Plan, Sizes
from bench.suites.volpe2017.suite import run_plan
from bench.sweep.extremes import Extreme
from bench.sweep.page import MapOnPage, write_page
from bench.sweep.sun_map import sun_map
from bench.sweep.table import VERDICTS, setting_of
from models.camera import camera_preset
from models.dataset.estimates_file import write_estimates
from models.dataset.marker_file import markers_to_toml
from models.estimate import Detections, Estimate, NamedState, PoseEstimate
from models.lights.sun_grid import sun_grid
from tests.bench.sweep.test_table import SETTING, TRUTH, judged
from tests.support.synthetic_dataset import (
    lost_estimate,
    perfect_estimate,
    solved_estimate,
    write_dataset,
    write_variant,
)
from tests.support.synthetic_images import write_images
from tests.support.unknown_cube import write_cube

RUNS = "document.title='taken'"
HOSTILE = f'<img src=x onerror="{RUNS}"></script><script>{RUNS}'
HOSTILE_LABEL = f"<img src=x onerror={RUNS}>"  # a file is named by it
LOST = 3  # the frame of the pairs that best has no pose of


class Pages:
    """Pages by name: ``EXPLORED`` have an explorer, ``PLAIN`` have none."""

    def __init__(self, home: Path) -> None:
        self.home, self._found = home, {}

    def __getitem__(self, name: str) -> Path:
        if name not in self._found:
            self._found[name] = MAKERS[name](self.home / name)
        return self._found[name]


def pair(home: Path) -> Path:
    """Return six pairs by three pipelines, of two runs; best has no pose of one."""
    dataset = write_dataset(home, frames=6, width_px=128)
    rng = np.random.default_rng(7)
    for label, sigma_px in (("best", 0.05), ("paper", 0.4), (HOSTILE_LABEL, 1.0)):

        def said(truth, label=label, sigma_px=sigma_px):
            if label == "best" and truth.frame == LOST:
                return lost_estimate(truth, HOSTILE)
            return solved_estimate(dataset, truth, np.full(2, sigma_px), rng)

        for run in (0, 1):
            write_variant(dataset, label, said, run)
    names = (HOSTILE, *dataset.pattern.names[1:])
    (home / "markers.toml").write_text(markers_to_toml(replace(dataset.pattern, names=names)))
    return reported(home)


def tumble(home: Path) -> Path:
    """Return eight images of XMM, a pose with a small error each but for the last."""
    dataset = write_images(home, 8, 4.0, width_px=96)
    rng = np.random.default_rng(3)

    def said(truth) -> Estimate:
        if truth.frame == 7:
            return Estimate(truth.frame, truth.time_s, reason=HOSTILE)
        pose = truth.cam_from_target.perturbed(
            0.02 * rng.standard_normal(3), 0.1 * rng.standard_normal(3)
        )
        seen = np.flatnonzero(truth.landmarks_visible)
        found = Detections(
            truth.landmarks_px[seen], np.full((len(seen), 2), 0.5), tuple(map(int, seen)),
            (True,) * len(seen),
        )  # fmt: skip
        return Estimate(truth.frame, truth.time_s, PoseEstimate(pose), detections=found)

    write_estimates(home / "estimates" / "best.jsonl", map(said, dataset.truths))
    return reported(home)


def navigated(home: Path) -> Path:
    """Return six images of XMM by a chaser that knows its own orbit to some metres."""
    dataset = write_images(home, 6, 4.0, width_px=96)
    rng = np.random.default_rng(4)

    def said(truth) -> Estimate:
        place = truth.chaser.position_in_inertial + rng.normal(0.0, 5.0, 3)
        orbit = NamedState(
            {
                "position_in_inertial_m": place,
                "velocity_in_inertial_m_s": truth.chaser.velocity_in_inertial,
            },
            np.diag([25.0] * 3 + [1e-4] * 3),
        )
        states = {**truth.state.named(np.eye(6), np.eye(6)), "chaser_orbit": orbit}
        pose = truth.cam_from_target.perturbed(0.02 * rng.standard_normal(3), np.zeros(3))
        return Estimate(
            truth.frame, truth.time_s, PoseEstimate(pose), mode="tracked", states=states
        )

    write_estimates(home / "estimates" / "best.jsonl", map(said, dataset.truths))
    path = home / "dataset.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "chain": "navigated_images"}))
    return reported(home)


def unknown(home: Path) -> Path:
    """Return a textured cube's images, as our pipeline knows it in the end."""
    write_cube(home, 34)
    api.estimate(home)
    return reported(home)


def absolute(home: Path) -> Path:
    """Return two minutes of a low orbit."""
    write_flight(home, LEO, 120.0)
    api.estimate(home)
    return reported(home)


def sweep(home: Path) -> Path:
    """Return a sweep's page, its verdicts of every kind."""
    suns = sun_grid(45.0)
    estimates = [lost_estimate(TRUTH, HOSTILE) if n % 4 == 3 else perfect_estimate(TRUTH)
                 for n in range(len(suns))]  # fmt: skip
    rows = [
        replace(
            judged(said, "S2"), sun=HOSTILE if n == 0 else sun.name, pipeline=HOSTILE_LABEL,
            azimuth_deg=sun.azimuth_deg, elevation_deg=sun.elevation_deg, verdict=VERDICTS[n % 4],
        )
        for n, (sun, said) in enumerate(zip(suns, estimates, strict=True))
    ]  # fmt: skip
    grey = np.tile(np.arange(64, dtype=np.uint8) * 3, (64, 1))
    result = SimpleNamespace(
        plan=SimpleNamespace(
            scenario=SimpleNamespace(
                target=HOSTILE, simulated_camera=camera_preset("chaser_fixed").resized(512),
                render=SimpleNamespace(samples=4),
            ),
            pipelines=[SimpleNamespace(label=HOSTILE_LABEL)],
        ),
        rows=rows, settings=[setting_of(rows[0])], map_pipeline=HOSTILE_LABEL,
        provenance={"scenario": HOSTILE},
    )  # fmt: skip
    home.mkdir()
    drawn = sun_map(HOSTILE, SETTING, rows, [grey] * len(rows))
    (home / "sun_map.png").write_bytes(drawn.png)
    on_page = MapOnPage(setting_of(rows[0]), home / "sun_map.png", drawn, rows, [grey] * len(rows))
    shown = [Extreme("best_1", rows[0], grey), Extreme("harshest_1", rows[3], grey)]
    return write_page(home / "sweep.html", result, HOSTILE, [on_page], shown)


def suite(home: Path) -> Path:
    """Return the page of a small suite."""
    sizes = Sizes(runs=1, paper_runs=1, seeds=1, duration_s=60.0, study_s=6.0, speed_s=6.0)
    plan = Plan(sizes, ("tracks",))
    return run_plan(plan, home, 1, Console(file=io.StringIO())).page


def leaderboard(home: Path) -> Path:
    """Return three methods side by side."""
    dataset = write_dataset(home / HOSTILE_LABEL, 4, images=False, width_px=64)
    rng = np.random.default_rng(5)
    for label, sigma_px in (("best", 0.05), ("paper", 0.4), (HOSTILE_LABEL, 1.0)):
        write_variant(
            dataset, label,
            lambda truth, s=sigma_px: solved_estimate(dataset, truth, np.full(2, s), rng),
        )  # fmt: skip
    _, files = api.compare([dataset.folder], out=home / "compared")
    return next(path for path in files.values() if path.suffix == ".html")


def reported(home: Path) -> Path:
    """Score and report a dataset with estimates, its case by a hostile name."""
    path = home / "dataset.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "case": HOSTILE}))
    for stamp in home.glob("seeds/*/run.json"):
        stamp.unlink()
    api.score(home)
    return api.report(home)


EXPLORED: dict[str, Callable[[Path], Path]] = {
    "pair": pair, "tumble": tumble, "navigated": navigated, "unknown": unknown,
    "absolute": absolute,
}  # fmt: skip
PLAIN: dict[str, Callable[[Path], Path]] = {
    "sweep": sweep, "suite": suite, "leaderboard": leaderboard,
}  # fmt: skip
MAKERS = {**EXPLORED, **PLAIN}

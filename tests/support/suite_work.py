"""Work that suites of the tests do: importable by name, so that any process finds it."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from bench.suites.request import SuiteRequest
from bench.suites.units import Outcome, WorkUnit


@dataclass(frozen=True)
class DrawTask:
    """Some numbers to draw."""

    seed: int
    count: int = 100
    wait_s: float = 0.0


def drawn(task: DrawTask) -> Outcome:
    """Draw them, and take a while."""
    began = time.perf_counter()
    time.sleep(task.wait_s)
    draw = np.random.default_rng([task.seed]).standard_normal(task.count)
    return Outcome({"draw": draw}, np.array([time.perf_counter() - began]))


def draw_units(count: int, wait_s: float = 0.0) -> list[WorkUnit]:
    """Return so many units of two kinds."""
    return [
        WorkUnit(
            f"{'even' if seed % 2 == 0 else 'odd'}/unit_{seed:03d}",
            drawn,
            DrawTask(seed, wait_s=wait_s),
            "even" if seed % 2 == 0 else "odd",
            1.0,
        )
        for seed in range(count)
    ]


def units_of(request: SuiteRequest) -> list[WorkUnit]:
    """Return the units of a suite that draws, as suites' modules do."""
    return draw_units(request.runs or 0)

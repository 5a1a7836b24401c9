"""``make speed``: what light costs, ours against Blender Cycles' and against bare Mitsuba's.

One scene, size and number of samples for all; denoising, clamping and adaptive sampling off. Each
measurement is a process of its own, start-up and writing counted. A and B alternate, so that what
else the machine does falls on both. Times are told as they are and at equal noise: Cycles is given
(or taken) the samples that bring its error against its own converged reference to ours.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

from bench.cycles.course import (
    JUDGED_SUNS,
    ONE_SUN,
    Course,
    noise,
    noise_ratios,
    references,
)
from bench.cycles.jobs import BARE, CYCLES, OURS, Effort
from bench.cycles.noise import Cost, cost_of
from bench.cycles.sequence import SCENE, SUNS, render_references, sequence, sequence_scene
from bench.cycles.speed_row import Row
from bench.cycles.speed_tables import print_rows
from models.errors import RvbenchError
from models.plain_console import plain_console


def one_frame(course: Course, repeats: int) -> tuple[Row, Row]:
    """Time one frame: ours against Cycles', and ours against bare Mitsuba's."""
    one: list[tuple[str, ...]] = [(ONE_SUN,)]
    efforts: dict[str, list[Effort]] = {OURS: [], BARE: [], CYCLES: []}
    for _ in range(repeats):
        for side in (OURS, BARE, CYCLES):
            efforts[side].append(course.run(side, "one", one))
    costs = {side: [cost_of(effort) for effort in efforts[side]] for side in efforts}
    errors = {}
    for side in efforts:
        path = course.image(side, one[0], 0, course.samples)
        errors[side] = noise(course, side, path, one[0])
    against_cycles = noise_ratios(errors[OURS], errors[CYCLES])
    against_bare = noise_ratios(errors[BARE], errors[OURS])
    return (
        Row("one frame", 8.0, costs[OURS], costs[CYCLES], *against_cycles),
        Row("bare mi.render", 1.15, costs[BARE], costs[OURS], *against_bare, bare=True),
    )


def sweep(course: Course, repeats: int, rendered: int) -> tuple[Row, Row]:
    """Time 36 Suns: ours in one pass against Cycles' renders, and against its light groups.

    Cycles renders the Suns one after another in one process that keeps the scene. With fewer than
    36 ``rendered`` its light is scaled up.

    Parameters
    ----------
    course : Course
    repeats : int
    rendered : int
        How many of the Suns Cycles renders one by one; the judged ones are always among them.
    """
    every = course.suns
    chosen = sorted({*JUDGED_SUNS, *every[:: max(1, len(every) // rendered)]}, key=every.index)
    singles: list[tuple[str, ...]] = [(name,) for name in chosen]
    ours, theirs, groups = [], [], []
    for _ in range(repeats):
        ours.append(cost_of(course.run(OURS, "sweep", [every])))
        part = cost_of(course.run(CYCLES, "sweep", singles))
        theirs.append(part.times(len(every) / len(chosen)))
        groups.append(cost_of(course.run(CYCLES, "sweep", [every])))
    our_noise = noise(course, OURS, course.image(OURS, every, 0, course.samples), every)
    group_noise = noise(course, CYCLES, course.image(CYCLES, every, 0, course.samples), every)
    single_noise = [
        noise(course, CYCLES, course.image(CYCLES, (s,), chosen.index(s), course.samples), (s,))[0]
        for s in JUDGED_SUNS
    ]
    return (
        Row("36 Suns, one by one", 40.0, ours, theirs, *noise_ratios(our_noise, single_noise)),
        Row(
            "36 Suns, light groups",
            15.0,
            ours,
            groups,
            *noise_ratios(our_noise, group_noise),
        ),
    )


def machine() -> dict[str, str | int]:
    """Return what ran all this."""
    model = platform.processor()
    if Path("/proc/cpuinfo").exists():
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next((line.split(":")[1].strip() for line in lines if "model name" in line), model)
    return {"processor": model, "cores": os.cpu_count() or 0, "load": f"{os.getloadavg()[0]:.1f}"}


def as_table(cost: Cost) -> dict[str, float]:
    """Return a cost with its sums."""
    return asdict(cost) | {"whole_s": cost.whole_s, "processor_s": cost.processor_s}


def report(rows: list[Row], first: dict[str, Cost], settings: dict[str, int]) -> str:
    """Return everything that was measured as JSON.

    Parameters
    ----------
    rows : list of Row
    first : dict of str to Cost
        What the first run of a scene took, kernels compiled, by what it was.
    settings : dict of str to int
        What was asked for.
    """
    ratios = (
        "decisive",
        "at_equal_noise",
        "at_equal_samples",
        "of_light_alone",
        "of_processor",
        "of_processor_at_equal_noise",
    )
    table = {
        "machine": machine(),
        "settings": settings,
        "first_time": {what: as_table(cost) for what, cost in first.items()},
        "rows": [
            asdict(row)
            | {side: [as_table(cost) for cost in getattr(row, side)] for side in ("ours", "theirs")}
            | {name: getattr(row, name) for name in ratios}
            | {"reached": row.reached}
            for row in rows
        ],
    }
    return json.dumps(table, indent=1)


def main() -> int:
    """Run the race; exit code 0 if every target is reached, 1 if not, 2 if it could not run."""
    parser = argparse.ArgumentParser(prog="make speed", description=__doc__)
    parser.add_argument("--size-px", type=int, default=1024)
    parser.add_argument("--samples", type=int, default=16, help="per pixel, a square")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--cycles-suns", type=int, default=36, help="of the 36, by Cycles")
    parser.add_argument("--sequence-repeats", type=int, default=1, help="of the approach's rows")
    parser.add_argument("--out", type=Path, default=Path("out/speed"))
    options = parser.parse_args()
    console = plain_console(width=None if sys.stdout.isatty() else 140)
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        with tempfile.TemporaryDirectory(dir=options.out) as folder:
            course = Course(Path(folder), options.size_px, options.samples)
            sequence_scene(options.size_px).write(course.folder / SCENE)
            first = {  # on a machine: kernels compile, and are kept
                "one frame": cost_of(course.run(OURS, "one", [(ONE_SUN,)])),
                "36 Suns": cost_of(course.run(OURS, "sweep", [course.suns])),
                "7 Suns": cost_of(course.run(OURS, SCENE, [SUNS])),
            }
            references(course)
            render_references(course)
            rows = [
                *one_frame(course, options.repeats),
                *sweep(course, options.repeats, options.cycles_suns),
                *sequence(course, options.sequence_repeats),
            ]
    except RvbenchError as error:
        console.print(str(error), markup=False)
        return 2
    names = ("size_px", "samples", "repeats", "cycles_suns", "sequence_repeats")
    settings = {name: getattr(options, name) for name in names}
    (options.out / "speed.json").write_text(report(rows, first, settings))
    print_rows(console, rows, first, options.out)
    return 0 if all(row.reached for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())

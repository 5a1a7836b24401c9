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
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from bench.cycles.jobs import BARE, CYCLES, OURS, Effort, Job, Task, read_radiance, run
from bench.cycles.neutral_scene import NeutralScene
from bench.cycles.noise import Cost, cost_of, relative_mse, whole_frame_mse
from bench.cycles.scene_export import maxar_scene, neutral_sun
from bench.cycles.speed_tables import print_rows
from models.arrays import Radiance
from models.errors import RvbenchError
from models.lights.sun import direction_from_azimuth
from models.plain_console import plain_console

SWEEP_AZIMUTHS_DEG = range(0, 360, 30)
SWEEP_ELEVATIONS_DEG = (15, 45, 75)
REFERENCE_FACTOR = 25  # times the samples: its own noise is 4 % of what is measured
REFERENCE_SEED = 1000
JUDGED_SUNS = ("az270el45", "az090el75", "az000el15")  # whose noise stands for the sweep's
ONE_SUN = JUDGED_SUNS[0]  # S2 of the papers


@dataclass(frozen=True)
class Row:
    """One comparison.

    Attributes
    ----------
    what : str
    target : float
        What the ratio should reach; for bare Mitsuba, what it may not exceed.
    ours, theirs : list of Cost
        One for each repetition, the two of a pair taken one after the other.
    noise_ratio, whole_frame_noise_ratio : float
        Their error over ours at equal samples, by either reading of it.
    bare : bool
        Whether "ours" is bare Mitsuba and "theirs" is rvbench, so that less is better.
    """

    what: str
    target: float
    ours: list[Cost]
    theirs: list[Cost]
    noise_ratio: float
    whole_frame_noise_ratio: float
    bare: bool = False

    @property
    def decisive(self) -> list[float]:
        """What is held against the target: at equal noise; of bare Mitsuba, light alone."""
        return self.of_light_alone if self.bare else self.at_equal_noise

    @property
    def reached(self) -> bool:
        """Whether the middle of the repetitions reaches the target."""
        middle = float(np.median(self.decisive))
        return middle <= self.target if self.bare else middle >= self.target

    @property
    def at_equal_samples(self) -> list[float]:
        """Their whole time over ours."""
        return [b.whole_s / a.whole_s for a, b in zip(self.ours, self.theirs, strict=True)]

    @property
    def at_equal_noise(self) -> list[float]:
        """Their whole time over ours, had they the samples that give our noise."""
        pairs = zip(self.ours, self.theirs, strict=True)
        return [b.at_noise(self.noise_ratio, 1.0) / a.whole_s for a, b in pairs]

    @property
    def of_light_alone(self) -> list[float]:
        """Their time for light over ours at equal samples: no start-up, no writing."""
        return [b.light_s / a.light_s for a, b in zip(self.ours, self.theirs, strict=True)]

    @property
    def of_processor_at_equal_noise(self) -> list[float]:
        """The same in processor time, which other work on the machine hardly changes."""
        pairs = zip(self.ours, self.theirs, strict=True)
        return [b.processor_at_noise(self.noise_ratio, 1.0) / a.processor_s for a, b in pairs]

    @property
    def of_processor(self) -> list[float]:
        """Their processor time over ours at equal samples."""
        return [b.processor_s / a.processor_s for a, b in zip(self.ours, self.theirs, strict=True)]


def sweep_scene(size_px: int) -> NeutralScene:
    """Return the Maxar target under the sweep's 36 Suns."""
    suns = tuple(
        neutral_sun(f"az{azimuth:03d}el{elevation:02d}", direction_from_azimuth(azimuth, elevation))
        for elevation in SWEEP_ELEVATIONS_DEG
        for azimuth in SWEEP_AZIMUTHS_DEG
    )
    return maxar_scene(size_px, suns)


class Course:
    """The scenes, and the runs over them."""

    def __init__(self, folder: Path, size_px: int, samples: int) -> None:
        self.folder, self.samples = folder, samples
        scene = sweep_scene(size_px)
        self.suns = tuple(sun.name for sun in scene.suns)
        scene.write(folder / "sweep")
        one = tuple(sun for sun in scene.suns if sun.name == ONE_SUN)
        scene.lit_by(one).write(folder / "one")

    def run(self, side: str, scene: str, suns: list[tuple[str, ...]], **options: int) -> Effort:
        """Run one process that renders some images, each of one or more Suns.

        Parameters
        ----------
        side : str
            Who renders: ``OURS``, ``CYCLES`` or ``BARE``.
        scene : str
            Name of a folder that was written.
        suns : list of tuple of str
            The Suns of each image.
        **options : int
            ``samples`` per pixel, this course's unless given, and the first image's ``seed``, 1.
        """
        samples = options.get("samples", self.samples)
        seed = options.get("seed", 1)
        tasks = tuple(
            Task(names, samples, seed + k, self.image(side, names, k, samples))
            for k, names in enumerate(suns)
        )
        job = Job(side, self.folder / scene, tasks)
        return run(job, self.folder / "jobs", self.folder / "kernels")

    def image(self, side: str, names: tuple[str, ...], number: int, samples: int) -> Path:
        """Return where an image lies.

        Parameters
        ----------
        side : str
        names : tuple of str
            The image's Suns.
        number : int
            Its place in the run.
        samples : int
            Per pixel.
        """
        what = names[0] if len(names) == 1 else f"{len(names)}suns"
        return self.folder / f"{side}_{what}_{number}_{samples}.exr"


def references(course: Course) -> None:
    """Render each side's converged images of the Suns whose noise is judged."""
    samples = course.samples * REFERENCE_FACTOR
    options = {"samples": samples, "seed": REFERENCE_SEED}
    course.run(OURS, "sweep", [JUDGED_SUNS], **options)
    course.run(CYCLES, "sweep", [(name,) for name in JUDGED_SUNS], **options)
    course.run(BARE, "one", [(ONE_SUN,)], **options)


def reference(course: Course, side: str, sun: str) -> Radiance:
    """Read a converged image.

    Parameters
    ----------
    course : Course
    side : str
    sun : str

    Returns
    -------
    (height, width) array, W m-2 sr-1
    """
    samples = course.samples * REFERENCE_FACTOR
    suns = JUDGED_SUNS if side == OURS else (sun,)
    number = JUDGED_SUNS.index(sun) if side == CYCLES else 0
    return read_radiance(course.image(side, suns, number, samples), suns)[sun]


def noise(
    course: Course, side: str, path: Path, suns: tuple[str, ...]
) -> list[tuple[float, float]]:
    """Return both relative errors of each judged Sun that an image holds.

    Parameters
    ----------
    course : Course
    side : str
        Whose converged image is the reference.
    path : Path
    suns : tuple of str
        All that the image holds.
    """
    images = read_radiance(path, suns)
    found = []
    for sun in JUDGED_SUNS:
        if sun in images:
            converged = reference(course, side, sun)
            image = images[sun]
            found.append((relative_mse(image, converged), whole_frame_mse(image, converged)))
    return found


def noise_ratios(
    ours: list[tuple[float, float]], theirs: list[tuple[float, float]]
) -> tuple[float, float]:
    """Return their errors over ours, by both readings: geometric means over Suns."""
    ratios = np.exp(np.log(np.array(theirs) / np.array(ours)).mean(axis=0))
    return float(ratios[0]), float(ratios[1])


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
    parser.add_argument("--out", type=Path, default=Path("out/speed"))
    options = parser.parse_args()
    console = plain_console(width=None if sys.stdout.isatty() else 140)
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        with tempfile.TemporaryDirectory(dir=options.out) as folder:
            course = Course(Path(folder), options.size_px, options.samples)
            first = {  # on a machine: kernels compile, and are kept
                "one frame": cost_of(course.run(OURS, "one", [(ONE_SUN,)])),
                "36 Suns": cost_of(course.run(OURS, "sweep", [course.suns])),
            }
            references(course)
            rows = [
                *one_frame(course, options.repeats),
                *sweep(course, options.repeats, options.cycles_suns),
            ]
    except RvbenchError as error:
        console.print(str(error), markup=False)
        return 2
    names = ("size_px", "samples", "repeats", "cycles_suns")
    settings = {name: getattr(options, name) for name in names}
    (options.out / "speed.json").write_text(report(rows, first, settings))
    print_rows(console, rows, first, options.out)
    return 0 if all(row.reached for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())

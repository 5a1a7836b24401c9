"""The scenes of ``make speed``, what is rendered of them, and how noisy it is."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bench.cycles.jobs import BARE, CYCLES, OURS, Effort, Job, Task, read_radiance, run
from bench.cycles.neutral_scene import NeutralScene
from bench.cycles.noise import relative_mse, whole_frame_mse
from bench.cycles.scene_export import maxar_scene, neutral_sun
from models.arrays import Radiance
from models.lights.sun import direction_from_azimuth
from models.pose import RigidTransform

SWEEP_AZIMUTHS_DEG = range(0, 360, 30)
SWEEP_ELEVATIONS_DEG = (15, 45, 75)
REFERENCE_FACTOR = 25  # times the samples: its own noise is 4 % of what is measured
REFERENCE_SEED = 1000
JUDGED_SUNS = ("az270el45", "az090el75", "az000el15")  # whose noise stands for the sweep's
ONE_SUN = JUDGED_SUNS[0]  # S2 of the papers


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

    def run(
        self,
        side: str,
        scene: str,
        suns: Sequence[tuple[str, ...]],
        views: Sequence[RigidTransform | None] | None = None,
        *,
        samples: int | None = None,
        seed: int = 1,
    ) -> Effort:
        """Run one process that renders some images, each of one or more Suns.

        Parameters
        ----------
        side : str
            Who renders: ``OURS``, ``CYCLES`` or ``BARE``.
        scene : str
            Name of a folder that was written.
        suns : sequence of tuple of str
            The Suns of each image.
        views : sequence of RigidTransform or None, optional
            ``cam_from_target`` of each image; None is where the scene has it.
        samples : int, optional
            Per pixel, this course's unless given.
        seed : int
            Of the first image; the next ones follow.
        """
        samples = samples or self.samples
        tasks = tuple(
            Task(names, samples, seed + k, self.image(side, names, k, samples), view)
            for k, (names, view) in enumerate(zip(suns, views or [None] * len(suns), strict=True))
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
    singles = [(name,) for name in JUDGED_SUNS]
    course.run(OURS, "sweep", [JUDGED_SUNS], samples=samples, seed=REFERENCE_SEED)
    course.run(CYCLES, "sweep", singles, samples=samples, seed=REFERENCE_SEED)
    course.run(BARE, "one", [(ONE_SUN,)], samples=samples, seed=REFERENCE_SEED)


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

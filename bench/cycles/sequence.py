"""The rows of ``make speed`` for a sequence: an approach, every exposure under seven Suns.

The camera flies, the target and its Suns stay; there is no chaser in it, which Cycles would have to
move and rebuild. Both sides keep the scene between exposures.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.cycles.course import REFERENCE_FACTOR, REFERENCE_SEED, Course, noise_ratios
from bench.cycles.jobs import CYCLES, OURS, read_radiance
from bench.cycles.neutral_scene import NeutralScene
from bench.cycles.noise import Cost, cost_of, relative_mse, whole_frame_mse
from bench.cycles.scene_export import maxar_scene, neutral_sun
from bench.cycles.speed_row import Row
from models.arrays import Radiance
from models.lights.sun import SUN_CASES_DEG, direction_from_azimuth
from models.motion.approach import Approach
from models.pose import RigidTransform

EXPOSURES = 20
SUNS = tuple(SUN_CASES_DEG)
SCENE = "sequence"
JUDGED = (1, 11, 16)  # exposures whose noise stands for all; their Suns are S2, S5 and S3
ONE_BY_ONE_TARGET = GROUPS_TARGET = 100.0


def sequence_scene(size_px: int) -> NeutralScene:
    """Return the Maxar target under the seven Suns of the papers, without a chaser.

    Parameters
    ----------
    size_px : int, px
    """
    suns = tuple(
        neutral_sun(name, direction_from_azimuth(*angles)) for name, angles in SUN_CASES_DEG.items()
    )
    return maxar_scene(size_px, suns, with_chaser=False)


def views() -> list[RigidTransform]:
    """Return ``cam_from_target`` of each exposure, evenly spaced over the papers' approach."""
    approach = Approach(pointing_accuracy_deg=0.0)
    times_s = np.linspace(0.0, approach.duration_s, EXPOSURES)
    return [approach.cam_from_target(float(time_s)) for time_s in times_s]


def sun_of(exposure: int) -> str:
    """Return the Sun under which Cycles renders an exposure when it renders one of seven."""
    return SUNS[exposure % len(SUNS)]


def sequence(course: Course, repeats: int) -> tuple[Row, Row]:
    """Time the sequence: ours, seven Suns a pass, against Cycles one by one and by light groups.

    One by one Cycles renders each exposure under one of the Suns, in turn; its light counts seven
    times.

    Parameters
    ----------
    course : Course
    repeats : int
    """
    every, flown = [SUNS] * EXPOSURES, views()
    singles = [(sun_of(k),) for k in range(EXPOSURES)]
    ours: list[Cost] = []
    theirs: list[Cost] = []
    groups: list[Cost] = []
    for _ in range(repeats):
        ours.append(cost_of(course.run(OURS, SCENE, every, flown)))
        part = cost_of(course.run(CYCLES, SCENE, singles, flown))
        theirs.append(part.times(len(SUNS)))
        groups.append(cost_of(course.run(CYCLES, SCENE, every, flown)))
    our_noise = noise(course, OURS, every)
    return (
        Row(
            "20 exposures of 7 Suns, one by one",
            ONE_BY_ONE_TARGET,
            ours,
            theirs,
            *noise_ratios(our_noise, noise(course, CYCLES, singles)),
        ),
        Row(
            "20 exposures of 7 Suns, light groups",
            GROUPS_TARGET,
            ours,
            groups,
            *noise_ratios(our_noise, noise(course, CYCLES, every)),
        ),
    )


def render_references(course: Course, sides: tuple[str, ...] = (OURS, CYCLES)) -> None:
    """Render each side's converged image of the judged exposures, each under its one Sun.

    Parameters
    ----------
    course : Course
    sides : tuple of str
        Whose.
    """
    flown = views()
    samples = course.samples * REFERENCE_FACTOR
    suns = [(sun_of(k),) for k in JUDGED]
    judged = [flown[k] for k in JUDGED]
    for side in sides:
        course.run(side, SCENE, suns, judged, samples=samples, seed=REFERENCE_SEED)


def reference(course: Course, side: str, exposure: int) -> Radiance:
    """Read a converged image.

    Parameters
    ----------
    course : Course
    side : str
    exposure : int
        One of those judged.

    Returns
    -------
    (height, width) array, W m-2 sr-1
    """
    name = (sun_of(exposure),)
    samples = course.samples * REFERENCE_FACTOR
    path = course.image(side, name, JUDGED.index(exposure), samples)
    return read_radiance(path, name)[name[0]]


def noise(course: Course, side: str, suns: Sequence[tuple[str, ...]]) -> list[tuple[float, float]]:
    """Return both relative errors of each judged exposure under its Sun.

    Parameters
    ----------
    course : Course
    side : str
    suns : sequence of tuple of str
        What each of the sequence's images holds.
    """
    found = []
    for k in JUDGED:
        path = course.image(side, suns[k], k, course.samples)
        image, converged = read_radiance(path, suns[k])[sun_of(k)], reference(course, side, k)
        found.append((relative_mse(image, converged), whole_frame_mse(image, converged)))
    return found

"""The sequence's rows: a camera that is moved sees what a camera put there sees."""

from __future__ import annotations

import numpy as np
import pytest

from bench.cycles.course import REFERENCE_FACTOR, Course
from bench.cycles.jobs import OURS, read_radiance
from bench.cycles.scene_export import maxar_scene
from bench.cycles.sequence import (
    EXPOSURES,
    JUDGED,
    SCENE,
    SUNS,
    noise,
    reference,
    render_references,
    sequence_scene,
    sun_of,
    views,
)

SIZE_PX, SAMPLES = 32, 4
ALONE = "at one place"
OTHER_SUN = 0.5  # what two Suns' images differ by, at least, over the brighter of them


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    made = Course(tmp_path_factory.mktemp("course"), SIZE_PX, SAMPLES)
    sequence_scene(SIZE_PX).write(made.folder / SCENE)
    return made


def test_the_judged_exposures_lie_within_the_flight_and_their_suns_differ():
    assert max(JUDGED) < EXPOSURES
    assert len({sun_of(k) for k in JUDGED}) == len(JUDGED)
    ranges = [view.translation[2] for view in views()]
    assert len(ranges) == EXPOSURES
    assert np.all(np.diff(ranges) < 0.0)


def test_a_camera_that_is_moved_sees_what_a_camera_put_there_sees(course):
    last = views()[-1]
    course.run(OURS, SCENE, [SUNS, SUNS], [None, last])
    moved = read_radiance(course.image(OURS, SUNS, 1, SAMPLES), SUNS)
    scene = maxar_scene(SIZE_PX, sequence_scene(SIZE_PX).suns, 330.0, with_chaser=False)
    scene.write(course.folder / ALONE)
    course.run(OURS, ALONE, [SUNS], seed=2)
    put = read_radiance(course.image(OURS, SUNS, 0, SAMPLES), SUNS)
    for sun in SUNS:
        np.testing.assert_array_equal(moved[sun], put[sun])
    assert np.abs(moved["S2"] - moved["S3"]).sum() > OTHER_SUN * moved["S2"].sum()


def test_the_noise_of_an_exposure_is_held_against_its_own_reference(course):
    course.run(OURS, SCENE, [SUNS] * EXPOSURES, views())
    render_references(course, sides=(OURS,))
    errors = noise(course, OURS, [SUNS] * EXPOSURES)
    assert len(errors) == len(JUDGED)
    for (error, _), k in zip(errors, JUDGED, strict=True):
        image = read_radiance(course.image(OURS, SUNS, k, SAMPLES), SUNS)
        wrong = image[SUNS[(k + 1) % len(SUNS)]]
        true = reference(course, OURS, k)
        floor = 0.01 * true.mean()
        other = np.mean((wrong - true) ** 2 / (true**2 + floor**2))
        assert 0.0 < error < other
    assert course.image(OURS, (sun_of(JUDGED[0]),), 0, SAMPLES * REFERENCE_FACTOR).exists()

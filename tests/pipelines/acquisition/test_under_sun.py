"""Poses under a Sun that is known, on images drawn by a peer that shares no code with it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.pose import RigidTransform
from pipelines.acquisition.daylight import Daylight
from pipelines.acquisition.image_part import cut_out
from pipelines.acquisition.light_likelihood import LIT, SHADE, explained, image_light, told_light
from pipelines.acquisition.rivals import RivalOptions
from pipelines.acquisition.sunlit_start import SunlitStart, SunlitStartOptions
from pipelines.acquisition.surface_cloud import surface_cloud
from pipelines.acquisition.under_sun import Looked, UnderSun
from pipelines.acquisition.under_sun_options import Effort, UnderSunOptions
from pipelines.detection.target_region import find_target
from tests.support.drawn_targets import CAMERA, DETECTOR, drawn, target

WIREFRAME = target()
CLOUD = surface_cloud(WIREFRAME)
OPTIONS = UnderSunOptions(directions=250, anew=Effort(24, 16, 8, 1, 1), quick=Effort(6, 6, 2, 1, 1))
SUNS = ((-0.55, -0.35, -0.76), (0.9, 0.1, -0.42))  # behind the camera, and beside it
RIGHT_DEG = 3.0
FOLLOWED = 0.6  # share of the light that a prediction must explain
RADIUS_PX = 85.0  # of the target in these images, about
DARK_DN = 5.0  # of what no Sun lights: the detector's noise is about one


def pose_of(run: int) -> RigidTransform:
    rng = np.random.default_rng([7, run])
    rotation = Rotation.random(random_state=rng).as_matrix()
    return RigidTransform(rotation, np.array([*rng.uniform(-0.5, 0.5, 2), rng.uniform(12, 16)]))


def frame_of(run: int, sun: int) -> np.ndarray:
    return drawn(WIREFRAME, pose_of(run), sun_in_cam=SUNS[sun], seed=run, unlit_dn=DARK_DN)


def daylight(sun: int) -> Daylight:
    return Daylight(np.array(SUNS[sun]))


def turn_deg(one: RigidTransform, other: RigidTransform) -> float:
    turn = Rotation.from_matrix(one.rotation @ other.rotation.T)
    return float(np.rad2deg(turn.magnitude()))


@pytest.fixture(scope="module")
def looking() -> UnderSun:
    return UnderSun(WIREFRAME, CAMERA, DETECTOR, OPTIONS)


@pytest.fixture(scope="module")
def looked(looking: UnderSun) -> dict[tuple[int, int], Looked]:
    runs = ((1, 0), (1, 1), (2, 0))
    return {(run, sun): looking.look(frame_of(run, sun), daylight(sun)) for run, sun in runs}


def test_the_likeliest_pose_is_right(looked: dict[tuple[int, int], Looked]) -> None:
    for (run, _), one in looked.items():
        assert turn_deg(one.candidates[0].pose, pose_of(run)) < RIGHT_DEG


def test_rivals_are_different_and_in_order(
    looking: UnderSun, looked: dict[tuple[int, int], Looked]
) -> None:
    for one in looked.values():
        scores = [each.score for each in one.candidates]
        assert scores == sorted(scores, reverse=True)
        for place, each in enumerate(one.candidates):
            assert not any(looking.same(each.pose, o.pose) for o in one.candidates[:place])


@pytest.mark.parametrize("sun", [0, 1])
def test_the_true_pose_explains_more_light_than_its_half_turns(sun: int) -> None:
    pose = pose_of(1)
    region = find_target(frame_of(1, sun), DETECTOR)
    light = image_light(region, RADIUS_PX)

    def share(rotation: np.ndarray) -> float:
        tried = RigidTransform(rotation, pose.translation)
        return explained(light, told_light(light, CLOUD, CAMERA, tried, np.array(SUNS[sun])))

    for signs in ((1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0)):
        assert share(pose.rotation) > share(pose.rotation @ np.diag(signs))


def test_light_and_shade_are_told_apart() -> None:
    """Where a pose says lit, the drawing is far brighter than where it says shade."""
    frame = frame_of(1, 1).astype(float) - DETECTOR.bias_dn
    light = image_light(find_target(frame_of(1, 1), DETECTOR), RADIUS_PX)
    told = told_light(light, CLOUD, CAMERA, pose_of(1), np.array(SUNS[1]))
    said, corner = told.said, told.corner
    row, column = np.mgrid[0 : said.shape[0], 0 : said.shape[1]]
    x = np.rint((column + corner[0] + 0.5) * light.cell_px + light.corner_px[0]).astype(int)
    y = np.rint((row + corner[1] + 0.5) * light.cell_px + light.corner_px[1]).astype(int)
    inside = (x >= 0) & (x < CAMERA.width) & (y >= 0) & (y < CAMERA.height)
    level = np.where(inside, frame[y.clip(0, 255), x.clip(0, 255)], np.nan)
    assert np.nanmedian(level[said == LIT]) > 10.0 * max(np.nanmedian(level[said == SHADE]), 1.0)


def test_a_part_is_cut_out_with_its_camera() -> None:
    pose = RigidTransform(pose_of(1).rotation, np.array([2.0, -1.0, 60.0]))
    cut = cut_out(drawn(WIREFRAME, pose, unlit_dn=DARK_DN), CAMERA, DETECTOR, 1024)
    assert cut.camera.width < CAMERA.width
    assert cut.target.lit.shape == (cut.camera.height, cut.camera.width)
    moved = CAMERA.project(pose.translation[None]) - cut.camera.project(pose.translation[None])
    np.testing.assert_allclose(moved, np.rint(moved), atol=1e-9)


def test_an_empty_image_is_refused_with_a_reason(looking: UnderSun) -> None:
    start = SunlitStart(looking, SunlitStartOptions())
    black = np.full((CAMERA.height, CAMERA.width), DETECTOR.bias_dn, dtype=np.uint16)
    answer = start.take(black, 0.0, daylight(0))
    assert answer.pose is None
    assert "stands out of the sky" in answer.reason


def test_a_start_ends_when_its_work_is_spent(looking: UnderSun) -> None:
    start = SunlitStart(looking, SunlitStartOptions(most_work=0.0))
    answer = start.take(frame_of(1, 0), 0.0, daylight(0))
    assert answer.pose is None
    assert answer.over
    assert "may cost" in answer.reason


def test_a_start_that_is_not_sure_says_why(looking: UnderSun) -> None:
    """What it explains, and the rival that it leads over: none is sure enough here."""
    never = SunlitStartOptions(rivals=RivalOptions(most_wrong=-1.0))
    answer = SunlitStart(looking, never).take(frame_of(1, 0), 0.0, daylight(0))
    assert answer.pose is None
    assert not answer.over
    assert answer.candidates
    assert "% of the light" in answer.reason
    assert "sigmas over one" in answer.reason


def test_a_prediction_is_followed_where_it_explains_the_light(looking: UnderSun) -> None:
    """It costs less than looking anew; one that is a quarter turn off is no reason to."""
    frame, sun, truth = frame_of(1, 0), daylight(0), pose_of(1)
    quarter = Rotation.from_rotvec([0.0, 0.0, 0.5 * np.pi]).as_matrix()
    turned = RigidTransform(truth.rotation @ quarter, truth.translation)
    followed = looking.look(frame, sun, (truth,), FOLLOWED)
    anew = looking.look(frame, sun, (turned,), FOLLOWED)
    assert followed.work < 0.8 * anew.work
    for looked in (followed, anew):
        assert turn_deg(looked.candidates[0].pose, truth) < RIGHT_DEG

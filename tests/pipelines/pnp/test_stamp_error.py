"""A clock that is off: both cameras' poses are of another instant, and their covariances say so."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from bench.scoring.metrics.pose_errors import frame_nees
from models.estimate import PoseEstimate
from models.frame import IMAGE, Frame, ImageReading
from models.onboard import OnboardKnowledge, PosePrior
from models.pose import RigidTransform
from models.spacecraft.grasp_markers import GRASP_MARKERS
from pipelines.chaser_fixed.options import options_for
from pipelines.chaser_fixed.pipeline import ChaserFixed
from pipelines.eye_in_hand.registered import make
from pipelines.pipeline import Pipeline
from pipelines.pnp.told_errors import stamp_sigma_s
from renders.scenario.told_tables import CalibrationTable, ToldTable
from renders.world.told import sigmas_told
from tests.support import synthetic_dots
from tests.support.synthetic_pair import (
    CAMERA_1024,
    PRIOR_SIGMA_DEG,
    PRIOR_SIGMA_M,
    Scene,
    expected_pair,
    facing_pose,
    knowledge_of,
)

SIGMA_S = 0.02  # 0.8 mm along the motion, several sigmas of either camera's own noise
TOLD = {"frames.offset_s": SIGMA_S}
FRAMES, STEP_S = 3, 1.0
TURN_DEG_S, SHIFT_M_S = np.array([0.02, -0.03, 0.04]), np.array([0.02, -0.01, -0.03])
RUNS = 24
# What the mean NEES of honest covariances exceeds once in 2000 draws. The images' own part of it is
# cautious here: what is left is the clock's, one number of six.
HONEST = float(chi2.ppf(0.9995, 6 * RUNS) / (6 * RUNS))
CLOCK_ALONE = float(chi2.ppf(0.0005, RUNS) / (6 * RUNS))


def carried(first: RigidTransform, time_s: float) -> RigidTransform:
    return first.perturbed(np.deg2rad(TURN_DEG_S) * time_s, SHIFT_M_S * time_s)


class Chaser:
    """The camera fixed to the chaser, on drawn pairs."""

    first = facing_pose(3.0, (179.0, 1.0, -2.0))

    def __init__(self) -> None:
        self._scene = Scene(camera=CAMERA_1024)
        poses = [carried(self.first, index * STEP_S) for index in range(FRAMES)]
        self._pairs = [expected_pair(self._scene, pose) for pose in poses]

    def pipeline(self, sigmas: Mapping[str, float], variant: str) -> Pipeline:
        known = knowledge_of(self._scene, self.first, PRIOR_SIGMA_M, PRIOR_SIGMA_DEG)
        return ChaserFixed(known, options_for(variant), sigmas)

    def frame(self, run: int, index: int, time_s: float) -> Frame:
        return self._pairs[index].exposed(run, index, time_s)


class Hand:
    """The camera in the hand, on drawn dots."""

    first = synthetic_dots.facing(0.9, [3.0, -4.0, 5.0], (0.005, -0.004))

    def __init__(self) -> None:
        self._means = [
            synthetic_dots.mean_image(synthetic_dots.DotScene(carried(self.first, index * STEP_S)))
            for index in range(FRAMES)
        ]

    def pipeline(self, sigmas: Mapping[str, float], variant: str) -> Pipeline:
        prior = PosePrior(self.first, np.full(3, 0.010), np.full(3, 0.667))
        known = OnboardKnowledge(
            synthetic_dots.CAMERA, synthetic_dots.DETECTOR, GRASP_MARKERS, prior
        )
        return make(replace(known, sigmas=dict(sigmas)), variant)

    def frame(self, run: int, index: int, time_s: float) -> Frame:
        detector = synthetic_dots.DETECTOR
        raw = synthetic_dots.with_noise(self._means[index], detector, FRAMES * run + index)
        return Frame(index, time_s, {IMAGE: ImageReading(raw, time_s, 3.0)})


@pytest.fixture(scope="module", params=[Chaser, Hand])
def camera(request: pytest.FixtureRequest) -> Chaser | Hand:
    made = request.param()
    assert isinstance(made, Chaser | Hand)
    return made


def poses_of(
    camera: Chaser | Hand, run: int, off_s: float, sigmas: Mapping[str, float], variant: str
) -> list[PoseEstimate]:
    """Fly one run whose clock is off by the same all along."""
    pipeline, poses = camera.pipeline(sigmas, variant), []
    for index in range(FRAMES):
        said = pipeline.process(camera.frame(run, index, index * STEP_S + off_s))
        assert said.pose is not None, said.reason
        poses.append(said.pose)
    return poses


def squares(camera: Chaser | Hand, sigmas: Mapping[str, float]) -> list[float]:
    """Return the mean NEES over six of each frame, against the pose at the time stamped."""
    rows = []
    for run in range(RUNS):
        off_s = SIGMA_S * float(np.random.default_rng([11, run]).standard_normal())
        poses = poses_of(camera, run, off_s, sigmas, "best")
        stamped = [carried(camera.first, index * STEP_S + off_s) for index in range(FRAMES)]
        rows.append([frame_nees(*each) for each in zip(poses, stamped, strict=True)])
    return [float(each) for each in np.mean(np.array(rows, dtype=np.float64), axis=0) / 6.0]


def test_told_of_it_the_covariance_holds_from_the_first_frame_on(camera: Chaser | Hand) -> None:
    found = squares(camera, TOLD)
    assert max(found) < HONEST
    assert min(found[1:]) > CLOCK_ALONE


def test_told_nothing_it_is_far_too_small(camera: Chaser | Hand) -> None:
    assert min(squares(camera, {})[1:]) > 3.0 * HONEST


def test_poses_are_the_same_and_what_is_added_is_along_the_motion(camera: Chaser | Hand) -> None:
    """The clock errs alike in all frames: no prediction, and so no pose, is of its size."""
    plain, told = (poses_of(camera, 0, 0.0, sigmas, "best") for sigmas in ({}, TOLD))
    rate = np.concatenate([np.deg2rad(TURN_DEG_S), SHIFT_M_S])
    for index, (one, other) in enumerate(zip(plain, told, strict=True)):
        assert np.array_equal(one.cam_from_target.matrix(), other.cam_from_target.matrix())
        if index == 0:
            continue
        added = other.stated_covariance - one.stated_covariance
        assert np.linalg.matrix_rank(added, tol=1e-6 * np.trace(added)) == 1
        # The rate is that of two poses a second apart, each a tenth of a millimetre off or so.
        along = SIGMA_S * rate[3:]
        assert added[3:, 3:] == pytest.approx(
            np.outer(along, along), abs=0.05 * float(along @ along)
        )


def test_as_published_no_told_error_is_known(camera: Chaser | Hand) -> None:
    plain, told = (poses_of(camera, 0, 0.0, sigmas, "paper") for sigmas in ({}, TOLD))
    for one, other in zip(plain, told, strict=True):
        assert np.array_equal(one.stated_covariance, other.stated_covariance)


def test_the_stamp_is_told_as_a_dataset_tells_it() -> None:
    table = ToldTable.model_validate(
        {"clock": {"offset_s": {"sigma": 2e-3}, "drift_ppm": {"sigma": 5.0}}}
    )
    sigmas = sigmas_told(table, CalibrationTable(sigma_focal_px=0.0, sigma_principal_point_px=0.0))
    assert stamp_sigma_s(sigmas, 0.0) == 2e-3
    # 5 ppm of 300 s are 1.5 ms.
    assert stamp_sigma_s(sigmas, 300.0) == pytest.approx(2.5e-3, rel=1e-12)
    assert stamp_sigma_s({}, 300.0) == 0.0

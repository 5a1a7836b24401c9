"""A calibration that is off: stated or weighed it is owned up to, and weighed poses are nearer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from bench.scoring.metrics.pose_errors import frame_nees
from models.arrays import Floats
from models.pose import pose_error
from pipelines.chaser_fixed.options import CalibrationUse, options_for
from pipelines.chaser_fixed.pipeline import ChaserFixed
from tests.support.synthetic_pair import (
    CAMERA_1024,
    PRIOR_SIGMA_DEG,
    PRIOR_SIGMA_M,
    Scene,
    drawn_prior,
    expected_pair,
    facing_pose,
    knowledge_of,
)

SIGMAS = {f"camera.{key}": 1.0 for key in ("fx", "fy", "cx", "cy")}
POSE = facing_pose(3.0, (179.0, 1.0, -2.0))
RUNS = 12
# What the mean NEES of honest covariances exceeds once in 2000 draws. A first frame is cautious:
# what motion within the pair may have done widens each marker's covariance.
HONEST = float(chi2.ppf(0.9995, 6 * RUNS) / (6 * RUNS))
CAUTIOUS = 0.3


def flown(use: CalibrationUse) -> tuple[Floats, Floats]:
    """Return errors (runs, 6), m and deg, and NEES over 6; each run has its own calibration."""
    scene = Scene(camera=CAMERA_1024)
    pair = expected_pair(scene, POSE)
    errors, squares = [], []
    for run in range(RUNS):
        rng = np.random.default_rng([7, run])
        told = replace(
            CAMERA_1024,
            **{
                key: getattr(CAMERA_1024, key) + rng.standard_normal()
                for key in ("fx", "fy", "cx", "cy")
            },
        )
        knowledge = knowledge_of(scene, drawn_prior(POSE, run), PRIOR_SIGMA_M, PRIOR_SIGMA_DEG)
        options = replace(options_for("best"), calibration=use)
        pipeline = ChaserFixed(replace(knowledge, camera=told), options, SIGMAS)
        pose = pipeline.process(pair.exposed(run)).pose
        assert pose is not None
        error = pose_error(pose.cam_from_target, POSE)
        errors.append([*error.position_m, *error.euler_deg])
        square = frame_nees(pose, POSE)
        assert square is not None
        squares.append(square / 6.0)
    return np.array(errors), np.array(squares)


@pytest.fixture(scope="module")
def weighed() -> tuple[Floats, Floats]:
    return flown("weighed")


def test_weighed_the_covariance_holds(weighed: tuple[Floats, Floats]) -> None:
    assert CAUTIOUS < weighed[1].mean() < HONEST


def test_only_stated_it_holds_too_and_poses_are_further_off(weighed: tuple[Floats, Floats]) -> None:
    errors, squares = flown("stated")
    assert CAUTIOUS < squares.mean() < HONEST
    rms, nearer = (np.sqrt((each**2).mean(axis=0)) for each in (errors, weighed[0]))
    assert (nearer < 0.95 * rms).all()


def test_taken_for_exact_the_covariance_is_far_too_small(weighed: tuple[Floats, Floats]) -> None:
    assert flown("unknown")[1].mean() > 10.0 * HONEST

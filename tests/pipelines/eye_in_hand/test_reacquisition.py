"""Frames without a pose, and the first one after them."""

from __future__ import annotations

import numpy as np
import pytest

from models.frame import IMAGE, Frame, ImageReading
from models.motion.prior import draw_prior
from models.onboard import OnboardKnowledge, PosePrior
from models.pose import RigidTransform, pose_error
from models.spacecraft.grasp_markers import GRASP_MARKERS, grasp_board_outline
from pipelines.eye_in_hand.registered import make
from tests.support.synthetic_dots import CAMERA, DETECTOR, DotScene, facing, raw_image

PRIOR_M, PRIOR_DEG = np.full(3, 0.010), np.full(3, 0.667)  # Opromolla et al. 2022, Table 5
DARK = np.full((CAMERA.height, CAMERA.width), 100, dtype=np.uint16)


def pose_at(time_s: float) -> RigidTransform:
    """Return a motion of 21 mm/s that slows down, and turns by 0.2 deg/s."""
    range_m = 1.2 - 0.02 * time_s + 0.0005 * time_s**2
    return facing(range_m, [3.0, -4.0 + 0.2 * time_s, 5.0], (0.005 + 0.006 * time_s, -0.004))


@pytest.mark.parametrize("dark", [range(6), range(2, 14)])
def test_the_first_frame_with_light_gives_a_pose_again(dark: range) -> None:
    """From the start, by a prior that is six seconds old; and after twelve seconds in flight."""
    first = pose_at(0.0)
    drawn = draw_prior(first, PRIOR_M, PRIOR_DEG, np.random.default_rng(0))
    prior = PosePrior(drawn, PRIOR_M, PRIOR_DEG)
    known = OnboardKnowledge(CAMERA, DETECTOR, GRASP_MARKERS, prior, grasp_board_outline())
    pipeline = make(known, "best")
    for index in range(dark.stop + 1):
        pose, time_s = pose_at(float(index)), float(index)
        raw = DARK if index in dark else raw_image(DotScene(pose, coarse=4), index)
        said = pipeline.process(Frame(index, time_s, {IMAGE: ImageReading(raw, time_s, 3.0)}))
        if index in dark:
            assert said.reason
            continue
        assert said.pose is not None, said.reason
        error = pose_error(said.pose.cam_from_target, pose)
        assert 1e3 * np.linalg.norm(error.position_m) < 0.2
        assert error.attitude_deg < 0.05

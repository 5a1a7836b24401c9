"""A chaser's own state and its protection levels, wrong by known amounts, score as that."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.scoring.navigated.parts import frame_rows, integrity, navigation, relative_integrity
from models.estimate import Estimate, NamedState
from models.motion.perturbed_orbit import lvlh_axes
from models.motion.relative_state import ChaserState, RelativeState

POSITION, VELOCITY = np.array([7158e3, 0.0, 0.0]), np.array([0.0, 1e3, 7.4e3])
AXES = lvlh_axes(POSITION, VELOCITY)
OFF_M, OFF_DEG, RHO_OFF_M = 3.0, 0.01, 0.2
FRAMES = 4


def said(frame: int, level_m: float, relative_level_m: float) -> Estimate:
    """Return 3 m off along the track, 0.01 deg about the body's y, 0.2 m in relative position."""
    turn = Rotation.from_matrix(AXES) * Rotation.from_rotvec([0.0, np.deg2rad(OFF_DEG), 0.0])
    relative = RelativeState(
        float(frame), np.array([0.0, 30.0 + RHO_OFF_M, 0.0]), np.zeros(3), np.eye(3), np.zeros(3)
    )
    states = {
        **relative.named(np.eye(6), np.eye(6)),
        "chaser_orbit": NamedState(
            {
                "position_in_inertial_m": POSITION + AXES @ [0.0, OFF_M, 0.0],
                "velocity_in_inertial_m_s": VELOCITY,
            },
            np.diag([OFF_M**2] * 3 + [1e-4] * 3),
        ),
        "chaser_attitude": NamedState(
            {"q_inertial_from_body_wxyz": turn.as_quat(scalar_first=True)},
            np.deg2rad(OFF_DEG) ** 2 * np.eye(6),
        ),
        "integrity": NamedState(
            {
                "protection_m": np.full(3, level_m),
                "relative_protection_m": np.full(3, relative_level_m),
            }
        ),
    }
    return Estimate(frame, float(frame), mode="tracked", states=states)


TRUTH = SimpleNamespace(
    by_frame={
        frame: SimpleNamespace(
            time_s=float(frame),
            chaser=ChaserState(float(frame), POSITION, VELOCITY),
            state=RelativeState(
                float(frame), np.array([0.0, 30.0, 0.0]), np.zeros(3), np.eye(3), np.zeros(3)
            ),
        )
        for frame in range(FRAMES)
    }
)


def judged(*estimates: Estimate):
    return [[SimpleNamespace(run=0, estimate=each, row=dict) for each in estimates]]


def test_errors_of_the_chaser_are_told_by_axis():
    found = navigation(judged(*(said(frame, 10.0, 1.0) for frame in range(FRAMES))), TRUTH, "best")
    assert found.along_rms_m == pytest.approx([0.0, OFF_M, 0.0], abs=1e-6)
    assert found.attitude_rms_deg == pytest.approx(OFF_DEG, rel=1e-6)
    assert found.orbit_nees == pytest.approx(1.0 / 6.0, rel=1e-6)
    assert found.attitude_nees == pytest.approx(1.0 / 3.0, rel=1e-6)


def test_an_error_beyond_its_level_was_not_warned_of():
    runs = judged(said(0, 10.0, 1.0), said(1, 2.0, 1.0), said(2, 10.0, 0.1), said(3, 10.0, 0.1))
    own, relative = integrity(runs, TRUTH, "best"), relative_integrity(runs, TRUTH, "best")
    assert (own.told, own.missed) == (4, 1)
    assert (relative.told, relative.missed) == (4, 2)
    assert relative.mean_m == pytest.approx([0.55] * 3)


def test_a_pipeline_that_tells_nothing_of_the_chaser_has_nothing_judged():
    silent = Estimate(0, 0.0, reason="too dark")
    assert navigation(judged(silent), TRUTH, "best").along_rms_m is None
    assert relative_integrity(judged(silent), TRUTH, "best").told == 0
    assert frame_rows(judged(silent), TRUTH)[0]["along_m"] is None

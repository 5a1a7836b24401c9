"""Pairs with two seeds: what is mixed, and what a change is held against."""

from __future__ import annotations

import numpy as np
import pytest

from bench.grain.pairs import change, mixed, row, sigma, with_seed
from models.estimate import Detections, Estimate, PoseEstimate
from models.pose import RigidTransform
from renders.scenario.case_files import case_path
from renders.scenario.scenario import Scenario

SIGMA_M = 1e-3
AHEAD = RigidTransform(np.eye(3), np.array([0.0, 0.0, 5.0]))
FRAMES = 400
BY_CHANCE = 0.15  # of a ratio of rms over 400 frames of three axes: 4 sigma


def said(offsets, sigma_m=SIGMA_M):
    """Return estimates whose position is off by some amounts, (n, 3), m."""
    detections = Detections(np.zeros((3, 2)), np.ones((3, 2)), (0, 1, 2), (True, True, False))
    covariance = np.diag([1e-8] * 3 + [sigma_m**2] * 3)
    return [
        Estimate(
            frame=k,
            time_s=float(k),
            detections=detections,
            pose=PoseEstimate(AHEAD.perturbed(offset, offset), covariance),
        )
        for k, offset in enumerate(offsets)
    ]


def test_a_change_is_a_distance_and_an_angle():
    one, other = (e.pose for e in said(np.array([[0.0, 0.0, 0.0], [0.003, 0.0, 0.004]])))
    np.testing.assert_allclose(change(one, other), [0.005, 0.005], rtol=1e-6)


def test_another_draw_changes_as_much_as_the_runs_differ_and_a_shift_more():
    rng = np.random.default_rng(5)
    runs = [said(SIGMA_M * rng.standard_normal((FRAMES, 3))) for _ in range(4)]
    drawn = row("best", runs, said(SIGMA_M * rng.standard_normal((FRAMES, 3))))
    assert float(drawn[3]) == pytest.approx(1.0, abs=BY_CHANCE)
    shifted = row("best", runs, said(3.0 * SIGMA_M * rng.standard_normal((FRAMES, 3))))
    # Two draws differ by the root of both their variances: sqrt(1 + 9) over sqrt(2).
    assert float(shifted[3]) == pytest.approx(np.sqrt(5.0), rel=BY_CHANCE)
    assert drawn[2] == f"{2 * FRAMES}, {2 * FRAMES}"


def test_a_lost_pose_is_counted_and_a_wider_sigma_told():
    rng = np.random.default_rng(6)
    runs = [said(SIGMA_M * rng.standard_normal((FRAMES, 3))) for _ in range(2)]
    other = said(SIGMA_M * rng.standard_normal((FRAMES, 3)), 2.0 * SIGMA_M)
    other[7] = Estimate(frame=7, time_s=7.0, reason="nothing there")
    line = row("best", runs, other)
    assert line[1] == f"{FRAMES}, {FRAMES - 1} of {FRAMES}"
    assert float(line[5]) == 2.0
    assert sigma(other) == pytest.approx(np.sqrt(3.0) * 2.0 * SIGMA_M)


def test_one_band_comes_from_the_other_seed(tmp_path):
    for name in ("seed0", "seed1"):
        (tmp_path / name / "frames").mkdir(parents=True)
        (tmp_path / name / "estimates").mkdir()
        for band in ("800", "850"):
            (tmp_path / name / "frames" / f"000000_{band}.png").write_text(f"{name} {band}")
    mixed(tmp_path / "seed0", tmp_path / "seed1", tmp_path / "both")
    frames = tmp_path / "both" / "frames"
    assert (frames / "000000_800.png").read_text() == "seed0 800"
    assert (frames / "000000_850.png").read_text() == "seed1 850"
    assert not (tmp_path / "both" / "estimates").exists()


def test_a_case_with_another_seed_differs_in_nothing_else(tmp_path):
    import tomllib

    written = tomllib.loads(with_seed("maxar-approach", 3, tmp_path).read_text())
    assert Scenario(**written).render.seed == 3
    case = tomllib.loads(case_path("maxar-approach").read_text())
    assert written["render"] == {**case["render"], "seed": 3}
    assert {key for key in case if written[key] != case[key]} == {"render", "sun"}

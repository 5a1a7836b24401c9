"""A wrong pose is one beyond its own covariance and the case's limits: counted apart from lost."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from bench.scoring.core_score import longest_run
from bench.scoring.judgement import ALLOWED_CONFIDENCE, is_wrong
from bench.scoring.limits import Limits, read_asked, read_limits
from bench.scoring.score import score_dataset
from models.errors import DatasetError
from tests.support.synthetic_dataset import (
    lost_estimate,
    perfect_estimate,
    write_dataset,
    write_variant,
)

SMALL = np.diag([1e-3] * 3 + [1e-2] * 3) ** 2  # a milliradian, a centimetre
HONEST = np.diag([0.5] * 3 + [2.0] * 3) ** 2  # half a radian, two metres
FRAMES = 8


@pytest.fixture
def dataset(tmp_path):
    return write_dataset(tmp_path / "data", frames=FRAMES, width_px=64)


def off(truth, covariance, shift_m=2.0, turn_deg=0.0):
    """Return an estimate wrong by a shift along the boresight and a turn about it."""
    said = perfect_estimate(truth)
    pose = said.pose.cam_from_target.perturbed(
        [0.0, 0.0, np.deg2rad(turn_deg)], [0.0, 0.0, shift_m]
    )
    return replace(said, pose=replace(said.pose, cam_from_target=pose, covariance=covariance))


def wrong(dataset, make) -> dict:
    write_variant(dataset, "best", make)
    return score_dataset(dataset.folder)["pipelines"]["best"]["core"]["wrong"]


@pytest.mark.parametrize(
    ("covariance", "count"), [(SMALL, FRAMES), (HONEST, 0), (None, FRAMES)], ids=str
)
def test_two_metres_off_is_wrong_unless_the_covariance_says_so(dataset, covariance, count):
    """Without a covariance nothing is allowed for."""
    assert wrong(dataset, lambda truth: off(truth, covariance))["count"] == count


def test_what_is_within_the_limits_is_not_wrong_whatever_was_boasted(dataset):
    assert wrong(dataset, lambda truth: off(truth, SMALL, shift_m=0.9))["count"] == 0
    assert wrong(dataset, lambda t: off(t, SMALL, shift_m=0.0, turn_deg=9.0))["count"] == 0
    assert wrong(dataset, lambda t: off(t, SMALL, shift_m=0.0, turn_deg=11.0))["count"] == FRAMES


def test_wrong_poses_are_counted_listed_and_not_lost(dataset):
    def some(truth):
        if truth.frame in (2, 3, 6):
            return off(truth, SMALL)
        return lost_estimate(truth) if truth.frame == 5 else perfect_estimate(truth)

    write_variant(dataset, "best", some)
    write_variant(dataset, "best", lambda truth: off(truth, SMALL), run=1)
    scored = score_dataset(dataset.folder)["pipelines"]["best"]
    core = scored["core"]
    assert core["wrong"] == {"count": 3, "longest": 2, "frames": [2, 3, 6]}
    assert core["lost"]["frames"] == [5]
    assert core["estimated"] == FRAMES - 1
    assert core["pooled"]["wrong"] == 3 + FRAMES
    assert [row["frame"] for row in scored["per_frame"] if row["wrong"]] == [2, 3, 6]


def test_the_case_names_the_limits(tmp_path):
    squares = ((1e6, 6),)
    assert is_wrong(0.5, 0.0, squares, Limits(0.4, 5.0))
    assert not is_wrong(0.5, 0.0, squares, Limits())
    assert read_limits(tmp_path) == Limits()


def test_limits_and_what_is_asked_are_read_from_behind_the_wall(tmp_path):
    path = tmp_path / "truth" / "scenario.toml"
    path.parent.mkdir()
    path.write_text(
        "[limits]\nwrong_position_m = 0.4\nwrong_attitude_deg = 5\n"
        "[asked]\nlost_share = 0.1\nwrong_in_a_row = 3\n"
    )
    assert read_limits(tmp_path) == Limits(0.4, 5.0)
    assert (read_asked(tmp_path).lost_share, read_asked(tmp_path).wrong_in_a_row) == (0.1, 3)
    assert read_asked(tmp_path).median_position_m is None
    path.write_text("[limits]\nwrong_position_m = -1\nwrong_attitude_deg = 5\n")
    with pytest.raises(DatasetError, match=r"scenario\.toml.*limits\.wrong_position_m"):
        read_limits(tmp_path)
    path.write_text("limits = 3\n")
    with pytest.raises(DatasetError, match=r"scenario\.toml.*limits"):
        read_limits(tmp_path)


def test_an_honest_covariance_is_rarely_called_wrong():
    """Of 20 000 honest errors beyond the limits two are expected beyond their covariance."""
    rng = np.random.default_rng(3)
    squares = rng.chisquare(6, 20_000)
    called = sum(is_wrong(5.0, 0.0, ((square, 6),), Limits()) for square in squares)
    assert called <= 10  # Poisson of mean two: beyond ten once in 100 000
    bound = chi2.ppf(ALLOWED_CONFIDENCE, 6)
    assert is_wrong(5.0, 0.0, ((1.01 * bound, 6),), Limits())
    assert not is_wrong(5.0, 0.0, ((0.99 * bound, 6),), Limits())
    assert is_wrong(5.0, 0.0, ((0.1, 6), (1.01 * bound, 6)), Limits())
    assert is_wrong(5.0, 0.0, ((np.nan, 6),), Limits())
    assert not is_wrong(None, None, ((1e9, 6),), Limits())


def test_longest_run():
    assert longest_run([]) == 0
    assert longest_run([True, True, False, True]) == 2

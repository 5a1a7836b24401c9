"""A dataset whose estimates are wrong by known amounts gets the score that these amount to."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from bench.report.tumble_summary import print_tumble_summary
from models.dataset.navigation_estimates_file import write_navigation_estimates
from models.uncooperative import NavigationEstimate
from rich.console import Console
from scipy.spatial.transform import Rotation

from bench.estimating.runs import estimates_path
from bench.estimating.starts import chosen_starts, read_starts, starts_path, try_starts
from bench.report.tumble.page import write_tumble_report
from bench.scoring.tumble.judged_images import confusion_of, lit_landmarks
from bench.scoring.tumble.parts import longest_run, read_tumble_score, score_tumble
from models.errors import DatasetError
from models.estimate import Detections, NoPose, PoseEstimate
from models.motion.tumble import CAM_FROM_LVLH
from models.pose import RigidTransform
from models.spacecraft.wireframes import wireframe_by_name
from tests.support.synthetic_images import write_images

FRAMES = 8
MOVED_M, TURNED_DEG = 0.05, 1.0
WRONG = (4, 5, 6)  # half a turn about z
LOST = 3  # after the first state, no pose
OFF_PX = 1.5  # of every second corner, along u
STAND_IN = "tests.support.stand_in_navigation"
ROUNDING = 1e-6


def corners(truth) -> Detections:
    """Return every visible landmark, every second one beside its place, and one of nothing."""
    points = truth.landmarks_px[truth.landmarks_visible].copy()
    points[::2, 0] += OFF_PX
    points = np.concatenate([points, [[3.0, 3.0]]])
    count = len(points)
    return Detections(points, np.full((count, 2), 0.5), (-1,) * count, (False,) * count)


def estimate(truth) -> NavigationEstimate:
    """Return what the stand-in of a pipeline says of one frame."""
    index, found = truth.frame, corners(truth)
    if index == 0:
        none = NoPose(0, truth.time_s, "too dark", found)
        return NavigationEstimate(0, truth.time_s, "searching", none, None, None, None)
    axis = np.array([0.0, 0.0, np.pi]) if index in WRONG else np.deg2rad([TURNED_DEG, 0.0, 0.0])
    state = replace(
        truth.state,
        rho_in_lvlh=truth.state.rho_in_lvlh + np.array([MOVED_M, 0.0, 0.0]),
        R_lvlh_from_target=truth.state.R_lvlh_from_target @ Rotation.from_rotvec(axis).as_matrix(),
    )
    pose = PoseEstimate(
        index, truth.time_s, state.cam_from_target(CAM_FROM_LVLH), 1e-4 * np.eye(6), found, 0.5
    )
    honest = np.diag(np.repeat([MOVED_M**2, 1.0], 3))
    turn = np.diag(np.repeat([np.deg2rad(TURNED_DEG) ** 2, 1.0], 3))
    if index == LOST:
        none = NoPose(index, truth.time_s, "blurred", found)
        return NavigationEstimate(index, truth.time_s, "predicted", none, state, honest, turn)
    return NavigationEstimate(index, truth.time_s, "tracked", pose, state, honest, turn)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    dataset = write_images(tmp_path_factory.mktemp("tumble") / "data", frames=FRAMES, width_px=256)
    said = [estimate(truth) for truth in dataset.truths]
    for variant in ("best", "paper"):
        write_navigation_estimates(estimates_path(dataset.folder, 0, variant), said)
    try_starts(dataset.folder, starts=3, most_images=3, navigator=STAND_IN)
    score_tumble(dataset.folder)
    return dataset


@pytest.fixture(scope="module")
def best(written):
    return read_tumble_score(written.folder)["pipelines"]["best"]


def test_errors_are_those_put_in(best):
    assert best["position_m"]["median"] == pytest.approx(MOVED_M, rel=ROUNDING)
    assert best["attitude_deg"]["median"] == pytest.approx(TURNED_DEG, rel=ROUNDING)
    assert best["attitude_deg"]["p95"] == pytest.approx(180.0, rel=ROUNDING)
    assert best["velocity_m_s"]["median"] == 0.0


def test_frames_without_a_pose_are_counted(best):
    assert (best["frames"], best["with_state"], best["first_state"]) == (FRAMES, FRAMES - 1, 1)
    assert best["lost"] == 1
    assert best["lost_share"] == pytest.approx(1.0 / (FRAMES - 1))
    assert best["reasons"] == {"too dark": 1, "blurred": 1}
    assert best["modes"] == {"searching": 1, "tracked": FRAMES - 2, "predicted": 1}


def test_wrong_states_are_counted_named_and_followed(best):
    assert (best["wrong"], best["longest_wrong"]) == (len(WRONG), len(WRONG))
    assert best["confusions"] == {"half turn about z": len(WRONG)}


def test_an_honest_covariance_has_the_nees_of_its_error(best):
    """One axis wrong by one sigma, five right."""
    assert best["nees"]["translation"]["mean"] == pytest.approx(1.0 / 6.0, rel=ROUNDING)


def test_corners_are_found_where_they_are(written, best):
    visible = sum(int(truth.landmarks_visible.sum()) for truth in written.truths)
    corners = best["corners"]
    assert corners["repeatability"] == 1.0
    assert corners["precision"] == pytest.approx(visible / (visible + FRAMES))
    off = sum((int(truth.landmarks_visible.sum()) + 1) // 2 for truth in written.truths)
    # Where landmarks lie so near each other that another's corner is the nearer, it is less.
    assert corners["rms_px"] <= OFF_PX * np.sqrt(0.5 * off / visible) + ROUNDING
    assert corners["rms_px"] > 0.8 * OFF_PX * np.sqrt(0.5 * off / visible)


def test_checks_say_what_holds(best):
    holds = {check["what"]: check["holds"] for check in best["checks"]}
    assert holds["median position error"] is True
    assert holds["median attitude error"] is True
    assert holds["frames lost once acquired"] is False
    assert holds["longest run of wrong states"] is True


def test_limits_share_out_all_frames(best):
    for name in ("visible landmarks", "sunlit share", "corners found"):
        own = [limit for limit in best["limits"] if limit["of"] == name]
        assert sum(limit["frames"] for limit in own) == FRAMES
        spans = [limit["span"] for limit in own]
        assert all(a[1] <= b[0] for a, b in pairwise(spans))


def test_the_report_holds_everything(written):
    text = write_tumble_report(written.folder).read_text()
    assert text.count("data:image/jpeg;base64,") == 1 + FRAMES
    assert "half turn about z" in text
    assert "too dark" in text
    assert "http" not in text.replace("http://www.w3.org", "")


def test_the_summary_names_the_target(written, capsys):
    print_tumble_summary(Console(width=200), read_tumble_score(written.folder))
    said = capsys.readouterr().out
    assert "xmm" in said
    assert "longest run of wrong states" in said


def test_estimates_of_other_frames_are_refused(written, tmp_path):
    dataset = write_images(tmp_path / "data", frames=2, width_px=128)
    said = [estimate(written.truths[0])]
    write_navigation_estimates(estimates_path(dataset.folder, 0, "best"), said)
    with pytest.raises(DatasetError, match="one estimate for each of the 2 frames"):
        score_tumble(dataset.folder)


def test_a_score_of_another_kind_is_refused(tmp_path):
    (tmp_path / "score.json").write_text('{"format": "rvbench-score", "version": 1}')
    with pytest.raises(DatasetError, match="rvbench-tumble-score"):
        read_tumble_score(tmp_path)


def test_starts_are_spread_and_have_images_left():
    starts = chosen_starts(list(range(200)), 50, 5)
    assert len(starts) == 50
    assert starts[0] == (0, 1, 2, 3, 4)
    assert starts[-1] == (195, 196, 197, 198, 199)
    gaps = np.diff([own[0] for own in starts])
    assert gaps.max() - gaps.min() <= 1
    assert chosen_starts([4, 7], 50, 5) == ((4, 7),)


def test_a_start_looks_on_until_an_image_gives_a_pose(written, best):
    """The stand-in finds its pose, the right one at time zero only, on every second image."""
    most, starts = read_starts(written.folder, "best")
    assert most == 3
    assert [start.images for start in starts] == [2, 2, 2]
    assert [start.pose_frame for start in starts] == [start.frame + 1 for start in starts]
    scored = best["starts"]
    assert scored["starts"] == 3
    assert scored["first_image"] == 0
    assert scored["within"] + scored["wrong"] + scored["none"] == 3


def test_trying_again_does_nothing_and_says_the_same(written):
    before = starts_path(written.folder, "best").read_bytes()
    try_starts(written.folder, workers=2, starts=3, most_images=3, navigator=STAND_IN)
    assert starts_path(written.folder, "best").read_bytes() == before


def test_damaged_starts_say_what_to_do(tmp_path):
    path = starts_path(tmp_path, "best")
    path.parent.mkdir(parents=True)
    path.write_text('{"most_images": 3')
    with pytest.raises(DatasetError, match="delete it and estimate again"):
        read_starts(tmp_path, "best")
    assert read_starts(tmp_path, "paper") == (0, [])


def test_longest_run():
    assert longest_run([]) == 0
    assert longest_run([True, True, False, True]) == 2


def test_the_suns_side_of_a_plate_is_lit():
    """Of XMM, what faces the Sun alone in an image from the Sun is lit; behind it is not all."""
    target = wireframe_by_name("xmm")
    for axis in np.eye(3):
        front, back = lit_landmarks(target, axis), lit_landmarks(target, -axis)
        height = target.points_in_target @ axis
        assert front[height.argmax()]
        assert back[height.argmin()]
        assert not (front & back).all()


def test_a_turn_is_named_by_its_axis():
    target = wireframe_by_name("xmm")
    truth = RigidTransform(np.eye(3), np.array([0.0, 0.0, 30.0]))
    for axis, name in zip(np.eye(3), "xyz", strict=True):
        half = RigidTransform(Rotation.from_rotvec(3.0 * axis).as_matrix(), truth.translation)
        assert confusion_of(half, truth, target) == f"half turn about {name}"
    third = RigidTransform(
        Rotation.from_rotvec(2.0 * np.ones(3) / np.sqrt(3.0)).as_matrix(), truth.translation
    )
    assert confusion_of(third, truth, target) == "other"

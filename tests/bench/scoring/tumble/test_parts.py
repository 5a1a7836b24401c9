"""A dataset whose estimates are wrong by known amounts gets the score that these amount to."""

import json
import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from rich.console import Console
from scipy.spatial.transform import Rotation

from bench import api
from bench.chains.catalogue import chain_named
from bench.estimating.runs import estimates_path
from bench.estimating.tumble.starts import chosen_starts, read_starts, starts_path, try_starts
from bench.report.summary import print_summary
from bench.scoring.score import read_score
from bench.scoring.tumble.judged_images import confusion_of, lit_landmarks
from models.dataset.dataset import open_dataset
from models.dataset.estimates_file import write_estimates
from models.errors import DatasetError
from models.estimate import Detections, Estimate, PoseEstimate
from models.motion.tumble import CAM_FROM_LVLH
from models.pose import RigidTransform
from models.spacecraft.wireframes import wireframe_by_name
from pipelines import registry
from tests.support.synthetic_images import write_images

FRAMES = 8
MOVED_M, TURNED_DEG = 0.05, 1.0
WRONG = (4, 5, 6)  # half a turn about z
LOST = 3  # after the first state, no pose
OFF_PX = 1.5  # of every second corner, along u
STAND_IN = "stand_in"
ROUNDING = 1e-6
ASKED = """
[asked]
starts_right = 0.5
median_position_m = 0.1
median_attitude_deg = 2.0
lost_share = 0.05
wrong_in_a_row = 3
"""


def corners(truth) -> Detections:
    """Return every visible landmark, every second one beside its place, and one of nothing."""
    points = truth.landmarks_px[truth.landmarks_visible].copy()
    points[::2, 0] += OFF_PX
    points = np.concatenate([points, [[3.0, 3.0]]])
    count = len(points)
    return Detections(points, np.full((count, 2), 0.5), (-1,) * count, (False,) * count)


def estimate(truth) -> Estimate:
    """Return what the stand-in of a pipeline says of one frame."""
    index, found = truth.frame, corners(truth)
    if index == 0:
        return Estimate(0, truth.time_s, reason="too dark", detections=found, mode="searching")
    axis = np.array([0.0, 0.0, np.pi]) if index in WRONG else np.deg2rad([TURNED_DEG, 0.0, 0.0])
    state = replace(
        truth.state,
        rho_in_lvlh=truth.state.rho_in_lvlh + np.array([MOVED_M, 0.0, 0.0]),
        R_lvlh_from_target=truth.state.R_lvlh_from_target @ Rotation.from_rotvec(axis).as_matrix(),
    )
    honest = np.diag(np.repeat([MOVED_M**2, 1.0], 3))
    turn = np.diag(np.repeat([np.deg2rad(TURNED_DEG) ** 2, 1.0], 3))
    said = Estimate(
        index, truth.time_s, detections=found, mode="tracked", states=state.named(honest, turn)
    )
    if index == LOST:
        return replace(said, reason="blurred", mode="predicted")
    pose = PoseEstimate(state.cam_from_target(CAM_FROM_LVLH), 1e-4 * np.eye(6), 0.5)
    return replace(said, pose=pose)


@pytest.fixture(scope="module")
def stand_in():
    """Have the stand-in known by name for as long as these tests run."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(registry.OURS, STAND_IN, "tests.support.stand_in_navigation")
        yield STAND_IN


@pytest.fixture(scope="module")
def written(tmp_path_factory, stand_in):
    dataset = write_images(tmp_path_factory.mktemp("tumble") / "data", frames=FRAMES, width_px=256)
    said = [estimate(truth) for truth in dataset.truths]
    for variant in ("best", "paper"):
        write_estimates(estimates_path(dataset.folder, 0, variant), said)
    (dataset.folder / "truth" / "scenario.toml").write_text(ASKED)
    try_starts(open_dataset(dataset.folder), starts=3, most_images=3, pipeline=stand_in)
    api.score(dataset.folder)
    return dataset


@pytest.fixture(scope="module")
def score(written):
    return read_score(written.folder)


@pytest.fixture(scope="module")
def best(score):
    return score["pipelines"]["best"]


def test_errors_are_those_put_in(best):
    core, state = best["core"], best["parts"]["state"]
    assert state["position_m"]["median"] == pytest.approx(MOVED_M, rel=ROUNDING)
    assert core["position_error_mm"]["median"] == pytest.approx(1e3 * MOVED_M, rel=ROUNDING)
    assert state["attitude_deg"]["median"] == pytest.approx(TURNED_DEG, rel=ROUNDING)
    assert core["attitude_error_deg"]["median"] == pytest.approx(TURNED_DEG, rel=ROUNDING)
    assert core["attitude_error_deg"]["p95"] == pytest.approx(180.0, rel=ROUNDING)
    assert state["velocity_m_s"]["median"] == 0.0
    assert state["raw_position_m"]["median"] == pytest.approx(MOVED_M, rel=ROUNDING)


def test_frames_without_a_pose_are_counted(best):
    core, state = best["core"], best["parts"]["state"]
    assert (core["frames"], core["estimated"], state["with_state"]) == (
        FRAMES,
        FRAMES - 1,
        FRAMES - 1,
    )
    assert state["first_state"] == 1
    assert core["lost"] == {
        "count": 2,
        "missed": 1,  # the first image came before there was a state
        "reasons": {"blurred": 1, "too dark": 1},
        "frames": [0, LOST],
    }
    assert state["lost_share"] == pytest.approx(1.0 / (FRAMES - 1))
    assert state["modes"] == {"searching": 1, "tracked": FRAMES - 2, "predicted": 1}


def test_wrong_states_are_counted_named_and_followed(best):
    count = len(WRONG)
    assert best["core"]["wrong"] == {"count": count, "longest": count, "frames": [*WRONG]}
    assert best["parts"]["state"]["confusions"] == {"half turn about z": count}


def test_an_honest_covariance_has_the_nees_of_its_error(best):
    """One axis wrong by one sigma, five right."""
    nees = best["parts"]["state"]["nees"]
    assert nees["translation"]["mean"] == pytest.approx(1.0 / 6.0, rel=ROUNDING)


def test_corners_are_found_where_they_are(written, best):
    visible = sum(int(truth.landmarks_visible.sum()) for truth in written.truths)
    found = best["parts"]["corners"]
    assert found["repeatability"] == 1.0
    assert found["precision"] == pytest.approx(visible / (visible + FRAMES))
    off = sum((int(truth.landmarks_visible.sum()) + 1) // 2 for truth in written.truths)
    # Where landmarks lie so near each other that another's corner is the nearer, it is less.
    assert found["rms_px"] <= OFF_PX * np.sqrt(0.5 * off / visible) + ROUNDING
    assert found["rms_px"] > 0.8 * OFF_PX * np.sqrt(0.5 * off / visible)


def test_checks_say_what_holds(best):
    holds = {check["what"]: check["holds"] for check in best["parts"]["asked"]}
    assert holds["median position error"] is True
    assert holds["median attitude error"] is True
    assert holds["frames lost once acquired"] is False
    assert holds["longest run of wrong poses"] is True
    assert "starts acquired rightly" in holds


def test_limits_share_out_all_frames(best):
    for name in ("visible landmarks", "sunlit share", "corners found"):
        own = [limit for limit in best["parts"]["limits"] if limit["of"] == name]
        assert sum(limit["frames"] for limit in own) == FRAMES
        spans = [limit["span"] for limit in own]
        assert all(a[1] <= b[0] for a, b in pairwise(spans))


def test_the_report_holds_everything(written):
    text = api.report(written.folder).read_text()
    assert text.count('src="data:image/jpeg;base64,') == 1 + FRAMES
    assert "half turn about z" in text
    assert "too dark" in text
    assert "does not hold" in text
    assert "https://" not in text
    assert "http://" not in text.replace("http://www.w3.org", "")
    (told,) = re.findall(r'id="explorer-data">(.*?)</script>', text, re.DOTALL)
    explored = json.loads(told)
    assert [plot["title"] for plot in explored["plots"]][-1] == "landmarks"
    (image,) = explored["image"]["streams"]
    assert len(image["pictures"]) == FRAMES
    assert all(layers[0]["sign"] == "lines" for layers in explored["true_layers"])
    assert explored["pipelines"]["best"]["layers"][1][-1]["name"] == "detections"


def test_the_summary_names_the_case_and_what_was_asked(score, capsys):
    headline = chain_named("tumble_images").headline(score)
    print_summary(Console(width=200), score, headline)
    said = capsys.readouterr().out
    assert "painted" in said
    assert "longest run of wrong poses" in said
    assert "repeatability" in said
    print_summary(Console(width=200), score)
    assert "position error, median" in capsys.readouterr().out


def test_estimates_of_other_frames_are_refused(written, tmp_path):
    dataset = write_images(tmp_path / "data", frames=2, width_px=128)
    write_estimates(estimates_path(dataset.folder, 0, "best"), [estimate(written.truths[0])])
    with pytest.raises(DatasetError, match="one estimate for each of the 2 frames"):
        api.score(dataset.folder)


def test_a_wireframe_of_another_target_is_refused(written, tmp_path):
    dataset = write_images(tmp_path / "data", frames=1, width_px=128)
    other = write_images(tmp_path / "other", frames=1, width_px=128, target_name="hispasat")
    write_estimates(estimates_path(dataset.folder, 0, "best"), [estimate(dataset.truths[0])])
    (dataset.folder / "wireframe.json").write_bytes((other.folder / "wireframe.json").read_bytes())
    with pytest.raises(DatasetError, match="the two halves are of different renders"):
        api.score(dataset.folder)


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
    scored = best["parts"]["starts"]
    assert scored["starts"] == 3
    assert scored["first_image"] == 0
    assert scored["within"] + scored["wrong"] + scored["none"] == 3


def test_trying_again_does_nothing_and_says_the_same(written, stand_in):
    before = starts_path(written.folder, "best").read_bytes()
    dataset = open_dataset(written.folder)
    try_starts(dataset, workers=2, starts=3, most_images=3, pipeline=stand_in)
    assert starts_path(written.folder, "best").read_bytes() == before


@pytest.mark.parametrize(
    "text",
    [
        '{"most_images": 3',
        '{"most_images": 3}',
        '{"most_images": 3, "starts": [{"frame": 0}]}',
        '{"most_images": 3, "starts": 5}',
        '{"most_images": 3, "starts": [7]}',
        '{"most_images": 3, "starts": [{"frame": 0, "images": 1, "pose_frame": 0,'
        ' "cam_from_target": [[1, 2], [3, 4]], "seconds": 1, "reason": ""}]}',
    ],
)  # fmt: skip
def test_damaged_starts_say_what_to_do(tmp_path, text):
    path = starts_path(tmp_path, "best")
    path.parent.mkdir(parents=True)
    path.write_text(text)
    with pytest.raises(DatasetError, match="delete it and estimate again"):
        read_starts(tmp_path, "best")
    assert read_starts(tmp_path, "paper") == (0, [])


def test_starts_of_other_frames_are_refused(written, tmp_path):
    dataset = write_images(tmp_path / "data", frames=1, width_px=128)
    write_estimates(estimates_path(dataset.folder, 0, "best"), [estimate(dataset.truths[0])])
    path = starts_path(dataset.folder, "best")
    path.parent.mkdir(parents=True)
    path.write_bytes(starts_path(written.folder, "best").read_bytes())
    with pytest.raises(DatasetError, match=r"expected frames of the dataset.*delete it"):
        api.score(dataset.folder)


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

"""The table holds what was judged, and comes back from CSV and JSON with every digit."""

import dataclasses
import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.scoring.judgement import TrueScene
from bench.scoring.limits import Limits
from bench.scoring.pairs.detections import visible_markers
from bench.scoring.pairs.judged_pairs import judge_alone
from bench.sweep.extremes import ranked, told
from bench.sweep.table import (
    LARGEST,
    VERDICTS,
    Row,
    Setting,
    judged_row,
    read_csv,
    read_json,
    setting_of,
    to_csv,
    to_json,
)
from models.camera import camera_preset
from models.errors import DatasetError
from models.frame import IMAGE_800, IMAGE_850
from models.lights.sun_grid import read_sun
from models.spacecraft.retroreflector_layout import RETROREFLECTORS
from tests.support.synthetic_dataset import (
    lost_estimate,
    perfect_estimate,
    true_exposure,
    true_pose,
)

NUMBERS = st.floats(-LARGEST, LARGEST)
PERCENT = st.floats(0.0, 100.0)
WORDS = st.text(st.characters(exclude_categories=["C", "Z"], include_characters=" "), max_size=12)
MAYBE = st.none() | NUMBERS
COUNTS = st.integers(0, 20)
ROWS = st.lists(
    st.builds(
        Row,
        **dict.fromkeys(("azimuth_deg", "elevation_deg", "time_s", "range_m"), NUMBERS),
        **dict.fromkeys(("exposure_ms", "lamp_w_sr"), NUMBERS),
        **dict.fromkeys(("sun", "sun_text", "pipeline", "reason"), WORDS),
        verdict=st.sampled_from(VERDICTS),
        **dict.fromkeys(("expected", "found", "mismatched", "used", "in_sun"), COUNTS),
        draws=st.integers(1, 20),
        **dict.fromkeys(("draws_without_pose", "draws_wrong", "draws_found"), COUNTS),
        **{f"position_{which}_mm": MAYBE for which in ("rms", "least", "most")},
        attitude_rms_deg=MAYBE,
        **dict.fromkeys(("position_error_mm", "attitude_error_deg", "position_sigma_mm"), MAYBE),
        **{f"error_{axis}_mm": MAYBE for axis in "xyz"},
        saturated_percent=st.fixed_dictionaries({IMAGE_800: PERCENT, IMAGE_850: PERCENT}),
    ),
    max_size=4,
)
CAMERA = camera_preset("chaser_fixed").resized(512)
TRUTH = true_exposure(0, 850, 12.0, true_pose(3.0, 0.0), CAMERA)
SCENE = TrueScene(CAMERA, RETROREFLECTORS, None, Limits())
MARKERS = visible_markers(TRUTH, CAMERA, RETROREFLECTORS)
SETTING = Setting(12.0, 3.0, 0.5, 12.0)


def judged(estimate, sun="S2", again=()):
    saturated = {IMAGE_800: 0.0, IMAGE_850: 1.5}
    along_m = None
    if estimate.pose is not None:
        along_m = estimate.pose.cam_from_target.translation - TRUTH.cam_from_target.translation
    alone = judge_alone(estimate, TRUTH, SCENE)
    others = [judge_alone(each, TRUTH, SCENE) for each in again]
    return judged_row(read_sun(sun), SETTING, "best", alone, along_m, saturated, others)


def with_pose(estimate, cam_from_target):
    pose = dataclasses.replace(estimate.pose, cam_from_target=cam_from_target)
    return dataclasses.replace(estimate, pose=pose)


@settings(max_examples=30)
@given(ROWS)
def test_rows_come_back_from_both_files(tmp_path_factory, rows):
    folder = tmp_path_factory.mktemp("table")
    (folder / "t.csv").write_text(to_csv(rows))
    (folder / "t.json").write_text(to_json(rows, {"case": "x"}))
    assert read_csv(folder / "t.csv") == rows
    assert read_json(folder / "t.json") == (rows, {"case": "x"})


def test_a_pipeline_that_tells_of_no_detections_is_judged_by_its_pose():
    silent = dataclasses.replace(perfect_estimate(TRUTH), detections=None)
    assert judged(silent).verdict == "all found"


def test_every_column_with_a_dimension_names_its_unit():
    units = ("_deg", "_s", "_m", "_ms", "_w_sr", "_mm", "_percent")
    for field in dataclasses.fields(Row):
        if "float" in str(field.type):
            assert field.name.endswith(units), field.name


def test_what_is_no_table_is_refused(tmp_path):
    path = tmp_path / "t.csv"
    for text in ("", "a,b\n1,2\n", to_csv([judged(lost_estimate(TRUTH))]).replace("12.0", "x")):
        path.write_text(text)
        if text:
            with pytest.raises(DatasetError, match="expected the table of a sweep"):
                read_csv(path)
    other = json.loads(to_json([], {})) | {"version": 99}
    path.write_text(json.dumps(other))
    with pytest.raises(DatasetError, match="another format or version"):
        read_json(path)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("12.0", "nan"), ("12.0", "1e999"), ("12.0", "1_2.0"), ("all found", "found"),
        (",0,", ",2.7,"), (",0,", ",-1,"), ("reason", "reasons"), ("S2", "S\x1b2"),
    ],
)  # fmt: skip
def test_a_cell_that_cannot_be_is_refused(tmp_path, old, new):
    path = tmp_path / "t.csv"
    text = to_csv([judged(perfect_estimate(TRUTH))])
    path.write_text("\ufeff" + text)
    assert len(read_csv(path)) == 1
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(DatasetError, match="expected the table of a sweep"):
        read_csv(path)


@pytest.mark.parametrize(
    ("key", "value"),
    [("time_s", "12"), ("time_s", True), ("used", 2.7), ("verdict", "x"), ("sun", 1)],
)
def test_a_value_that_cannot_be_is_refused(tmp_path, key, value):
    path = tmp_path / "t.json"
    table = json.loads(to_json([judged(perfect_estimate(TRUTH))], {}))
    table["rows"][0][key] = value
    path.write_text(json.dumps(table))
    with pytest.raises(DatasetError, match=rf"expected a sweep at .*rows\.0\.{key}"):
        read_json(path)


def test_a_perfect_estimate_finds_every_marker_and_has_no_error():
    row = judged(perfect_estimate(TRUTH))
    assert row.verdict == "all found"
    assert row.found == row.expected == int(MARKERS.expected.sum()) >= 8
    assert row.mismatched == 0
    assert row.position_error_mm == row.attitude_error_deg == 0.0
    assert (row.azimuth_deg, row.elevation_deg) == (270.0, 45.0)
    assert setting_of(row) == SETTING


def test_errors_are_the_pose_errors_along_the_cameras_axes():
    estimate = perfect_estimate(TRUTH)
    off = TRUTH.cam_from_target.perturbed([0.0, 0.0, 0.01], [0.003, 0.0, -0.004])
    row = judged(with_pose(estimate, off))
    assert (row.error_x_mm, row.error_y_mm, row.error_z_mm) == pytest.approx((3.0, 0.0, -4.0))
    assert row.position_error_mm == pytest.approx(5.0)
    assert row.attitude_error_deg == pytest.approx(math.degrees(0.01))
    assert row.verdict == "all found"  # the detections are true, the pose is not


def test_a_marker_missed_or_mistaken_is_counted():
    estimate = perfect_estimate(TRUTH)
    found = estimate.detections
    seen = np.flatnonzero(MARKERS.expected[list(found.marker)])
    fewer = dataclasses.replace(
        found, marker=tuple(-1 if k == seen[0] else m for k, m in enumerate(found.marker))
    )
    row = judged(dataclasses.replace(estimate, detections=fewer))
    assert (row.verdict, row.found, row.mismatched) == ("some missed", row.expected - 1, 0)
    swapped = list(found.marker)
    swapped[seen[0]], swapped[seen[1]] = swapped[seen[1]], swapped[seen[0]]
    mistaken = dataclasses.replace(found, marker=tuple(swapped))
    row = judged(dataclasses.replace(estimate, detections=mistaken))
    assert (row.verdict, row.found, row.mismatched) == ("some missed", row.expected - 2, 2)


def test_no_pose_has_a_reason_and_no_error():
    row = judged(lost_estimate(TRUTH, "only 2 markers"))
    assert (row.verdict, row.reason, row.found) == ("no pose", "only 2 markers", 0)
    assert row.position_error_mm is row.attitude_error_deg is row.error_x_mm is None


def test_harshest_is_no_pose_then_markers_missed_then_error():
    good = judged(perfect_estimate(TRUTH))
    off = dataclasses.replace(good, position_error_mm=3.0)
    missed = dataclasses.replace(good, draws_found=good.expected - 2, position_error_mm=0.1)
    lost = judged(lost_estimate(TRUTH))
    rows = [missed, good, lost, off]
    best, harshest = ranked(rows)
    assert (best, harshest) == ([good, off], [lost, missed])
    best, harshest = ranked([good])
    assert (best, harshest) == ([good], [])


def test_one_lucky_draw_makes_no_direction_kind():
    """The error is one draw; what orders is the markers found, and the error to be expected."""
    estimate = perfect_estimate(TRUTH)
    lucky, unlucky = judged(estimate), judged(estimate)
    sigma_mm = 1e3 * math.sqrt(np.trace(estimate.pose.covariance[3:, 3:]))
    assert lucky.position_sigma_mm == pytest.approx(sigma_mm)
    lucky = dataclasses.replace(lucky, position_error_mm=0.01, position_sigma_mm=2.0 * sigma_mm)
    unlucky = dataclasses.replace(unlucky, position_error_mm=1.0)
    assert ranked([lucky, unlucky]) == ([unlucky], [lucky])
    unsure = dataclasses.replace(unlucky, position_sigma_mm=None)
    lost = judged(lost_estimate(TRUTH))
    assert ranked([lost, unsure, lucky, unlucky])[0] == [unlucky, lucky]
    assert ranked([lost, unsure, lucky, unlucky])[1] == [lost, unsure]


def test_several_draws_rank_by_what_they_come_to():
    """A direction that is lost in one draw of three is harsher than any with all, however lucky."""
    estimate, lost = perfect_estimate(TRUTH), lost_estimate(TRUTH)
    off_mm = (1.0, 2.0, 2.0)
    off = [
        with_pose(estimate, TRUTH.cam_from_target.perturbed([0.0] * 3, [1e-3 * each, 0.0, 0.0]))
        for each in off_mm
    ]
    steady = judged(off[0], again=off[1:])
    assert (steady.draws, steady.draws_without_pose, steady.draws_wrong) == (3, 0, 0)
    assert steady.draws_found == 3 * steady.expected
    assert steady.position_rms_mm == pytest.approx(math.sqrt(3.0))
    assert (steady.position_least_mm, steady.position_most_mm) == pytest.approx((1.0, 2.0))
    lucky = judged(estimate, again=[lost, estimate])
    assert (lucky.draws_without_pose, lucky.position_rms_mm) == (1, 0.0)
    assert ranked([lucky, steady]) == ([steady], [lucky])
    better = judged(off[0], again=[off[0], off[1]])
    assert ranked([lucky, steady, better, judged(lost, again=[lost, lost])])[0] == [better, steady]
    assert "3 draws: no pose in 1 of 3 draws" in told(lucky)

"""Two datasets of one flight fused: their files are written here, without a renderer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from bench.fusing.fuse import fuse
from models.arm.hand_camera import HAND_FROM_TOOL, hand_from_chaser
from models.arm.house_arm import NEAR_DEG, house_arm
from models.arm.onboard_arm import ARM_FILE, ARM_JOINTS, OnboardArm, columns_of
from models.arrays import Floats
from models.dataset.dataset import Dataset
from models.dataset.description import DatasetInfo, Stream
from models.dataset.estimates_file import read_estimates, write_estimates
from models.dataset.frame_table import FrameEntry
from models.errors import DatasetError
from models.estimate import Estimate, PoseEstimate
from models.frame import TableReading
from models.onboard import OnboardKnowledge
from models.pose import RigidTransform
from models.spacecraft.grasp_markers import GRASPING_POINT_M
from pipelines.two_cameras.arm_chain import difference
from tests.support.half_written import left_half_written

ARM = house_arm()
JOINTS_DEG = np.array(NEAR_DEG, dtype=np.float64)
TIMES_S = (290.0, 300.0, 310.0)
CHASER_FROM_TARGET = RigidTransform(np.diag([1.0, -1.0, -1.0]), np.array([0.1, -0.8, 2.2]))
TO_GRASP = RigidTransform(np.eye(3), np.array(GRASPING_POINT_M))
HAND_FROM_TARGET = hand_from_chaser(ARM, JOINTS_DEG, HAND_FROM_TOOL) @ CHASER_FROM_TARGET @ TO_GRASP
COVARIANCE = 1e-6 * np.eye(6)


class Flight:
    """Stands for datasets on disk: what ``fuse`` opens, by folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.opened: dict[Path, Dataset] = {}
        self.joints: dict[Path, Floats] = {}

    def add(
        self,
        name: str,
        target: str,
        carries: bool,
        said: list[Estimate],
        joints_deg: Floats = JOINTS_DEG,
        times_s: tuple[float, ...] = TIMES_S,
    ) -> Path:
        place = self.folder / name
        onboard = OnboardArm(ARM, HAND_FROM_TOOL, carries).to_table()
        stream = Stream(ARM_JOINTS, "table", "arm_joints.csv", columns_of(ARM))
        info = DatasetInfo(name, "S1", len(times_s), target, "posed_images", (stream,), ())
        entries = [FrameEntry(n, time_s, 3.0) for n, time_s in enumerate(times_s)]
        dataset = Dataset(place, info, entries)
        dataset.__dict__["onboard"] = OnboardKnowledge(tables={ARM_FILE: onboard})
        self.opened[place], self.joints[place / "arm_joints.csv"] = dataset, joints_deg
        (place / "estimates").mkdir(parents=True)
        write_estimates(place / "estimates" / "best.jsonl", said)
        return place


def posed(pose: RigidTransform, blind: tuple[int, ...] = ()) -> list[Estimate]:
    return [
        Estimate(n, time_s, reason="in the dark")
        if n in blind
        else Estimate(n, time_s, PoseEstimate(pose, COVARIANCE))
        for n, time_s in enumerate(TIMES_S)
    ]


@pytest.fixture
def flight(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Flight:
    made = Flight(tmp_path)

    def table(path: Path, columns: tuple[str, ...], entries: list[FrameEntry]) -> object:
        row = made.joints[path][None]
        return {each.index: TableReading(columns, np.array([each.time_s]), row) for each in entries}

    monkeypatch.setattr("bench.fusing.fuse.open_dataset", lambda folder: made.opened[folder])
    monkeypatch.setattr("bench.fusing.fuse.read_table", table)
    return made


def test_the_frames_of_the_hand_get_poses_by_whoever_speaks(flight: Flight) -> None:
    hand = flight.add("hand", "maxar1300_grasp", True, posed(HAND_FROM_TARGET, blind=(1,)))
    chaser = flight.add("chaser", "maxar1300", False, posed(CHASER_FROM_TARGET, blind=(0,)))
    out = flight.folder / "fused.jsonl"
    fused = fuse(hand, chaser, out)
    assert fused.frames_by == {
        "by both cameras": 1,
        "by the hand camera alone": 1,
        "by the chaser-fixed camera alone": 1,
    }
    said = read_estimates(out)
    assert [each.mode for each in said] == ["hand", "chaser", "both"]
    for each in said:
        assert each.pose is not None
        away = difference(each.pose.cam_from_target, HAND_FROM_TARGET)
        np.testing.assert_allclose(away, 0.0, atol=1e-9)
    half = left_half_written(out)
    fuse(hand, chaser, out)  # what it wrote it may write again
    assert not half.exists()


def test_over_time_one_state_bridges_what_both_miss(flight: Flight) -> None:
    hand = flight.add("hand", "maxar1300_grasp", True, posed(HAND_FROM_TARGET, blind=(1, 2)))
    chaser = flight.add("chaser", "maxar1300", False, posed(CHASER_FROM_TARGET, blind=(2,)))
    out = flight.folder / "fused.jsonl"
    assert main(["fuse", str(hand), str(chaser), "--over-time", "--out", str(out)]) == 0
    said = read_estimates(out)
    assert [each.mode for each in said] == ["both", "chaser", "carried"]
    for each in said:
        assert each.pose is not None
        away = difference(each.pose.cam_from_target, HAND_FROM_TARGET)
        np.testing.assert_allclose(away, 0.0, atol=1e-7)
        assert "chaser_fixed_rates" in each.states
    sure = [np.trace(each.pose.stated_covariance) for each in said if each.pose is not None]
    assert sure == sorted(sure)


def test_what_are_no_two_cameras_of_one_flight_is_refused(flight: Flight) -> None:
    hand = flight.add("hand", "maxar1300_grasp", True, posed(HAND_FROM_TARGET))
    chaser = flight.add("chaser", "maxar1300", False, posed(CHASER_FROM_TARGET))
    other = flight.add(
        "other", "maxar1300", False, posed(CHASER_FROM_TARGET), joints_deg=JOINTS_DEG + 1.0
    )
    later = flight.add(
        "later", "maxar1300", False, posed(CHASER_FROM_TARGET), times_s=(1.0, 2.0, 3.0)
    )
    strange = flight.add("strange", "mine", False, posed(CHASER_FROM_TARGET))
    out = flight.folder / "fused.jsonl"
    for one, two, told in (
        (chaser, hand, "first a dataset of the hand camera"),
        (hand, other, "joints that are read otherwise"),
        (hand, later, "frames at the same times"),
        (hand, strange, "--origin-m"),
    ):
        with pytest.raises(DatasetError, match=told):
            fuse(one, two, out)
    with pytest.raises(DatasetError, match="expected estimates of paper, got none"):
        fuse(hand, chaser, out, "paper")
    theirs = flight.folder / "notes.txt"
    theirs.write_text("mine")
    with pytest.raises(DatasetError, match="got another file"):
        fuse(hand, chaser, theirs)
    assert theirs.read_text() == "mine"
    assert not out.exists()


def test_a_dataset_without_an_arm_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["fuse", str(tmp_path), str(tmp_path), "--out", str(tmp_path / "x.jsonl")]) == 2
    assert capsys.readouterr().err.count("\n") == 1

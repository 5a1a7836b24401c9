"""What ``docs/formats.md`` shows is read by what reads datasets and estimates."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from bench.estimating.foreign_estimates.reading import read_foreign_estimates
from bench.estimating.foreign_estimates.said_poses import Choices
from bench.estimating.runs import read_run
from models.arm.arm_file import own_arm
from models.dataset.dataset import open_dataset
from models.dataset.estimates_file import read_estimates, write_estimates
from models.dataset.image_file import encode_image
from models.errors import RvbenchError
from models.motion.relative_state import ROTATION, TRANSLATION, relative_state
from models.pose import RigidTransform
from models.spacecraft.own.description import KEYS, WIREFRAME_KEYS, description_of

HOUSE = Path(__file__).resolve().parents[2]
PAGE = (HOUSE / "docs" / "formats.md").read_text()
FENCE = re.compile(r"^```\w+ (?P<name>\S+)\n(?P<body>.*?)^```$", re.MULTILINE | re.DOTALL)
EXAMPLES = {match["name"]: match["body"] for match in FENCE.finditer(PAGE)}
SHARED = ("frames.csv", "camera.toml", "detector.toml")


def write_examples(folder: Path) -> tuple[Path, Path]:
    """Write the files of the page, and black images; return the datasets of pairs and images."""
    for name, text in EXAMPLES.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    images = folder / "images"
    for name in SHARED:
        (images / name).write_text(EXAMPLES[name])
    for home in (folder, images):
        dataset = open_dataset(home)
        camera = dataset.onboard.camera
        black = encode_image(np.zeros((camera.height, camera.width), np.uint16))
        for stream in dataset.info.image_streams:
            for index in dataset.indices:
                path = stream.path(home, index)
                path.parent.mkdir(exist_ok=True)
                path.write_bytes(black)
    return folder, images


@pytest.fixture
def folders(tmp_path) -> tuple[Path, Path]:
    return write_examples(tmp_path)


def test_every_block_is_a_file():
    assert PAGE.count("\n```") == 2 * len(EXAMPLES)
    assert len(EXAMPLES) >= 12


def test_the_datasets_are_read(folders):
    pairs, images = map(open_dataset, folders)
    assert pairs.onboard.markers is not None
    assert pairs.onboard.prior is not None
    assert images.onboard.wireframe is not None
    assert images.onboard.expectations is not None
    for dataset, streams in (
        (pairs, {"image_800", "image_850"}),
        (images, {"image", "chaser_orbit"}),
    ):
        dataset.check_images()
        frames = list(dataset.frames())
        assert [frame.index for frame in frames] == [0, 1]
        assert all(set(frame.readings) == streams for frame in frames)
    first = pairs.frame(0)
    assert first.image("image_800").time_s == pytest.approx(-0.033)
    assert images.frame(1).table("chaser_orbit").column("x_m") == pytest.approx([1093488.7])


def test_the_spacecraft_is_read_with_every_key(folders):
    described = description_of(
        tuple(EXAMPLES["own/probe.toml"].splitlines()), "probe.toml", folders[0]
    )
    table = tomllib.loads(EXAMPLES["own/probe.toml"])
    assert set(table) == {"name", "mesh", *KEYS}
    assert set(table["wireframe"]) == set(WIREFRAME_KEYS) - {"file"}
    assert described.unit_m == 0.001
    assert described.markers == "markers.toml"
    assert described.materials["my_paint"].diffuse.bands == (0.80, 0.81, 0.79)
    assert described.wireframe.edges == (("antenna_foot", "antenna_tip"),)


def test_the_estimates_are_of_that_dataset(folders):
    dataset = open_dataset(folders[0])
    mine, full = read_run(dataset, 0, "mine"), read_run(dataset, 0, "full")
    assert mine.estimates[0].pose is not None
    assert mine.estimates[1].reason == "too few markers"
    assert mine.runtime_ms == {0: 12.5, 1: 3.0}
    said = full.estimates[0]
    assert said.pose is not None
    assert said.pose.covariance is not None
    assert said.detected.marker == (3, -1)
    assert set(full.estimates[1].states) == {TRANSLATION, ROTATION}
    assert relative_state(full.estimates[1]) is not None


def test_the_estimates_are_what_we_would_write(folders, tmp_path):
    for name in ("mine", "full"):
        path = folders[0] / "estimates" / f"{name}.jsonl"
        again = tmp_path / "again.jsonl"
        write_estimates(again, read_estimates(path))
        shown, written = (each.read_text().count("\n") for each in (path, again))
        assert shown == written
        keys = [set(re.findall(r'"(\w+)":', each.read_text())) for each in (path, again)]
        assert keys[0] == keys[1]


@pytest.mark.parametrize(
    "name",
    [name for name in EXAMPLES if not name.startswith(("estimates/", "own/", "elsewhere/"))],
)
def test_each_file_matters(folders, name):
    """The tests above, tested: without any one of the files the datasets are not read."""
    (folders[0] / name).unlink()
    home = folders[1] if name.startswith("images/") else folders[0]
    with pytest.raises(RvbenchError):
        list(open_dataset(home).frames())


@pytest.mark.parametrize("name", [name for name in EXAMPLES if name.startswith("elsewhere/")])
def test_the_estimates_from_elsewhere_are_of_that_dataset(folders, name):
    whose = Choices(trajectory_of="target") if name.endswith("slam.txt") else Choices()
    read = read_foreign_estimates(folders[0] / name, open_dataset(folders[0]), choices=whose)
    places = [read.run.estimates[frame].pose.cam_from_target for frame in (0, 1)]
    for place, range_m in zip(places, (6.7, 6.65), strict=True):
        np.testing.assert_allclose(place.translation, [0.0, 0.1, range_m], atol=1e-12)
        np.testing.assert_allclose(place.rotation, np.diag([1.0, -1.0, -1.0]), atol=1e-12)
    assert not read.unsaid


def test_the_arm_is_read():
    lines = EXAMPLES["own/arm.toml"].splitlines()
    own = own_arm(lines, "arm.toml", RigidTransform.identity())
    assert [joint.name for joint in own.arm.joints] == ["shoulder", "elbow", "wrist"]
    assert own.arm.reach_m == pytest.approx(0.3 + 1.0 + np.hypot(0.8, 0.1))
    assert own.near_deg.tolist() == [0.0, 60.0, -90.0]

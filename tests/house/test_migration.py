"""Every key of an old ``score.json`` is named in ``docs/migration.md``, and is where that says."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from bench import api
from bench.estimating.runs import estimates_path
from bench.estimating.tumble.starts import starts_path
from models.dataset.estimates_file import write_estimates
from models.estimate import Detections, Estimate, PoseEstimate
from tests.support.synthetic_dataset import perfect_estimate, write_dataset, write_variant
from tests.support.synthetic_images import write_images

HOUSE = Path(__file__).resolve().parents[2]
PAGE = (HOUSE / "docs" / "migration.md").read_text()
OLD_KEYS = json.loads(Path(__file__).with_name("score_keys_of_version_1.json").read_text())
ROW = re.compile(r"^\| `([^`]+)` \| `([^`]+)` \|$", re.MULTILINE)
ASKED = "[asked]\nmedian_position_m = 1.0\n"


def moves(name: str) -> dict[str, str]:
    """Return new keys by old ones, as the page's section of a format has them."""
    section = PAGE.split(f"## `{name}`, version 1")[1].split("\n## ")[0]
    return dict(ROW.findall(section))


def moved(key: str, table: dict[str, str]) -> str | None:
    """Return where a key has gone: by its own row, or by that of the nearest table above it."""
    above = [old for old in table if key == old or key.startswith((f"{old}.", f"{old}[]"))]
    if not above:
        return None
    old = max(above, key=len)
    return table[old] + key.removeprefix(old)


@pytest.fixture(scope="module")
def scores(tmp_path_factory) -> dict[str, dict]:
    """Return a score of version 2 for each old format, with something to say of every part."""
    home = tmp_path_factory.mktemp("migration")
    pairs = write_dataset(home / "pairs", frames=3, width_px=128)
    for run in range(2):
        write_variant(pairs, "best", perfect_estimate, run)
    images = write_images(home / "images", frames=2, width_px=128)
    said = [
        Estimate(
            truth.frame, truth.time_s, PoseEstimate(truth.cam_from_target, np.eye(6)),
            detections=Detections.none(), mode="tracked",
            states=truth.state.named(np.eye(6), np.eye(6)),
        )
        for truth in images.truths
    ]  # fmt: skip
    write_estimates(estimates_path(images.folder, 0, "best"), said)
    (images.folder / "truth" / "scenario.toml").write_text(ASKED)
    start = {"frame": 0, "images": 0, "pose_frame": None, "cam_from_target": None,
             "reason": "dark", "seconds": 1.0}  # fmt: skip
    path = starts_path(images.folder, "best")
    path.parent.mkdir()
    path.write_text(json.dumps({"most_images": 5, "starts": [start]}))
    return {
        "rvbench-score": api.score(pairs.folder),
        "rvbench-tumble-score": api.score(images.folder),
    }


def is_there(score: dict, key: str) -> bool:
    """Tell whether a score has a key; of a list the first row answers."""
    value = score
    for step in key.split("."):
        name = "best" if step == "LABEL" else step.removesuffix("[]")
        if not isinstance(value, dict) or name not in value:
            return False
        value = value[name]
        if step.endswith("[]"):
            if not isinstance(value, list) or not value:
                return False
            value = value[0]
    return True


@pytest.mark.parametrize(
    ("name", "key"), [(name, key) for name, keys in OLD_KEYS.items() for key in keys]
)
def test_every_old_key_is_where_the_page_says(scores, name, key):
    new = moved(key, moves(name))
    assert new is not None, "docs/migration.md does not name it"
    assert is_there(scores[name], new), new


@pytest.mark.parametrize("name", OLD_KEYS)
def test_every_row_is_of_a_key_that_was(name):
    for old in moves(name):
        assert any(
            key == old or key.startswith((f"{old}.", f"{old}[]")) for key in OLD_KEYS[name]
        ) or (old.endswith("[]") and any(key.startswith(old) for key in OLD_KEYS[name])), old


def test_what_is_nowhere_is_seen(scores):
    """The tests above, tested."""
    score = scores["rvbench-score"]
    assert not is_there(score, "pipelines.LABEL.parts.efficiency.colour")
    assert not is_there(score, "pipelines.LABEL.per_frame[].colour")
    assert moved("pipelines.LABEL.colour", moves("rvbench-score")) is None

"""What is told on board may be wrong: a score is held against what is true, and knows the two."""

from dataclasses import replace

import numpy as np
import pytest

from bench.scoring.pairs.judged_pairs import read_true_dataset
from bench.scoring.score import score_dataset
from models.dataset.dataset import open_dataset
from models.dataset.marker_file import markers_to_toml, read_markers
from models.markers import MarkerPattern
from tests.support.synthetic_dataset import (
    SyntheticDataset,
    solved_estimate,
    write_dataset,
    write_variant,
)

SIGMA_PX = np.array([0.05, 0.05])
BOUND_KEYS = ("bound_position_mm", "bound_rotation_deg")


@pytest.fixture
def dataset(tmp_path) -> SyntheticDataset:
    written = write_dataset(tmp_path / "data", frames=4)
    rng = np.random.default_rng(2)
    write_variant(written, "best", lambda t: solved_estimate(written, t, SIGMA_PX, rng))
    return written


def tell_markers_times(dataset: SyntheticDataset, factor: float) -> None:
    """Have the markers on board lie so many times as far out as they truly do."""
    path = dataset.folder / "markers.toml"
    true = read_markers(path)
    told = MarkerPattern(
        true.names, factor * true.points_in_target, true.normals_in_target, true.radius_m
    )
    path.write_text(markers_to_toml(told))


def test_the_bound_is_of_the_true_markers(dataset):
    """Ten times as far apart they would fix the pose ten times as well: the bound knows better."""
    before = score_dataset(dataset.folder)["pipelines"]["best"]
    tell_markers_times(dataset, 10.0)
    told = score_dataset(dataset.folder)["pipelines"]["best"]
    for key in BOUND_KEYS:
        rows = [[row[key] for row in each["per_frame"]] for each in (before, told)]
        assert rows[0] == rows[1]
        assert np.min(rows[0]) > 0.0
    assert told["parts"] == before["parts"]
    assert told["core"] == before["core"]


def test_without_the_true_markers_those_on_board_stand_in(dataset):
    """Datasets from before they were written: what was surveyed was what is."""
    before = score_dataset(dataset.folder)["pipelines"]["best"]["parts"]["efficiency"]
    (dataset.folder / "truth" / "markers.toml").unlink()
    after = score_dataset(dataset.folder)["pipelines"]["best"]["parts"]["efficiency"]
    assert after == before
    tell_markers_times(dataset, 10.0)
    wrong = score_dataset(dataset.folder)["pipelines"]["best"]["parts"]["efficiency"]
    assert wrong["position"] > 2.0 * before["position"]
    assert wrong["attitude"] > 2.0 * before["attitude"]


def test_markers_that_are_truly_elsewhere_move_the_gate_with_them(dataset):
    true = read_true_dataset(open_dataset(dataset.folder))
    assert np.array_equal(true.pattern.points_in_target, dataset.pattern.points_in_target)
    path = dataset.folder / "truth" / "markers.toml"
    path.write_text(
        markers_to_toml(replace(dataset.pattern, radius_m=2.0 * dataset.pattern.radius_m))
    )
    wide = read_true_dataset(open_dataset(dataset.folder))
    radii = [frame.markers.radius_px for frame in (true.frames[0], wide.frames[0])]
    assert radii[1] == pytest.approx(2.0 * radii[0])

"""The depth that VSD casts itself is the depth that was rendered, chip for chip."""

import numpy as np
import pytest
import tomli_w

from bench import api
from bench.scoring.true_view import SCENE_DEPTH, true_view
from models.dataset.dataset import open_dataset
from tests.support.foreign_files import write_speed
from tests.support.said_truth import said_truth
from tests.support.tumble_scenario import tumble_table

SINGLE_PRECISION_M = 1e-4  # Mitsuba's rays at 30 m, and at grazing faces ten times that
OUTLINE_PX = 3  # of some hundred that the target covers


@pytest.fixture(scope="module")
def rendered(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rendered")
    (folder / "small.toml").write_text(tomli_w.dumps(tumble_table()))
    api.render(str(folder / "small.toml"), folder / "out", store=folder / "store")
    return folder / "out"


def test_our_depth_of_the_true_pose_is_the_rendered_one(rendered):
    view = true_view(open_dataset(rendered), 64)
    assert view.scene_depth_source == SCENE_DEPTH
    for index in view.dataset.indices:
        own = view.distances(view.truths[index].cam_from_target)
        was = view.scene_distances(index, own)
        assert ((own > 0) != (was > 0)).sum() <= OUTLINE_PX
        both = (own > 0) & (was > 0)
        assert both.sum() > 100
        assert np.percentile(np.abs(own - was)[both], 95) < SINGLE_PRECISION_M


def test_truth_is_perfect_where_it_was_rendered(rendered, tmp_path):
    class Said:
        entries = open_dataset(rendered).entries
        truths = tuple(true_view(open_dataset(rendered)).truths.values())

    path = write_speed(tmp_path / "truth.csv", said_truth(Said))
    _, table = api.score_estimates(rendered, path, tmp_path / "out.json", vsd_px=64)
    told = table["methods"]["truth"]["measures"]
    assert told["vsd"] == [0.0] * 10
    assert told["bop"] == {"ar_vsd": 1.0, "ar_mssd": 1.0, "ar_mspd": 1.0, "ar": 1.0}
    assert table["made_by"]["vsd"]["scene_depth"] == SCENE_DEPTH

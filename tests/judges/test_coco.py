"""COCO exports, loaded and evaluated by pycocotools and by faster-coco-eval."""

from __future__ import annotations

import contextlib
import io
import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from faster_coco_eval import COCO as FasterCoco
from faster_coco_eval import COCOeval_faster
from pycocotools import mask as masks
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

SPLITS = ("train", "val", "test")
KEPT = {
    "bbox": ("bbox",),
    "segm": ("segmentation",),
    "keypoints": ("keypoints",),
}
SIGMA = 0.05  # of each keypoint, as its share of the object's size; OKS leaves it to the user
MOVED_PX = 1.25
WITHIN = 1e-9  # pycocotools adds an epsilon to every precision; exponentials round
PERFECT = (0, 1, 2)  # stats: AP over all thresholds, at 0.50, at 0.75


def loaded(reader, path: Path):
    with contextlib.redirect_stdout(io.StringIO()):
        return reader(str(path))


def truth_as_results(path: Path, kind: str, moved_px: float = 0.0) -> list[dict]:
    results = []
    for told in json.loads(path.read_text())["annotations"]:
        own = {key: told[key] for key in ("image_id", "category_id", *KEPT[kind])}
        if kind == "keypoints":
            triples = np.reshape(own["keypoints"], (-1, 3))
            triples[triples[:, 2] > 0, 0] += moved_px
            own["keypoints"] = triples.ravel().tolist()
        results.append({**own, "score": 1.0})
    return results


def categories(path: Path) -> list[dict]:
    """Return the categories that a file has annotations of."""
    table = json.loads(path.read_text())
    there = {told["category_id"] for told in table["annotations"]}
    return [each for each in table["categories"] if each["id"] in there]


def evaluated(judge: str, path: Path, kind: str, category: dict, moved_px: float = 0.0):
    """Return an evaluation of truth as results, of one target: each has keypoints of its own."""
    results = truth_as_results(path, kind, moved_px)
    sigmas = np.full(len(category["keypoints"]), SIGMA)
    with contextlib.redirect_stdout(io.StringIO()):
        if judge == "pycocotools":
            truth = COCO(str(path))
            evaluation = COCOeval(truth, truth.loadRes(results), kind)
            evaluation.params.kpt_oks_sigmas = sigmas
        else:
            truth = FasterCoco(str(path))
            said = truth.loadRes(results)
            evaluation = COCOeval_faster(truth, said, kind, kpt_oks_sigmas=sigmas)
        evaluation.params.catIds = [category["id"]]
        evaluation.evaluate()
        evaluation.accumulate()
        evaluation.summarize()
    return evaluation


@pytest.mark.parametrize("judge", ["pycocotools", "faster-coco-eval"])
@pytest.mark.parametrize("kind", list(KEPT))
@pytest.mark.parametrize("split", SPLITS)
def test_truth_as_results_is_perfect(judge, kind, split, exported):
    path = exported("coco") / "annotations" / f"{split}.json"
    for category in categories(path):
        stats = evaluated(judge, path, kind, category).stats
        assert [stats[k] for k in PERFECT] == pytest.approx([1.0] * 3, abs=WITHIN), category["name"]


def test_all_targets_at_once_are_perfect_too(exported):
    path = exported("coco") / "annotations" / "train.json"
    assert len(categories(path)) == 2
    for kind in ("bbox", "segm"):
        with contextlib.redirect_stdout(io.StringIO()):
            truth = COCO(str(path))
            evaluation = COCOeval(truth, truth.loadRes(truth_as_results(path, kind)), kind)
            evaluation.evaluate()
            evaluation.accumulate()
            evaluation.summarize()
        assert evaluation.stats[0] == pytest.approx(1.0, abs=WITHIN)


@pytest.mark.parametrize("split", SPLITS)
def test_keypoints_moved_by_a_known_amount_give_the_oks_that_follows(split, exported):
    path = exported("coco") / "annotations" / f"{split}.json"
    annotations = json.loads(path.read_text())["annotations"]
    for category in categories(path):
        evaluation = evaluated("pycocotools", path, "keypoints", category, MOVED_PX)
        for told in (each for each in annotations if each["category_id"] == category["id"]):
            # Object keypoint similarity, cocodataset.org: exp(-d^2 / (2 s^2 k^2)), k = 2 sigma,
            # s^2 the area; alike for all points when all are moved alike.
            expected = np.exp(-(MOVED_PX**2) / (2.0 * told["area"] * (2.0 * SIGMA) ** 2))
            found = evaluation.ious[told["image_id"], category["id"]]
            assert found.shape == (1, 1)
            assert found[0, 0] == pytest.approx(expected, abs=WITHIN)


def test_the_other_judge_counts_moved_keypoints_alike(exported):
    path = exported("coco") / "annotations" / "train.json"
    for category in categories(path):
        one = evaluated("pycocotools", path, "keypoints", category, MOVED_PX).stats
        other = evaluated("faster-coco-eval", path, "keypoints", category, MOVED_PX).stats
        assert one[0] < 1.0
        assert np.allclose(one[:10], other[:10], atol=WITHIN)


@pytest.mark.parametrize("split", SPLITS)
def test_masks_boxes_and_areas_are_one_anothers(split, exported):
    folder = exported("coco")
    truth = loaded(COCO, folder / "annotations" / f"{split}.json")
    assert truth.anns
    for told in truth.anns.values():
        run_lengths = told["segmentation"]
        assert masks.area(run_lengths) == told["area"]
        assert masks.toBbox(run_lengths).tolist() == told["bbox"]
        image = truth.imgs[told["image_id"]]
        pixels = cv2.imread(str(folder / "images" / image["file_name"]), -1)
        assert pixels.shape == (image["height"], image["width"])
        assert truth.annToMask(told).shape == pixels.shape


@pytest.mark.parametrize("split", SPLITS)
def test_keypoints_are_counted_and_lines_join_them(split, exported):
    truth = loaded(COCO, exported("coco") / "annotations" / f"{split}.json")
    for told in truth.anns.values():
        category = truth.cats[told["category_id"]]
        triples = np.reshape(told["keypoints"], (-1, 3))
        assert len(triples) == len(category["keypoints"])
        assert told["num_keypoints"] == (triples[:, 2] > 0).sum()
        assert set(triples[:, 2]) <= {0, 1, 2}
        assert not triples[triples[:, 2] == 0].any()
        joined = np.array(category["skeleton"]).reshape(-1, 2)
        assert ((joined >= 1) & (joined <= len(triples))).all()

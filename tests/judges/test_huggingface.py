"""Hugging Face exports, opened offline by ``datasets``; their card, judged by ``mlcroissant``."""

from __future__ import annotations

import csv
import json
import os

os.environ["HF_HUB_OFFLINE"] = os.environ["HF_DATASETS_OFFLINE"] = "1"  # before they are imported

import datasets
import mlcroissant
import numpy as np
import pytest
from pycocotools import mask as masks

NOT_SAID = ("citeAs", "datePublished")
SPLITS = {"train": "train", "val": "validation", "test": "test"}


@pytest.fixture(scope="module")
def folder(exported):
    return exported("huggingface")


@pytest.fixture(scope="module")
def opened(folder, tmp_path_factory):
    datasets.disable_progress_bars()
    return datasets.load_dataset(str(folder), cache_dir=str(tmp_path_factory.mktemp("cache")))


@pytest.fixture(scope="module")
def labels(folder):
    with (folder / "tables" / "labels.csv").open() as file:
        return {row["key"]: row for row in csv.DictReader(file)}


def test_every_image_is_in_its_split(opened, labels):
    counted = {ours: sum(row["split"] == ours for row in labels.values()) for ours in SPLITS}
    assert {SPLITS[name]: count for name, count in counted.items()} == {
        name: len(rows) for name, rows in opened.items()
    }


def test_rows_are_the_labels(opened, labels):
    seen = 0
    for rows in opened.values():
        for row in rows:
            pixels = np.asarray(row["image"])
            assert pixels.shape == (row["height"], row["width"])
            assert pixels.max() > 255  # the detector's own numbers
            label = labels[f"{row['scene']:06d}_{row['frame']:06d}_{row['stream']}"]
            assert row["target"] == label["target"]
            assert row["range_m"] == float(label["range_m"])
            assert row["t_cam_from_target_m"] == [
                float(label[f"t{axis}_m_cam_from_target"]) for axis in "xyz"
            ]
            assert len(row["keypoints_px"]) == 2 * len(row["keypoint_states"])
            seen += 1
    assert seen == len(labels)


def test_masks_are_cocos(opened):
    for rows in opened.values():
        for row in rows:
            packed = {"size": [row["height"], row["width"]], "counts": row["mask_visible"]}
            x0, y0, x1, y1 = row["box_visible_px"]
            assert masks.toBbox(packed).tolist() == [x0, y0, x1 - x0 + 1, y1 - y0 + 1]


def test_the_description_holds_no_fault(folder):
    described = mlcroissant.Dataset(jsonld=str(folder / "croissant.json"))
    issues = described.metadata.ctx.issues
    assert not issues.errors
    # An export says no day and no paper: the same command makes the same bytes.
    left = [told for told in issues.warnings if not any(name in str(told) for name in NOT_SAID)]
    assert not left


def test_records_are_read_through_the_description(folder):
    described = mlcroissant.Dataset(jsonld=str(folder / "croissant.json"))
    for record_set in described.metadata.record_sets:
        count = 0
        for record in described.records(record_set.uuid):
            names = {name.rpartition("/")[2] for name in record}
            assert {"file_name", "range_m", "t_cam_from_target_m"} <= names
            count += 1
        assert count
    table = json.loads((folder / "croissant.json").read_text())
    assert len(table["recordSet"]) == len(described.metadata.record_sets) > 0

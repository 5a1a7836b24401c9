"""BOP shards, read by the package that the format is named after."""

from __future__ import annotations

import io
import json

import cv2
import numpy as np
import pytest
import webdataset
from PIL import Image

STREAMS = ("image_800", "image_850", "image")
PARTS = {
    "gray.tiff", "depth.png", "camera.json", "gt.json", "gt_info.json", "mask.json",
    "mask_visib.json",
}  # fmt: skip


def places(folder):
    return sorted(path.parent for path in folder.glob("*/key_to_shard.json"))


def samples(place):
    shards = sorted(map(str, place.glob("shard-*.tar")))
    return list(webdataset.WebDataset(shards, shardshuffle=False, empty_check=False))


def mask_of(run_lengths):
    """Return the mask of COCO's plain run lengths: down the columns, the first of what is not."""
    counts = run_lengths["counts"]
    height, width = run_lengths["size"]
    flat = np.repeat(np.arange(len(counts)) % 2, counts)
    return flat.reshape((width, height)).T.astype(bool)


def test_every_sample_is_whole_and_where_the_index_says(exported):
    folder = exported("webdataset")
    seen = 0
    for place in places(folder):
        index = json.loads((place / "key_to_shard.json").read_text())
        found = samples(place)
        assert {own["__key__"] for own in found} == set(index)
        for own in found:
            assert set(own) - {"__key__", "__url__", "__local_path__"} == PARTS
            assert own["__url__"].endswith(f"shard-{index[own['__key__']]:06d}.tar")
        seen += len(found)
    assert seen == 5 * 2 + 4


def test_images_labels_and_masks_of_a_sample_agree(exported):
    for place in places(exported("webdataset")):
        for own in samples(place):
            image = np.asarray(Image.open(io.BytesIO(own["gray.tiff"])))
            depth = cv2.imdecode(np.frombuffer(own["depth.png"], np.uint8), -1)
            (pose,), (info,) = json.loads(own["gt.json"]), json.loads(own["gt_info.json"])
            visible = mask_of(json.loads(own["mask_visib.json"])["0"])
            assert image.shape == depth.shape == visible.shape
            assert image.dtype == np.uint8
            assert visible.sum() == info["px_count_visib"]
            turn = np.reshape(pose["cam_R_m2c"], (3, 3))
            assert np.allclose(turn @ turn.T, np.eye(3), atol=1e-12)
            assert (depth[visible] > 0).all()


def test_webdatasets_own_decoder_reads_the_tables(exported):
    (place, *_) = places(exported("webdataset"))
    shards = sorted(map(str, place.glob("shard-*.tar")))
    read = webdataset.WebDataset(shards, shardshuffle=False, empty_check=False).decode()
    for own in read:
        assert len(own["camera.json"]["cam_K"]) == 9
        assert own["gt.json"][0]["obj_id"] in (1, 2)


@pytest.mark.parametrize("split", ["train", "val", "test"])
def test_streams_of_a_frame_share_its_key(split, exported):
    folder = exported("webdataset")
    keys = {
        stream: set(json.loads((folder / f"{split}_{stream}" / "key_to_shard.json").read_text()))
        for stream in STREAMS
    }
    assert keys["image_800"] == keys["image_850"]
    assert not keys["image"] & keys["image_800"]

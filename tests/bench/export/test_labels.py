"""Labels against the truth that they come from, and with something standing before the target."""

from __future__ import annotations

import json
import shutil

import cv2
import numpy as np
import pytest

from bench.export.labels import label_of
from bench.export.plan import make_plan
from bench.export.silhouette import silhouette
from bench.export.source import open_source
from models.dataset.image_file import read_image


def labelled(folder, number: int = 0):
    plan = make_plan([open_source(1, folder)], (1.0, 0.0, 0.0), 0, 1)
    shot = plan.shots[number]
    return plan, label_of(plan, shot, read_image(plan.image_path(shot)))


def test_masks_are_the_labels_of_the_ray_tracer(tumble):
    for number in range(3):
        _, label = labelled(tumble, number)
        parts = cv2.imread(str(tumble / "truth" / "labels" / f"{number:06d}.png"), -1)
        assert (label.visible == (parts > 0)).all()
        assert (label.full == label.visible).all()
        record = label.record
        assert record.full == record.visible
        assert record.visible_fraction == 1.0
        assert record.valid == record.visible.count > 100


def test_our_silhouette_is_that_of_the_ray_tracer(tumble):
    for number in range(3):
        plan, label = labelled(tumble, number)
        target, pose = plan.sources[0].target, label.record.cam_from_target
        alone = silhouette(target.vertices, target.faces, plan.sources[0].camera, pose)
        assert (alone.inside != label.visible).sum() <= 2  # of rays along an edge
        assert abs(alone.count - label.record.full.count) <= 2


def test_what_the_chaser_hides_is_of_the_silhouette(tumble, tmp_path):
    """A bar is drawn before the target, as the chaser would be: nothing else changes."""
    _, free = labelled(tumble)
    shutil.copytree(tumble, tmp_path / "data")
    path = tmp_path / "data" / "truth" / "labels" / "000000.png"
    parts = json.loads((tmp_path / "data" / "truth" / "parts.json").read_text())
    image = cv2.imread(str(path), -1)
    columns = np.nonzero(image)[1]
    middle = int(np.median(columns))
    image[:, middle - 1 : middle + 2] = parts.index("chaser") + 1
    cv2.imwrite(str(path), image)
    _, hidden = labelled(tmp_path / "data")
    assert (hidden.full != free.full).sum() <= 2
    assert not hidden.visible[:, middle - 1 : middle + 2].any()
    lost = free.visible[:, middle - 1 : middle + 2].sum()
    assert lost > 10
    assert hidden.record.visible_fraction == pytest.approx(
        1.0 - lost / free.record.full.count, abs=0.01
    )
    assert hidden.record.full.box == free.record.full.box


def test_keypoints_agree_with_what_was_sealed(tumble):
    sealed = [
        json.loads(x) for x in (tumble / "truth" / "exposures.jsonl").read_text().splitlines()
    ]
    for number, own in enumerate(sealed):
        _, label = labelled(tumble, number)
        record = label.record
        assert np.array(record.keypoints_px) == pytest.approx(np.array(own["landmarks_px"]))
        seen = [state in ("visible", "shadow") for state in record.keypoint_states]
        assert seen == own["landmarks_visible"]
        assert record.range_m == pytest.approx(np.linalg.norm(own["t_cam_from_target_m"]))
    assert {"visible", "hidden"} <= set(record.keypoint_states)


def test_without_pixel_truth_the_silhouette_stands_in(pairs):
    plan, label = labelled(pairs)
    assert not plan.sources[0].camera_is_true
    assert label.depth_m is None
    assert (label.full == label.visible).all()
    assert label.record.full.count > label.visible.sum() > 0  # it reaches out of the image
    assert set(label.record.keypoint_states) <= {"visible", "outside", "hidden"}
    assert len(label.record.keypoint_states) == 10


def test_phase_angle_and_range(tumble):
    _, label = labelled(tumble)
    record, pose = label.record, label.record.cam_from_target
    lens = pose.inverse().translation
    cosine = lens @ record.sun_dir_in_target / np.linalg.norm(lens)
    assert np.cos(np.deg2rad(record.phase_angle_deg)) == pytest.approx(cosine)

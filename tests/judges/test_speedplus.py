"""SPEED+ exports, read by a loader written from the format's public description alone.

Kisantal et al. 2020 and Park et al. 2022 describe it: ``q_vbs2tango`` is scalar-first and of the
passive rotation from the camera (vbs) to the target, ``r_Vo2To_vbs`` is in m and in the camera's
axes; points go through the transposed direction cosine matrix, then Brown's distortion, then
``cameraMatrix``.
"""

from __future__ import annotations

import csv
import json

import cv2
import numpy as np
import pytest
from scipy.io import loadmat

from tests.judges.command import SPLIT, rvbench

REPROJECTED_PX = 0.01
LISTS = {"train": "train.json", "val": "validation.json", "test": "test.json"}


def direction_cosines(q):
    """Return the passive direction cosine matrix of a scalar-first quaternion."""
    q0, q1, q2, q3 = q / np.linalg.norm(q)
    return np.array(
        [
            [2 * q0**2 - 1 + 2 * q1**2, 2 * q1 * q2 + 2 * q0 * q3, 2 * q1 * q3 - 2 * q0 * q2],
            [2 * q1 * q2 - 2 * q0 * q3, 2 * q0**2 - 1 + 2 * q2**2, 2 * q2 * q3 + 2 * q0 * q1],
            [2 * q1 * q3 + 2 * q0 * q2, 2 * q2 * q3 - 2 * q0 * q1, 2 * q0**2 - 1 + 2 * q3**2],
        ]
    )


def project_keypoints(q, r, camera, points):
    """Return where (3, n) points of the target fall, (2, n) px."""
    x, y, z = direction_cosines(q).T @ points + np.reshape(r, (3, 1))
    x, y = x / z, y / z
    k1, k2, p1, p2, k3 = camera["distCoeffs"]
    r2 = x**2 + y**2
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    across = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x**2)
    down = y * radial + p1 * (r2 + 2 * y**2) + 2 * p2 * x * y
    (fx, _, cx), (_, fy, cy), _ = camera["cameraMatrix"]
    return np.stack([fx * across + cx, fy * down + cy])


@pytest.fixture(scope="module", params=["xmm", "maxar", "hundred"])
def loaded(request, tmp_path_factory):
    data = request.getfixturevalue(request.param)
    out = tmp_path_factory.mktemp("speedplus") / "out"
    rvbench("export", data, "--as", "speedplus", "--split", *SPLIT, "--check", "--out", out)
    lists = {
        split: json.loads((out / "synthetic" / name).read_text()) for split, name in LISTS.items()
    }
    return out, json.loads((out / "camera.json").read_text()), lists


def test_keypoints_reproject(loaded):
    out, camera, lists = loaded
    points = loadmat(out / "tangoPoints.mat")["tango3Dpoints"]
    with (out / "tables" / "keypoints.csv").open() as file:
        told: dict[str, list] = {}
        for row in csv.DictReader(file):
            told.setdefault(row["key"], []).append(row)
    images = compared = 0
    for each in (own for rows in lists.values() for own in rows):
        q, r = np.array(each["q_vbs2tango_true"]), np.array(each["r_Vo2To_vbs_true"])
        projected = project_keypoints(q, r, camera, points)
        rows = told[each["filename"].removesuffix(".png")]
        assert len(rows) == points.shape[1]
        for at, row in zip(projected.T, rows, strict=True):
            if row["state"] != "outside":
                apart = np.hypot(at[0] - float(row["x_px"]), at[1] - float(row["y_px"]))
                assert apart < REPROJECTED_PX
                compared += 1
        images += 1
    assert images == len(told)
    assert compared > 5 * images


def test_images_and_masks_are_there(loaded):
    out, camera, lists = loaded
    for split, rows in lists.items():
        assert rows, split
        for each in rows:
            image = cv2.imread(str(out / "synthetic" / "images" / each["filename"]), -1)
            mask = cv2.imread(str(out / "synthetic" / "masks" / each["filename"]), -1)
            assert image.shape == mask.shape == (camera["Nv"], camera["Nu"])
            assert image.dtype == np.uint8
            assert set(np.unique(mask)) <= {0, 255}


def test_the_camera_is_one_in_metres_and_in_pixels(loaded):
    _, camera, _ = loaded
    (fx, _, cx), (_, fy, cy), _ = camera["cameraMatrix"]
    assert camera["fx"] / camera["ppx"] == pytest.approx(fx, rel=1e-12)
    assert camera["fy"] / camera["ppy"] == pytest.approx(fy, rel=1e-12)
    assert (camera["ccx"], camera["ccy"]) == (cx, cy)
    half = np.arctan(0.5 * camera["Nu"] / fx)
    assert camera["horizontalFOV"] == pytest.approx(np.rad2deg(2.0 * half))

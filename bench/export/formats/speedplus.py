"""SPEED+: image lists with a pose each, a camera in metres, masks, and the target's keypoints.

::

    OUT/camera.json, tangoPoints.mat, keypoints.json
        synthetic/train.json, validation.json, test.json
            images/000001_000000.png, masks/000001_000000.png

The quaternion of ``q_vbs2tango_true`` is scalar-first; as SPEED+'s own tools use it (passive, and
transposed to project), it is that of ``R_cam_from_target``: ``x_cam = R x_target + r``, m. The
camera's matrix has integer pixel centres. One target and one camera an export.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.io import savemat
from scipy.spatial.transform import Rotation

from bench.export.formats.bop import mask_png
from bench.export.formats.format import Files, Format, Streamed
from bench.export.formats.speedplus_check import check_speedplus
from bench.export.json_stream import items, whole
from bench.export.labels import Label
from bench.export.picture import Picture
from bench.export.plan import UNLABELLED, Plan
from bench.export.record import Record
from bench.export.records import Records
from models.errors import ScenarioError

NAME = "speedplus"
LISTS = {"train": "train.json", "val": "validation.json", "test": "test.json"}
PITCH_UM = 5.86  # of SPEED+'s own camera, where no detector is on board
MAT_HEAD = b"MATLAB 5.0 MAT-file: the target's keypoints, 3 x n, m".ljust(116)


def exposure(plan: Plan, label: Label, picture: Picture) -> Files:
    """Return the image and the mask of what is seen of the target.

    Parameters
    ----------
    plan : Plan
    label : Label
    picture : Picture
    """
    record = label.record
    if record.split == UNLABELLED:
        return {f"unlabelled/images/{record.key}.png": picture.png}
    files = {f"synthetic/images/{record.key}.png": picture.png}
    if label.visible is not None:
        files[f"synthetic/masks/{record.key}.png"] = mask_png(label.visible)
    return files


def finish(records: Records) -> Streamed:
    """Return camera, keypoints and lists."""
    plan = records.plan
    first = next((r for r in records.of() if r.camera is not None), None)
    if first is not None:
        yield "camera.json", whole(camera_table(first, _pitch_m(plan)))
    target = plan.targets()[0][1].target
    if target is not None and len(target.keypoints):
        points = target.keypoints.points_in_target
        yield "tangoPoints.mat", [mat_file(points.T)]
        table = {"names": list(target.keypoints.names), "points_in_target_m": points.tolist()}
        yield "keypoints.json", whole(table)
    for split, name in LISTS.items():
        if split in plan.splits:
            yield f"synthetic/{name}", items(_labels(records.of(split)))


def camera_table(record: Record, pitch_m: float) -> dict[str, Any]:
    """Return ``camera.json``: focal lengths in m, the matrix in px.

    Parameters
    ----------
    record : Record
    pitch_m : float, m
        Of a pixel.
    """
    assert record.camera is not None
    fx, fy, cx, cy = record.camera
    return {
        "Nu": record.width,
        "Nv": record.height,
        "ppx": pitch_m,
        "ppy": pitch_m,
        "fx": fx * pitch_m,
        "fy": fy * pitch_m,
        "ccx": cx,
        "ccy": cy,
        "cameraMatrix": [[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]],
        "distCoeffs": record.distortion,
        "horizontalFOV": float(np.rad2deg(2.0 * np.arctan(0.5 * record.width / fx))),
    }


def mat_file(points: Any) -> bytes:
    """Return (3, n) points as a MATLAB file that says no time and no machine."""
    stream: Any = io.BytesIO()
    savemat(stream, {"tango3Dpoints": np.ascontiguousarray(points)})
    return MAT_HEAD + stream.getvalue()[len(MAT_HEAD) :]


def refuse(plan: Plan) -> None:
    """Refuse what one ``camera.json`` and one set of keypoints cannot tell.

    Raises
    ------
    ScenarioError
        If there are several targets, or cameras that differ.
    """
    if len(plan.object_ids) > 1:
        raise ScenarioError(
            f"expected datasets of one target for --as {NAME}, got {', '.join(plan.object_ids)}; "
            "export each target's datasets on their own"
        )
    cameras = {source.camera for source in plan.sources if source.camera is not None}
    if len(cameras) > 1:
        raise ScenarioError(
            f"expected datasets of one camera for --as {NAME}, whose camera.json is one, got "
            f"{len(cameras)}; export each camera's datasets on their own"
        )


def _labels(records: Iterator[Record]) -> Iterator[dict[str, Any]]:
    for record in records:
        pose = record.cam_from_target
        if pose is None or record.translation_m is None:
            continue
        wxyz = Rotation.from_matrix(pose.rotation).as_quat(canonical=True, scalar_first=True)
        yield {
            "filename": f"{record.key}.png",
            "q_vbs2tango_true": wxyz.tolist(),
            "r_Vo2To_vbs_true": record.translation_m,
        }


def _pitch_m(plan: Plan) -> float:
    detector = plan.sources[0].dataset.onboard.detector
    return 1e-6 * (PITCH_UM if detector is None else detector.pixel_pitch_um)


FORMAT = Format(NAME, "SPEED+ (image lists, masks)", 8, exposure, finish, check_speedplus, refuse)

"""One exposure's label, from a dataset's public half and its truth: what every format begins with.

Masks come from the part labels that renders leave at pixel centres. What stands before the target,
or lies beyond the image's edge, is added from its silhouette, where the labels cannot tell.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.export.keypoints import HALF, projected, states_of
from bench.export.plan import Plan, Shot
from bench.export.record import MaskRecord, Record
from bench.export.run_lengths import run_lengths
from bench.export.silhouette import box_of, silhouette
from bench.export.source import Source, TargetModel
from bench.export.sunlight import sunlit
from bench.export.truth_lines import SealedExposure
from models.arrays import AnyArray, Floats, Labels, Mask, Radiance
from models.camera import Camera
from models.dataset.image_file import decoded_png, png_size
from models.errors import DatasetError
from models.pose import RigidTransform
from models.reading.regular_file import read_bytes
from renders.store.sealed_exr import read_exr

MOST_LABEL_BYTES = 300_000_000
EDGE_PX = 1.0  # a target whose corners are all so far within the image is whole in it


@dataclass(frozen=True, eq=False)
class Label:
    """What is true of one image.

    Attributes
    ----------
    record : Record
    full, visible : (height, width) arrays of bool, or None
        The target's silhouette within the image, and what of it is seen.
    depth_m : (height, width) float32 array or None, m
        Along the boresight, of whatever is seen; 0 in space.
    """

    record: Record
    full: Mask | None
    visible: Mask | None
    depth_m: Radiance | None


def label_of(plan: Plan, shot: Shot, image: AnyArray) -> Label:
    """Return the label of an image.

    Parameters
    ----------
    plan : Plan
    shot : Shot
    image : (height, width) or (height, width, 3) array
        As it leaves.

    Raises
    ------
    DatasetError
        If a file of the truth half is damaged, or does not fit the image.
    """
    source, entry = plan.source(shot), plan.source(shot).dataset.entry(shot.frame)
    name = plan.image_path(shot).stem
    sealed = source.truth.get(name)
    pose = None if sealed is None else sealed.cam_from_target
    camera = source.camera
    full = visible = depth = full_record = visible_record = None
    points_px: Floats = np.empty((0, 2))
    states: tuple[str, ...] = ()
    if pose is not None and camera is not None:
        labels, depth = _pixel_truth(source, name, (camera.height, camera.width))
        full_record, full, visible = _masks(source, labels, camera, pose)
        if visible is not None:
            visible_record = MaskRecord(run_lengths(visible), int(visible.sum()), box_of(visible))
        if source.target is not None and sealed is not None:
            points_px = projected(source.target.keypoints, camera, pose)
            states = _states(source.target, sealed, points_px, camera)
    record = Record(
        key=shot.key,
        scene=shot.scene,
        frame=shot.frame,
        stream=shot.stream,
        split=shot.split,
        time_s=entry.time_s + plan.stream(shot).offset_s if sealed is None else sealed.time_s,
        exposure_ms=entry.exposure_ms,
        width=int(image.shape[1]),
        height=int(image.shape[0]),
        channels=1 if image.ndim == 2 else int(image.shape[2]),
        camera=None if camera is None else [camera.fx, camera.fy, camera.cx, camera.cy],
        distortion=[0.0] * 5 if camera is None else camera.distortion.tolist(),
        object_id=None if pose is None else plan.object_ids[source.dataset.info.target],
        rotation=None if pose is None else pose.rotation.ravel().tolist(),
        translation_m=None if pose is None else pose.translation.tolist(),
        sun_dir_in_target=None
        if sealed is None or sealed.sun_dir_in_target is None
        else sealed.sun_dir_in_target.tolist(),
        keypoints_px=[None if np.isnan(point).any() else point.tolist() for point in points_px],
        keypoint_states=list(states),
        full=full_record,
        visible=visible_record,
        valid=0 if full is None or depth is None else int((full & (depth > 0.0)).sum()),
        depth_scale_mm=plan.depth_scale_mm,
    )
    return Label(record, full, visible, depth)


def _states(
    target: TargetModel, sealed: SealedExposure, points_px: Floats, camera: Camera
) -> tuple[str, ...]:
    """Return the keypoints' states: landmarks first, then markers; see ``keypoint_model``."""
    model = target.keypoints
    landmarks = len(model) - model.markers
    seen, lit = np.ones(len(model), dtype=np.bool_), np.ones(len(model), dtype=np.bool_)
    if sealed.landmarks_visible is not None and landmarks:
        if len(sealed.landmarks_visible) != landmarks:
            raise DatasetError(
                f"{target.name}: expected the truth of {landmarks} landmarks, as its wireframe "
                f"has, got {len(sealed.landmarks_visible)}; render again"
            )
        seen[:landmarks] = sealed.landmarks_visible
    if sealed.sun_dir_in_target is not None and landmarks:
        shone_on = model.points_in_target[:landmarks]
        lit[:landmarks] = sunlit(shone_on, target.vertices, target.faces, sealed.sun_dir_in_target)
    if sealed.marker_visible is not None and len(sealed.marker_visible) == model.markers:
        seen[landmarks:] = sealed.marker_visible >= HALF
    if sealed.marker_lit is not None and len(sealed.marker_lit) == model.markers:
        lit[landmarks:] = sealed.marker_lit >= HALF
    return states_of(points_px, camera, seen, lit)


def _masks(
    source: Source, labels: Labels | None, camera: Camera, cam_from_target: RigidTransform
) -> tuple[MaskRecord | None, Mask | None, Mask | None]:
    """Return the silhouette's record and mask, and the mask of what is seen."""
    if labels is None and source.target is None:
        return None, None, None
    if labels is None:
        assert source.target is not None
        alone = silhouette(source.target.vertices, source.target.faces, camera, cam_from_target)
        inside = alone.inside.copy()
        return MaskRecord(run_lengths(inside), alone.count, alone.box), inside, inside
    visible = np.isin(labels, source.target_labels)
    before = (labels > 0) & ~visible
    if source.target is None or (
        not before.any() and _whole_in_image(source.target, camera, cam_from_target)
    ):
        return (
            MaskRecord(run_lengths(visible), int(visible.sum()), box_of(visible)),
            visible,
            visible,
        )
    alone = silhouette(source.target.vertices, source.target.faces, camera, cam_from_target)
    full = visible | (before & alone.inside)
    count = alone.count - int(alone.inside.sum()) + int(full.sum())
    box, drawn = alone.box, box_of(full)
    if box is not None and drawn is not None:
        box = (
            min(box[0], drawn[0]),
            min(box[1], drawn[1]),
            max(box[2], drawn[2]),
            max(box[3], drawn[3]),
        )
    return MaskRecord(run_lengths(full), count, box or drawn), full, visible


def _whole_in_image(target: TargetModel, camera: Camera, cam_from_target: RigidTransform) -> bool:
    in_cam = cam_from_target @ target.vertices
    if in_cam[:, 2].min() <= 0.0:
        return False
    return bool(camera.contains(np.nan_to_num(camera.project(in_cam), nan=-1e9), EDGE_PX).all())


def _pixel_truth(
    source: Source, name: str, shape: tuple[int, int]
) -> tuple[Labels | None, Radiance | None]:
    """Return part labels and depth of an exposure; None where its dataset has none."""
    labels_path = source.folder / "truth" / "labels" / f"{name}.png"
    depth_path = source.folder / "truth" / "geometry" / f"{name}.exr"
    labels = depth = None
    if source.part_names and labels_path.is_file():
        data = read_bytes(labels_path, MOST_LABEL_BYTES)
        read = decoded_png(data) if png_size(data) == shape[::-1] else None
        if read is None or read.shape != shape or read.dtype != np.uint8:
            raise DatasetError(
                f"{labels_path}: expected part labels of {shape[1]} x {shape[0]} pixels as an "
                "8-bit PNG, got something else; delete it and render again"
            )
        labels = np.asarray(read, dtype=np.uint8)
    if depth_path.is_file():
        channels = read_exr(depth_path)
        if channels is None or "Z" not in channels or channels["Z"].shape != shape:
            raise DatasetError(
                f"{depth_path}: expected a whole EXR with the depth of {shape[1]} x {shape[0]} "
                "pixels, got none; delete it and render again"
            )
        depth = np.asarray(channels["Z"], dtype=np.float32)
    return labels, depth

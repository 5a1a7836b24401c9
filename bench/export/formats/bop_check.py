"""BOP exports reopened: tables against each other, masks against boxes, models against both."""

from __future__ import annotations

import io
import json
import tarfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import trimesh

from bench.export.formats.format import Findings
from bench.export.formats.reading_back import check_mask, image_of, opened
from models.arrays import AnyArray, Floats
from models.errors import DatasetError

SPLITS = ("train", "val", "test")
MM = 1e3
BOX_PX = 0.5  # beyond the outermost corner: rounding, and no more
MOST_MEMBER = 1_000_000_000


def check_bop(folder: Path) -> Findings:
    """Reopen a scenewise export."""
    found, models = Findings(), _models(folder)
    for scene in sorted(path for split in SPLITS for path in (folder / split).glob("[0-9]*")):
        place = str(scene.relative_to(folder))
        for camera_file in sorted(scene.glob("scene_camera*.json")):
            suffix = camera_file.stem.removeprefix("scene_camera")
            names = ("scene_camera", "scene_gt", "scene_gt_info")
            cameras, poses, infos = (opened(folder, f"{place}/{n}{suffix}.json") for n in names)
            if not cameras.keys() == poses.keys() == infos.keys():
                found.faults.append(f"{camera_file}: expected the same images in {names}")
                continue
            for image, camera in cameras.items():
                number = f"{int(image):06d}"
                pictures = [scene / f"{kind}{suffix}" / f"{number}.png" for kind in ("gray", "rgb")]
                shown = next((p for p in pictures if p.is_file()), pictures[0])
                size = image_of(folder, str(shown.relative_to(folder))).shape[:2]
                masks = [
                    _mask(folder, f"{place}/{kind}{suffix}/{number}_000000.png", size)
                    for kind in ("mask", "mask_visib")
                ]
                depth = _depth(folder, f"{place}/depth{suffix}/{number}.png", size)
                where = f"{place} image {image}{suffix}"
                _hold(found, where, camera, poses[image], infos[image], masks, depth, models)
    return found


def check_imagewise(folder: Path) -> Findings:
    """Reopen an imagewise export."""
    found, models = Findings(), _models(folder)
    for camera_file in sorted(p for s in SPLITS for p in folder.glob(f"{s}*/*.camera.json")):
        key = camera_file.name.removesuffix(".camera.json")
        own = {
            path.name.removeprefix(f"{key}."): path.read_bytes()
            for path in camera_file.parent.glob(f"{key}.*")
        }
        _hold_members(found, f"{camera_file.parent.name}/{key}", own, models)
    return found


def check_webdataset(folder: Path) -> Findings:
    """Reopen shards, one image at a time."""
    found, models = Findings(), _models(folder)
    for index in sorted(folder.glob("*/key_to_shard.json")):
        place = index.parent
        if place.name.split("_")[0] not in SPLITS:
            continue
        shards = opened(folder, f"{place.name}/key_to_shard.json")
        seen: dict[str, int] = {}
        for shard in sorted(place.glob("shard-*.tar")):
            with tarfile.open(shard) as file:
                key = ""
                own: dict[str, bytes] = {}
                for member in file:
                    if not member.isreg() or member.size > MOST_MEMBER:
                        found.faults.append(f"{shard}: expected files alone, got {member.name!r}")
                        continue
                    name, _, ending = member.name.partition(".")
                    if name != key and own:
                        _hold_members(found, f"{place.name}/{key}", own, models)
                        own = {}
                    key = name
                    seen[key] = int(shard.stem.removeprefix("shard-"))
                    data = file.extractfile(member)
                    own[ending] = b"" if data is None else data.read()
                if own:
                    _hold_members(found, f"{place.name}/{key}", own, models)
        if seen != shards:
            found.faults.append(f"{index}: expected the shard of each image, got others")
    return found


def _hold_members(
    found: Findings, where: str, own: dict[str, bytes], models: dict[int, Floats]
) -> None:
    camera = json.loads(own["camera.json"])
    image = next((own[name] for name in ("gray.tiff", "rgb.png") if name in own), b"")
    picture = cv2.imdecode(np.frombuffer(image, np.uint8), -1) if image else None
    if picture is None:
        found.faults.append(f"{where}: expected an image that opens, got none")
        return
    masks: list[AnyArray | None] = []
    for name in ("mask.json", "mask_visib.json"):
        table = json.loads(own[name])["0"] if name in own else None
        masks.append(None if table is None else _run_lengths(table, picture.shape[:2]))
    depth = None
    if "depth.png" in own:
        depth = cv2.imdecode(np.frombuffer(own["depth.png"], np.uint8), -1)
    poses, infos = (json.loads(own.get(name, b"[]")) for name in ("gt.json", "gt_info.json"))
    _hold(found, where, camera, poses, infos, masks, depth, models)


def _hold(
    found: Findings,
    where: str,
    camera: dict[str, Any],
    poses: Sequence[dict[str, Any]],
    infos: Sequence[dict[str, Any]],
    masks: Sequence[AnyArray | None],
    depth: AnyArray | None,
    models: dict[int, Floats],
) -> None:
    """Hold the tables of one image against each other and against its masks."""
    found.images += 1
    if len(poses) != len(infos):
        found.faults.append(f"{where}: expected as many poses as their infos")
        return
    for pose, info in zip(poses, infos, strict=True):
        found.objects += 1
        rotation = np.reshape(pose["cam_R_m2c"], (3, 3))
        if np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-9:
            found.faults.append(f"{where}: expected a rotation, got none")
        full, visible = masks
        if full is None or visible is None:
            continue
        if (visible & ~full).any():
            found.faults.append(f"{where}: expected what is seen within the silhouette")
        x, y, w, h = info["bbox_visib"]
        box = None if info["bbox_visib"] == [-1] * 4 else [x, y, x + w, y + h]
        check_mask(found, where, visible, info["px_count_visib"], box)
        if depth is not None and (depth[visible] == 0).any():
            found.faults.append(f"{where}: expected a depth wherever the target is seen")
        if info["px_count_visib"] and "distortion" not in camera:
            _hold_model(found, where, camera, pose, info, models.get(pose["obj_id"]), full.shape)


def _hold_model(
    found: Findings,
    where: str,
    camera: dict[str, Any],
    pose: dict[str, Any],
    info: dict[str, Any],
    model_mm: Floats | None,
    size: tuple[int, ...],
) -> None:
    """Ask that the silhouette is no larger than its model's corners, projected.

    Smaller it may be: what is thinner than a pixel covers none.
    """
    if model_mm is None or "cam_K" not in camera:
        return
    rotation, matrix = np.reshape(pose["cam_R_m2c"], (3, 3)), np.reshape(camera["cam_K"], (3, 3))
    in_cam = model_mm @ rotation.T + np.array(pose["cam_t_m2c"])
    x, y, w, h = info["bbox_obj"]
    around = [-size[1], -size[0], 2 * size[1] - 1, 2 * size[0] - 1]
    if in_cam[:, 2].min() <= 0.0 or np.isin([x, y, x + w, y + h], around).any():
        return  # cut off: the box is not that of the corners
    pixels = in_cam @ matrix.T
    pixels = pixels[:, :2] / pixels[:, 2:]
    low, high = pixels.min(axis=0) - BOX_PX, pixels.max(axis=0) + BOX_PX
    if (low > [x, y]).any() or (high < [x + w, y + h]).any():
        found.faults.append(
            f"{where}: expected bbox_obj within its model's picture, {low.tolist()} to "
            f"{high.tolist()}, got {info['bbox_obj']}"
        )


def _models(folder: Path) -> dict[int, Floats]:
    """Return the corners of each model, mm, by its number."""
    return {
        int(path.stem.removeprefix("obj_")): np.asarray(
            trimesh.load(io.BytesIO(path.read_bytes()), file_type="ply", process=False).vertices
        )
        for path in (folder / "models").glob("obj_*.ply")
    }


def _mask(folder: Path, name: str, size: tuple[int, ...]) -> AnyArray | None:
    if not (folder / name).is_file():
        return None
    image = image_of(folder, name)
    if image.shape != size or not np.isin(image, (0, 255)).all():
        raise DatasetError(f"{folder / name}: expected a mask of 0 and 255 of its image's size")
    return image == 255


def _depth(folder: Path, name: str, size: tuple[int, ...]) -> AnyArray | None:
    if not (folder / name).is_file():
        return None
    image = image_of(folder, name)
    if image.shape != size or image.dtype != np.uint16:
        raise DatasetError(f"{folder / name}: expected a 16-bit depth of its image's size")
    return image


def _run_lengths(table: dict[str, Any], size: tuple[int, ...]) -> AnyArray:
    counts = table["counts"]
    if tuple(table["size"]) != size or sum(counts) != size[0] * size[1] or min(counts) < 0:
        raise DatasetError("expected run lengths of a mask of its image's size, got others")
    return np.repeat(np.arange(len(counts)) % 2 == 1, counts).reshape(size[::-1]).T

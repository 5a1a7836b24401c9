"""BOP exports, made anew from their own models and poses by trimesh's ray casting.

One ray goes through the centre of each pixel, as the format has it: through K with integer pixel
centres, off to the nearest face of ``models/obj_*.ply``. The canvas is three times the image, as
BOP's own tools take it, so that silhouettes beyond the edge are counted.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import OpenEXR
import pytest
import trimesh
from scipy.ndimage import binary_dilation, binary_erosion

BOX_PX = 1
DEPTH_MM = 1.0
EDGE_SHARE = 0.995  # of the depths inside: a ray at a face's edge may go by on the one side
RAYS_AT_ONCE = 2000  # a tree of Python objects holds the faces that each may meet
STRETCH = 100.0
SPLITS = ("train", "val", "test")
CASES = [("000001", "_image_800"), ("000001", "_image_850"), ("000002", "_image")]


@dataclass(frozen=True)
class Cast:
    """What rays meet, by rows and columns of the canvas; ``left, top`` is its first pixel."""

    depth_mm: np.ndarray
    left: int
    top: int

    def within(self, width: int, height: int) -> np.ndarray:
        """Return the part that is the image."""
        return self.depth_mm[-self.top : -self.top + height, -self.left : -self.left + width]


@pytest.fixture(scope="module")
def folder(exported) -> Path:
    return exported("bop")


@pytest.fixture(scope="module")
def meshes(folder):
    return {
        int(path.stem[4:]): trimesh.load(path, process=False)
        for path in sorted((folder / "models").glob("obj_*.ply"))
    }


def read(place: Path, name: str, suffix: str):
    return json.loads((place / f"{name}{suffix}.json").read_text())


def cast(mesh, matrix, turn, at_mm, width: int, height: int) -> Cast:
    """Return depths along the boresight, mm; 0 where a ray meets nothing.

    The mesh is taken through K to (u, v, a hundred times nearest depth over depth): planes stay
    planes and all rays become parallel, so that trimesh's tree finds few faces for each.
    """
    left, top, columns, rows = -width, -height, 3 * width, 3 * height
    seen = (mesh.vertices @ turn.T + at_mm) @ matrix.T
    nearest_mm = seen[:, 2].min()
    assert nearest_mm > 0
    uvw = np.column_stack([seen[:, :2] / seen[:, 2:], STRETCH * nearest_mm / seen[:, 2]])
    low = np.maximum(np.floor(uvw[:, :2].min(axis=0)).astype(int), [left, top])
    high = np.ceil(uvw[:, :2].max(axis=0)).astype(int)
    high = np.minimum(high, [left + columns - 1, top + rows - 1])
    u, v = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    u, v = u.ravel(), v.ravel()
    straight = trimesh.Trimesh(uvw, mesh.faces, process=False)
    depth = np.zeros((rows, columns))
    for start in range(0, len(u), RAYS_AT_ONCE):
        pixels = slice(start, start + RAYS_AT_ONCE)
        origins = np.column_stack([u[pixels], v[pixels], np.full(len(u[pixels]), 2 * STRETCH)])
        places, ray, _ = straight.ray.intersects_location(
            origins, np.tile([0.0, 0.0, -1.0], (len(origins), 1)), multiple_hits=False
        )
        pixel = start + ray
        depth[v[pixel] - top, u[pixel] - left] = STRETCH * nearest_mm / places[:, 2]
    return Cast(depth, left, top)


@pytest.fixture(scope="module")
def judged(folder, meshes):
    """Return each image with what the rays say of it: of every stream, whichever split."""
    found = []
    for scene, suffix in CASES:
        for place in (folder / split / scene for split in SPLITS):
            cameras, infos = (
                read(place, "scene_camera", suffix),
                read(place, "scene_gt_info", suffix),
            )
            for image, (pose,) in read(place, "scene_gt", suffix).items():
                shown = cv2.imread(str(place / f"gray{suffix}" / f"{int(image):06d}.png"), -1)
                height, width = shown.shape
                matrix = np.reshape(cameras[image]["cam_K"], (3, 3))
                turn = np.reshape(pose["cam_R_m2c"], (3, 3))
                rays = cast(
                    meshes[pose["obj_id"]], matrix, turn, np.array(pose["cam_t_m2c"]), width, height
                )
                found.append(
                    (place, suffix, int(image), cameras[image], infos[image][0], rays, shown.shape)
                )
    return found


def outline(mask):
    """Return the pixels about a mask's edge, on either side."""
    return binary_dilation(mask) & ~binary_erosion(mask, border_value=1)


def box_of(mask, left: int = 0, top: int = 0):
    rows, columns = np.nonzero(mask)
    x0, y0 = int(columns.min()) + left, int(rows.min()) + top
    return [x0, y0, int(np.ptp(columns)), int(np.ptp(rows))]


def picture(place: Path, folder: str, suffix: str, name: str):
    image = cv2.imread(str(place / f"{folder}{suffix}" / f"{name}.png"), -1)
    assert image is not None, (place, folder, name)
    return image


def test_masks_are_the_meshes_but_for_outline_pixels(judged):
    for place, suffix, image, _, _, rays, (height, width) in judged:
        met = rays.within(width, height) > 0
        for kind in ("mask", "mask_visib"):
            written = picture(place, kind, suffix, f"{image:06d}_000000") == 255
            assert not ((written != met) & ~outline(met)).any(), (place.name, suffix, image, kind)


def test_boxes_are_within_a_pixel(judged):
    for _, _, image, _, info, rays, (height, width) in judged:
        met = rays.within(width, height) > 0
        whole = box_of(rays.depth_mm > 0, rays.left, rays.top)
        for told, anew in ((info["bbox_obj"], whole), (info["bbox_visib"], box_of(met))):
            told_ends = [told[0], told[1], told[0] + told[2], told[1] + told[3]]
            ends = [anew[0], anew[1], anew[0] + anew[2], anew[1] + anew[3]]
            assert np.abs(np.subtract(told_ends, ends)).max() <= BOX_PX, (image, told, anew)


def test_counts_and_the_visible_share_are_those_of_the_rays(judged):
    for _, _, image, _, info, rays, (height, width) in judged:
        whole, met = rays.depth_mm > 0, rays.within(width, height) > 0
        edge, seen_edge = int(outline(whole).sum()), int(outline(met).sum())
        assert abs(info["px_count_all"] - whole.sum()) <= edge
        assert abs(info["px_count_visib"] - met.sum()) <= seen_edge
        share = met.sum() / whole.sum()
        assert abs(info["visib_fract"] - share) <= (edge + seen_edge) / whole.sum(), image
        assert info["visib_fract"] == info["px_count_visib"] / info["px_count_all"]


def test_depth_is_within_a_millimetre(judged):
    for place, suffix, image, camera, _, rays, (height, width) in judged:
        met = rays.within(width, height)
        steps = picture(place, "depth", suffix, f"{image:06d}").astype(np.float64)
        file = OpenEXR.File(str(place / f"depth_m{suffix}" / f"{image:06d}.exr"))
        fine = 1e3 * np.asarray(file.channels()["Z"].pixels, dtype=np.float64)
        inside = (met > 0) & (steps > 0) & ~outline(met > 0)
        assert np.count_nonzero(inside) > 0.5 * np.count_nonzero(met)
        for depth in (steps * camera["depth_scale"], fine):
            apart = np.abs(depth - met)[inside]
            assert np.mean(apart <= DEPTH_MM) >= EDGE_SHARE, (image, np.sort(apart)[-20:])


def test_models_are_as_large_as_their_table_says(folder, meshes):
    infos = json.loads((folder / "models" / "models_info.json").read_text())
    assert set(infos) == {str(number) for number in meshes}
    for number, mesh in meshes.items():
        info, (low, high) = infos[str(number)], mesh.bounds
        assert np.allclose([info[f"min_{axis}"] for axis in "xyz"], low, atol=1e-3)
        assert np.allclose([info[f"size_{axis}"] for axis in "xyz"], high - low, atol=2e-3)
        corners = mesh.convex_hull.vertices
        apart = max(np.linalg.norm(corners - corner, axis=1).max() for corner in corners)
        assert info["diameter"] == pytest.approx(apart, rel=1e-6)


def test_targets_are_objects_that_are_seen(folder):
    targets = json.loads((folder / "test_targets_bop19.json").read_text())
    assert {told["scene_id"] for told in targets} == {1, 2}
    for told in targets:
        (place,) = folder.glob(f"test/{told['scene_id']:06d}")
        tables = [json.loads(path.read_text()) for path in place.glob("scene_gt_image*.json")]
        assert all(table[str(told["im_id"])][0]["obj_id"] == told["obj_id"] for table in tables)

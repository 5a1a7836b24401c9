"""How likely the light in an image is, were the target at a pose under a Sun that is known.

The image is cut into cells, each dark, faint, half bright or bright; a pose says of each whether
the target covers it, and whether the Sun shines on it, grazes it or leaves it in its own or cast
shadow. How often each goes with each was counted at true poses. What counts is the logarithm of
the likelihood over that of an empty sky, summed over the cells that the target covers: light that
it does not cover adds nothing, shine where nothing shines costs.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import AnyArray, Floats, Indices
from models.camera import Camera
from models.pose import RigidTransform
from pipelines.acquisition.surface_cloud import SurfaceCloud, nearest_in_cells, sunlight
from pipelines.detection.target_region import TargetRegion

OUTSIDE, SHADE, GRAZED, LIT = range(4)  # of what a pose says
DARK, FAINT, HALF, BRIGHT = range(4)  # of what an image shows
GRAZING = 0.25  # cosine at which the Sun meets a face: less is grazed
REFERENCE_PERCENTILE = 80.0  # of the lit pixels: what is called bright is measured in it
FAINT_BELOW, BRIGHT_ABOVE = 0.03, 0.2
MOST_CELLS = 800  # of a side of any grid
CELLS_OF_RADIUS = 40.0  # at most so many across the target's radius: the cloud is dense then
COUNTED = np.array(
    [
        [0.9950, 0.0030, 0.0015, 0.0005],
        [0.60, 0.25, 0.10, 0.05],
        [0.30, 0.15, 0.30, 0.25],
        [0.12, 0.06, 0.22, 0.60],
    ]
)
"""Share of an image's cells, by what a true pose says (rows) and what is shown (columns)."""


@dataclass(frozen=True, eq=False)
class ImageLight:
    """An image in cells.

    Attributes
    ----------
    shown : (rows, columns) array of int
        DARK to BRIGHT.
    cell_px : float, px
    corner_px : (2,) array, px
        Of the first cell's outer corner.
    most : float
        Log-likelihood that the best of all poses could have.
    cells : int
        That are not dark.
    """

    shown: AnyArray
    cell_px: float
    corner_px: Floats
    most: float
    cells: int


def gains() -> Floats:
    """Return log-likelihoods over those of an empty sky, (4, 4), as ``COUNTED``."""
    return np.asarray(np.log(COUNTED / COUNTED[OUTSIDE]))


def brightness(target: TargetRegion) -> Floats:
    """Return how brightly each pixel shines, (height, width) float32, 1 for what is called bright.

    Parameters
    ----------
    target : TargetRegion
        With something lit on it.
    """
    reference = float(np.percentile(target.signal[target.lit], REFERENCE_PERCENTILE))
    level = np.where(target.lit, target.signal, 0.0) / max(reference, 1e-6)
    return np.asarray(np.maximum(level, 0.0), dtype=np.float32)


def image_light(target: TargetRegion, radius_px: float) -> ImageLight:
    """Cut an image into cells.

    Parameters
    ----------
    target : TargetRegion
        With something lit on it.
    radius_px : float, px
        About how large the target is.
    """
    cell_px = float(max(1, round(radius_px / CELLS_OF_RADIUS)))
    row, column = np.nonzero(target.lit)
    low = np.array([column.min(), row.min()]) - 2 * cell_px
    high = np.array([column.max(), row.max()]) + 1 + 2 * cell_px
    low = np.maximum(np.floor(low / cell_px) * cell_px, 0.0).astype(int)
    count = np.ceil((high - low) / cell_px).astype(int)
    size = (count * cell_px).astype(int)
    level = brightness(target)[low[1] : low[1] + size[1], low[0] : low[0] + size[0]]
    lit = target.lit[low[1] : low[1] + size[1], low[0] : low[0] + size[0]].astype(np.float32)
    pad = ((0, size[1] - level.shape[0]), (0, size[0] - level.shape[1]))
    level, lit = np.pad(level, pad), np.pad(lit, pad)
    shape = (int(count[0]), int(count[1]))
    level = cv2.resize(level, shape, interpolation=cv2.INTER_AREA)
    lit = cv2.resize(lit, shape, interpolation=cv2.INTER_AREA)
    shown = np.digitize(level, (FAINT_BELOW, BRIGHT_ABOVE)) + 1
    shown = np.where(lit < 0.4, DARK, shown)
    best = gains().max(axis=0)
    lighted = shown[shown > DARK]
    return ImageLight(shown, cell_px, low - 0.5, float(best[lighted].sum()), len(lighted))


def told_grid(
    image: ImageLight,
    cloud: SurfaceCloud,
    camera: Camera,
    pose: RigidTransform,
    sun_in_cam: Floats,
) -> tuple[AnyArray, Indices]:
    """Return what a pose says, cell by cell.

    Parameters
    ----------
    image : ImageLight
        Whose cells they are.
    cloud : SurfaceCloud
    camera : Camera
    pose : RigidTransform
        ``cam_from_target``.
    sun_in_cam : (3,) array
        Unit vector towards the Sun.

    Returns
    -------
    said : (rows, columns) array of int
        OUTSIDE to LIT.
    corner : (2,) array of int
        Column and row of its first cell among the image's.
    """
    in_cam = cloud.points @ pose.rotation.T + pose.translation
    depth = np.maximum(in_cam[:, 2], 1e-3)
    flat = in_cam[:, :2] / depth[:, None] * np.array([camera.fx, camera.fy])
    flat += np.array([camera.cx, camera.cy])
    cell = np.floor((flat - image.corner_px) / image.cell_px).astype(np.int64)
    corner = np.clip(cell.min(axis=0) - 1, -MOST_CELLS, MOST_CELLS)
    width, height = np.clip(cell.max(axis=0) + 2 - corner, 1, MOST_CELLS).tolist()
    seen = nearest_in_cells(cell[:, 0] - corner[0], cell[:, 1] - corner[1], depth, width, height)
    there = seen >= 0
    point = seen[there]
    normal = cloud.normals[point] @ pose.rotation.T
    side = np.where(np.einsum("ni,ni->n", in_cam[point], normal) < 0.0, 1.0, -1.0)
    cosine = sunlight(cloud, pose.rotation.T @ sun_in_cam)[point] * side
    said = np.zeros(width * height, dtype=np.uint8)
    said[there] = np.digitize(cosine, (1e-6, GRAZING)) + SHADE
    grid = said.reshape(height, width)
    square = np.ones((3, 3), dtype=np.uint8)
    closed = cv2.morphologyEx((grid > OUTSIDE).astype(np.uint8), cv2.MORPH_CLOSE, square)
    holes = (grid == OUTSIDE) & (closed > 0)
    return np.where(holes, cv2.dilate(grid, square), grid), corner


def explained(image: ImageLight, said: AnyArray, corner: Indices) -> float:
    """Return how well a pose explains an image's light: 1 at the very best, 0 as an empty sky does.

    Parameters
    ----------
    image : ImageLight
    said, corner : arrays
        See ``told_grid``.
    """
    shown = shown_under(image, said, corner)
    covered = said > OUTSIDE
    return float(gains()[said[covered], shown[covered]].sum() / max(image.most, 1e-6))


def shown_under(image: ImageLight, said: AnyArray, corner: Indices) -> AnyArray:
    """Return what an image shows in the cells of a grid, dark beyond its own, as ``said``.

    Parameters
    ----------
    image : ImageLight
    said, corner : arrays
        See ``told_grid``.
    """
    height, width = said.shape
    shown = np.full((height, width), DARK, dtype=np.int64)
    rows, columns = image.shown.shape
    left, top = max(0, int(corner[0])), max(0, int(corner[1]))
    right, bottom = min(columns, int(corner[0]) + width), min(rows, int(corner[1]) + height)
    if right > left and bottom > top:
        shown[top - corner[1] : bottom - corner[1], left - corner[0] : right - corner[0]] = (
            image.shown[top:bottom, left:right]
        )
    return shown

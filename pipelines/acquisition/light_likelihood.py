"""How likely the light in an image is, were the target at a pose under a Sun that is known.

The image is cut into cells, each dark, faint, half bright or bright; a pose says of each whether
the target covers it, and whether the Sun shines on it, grazes it or leaves it in its own or cast
shadow. How often each goes with each was counted at true poses; what shines in shadow depends on
what else lights it, so that a pose has the best of some tables. What counts is the logarithm of the
likelihood over that of an empty sky, summed over the cells that the target covers: light that it
does not cover adds nothing, shine where nothing shines costs.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import AnyArray, Floats, Indices, Radiance
from models.camera import Camera
from models.pose import RigidTransform
from pipelines.acquisition.cell_grid import cells_under, points_in_cells
from pipelines.acquisition.surface_cloud import SurfaceCloud, nearest_in_cells, sunlight
from pipelines.detection.target_region import TargetRegion

OUTSIDE, SHADE, GRAZED, LIT = range(4)  # of what a pose says
DARK, FAINT, HALF, BRIGHT = range(4)  # of what an image shows
MOST_LEVEL = 2.0  # a mirror's glint says no more than that
LEAST_SAY = 6.0  # as of two cells: fewer tell little
FEWEST_CELLS = 12  # of which a correlation says anything
GRAZING = 0.25  # cosine at which the Sun meets a face: less is grazed
REFERENCE_PERCENTILE = 80.0  # of the lit pixels: what is called bright is measured in it
FAINT_BELOW, BRIGHT_ABOVE = 0.03, 0.2
MOST_CELLS = 800  # of a side of any grid
CELLS_OF_RADIUS = 40.0  # at most so many across the target's radius: the cloud is dense then
OF_OUTSIDE = (0.983, 0.006, 0.007, 0.004)
OF_GRAZED = (0.09, 0.12, 0.22, 0.57)
OF_LIT = (0.04, 0.01, 0.10, 0.85)
OF_SHADE = (
    (0.82, 0.07, 0.06, 0.05),  # the Sun alone, and little is reflected
    (0.45, 0.10, 0.20, 0.25),  # much is reflected from face to face
    (0.35, 0.40, 0.15, 0.10),  # the Earth lights it beside a bright Sun-lit part
    (0.08, 0.06, 0.50, 0.36),  # it outshines most of what the Sun lights
    (0.15, 0.02, 0.28, 0.55),  # it, or what is reflected, is all that shines
)
"""Share of cells by what is shown, DARK to BRIGHT, for what a true pose says of them.

Counted on 48 images of training motions. What shines in the shade depends on the Earth, of which
no pipeline is told: each pose has the best of some rows.
"""


@dataclass(frozen=True, eq=False)
class ImageLight:
    """An image in cells.

    Attributes
    ----------
    shown : (rows, columns) array of int
        DARK to BRIGHT.
    level : (rows, columns) float32 array
        Square root of the brightness, 1 for what is called bright.
    cell_px : float, px
    corner_px : (2,) array, px
        Of the first cell's outer corner.
    most : float
        Log-likelihood that the best of all poses could have.
    cells : int
        That are not dark.
    """

    shown: AnyArray
    level: Radiance
    cell_px: float
    corner_px: Floats
    most: float
    cells: int


def gains() -> Floats:
    """Return log-likelihoods over those of an empty sky, (regimes, said, shown)."""
    rows = [np.array([OF_OUTSIDE, shade, OF_GRAZED, OF_LIT]) for shade in OF_SHADE]
    return np.asarray(np.log(np.array(rows) / np.array(OF_OUTSIDE)))


GAINS = gains()


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
    best = GAINS.max(axis=(0, 1))
    lighted = shown[shown > DARK]
    return ImageLight(
        shown,
        np.sqrt(np.minimum(level, MOST_LEVEL)),
        cell_px,
        low - 0.5,
        float(best[lighted].sum()),
        len(lighted),
    )


@dataclass(frozen=True, eq=False)
class ToldLight:
    """What a pose says, cell by cell.

    Attributes
    ----------
    said : (rows, columns) array of int
        OUTSIDE to LIT.
    cosine : (rows, columns) array
        At which the Sun meets what is seen there, 0 where it does not.
    corner : (2,) array of int
        Column and row of its first cell among the image's.
    """

    said: AnyArray
    cosine: Floats
    corner: Indices


def told_light(
    image: ImageLight,
    cloud: SurfaceCloud,
    camera: Camera,
    pose: RigidTransform,
    sun_in_cam: Floats,
) -> ToldLight:
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
    """
    in_cam, depth, cell = points_in_cells(
        cloud.points, camera, pose, image.cell_px, image.corner_px
    )
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
    bright = np.zeros(width * height)
    bright[there] = np.maximum(cosine, 0.0)
    said = np.where(holes, cv2.dilate(grid, square), grid)
    return ToldLight(said, bright.reshape(height, width), corner)


def shading(image: ImageLight, told: ToldLight) -> float:
    """Return the correlation of the brightness shown with the cosine told, over what is covered.

    Materials differ, so that it is far below 1 at a right pose; a wrong one has it lower still.

    Parameters
    ----------
    image : ImageLight
    told : ToldLight
    """
    covered = told.said > OUTSIDE
    shown = cells_under(image.level, told.corner, told.said.shape, 0.0)[covered]
    cosine = told.cosine[covered]
    if covered.sum() < FEWEST_CELLS or shown.std() < 1e-6 or cosine.std() < 1e-6:
        return 0.0
    return float(np.corrcoef(shown, cosine)[0, 1])


def explained(image: ImageLight, told: ToldLight) -> float:
    """Return how well a pose explains an image's light: 1 at the very best, 0 as an empty sky does.

    Parameters
    ----------
    image : ImageLight
    told : ToldLight
    """
    return float(_by_regime(image, told).max() / max(image.most, 1e-6))


def regime_of(image: ImageLight, told: ToldLight) -> int:
    """Return which of ``OF_SHADE`` makes an image likeliest at a pose."""
    return int(_by_regime(image, told).argmax())


def _by_regime(image: ImageLight, told: ToldLight) -> Floats:
    """Return the log-likelihood of an image over an empty sky's, by what shines in the shade."""
    pairs = 4 * told.said.astype(np.int64) + cells_under(
        image.shown, told.corner, told.said.shape, DARK
    )
    counted = np.bincount(pairs.ravel(), minlength=16).reshape(4, 4)
    return np.asarray((GAINS * counted).sum(axis=(1, 2)))


def preference(image: ImageLight, one: ToldLight, other: ToldLight) -> float:
    """Return how clearly an image prefers one pose to another where they differ, in sigmas.

    Each cell of which the two say different things has a say, of the size of its own
    log-likelihood ratio; were each as likely to be for the one as for the other, the sum would be
    of unit variance. So a few cells decide between twins that are alike everywhere else.

    Parameters
    ----------
    image : ImageLight
    one, other : ToldLight
        Of two poses in that image.
    """
    low = np.minimum(one.corner, other.corner)
    high = np.maximum(
        one.corner + one.said.shape[::-1], other.corner + np.array(other.said.shape[::-1])
    )
    shown = cells_under(image.shown, low, tuple((high - low)[::-1].tolist()), DARK)
    ratio = np.zeros(shown.shape)
    for sign, told in ((1.0, one), (-1.0, other)):
        column, row = (told.corner - low).tolist()
        part = np.s_[row : row + told.said.shape[0], column : column + told.said.shape[1]]
        own = GAINS[regime_of(image, told)]
        ratio[part] += sign * own[told.said, shown[part]]
    return float(ratio.sum() / np.sqrt((ratio**2).sum() + LEAST_SAY**2))

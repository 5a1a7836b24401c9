"""Where in an image a view lies and how large it is, by the light alone.

What shines has a centroid and a size, but half of what should shine may be dark for a reason that
is not known on board, or lit by the Earth. So a view's cells, each lit, grazed or in shadow, are
laid over the image's at all places and sizes about, and the likeliest is taken: a correlation of
them with the image's log-likelihoods for each.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import Floats, Radiance
from models.camera import Camera
from models.pose import RigidTransform
from pipelines.acquisition.light_likelihood import GAINS, GRAZING, SHADE, ImageLight
from pipelines.acquisition.sunlit_views import VIEW_CELLS, SeenViews, turn_to
from pipelines.acquisition.view_search import Hypothesis

CELLS_OF_RADIUS = 12.0
SPAN_RADII = 2.1  # of a view's grid
SIZES = tuple(np.exp(0.12 * np.arange(-3, 4)).tolist())
SHIFT_CELLS = 4  # either way
SHADES = (0, 2, 4)  # of ``light_likelihood.OF_SHADE``: the others lie between
SAID = 3  # in shadow, grazed, lit


@dataclass(frozen=True, eq=False)
class CoarseLight:
    """An image's log-likelihoods in coarse cells.

    Attributes
    ----------
    gains : tuple of float32 arrays
        (rows, columns, 2) of what is grazed and lit, then (rows, columns) for each of ``SHADES``;
        sums over the image's own cells.
    cell_px : float, px
    corner_px : (2,) array, px
        Of the first cell's outer corner.
    most : float
        As ``ImageLight.most``.
    """

    gains: tuple[Radiance, ...]
    cell_px: float
    corner_px: Floats
    most: float


def coarse_light(image: ImageLight, radius_px: float) -> CoarseLight:
    """Sum an image's log-likelihoods over coarse cells.

    Parameters
    ----------
    image : ImageLight
    radius_px : float, px
        About how large the target is.
    """
    factor = max(1, round(radius_px / CELLS_OF_RADIUS / image.cell_px))
    rows, columns = (factor * -(-n // factor) for n in image.shown.shape)
    shown = np.zeros((rows, columns), dtype=np.int64)
    shown[: image.shown.shape[0], : image.shown.shape[1]] = image.shown
    blocks = shown.reshape(rows // factor, factor, columns // factor, factor)
    counted = np.stack([(blocks == k).sum(axis=(1, 3)) for k in range(4)], axis=-1)
    pad = int(np.ceil(2.5 * CELLS_OF_RADIUS))
    sky = [(pad, pad), (pad, pad), (0, 0)]
    counted = np.pad(counted, sky)
    empty = counted.sum(axis=-1) == 0
    counted[empty, 0] = factor * factor
    both = (counted @ GAINS[0, SHADE + 1 :].T).astype(np.float32)
    shades = [(counted @ GAINS[k, SHADE]).astype(np.float32) for k in SHADES]
    cell_px = factor * image.cell_px
    return CoarseLight((both, *shades), cell_px, image.corner_px - pad * cell_px, image.most)


def placed(
    image: CoarseLight,
    camera: Camera,
    seen: SeenViews,
    view: Hypothesis,
    sun_in_cam: Floats,
    radius_m: float,
) -> Hypothesis:
    """Move a view and change its range until it is likeliest.

    Parameters
    ----------
    image : CoarseLight
    camera : Camera
        Of the image.
    seen : SeenViews
    view : Hypothesis
        Of these views, and about where it lies.
    sun_in_cam : (3,) array
        Unit vector towards the Sun.
    radius_m : float, m
        Of the target.

    Returns
    -------
    Hypothesis
        Its ``likeness`` is the share of the image's light that it explains.
    """
    pose = view.cam_from_target
    ray = pose.translation / np.linalg.norm(pose.translation)
    turn = turn_to(ray).T @ pose.rotation @ seen.rotations[view.view].T
    classes = _classes(seen, view.view, pose.rotation.T @ sun_in_cam)
    radius_px = camera.fx * radius_m / pose.translation[2]
    middle = (camera.project(pose.translation[None])[0] - image.corner_px) / image.cell_px - 0.5
    rows, columns = image.gains[1].shape
    best = (-np.inf, 1.0, np.zeros(2))
    for size in SIZES:
        scale = size * radius_px / image.cell_px * (SPAN_RADII / VIEW_CELLS)
        half = int(np.ceil(0.53 * VIEW_CELLS * scale)) + 1
        low = np.rint(middle).astype(int) - half - SHIFT_CELLS
        side = 2 * (half + SHIFT_CELLS) + 1
        if low.min() < 0 or low[0] + side > columns or low[1] + side > rows:
            continue
        centre = 0.5 * (VIEW_CELLS - 1)
        linear = scale * turn[:2, :2]
        moved = np.column_stack([linear, half - linear @ np.full(2, centre)])
        drawn = cv2.warpAffine(classes, moved, (2 * half + 1, 2 * half + 1), flags=cv2.INTER_AREA)
        window = np.s_[low[1] : low[1] + side, low[0] : low[0] + side]
        both, *shades = (each[window] for each in image.gains)
        shine = cv2.matchTemplate(
            np.ascontiguousarray(both), np.ascontiguousarray(drawn[..., 1:]), cv2.TM_CCORR
        )
        dim = np.ascontiguousarray(drawn[..., 0])
        shade = [
            cv2.matchTemplate(np.ascontiguousarray(each), dim, cv2.TM_CCORR) for each in shades
        ]
        score = shine + np.max(shade, axis=0)
        row, column = np.unravel_index(int(score.argmax()), score.shape)
        if score[row, column] > best[0]:
            at = low + half + np.array([column, row])
            best = (float(score[row, column]), size, at.astype(np.float64))
    score, size, at = best
    if not np.isfinite(score):
        return Hypothesis(view.view, pose, -np.inf)
    centre_px = image.corner_px + (at + 0.5) * image.cell_px
    ray = camera.rays(centre_px[None])[0]
    range_m = float(np.linalg.norm(pose.translation)) / size
    rotation = turn_to(ray) @ turn @ seen.rotations[view.view]
    return Hypothesis(view.view, RigidTransform(rotation, range_m * ray), score / image.most)


def _classes(seen: SeenViews, view: int, sun: Floats) -> Radiance:
    """Return where a view is in shadow, grazed and lit, (cells, cells, 3) float32."""
    own = np.s_[seen.first[view] : seen.first[view + 1]]
    nearest = int(np.argmax(seen.suns @ sun))
    cosine = seen.light[nearest, seen.point[own]] * seen.towards[own]
    said = np.digitize(cosine, (1e-6, GRAZING))
    cell = np.floor((seen.places[own] + 0.5 * SPAN_RADII) * (VIEW_CELLS / SPAN_RADII)).astype(int)
    drawn = np.zeros((VIEW_CELLS, VIEW_CELLS, SAID), dtype=np.float32)
    drawn[cell[:, 1], cell[:, 0], said] = 1.0
    return drawn

"""Which views of a target an image may show: every view, roll, size and shift, compared at once.

The lit part of a target is not its silhouette: what neither Sun nor Earth lights is missing, so
that centroid and size mislead. They are therefore varied, and what is compared is both the
silhouette and the edges. The best are brought closer on the distance transform of the image's
edges, all together (Liu et al. 2010, CVPR, "Fast directional chamfer matching", in kind).
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import Floats
from models.camera import Camera
from models.pose import RigidTransform
from pipelines.acquisition.view_sphere import (
    CELLS,
    REACH,
    ViewSphere,
    centred,
    edge_pictures,
    pose_from_view,
    shape_of,
)
from pipelines.tracking.edge_fit import EdgeImage

ROLLS = 45
DIAGONALS = ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0))
MOST_EDGE_POINTS = 1000
EDGE_SHARE = 1.0  # what likeness of edges counts against that of silhouettes
TURN_APART_DEG = 6.0  # two of the best nearer than this are one


@dataclass(frozen=True)
class Spread:
    """How the lit part's size and place are varied.

    Attributes
    ----------
    scales : tuple of float
        Of its size.
    shifts : tuple of (float, float)
        Of its centroid, in its radii of gyration.
    """

    scales: tuple[float, ...]
    shifts: tuple[tuple[float, float], ...]


MOSTLY_LIT = Spread((0.85, 1.0, 1.17), ((0.0, 0.0), *((0.2 * x, 0.2 * y) for x, y in DIAGONALS)))
PARTLY_LIT = Spread(
    (0.85, 1.1, 1.4, 1.8),
    (
        (0.0, 0.0),
        *((0.3 * x, 0.3 * y) for x, y in DIAGONALS),
        *((0.75, 0.0), (-0.75, 0.0), (0.0, 0.75), (0.0, -0.75)),
    ),
)


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """A pose to be tried.

    Attributes
    ----------
    view : int
        Index into ``ViewSphere.views``.
    cam_from_target : RigidTransform
    likeness : float
    """

    view: int
    cam_from_target: RigidTransform
    likeness: float


def search_views(
    image: EdgeImage, sphere: ViewSphere, count: int, spread: Spread = MOSTLY_LIT
) -> list[Hypothesis]:
    """Return the ``count`` likeliest views of an image, the likeliest first.

    Parameters
    ----------
    image : EdgeImage
        With something lit on it.
    sphere : ViewSphere
    count : int
    spread : Spread
        How much of the target may be in the dark.
    """
    centroid, gyration = shape_of(image.target.lit)
    row, column = np.nonzero(image.edge_map.edges)
    every = len(row) // MOST_EDGE_POINTS + 1
    row, column = row[::every], column[::every]
    points = np.stack([column, row], axis=1).astype(np.float64)
    angle = image.edge_map.angle_rad[row, column].astype(np.float64)
    lit = image.target.lit.astype(np.float32)
    rolls = 2.0 * np.pi * np.arange(ROLLS) / ROLLS
    scores: list[Floats] = []
    settings: list[tuple[float, Floats]] = []
    for scale in spread.scales:
        size = scale * gyration
        soft = cv2.GaussianBlur(lit, (0, 0), max(0.5 * size * REACH / (0.5 * CELLS), 0.3))
        for shift in spread.shifts:
            centre = centroid + gyration * np.array(shift)
            scores.append(_likeness(soft, points, angle, centre, size, rolls, sphere))
            settings.append((size, centre))
    return _best(np.array(scores), settings, rolls, sphere, image.camera, count)


def _likeness(
    soft: Floats,
    points: Floats,
    angle: Floats,
    centre: Floats,
    size: float,
    rolls: Floats,
    sphere: ViewSphere,
) -> Floats:
    """Return how like each view, at each roll, an image reduced about a centre is, (rolls, v)."""
    step = size * REACH / (0.5 * CELLS)
    side = (np.arange(CELLS) - 0.5 * (CELLS - 1)) * step
    x, y = np.meshgrid(side, side)
    cosine, sine = np.cos(rolls)[:, None, None], np.sin(rolls)[:, None, None]
    # The view's x axis lies along (cosine, sine) in the image.
    u = (centre[0] + cosine * x - sine * y).astype(np.float32).reshape(-1, CELLS)
    v = (centre[1] + sine * x + cosine * y).astype(np.float32).reshape(-1, CELLS)
    covered = cv2.remap(soft, u, v, cv2.INTER_LINEAR).reshape(len(rolls), -1)
    away_x, away_y = (points - centre).T / step
    back = np.stack(
        [
            cosine[..., 0] * away_x + sine[..., 0] * away_y,
            -sine[..., 0] * away_x + cosine[..., 0] * away_y,
        ],
        axis=-1,
    )
    edges = edge_pictures(back + 0.5 * (CELLS - 1), angle - rolls[:, None])
    by_shape = centred(covered) @ sphere.covered.T
    by_edges = edges @ sphere.edges.T
    return np.asarray(by_shape + EDGE_SHARE * by_edges, dtype=np.float64)


def _best(
    scores: Floats,
    settings: list[tuple[float, Floats]],
    rolls: Floats,
    sphere: ViewSphere,
    camera: Camera,
    count: int,
) -> list[Hypothesis]:
    """Pick the best settings of each view and roll, then views apart from each other."""
    best_setting = scores.argmax(axis=0)
    best = scores.max(axis=0)
    order = np.argsort(best.ravel())[::-1][: 40 * count]
    chosen: list[Hypothesis] = []
    rotations: list[Floats] = []
    for flat in order.tolist():
        roll, view = divmod(flat, best.shape[1])
        size, centre = settings[int(best_setting[roll, view])]
        pose = pose_from_view(
            sphere.views[view],
            float(rolls[roll]),
            camera.normalise(centre[None])[0],
            size / (0.5 * (camera.fx + camera.fy)),
        )
        if rotations:
            traces = np.einsum("nij,ij->n", np.array(rotations), pose.rotation)
            if traces.max() > 1.0 + 2.0 * np.cos(np.deg2rad(TURN_APART_DEG)):
                continue
        chosen.append(Hypothesis(view, pose, float(best[roll, view])))
        rotations.append(np.array(pose.rotation))
        if len(chosen) == count:
            break
    return chosen

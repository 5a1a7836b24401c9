"""What a camera that moves while its shutter is open sees: light at some instants, added up by row.

Between two instants light is taken as linear in time, which spreads it by an eighth of a pixel at
most, as an image moves by a quarter from one to the next. Each row adds up the instants of its own
exposure: all rows the same with a global shutter, later ones further down with a rolling one. The
frame's time is the middle of the middle row's exposure.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.onboard import PosePrior
from models.pose import RigidTransform
from renders.tracing.silhouette import pieces_of
from renders.world.exposure import Exposure
from renders.world.world import World

STEP_PX = 0.25  # that an image moves by from one instant to the next, at most
STILL_PX = 0.01  # over a whole frame: below, it is an image of one instant
MOST_INSTANTS = 1024  # what moves further than so many steps is seen in wider ones
MOMENTS = (-0.5, -0.25, 0.0, 0.25, 0.5)  # of the time a frame takes, at which its way is measured
MOST_VERTICES = 3000  # by whose places it is measured


@dataclass(frozen=True, eq=False)
class OpenShutter:
    """The instants at which a frame's light is traced, and what each row takes of each.

    Attributes
    ----------
    offsets_s : (k,) array, s
        From the frame's time.
    poses : (k,) tuple of RigidTransform
        ``cam_from_target`` at each.
    row_weights : (k, height) array
        Each row's add up to 1.
    """

    offsets_s: Floats
    poses: tuple[RigidTransform, ...]
    row_weights: Floats

    def samples(self, of_a_pixel: int) -> int:
        """Return how many samples an instant needs for as many in a row as in a frame at rest."""
        share = float(np.max(np.sum(self.row_weights**2, axis=0)))
        return 1 << int(np.ceil(np.log2(max(of_a_pixel * share, 1.0))))

    @property
    def key(self) -> list[object]:
        """What shapes its light, as a store key."""
        return [
            self.offsets_s.tolist(),
            [pose.matrix().tolist() for pose in self.poses],
            self.row_weights[:, [0, -1]].tolist(),
        ]


def open_shutter(
    world: World, exposure: Exposure, prior: PosePrior | None, open_ms: float | None = None
) -> OpenShutter | None:
    """Return what is added up in an exposure; None if the camera moves too little to tell.

    Parameters
    ----------
    world : World
    exposure : Exposure
    prior : PosePrior or None
        From which exposure times are planned.
    open_ms : float, optional, ms
        How long the exposure lasts, if not as planned.
    """
    table, height = world.scenario.shutter, world.camera.height
    if table is None or not (table.blur or table.row_us):
        return None
    if open_ms is None:
        open_ms = world.plan.before_any_image(exposure.time_s, prior)
    open_s = 1e-3 * open_ms if table.blur else 0.0
    row_s = 1e-6 * table.row_us
    spread_s = open_s + row_s * (height - 1)
    moved_px = _moved_px(world, exposure.time_s, spread_s)
    if moved_px < STILL_PX:
        return None
    count = int(np.clip(np.ceil(moved_px / STEP_PX) + 1, 3, MOST_INSTANTS))
    offsets_s: Floats = spread_s * (np.arange(count, dtype=np.float64) / (count - 1.0) - 0.5)
    middles_s: Floats = row_s * (np.arange(height, dtype=np.float64) - 0.5 * (height - 1))
    return OpenShutter(
        offsets_s,
        tuple(
            world.trajectory.cam_from_target(exposure.time_s + float(offset_s))
            for offset_s in offsets_s
        ),
        row_weights(offsets_s, middles_s, open_s),
    )


def row_weights(offsets_s: Floats, middles_s: Floats, open_s: float) -> Floats:
    """Return what rows take of instants, light being linear in time between them.

    Parameters
    ----------
    offsets_s : (k,) array, s
        Evenly spaced, two or more.
    middles_s : (rows,) array, s
        Of each row's exposure.
    open_s : float, s
        How long a row is exposed.

    Returns
    -------
    (k, rows) array
        Each row's add up to 1.
    """
    step_s = float(offsets_s[1] - offsets_s[0])
    away = (middles_s[None, :] - offsets_s[:, None]) / step_s
    half = 0.5 * open_s / step_s
    if half < 1e-6:
        weights = np.maximum(1.0 - np.abs(away), 0.0)
    else:
        weights = (_of_a_hat(away + half) - _of_a_hat(away - half)) / (2.0 * half)
    return np.asarray(weights / weights.sum(axis=0))


def _of_a_hat(u: Floats) -> Floats:
    """Integrate the hat ``1 - |u|`` from its left end."""
    v = np.clip(u, -1.0, 1.0)
    return np.asarray(np.where(v < 0.0, 0.5 * (1.0 + v) ** 2, 1.0 - 0.5 * (1.0 - v) ** 2))


def _moved_px(world: World, time_s: float, spread_s: float) -> float:
    """Return how far anything moves in the image, px: target, arm, whatever crosses it."""
    places: list[Floats] = []
    for share in MOMENTS:
        at_s = time_s + share * spread_s
        pose = world.trajectory.cam_from_target(at_s)
        pieces = pieces_of(world.target, world.chaser, pose, world.stance(at_s))
        vertices = np.concatenate([np.atleast_2d(piece) for piece in pieces])
        vertices = vertices[:: max(1, len(vertices) // MOST_VERTICES)]
        places.append(world.camera.project(pose @ vertices))
    ways = np.stack(places)
    ways = ways[:, np.isfinite(ways).all(axis=(0, 2))]
    low, high = ways.min(axis=0), ways.max(axis=0)
    size = [world.camera.width, world.camera.height]
    crossing = ((high > 0.0) & (low < size)).all(axis=1)
    legs = np.linalg.norm(np.diff(ways[:, crossing], axis=0), axis=2)
    return float(legs.sum(axis=0).max(initial=0.0))

"""Which circle is which dot, by all of them together.

A wrong pose moves all dots alike, so pairs are not judged one by one: the differences between found
and predicted dots are held against the covariance that they have together (joint compatibility,
Neira and Tardos 2001). Three dots leave nothing that would give a wrong match away, so the sizes of
the circles must fit the pose, too (``pipeline``).
"""

from __future__ import annotations

from itertools import product

import numpy as np

from models.arrays import Floats, Indices
from models.camera import Camera
from models.markers import MarkerPattern
from pipelines.pnp.predicted_pose import PredictedPose
from pipelines.pnp.projection_jacobian import jacobian_by_turn

NEAREST, FEW_DOTS = 4, 5  # circles tried for a dot; for each of more dots than a few, one
MISSING_CHI2 = 25.0  # what a dot without a circle costs
MOST_RANKED = 6


def rank_matches(
    camera: Camera,
    markers: MarkerPattern,
    predicted: PredictedPose,
    expected_px: Floats,
    circles_px: Floats,
    sigma_px: float,
    gate_sigmas: float,
) -> list[Indices]:
    """Return the likeliest assignments, best first.

    Parameters
    ----------
    camera : Camera
    markers : MarkerPattern
        Of n dots.
    predicted : PredictedPose
    expected_px : (n, 2) array, px
        Where the prediction has the middles of the dots' images; NaN for one out of sight.
    circles_px : (k, 2) array, px
    sigma_px : float, px
        1-sigma of a circle's centre.
    gate_sigmas : float
        How far a dot may be from its prediction, alone.

    Returns
    -------
    list of (n,) int arrays
        The circle of each dot, or -1.
    """
    count = len(markers)
    focal = np.array([[camera.fx], [camera.fy]])
    pose = predicted.pose
    jacobian = focal * jacobian_by_turn(pose.rotation, pose.translation, markers.points_in_target)
    flat = jacobian.reshape(2 * count, 6)
    spread = flat @ predicted.covariance @ flat.T + sigma_px**2 * np.eye(2 * count)
    choices: list[list[int]] = []
    for index in range(count):
        if not np.isfinite(expected_px[index]).all() or len(circles_px) == 0:
            choices.append([-1])
            continue
        away = circles_px - expected_px[index]
        own = spread[2 * index : 2 * index + 2, 2 * index : 2 * index + 2]
        square = np.einsum("ki,ij,kj->k", away, np.linalg.inv(own), away)
        near = np.argsort(square, kind="stable")[: NEAREST if count <= FEW_DOTS else 1]
        choices.append([*(int(k) for k in near if square[k] < gate_sigmas**2), -1])
    ranked = []
    for chosen in product(*choices):
        taken = [circle for circle in chosen if circle >= 0]
        if len(set(taken)) < len(taken):
            continue
        rows = [index for index in range(count) if chosen[index] >= 0]
        cost = MISSING_CHI2 * (count - len(rows))
        if rows:
            lines = np.array([[2 * index, 2 * index + 1] for index in rows]).ravel()
            away = (circles_px[taken] - expected_px[rows]).ravel()
            cost += float(away @ np.linalg.solve(spread[np.ix_(lines, lines)], away))
        ranked.append((cost, chosen))
    ranked.sort(key=lambda each: each[0])
    return [np.array(chosen, dtype=np.int64) for _, chosen in ranked[:MOST_RANKED]]

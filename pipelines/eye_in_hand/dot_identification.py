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
from pipelines.detection.disc_outline import DiscOutlines
from pipelines.detection.dot_candidates import DotCandidates
from pipelines.pnp.predicted_pose import PredictedPose
from pipelines.pnp.projection_jacobian import jacobian_by_turn

NEAREST, FEW_DOTS = 8, 5  # circles tried for a dot; for each of more dots than a few, one
MISSING_CHI2 = 25.0  # what a dot without a circle costs
MOST_RANKED, MOST_WITHOUT_ONE = 5, 3
ARC_SIGMA = 0.25  # of what is missing of a circle: a shadow may cut a dot, foil is seldom round
SIZE_SHARE, SIZE_PX = 0.05, 0.7  # 1-sigma of a circle's radius: relative, and px


def rank_matches(
    camera: Camera,
    markers: MarkerPattern,
    predicted: PredictedPose,
    expected: DiscOutlines,
    circles: DotCandidates,
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
    expected : DiscOutlines
        Of the n dots, where the prediction has them; NaN for one out of sight.
    circles : DotCandidates
        k circles. A wrong distance makes all dots larger alike, so that the circles of one
        assignment are held against each other in size, and not against the prediction.
    sigma_px : float, px
        1-sigma of a circle's centre.
    gate_sigmas : float
        How far a dot may be from its prediction, alone.

    Returns
    -------
    list of (n,) int arrays
        The circle of each dot, or -1. Some in which one dot alone has none are among them: where
        the prediction is vague, there are likelier ones of three wrong circles.
    """
    count, expected_px, circles_px = len(markers), expected.area_centres_px, circles.centres
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
            cost += _unlike(circles.radii[taken], expected.radii_px[rows])
            cost += float((((1.0 - circles.arcs[taken]) / ARC_SIGMA) ** 2).sum())
            away = (circles_px[taken] - expected_px[rows]).ravel()
            cost += float(away @ np.linalg.solve(spread[np.ix_(lines, lines)], away))
        ranked.append((cost, chosen))
    ranked.sort(key=lambda each: each[0])
    first = [chosen for _, chosen in ranked[:MOST_RANKED]]
    without = [chosen for _, chosen in ranked if sum(k < 0 for k in chosen) == 1]
    told = dict.fromkeys([*first, *without[:MOST_WITHOUT_ONE]])
    return [np.array(chosen, dtype=np.int64) for chosen in told]


def _unlike(radii: Floats, expected: Floats) -> float:
    """Return how far circles are from being larger than expected all alike, in sigmas squared."""
    ratio = np.log(radii / expected)
    weight = 1.0 / (SIZE_SHARE**2 + (SIZE_PX / radii) ** 2)
    middle = float((weight * ratio).sum() / weight.sum())
    return float((weight * (ratio - middle) ** 2).sum())

"""Poses proposed by few matches and voted for by all: for when the nearest match is not the right.

Three pairs give up to four poses (P3P); the pose that most markers find a candidate for wins and
is solved anew from all of them by SQPNP (Terzakis and Lourakis 2020). OpenCV's iterative solver
without a guess is never used: with all but one marker in a plane it is wrong most of the time.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, product

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats, Indices, Mask
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from pipelines.pnp.identification import one_to_one
from pipelines.pnp.predicted_pose import PredictedPose
from pipelines.pnp.projection_jacobian import project_normalised

MOST_TRIPLES = 400  # P3P calls; each with its votes takes about 0.5 ms
CANDIDATES_EACH = 3  # nearest candidates tried for a marker
MOST_MARKERS = 7  # from which triples are drawn, those with the fewest candidates first
FAR_CHI2 = 60.0  # a pose further from the prediction (six dimensions) is absurd


def propose_match(
    camera: Camera,
    markers: MarkerPattern,
    points_px: Floats,
    allowed: Mask,
    predicted: PredictedPose,
    vote_px: float,
) -> tuple[RigidTransform, Indices] | None:
    """Find the pose for which most markers have a candidate of their own.

    Parameters
    ----------
    camera : Camera
    markers : MarkerPattern
    points_px : (n, 2) array, px
        Candidates.
    allowed : (n, m) array of bool
        Which candidate may be which marker.
    predicted : PredictedPose
    vote_px : float, px
        A marker votes for a pose that brings it within this distance of a candidate.

    Returns
    -------
    pose : RigidTransform
    matched : (n,) int array
        The marker of each candidate, or -1.

    None if no pose has more votes than the three that made it.
    """
    normalised = camera.normalise(points_px)
    focal_px = 0.5 * (camera.fx + camera.fy)
    vote = vote_px / focal_px
    best: tuple[float, RigidTransform, Indices] | None = None
    for pairs in _triples(points_px, allowed, markers, predicted, camera):
        for pose in _p3p(markers, normalised, pairs, predicted):
            if predicted.squared_distance(pose) > FAR_CHI2:
                continue
            reprojected = project_normalised(
                pose.rotation, pose.translation, markers.points_in_target
            )
            squared = ((normalised[:, None] - reprojected[None, :]) ** 2).sum(axis=-1) / vote**2
            squared = np.where(np.isfinite(squared), squared, np.inf)
            score = float(np.maximum(1.0 - squared.min(axis=0), 0.0).sum())
            if best is None or score > best[0]:
                matched = one_to_one(squared, squared < 1.0)
                best = (score, pose, matched)
    if best is None or np.count_nonzero(best[2] >= 0) < 4:
        return None
    return _polished(markers, normalised, best[2], best[1]), best[2]


def _triples(
    points_px: Floats,
    allowed: Mask,
    markers: MarkerPattern,
    predicted: PredictedPose,
    camera: Camera,
) -> Iterator[list[tuple[int, int]]]:
    """Yield triples of (candidate, marker), the least ambiguous markers first."""
    reprojected = camera.project(predicted.pose @ markers.points_in_target)
    near: dict[int, list[int]] = {}
    for marker in range(len(markers)):
        candidates = np.flatnonzero(allowed[:, marker])
        gaps = np.linalg.norm(points_px[candidates] - reprojected[marker], axis=1)
        nearest = candidates[np.argsort(gaps, kind="stable")[:CANDIDATES_EACH]]
        if len(nearest):
            near[marker] = [int(candidate) for candidate in nearest]
    chosen = sorted(near, key=lambda marker: (len(near[marker]), marker))[:MOST_MARKERS]
    given = 0
    for trio in combinations(chosen, 3):
        spread = reprojected[list(trio)] - reprojected[list(trio)].mean(axis=0)
        if np.linalg.svd(spread, compute_uv=False)[1] < 3.0:
            continue  # in a line
        for three in product(*(near[marker] for marker in trio)):
            if len(set(three)) == 3:
                yield list(zip(three, trio, strict=True))
                given += 1
                if given >= MOST_TRIPLES:
                    return


def _p3p(
    markers: MarkerPattern,
    normalised: Floats,
    pairs: list[tuple[int, int]],
    predicted: PredictedPose,
) -> Iterator[RigidTransform]:
    """Yield the poses of three pairs that are in front of the camera and in reach."""
    reach = np.sqrt(FAR_CHI2 * np.diag(predicted.covariance)[3:]) + 1e-6
    candidates, chosen = (list(column) for column in zip(*pairs, strict=True))
    count, turns, shifts = cv2.solveP3P(
        markers.points_in_target[chosen][:, None, :],
        normalised[candidates][:, None, :],
        np.eye(3),
        None,
        flags=cv2.SOLVEPNP_P3P,
    )
    for number in range(count):
        shift = shifts[number].reshape(3)
        near = np.abs(shift - predicted.pose.translation) < reach  # false for NaN
        pose = _pose(turns[number], shift) if shift[2] > 0.0 and near.all() else None
        if pose is not None:
            yield pose


def _pose(turn: Floats, shift: Floats) -> RigidTransform | None:
    if not (np.isfinite(turn).all() and np.isfinite(shift).all()):
        return None
    return RigidTransform(Rotation.from_rotvec(turn.reshape(3)).as_matrix(), shift.reshape(3))


def _polished(
    markers: MarkerPattern, normalised: Floats, matched: Indices, pose: RigidTransform
) -> RigidTransform:
    """Solve from all votes at once, by a method that needs no guess."""
    voted = matched >= 0
    ok, turn, shift = cv2.solvePnP(
        markers.points_in_target[matched[voted]],
        normalised[voted],
        np.eye(3),
        None,
        flags=cv2.SOLVEPNP_SQPNP,
    )
    solved = _pose(turn, shift) if ok else None
    return solved if solved is not None and solved.translation[2] > 0.0 else pose

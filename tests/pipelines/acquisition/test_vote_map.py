"""The map of votes against distances taken one by one."""

from __future__ import annotations

import numpy as np

from pipelines.acquisition.vote_map import VoteMap
from tests.support.point_targets import CAMERA, any_pose, seen_points, telescope_target

TARGET = telescope_target()
REACH_PX = 12.0
# A cell is a quarter of the reach: a distance errs by 0.71 cells, a vote by 2 * 0.71 / 4 at most.
LARGEST_VOTE_ERROR = 0.36
MEAN_VOTE_ERROR = 0.06


def test_votes_are_those_of_the_distances() -> None:
    rng = np.random.default_rng(1)
    pose = any_pose(rng)
    points, _ = seen_points(TARGET, pose, rng, 1.0)
    away = CAMERA.fx * CAMERA.normalise(points)
    votes = VoteMap(away, REACH_PX)
    poses = [
        pose.perturbed(0.01 * rng.standard_normal(3), 0.1 * rng.standard_normal(3))
        for _ in range(50)
    ]
    given = votes.votes_for(
        np.array([one.rotation for one in poses]),
        np.array([one.translation for one in poses]),
        TARGET.points_in_target,
        CAMERA.fx,
    )
    errors = []
    for one, vote in zip(poses, given, strict=True):
        seen = CAMERA.project(one @ TARGET.points_in_target)
        nearest = np.linalg.norm(seen[:, None] - points, axis=-1).min(axis=1)
        errors.append(vote - np.maximum(1.0 - (nearest / REACH_PX) ** 2, 0.0).sum())
    assert np.abs(errors).max() < LARGEST_VOTE_ERROR * len(TARGET)
    assert abs(np.mean(errors)) < MEAN_VOTE_ERROR * len(TARGET)


def test_a_target_elsewhere_or_behind_gets_no_vote() -> None:
    rng = np.random.default_rng(2)
    pose = any_pose(rng)
    points, _ = seen_points(TARGET, pose, rng, 1.0)
    votes = VoteMap(CAMERA.fx * CAMERA.normalise(points), REACH_PX)
    aside = pose.translation + np.array([40.0, 0.0, 0.0])
    behind = pose.translation * [1.0, 1.0, -1.0]
    given = votes.votes_for(
        np.stack([pose.rotation] * 3),
        np.stack([pose.translation, aside, behind]),
        TARGET.points_in_target,
        CAMERA.fx,
    )
    assert given[0] > 0.9 * len(TARGET)
    assert given[1] == given[2] == 0.0

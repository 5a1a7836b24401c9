"""The truth of a synthetic dataset, or something near it, as what a method says."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from models.pose import RigidTransform

Change = Callable[[RigidTransform], RigidTransform]


def said_truth(
    dataset: Any, change: Change = lambda pose: pose, without: tuple[int, ...] = ()
) -> list[tuple[int, float, RigidTransform]]:
    """Return frame, time and pose of every frame.

    Parameters
    ----------
    dataset : SyntheticImages or SyntheticDataset
    change : callable
        Of each pose.
    without : tuple of int
        Frames of which nothing is said.
    """
    times_s = {entry.index: entry.time_s for entry in dataset.entries}
    return [
        (truth.frame, times_s[truth.frame], change(truth.cam_from_target))
        for truth in dataset.truths
        if truth.frame not in without
    ]

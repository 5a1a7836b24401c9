"""What finds poses of an uncooperative target in one kind of frame: points, or images.

``pipelines.uncooperative.pipeline`` drives one of them: ``acquire`` until there is a pose, then
``track`` with the filters' prediction. Neither raises on what a frame shows; neither knows of the
filters.
"""

from __future__ import annotations

from typing import Protocol, TypeVar

from models.arrays import Floats
from models.estimate import Estimate
from models.pose import RigidTransform

Seen = TypeVar("Seen", contravariant=True)


class PoseFinder(Protocol[Seen]):
    """Finds the target's pose in frames of one kind."""

    def acquire(self, frame: Seen) -> Estimate:
        """Find the pose without any earlier one."""

    def track(self, frame: Seen, predicted: RigidTransform, covariance: Floats) -> Estimate:
        """Find the pose near a predicted one.

        Parameters
        ----------
        frame
        predicted : RigidTransform
            ``cam_from_target``.
        covariance : (6, 6) array, rad and m
            Of the prediction: rotation first, as in ``RigidTransform.perturbed``.
        """

    @property
    def found_anew(self) -> bool:
        """Whether the last pose tracked owes nothing to the prediction and surely fits."""

    def matched_share(self, frame: Seen, estimate: Estimate) -> float:
        """Return how much of what should match did, from 0 to 1; low over time means a wrong pose.

        Where there is no pose it is 0.
        """

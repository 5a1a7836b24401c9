"""How the camera moves about the target."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from models.arrays import Floats
from models.errors import ScenarioError
from models.motion.perturbed_tumble import PerturbedTumble
from models.motion.relative_state import ChaserState, RelativeState
from models.motion.tumble import OVERTIME_S, Tumble
from models.pose import RigidTransform


class Trajectory(Protocol):
    """A true motion: the pose at any instant."""

    def cam_from_target(self, time_s: float, /) -> RigidTransform:
        """Return the true pose."""
        ...


@dataclass(frozen=True, eq=False)
class FreeMotion:
    """A target that turns freely beside a chaser on an orbit: relative and absolute states.

    A shutter that is open over the motion's start or end asks for an instant just beyond; the
    motion is carried on there by its own reflection, which errs by the square of that time.

    Attributes
    ----------
    tumble : Tumble or PerturbedTumble
    """

    tumble: Tumble | PerturbedTumble

    def cam_from_target(self, time_s: float) -> RigidTransform:
        """Return the true pose."""
        end_s = self._end_beside(time_s)
        if end_s is None:
            return self.tumble.cam_from_target(time_s)
        at_end = self.tumble.cam_from_target(end_s)
        inside = self.tumble.cam_from_target(2.0 * end_s - time_s)
        return RigidTransform(
            at_end.rotation @ inside.rotation.T @ at_end.rotation,
            2.0 * at_end.translation - inside.translation,
        )

    def target_from_inertial(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation from the orbit's inertial frame into target axes."""
        return self._reflected(self._target_from_inertial, time_s)

    def state(self, time_s: float) -> RelativeState:
        """Return the target's true state in the chaser's local frame."""
        return self.tumble.state(time_s)

    def chaser_state(self, time_s: float) -> ChaserState:
        """Return the chaser's true state in the orbit's inertial frame."""
        if self._end_beside(time_s) is None:
            return self.tumble.chaser_state(time_s)
        return self.tumble.chaser_state_beside(time_s)

    def check_time(self, time_s: float) -> None:
        """Refuse an instant outside the motion.

        Raises
        ------
        ScenarioError
        """
        if self._end_beside(time_s) is not None:
            raise ScenarioError(
                f"expected a time between 0 and {self.tumble.duration_s:g} s, where the target's "
                f"motion ends, got {time_s:g} s; give a later motion.end_s"
            )

    def _target_from_inertial(self, time_s: float) -> Floats:
        inertial_from_lvlh = self.tumble.inertial_from_lvlh(time_s)
        return (inertial_from_lvlh @ self.tumble.state(time_s).R_lvlh_from_target).T

    def _reflected(self, rotation: Callable[[float], Floats], time_s: float) -> Floats:
        end_s = self._end_beside(time_s)
        if end_s is None:
            return rotation(time_s)
        at_end = rotation(end_s)
        return np.asarray(at_end @ rotation(2.0 * end_s - time_s).T @ at_end)

    def _end_beside(self, time_s: float) -> float | None:
        """Return the end of the motion beyond which a time lies; None within it."""
        if time_s < -OVERTIME_S:
            return 0.0
        if time_s > self.tumble.duration_s + OVERTIME_S:
            return self.tumble.duration_s
        return None

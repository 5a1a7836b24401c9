"""Where a target was at earlier times, by what is known of it at the last one.

Nothing disturbs its motion, so state and inertia at one time tell all poses, and each image has had
its say in them: what is known at the end of a run is truer of its beginning than what was known
then.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.errors import DatasetError
from models.estimate import Estimate
from pipelines.unknown_target import inertia_chart
from pipelines.unknown_target.free_tumble import FreeTumble
from pipelines.unknown_target.observation_rows import Epochs, Placed, placed
from pipelines.unknown_target.pipeline import INERTIA, MOTION
from pipelines.unknown_target.unknowns import CHART, OMEGA, RHO, RHO_DOT, SHARED, Unknowns

SHORTEST_S = 1e-3  # that a tumble is followed


@dataclass(frozen=True, eq=False)
class KnownMotion:
    """A target's motion at one time.

    Attributes
    ----------
    time_s : float, s
    shared : (14,) array
        As ``Unknowns`` has them, at that time.
    R_lvlh_from_target : (3, 3) array
    R_cam_from_lvlh : (3, 3) array
        Of the camera, which is mounted fast.
    mean_motion_rad_s : float, rad/s
        Of the target's circular orbit.
    """

    time_s: float
    shared: Floats
    R_lvlh_from_target: Floats
    R_cam_from_lvlh: Floats
    mean_motion_rad_s: float

    @classmethod
    def of(cls, said: Estimate, R_cam_from_lvlh: Floats, mean_motion_rad_s: float) -> KnownMotion:
        """Take it out of an estimate.

        Parameters
        ----------
        said : Estimate
        R_cam_from_lvlh : (3, 3) array
        mean_motion_rad_s : float, rad/s

        Raises
        ------
        DatasetError
            If the estimate has no pose, or lacks a state.
        """
        if said.pose is None or not {MOTION, INERTIA} <= set(said.states):
            raise DatasetError(
                f"frame {said.frame}: expected a pose with the states {MOTION} and {INERTIA}, got "
                f"{said.reason or 'none of them'}; name the estimates of a pipeline for an unknown "
                "target"
            )
        motion, inertia = said.states[MOTION].values, said.states[INERTIA].values
        shared = np.zeros(SHARED)
        try:
            shared[RHO] = motion["rho_in_lvlh_m"]
            shared[RHO_DOT] = motion["rho_dot_in_lvlh_m_s"]
            shared[OMEGA] = motion["omega_in_target_rad_s"]
            shared[CHART] = inertia_chart.chart_of(inertia["inertia_of_trace_1"])
        except (KeyError, ValueError) as error:
            raise DatasetError(
                f"frame {said.frame}: expected the states {MOTION} and {INERTIA} of an unknown "
                f"target, got: {error}; estimate again"
            ) from error
        turn = R_cam_from_lvlh.T @ said.pose.cam_from_target.rotation
        return cls(said.time_s, shared, turn, R_cam_from_lvlh, mean_motion_rad_s)

    def at(self, times_s: Floats) -> Placed:
        """Return where the target was.

        Parameters
        ----------
        times_s : (f,) array, s
            None later than its own.

        Returns
        -------
        Placed
            Of f epochs.

        Raises
        ------
        ValueError
            If a time is later.
        """
        after = np.asarray(times_s, dtype=np.float64) - self.time_s
        if (after > SHORTEST_S).any():
            raise ValueError(
                f"expected times up to {self.time_s} s, got {self.time_s + after.max()} s"
            )
        back_s = min(float(after.min(initial=0.0)), -SHORTEST_S)
        tumble = FreeTumble(
            self.shared[OMEGA],
            self.shared[CHART],
            self.R_lvlh_from_target,
            self.mean_motion_rad_s,
            back_s,
        )
        each = [
            Epochs.of(min(float(one), 0.0), self.R_cam_from_lvlh, self.mean_motion_rad_s)
            for one in after
        ]
        epochs = each[0]
        for one in each[1:]:
            epochs = epochs.followed_by(one)
        return placed(Unknowns(self.shared, np.zeros((0, 3))), tumble, epochs)

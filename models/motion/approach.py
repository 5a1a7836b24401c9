"""The final approach of Opromolla et al. 2022, section 4.1: the true pose at any instant.

The target flies on a geostationary orbit, Earth deck down, launch adaptor ring up. The chaser
comes down on it from above along a closed 2-by-1 relative ellipse and looks at the markers.

The *orbital target frame* used here has the target's centre of mass as origin and the nominal
target axes: z away from Earth, x backward along the orbit, y opposite to the orbit normal. (The
paper leaves x and y open; so the ellipse's curvature carries the aim towards -x, as there.)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.arrays import Floats
from models.motion.aimed_camera import aimed_camera
from models.motion.attitude_wobble import AttitudeWobble
from models.motion.clohessy_wiltshire import (
    GEO_SEMI_MAJOR_AXIS_M,
    mean_motion,
    propagate,
    state_on_closed_ellipse,
)
from models.pose import RigidTransform
from models.spacecraft.retroreflector_layout import RETROREFLECTORS

_X, _Y, _Z = RETROREFLECTORS.points_in_target.mean(axis=0).tolist()
PATTERN_CENTRE: tuple[float, float, float] = (_X, _Y, _Z)

# Rows: the orbital target axes x, y, z in (radial, along-track, normal).
ORBITAL_TARGET_FROM_HILL = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])


@dataclass(frozen=True)
class Approach:
    """One approach; every pose is a pure function of these numbers and of time.

    Attributes
    ----------
    semi_major_axis_m : float, m
        Of the closed relative ellipse; the chaser passes the target radially at half of it times
        the mean motion, 0.015 m/s.
    start_range_m : float, m
        Height of the camera above the ring plane at time 0, were it to look straight down. At the
        ellipse's speed 330 s are 4.94 m, not the 4.9 m between the paper's rounded 6.7 and 1.8 m;
        so it starts at 6.73 m along the boresight and ends at 1.77 m, which round to both.
    duration_s : float, s
        Until the camera is about 1.8 m from the ring plane, and #1 the last marker lost.
    target_com_to_ring_m : float, m
        From the target's centre of mass up to the ring plane.
    chaser_com_to_camera_m : float, m
        Along the boresight.
    pattern_centre : tuple of three floats, m
        What the chaser means to look at, target frame; it flies above this point's y.
    aim_slew_m, aim_slew_middle_s, aim_slew_time_s : float, m, s, s
        The slow slew of the aim towards -x late in the approach, see ``aim_in_target``.
    pointing_accuracy_deg, max_rate_deg_s : float, deg and deg/s
        Bounds on the target's sway: per axis, and in all.
    seed : int
        Draws the target's sway.

    Raises
    ------
    ValueError
        If a length or the duration is not positive or finite.
    """

    semi_major_axis_m: float = 411.0
    start_range_m: float = 6.72
    duration_s: float = 330.0
    target_com_to_ring_m: float = 1.8
    chaser_com_to_camera_m: float = 1.5
    pattern_centre: tuple[float, float, float] = PATTERN_CENTRE
    aim_slew_m: float = 0.153
    aim_slew_middle_s: float = 268.0
    aim_slew_time_s: float = 15.5
    pointing_accuracy_deg: float = 2.0
    max_rate_deg_s: float = 0.02
    seed: int = 0

    def __post_init__(self) -> None:
        lengths_and_times = (
            self.semi_major_axis_m,
            self.start_range_m,
            self.duration_s,
            self.target_com_to_ring_m,
            self.chaser_com_to_camera_m,
            self.aim_slew_time_s,
        )
        if not all(0.0 < value < np.inf for value in lengths_and_times):
            raise ValueError(f"approach: expected finite lengths and times above zero, got {self}")
        if not np.isfinite([*self.pattern_centre, self.aim_slew_m, self.aim_slew_middle_s]).all():
            raise ValueError(f"approach: expected a finite aim, got {self}")

    @cached_property
    def mean_motion_rad_s(self) -> float:
        """Of the target's orbit, rad/s."""
        return mean_motion(GEO_SEMI_MAJOR_AXIS_M)

    @property
    def crossing_speed_m_s(self) -> float:
        """Speed with which the ellipse crosses the target, along the radial, m/s."""
        return 0.5 * self.semi_major_axis_m * self.mean_motion_rad_s

    @cached_property
    def wobble(self) -> AttitudeWobble:
        """How the target sways."""
        return AttitudeWobble.drawn(self.pointing_accuracy_deg, self.max_rate_deg_s, self.seed)

    @cached_property
    def _start_state(self) -> Floats:
        height = self.start_range_m + self.target_com_to_ring_m + self.chaser_com_to_camera_m
        return state_on_closed_ellipse(
            self.semi_major_axis_m,
            self.mean_motion_rad_s,
            radial_m=height,
            normal_m=-self.pattern_centre[1],
        )

    def chaser_in_orbital_target(self, time_s: float) -> Floats:
        """Return the chaser's centre of mass, (3,), m, in the orbital target frame."""
        state = propagate(self._start_state, self.mean_motion_rad_s, time_s)
        return ORBITAL_TARGET_FROM_HILL @ state[:3]

    def along_track_curvature_m(self, time_s: float) -> float:
        """Return how far the ellipse has left its starting tangent, along x, m.

        About ``-n v t^2``: -0.12 m after 330 s.
        """
        start = ORBITAL_TARGET_FROM_HILL @ self._start_state[:3]
        velocity = ORBITAL_TARGET_FROM_HILL @ self._start_state[3:]
        return float((self.chaser_in_orbital_target(time_s) - start - velocity * time_s)[0])

    def aim_slew(self, time_s: float) -> float:
        """Return the slow slew of the aim along x, m: from 0 smoothly to ``-aim_slew_m``."""
        progress = np.tanh((time_s - self.aim_slew_middle_s) / self.aim_slew_time_s)
        return float(-0.5 * self.aim_slew_m * (1.0 + progress))

    def aim_in_target(self, time_s: float) -> Floats:
        """Return where the boresight goes, (3,), m, target frame.

        It starts at the pattern's centre and wanders towards -x for two reasons. The guidance
        reckons with a straight line, so the ellipse's along-track curvature carries the aim with
        it; and late in the approach the attitude slews a little further. Together about 0.15 m at
        268 s, 0.25 m at 296 s and 0.27 m at 330 s, which loses #2, then #4, then #6 and #1
        (Opromolla et al. 2022, section 5.1.1).
        """
        wander = self.along_track_curvature_m(time_s) + self.aim_slew(time_s)
        return np.array(self.pattern_centre) + np.array([wander, 0.0, 0.0])

    def orbital_target_from_target(self, time_s: float) -> RigidTransform:
        """Return the target's true pose: it sways about its centre of mass."""
        rotation = self.wobble.nominal_from_target(time_s)
        return RigidTransform(rotation, rotation @ [0.0, 0.0, self.target_com_to_ring_m])

    def cam_from_target(self, time_s: float) -> RigidTransform:
        """Return the true pose at ``time_s`` after the start.

        The boresight runs from the chaser's centre of mass through the lens to the aim, the
        camera's x axis is as near the orbital target frame's x as that allows: facing the target,
        R is near diag(1, -1, -1).
        """
        orbital_from_target = self.orbital_target_from_target(time_s)
        chaser = self.chaser_in_orbital_target(time_s)
        aim = orbital_from_target @ self.aim_in_target(time_s)
        return aimed_camera(chaser, aim, self.chaser_com_to_camera_m) @ orbital_from_target

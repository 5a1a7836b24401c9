"""The absolute navigator as a pipeline: frames of table streams in, named states out."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.errors import DatasetError
from models.estimate import Estimate, NamedState
from models.frame import Frame
from models.motion.perturbed_orbit import lvlh_axes
from models.navigation_tables import records_of
from models.sky.moon_ephemeris import moon_position_in_inertial
from models.sky.sun_ephemeris import sun_position_in_inertial
from pipelines.absolute.error_state import (
    ACCELERATION,
    ATTITUDE,
    CLOCK,
    GYRO_BIAS,
    POSITION,
    VELOCITY,
    AbsoluteState,
)
from pipelines.absolute.integrity import protection_levels_m
from pipelines.absolute.knowledge import AbsoluteKnowledge
from pipelines.absolute.navigator import AbsoluteNavigator, started_from
from pipelines.absolute.options import AbsoluteOptions

ORBIT, TURN, RECEIVER_CLOCK, INTEGRITY = "chaser_orbit", "chaser_attitude", "clock", "integrity"
STALE_S = 2.0  # without turns for so long, the attitude is not known any more
BODIES_EVERY_S = 10.0  # Sun and Moon are asked for anew: they move by 10 km


class AbsoluteNavigation:
    """One run.

    Parameters
    ----------
    knowledge : AbsoluteKnowledge
    options : AbsoluteOptions
    """

    def __init__(self, knowledge: AbsoluteKnowledge, options: AbsoluteOptions) -> None:
        self._knowledge = knowledge
        self._bodies: tuple[float, tuple[Floats, Floats]] | None = None
        state = started_from(
            options,
            knowledge.position_m[None],
            knowledge.velocity_m_s[None],
            knowledge.q_inertial_from_body_wxyz[None],
        )
        self._navigator = AbsoluteNavigator(options, state, self._sun_and_moon)

    def process(self, frame: Frame) -> Estimate:
        """Take the records of a frame and say what the state is at its time.

        Parameters
        ----------
        frame : Frame
            Of the streams ``gnss``, ``inertial`` and ``star_attitude``; none has to speak.

        Returns
        -------
        Estimate
            States by name. ``chaser_orbit``: position and velocity, inertial, with their
            covariance (6, 6), and the acceleration that the model leaves out. ``chaser_attitude``:
            quaternion and gyro bias, with the covariance (6, 6) of the attitude's error in body
            axes and the bias. ``clock``: bias and drift in m and m/s, (2, 2). ``integrity``:
            protection levels along radial, track and normal, satellites used and edited, those
            named as liars, star frames refused, times of doubt, late records. Or a reason, where
            turns are missing.
        """
        try:
            records = records_of(frame.readings)
        except DatasetError as error:
            return Estimate(frame.index, frame.time_s, reason=f"records that cannot be: {error}")
        for record in records:
            self._navigator.take(record)
        behind_s = frame.time_s - self._navigator.state.time_s
        if behind_s > STALE_S:
            return Estimate(
                frame.index, frame.time_s, reason=f"no turns for the last {behind_s:.1f} s"
            )
        mode = "in doubt" if self._navigator.integrity.doubts[0] else "navigating"
        states = self._states(self._navigator.carried_to(frame.time_s))
        return Estimate(frame.index, frame.time_s, mode=mode, states=states)

    def _states(self, state: AbsoluteState) -> dict[str, NamedState]:
        integrity = self._navigator.integrity
        vector, covariance = state.vector[0], state.covariance[0]
        orbit = slice(POSITION.start, VELOCITY.stop)
        turn = slice(ATTITUDE.start, GYRO_BIAS.stop)
        axes = lvlh_axes(vector[POSITION], vector[VELOCITY])
        gnss = integrity.gnss
        edited = 0 if gnss is None or gnss.edited is None else int(gnss.edited[0].sum())
        told = {
            "protection_m": protection_levels_m(covariance[POSITION, POSITION], axes),
            "satellites_used": np.array(0 if gnss is None else len(gnss.satellite) - edited),
            "satellites_edited": np.array(edited),
            "liars": np.array(integrity.liars(), dtype=np.float64),
            "stars_refused": integrity.refused_stars[0],
            "doubts": integrity.doubts[0],
            "late_records": np.array(integrity.late),
        }
        return {
            ORBIT: NamedState(
                {
                    "position_in_inertial_m": vector[POSITION],
                    "velocity_in_inertial_m_s": vector[VELOCITY],
                    "left_out_in_inertial_m_s2": vector[ACCELERATION],
                },
                covariance[orbit, orbit],
            ),
            TURN: NamedState(
                {
                    "q_inertial_from_body_wxyz": state.q_inertial_from_body_wxyz[0],
                    "gyro_bias_in_body_rad_s": vector[GYRO_BIAS],
                },
                covariance[turn, turn],
            ),
            RECEIVER_CLOCK: NamedState(
                {"bias_m": vector[CLOCK][0], "drift_m_s": vector[CLOCK][1]},
                covariance[CLOCK, CLOCK],
            ),
            INTEGRITY: NamedState({name: np.asarray(each) for name, each in told.items()}),
        }

    def _sun_and_moon(self, time_s: float) -> tuple[Floats, Floats]:
        known = self._bodies
        if known is None or abs(time_s - known[0]) > BODIES_EVERY_S:
            epoch = self._knowledge.epoch
            found = (
                sun_position_in_inertial(epoch, time_s),
                moon_position_in_inertial(epoch, time_s),
            )
            known = self._bodies = (time_s, found)
        return known[1]

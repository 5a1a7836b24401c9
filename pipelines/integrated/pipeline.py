"""One unit that knows where it is and where its target is: GNSS, gyroscopes, stars and a camera.

The absolute filter takes the records up to an image and says where the chaser is and how it
stands; the relative filters take that, errors and all, as their chaser. Nothing goes back.

Source: Capuano et al. 2018 (VINAG), Figure 1.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.estimate import Detections, Estimate, NamedState
from models.frame import Frame
from models.motion.perturbed_orbit import lvlh_axes
from models.motion.relative_state import TRANSLATION, ChaserState
from models.pose import RigidTransform
from pipelines.absolute.integrity import protection_levels_m
from pipelines.absolute.pipeline import INTEGRITY, ORBIT, TURN, AbsoluteNavigation
from pipelines.filters.camera_mount import CameraMount
from pipelines.uncooperative.knowledge import Seen, shown
from pipelines.uncooperative.pipeline import Uncooperative

RELATIVE_PROTECTION = "relative_protection_m"


class IntegratedNavigation:
    """One run.

    Parameters
    ----------
    absolute : AbsoluteNavigation
    relative : Uncooperative
    cam_from_body : RigidTransform
        How the camera is mounted.
    relative_from_s : float, s
        Images before it are passed by: the unit is in its absolute mode (section 3).
    """

    def __init__(
        self,
        absolute: AbsoluteNavigation,
        relative: Uncooperative,
        cam_from_body: RigidTransform,
        relative_from_s: float = -np.inf,
    ) -> None:
        self._absolute = absolute
        self._relative = relative
        self._cam_from_body = cam_from_body
        self._last_s = -np.inf
        self._relative_from_s = relative_from_s

    def process(self, frame: Frame) -> Estimate:
        """Take the records of a frame and its image, and say both states.

        Parameters
        ----------
        frame : Frame
            An image, or points, and the streams of ``AbsoluteNavigation``. An image that is older
            than one before it is passed by; of records that come late, ``integrity`` counts how
            many.

        Returns
        -------
        Estimate
            Of the target as ``Uncooperative`` gives it: pose or reason, mode, states of the
            relative motion. Beside them the states of ``AbsoluteNavigation``; their ``integrity``
            has also ``relative_protection_m``, along radial, track and normal, where there is a
            relative state. In the absolute mode they are all, and the mode is ``absolute``.

        Raises
        ------
        DatasetError
            If the frame has neither an image nor points.
        """
        known = self._absolute.process(frame)
        if not known.states:
            reason = f"the chaser's own state is not known: {known.reason}"
            return replace(known, reason=reason, detections=Detections.none())
        if frame.time_s < self._relative_from_s:
            reason = f"in the absolute mode until {self._relative_from_s:g} s"
            return replace(known, reason=reason, detections=Detections.none(), mode="absolute")
        if frame.time_s <= self._last_s:
            reason = (
                f"came late: of {frame.time_s:g} s, after the image of {self._last_s:g} s; "
                "the filters go forward in time"
            )
            return replace(known, reason=reason, detections=Detections.none(), mode="late")
        self._last_s = frame.time_s
        said = self._relative.process_seen(self._seen(frame, known))
        return replace(said, states={**known.states, **said.states, INTEGRITY: _told(known, said)})

    def _seen(self, frame: Frame, known: Estimate) -> Seen:
        orbit, turn = known.states[ORBIT], known.states[TURN]
        chaser = ChaserState(
            frame.time_s,
            orbit.values["position_in_inertial_m"],
            orbit.values["velocity_in_inertial_m_s"],
        )
        return shown(frame, chaser, self._mount(chaser, turn))

    def _mount(self, chaser: ChaserState, turn: NamedState) -> CameraMount:
        """Return how the camera stands in the local frame, both as navigated.

        What the orbit's error turns the local frame by, some 1e-7 rad, is left out of its noise.
        """
        wxyz = turn.values["q_inertial_from_body_wxyz"]
        body_from_inertial = Rotation.from_quat(wxyz, scalar_first=True).as_matrix().T
        axes = lvlh_axes(chaser.position_in_inertial, chaser.velocity_in_inertial)
        body_from_lvlh = RigidTransform(body_from_inertial @ axes, np.zeros(3))
        covariance: Floats | None = None
        if turn.covariance is not None:
            own = self._cam_from_body.rotation
            covariance = own @ turn.covariance[:3, :3] @ own.T
        return CameraMount(self._cam_from_body @ body_from_lvlh, covariance)


def _told(known: Estimate, said: Estimate) -> NamedState:
    values = dict(known.states[INTEGRITY].values)
    relative = said.states.get(TRANSLATION)
    if relative is not None and relative.covariance is not None:
        levels = protection_levels_m(relative.covariance[:3, :3], np.eye(3))
        values[RELATIVE_PROTECTION] = levels
    return NamedState(values)

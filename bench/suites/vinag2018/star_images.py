"""The star sensor of a flight as a camera: each frame rendered, identified without a prior, solved.

A record is stamped with the middle of the exposure and reaches the filter then: reading out and
finding take a while that is left out. The sensor is told the turn rate as the gyroscopes measure
it, and its velocity as the orbit has it (a filter knows it to 1 m/s, three nanoradians of
aberration).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.navigation_records import StarAttitude
from models.sensors.star_camera import StarCamera
from models.sky.aberration import earth_velocity_m_s
from pipelines.star_attitude.star_sensor import StarSensor
from renders.flight.flight import Flight
from renders.star_images.star_frame import star_frame
from renders.star_images.star_view import EarthView, StarView, moon_disc, sun_disc

STAR_IMAGES = 9  # purpose, that sets the frames' draws apart


@dataclass(eq=False)
class ImagedStars:
    """One run's star camera.

    Attributes
    ----------
    flight : Flight
    sensor : StarCamera
    key : tuple of int
        Of the noise.
    refused : int
        Frames without an attitude so far.
    """

    flight: Flight
    sensor: StarCamera
    key: tuple[int, ...]
    refused: int = 0
    _finder: StarSensor = field(init=False)

    def __post_init__(self) -> None:
        self._finder = StarSensor(self.sensor)

    def attitude(
        self, time_s: float, q_inertial_from_body_wxyz: Floats, measured_rate: Floats
    ) -> StarAttitude | None:
        """Return what the camera makes of one frame; None if it is refused.

        Parameters
        ----------
        time_s : float, s
        q_inertial_from_body_wxyz : (4,) array
            True.
        measured_rate : (3,) array, rad/s
            By the gyroscopes, body axes.
        """
        view = self.view(time_s, q_inertial_from_body_wxyz)
        frame = round(time_s * 1e3)
        image = star_frame(view, self.sensor, (*self.key, STAR_IMAGES, frame))
        body_from_cam = self.sensor.body_from_cam
        fix = self._finder.find(image, body_from_cam.T @ measured_rate, view.velocity_m_s)
        if fix.cam_from_icrs is None or fix.covariance_rad2 is None:
            self.refused += 1
            return None
        turn = Rotation.from_matrix(fix.cam_from_icrs.T @ body_from_cam.T)
        covariance = body_from_cam @ fix.covariance_rad2 @ body_from_cam.T
        return StarAttitude(time_s, turn.as_quat(scalar_first=True)[None], covariance)

    def view(self, time_s: float, q_inertial_from_body_wxyz: Floats) -> StarView:
        """Return what the camera looks at: stars, and Sun, Moon and Earth where they are.

        Parameters
        ----------
        time_s : float, s
        q_inertial_from_body_wxyz : (4,) array
        """
        state = self.flight.orbit.states(np.array([time_s]))[0]
        sun_m, moon_m = self.flight.bodies(time_s)
        sun = (sun_m - state[:3]) / np.linalg.norm(sun_m - state[:3])
        inertial_from_body = Rotation.from_quat(
            q_inertial_from_body_wxyz, scalar_first=True
        ).as_matrix()
        rate = self.flight.attitude.rates(np.array([time_s]))[0]
        return StarView(
            (inertial_from_body @ self.sensor.body_from_cam).T,
            self.sensor.body_from_cam.T @ rate,
            earth_velocity_m_s(self.flight.epoch, time_s) + state[3:],
            (sun_disc(sun), moon_disc(moon_m - state[:3], sun)),
            EarthView(-state[:3], sun),
        )

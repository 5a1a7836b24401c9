"""Attitudes drawn at random, no prior: who is identified, who is wrong, and by how much off."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from bench.suites.units import Outcome
from bench.suites.vinag2018.flight import EPOCH
from bench.suites.vinag2018.star_bound import attitude_bound
from models.arrays import Floats
from models.quaternions import rotated
from models.sensors.star_camera import StarCamera, star_camera
from models.sky.aberration import earth_velocity_m_s
from models.sky.sun_ephemeris import epoch_of, sun_dir_in_inertial
from pipelines.star_attitude.star_sensor import StarFix, StarSensor
from renders.star_images.star_frame import exposed, mean_charge
from renders.star_images.star_view import FULL_MOON_MAG, Disc, StarView, sun_disc

ORBITAL_M_S = 7500.0
SUN_OFF_DEG = 30.0  # nearer to the boresight the baffle keeps nothing out
MOON_RADIUS_DEG = 0.26
SURVEY = 0x57A2  # purpose, that sets these draws apart from a flight's
WRONG_ARCSEC = 100.0  # about any axis: some ten sigmas of a frame with few stars


@dataclass(frozen=True)
class Sky:
    """What stands in the way of identification.

    Attributes
    ----------
    false_stars : int
        Of the point spread and of magnitudes from 2 to 6, anywhere on the chip.
    moon : bool
        Whether the full Moon stands somewhere on the chip.
    rate_deg_s : float, deg/s
        1 sigma of the turn rate on each axis.
    focal_error : float
        By how much of itself the true focal length is longer than the one told.
    share : float
        Of the attitudes asked for, that are drawn under this sky.
    """

    false_stars: int = 0
    moon: bool = False
    rate_deg_s: float = 0.06
    focal_error: float = 0.0
    share: float = 1.0


SKIES = {
    "nothing in the way": Sky(),
    "20 false stars and the Moon": Sky(20, True),
    "turning at half a degree a second": Sky(rate_deg_s=0.5, share=0.2),
    "a focal length 0.01 % too long": Sky(focal_error=1e-4, share=0.2),
}


@dataclass(frozen=True)
class SurveyTask:
    """Some attitudes.

    Attributes
    ----------
    sky : Sky
    first, count : int
        Numbers of the attitudes.
    seed : int
    pixels : int
        Of the camera, a side.
    options : str
        All settings as text.
    """

    sky: Sky
    first: int
    count: int
    seed: int
    pixels: int
    options: str


def survey(task: SurveyTask) -> Outcome:
    """Find all attitudes of a task.

    Returns
    -------
    Outcome
        By attitude (n): ``found``, ``error_rad`` (n, 3) of the rotation vector in camera axes, NaN
        where refused; ``stated_rad2`` and ``bound_rad2`` (n, 3, 3); ``spots``, ``stars``
        identified, ``triangles`` tried. Seconds of one core for each frame's attitude, light left
        out.
    """
    told = star_camera(task.pixels)
    finder = StarSensor(told)
    longer = 1.0 + task.sky.focal_error
    camera = replace(told.camera, fx=told.camera.fx * longer, fy=told.camera.fy * longer)
    sensor = replace(told, camera=camera)
    rows, seconds = [], []
    for number in range(task.first, task.first + task.count):
        view = drawn_view(task.sky, sensor, task.seed, number)
        mean_e = mean_charge(view, sensor)
        image = exposed(mean_e, sensor, (task.seed, number, SURVEY))
        began = time.process_time()
        fix = finder.find(image, view.rate_in_cam_rad_s, view.velocity_m_s)
        seconds.append(time.process_time() - began)
        rows.append(
            {
                "found": np.array(bool(fix)),
                "error_rad": error_of(fix, view),
                "stated_rad2": _or_nothing(fix.covariance_rad2, (3, 3)),
                "bound_rad2": attitude_bound(view, mean_e, sensor, finder.catalogue),
                "spots": np.array(len(fix.spots)),
                "stars": np.array(len(fix.identified)),
                "triangles": np.array(fix.triangles),
            }
        )
    return Outcome({name: np.stack([row[name] for row in rows]) for name in rows[0]},
                   np.array(seconds))  # fmt: skip


def drawn_view(sky: Sky, sensor: StarCamera, seed: int, number: int) -> StarView:
    """Draw an attitude, a turn rate and what is in the way; the Sun is where the baffle shades it.

    Parameters
    ----------
    sky : Sky
    sensor : StarCamera
    seed, number : int
    """
    rng = np.random.default_rng([seed, number, SURVEY])
    sun = sun_dir_in_inertial(epoch_of(EPOCH))
    while True:
        quaternion = rng.standard_normal(4)
        quaternion /= np.linalg.norm(quaternion)
        cam_from_icrs = rotated(quaternion, np.eye(3)).T
        if np.rad2deg(np.arccos(cam_from_icrs[2] @ sun)) > SUN_OFF_DEG:
            break
    rate = np.deg2rad(sky.rate_deg_s) * rng.standard_normal(3)
    course = rng.standard_normal(3)
    velocity = earth_velocity_m_s(epoch_of(EPOCH)) + ORBITAL_M_S * course / np.linalg.norm(course)
    size = (sensor.camera.width, sensor.camera.height)
    moon_px = rng.random(2) * size - 0.5
    false_px = rng.random((sky.false_stars, 2)) * size - 0.5
    discs = [sun_disc(sun)]
    if sky.moon:
        moon = cam_from_icrs.T @ sensor.camera.rays(moon_px[None])[0]
        discs.append(Disc(moon, FULL_MOON_MAG, MOON_RADIUS_DEG))
    return StarView(
        cam_from_icrs,
        rate,
        velocity,
        tuple(discs),
        None,
        false_px,
        2.0 + 4.0 * rng.random(sky.false_stars),
    )


def error_of(fix: StarFix, view: StarView) -> Floats:
    """Return the rotation vector that carries the truth to what was found, (3,), rad; or NaN."""
    if fix.cam_from_icrs is None:
        return np.full(3, np.nan)
    return Rotation.from_matrix(fix.cam_from_icrs @ view.cam_from_icrs.T).as_rotvec()


def _or_nothing(array: Floats | None, shape: tuple[int, ...]) -> Floats:
    return np.full(shape, np.nan) if array is None else array

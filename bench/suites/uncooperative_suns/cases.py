"""What is drawn of a study: short motions, each under some Suns, with the Earth's light or without.

Each draw is keyed by the seed, the target and the number of the motion, and never in sequence: the
n-th start is the same however many others there are.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from bench.random_dataset.draws import at_angle, log_uniform
from models.arrays import Floats
from models.camera import Camera
from models.lights.earth import EARTH_RADIUS_KM, GEO_RADIUS_KM
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.relative_state import ChaserState
from models.motion.tumble import CAM_FROM_LVLH
from models.pose import RigidTransform

SUNS = 4  # of a motion: their light is traced together
IMAGES = 5  # that a start may look at
SHARES = (1.0 / 20.0, 1.0 / 4.0)  # of the field's width that the target is across
OFF_AXIS = 0.3  # of half the field, that the target may be off the boresight
RATES_DEG_S = (0.1, 3.0)
STEPS_S = (1.0, 20.0)
PHASES_DEG = (0.0, 170.0)
EARTH_AWAY_DEG = 60.0  # of the boresight, at least: it lights the target and is not behind it
MOTION_DRAW, SUN_DRAW, TOLD_DRAW = 1, 2, 3  # purposes that key the draws
MOST_DRAWS = 200
SUN_SIGMA_DEG = 0.3  # of a coarse attitude: the ephemeris itself is nearly exact
ORBIT = KeplerOrbit.from_elements_deg(
    a_km=GEO_RADIUS_KM, e=0.0, i_deg=0.0, raan_deg=0.0, argument_of_perigee_deg=0.0,
    true_anomaly_deg=0.0,
)  # fmt: skip


@dataclass(frozen=True)
class MotionTask:
    """One short motion of one target, under some Suns.

    Attributes
    ----------
    target : str
        A spacecraft's name, or the file of one's own.
    shape : str
        What tells one's own from another of its name; empty for ours.
    number : int
    seed : int
    width : int, px
    samples : int
        Per pixel.
    images : int
        Of each start.
    bracket : tuple of float
        Further exposures of each image, as multiples of the metered one.
    """

    target: str
    shape: str
    number: int
    seed: int
    width: int
    samples: int
    images: int = IMAGES
    bracket: tuple[float, ...] = ()

    def rng(self, *key: int) -> np.random.Generator:
        """Return the random numbers of a purpose."""
        name = zlib.crc32(self.target.rsplit("/", 1)[-1].encode())
        return np.random.default_rng([self.seed, name, self.number, *key])


@dataclass(frozen=True, eq=False)
class DrawnMotion:
    """A motion as it was drawn.

    Attributes
    ----------
    times_s : (n,) array, s
    poses : tuple of n RigidTransform
        ``cam_from_target``.
    share : float
        Of the field's width that the target is across.
    rate_deg_s, step_s : float
    suns_in_inertial : (k, 3) array
        Unit vectors towards the Suns, axes of the chaser's orbit.
    earth_in_inertial : (3,) array
        Unit vector towards the Earth's centre.
    earth_shines : (k,) array of bool
    """

    times_s: Floats
    poses: tuple[RigidTransform, ...]
    share: float
    rate_deg_s: float
    step_s: float
    suns_in_inertial: Floats
    earth_in_inertial: Floats
    earth_shines: tuple[bool, ...]

    def chaser(self, image: int) -> ChaserState:
        """Return the chaser's state at an image."""
        return ORBIT.state(float(self.times_s[image]))

    def cam_from_inertial(self, image: int) -> Floats:
        """Return the (3, 3) rotation into camera axes at an image."""
        axes = ORBIT.inertial_from_lvlh(float(self.times_s[image]))
        return np.asarray(CAM_FROM_LVLH.rotation @ axes.T)

    @cached_property
    def phases_deg(self) -> Floats:
        """(k,) Angle between each Sun and the camera, as the target sees them first, deg."""
        place = self.poses[0].translation
        suns = self.suns_in_inertial @ self.cam_from_inertial(0).T
        cosine = suns @ (-place / np.linalg.norm(place))
        return np.asarray(np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0))))


def draw_motion(task: MotionTask, camera: Camera, radius_m: float) -> DrawnMotion:
    """Draw a motion.

    Parameters
    ----------
    task : MotionTask
    camera : Camera
        Of the images.
    radius_m : float, m
        Of the target about its origin.
    """
    rng = task.rng(MOTION_DRAW)
    attitude = Rotation.random(rng=rng)
    share = log_uniform(rng, SHARES)
    field = camera.width / camera.fx
    range_m = 2.0 * radius_m / (share * field)
    off = OFF_AXIS * rng.uniform(-1.0, 1.0, 2) * np.array([camera.width, camera.height])
    centre = 0.5 * np.array([camera.width - 1.0, camera.height - 1.0])
    place = range_m * camera.rays((centre + 0.5 * off)[None])[0]
    rate_deg_s, step_s = log_uniform(rng, RATES_DEG_S), log_uniform(rng, STEPS_S)
    axis = any_direction(rng)
    times_s = step_s * np.arange(task.images, dtype=np.float64)
    poses = tuple(
        RigidTransform(
            (attitude * Rotation.from_rotvec(np.deg2rad(rate_deg_s) * t * axis)).as_matrix(), place
        )
        for t in times_s
    )
    inertial_from_cam = (CAM_FROM_LVLH.rotation @ ORBIT.inertial_from_lvlh(0.0).T).T
    earth = next(
        e for _ in range(MOST_DRAWS) if (e := any_direction(rng))[2] < _cos(EARTH_AWAY_DEG)
    )
    suns = [_sun(task, number, place, earth) for number in range(SUNS)]
    return DrawnMotion(
        times_s=times_s,
        poses=poses,
        share=share,
        rate_deg_s=rate_deg_s,
        step_s=step_s,
        suns_in_inertial=np.array(suns) @ inertial_from_cam.T,
        earth_in_inertial=inertial_from_cam @ earth,
        earth_shines=tuple((task.number + number) % 2 == 0 for number in range(SUNS)),
    )


def told_sun(task: MotionTask, number: int, true: Floats, sigma_deg: float) -> Floats:
    """Return the Sun's direction as one start has it on board, (3,).

    Parameters
    ----------
    task : MotionTask
    number : int
        Of the Sun among those of the motion.
    true : (3,) array
    sigma_deg : float, deg
        Per axis.
    """
    turn = np.deg2rad(sigma_deg) * task.rng(TOLD_DRAW, number).standard_normal(3)
    return np.asarray(Rotation.from_rotvec(turn).apply(true))


def _sun(task: MotionTask, number: int, place: Floats, earth: Floats) -> Floats:
    """Draw a Sun by its phase angle, camera axes, not behind the Earth."""
    radius = np.arcsin(EARTH_RADIUS_KM / GEO_RADIUS_KM)
    rng = task.rng(SUN_DRAW, number)
    while True:
        phase = np.deg2rad(rng.uniform(*PHASES_DEG))
        sun = at_angle(rng, -place / np.linalg.norm(place), float(phase))
        if sun @ earth < np.cos(radius):
            return sun


def any_direction(rng: np.random.Generator) -> Floats:
    """Return a unit vector, even over the sphere, (3,)."""
    vector = rng.standard_normal(3)
    return np.asarray(vector / np.linalg.norm(vector))


def _cos(deg: float) -> float:
    return float(np.cos(np.deg2rad(deg)))

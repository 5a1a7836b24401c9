"""What is drawn of a frame: pose, background, Sun and exposure, each keyed and never in sequence.

A draw's key is the seed, what it is for, the number of the pose (and of the Sun and the exposure at
it) and of the attempt. So the n-th frame is the same whatever was drawn before it, and however
often something was refused.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.spatial.transform import Rotation

from bench.random_dataset.spec_tables import Spec
from models.arrays import Floats
from models.camera import Camera
from models.errors import ScenarioError
from models.lights.earth import EARTH_RADIUS_KM
from models.lights.sun import unit_direction
from models.pose import RigidTransform
from models.spacecraft.inside import is_inside
from models.spacecraft.part import Spacecraft
from renders.tracing.silhouette import in_sight, pieces_of

ATTITUDE, BACKGROUND, SUN, EXPOSURE = 1, 2, 3, 4  # purposes that key the draws
MOST_DRAWS = 2000  # of one pose, or of one Sun
NEAREST_M = 0.05  # of the target's origin before the lens
SPACE, STARS, EARTH = BACKGROUNDS = ("space", "stars", "earth")
BEHIND, INSIDE, OUT, CUT, ECLIPSED = (
    "target behind the camera",
    "camera inside the target",
    "target out of view",
    "target cut off by the image's edge",
    "Sun behind the Earth",
)


@dataclass(frozen=True, eq=False)
class Aim:
    """A target as poses are drawn about it.

    Attributes
    ----------
    craft : Spacecraft
    point : (3,) array, m
        From which ranges are, target axes.
    range_m : (float, float), m
    """

    craft: Spacecraft
    point: Floats
    range_m: tuple[float, float]

    @property
    def corners(self) -> Floats:
        """Corners of its bounding box, (8, 3), m."""
        return np.array(list(product(*self.craft.bounds.T)))


@dataclass(frozen=True, eq=False)
class DrawnPose:
    """A pose that was taken, and what stands behind the target there.

    Attributes
    ----------
    cam_from_target : RigidTransform
    range_m : float, m
        From the camera to the aim.
    to_camera : (3,) array
        Unit vector from the aim to the camera, target axes.
    background : str
        space, stars or earth.
    earth_dir_in_target : (3,) array
        Unit vector to the Earth's centre; zeros without it.
    """

    cam_from_target: RigidTransform
    range_m: float
    to_camera: Floats
    background: str
    earth_dir_in_target: Floats


def rng_of(spec: Spec, *key: int) -> np.random.Generator:
    """Return the random numbers of a key."""
    return np.random.default_rng([spec.seed, *key])


def draw_pose(
    spec: Spec, aim: Aim, camera: Camera, number: int, refused: Counter[str]
) -> DrawnPose:
    """Draw pose number ``number``.

    Parameters
    ----------
    spec : Spec
    aim : Aim
    camera : Camera
    number : int
    refused : Counter
        Refusals by reason; added to.

    Raises
    ------
    ScenarioError
        If thousands of draws were refused.
    """
    own: Counter[str] = Counter()
    for attempt in range(MOST_DRAWS):
        rng = rng_of(spec, ATTITUDE, number, attempt)
        range_m, ray = log_uniform(rng, aim.range_m), _ray(spec, camera, rng)
        if not np.isfinite(ray).all():  # beyond what the lens shows
            own[OUT] += 1
            continue
        pose = _pose(spec, aim, range_m, ray, rng)
        reason = refusal(spec, aim, camera, pose)
        if reason is None:
            refused.update(own)
            lens = pose.inverse().translation - aim.point
            background, earth = _draw_background(spec, camera, pose, number)
            return DrawnPose(pose, range_m, lens / np.linalg.norm(lens), background, earth)
        own[reason] += 1
    told = ", ".join(f"{reason}: {count}" for reason, count in own.most_common())
    raise ScenarioError(
        f"expected poses that can be seen; of {MOST_DRAWS} draws for {aim.craft.name} at "
        f"{aim.range_m[0]:g} to {aim.range_m[1]:g} m none was taken ({told}); change pose.range_m, "
        "pose.off_axis or pose.in_view"
    )


def refusal(spec: Spec, aim: Aim, camera: Camera, pose: RigidTransform) -> str | None:
    """Return why a pose is refused, or None if it is taken.

    Parameters
    ----------
    spec : Spec
    aim : Aim
    camera : Camera
    pose : RigidTransform
        ``cam_from_target``.
    """
    middle = pose @ aim.point
    if pose.translation[2] < NEAREST_M or middle[2] < NEAREST_M:
        return BEHIND
    if spec.pose.in_view == "whole" and not _all_in_image(camera, pose @ aim.corners):
        return CUT
    if spec.pose.in_view == "middle" and not _all_in_image(camera, middle[None]):
        return OUT
    if is_inside(aim.craft, pose.inverse().translation):  # the dearest to tell
        return INSIDE
    if not in_sight(pieces_of(aim.craft, None, pose), camera, pose):
        return OUT
    return None


def draw_sun(spec: Spec, pose: DrawnPose, number: int, which: int, refused: Counter[str]) -> Floats:
    """Draw a Sun for a pose: (3,), the unit vector towards it, target axes.

    Parameters
    ----------
    spec : Spec
    pose : DrawnPose
    number : int
        Of the pose.
    which : int
        Of the Sun among those of the pose.
    refused : Counter
        Refusals by reason; added to.

    Raises
    ------
    ScenarioError
        If thousands of draws were refused.
    """
    radius = np.arcsin(EARTH_RADIUS_KM / spec.background.earth_distance_km)
    for attempt in range(MOST_DRAWS):
        sun = _sun_candidate(spec, pose.to_camera, rng_of(spec, SUN, number, which, attempt))
        if pose.background != EARTH or sun @ pose.earth_dir_in_target < np.cos(radius):
            return sun
        refused[ECLIPSED] += 1
    raise ScenarioError(
        f"expected Suns that the Earth does not hide; of {MOST_DRAWS} draws none was: change "
        "sun.phase_deg, or background.earth_distance_km"
    )


def draw_exposure_ms(spec: Spec, number: int, which: int) -> float:
    """Draw an exposure time, ms: log-uniform.

    Parameters
    ----------
    spec : Spec
    number : int
        Of the pose.
    which : int
        Of the frame among those of the pose.
    """
    return log_uniform(rng_of(spec, EXPOSURE, number, which), spec.exposure.exposure_ms)


def log_uniform(rng: np.random.Generator, span: tuple[float, float]) -> float:
    """Draw a number whose logarithm is uniform between those of a span."""
    low, high = np.log(span)
    return float(np.clip(np.exp(rng.uniform(low, high)), *span))


def direction_in_cap(rng: np.random.Generator, axis: Floats, least: float, most: float) -> Floats:
    """Draw a direction uniform by solid angle between two angles about an axis, rad.

    Parameters
    ----------
    rng : numpy Generator
    axis : (3,) array
        Of length 1.
    least, most : float, rad

    Returns
    -------
    (3,) array
        Of length 1.
    """
    cosine = rng.uniform(np.cos(most), np.cos(least)) if most > least else np.cos(least)
    return at_angle(rng, axis, float(np.arccos(np.clip(cosine, -1.0, 1.0))))


def at_angle(rng: np.random.Generator, axis: Floats, angle: float) -> Floats:
    """Draw a direction at an angle from an axis, at any side of it.

    Parameters
    ----------
    rng : numpy Generator
    axis : (3,) array
        Of length 1.
    angle : float, rad

    Returns
    -------
    (3,) array
        Of length 1.
    """
    first, second = _across(axis)
    azimuth = rng.uniform(0.0, 2.0 * np.pi)
    side = np.cos(azimuth) * first + np.sin(azimuth) * second
    towards = np.cos(angle) * axis + np.sin(angle) * side
    return np.asarray(towards / np.linalg.norm(towards))


def _ray(spec: Spec, camera: Camera, rng: np.random.Generator) -> Floats:
    """Draw the direction in which the aim lies, camera axes: even over the image's middle part."""
    off = spec.pose.off_axis * rng.uniform(-1.0, 1.0, size=2)
    size = np.array([camera.width, camera.height])
    return np.asarray(camera.rays((0.5 * (size - 1) + 0.5 * off * size)[None])[0])


def _pose(
    spec: Spec, aim: Aim, range_m: float, ray: Floats, rng: np.random.Generator
) -> RigidTransform:
    table = spec.pose
    if table.attitude == "uniform":
        turn = Rotation.random(rng=rng).as_matrix()
    else:
        axis = unit_direction(table.axis)
        to_camera = direction_in_cap(rng, axis, 0.0, np.deg2rad(table.cone_deg))
        roll = np.deg2rad(table.roll_deg) * rng.uniform(-1.0, 1.0)
        turn = _turned_to(ray) @ _rolled(roll) @ _facing(to_camera)
    return RigidTransform(turn, range_m * ray - turn @ aim.point)


def _facing(to_camera: Floats) -> Floats:
    """Return the rotation of a camera that looks back along a direction, its +x across it."""
    right, _ = _across(to_camera)
    ahead = -to_camera
    return np.stack([right, np.cross(ahead, right), ahead])


def _rolled(angle: float) -> Floats:
    return np.asarray(Rotation.from_rotvec([0.0, 0.0, angle]).as_matrix())


def _turned_to(ray: Floats) -> Floats:
    """Return the shortest turn that takes the boresight to a ray."""
    across = np.cross([0.0, 0.0, 1.0], ray)
    size = float(np.linalg.norm(across))
    if size < 1e-12:
        return np.eye(3)
    return np.asarray(Rotation.from_rotvec(across / size * np.arctan2(size, ray[2])).as_matrix())


def _across(axis: Floats) -> tuple[Floats, Floats]:
    """Return two unit vectors across an axis and each other: the first as +y or +x has it."""
    helper = np.array([1.0, 0.0, 0.0]) if abs(axis[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    first = helper - (helper @ axis) * axis
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


def _sun_candidate(spec: Spec, to_camera: Floats, rng: np.random.Generator) -> Floats:
    if spec.sun.by == "direction":
        vector = rng.standard_normal(3)
        return np.asarray(vector / np.linalg.norm(vector))
    low, high = np.deg2rad(spec.sun.phase_deg)
    return at_angle(rng, to_camera, float(rng.uniform(low, high)))


def _draw_background(
    spec: Spec, camera: Camera, pose: RigidTransform, number: int
) -> tuple[str, Floats]:
    """Draw what stands behind, and where the Earth does: some of it is in the image."""
    rng, table = rng_of(spec, BACKGROUND, number), spec.background
    weights = np.array([table.space, table.stars, table.earth])
    background = BACKGROUNDS[int(rng.choice(len(BACKGROUNDS), p=weights / weights.sum()))]
    if background != EARTH:
        return background, np.zeros(3)
    radius = np.arcsin(EARTH_RADIUS_KM / table.earth_distance_km)
    edges = np.array([[0.5 * camera.width, 0.0], [0.0, 0.5 * camera.height]])
    field = float(np.arccos(camera.rays(edges)[:, 2].max()))  # of the shorter side
    boresight = pose.rotation[2]
    return background, direction_in_cap(rng, boresight, 0.0, min(np.pi, radius + 0.8 * field))


def _all_in_image(camera: Camera, points_in_cam: Floats) -> bool:
    if (points_in_cam[:, 2] < NEAREST_M).any():
        return False
    return bool(np.all(camera.contains(np.nan_to_num(camera.project(points_in_cam), nan=-1e9))))

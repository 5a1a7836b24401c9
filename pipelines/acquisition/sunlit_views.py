"""Which views of a target an image may show, when it is known where the Sun stands.

The Sun's direction before the camera fixes, for each view and roll, which faces shine and which lie
in their own or cast shadow. So an image is compared with what would shine, about the centroid and
within the radius of gyration of what would shine: size and place need little variation, however
little is lit. Templates depend on the phase angle alone and are made once a start.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats, Indices, Radiance
from models.camera import Camera
from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe
from pipelines.acquisition.surface_cloud import (
    nearest_in_cells,
    sunlight,
    surface_cloud,
)
from pipelines.acquisition.view_search import TURN_APART_DEG, Hypothesis
from pipelines.acquisition.view_sphere import centred, directions_all_around, look_from

VIEW_CELLS = 40  # of a side of the grid on which a view is seen
AZIMUTHS = 18  # of the Sun about the line of sight
SUN_DIRECTIONS = 500  # for which cast shadows are known beforehand: 9 deg apart
CELLS = 24  # of a side of a template,
REACH = 2.8  # which ends this many radii of gyration from the centroid
SOFT_CELLS = 0.8
DIMMEST = 0.15  # of a lit point's weight: one that the Sun grazes is still seen
ROLLS = 36
SCALES = (0.87, 1.0, 1.15)
SHIFTS = ((0.0, 0.0), (0.22, 0.0), (-0.22, 0.0), (0.0, 0.22), (0.0, -0.22))
FEWEST_CELLS = 4  # that shine: fewer are no view


@dataclass(frozen=True, eq=False)
class SeenViews:
    """A target seen from all around, without light.

    Attributes
    ----------
    rotations : (v, 3, 3) array
        ``cam_from_target``, the origin on the boresight.
    range_radii : float
        How far off, in radii of the target.
    view, point : (p,) arrays of int
        Of each cell that is covered, in any view.
    places : (p, 2) array
        Where it lies, normalised image coordinates times the range, in radii.
    towards : (p,) array
        1 where the side of the point's normal is seen, -1 where the other is.
    suns : (s, 3) array
        Directions for which sunlight is known.
    light : (s, n) float32 array
        See ``surface_cloud.sunlight``.
    first : (v + 1,) array of int
        Where each view's cells begin among all.
    """

    rotations: Floats
    range_radii: float
    view: Indices
    point: Indices
    places: Floats
    towards: Floats
    suns: Floats
    light: Radiance
    first: Indices


@dataclass(frozen=True, eq=False)
class SunlitViews:
    """Templates of what shines, for one phase angle.

    Attributes
    ----------
    phase_rad : float, rad
    pictures : (a, v, cells * cells) float32 array
        By azimuth of the Sun; each of mean 0 and length 1, zeros where nothing shines.
    centroid : (a, v, 2) array
        Of what shines, in ``SeenViews.places``.
    gyration : (a, v) array
        Its radius of gyration, likewise.
    """

    phase_rad: float
    pictures: Radiance
    centroid: Floats
    gyration: Floats


@lru_cache(maxsize=4)
def seen_views(wireframe: Wireframe, range_radii: float, count: int) -> SeenViews:
    """Look at a target from all around; kept in memory, and made before the first image.

    Parameters
    ----------
    wireframe : Wireframe
    range_radii : float
        How far off, in radii: for the perspective.
    count : int
        From how many directions.
    """
    cloud = surface_cloud(wireframe)
    rotations, views, points, places, towards = [], [], [], [], []
    distance = range_radii * cloud.radius_m
    for number, direction in enumerate(directions_all_around(count)):
        pose = look_from(direction, distance)
        in_cam = cloud.points @ pose.rotation.T + pose.translation
        flat = in_cam[:, :2] / in_cam[:, 2:] * range_radii
        cell = np.floor((flat + 1.05) * (VIEW_CELLS / 2.1)).astype(np.int64)
        seen = nearest_in_cells(cell[:, 0], cell[:, 1], in_cam[:, 2], VIEW_CELLS, VIEW_CELLS)
        place = np.flatnonzero(seen >= 0)
        own = seen[place]
        rotations.append(pose.rotation)
        views.append(np.full(len(own), number))
        points.append(own)
        middle = np.stack([place % VIEW_CELLS, place // VIEW_CELLS], axis=1) + 0.5
        places.append(middle * (2.1 / VIEW_CELLS) - 1.05)
        eye = pose.inverse().translation - cloud.points[own]
        towards.append(np.where(np.einsum("ni,ni->n", eye, cloud.normals[own]) > 0.0, 1.0, -1.0))
    suns = directions_all_around(SUN_DIRECTIONS)
    return SeenViews(
        rotations=np.array(rotations),
        range_radii=range_radii,
        view=np.concatenate(views),
        point=np.concatenate(points),
        places=np.concatenate(places),
        towards=np.concatenate(towards),
        suns=suns,
        light=np.array([sunlight(cloud, sun) for sun in suns], dtype=np.float32),
        first=np.cumsum([0, *(len(own) for own in points)]),
    )


@lru_cache(maxsize=4)
def even_views(seen: SeenViews) -> SunlitViews:
    """Return views that shine evenly all over, as the Earth lights them; kept in memory.

    Parameters
    ----------
    seen : SeenViews
    """
    flat, centre, gyration = _pictures(seen, np.ones(len(seen.view)))
    return SunlitViews(0.0, flat[None], centre[None], gyration[None])


def sunlit_views(seen: SeenViews, phase_rad: float) -> SunlitViews:
    """Light all views from a phase angle, the Sun all around the line of sight.

    Parameters
    ----------
    seen : SeenViews
    phase_rad : float, rad
        Between the Sun and the camera, as the target sees them.
    """
    every = []
    for number in range(AZIMUTHS):
        azimuth = 2.0 * np.pi * number / AZIMUTHS
        sun = np.array(
            [
                np.sin(phase_rad) * np.cos(azimuth),
                np.sin(phase_rad) * np.sin(azimuth),
                -np.cos(phase_rad),
            ]
        )
        nearest = np.argmax((seen.rotations.transpose(0, 2, 1) @ sun) @ seen.suns.T, axis=1)
        cosine = seen.light[nearest[seen.view], seen.point] * seen.towards
        every.append(
            _pictures(seen, np.where(cosine > 0.0, DIMMEST + (1.0 - DIMMEST) * cosine, 0.0))
        )
    pictures, centroids, gyrations = (np.array(each) for each in zip(*every, strict=True))
    return SunlitViews(phase_rad, pictures, centroids, gyrations)


def _pictures(seen: SeenViews, weight: Floats) -> tuple[Radiance, Floats, Floats]:
    """Return each view's template, (v, cells * cells), centroid and radius of gyration."""
    count = len(seen.rotations)
    total = np.bincount(seen.view, weight, count)
    safe = np.maximum(total, 1e-9)
    centre = np.stack(
        [np.bincount(seen.view, weight * seen.places[:, k], count) / safe for k in (0, 1)],
        axis=1,
    )
    away = seen.places - centre[seen.view]
    square = np.bincount(seen.view, weight * (away**2).sum(axis=1), count) / safe
    gyration = np.sqrt(np.maximum(square, (0.5 * 2.1 / VIEW_CELLS) ** 2))
    cell = away / gyration[seen.view][:, None] * (0.5 * CELLS / REACH) + 0.5 * (CELLS - 1)
    whole = np.rint(cell).astype(np.int64)
    inside = (whole >= 0).all(axis=1) & (whole < CELLS).all(axis=1) & (weight > 0.0)
    at = seen.view * CELLS * CELLS + whole[:, 1] * CELLS + whole[:, 0]
    summed = np.bincount(at[inside], weight[inside], count * CELLS * CELLS)
    number_of = np.bincount(at[inside], minlength=count * CELLS * CELLS)
    mean = (summed / np.maximum(number_of, 1)).astype(np.float32)
    drawn = mean.reshape(count, CELLS, CELLS)
    for picture in drawn:
        # Cells finer than the view's own leave holes; the blur closes them.
        cv2.GaussianBlur(picture, (0, 0), SOFT_CELLS, dst=picture)
    enough = np.bincount(seen.view, weight > 0.0, count) >= FEWEST_CELLS
    flat = centred(drawn.reshape(count, -1)) * enough[:, None]
    return np.asarray(flat, dtype=np.float32), centre, gyration


def search_sunlit_views(
    shine: Radiance,
    camera: Camera,
    seen: SeenViews,
    lit: SunlitViews,
    sun_in_cam: Floats,
    radius_m: float,
    count: int,
) -> list[Hypothesis]:
    """Return the ``count`` likeliest views of an image, the likeliest first.

    Parameters
    ----------
    shine : (height, width) float32 array
        How brightly the image shines, 0 to 1; something does.
    camera : Camera
        Of it.
    seen : SeenViews
    lit : SunlitViews
        At the Sun's phase angle, or evenly.
    sun_in_cam : (3,) array
        Unit vector towards the Sun.
    radius_m : float, m
        Of the target.
    count : int
    """
    row, column = np.nonzero(shine > 0.0)
    value = shine[row, column].astype(np.float64)
    centroid = np.array([value @ column, value @ row]) / value.sum()
    square = value @ ((column - centroid[0]) ** 2 + (row - centroid[1]) ** 2) / value.sum()
    gyration = float(np.sqrt(max(square, 0.25)))
    ray = camera.rays(centroid[None])[0]
    towards = turn_to(ray)
    flat = towards.T @ sun_in_cam  # as a camera that looks at the target has it
    azimuth = np.arctan2(flat[1], flat[0])
    rolls = 2.0 * np.pi * np.arange(ROLLS) / ROLLS
    azimuths = len(lit.pictures)
    place = np.rint((azimuth - rolls) * (azimuths / (2.0 * np.pi))).astype(np.int64) % azimuths
    patches, settings = [], []
    side = np.arange(CELLS) - 0.5 * (CELLS - 1)
    x, y = np.meshgrid(side, side)
    cosine, sine = np.cos(rolls)[:, None, None], np.sin(rolls)[:, None, None]
    for scale in SCALES:
        size = scale * gyration
        step = size * REACH / (0.5 * CELLS)
        soft = cv2.GaussianBlur(shine, (0, 0), max(SOFT_CELLS * step, 0.3))
        for shift in SHIFTS:
            centre = centroid + gyration * np.array(shift)
            u = (centre[0] + step * (cosine * x - sine * y)).astype(np.float32)
            v = (centre[1] + step * (sine * x + cosine * y)).astype(np.float32)
            patch = cv2.remap(
                soft, u.reshape(-1, CELLS), v.reshape(-1, CELLS), cv2.INTER_LINEAR
            ).reshape(ROLLS, -1)
            patches.append(centred(patch))
            settings.append((size, centre))
    every = np.array(patches)
    scores = np.empty((len(settings), ROLLS, len(seen.rotations)), dtype=np.float32)
    for number in np.unique(place):
        own = place == number
        scores[:, own] = every[:, own] @ lit.pictures[number].T
    return _best(scores, settings, rolls, place, camera, seen, lit, radius_m, count)


def _best(
    scores: Radiance,
    settings: list[tuple[float, Floats]],
    rolls: Floats,
    place: Indices,
    camera: Camera,
    seen: SeenViews,
    lit: SunlitViews,
    radius_m: float,
    count: int,
) -> list[Hypothesis]:
    """Pick the best settings of each view and roll, then views apart from each other."""
    best_setting, best = scores.argmax(axis=0), scores.max(axis=0)
    order = np.argsort(-best.ravel(), kind="stable")[: 12 * count]
    focal = 0.5 * (camera.fx + camera.fy)
    roll, view = np.divmod(order, best.shape[1])
    turns = Rotation.from_rotvec(rolls[:, None] * np.array([0.0, 0.0, 1.0])).as_matrix()
    rotations = turns[roll] @ seen.rotations[view]
    alike = 1.0 + 2.0 * np.cos(np.deg2rad(TURN_APART_DEG))
    chosen: list[Hypothesis] = []
    kept: list[int] = []
    for each in range(len(order)):
        if kept and np.einsum("nij,ij->n", rotations[kept], rotations[each]).max() > alike:
            continue
        kept.append(each)
        size, centre = settings[int(best_setting[roll[each], view[each]])]
        azimuth = place[roll[each]]
        # Places are angles times the range in radii: a size of so many radii at that range.
        scale = (size / focal) / lit.gyration[azimuth, view[each]]
        origin = camera.normalise(centre[None])[0] - scale * (
            turns[roll[each], :2, :2] @ lit.centroid[azimuth, view[each]]
        )
        ray = np.array([origin[0], origin[1], 1.0])
        ray /= np.linalg.norm(ray)
        pose = RigidTransform(turn_to(ray) @ rotations[each], radius_m / scale * ray)
        chosen.append(Hypothesis(int(view[each]), pose, float(best[roll[each], view[each]])))
        if len(chosen) == count:
            break
    return chosen


def turn_to(ray: Floats) -> Floats:
    """Return the shortest turn that takes the boresight to a ray, (3, 3)."""
    aside = np.cross([0.0, 0.0, 1.0], ray)
    sine = float(np.linalg.norm(aside))
    turn = np.zeros(3) if sine < 1e-12 else aside / sine * np.arcsin(min(sine, 1.0))
    return np.asarray(Rotation.from_rotvec(turn).as_matrix())

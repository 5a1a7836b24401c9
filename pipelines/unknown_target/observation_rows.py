"""What cameras and ranges say of the unknowns: predictions, and derivatives by all of them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.transform import Rotation

from models.arrays import Floats, Indices, Mask
from models.motion.clohessy_wiltshire import state_transition
from models.motion.gravity_gradient_rotation import lvlh_from_first
from pipelines.unknown_target.free_tumble import FreeTumble
from pipelines.unknown_target.unknowns import PLACE, SHARED, TURN, Unknowns

NEAREST_M = 0.1  # of a point to the camera: nearer ones, and ones behind, are no prediction
FACING = 1e-3  # cosine of the beam to a facet, below which it grazes


@dataclass(frozen=True, eq=False)
class Epochs:
    """What is known of frames, whatever the unknowns.

    Attributes
    ----------
    times_s : (f,) array, s
        After the start.
    R_cam_from_lvlh : (f, 3, 3) array
    R_cam_from_start : (f, 3, 3) array
        From the local frame of the start, held still.
    transition : (f, 6, 6) array
        Of Clohessy and Wiltshire, from the start.
    """

    times_s: Floats
    R_cam_from_lvlh: Floats
    R_cam_from_start: Floats
    transition: Floats

    @classmethod
    def of(cls, after_s: float, R_cam_from_lvlh: Floats, mean_motion_rad_s: float) -> Epochs:
        """Return one frame.

        Parameters
        ----------
        after_s : float, s
            After the start.
        R_cam_from_lvlh : (3, 3) array
        mean_motion_rad_s : float, rad/s
            Of the target's circular orbit.
        """
        return cls(
            np.array([after_s]),
            R_cam_from_lvlh[None],
            (R_cam_from_lvlh @ lvlh_from_first(mean_motion_rad_s * after_s))[None],
            state_transition(mean_motion_rad_s, after_s)[None],
        )

    def take(self, which: Indices | slice) -> Epochs:
        """Return some of them.

        Parameters
        ----------
        which : (k,) int array or slice
        """
        parts = (self.times_s, self.R_cam_from_lvlh, self.R_cam_from_start, self.transition)
        return Epochs(*(part[which] for part in parts))

    def followed_by(self, other: Epochs) -> Epochs:
        """Return both, one after the other."""
        return Epochs(
            np.concatenate([self.times_s, other.times_s]),
            np.concatenate([self.R_cam_from_lvlh, other.R_cam_from_lvlh]),
            np.concatenate([self.R_cam_from_start, other.R_cam_from_start]),
            np.concatenate([self.transition, other.transition]),
        )


@dataclass(frozen=True, eq=False)
class Placed:
    """Where the target is at some epochs, and how that depends on the shared unknowns.

    Attributes
    ----------
    R_cam_from_target : (f, 3, 3) array
    t_cam_from_target : (f, 3) array, m
    state : (f, 6) array
        rho and its rate, local frame, m and m/s.
    omega : (f, 3) array, rad/s
        Inertial rate, body axes.
    origin_by_place : (f, 3, 6) array
        t by rho and its rate at the start.
    state_by_place : (f, 6, 6) array
    turn_by_rest, omega_by_rest : (f, 3, 8) array
        By the rate at the start and the inertia.
    """

    R_cam_from_target: Floats
    t_cam_from_target: Floats
    state: Floats
    omega: Floats
    origin_by_place: Floats
    state_by_place: Floats
    turn_by_rest: Floats
    omega_by_rest: Floats

    def take(self, which: Indices) -> Placed:
        """Return some of them.

        Parameters
        ----------
        which : (k,) int array
        """
        return Placed(**{name: part[which] for name, part in vars(self).items()})

    def moved(self, shared: Floats) -> Placed:
        """Return where the target is after a (14,) step of the shared unknowns."""
        turns = Rotation.from_rotvec(self.turn_by_rest @ shared[TURN]).as_matrix()
        return replace(
            self,
            R_cam_from_target=self.R_cam_from_target @ turns,
            t_cam_from_target=self.t_cam_from_target + self.origin_by_place @ shared[PLACE],
            state=self.state + self.state_by_place @ shared[PLACE],
            omega=self.omega + self.omega_by_rest @ shared[TURN],
        )


def placed(at: Unknowns, tumble: FreeTumble, epochs: Epochs) -> Placed:
    """Return where the target is.

    Parameters
    ----------
    at : Unknowns
    tumble : FreeTumble
        Of the same unknowns.
    epochs : Epochs
        None beyond how far the tumble was followed.
    """
    turned = tumble.at(epochs.times_s)
    state = epochs.transition @ at.shared[PLACE]
    return Placed(
        epochs.R_cam_from_start @ turned.R_start_from_body,
        -np.einsum("fij,fj->fi", epochs.R_cam_from_lvlh, state[:, :3]),
        state,
        turned.omega,
        -epochs.R_cam_from_lvlh @ epochs.transition[:, :3],
        epochs.transition,
        turned.turn_by_unknowns,
        turned.omega_by_unknowns,
    )


@dataclass(frozen=True, eq=False)
class Rows:
    """Whitened measurements, see ``ArrowEquations.add_rows``.

    Attributes
    ----------
    by_shared : (m, k, 14) array
    by_point : (m, k, 3) array
    error : (m, k) array
        Measured minus predicted, over sigma; NaN where there is no prediction.
    who : (m,) int array
        The point of each.
    """

    by_shared: Floats
    by_point: Floats
    error: Floats
    who: Indices

    @classmethod
    def none(cls) -> Rows:
        """Return no rows, of one number each."""
        shared, point = np.zeros((0, 1, SHARED)), np.zeros((0, 1, 3))
        return cls(shared, point, np.zeros((0, 1)), np.zeros(0, dtype=np.int64))

    @property
    def sizes(self) -> Floats:
        """(m,) lengths of the errors, in sigmas; infinite where there is no prediction."""
        size = np.sqrt(np.sum(self.error**2, axis=1))
        return np.where(np.isfinite(size), size, np.inf)

    def weighted(self, weights: Floats) -> Rows:
        """Return rows that count so much; those of weight zero are left out.

        Parameters
        ----------
        weights : (m,) array
        """
        kept = weights > 0.0
        root = np.sqrt(weights[kept])[:, None]
        return Rows(
            self.by_shared[kept] * root[..., None],
            self.by_point[kept] * root[..., None],
            self.error[kept] * root,
            self.who[kept],
        )


def sighting_rows(
    where: Placed, points: Floats, frame: Indices, who: Indices, seen: Floats, sigma: Floats
) -> Rows:
    """Return the rows of points seen in images.

    Parameters
    ----------
    where : Placed
    points : (n, 3) array, m
    frame : (m,) int array
        A place in ``where``.
    who : (m,) int array
        A place in ``points``.
    seen : (m, 2) array
        Undistorted, in units of the focal length.
    sigma : (m,) array
        Of each axis, in the same unit.
    """
    place = points[who]
    turn = where.R_cam_from_target[frame]
    in_cam = np.einsum("mij,mj->mi", turn, place) + where.t_cam_from_target[frame]
    depth = np.where(in_cam[:, 2] > NEAREST_M, in_cam[:, 2], np.nan)
    across = in_cam[:, :2] / depth[:, None]
    by_cam = np.zeros((len(who), 2, 3))
    by_cam[:, 0, 0] = by_cam[:, 1, 1] = 1.0 / depth
    by_cam[:, :, 2] = -across / depth[:, None]
    by_cam /= sigma[:, None, None]
    by_point = by_cam @ turn
    by_shared = np.empty((len(who), 2, SHARED))
    by_shared[:, :, PLACE] = by_cam @ where.origin_by_place[frame]
    by_shared[:, :, TURN] = cross(place[:, None], by_point) @ where.turn_by_rest[frame]
    return Rows(by_shared, by_point, (seen - across) / sigma[:, None], who)


def centre_rows(where: Placed, frame: Indices, range_m: Floats, sigma_m: Floats) -> Rows:
    """Return the rows of distances to the centre of mass; they are of no point.

    Parameters
    ----------
    where : Placed
    frame : (m,) int array
    range_m, sigma_m : (m,) array, m
    """
    origin = where.t_cam_from_target[frame]
    distance = np.linalg.norm(origin, axis=1)
    by_shared = np.zeros((len(frame), 1, SHARED))
    by_shared[:, :, PLACE] = (
        (origin / distance[:, None])[:, None] @ where.origin_by_place[frame]
    ) / sigma_m[:, None, None]
    error = ((range_m - distance) / sigma_m)[:, None]
    none = np.zeros(len(frame), dtype=np.int64)
    return Rows(by_shared, np.zeros((len(frame), 1, 3)), error, none)


def surface_rows(
    where: Placed, points: Floats, used: Mask, frame: Indices, range_m: Floats, sigma_m: Floats
) -> Rows:
    """Return the rows of distances to the surface that the boresight meets.

    The surface is the hull of the points; a range is one to the corner of the facet met that is
    nearest to the beam, but for a step along the beam that is taken from the shape as it is now. So
    it tells of one point, and the equations remain an arrow.

    Parameters
    ----------
    where : Placed
    points : (n, 3) array, m
    used : (n,) bool array
        Of which the hull is made.
    frame : (m,) int array
    range_m, sigma_m : (m,) array, m
    """
    places = np.flatnonzero(used)
    turn, origin = where.R_cam_from_target[frame], where.t_cam_from_target[frame]
    beam = turn[:, 2]  # the boresight in body axes
    eye = -np.einsum("mji,mj->mi", turn, origin)
    met, facet = _entry(points[places], eye, beam)
    hit = eye + met[:, None] * beam
    if facet is None:
        nearest = np.zeros(len(frame), dtype=np.int64)
    else:
        corners = points[places][facet]
        apart = np.linalg.norm(corners - hit[:, None], axis=2)
        nearest = places[facet[np.arange(len(frame)), apart.argmin(axis=1)]]
    by_cam = np.zeros((len(frame), 1, 3))
    by_cam[:, 0, 2] = 1.0 / sigma_m
    by_point = by_cam @ turn
    by_shared = np.empty((len(frame), 1, SHARED))
    by_shared[:, :, PLACE] = by_cam @ where.origin_by_place[frame]
    by_shared[:, :, TURN] = cross(points[nearest][:, None], by_point) @ where.turn_by_rest[frame]
    return Rows(by_shared, by_point, ((range_m - met) / sigma_m)[:, None], nearest)


def _entry(points: Floats, eye: Floats, beam: Floats) -> tuple[Floats, Indices | None]:
    """Return how far rays go to a hull, NaN where they miss it, and the (m, 3) facets they meet."""
    missed = np.full(len(eye), np.nan)
    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):  # too few points, or all in a plane
        return missed, None
    slope = beam @ hull.equations[:, :3].T
    height = eye @ hull.equations[:, :3].T + hull.equations[:, 3]
    with np.errstate(divide="ignore"):
        crossing = -height / slope
    enters = np.where(slope < -FACING, crossing, -np.inf)
    leaves = np.where(slope > FACING, crossing, np.inf)
    first = enters.argmax(axis=1)
    met = enters[np.arange(len(eye)), first]
    beside = ((np.abs(slope) <= FACING) & (height > 0.0)).any(axis=1)
    hit = np.isfinite(met) & (met > 0.0) & (met < leaves.min(axis=1)) & ~beside
    return np.where(hit, met, np.nan), hull.simplices[first].astype(np.int64)


def cross(first: Floats, second: Floats) -> Floats:
    """Return the cross product over the last axis, (..., 3); NumPy's own is slow.

    Parameters
    ----------
    first, second : (..., 3) array
    """
    ax, ay, az = first[..., 0], first[..., 1], first[..., 2]
    bx, by, bz = second[..., 0], second[..., 1], second[..., 2]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)

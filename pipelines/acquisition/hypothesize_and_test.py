"""Acquisition as printed: Algorithm 1 of Pesce et al. 2019, section III.

Four points far along the image's principal directions are matched with four landmarks of the
subset T at random, EPnP solves for the pose, and the match is believed when the pose brings the
four landmarks back onto their points and 60 % of the points onto landmarks.

Where the print leaves a choice. D_m, "the minimum detectable distance between two" points, is the
least distance between two points of the image; a corner detector resolves nothing nearer than its
own noise, so it is not less than three sigmas. t_lim is a number of hypotheses, not of seconds, so
that a result does not depend on the machine. Points and landmarks are drawn without repetition.
The hypotheses are drawn in blocks; the first of a block that passes is taken. A set that cannot
pass is not solved: three of its matches have at most four poses, found for a whole block at once,
and where none of them brings the fourth landmark anywhere near its point EPnP would not either.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import cv2
import numpy as np
from scipy.spatial.distance import pdist

from models.arrays import Floats, Indices
from models.camera import Camera
from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe
from pipelines.acquisition.acquisition_options import HypothesizeAndTestOptions
from pipelines.acquisition.pca_classes import pca_classes
from pipelines.acquisition.three_point_poses import LandmarkTriples, three_point_poses
from pipelines.pnp.projection_jacobian import project_normalised

LEAST_GATE_SIGMAS = 3.0
DRAW, BLOCK = 7, 4096  # key of these draws among all; hypotheses drawn at a time
IDENTITY = np.eye(3)
MOST_ROUNDS = 10  # of Step 2 and Step 3, going round while the consensus set grows


@dataclass(frozen=True, eq=False)
class ConsensusPose:
    """A pose with its enlarged consensus set S*.

    Attributes
    ----------
    pose : RigidTransform
        ``cam_from_target``.
    matched : (n,) int array
        The landmark of each point, or -1.
    hypotheses : int
        How many sets were tried.
    """

    pose: RigidTransform
    matched: Indices
    hypotheses: int


def hypothesize_and_test(
    points_px: Floats,
    target: Wireframe,
    camera: Camera,
    sigma_px: float,
    frame: int,
    options: HypothesizeAndTestOptions | None = None,
) -> ConsensusPose | str:
    """Find the pose from one image's points, by chance.

    Parameters
    ----------
    points_px : (n, 2) array, px
    target : Wireframe
    camera : Camera
    sigma_px : float, px
        1-sigma of a point, per axis.
    frame : int
        Number of the image: with the options' seed it keys the draws.
    options : HypothesizeAndTestOptions, optional

    Returns
    -------
    ConsensusPose or str
        In words, why the next image is needed.
    """
    options = options or HypothesizeAndTestOptions()
    size = options.set_size
    landmarks = np.flatnonzero(target.appendage)
    if len(landmarks) < size:
        return f"T has {len(landmarks)} landmarks, at least {size} are needed"
    rng = np.random.default_rng([*options.seed, frame, DRAW])
    chosen = _chosen_class(points_px, size, rng)
    if isinstance(chosen, str):
        return chosen
    normalised = camera.normalise(points_px)
    focal_px = 0.5 * (camera.fx + camera.fy)
    nearest_px = float(pdist(points_px).min()) if len(points_px) > 1 else 0.0
    gate = max(nearest_px, LEAST_GATE_SIGMAS * sigma_px) / focal_px
    enough = round(options.share_to_accept * len(points_px))
    tried = 0
    while tried < options.most_hypotheses:
        count = min(BLOCK, options.most_hypotheses - tried)
        points = _drawn_sets(rng, chosen, count, size)
        named = _drawn_sets(rng, landmarks, count, size)
        reach = options.screen_gates * gate
        for place in _possible(target, normalised, points, named, reach):
            pose = _hypothesis(target, normalised, points[place], named[place], gate)
            if pose is None:
                continue
            found = _enlarged(target, normalised, pose, gate, enough)
            if found is not None:
                return ConsensusPose(*found, tried + int(place) + 1)
        tried += count
    return f"no pose within {tried} hypotheses, the time that Algorithm 1 allows an image"


def _chosen_class(points_px: Floats, size: int, rng: np.random.Generator) -> Indices | str:
    """Choose B: B1 or B2 by lot where both are large enough, else the one that is."""
    if len(points_px) < size + 1:
        return f"{len(points_px)} corners in the image, at least {size + 1} are needed"
    classes = pca_classes(points_px)
    usable = [
        np.flatnonzero(one)
        for one in (classes.first, classes.second)
        if np.count_nonzero(one) >= size
    ]
    if not usable:
        return f"fewer than {size} corners lie far along either principal direction"
    return usable[int(rng.integers(len(usable)))]


def _drawn_sets(rng: np.random.Generator, among: Indices, count: int, size: int) -> Indices:
    """Draw ordered sets without repetition, (count, size)."""
    order = rng.random((count, len(among))).argsort(axis=1)[:, :size]
    return among[order]


def _possible(
    target: Wireframe, normalised: Floats, points: Indices, named: Indices, reach: float
) -> Indices:
    """Return the rows whose fourth landmark comes within reach of its point, by the first three."""
    if reach <= 0.0:
        return np.arange(len(points))
    known = target.points_in_target[named]
    rays = np.concatenate([normalised[points[:, :3]], np.ones((len(points), 3, 1))], axis=2)
    rays /= np.linalg.norm(rays, axis=2, keepdims=True)
    triples = LandmarkTriples.of(target.points_in_target, named[:, :3])
    rotations, translations, of_row = three_point_poses(rays[triples.row], triples)
    row = triples.row[of_row]
    in_cam = np.einsum("pij,pj->pi", rotations, known[row, 3]) + translations
    missed = np.abs(in_cam[:, :2] - normalised[points[row, 3]] * in_cam[:, 2:])
    near = (missed < reach * in_cam[:, 2:]).all(axis=1)
    flat = np.setdiff1d(np.arange(len(points)), triples.row)  # no pose from three in a line
    return np.union1d(row[near], flat)


def _hypothesis(
    target: Wireframe, normalised: Floats, point: Indices, landmark: Indices, gate: float
) -> RigidTransform | None:
    """Solve for a consensus set, and keep the pose if it confirms all of the set (Step 2)."""
    known, seen = target.points_in_target[landmark], normalised[point]
    solved = _epnp(known, seen)
    if solved is None:
        return None
    rotation, translation = solved
    in_cam = known @ rotation.T + translation
    missed = in_cam[:, :2] - seen * in_cam[:, 2:]
    if not (np.abs(missed) < gate * in_cam[:, 2:]).all():
        return None
    gaps = np.linalg.norm(in_cam[:, None, :2] / in_cam[:, None, 2:] - normalised, axis=-1)
    confirmed = (gaps.argmin(axis=1) == point) & (gaps.min(axis=1) < gate)
    return RigidTransform(rotation, translation) if confirmed.all() else None


def _enlarged(
    target: Wireframe, normalised: Floats, pose: RigidTransform, gate: float, enough: int
) -> tuple[RigidTransform, Indices] | None:
    """Enlarge the set while it grows; refine once it is large enough (Steps 2 and 3)."""
    before = 0
    for _ in range(MOST_ROUNDS):
        matched = _confirmed(target, normalised, pose, gate)
        count = int(np.count_nonzero(matched >= 0))
        taken = matched >= 0
        if count <= before or count < 4:
            return None
        solved = _epnp(target.points_in_target[matched[taken]], normalised[taken])
        if solved is None:
            return None
        refined = RigidTransform(*solved)
        if count >= enough:
            return refined, matched
        pose, before = refined, count
    return None


def _confirmed(target: Wireframe, normalised: Floats, pose: RigidTransform, gate: float) -> Indices:
    """Match each landmark with the nearest point; a point claimed twice keeps the nearer."""
    seen = project_normalised(pose.rotation, pose.translation, target.points_in_target)
    gaps = np.linalg.norm(seen[:, None] - normalised, axis=-1)
    gaps = np.where(np.isfinite(gaps), gaps, np.inf)
    nearest = gaps.argmin(axis=1)
    matched = np.full(len(normalised), -1, dtype=np.int64)
    for landmark in np.argsort(gaps.min(axis=1), kind="stable"):
        point = nearest[landmark]
        if gaps[landmark, point] < gate and matched[point] < 0:
            matched[point] = landmark
    return matched


def _epnp(points_in_target: Floats, normalised: Floats) -> tuple[Floats, Floats] | None:
    """Solve by EPnP with Gauss-Newton over its weights (Lepetit et al. 2009)."""
    try:
        ok, turn, shift = cv2.solvePnP(
            points_in_target, normalised, IDENTITY, None, flags=cv2.SOLVEPNP_EPNP
        )
    except cv2.error:
        return None
    # A sum of squares is finite where all its terms are.
    if not (ok and isfinite(float(turn[:, 0] @ turn[:, 0] + shift[:, 0] @ shift[:, 0]))):
        return None
    return (cv2.Rodrigues(turn)[0], shift[:, 0]) if shift[2, 0] > 0.0 else None

"""One image's estimate held against its truth: errors, corners, light, and what kind of wrong."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from models.uncooperative import NavigationEstimate
from scipy.spatial.transform import Rotation

from bench.scoring.navigation_errors import NavigationError, navigation_error
from bench.suites.pesce2019.acquisition_trial import WRONG_DEG, WRONG_M, symmetric_attitude_deg
from models.arrays import Floats, Mask
from models.estimate import NoPose
from models.pose import RigidTransform
from models.wireframe.visibility import visible_landmarks
from models.wireframe.wireframe import Wireframe
from pipelines.uncooperative.knowledge import UncooperativeKnowledge
from renders.truth.image_truth import ImageTruth

FOUND_PX = 3.0  # a corner this near to a landmark's true place is that landmark's
SUN_M = 1e6  # so far away the rays of a "camera" in the Sun are parallel
HALF_TURN_DEG = 20.0  # this near to half a turn about a body axis counts as one


@dataclass(frozen=True)
class Corners:
    """What the image processing found of a target's landmarks.

    Attributes
    ----------
    visible, lit : int
        Landmarks that the image holds unhidden; of those, that the Sun reaches.
    found, found_lit : int
        Of those, with a corner within 3 px.
    detected : int
        Corners in all.
    square_px : float
        Sum of the squared distances of those found, px2.
    """

    visible: int
    lit: int
    found: int
    found_lit: int
    detected: int
    square_px: float


@dataclass(frozen=True)
class FrameJudgement:
    """One frame by one variant.

    Attributes
    ----------
    frame : int
    time_s : float
    mode : str
    reason : str or None
        Why the image gave no pose.
    error : NavigationError
        NaN where there is nothing to judge.
    wrong : bool
        A state further than 10 deg or 1 m from the truth.
    confusion : str or None
        Of a wrong attitude: ``symmetry``, ``half turn about x`` (y, z), or ``other``.
    corners : Corners
    """

    frame: int
    time_s: float
    mode: str
    reason: str | None
    error: NavigationError
    wrong: bool
    confusion: str | None
    corners: Corners

    def to_json(self) -> dict[str, object]:
        """Return it as a JSON object: None for NaN."""
        row = asdict(self)
        row["error"] = {
            name: None if np.isnan(value) else value for name, value in row["error"].items()
        }
        return row


def judged(
    estimate: NavigationEstimate, truth: ImageTruth, knowledge: UncooperativeKnowledge
) -> FrameJudgement:
    """Hold one estimate against the truth of its image."""
    error = navigation_error(estimate, truth.state, knowledge.cam_from_lvlh)
    wrong = bool(error.position_m > WRONG_M or error.attitude_deg > WRONG_DEG)
    confusion = None
    if error.attitude_deg > WRONG_DEG and estimate.state is not None:
        pose = estimate.state.cam_from_target(knowledge.cam_from_lvlh)
        confusion = confusion_of(pose, truth.cam_from_target, knowledge.target)
    return FrameJudgement(
        frame=estimate.frame,
        time_s=estimate.time_s,
        mode=estimate.mode,
        reason=estimate.pose.reason if isinstance(estimate.pose, NoPose) else None,
        error=error,
        wrong=wrong,
        confusion=confusion,
        corners=corners_found(estimate.pose.detections.points_px, truth, knowledge.target),
    )


def confusion_of(pose: RigidTransform, truth: RigidTransform, target: Wireframe) -> str:
    """Name the kind of a wrong attitude."""
    if symmetric_attitude_deg(pose, truth, target.symmetries) <= WRONG_DEG:
        return "symmetry"
    for axis, name in zip(np.eye(3), "xyz", strict=True):
        half = Rotation.from_rotvec(np.pi * axis).as_matrix()
        turned = RigidTransform(truth.rotation @ half, truth.translation)
        if symmetric_attitude_deg(pose, turned, ()) <= HALF_TURN_DEG:
            return f"half turn about {name}"
    return "other"


def lit_landmarks(target: Wireframe, sun_dir_in_target: Floats) -> Mask:
    """Tell which landmarks the Sun reaches past the wireframe's own faces."""
    towards = sun_dir_in_target / np.linalg.norm(sun_dir_in_target)
    aside = np.cross(towards, np.eye(3)[int(np.argmin(np.abs(towards)))])
    aside /= np.linalg.norm(aside)
    rotation = np.array([aside, np.cross(-towards, aside), -towards])
    sun_from_target = RigidTransform(rotation, np.array([0.0, 0.0, SUN_M]))
    return visible_landmarks(target, sun_from_target)


def corners_found(points_px: Floats, truth: ImageTruth, target: Wireframe) -> Corners:
    """Count the visible landmarks that have a corner near their true place."""
    visible = truth.landmarks_visible
    lit = lit_landmarks(target, truth.sun_dir_in_target)
    nearest = np.full(len(visible), np.inf)
    if len(points_px):
        apart = np.linalg.norm(truth.landmarks_px[:, None] - points_px[None], axis=2)
        nearest = np.where(np.isfinite(apart).all(axis=1), apart.min(axis=1), np.inf)
    found = visible & (nearest <= FOUND_PX)
    return Corners(
        visible=int(visible.sum()),
        lit=int((visible & lit).sum()),
        found=int(found.sum()),
        found_lit=int((found & lit).sum()),
        detected=len(points_px),
        square_px=float(np.sum(nearest[found] ** 2)),
    )

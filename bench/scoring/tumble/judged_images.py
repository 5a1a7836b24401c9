"""One image's estimate held against its truth: errors, corners, light, and what kind of wrong."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from bench.estimating.runs import Run
from bench.scoring.judgement import Counts, Judgement, TrueScene, is_wrong
from bench.scoring.limits import Limits, read_limits
from bench.scoring.metrics.pose_errors import POSE_DOF, frame_nees
from bench.scoring.tumble.navigation_errors import (
    NavigationError,
    navigation_error,
    symmetric_attitude_deg,
)
from models.arrays import Floats, Mask
from models.dataset.dataset import Dataset
from models.errors import DatasetError
from models.estimate import Estimate
from models.motion.relative_state import relative_state
from models.pose import RigidTransform
from models.wireframe.visibility import visible_landmarks
from models.wireframe.wireframe import Wireframe
from pipelines.uncooperative.knowledge import UncooperativeKnowledge
from renders.truth.image_truth import ImageTruth, read_image_truths

STATE_DOF = 6
FOUND_PX = 3.0  # a corner this near to a landmark's true place is that landmark's
SUN_M = 1e6  # so far away the rays of a "camera" in the Sun are parallel
LIKE_DEG = 10.0  # this near to a pose that the target's symmetry makes alike
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
        Corners in all; 0 where the pipeline tells of none.
    square_px : float
        Sum of the squared distances of those found, px2.
    """

    visible: int
    lit: int
    found: int
    found_lit: int
    detected: int
    square_px: float


@dataclass(frozen=True, eq=False)
class TrueImages:
    """The truth half of a dataset of single images, as judging needs it.

    Attributes
    ----------
    dataset : Dataset
    by_frame : dict of int to ImageTruth
    knowledge : UncooperativeKnowledge
    limits : Limits
    """

    dataset: Dataset
    by_frame: dict[int, ImageTruth]
    knowledge: UncooperativeKnowledge
    limits: Limits


@dataclass(frozen=True, eq=False)
class JudgedImage(Judgement):
    """One frame by one pipeline.

    Attributes
    ----------
    error : NavigationError
        NaN where there is nothing to judge.
    confusion : str or None
        Of a wrong attitude: ``symmetry``, ``half turn about x`` (y, z), or ``other``.
    corners : Corners
    """

    error: NavigationError
    confusion: str | None
    corners: Corners

    @property
    def counts(self) -> Counts:
        """The landmarks of this image."""
        corners = self.corners
        return Counts(
            expected=corners.visible,
            found=corners.found,
            used=sum(self.estimate.detected.used),
            in_sun=corners.lit,
        )

    def row(self) -> dict[str, Any]:
        """Return what single images add to a frame of ``per_frame``: None for NaN."""
        error = {
            name: None if np.isnan(value) else value for name, value in asdict(self.error).items()
        }
        return {"confusion": self.confusion, "error": error, "corners": asdict(self.corners)}


def read_true_images(dataset: Dataset) -> TrueImages:
    """Read the truth of a dataset of single images.

    Raises
    ------
    DatasetError
        If the truth half is missing or lacks a frame, or the wireframe on board is another's.
    """
    truths = read_image_truths(dataset.folder)
    knowledge = UncooperativeKnowledge.of(dataset.onboard)
    path, landmarks = dataset.folder / "truth" / "exposures.jsonl", len(knowledge.target)
    for index in dataset.indices:
        if index not in truths:
            raise DatasetError(
                f"{path}: expected frame {index}, found none; "
                "run the render again, it goes on where it stopped"
            )
        if len(truths[index].landmarks_px) != landmarks:
            raise DatasetError(
                f"{path}: expected {landmarks} landmarks, as in wireframe.json, got "
                f"{len(truths[index].landmarks_px)} in frame {index}; "
                "the two halves are of different renders"
            )
    return TrueImages(dataset, truths, knowledge, read_limits(dataset.folder))


def true_images(dataset: Dataset) -> dict[int, ImageTruth]:
    """Return the truth of each frame; empty where there is no truth half."""
    there = (dataset.folder / "truth" / "exposures.jsonl").is_file()
    return read_image_truths(dataset.folder) if there else {}


def judge_run(run: Run, truth: TrueImages) -> list[JudgedImage]:
    """Hold one run's estimates against the truth.

    A pipeline stands by its state; one that keeps none, in no frame, by the image's own pose. A
    frame is missed if its image gave no pose once there had been one that it stood by.
    """
    judged: list[JudgedImage] = []
    keeps_state = any(relative_state(each) is not None for each in run.estimates.values())
    begun = False
    for index in truth.dataset.indices:
        said, was = run.estimates[index], truth.by_frame[index]
        begun = begun or (relative_state(said) if keeps_state else said.pose) is not None
        judged.append(
            judged_image(
                run.number, said, was, truth.knowledge, truth.limits, begun, keeps_state=keeps_state
            )
        )
    return judged


def judge_alone(said: Estimate, record: ImageTruth, scene: TrueScene) -> JudgedImage:
    """Hold one estimate of one image against its sealed record.

    Parameters
    ----------
    said : Estimate
    record : ImageTruth
    scene : TrueScene

    Raises
    ------
    DatasetError
        If the camera, the wireframe or the expectations are not on board.
    """
    knowledge = UncooperativeKnowledge.of(scene.onboard)
    return judged_image(0, said, record, knowledge, scene.limits, begun=True)


def judged_image(
    run: int,
    said: Estimate,
    was: ImageTruth,
    knowledge: UncooperativeKnowledge,
    limits: Limits,
    begun: bool,
    *,
    keeps_state: bool = True,
) -> JudgedImage:
    """Hold one estimate against the truth of its image.

    Parameters
    ----------
    run : int
    said : Estimate
    was : ImageTruth
    knowledge : UncooperativeKnowledge
    limits : Limits
    begun : bool
        Whether there has been a pose that it stands by, in this frame or before.
    keeps_state : bool
        Whether that is its state's, and not the image's own.
    """
    error = navigation_error(said, was.state, knowledge.cam_from_lvlh, was.cam_from_target)
    pose: RigidTransform | None = None
    position_m = attitude_deg = confusion = None
    squares: tuple[tuple[float | None, int], ...] = ()
    state = relative_state(said)
    if state is not None:
        pose = state.cam_from_target(knowledge.cam_from_lvlh)
        position_m, attitude_deg = error.position_m, error.attitude_deg
        squares = (
            (_known(error.nees_translation), STATE_DOF),
            (_known(error.nees_rotation), STATE_DOF),
        )
    elif said.pose is not None and not keeps_state:
        pose = said.pose.cam_from_target
        position_m, attitude_deg = error.raw_position_m, error.raw_attitude_deg
        squares = ((frame_nees(said.pose, was.cam_from_target), POSE_DOF),)
    turned = attitude_deg is not None and attitude_deg > limits.wrong_attitude_deg
    if pose is not None and turned:
        confusion = confusion_of(pose, was.cam_from_target, knowledge.target)
    return JudgedImage(
        run=run,
        estimate=said,
        range_m=float(np.linalg.norm(was.cam_from_target.translation)),
        position_m=position_m,
        attitude_deg=attitude_deg,
        missed=begun and said.pose is None,
        wrong=is_wrong(position_m, attitude_deg, squares, limits),
        error=error,
        confusion=confusion,
        corners=corners_found(said.detected.points_px, was, knowledge.target),
    )


def _known(value: float) -> float | None:
    return None if np.isnan(value) else value


def confusion_of(pose: RigidTransform, truth: RigidTransform, target: Wireframe) -> str:
    """Name the kind of a wrong attitude.

    Parameters
    ----------
    pose, truth : RigidTransform
        ``cam_from_target``.
    target : Wireframe
        Whose symmetries these are.

    Returns
    -------
    str
        ``symmetry``, ``half turn about x`` (y, z), or ``other``.
    """
    if symmetric_attitude_deg(pose, truth, target.symmetries) <= LIKE_DEG:
        return "symmetry"
    for axis, name in zip(np.eye(3), "xyz", strict=True):
        half = Rotation.from_rotvec(np.pi * axis).as_matrix()
        turned = RigidTransform(truth.rotation @ half, truth.translation)
        if symmetric_attitude_deg(pose, turned, ()) <= HALF_TURN_DEG:
            return f"half turn about {name}"
    return "other"


def lit_landmarks(target: Wireframe, sun_dir_in_target: Floats) -> Mask:
    """Tell which landmarks the Sun reaches past the wireframe's own faces.

    Parameters
    ----------
    target : Wireframe
        Of m landmarks.
    sun_dir_in_target : (3,) array
        Towards the Sun, of any length.

    Returns
    -------
    (m,) array of bool
    """
    towards = sun_dir_in_target / np.linalg.norm(sun_dir_in_target)
    aside = np.cross(towards, np.eye(3)[int(np.argmin(np.abs(towards)))])
    aside /= np.linalg.norm(aside)
    rotation = np.array([aside, np.cross(-towards, aside), -towards])
    sun_from_target = RigidTransform(rotation, np.array([0.0, 0.0, SUN_M]))
    return visible_landmarks(target, sun_from_target)


def corners_found(points_px: Floats, truth: ImageTruth, target: Wireframe) -> Corners:
    """Count the visible landmarks that have a corner near their true place.

    Parameters
    ----------
    points_px : (n, 2) array, px
        The corners detected.
    truth : ImageTruth
    target : Wireframe
    """
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

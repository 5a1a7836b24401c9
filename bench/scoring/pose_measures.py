"""Every measure of every method's pose, frame by frame, on the same truth."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.estimating.runs import Run
from bench.pictures.frame_record import pose_stood_by
from bench.scoring.judgement import Judgement
from bench.scoring.metrics import bop, speed
from bench.scoring.metrics.add import add, add_s
from bench.scoring.metrics.speed import SpeedError, speed_error
from bench.scoring.true_view import TrueView
from models.arrays import Floats
from models.pose import RigidTransform


@dataclass(frozen=True, eq=False)
class ShapeMeasures:
    """What a pose does to the target's surface.

    Attributes
    ----------
    add_m, add_s_m, mssd_m : float, m
    mspd_px : float, px
        Infinite where a point of the target would lie beside or behind the camera.
    vsd : (10,) array or None
        For each of BOP's tolerances; None where it was left out.
    """

    add_m: float
    add_s_m: float
    mssd_m: float
    mspd_px: float
    vsd: Floats | None


@dataclass(frozen=True, eq=False)
class FrameMeasures:
    """One frame of one method.

    Attributes
    ----------
    frame : int
    range_m : float, m
    reason : str or None
        Why there is no pose that the method stands by; None where there is one.
    wrong : bool
        As ``Judgement`` has it.
    position_m, attitude_deg : float or None
        None without a pose.
    speed : SpeedError
        Of a lost frame what those count as.
    shape : ShapeMeasures or None
        None without a pose, or where the target's shape is not known.
    """

    frame: int
    range_m: float
    reason: str | None
    wrong: bool
    position_m: float | None
    attitude_deg: float | None
    speed: SpeedError
    shape: ShapeMeasures | None

    @property
    def lost(self) -> bool:
        """Whether there is no pose."""
        return self.position_m is None


@dataclass(frozen=True, eq=False)
class MethodMeasures:
    """One method on all frames.

    Attributes
    ----------
    label : str
    judged : sequence of Judgement
        As the dataset's chain judges it, frame by frame.
    frames : tuple of FrameMeasures
    runtime_ms : tuple of float, ms
        Of frames that were timed.
    """

    label: str
    judged: Sequence[Judgement]
    frames: tuple[FrameMeasures, ...]
    runtime_ms: tuple[float, ...]


def measured_methods(
    view: TrueView, runs: Mapping[str, Run], advance: Callable[[], None] = lambda: None
) -> list[MethodMeasures]:
    """Measure methods on a dataset, frame by frame, so that what is true is made once a frame.

    Parameters
    ----------
    view : TrueView
    runs : mapping of str to Run
        By label.
    advance : callable
        Called after each frame.

    Raises
    ------
    DatasetError
        If estimates are not of the dataset, or a depth cannot be read.
    """
    judged = {label: view.chain.judge(run, view.judged_by) for label, run in runs.items()}
    found: dict[str, list[FrameMeasures]] = {label: [] for label in runs}
    for place, index in enumerate(view.dataset.indices):
        own = {label: judged[label][place] for label in runs}
        poses = {label: _pose(view, each) for label, each in own.items()}
        shapes = _shapes(view, index, poses)
        for label, each in own.items():
            found[label].append(_frame(view, index, each, poses[label], shapes[label]))
        advance()
    return [
        MethodMeasures(label, judged[label], tuple(found[label]), tuple(run.runtime_ms.values()))
        for label, run in runs.items()
    ]


def _pose(view: TrueView, judged: Judgement) -> RigidTransform | None:
    """Return the pose that was judged; none where the judge found none to stand by."""
    if judged.position_m is None or judged.attitude_deg is None:
        return None
    return pose_stood_by(judged.estimate, view.dataset.onboard)


def _frame(
    view: TrueView,
    index: int,
    judged: Judgement,
    pose: RigidTransform | None,
    shape: ShapeMeasures | None,
) -> FrameMeasures:
    truth = view.truths[index].cam_from_target
    return FrameMeasures(
        frame=index,
        range_m=float(np.linalg.norm(truth.translation)),
        reason=None if pose is not None else judged.reason or "no state",
        wrong=judged.wrong,
        position_m=None if pose is None else judged.position_m,
        attitude_deg=None if pose is None else judged.attitude_deg,
        speed=speed.LOST if pose is None else speed_error(pose, truth),
        shape=shape,
    )


def _shapes(
    view: TrueView, index: int, poses: Mapping[str, RigidTransform | None]
) -> dict[str, ShapeMeasures | None]:
    found: dict[str, ShapeMeasures | None] = dict.fromkeys(poses)
    shape = view.shape
    if shape is None or all(pose is None for pose in poses.values()):
        return found
    truth = view.truths[index].cam_from_target
    true_m = scene_m = np.zeros(0)
    if view.grid is not None:
        true_m = view.distances(truth)
        scene_m = view.scene_distances(index, true_m)
    for label, pose in poses.items():
        if pose is None:
            continue
        discrepancies = None
        if view.grid is not None:
            estimated_m = view.distances(pose)
            discrepancies = bop.vsd(estimated_m, true_m, scene_m, shape.diameter_m)
        found[label] = ShapeMeasures(
            add_m=add(pose, truth, shape.spread),
            add_s_m=add_s(pose, truth, shape.tree),
            mssd_m=bop.mssd(pose, truth, shape.corners, shape.symmetries),
            mspd_px=bop.mspd(pose, truth, shape.points, view.camera, shape.symmetries),
            vsd=discrepancies,
        )
    return found

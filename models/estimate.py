"""What a pipeline must say of a frame: a pose, or a reason for none. Never identity, never NaN."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from models.arrays import Floats
from models.pose import RigidTransform


@dataclass(frozen=True, eq=False)
class Detections:
    """What the image processing found in one frame.

    Attributes
    ----------
    points_px : (n, 2) array, px
        Pixel centres are integers.
    sigma_px : (n, 2) array, px
        Their 1-sigma as the pipeline believes it.
    marker : (n,) tuple of int
        Index of the matched marker or landmark, or -1.
    used : (n,) tuple of bool
        Whether the solver kept the match.
    """

    points_px: Floats
    sigma_px: Floats
    marker: tuple[int, ...]
    used: tuple[bool, ...]

    @classmethod
    def none(cls) -> Detections:
        """Return no detections at all."""
        return cls(np.zeros((0, 2)), np.zeros((0, 2)), (), ())


@dataclass(frozen=True, eq=False)
class PoseEstimate:
    """A pose of the target, from one frame's own readings.

    Attributes
    ----------
    cam_from_target : RigidTransform
    covariance : (6, 6) array or None, rad and m
        Rotation first, in the camera's axes: see ``RigidTransform.perturbed``. None if the
        pipeline states none.
    residual_rms_px : float or None, px
        Root mean square of the reprojection error per axis, over the matches used.
    wrong_probability : float or None
        That this is another pose than the true one, not a little off as its covariance has it but
        a different one; None if the pipeline states none.
    """

    cam_from_target: RigidTransform
    covariance: Floats | None = None
    residual_rms_px: float | None = None
    wrong_probability: float | None = None

    @property
    def stated_covariance(self) -> Floats:
        """(6, 6) array, rad and m; a ValueError where the pipeline states none."""
        if self.covariance is None:
            raise ValueError("expected a pose with a covariance, got one without")
        return self.covariance


@dataclass(frozen=True, eq=False)
class NamedState:
    """One state that a pipeline keeps over time, such as the target's relative motion.

    Attributes
    ----------
    values : mapping of str to array
        Name with its unit at the end (``rho_in_lvlh_m``), any shape.
    covariance : (n, n) array or None
        Of what the pipeline's docstring says, in that order.
    """

    values: Mapping[str, Floats]
    covariance: Floats | None = None


NO_STATES: Mapping[str, NamedState] = MappingProxyType({})


@dataclass(frozen=True, eq=False)
class Estimate:
    """What a pipeline says of one frame. False if it says neither a pose nor a state.

    Attributes
    ----------
    frame : int
    time_s : float, s
        Of the frame.
    pose : PoseEstimate or None
        From this frame's own readings.
    reason : str or None
        Why there is no pose.
    detections : Detections or None
        None if the pipeline tells of none.
    mode : str
        The pipeline's own word for what it did, such as ``tracked``.
    states : mapping of str to NamedState
        What it keeps over time, by name.
    """

    frame: int
    time_s: float
    pose: PoseEstimate | None = None
    reason: str | None = None
    detections: Detections | None = None
    mode: str = ""
    states: Mapping[str, NamedState] = field(default_factory=lambda: NO_STATES)

    def __post_init__(self) -> None:
        if self.pose is not None and self.reason is not None:
            raise ValueError(f"frame {self.frame}: expected a pose or a reason for none, got both")
        if self.pose is None and self.reason is None and not self.states:
            raise ValueError(f"frame {self.frame}: expected a pose, a state or a reason for none")

    def __bool__(self) -> bool:
        return self.pose is not None or bool(self.states)

    def __reduce__(self) -> tuple[Any, ...]:  # a mapping proxy cannot be sent to another process
        return _restored, ({**self.__dict__, "states": dict(self.states)},)

    @property
    def detected(self) -> Detections:
        """The detections, empty where none are told of."""
        return Detections.none() if self.detections is None else self.detections


def _restored(fields: dict[str, Any]) -> Estimate:
    return Estimate(**fields)

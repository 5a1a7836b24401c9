"""The shape of ``score.json``: dataclasses whose fields are its keys."""

from __future__ import annotations

from dataclasses import dataclass

from bench.scoring.centroids import Centroids
from bench.scoring.cramer_rao import Efficiency
from bench.scoring.detections import DetectionScore
from bench.scoring.metrics import AttitudeError, Nees, PositionError, Runtime
from bench.scoring.paper_statistics import PaperStatistics

SCORE_FORMAT = "rvbench-score"
SCORE_VERSION = 1


@dataclass(frozen=True)
class Lost:
    """Frames without a pose.

    Attributes
    ----------
    count : int
    missed : int
        Those in which four or more markers were whole: lit, visible and within the image.
    reasons : dict
        The pipeline's words, and how often.
    frames : list of int
    """

    count: int
    missed: int
    reasons: dict[str, int]
    frames: list[int]


@dataclass(frozen=True)
class PooledScore:
    """The headline numbers over all runs together."""

    runs: int
    frames: int
    estimated: int
    missed: int
    position_error_mm: PositionError
    attitude_error_deg: AttitudeError
    centroid_error_px: Centroids


@dataclass(frozen=True)
class RangeScore:
    """One bin of range, all runs together.

    Attributes
    ----------
    range_m : list of 2 floats, m
        Near and far edge.
    frames, estimated : int
        Frames times runs.
    centroid_bias_px, centroid_std_px : list of 2 floats, px
    position_rms_mm : list of 3 floats
    rotation_rms_deg : list of 3 floats
        Of the rotation vector, camera axes.
    bound_position_mm, bound_rotation_deg : list of 3 floats
        Root mean square of the Cramer-Rao bound.
    efficiency : Efficiency
    """

    range_m: list[float]
    frames: int
    estimated: int
    centroid_bias_px: list[float] | None
    centroid_std_px: list[float] | None
    position_rms_mm: list[float] | None
    rotation_rms_deg: list[float] | None
    bound_position_mm: list[float] | None
    bound_rotation_deg: list[float] | None
    efficiency: Efficiency


@dataclass(frozen=True)
class FrameScore:
    """One frame of run 0.

    Attributes
    ----------
    frame : int
    time_s, range_m : float
    reason : str or None
        Why there is no pose; None if there is one.
    missed : bool
    position_mm, euler_deg, rotation_vector_deg : list of 3 floats
        Estimate minus truth.
    attitude_deg : float
    sigma_position_mm, sigma_rotation_deg : list of 3 floats
        1-sigma that the pipeline states, camera axes.
    bound_position_mm, bound_rotation_deg : list of 3 floats
        1-sigma of the Cramer-Rao bound, camera axes.
    nees : float
        ``e^T P^-1 e``.
    whole, expected, matched, used : int
        Markers lit and visible; expected; matched truly; kept by the solver, of those.
    centroid_mean_px, centroid_std_px : list of 2 floats, px
        Over the markers of this frame.
    centroid_error_px : dict
        By marker name.
    """

    frame: int
    time_s: float
    range_m: float
    reason: str | None
    missed: bool
    position_mm: list[float] | None
    euler_deg: list[float] | None
    rotation_vector_deg: list[float] | None
    attitude_deg: float | None
    sigma_position_mm: list[float] | None
    sigma_rotation_deg: list[float] | None
    bound_position_mm: list[float] | None
    bound_rotation_deg: list[float] | None
    nees: float | None
    whole: int
    expected: int
    matched: int
    used: int
    centroid_mean_px: list[float] | None
    centroid_std_px: list[float] | None
    centroid_error_px: dict[str, list[float]]


@dataclass(frozen=True)
class VariantScore:
    """One pipeline variant on one dataset.

    Errors and detections are of run 0; statistics, efficiency, NEES and ranges pool all runs.
    """

    frames: int
    estimated: int
    lost: Lost
    position_error_mm: PositionError
    attitude_error_deg: AttitudeError
    centroid_error_px: Centroids
    detection: DetectionScore
    paper_statistics: PaperStatistics
    efficiency: Efficiency
    nees: Nees
    runtime_ms: Runtime
    pooled: PooledScore
    per_range: list[RangeScore]
    per_frame: list[FrameScore]


@dataclass(frozen=True)
class Score:
    """The whole of ``score.json``."""

    format: str
    version: int
    case: str
    sun: str
    target: str
    frames: int
    runs: int
    pipelines: dict[str, VariantScore]

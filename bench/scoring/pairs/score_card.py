"""The shape of what image pairs add to ``score.json``: dataclasses whose fields are its keys."""

from __future__ import annotations

from dataclasses import dataclass

from bench.scoring.metrics.pose_errors import AxisErrors
from bench.scoring.pairs.centroids import Centroids
from bench.scoring.pairs.cramer_rao import Efficiency


@dataclass(frozen=True)
class Axes:
    """Pose errors axis by axis, of run 0 and of all runs together."""

    run_0: AxisErrors
    pooled: AxisErrors


@dataclass(frozen=True)
class CentroidScore:
    """Centroid errors, px, of run 0 and of all runs together."""

    run_0: Centroids
    pooled: Centroids


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
class PairRow:
    """What image pairs add to one frame of run 0.

    Attributes
    ----------
    position_mm, euler_deg, rotation_vector_deg : list of 3 floats
        Estimate minus truth.
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

    position_mm: list[float] | None
    euler_deg: list[float] | None
    rotation_vector_deg: list[float] | None
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

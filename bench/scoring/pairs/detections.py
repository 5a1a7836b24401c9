"""Whether what the image processing found was there, and how far off.

A detection is judged against the truth of the 850 nm exposure. It is *true* if it is matched to a
marker of which the camera sees something and lies within ``max(1.5 px, r/2)`` of that marker's
projected centre, r being the radius of the marker's image. Matched and not true is a *mismatch*:
a wrong marker, or none at all.

A marker is *whole* if the camera sees, and the lamps light, at least 99 % of its disc; it is
*expected* if it is whole and its centre lies at least 1.5 r within the image: the 1.2 r of
Opromolla et al. 2022, Table 11, and what blur and the prior's error add. Recall is over expected
markers, in frames with a pose and without.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices, Mask
from models.camera import Camera
from models.estimate import Detections
from models.markers import MarkerPattern
from renders.truth.exposure_truth import ExposureTruth

GATE_PX = 1.5
GATE_RADII = 0.5
WHOLE = 0.99
BORDER_RADII = 1.5
MIN_MARKERS = 4


@dataclass(frozen=True)
class VisibleMarkers:
    """The markers of one frame, as they truly were.

    Attributes
    ----------
    centre_px : (n, 2) array, px
    radius_px : (n,) array, px
        Of the marker's image were it seen face on.
    visible, whole, expected : (n,) bool arrays
    """

    centre_px: Floats
    radius_px: Floats
    visible: Mask
    whole: Mask
    expected: Mask

    @property
    def enough(self) -> bool:
        """Whether at least four markers, or all of fewer, are whole: no pose then is missed."""
        return int(self.whole.sum()) >= min(MIN_MARKERS, len(self.whole))


@dataclass(frozen=True)
class JudgedDetections:
    """The detections of one frame against the truth.

    Attributes
    ----------
    error_px : (n, 2) array, px
        Detection minus the projected centre of the marker it is matched to; NaN if unmatched.
    marker : (n,) int array
        As the pipeline matched them, -1 for none.
    true, mismatch, used : (n,) bool arrays
    near : (n,) bool array
        Whether any marker that the camera sees lies within the gate, matched or not.
    """

    error_px: Floats
    marker: Indices
    true: Mask
    mismatch: Mask
    used: Mask
    near: Mask

    @property
    def found(self) -> Indices:
        """Markers truly found, each once."""
        return np.unique(self.marker[self.true])

    @property
    def solved_with(self) -> Indices:
        """Markers truly found and kept by the solver, each once."""
        return np.unique(self.marker[self.true & self.used])


@dataclass(frozen=True)
class DetectionScore:
    """Detection and identification over many frames.

    Attributes
    ----------
    precision : float
        Share of the matched detections that are true.
    recall : float
        Share of the expected markers that are found.
    mismatches, mismatches_used : int
        Matched detections that are not true, and those of them that the solver kept.
    blobs : int
        All detections, matched or not.
    blob_precision : float
        Share of them that lie on a marker; the rest are glints and noise for the identification
        to reject.
    matched, expected : int
        The denominators of precision and recall.
    """

    precision: float | None
    recall: float | None
    mismatches: int
    mismatches_used: int
    blobs: int
    blob_precision: float | None
    matched: int
    expected: int


def visible_markers(truth: ExposureTruth, camera: Camera, pattern: MarkerPattern) -> VisibleMarkers:
    """Say which markers a pipeline can be asked to find in one frame.

    Parameters
    ----------
    truth : ExposureTruth
        Of the 850 nm exposure.
    camera : Camera
    pattern : MarkerPattern
        The markers of that truth.
    """
    depth = (truth.cam_from_target @ pattern.points_in_target)[:, 2]
    with np.errstate(divide="ignore"):
        radius_px = np.where(depth > 0.0, camera.fx * pattern.radius_m / depth, 0.0)
    visible = (truth.visible > 0.0) & np.isfinite(truth.markers_px).all(axis=1)
    whole = visible & (truth.visible >= WHOLE) & (truth.lamp_lit >= WHOLE)
    inside = [
        bool(camera.contains(centre, BORDER_RADII * radius))
        for centre, radius in zip(truth.markers_px, radius_px, strict=True)
    ]
    return VisibleMarkers(truth.markers_px, radius_px, visible, whole, whole & np.array(inside))


def judge(detections: Detections, markers: VisibleMarkers) -> JudgedDetections:
    """Compare the detections of one frame with the truth."""
    points = detections.points_px
    marker = np.array(detections.marker, dtype=np.int64)
    used = np.array(detections.used, dtype=np.bool_)
    gate_px = np.where(
        markers.visible, np.maximum(GATE_PX, GATE_RADII * markers.radius_px), -np.inf
    )
    distance = np.linalg.norm(points[:, None, :] - markers.centre_px[None, :, :], axis=-1)
    within = np.nan_to_num(distance, nan=np.inf) <= gate_px
    matched = marker >= 0
    true = matched & within[np.arange(len(points)), marker]
    error_px = np.where(matched[:, None], points - markers.centre_px[marker], np.nan)
    return JudgedDetections(
        error_px=error_px,
        marker=marker,
        true=true,
        mismatch=matched & ~true,
        used=used,
        near=within.any(axis=1),
    )


def detection_score(
    frames: Sequence[tuple[JudgedDetections, VisibleMarkers]],
) -> DetectionScore:
    """Count over many frames."""
    matched = sum(int((judged.marker >= 0).sum()) for judged, _ in frames)
    blobs = sum(len(judged.marker) for judged, _ in frames)
    expected = sum(int(markers.expected.sum()) for _, markers in frames)
    found = sum(int(markers.expected[judged.found].sum()) for judged, markers in frames)
    mismatches = sum(int(judged.mismatch.sum()) for judged, _ in frames)
    return DetectionScore(
        precision=(matched - mismatches) / matched if matched else None,
        recall=found / expected if expected else None,
        mismatches=mismatches,
        mismatches_used=sum(int((judged.mismatch & judged.used).sum()) for judged, _ in frames),
        blobs=blobs,
        blob_precision=sum(int(judged.near.sum()) for judged, _ in frames) / blobs
        if blobs
        else None,
        matched=matched,
        expected=expected,
    )

"""What image pairs add to a score: all runs judged, bounded and summed up, part by part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from bench.scoring.asked import Check, checks
from bench.scoring.metrics import pose_errors
from bench.scoring.pairs import centroids
from bench.scoring.pairs.cramer_rao import Efficiency, efficiency, pose_bound
from bench.scoring.pairs.detections import DetectionScore, detection_score
from bench.scoring.pairs.judged_pairs import JudgedFrame, TrueDataset, centroid_errors
from bench.scoring.pairs.paper_statistics import PaperStatistics, paper_statistics
from bench.scoring.pairs.ranges import range_bins
from bench.scoring.pairs.score_card import Axes, CentroidScore, PairRow, RangeScore
from models.arrays import Floats
from models.pose import PoseError

Runs = Sequence[Sequence[JudgedFrame]]


def axes(judged: Runs, truth: TrueDataset, label: str) -> Axes:
    """Summarise the pose errors axis by axis.

    Parameters
    ----------
    judged : sequence of sequences of JudgedFrame
        Run by run.
    truth : TrueDataset
    label : str
        Of the pipeline.
    """
    return Axes(
        pose_errors.axis_errors(_errors(judged[0])),
        pose_errors.axis_errors(_errors(_pooled(judged))),
    )


def centroid_score(judged: Runs, truth: TrueDataset, label: str) -> CentroidScore:
    """Summarise the centroid errors.

    Parameters
    ----------
    judged, truth, label : as for ``axes``
    """
    return CentroidScore(
        centroids.summarise(centroid_errors(judged[0])),
        centroids.summarise(centroid_errors(_pooled(judged))),
    )


def detection(judged: Runs, truth: TrueDataset, label: str) -> DetectionScore:
    """Count what was found, missed and mistaken in run 0.

    A pipeline that tells of no detections, in no frame, has no recall.

    Parameters
    ----------
    judged, truth, label : as for ``axes``
    """
    score = detection_score([(each.detections, each.frame.markers) for each in judged[0]])
    told = any(each.estimate.detections is not None for each in judged[0])
    return score if told else replace(score, recall=None)


def statistics(judged: Runs, truth: TrueDataset, label: str) -> PaperStatistics:
    """Return equations 17 and 18 of the paper over the runs.

    Parameters
    ----------
    judged, truth, label : as for ``axes``
    """
    return paper_statistics([_errors_by_frame(run) for run in judged])


def efficiencies(judged: Runs, truth: TrueDataset, label: str) -> Efficiency:
    """Return the errors over the bound, all runs together.

    Parameters
    ----------
    judged, truth, label : as for ``axes``
    """
    pooled = _pooled(judged)
    return _efficiency(pooled, bounds_of(pooled, truth))


def nees(judged: Runs, truth: TrueDataset, label: str) -> pose_errors.Nees:
    """Hold what the pipeline states against its errors, all runs together.

    Parameters
    ----------
    judged, truth, label : as for ``axes``
    """
    squares = [square for each in _pooled(judged) if (square := _nees(each)) is not None]
    return pose_errors.consistency(squares)


def per_range(judged: Runs, truth: TrueDataset, label: str) -> list[RangeScore]:
    """Summarise by range, all runs together.

    Parameters
    ----------
    judged, truth, label : as for ``axes``
    """
    pooled = _pooled(judged)
    return _per_range(pooled, bounds_of(pooled, truth))


def asked(judged: Runs, truth: TrueDataset, label: str) -> list[Check]:
    """Hold run 0 against what the case asks for.

    Parameters
    ----------
    judged, truth, label : as for ``axes``
    """
    return checks(truth.folder, judged)


def frame_rows(judged: Runs, truth: TrueDataset) -> list[dict[str, Any]]:
    """Return what image pairs add to each frame of run 0."""
    bounds = bounds_of(_pooled(judged), truth)
    own = judged[0]
    return [
        asdict(_row(each, bound, truth.pattern.names))
        for each, bound in zip(own, bounds[: len(own)], strict=True)
    ]


def _pooled(judged: Runs) -> list[JudgedFrame]:
    return [each for run in judged for each in run]


def bounds_of(judged: Sequence[JudgedFrame], dataset: TrueDataset) -> list[Floats | None]:
    """Return the Cramer-Rao bound of each pose, (6, 6), or None.

    It is that of the markers truly found and used in that frame, for the true pose and camera and
    for the centroid noise measured at that range over all the frames and runs given.
    """
    measured = centroid_errors(judged)
    noise = {
        frame.entry.index: centroids.noise_at(frame.range_m, measured).sigma_px
        for frame in dataset.frames
    }
    known: dict[tuple[int, tuple[int, ...]], Floats | None] = {}
    bounds: list[Floats | None] = []
    for each in judged:
        if each.error is None:
            bounds.append(None)
            continue
        used = each.detections.solved_with
        key = (each.estimate.frame, tuple(used.tolist()))
        if key not in known:
            known[key] = pose_bound(
                dataset.camera,
                dataset.pattern.points_in_target[used],
                each.frame.truth.cam_from_target,
                noise[each.estimate.frame],
            )
        bounds.append(known[key])
    return bounds


def _errors(judged: Sequence[JudgedFrame]) -> list[PoseError]:
    return [each.error for each in judged if each.error is not None]


def _errors_by_frame(judged: Sequence[JudgedFrame]) -> dict[int, PoseError]:
    return {each.estimate.frame: each.error for each in judged if each.error is not None}


def _nees(judged: JudgedFrame) -> float | None:
    if judged.estimate.pose is None:
        return None
    return pose_errors.frame_nees(judged.estimate.pose, judged.frame.truth.cam_from_target)


def _efficiency(judged: Sequence[JudgedFrame], bounds: Sequence[Floats | None]) -> Efficiency:
    pairs = [
        (pose_errors.error_vector(each.error), bound)
        for each, bound in zip(judged, bounds, strict=True)
        if each.error is not None
    ]
    return efficiency([error for error, _ in pairs], [bound for _, bound in pairs])


def _per_range(judged: Sequence[JudgedFrame], bounds: Sequence[Floats | None]) -> list[RangeScore]:
    pairs = list(zip(judged, bounds, strict=True))
    scores = []
    for near, far in range_bins(np.array([each.frame.range_m for each in judged])):
        inside = [pair for pair in pairs if near <= pair[0].frame.range_m < far]
        if inside:
            scores.append(_range_score([near, far], inside))
    return scores


def _range_score(
    range_m: list[float], inside: Sequence[tuple[JudgedFrame, Floats | None]]
) -> RangeScore:
    judged = [each for each, _ in inside]
    errors = _errors(judged)
    vectors = np.array([pose_errors.error_vector(error) for error in errors])
    deviations = [np.sqrt(np.diag(bound)) for _, bound in inside if bound is not None]
    summary = centroids.summarise(centroid_errors(judged))
    rms = pose_errors.root_mean_square(vectors) if errors else None
    bound_rms = pose_errors.root_mean_square(deviations) if deviations else None
    return RangeScore(
        range_m=range_m,
        frames=len(judged),
        estimated=len(errors),
        centroid_bias_px=summary.mean,
        centroid_std_px=summary.std,
        position_rms_mm=_in_mm(rms),
        rotation_rms_deg=_in_deg(rms),
        bound_position_mm=_in_mm(bound_rms),
        bound_rotation_deg=_in_deg(bound_rms),
        efficiency=_efficiency(judged, [bound for _, bound in inside]),
    )


def _row(judged: JudgedFrame, bound: Floats | None, names: tuple[str, ...]) -> PairRow:
    error, pose, found = judged.error, judged.estimate.pose, judged.detections
    stated = (
        None
        if pose is None or pose.covariance is None
        else np.sqrt(np.maximum(np.diag(pose.covariance), 0.0))
    )
    smallest = None if bound is None else np.sqrt(np.diag(bound))
    kept = found.true & found.used
    kept_px = found.error_px[kept]
    by_name = {
        names[marker]: [float(x) for x in error_px]
        for marker, error_px in sorted(
            zip(found.marker[kept].tolist(), kept_px, strict=True), key=lambda item: item[0]
        )
    }
    return PairRow(
        position_mm=None if error is None else (1e3 * error.position_m).tolist(),
        euler_deg=None if error is None else error.euler_deg.tolist(),
        rotation_vector_deg=None if error is None else error.rotation_vector_deg.tolist(),
        sigma_position_mm=_in_mm(stated),
        sigma_rotation_deg=_in_deg(stated),
        bound_position_mm=_in_mm(smallest),
        bound_rotation_deg=_in_deg(smallest),
        nees=_nees(judged),
        whole=int(judged.frame.markers.whole.sum()),
        expected=int(judged.frame.markers.expected.sum()),
        matched=len(found.found),
        used=len(found.solved_with),
        centroid_mean_px=kept_px.mean(axis=0).tolist() if len(kept_px) else None,
        centroid_std_px=kept_px.std(axis=0, ddof=1).tolist() if len(kept_px) > 1 else None,
        centroid_error_px=by_name,
    )


def _in_mm(deviations: Floats | list[float] | None) -> list[float] | None:
    """Take the position part of a (6,) vector in rad and m."""
    return None if deviations is None else [1e3 * float(x) for x in deviations[3:]]


def _in_deg(deviations: Floats | list[float] | None) -> list[float] | None:
    """Take the rotation part of a (6,) vector in rad and m."""
    return None if deviations is None else [float(np.rad2deg(x)) for x in deviations[:3]]

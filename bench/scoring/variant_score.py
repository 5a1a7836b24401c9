"""One pipeline variant's score: all runs judged, bounded and summed up."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from bench.estimating.runs import Run
from bench.scoring import centroids, metrics
from bench.scoring.cramer_rao import Efficiency, efficiency, pose_bound
from bench.scoring.detections import detection_score
from bench.scoring.judged_frames import JudgedFrame, TrueDataset, centroid_errors, judge_run
from bench.scoring.paper_statistics import paper_statistics
from bench.scoring.ranges import range_bins
from bench.scoring.score_card import FrameScore, Lost, PooledScore, RangeScore, VariantScore
from models.arrays import Floats
from models.pose import PoseError


def score_variant(runs: Sequence[Run], dataset: TrueDataset) -> VariantScore:
    """Score one pipeline variant over its runs; the first is the headline."""
    judged = [judge_run(run, dataset) for run in runs]
    pooled = [each for run in judged for each in run]
    headline = judged[0]
    bounds = bounds_of(pooled, dataset)
    errors = _errors(headline)
    return VariantScore(
        frames=len(headline),
        estimated=len(errors),
        lost=_lost(headline),
        position_error_mm=metrics.position_error_mm(errors),
        attitude_error_deg=metrics.attitude_error_deg(errors),
        centroid_error_px=centroids.summarise(centroid_errors(headline)),
        detection=detection_score([(each.detections, each.frame.markers) for each in headline]),
        paper_statistics=paper_statistics([_errors_by_frame(run) for run in judged]),
        efficiency=_efficiency(pooled, bounds),
        nees=metrics.consistency([nees for each in pooled if (nees := _nees(each)) is not None]),
        runtime_ms=metrics.runtime(list(runs[0].runtime_ms.values())),
        pooled=_pooled(pooled, len(runs)),
        per_range=_per_range(pooled, bounds),
        per_frame=[
            _frame_score(each, bound, dataset.pattern.names)
            for each, bound in zip(headline, bounds[: len(headline)], strict=True)
        ],
    )


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
    if judged.pose is None:
        return None
    return metrics.frame_nees(judged.pose, judged.frame.truth.cam_from_target)


def _efficiency(judged: Sequence[JudgedFrame], bounds: Sequence[Floats | None]) -> Efficiency:
    pairs = [
        (metrics.error_vector(each.error), bound)
        for each, bound in zip(judged, bounds, strict=True)
        if each.error is not None
    ]
    return efficiency([error for error, _ in pairs], [bound for _, bound in pairs])


def _lost(judged: Sequence[JudgedFrame]) -> Lost:
    lost = [each for each in judged if each.pose is None]
    reasons = Counter(getattr(each.estimate, "reason", "") for each in lost)
    return Lost(
        count=len(lost),
        missed=sum(each.missed for each in lost),
        reasons=dict(sorted(reasons.items(), key=lambda item: (-item[1], item[0]))),
        frames=[each.estimate.frame for each in lost],
    )


def _pooled(judged: Sequence[JudgedFrame], runs: int) -> PooledScore:
    errors = _errors(judged)
    return PooledScore(
        runs=runs,
        frames=len(judged),
        estimated=len(errors),
        missed=sum(each.missed for each in judged),
        position_error_mm=metrics.position_error_mm(errors),
        attitude_error_deg=metrics.attitude_error_deg(errors),
        centroid_error_px=centroids.summarise(centroid_errors(judged)),
    )


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
    vectors = np.array([metrics.error_vector(error) for error in errors])
    deviations = [np.sqrt(np.diag(bound)) for _, bound in inside if bound is not None]
    summary = centroids.summarise(centroid_errors(judged))
    rms = metrics.root_mean_square(vectors) if errors else None
    bound_rms = metrics.root_mean_square(deviations) if deviations else None
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


def _frame_score(judged: JudgedFrame, bound: Floats | None, names: tuple[str, ...]) -> FrameScore:
    error, pose, found = judged.error, judged.pose, judged.detections
    stated = None if pose is None else np.sqrt(np.maximum(np.diag(pose.covariance), 0.0))
    smallest = None if bound is None else np.sqrt(np.diag(bound))
    kept = found.true & found.used
    kept_px = found.error_px[kept]
    by_name = {
        names[marker]: [float(x) for x in error_px]
        for marker, error_px in sorted(
            zip(found.marker[kept].tolist(), kept_px, strict=True), key=lambda item: item[0]
        )
    }
    return FrameScore(
        frame=judged.estimate.frame,
        time_s=judged.estimate.time_s,
        range_m=judged.frame.range_m,
        reason=getattr(judged.estimate, "reason", None),
        missed=judged.missed,
        position_mm=None if error is None else (1e3 * error.position_m).tolist(),
        euler_deg=None if error is None else error.euler_deg.tolist(),
        rotation_vector_deg=None if error is None else error.rotation_vector_deg.tolist(),
        attitude_deg=None if error is None else error.attitude_deg,
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

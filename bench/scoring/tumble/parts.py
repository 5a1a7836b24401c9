"""What single images of a free target add to a score: the state, corners, starts, and limits.

Errors are those of the filtered state from the first state on; the pose of the image alone stands
beside.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from bench.estimating.tumble.starts import read_starts, starts_path
from bench.scoring.asked import Check, checks
from bench.scoring.core_score import Sizes, sizes
from bench.scoring.judgement import without_numbers
from bench.scoring.tumble.judged_images import STATE_DOF, JudgedImage, TrueImages, confusion_of
from bench.scoring.tumble.navigation_errors import pose_error_sizes
from bench.scoring.tumble.score_card import CornerScore, Limit, StartsScore, StateScore
from models.errors import DatasetError
from models.quantiles import chi_square_quantile

CONFIDENCE = 0.95
BINS = 4
Runs = Sequence[Sequence[JudgedImage]]


def state(judged: Runs, truth: TrueImages, label: str) -> StateScore:
    """Summarise the filtered state of run 0.

    Parameters
    ----------
    judged : sequence of sequences of JudgedImage
        Run by run.
    truth : TrueImages
    label : str
        Of the pipeline.
    """
    frames = judged[0]
    states = [each for each in frames if not np.isnan(each.error.position_m)]
    first = states[0].estimate.frame if states else None
    after = [each for each in frames if first is not None and each.estimate.frame >= first]
    lost = sum(each.lost for each in after)
    return StateScore(
        with_state=len(states),
        first_state=first,
        lost_share=lost / len(after) if after else None,
        modes=dict(Counter(each.estimate.mode for each in frames)),
        position_m=_sizes(frames, "position_m"),
        attitude_deg=_sizes(frames, "attitude_deg"),
        velocity_m_s=_sizes(frames, "velocity_m_s"),
        rate_deg_s=_sizes(frames, "rate_deg_s"),
        raw_position_m=_sizes(frames, "raw_position_m"),
        raw_attitude_deg=_sizes(frames, "raw_attitude_deg"),
        confusions=dict(Counter(e.confusion for e in frames if e.confusion is not None)),
        nees={
            "translation": _nees([each.error.nees_translation for each in frames]),
            "rotation": _nees([each.error.nees_rotation for each in frames]),
        },
    )


def corners(judged: Runs, truth: TrueImages, label: str) -> CornerScore:
    """Pool the corners of all frames of run 0.

    Parameters
    ----------
    judged, truth, label : as for ``state``
    """
    return corner_score(judged[0])


def limits(judged: Runs, truth: TrueImages, label: str) -> list[Limit]:
    """Sort the frames of run 0 by what may limit a pose, and give the errors by quarter.

    Parameters
    ----------
    judged, truth, label : as for ``state``
    """
    return limits_of(judged[0])


def starts(judged: Runs, truth: TrueImages, label: str) -> StartsScore | None:
    """Judge the starts that were tried; None where none were.

    Parameters
    ----------
    judged, truth, label : as for ``state``

    Raises
    ------
    DatasetError
        As ``starts_score``.
    """
    return starts_score(truth, label)


def asked(judged: Runs, truth: TrueImages, label: str) -> list[Check]:
    """Hold run 0, and the starts, against what the case asks for.

    Parameters
    ----------
    judged, truth, label : as for ``state``
    """
    tried = starts_score(truth, label)
    right = None if tried is None else tried.within / tried.starts
    return checks(truth.dataset.folder, judged, right)


def frame_rows(judged: Runs, truth: TrueImages) -> list[dict[str, Any]]:
    """Return what single images add to each frame of run 0."""
    return [each.row() for each in judged[0]]


def _sizes(frames: Sequence[JudgedImage], name: str) -> Sizes:
    return sizes([getattr(each.error, name) for each in frames])


def _nees(squares: Sequence[float]) -> dict[str, float | None]:
    there = np.array([value for value in squares if not np.isnan(value)])
    if not there.size:
        return {"mean": None, "inside": None}
    limit = chi_square_quantile(CONFIDENCE, STATE_DOF)
    return {
        "mean": float(there.mean() / STATE_DOF),
        "inside": float(np.mean(there <= limit)),
    }


def corner_score(frames: Sequence[JudgedImage]) -> CornerScore:
    """Pool the corners of all frames; of a pipeline that tells of none, what was there to find."""
    corners = [each.corners for each in frames]
    told = any(each.estimate.detections is not None for each in frames)
    visible, lit = sum(c.visible for c in corners), sum(c.lit for c in corners)
    found, found_lit = sum(c.found for c in corners), sum(c.found_lit for c in corners)
    detected = sum(c.detected for c in corners)
    square = sum(c.square_px for c in corners)
    count = max(1, len(corners))
    return CornerScore(
        repeatability=_ratio(found, visible) if told else None,
        repeatability_lit=_ratio(found_lit, lit) if told else None,
        repeatability_dark=_ratio(found - found_lit, visible - lit) if told else None,
        rms_px=float(np.sqrt(0.5 * square / found)) if found else None,
        precision=_ratio(found, detected),
        detected=detected / count if told else None,
        visible=visible / count,
        lit_share=_ratio(lit, visible),
    )


def _ratio(part: int, whole: int) -> float | None:
    return part / whole if whole else None


def limits_of(frames: Sequence[JudgedImage]) -> list[Limit]:
    """Sort the frames by what may limit a pose, and give the errors by quarter."""
    measures = {
        "visible landmarks": [float(each.corners.visible) for each in frames],
        "sunlit share": [each.corners.lit / max(1, each.corners.visible) for each in frames],
        "corners found": [each.corners.found / max(1, each.corners.visible) for each in frames],
    }
    if all(each.estimate.detections is None for each in frames):
        del measures["corners found"]
    found = []
    for name, values in measures.items():
        for part in np.array_split(np.argsort(values, kind="stable"), min(BINS, len(frames))):
            own = [frames[place] for place in part]
            errors = [each.error for each in own if not np.isnan(each.error.raw_position_m)]
            span = [values[part[0]], values[part[-1]]]
            found.append(
                Limit(
                    name, span, len(own), len(errors),
                    sizes([each.raw_position_m for each in errors]).median,
                    sizes([each.raw_attitude_deg for each in errors]).median,
                )
            )  # fmt: skip
    return found


def starts_score(truth: TrueImages, label: str) -> StartsScore | None:
    """Judge the starts that were tried by a pipeline; None where none were.

    Raises
    ------
    DatasetError
        If a start tells of a pose in a frame that the dataset has not, or the file is damaged.
    """
    most_images, tried = read_starts(truth.dataset.folder, label)
    if not tried:
        return None
    limit = truth.limits
    right, confusions, first, wrong = [], Counter[str](), 0, 0
    for start in tried:
        if start.cam_from_target is None or start.pose_frame is None:
            continue
        if start.pose_frame not in truth.by_frame:
            raise DatasetError(
                f"{starts_path(truth.dataset.folder, label)}: expected frames of the dataset, got "
                f"{start.pose_frame}; delete it and estimate again: only what is missing is done"
            )
        was = truth.by_frame[start.pose_frame].cam_from_target
        moved_m, turned_deg = pose_error_sizes(start.cam_from_target, was)
        if moved_m > limit.wrong_position_m or turned_deg > limit.wrong_attitude_deg:
            wrong += 1
            if turned_deg > limit.wrong_attitude_deg:
                confusions[confusion_of(start.cam_from_target, was, truth.knowledge.target)] += 1
            continue
        right.append((moved_m, turned_deg))
        first += start.images == 1
    return StartsScore(
        starts=len(tried),
        most_images=most_images,
        first_image=int(first),
        within=len(right),
        wrong=wrong,
        none=len(tried) - len(right) - wrong,
        confusions=dict(confusions),
        position_m=sizes([each[0] for each in right]),
        attitude_deg=sizes([each[1] for each in right]),
        seconds=sizes([each.seconds for each in tried]),
        reasons=dict(
            Counter(without_numbers(e.reason) for e in tried if not e.images).most_common()
        ),
    )

"""Score a run on rendered frames of a tumbling target: every variant, against the truth.

A frame without a state is never dropped: it is counted as lost, with its reason. Errors are those
of the filtered state from the first state on; the pose of the image alone stands beside.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import chi2

from bench.estimating.runs import estimates_path, found_variants
from bench.estimating.starts import read_starts
from bench.scoring.frame_judgement import FrameJudgement, confusion_of, judged
from bench.scoring.navigation_errors import pose_error_sizes
from bench.scoring.tumble_score_card import (
    FORMAT,
    VERSION,
    CornerScore,
    Limit,
    Sizes,
    StartsScore,
    TumbleVariant,
)
from bench.suites.pesce2019.acquisition_trial import WRONG_DEG, WRONG_M
from bench.suites.pesce2019.summaries import without_numbers
from models.atomic_file import write_text
from models.dataset.dataset import read_frame_entries
from models.dataset.image_dataset import read_image_info, read_uncooperative_knowledge
from models.dataset.navigation_estimates_file import read_navigation_estimates
from models.errors import DatasetError, UnreadableError, cause
from models.reading.json_file import read_json_table
from models.uncooperative import NavigationEstimate, UncooperativeKnowledge
from renders.truth.image_truth import ImageTruth, read_image_truths

STATE_DOF = 6
CONFIDENCE = 0.95
BINS = 4
# What is asked of a target: median position (m) and attitude (deg) once acquired.
ASKED = {"xmm": (0.10, 1.5), "hispasat": (0.15, 2.0)}
ASKED_STARTS, ASKED_LOST, ASKED_WRONG_RUN = 0.95, 0.05, 10


def score_tumble(folder: Path) -> dict[str, Any]:
    """Score a dataset of single images into ``score.json``.

    Returns
    -------
    dict
        What was written.

    Raises
    ------
    DatasetError
        If the truth or the estimates are missing, or are not of the same frames.
    """
    info, knowledge = read_image_info(folder), read_uncooperative_knowledge(folder)
    truths, wanted = read_image_truths(folder), [e.index for e in read_frame_entries(folder)]
    pipelines = {}
    for variant in found_variants(folder):
        said = _read(folder, variant, wanted)
        frames = [judged(each, truths[each.frame], knowledge) for each in said]
        starts = starts_score(folder, variant, truths, knowledge)
        pipelines[variant] = asdict(variant_score(frames, starts, knowledge.target.name))
    document = {
        "format": FORMAT,
        "version": VERSION,
        "case": info.case,
        "target": knowledge.target.name,
        "frames": len(wanted),
        "pipelines": pipelines,
    }
    write_text(folder / "score.json", json.dumps(document, indent=1, allow_nan=False) + "\n")
    return document


def read_tumble_score(folder: Path) -> dict[str, Any]:
    """Read ``score.json`` of a dataset of single images.

    Raises
    ------
    DatasetError
        If it is missing, of another format, or cannot be read.
    """
    path = folder / "score.json"
    try:
        score = read_json_table(path)
        if (score["format"], score["version"]) != (FORMAT, VERSION):
            raise ValueError(f"{score['format']}, version {score['version']}")
    except (UnreadableError, KeyError, ValueError) as error:
        raise DatasetError(
            f"{path}: expected {FORMAT}, version {VERSION}, got: {cause(error)}; "
            f"run `rvbench score {folder}`"
        ) from error
    return score


def _read(folder: Path, variant: str, wanted: list[int]) -> list[NavigationEstimate]:
    path = estimates_path(folder, 0, variant)
    said = read_navigation_estimates(path)
    if [each.frame for each in said] != wanted:
        raise DatasetError(
            f"{path}: expected one estimate for each of the {len(wanted)} frames in order, got "
            f"{len(said)}; the frames have changed since: run `rvbench estimate {folder}` again"
        )
    return said


def variant_score(
    frames: Sequence[FrameJudgement], starts: StartsScore | None, target: str
) -> TumbleVariant:
    """Summarise the judged frames of one variant."""
    states = [each for each in frames if not np.isnan(each.error.position_m)]
    first = states[0].frame if states else None
    after = [each for each in frames if first is not None and each.frame >= first]
    lost = sum(each.reason is not None for each in after)
    scored = TumbleVariant(
        frames=len(frames),
        with_state=len(states),
        first_state=first,
        lost=lost,
        lost_share=lost / len(after) if after else None,
        reasons=_counted(e.reason for e in frames if e.reason is not None),
        modes=dict(Counter(each.mode for each in frames)),
        position_m=_sizes(frames, "position_m"),
        attitude_deg=_sizes(frames, "attitude_deg"),
        velocity_m_s=_sizes(frames, "velocity_m_s"),
        rate_deg_s=_sizes(frames, "rate_deg_s"),
        raw_position_m=_sizes(frames, "raw_position_m"),
        raw_attitude_deg=_sizes(frames, "raw_attitude_deg"),
        wrong=sum(each.wrong for each in frames),
        longest_wrong=longest_run([each.wrong for each in frames]),
        confusions=dict(Counter(e.confusion for e in frames if e.confusion is not None)),
        nees={
            "translation": _nees([each.error.nees_translation for each in frames]),
            "rotation": _nees([each.error.nees_rotation for each in frames]),
        },
        corners=corner_score(frames),
        starts=starts,
        limits=limits(frames),
        checks=[],
        per_frame=[each.to_json() for each in frames],
    )
    scored.checks.extend(_checks(scored, target))
    return scored


def longest_run(flags: Sequence[bool]) -> int:
    """Return how many in a row are true, at most."""
    longest = now = 0
    for flag in flags:
        now = now + 1 if flag else 0
        longest = max(longest, now)
    return longest


def sizes(values: Sequence[float]) -> Sizes:
    """Summarise the sizes that are not NaN."""
    there = np.sort([value for value in values if not np.isnan(value)])
    if not there.size:
        return Sizes(None, None, None)
    return Sizes(
        float(np.median(there)),
        float(np.percentile(there, 95.0)),
        float(np.sqrt(np.mean(there**2))),
    )


def _sizes(frames: Sequence[FrameJudgement], name: str) -> Sizes:
    return sizes([getattr(each.error, name) for each in frames])


def _nees(squares: Sequence[float]) -> dict[str, float | None]:
    there = np.array([value for value in squares if not np.isnan(value)])
    if not there.size:
        return {"mean": None, "inside": None}
    limit = float(chi2.ppf(CONFIDENCE, STATE_DOF))
    return {
        "mean": float(there.mean() / STATE_DOF),
        "inside": float(np.mean(there <= limit)),
    }


def corner_score(frames: Sequence[FrameJudgement]) -> CornerScore:
    """Pool the corners of all frames."""
    corners = [each.corners for each in frames]
    visible, lit = sum(c.visible for c in corners), sum(c.lit for c in corners)
    found, found_lit = sum(c.found for c in corners), sum(c.found_lit for c in corners)
    detected = sum(c.detected for c in corners)
    square = sum(c.square_px for c in corners)
    count = max(1, len(corners))
    return CornerScore(
        repeatability=_ratio(found, visible),
        repeatability_lit=_ratio(found_lit, lit),
        repeatability_dark=_ratio(found - found_lit, visible - lit),
        rms_px=float(np.sqrt(0.5 * square / found)) if found else None,
        precision=_ratio(found, detected),
        detected=detected / count,
        visible=visible / count,
        lit_share=_ratio(lit, visible),
    )


def _ratio(part: int, whole: int) -> float | None:
    return part / whole if whole else None


def limits(frames: Sequence[FrameJudgement]) -> list[Limit]:
    """Sort the frames by what may limit a pose, and give the errors by quarter."""
    measures = {
        "visible landmarks": [float(each.corners.visible) for each in frames],
        "sunlit share": [each.corners.lit / max(1, each.corners.visible) for each in frames],
        "corners found": [each.corners.found / max(1, each.corners.visible) for each in frames],
    }
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


def starts_score(
    folder: Path,
    variant: str,
    truths: dict[int, ImageTruth],
    knowledge: UncooperativeKnowledge,
) -> StartsScore | None:
    """Judge the starts that were tried; None where none were."""
    most_images, starts = read_starts(folder, variant)
    if not starts:
        return None
    right, confusions, first, wrong = [], Counter[str](), 0, 0
    for start in starts:
        if start.cam_from_target is None or start.pose_frame is None:
            continue
        truth = truths[start.pose_frame].cam_from_target
        moved_m, turned_deg = pose_error_sizes(start.cam_from_target, truth)
        if moved_m > WRONG_M or turned_deg > WRONG_DEG:
            wrong += 1
            if turned_deg > WRONG_DEG:
                confusions[confusion_of(start.cam_from_target, truth, knowledge.target)] += 1
            continue
        right.append((moved_m, turned_deg))
        first += start.images == 1
    return StartsScore(
        starts=len(starts),
        most_images=most_images,
        first_image=int(first),
        within=len(right),
        wrong=wrong,
        none=len(starts) - len(right) - wrong,
        confusions=dict(confusions),
        position_m=sizes([each[0] for each in right]),
        attitude_deg=sizes([each[1] for each in right]),
        seconds=sizes([each.seconds for each in starts]),
        reasons=_counted(each.reason for each in starts if not each.images),
    )


def _counted(reasons: Iterable[str]) -> dict[str, int]:
    return dict(Counter(map(without_numbers, reasons)).most_common())


def _checks(scored: TumbleVariant, target: str) -> list[dict[str, Any]]:
    position_m, attitude_deg = ASKED.get(target, ASKED["xmm"])
    checks: list[tuple[str, str, float | None, bool | None]] = []

    def at_most(what: str, asked: float, unit: str, measured: float | None) -> None:
        holds = None if measured is None else measured <= asked
        text = f"{100.0 * asked:g} %" if unit == "%" else f"{asked:g} {unit}"
        checks.append((what, f"at most {text}", measured, holds))

    if scored.starts is not None:
        share = scored.starts.within / scored.starts.starts
        asked = f"at least {100 * ASKED_STARTS:g} %"
        checks.append(("starts acquired rightly", asked, share, share >= ASKED_STARTS))
    at_most("median position error", position_m, "m", scored.position_m.median)
    at_most("median attitude error", attitude_deg, "deg", scored.attitude_deg.median)
    at_most("frames lost once acquired", ASKED_LOST, "%", scored.lost_share)
    at_most("longest run of wrong states", ASKED_WRONG_RUN, "frames", scored.longest_wrong)
    return [
        {"what": what, "asked": asked, "measured": measured, "holds": holds}
        for what, asked, measured, holds in checks
    ]

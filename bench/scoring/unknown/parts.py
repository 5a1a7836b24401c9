"""What images of an unknown target add to a score: motion, shape, tracks, and what is asked."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from bench.report.scenario_tables import scenario_tables
from bench.scoring.asked import Check, checks, held_at_most
from bench.scoring.core_score import Sizes, sizes
from bench.scoring.limits import read_asked
from bench.scoring.unknown.cloud import CloudScore, Surface, cloud_score, seen_surface
from bench.scoring.unknown.inertia_score import InertiaScore, inertia_score
from bench.scoring.unknown.judged_unknown import JudgedUnknown, TrueUnknown, second_half
from models.arrays import Floats
from models.estimate import Estimate
from pipelines.unknown_target.pipeline import INERTIA, SHAPE

Runs = Sequence[Sequence[JudgedUnknown]]


@dataclass(frozen=True)
class MotionScore:
    """The motion of run 0 over the second half of the frames that have one, and at the end.

    Attributes
    ----------
    first_frame : int or None
        The first with a pose.
    frames : int
        Judged.
    range_share, velocity_m_s, rate_deg_s, axis_deg : Sizes
        Sizes of the errors.
    last : dict or None
        ``MotionError`` of the last frame.
    inertia_percent : float or None
        Largest error of an entry of the inertia at the end, of its trace.
    """

    first_frame: int | None
    frames: int
    range_share: Sizes
    velocity_m_s: Sizes
    rate_deg_s: Sizes
    axis_deg: Sizes
    last: dict[str, float | None] | None
    inertia_percent: float | None


@dataclass(frozen=True)
class TrackScore:
    """The tracks of run 0.

    Attributes
    ----------
    tracks : int
    lengths : list of int
        Images in which each was seen: 10th, 50th and 90th percentile, and most.
    live, used : float
        Mean of an image: tracks, and those that go by a point of the shape.
    """

    tracks: int
    lengths: list[int]
    live: float
    used: float


def motion(judged: Runs, truth: TrueUnknown, label: str) -> MotionScore:
    """Summarise the motion of run 0.

    Parameters
    ----------
    judged : sequence of sequences of JudgedUnknown
    truth : TrueUnknown
    label : str
        Of the pipeline.
    """
    frames = judged[0]
    settled, known = second_half(frames), inertia(judged, truth, label)
    first = next((each.estimate.frame for each in frames if each.estimate.pose is not None), None)
    return MotionScore(
        first,
        len(settled),
        sizes([abs(each.range_share) for each in settled]),
        sizes([each.velocity_m_s for each in settled]),
        sizes([each.rate_deg_s for each in settled]),
        sizes([each.axis_deg for each in settled]),
        asdict(settled[-1]) if settled else None,
        None if known is None else known.entries_percent,
    )


def shape(judged: Runs, truth: TrueUnknown, label: str) -> CloudScore | None:
    """Hold the cloud at the end of run 0 against the surface; None where there is none.

    Parameters
    ----------
    judged, truth, label : as for ``motion``
    """
    cloud = last_cloud(judged[0])
    if cloud is None:
        return None
    points, sigma_m = cloud
    seen = seen_surface(truth.dataset, dict(truth.by_frame))
    return cloud_score(points, sigma_m, Surface.of(truth.dataset), seen)


def tracks(judged: Runs, truth: TrueUnknown, label: str) -> TrackScore:
    """Count the tracks of run 0.

    Parameters
    ----------
    judged, truth, label : as for ``motion``
    """
    found = [each.estimate.detected for each in judged[0]]
    lengths = Counter(name for each in found for name in each.marker)
    count = max(1, len(found))
    told = sorted(lengths.values())
    quantiles = np.quantile(told, (0.1, 0.5, 0.9, 1.0)).astype(int).tolist() if told else []
    return TrackScore(
        len(told),
        quantiles,
        sum(len(each.marker) for each in found) / count,
        sum(sum(each.used) for each in found) / count,
    )


def asked(judged: Runs, truth: TrueUnknown, label: str) -> list[Check]:
    """Hold run 0 against what the case asks for.

    Parameters
    ----------
    judged, truth, label : as for ``motion``
    """
    folder = truth.dataset.folder
    wanted, found = read_asked(folder), motion(judged, truth, label)
    cloud = shape(judged, truth, label) if wanted.shape_rms_m is not None else None
    return [
        *checks(folder, judged),
        *held_at_most("median range error", wanted.range_share, found.range_share.median, "%"),
        *held_at_most("median rate error", wanted.rate_deg_s, found.rate_deg_s.median, "deg/s"),
        *held_at_most("median spin axis error", wanted.axis_deg, found.axis_deg.median, "deg"),
        *held_at_most("shape, rms to the surface", wanted.shape_rms_m,
                      None if cloud is None else cloud.rms_m, "m"),
    ]  # fmt: skip


def frame_rows(judged: Runs, truth: TrueUnknown) -> list[dict[str, Any]]:
    """Return what an unknown target adds to each frame of run 0."""
    return [
        {
            "motion": None if each.motion is None else asdict(each.motion),
            "tracks": len(each.estimate.detected.marker),
            "used": sum(each.estimate.detected.used),
        }
        for each in judged[0]
    ]


def last_cloud(frames: Sequence[JudgedUnknown]) -> tuple[Floats, Floats | None] | None:
    """Return the points that a run ends with, (n, 3) m in true axes, and their sigmas."""
    for each in reversed(frames):
        if SHAPE in each.estimate.states and each.true_from_own is not None:
            values = each.estimate.states[SHAPE].values
            points = values["points_in_target_m"].reshape(-1, 3)
            return points @ each.true_from_own.T, values.get("sigma_m")
    return None


def inertia(judged: Runs, truth: TrueUnknown, label: str) -> InertiaScore | None:
    """Hold the inertia at the end of run 0 against the true one; None where either is missing.

    Parameters
    ----------
    judged, truth, label : as for ``motion``
    """
    frames = judged[0]
    table = scenario_tables(truth.dataset.folder).get("tumble", {})
    said: Estimate | None = frames[-1].estimate if frames else None
    turn = frames[-1].true_from_own if frames else None
    if said is None or turn is None or INERTIA not in said.states or "inertia_kg_m2" not in table:
        return None
    own = turn @ said.states[INERTIA].values["inertia_of_trace_1"] @ turn.T
    return inertia_score(own, np.array(table["inertia_kg_m2"], dtype=np.float64))

"""A surface held against the mesh that was rendered: how right it is, and how much of it there is.

Accuracy and completeness are Seitz et al.'s (2006, CVPR, "A comparison and evaluation of multi-view
stereo reconstruction algorithms"), precision, recall and F-score Knapitsch et al.'s (2017, ACM
Transactions on Graphics 36, "Tanks and Temples"), at one hundredth of the target's size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.estimating.unknown.shape_files import read_surface
from bench.scoring.target_shape import spread_points, target_shape
from bench.scoring.unknown.cloud import NEAREST_M, Surface, seen_surface
from bench.scoring.unknown.judged_unknown import JudgedUnknown, TrueUnknown
from models.arrays import Floats

ASKED = 20_000  # places of the surface that is judged
SIZE_SHARE = 0.01


@dataclass(frozen=True)
class SurfaceScore:
    """A surface against the true one.

    Attributes
    ----------
    accuracy_rms_m, accuracy_median_m : float
        Distance of its places to the true surface.
    completeness_5cm : float or None
        Share of the seen surface within 5 cm of it; None where nothing tells what was seen.
    within_m : float
        One hundredth of the target's size, for the next three.
    precision : float
        Share of its places so near to the true surface.
    recall, f_score : float or None
        Share of the seen surface so near to it; harmonic mean of both.
    chamfer_m : float or None
        Mean of the mean distances either way.
    """

    accuracy_rms_m: float
    accuracy_median_m: float
    completeness_5cm: float | None
    within_m: float
    precision: float
    recall: float | None
    f_score: float | None
    chamfer_m: float | None


def surface_score(own: Floats, true: Floats, seen: Floats) -> SurfaceScore:
    """Hold a surface against the true one.

    Parameters
    ----------
    own, true : (f, 3, 3) and (g, 3, 3) arrays, m
        Triangles, true axes.
    seen : (k, 3) array, m
        Places of the true one that images showed; none where that is not known.
    """
    corners = true.reshape(-1, 3)
    within_m = SIZE_SHARE * float(np.linalg.norm(np.ptp(corners, axis=0)))
    away = Surface(true).distances(spread_points(own, ASKED))
    precision = float(np.mean(away < within_m))
    complete = recall = f_score = chamfer = None
    if len(seen):
        back = Surface(own).distances(seen)
        complete, recall = float(np.mean(back < NEAREST_M)), float(np.mean(back < within_m))
        both = precision + recall
        f_score = 2.0 * precision * recall / both if both else 0.0
        chamfer = 0.5 * float(away.mean() + back.mean())
    return SurfaceScore(
        float(np.sqrt(np.mean(away**2))),
        float(np.median(away)),
        complete,
        within_m,
        precision,
        recall,
        f_score,
        chamfer,
    )


def surface(
    judged: Sequence[Sequence[JudgedUnknown]], truth: TrueUnknown, label: str
) -> SurfaceScore | None:
    """Hold the surface that run 0 left against the true one; None where either is missing.

    Parameters
    ----------
    judged : sequence of sequences of JudgedUnknown
    truth : TrueUnknown
    label : str
        Of the pipeline.
    """
    dataset = truth.dataset
    own, shape = surface_in_true(judged[0], truth, label), target_shape(dataset)
    if own is None or shape is None:
        return None
    seen = seen_surface(dataset, dict(truth.by_frame))
    return surface_score(own, shape.vertices[shape.faces], seen)


def surface_in_true(
    frames: Sequence[JudgedUnknown], truth: TrueUnknown, label: str
) -> Floats | None:
    """Return the triangles of a run's surface in true axes, (f, 3, 3) m; None where there is none.

    Parameters
    ----------
    frames : sequence of JudgedUnknown
        Of run 0.
    truth : TrueUnknown
    label : str
        Of the pipeline.
    """
    own = read_surface(truth.dataset, label)
    turn = frames[0].true_from_own if frames else None
    return None if own is None or turn is None else np.asarray(own @ turn.T)

"""Centroid errors: their bias and noise, over a run, along the range, and from run to run.

An error is a true detection (``bench.scoring.pairs.detections``) that the solver kept, minus the
projected centre of its marker with the true pose and camera; what a pipeline itself rejects it
does not measure. A pipeline that corrects for the perspective of a circle reports the corrected
point, so one truth serves all.

The noise at a range is measured, not assumed: the standard deviation of the errors of all
markers, runs and frames whose range is within 10 % of it, about the mean of those errors, which is
the bias there. Where that is fewer than 60 errors the nearest frames in range are added. What
differs from marker to marker and repeats from run to run (where a disc falls between the pixels)
counts as noise, as it does in one flight; ``Centroids.temporal_std`` tells the detector's part.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices

RANGE_WINDOW = 0.1
MIN_SAMPLES = 60


@dataclass(frozen=True)
class CentroidErrors:
    """Errors of true detections, flat.

    Attributes
    ----------
    error_px : (n, 2) array, px
    range_m : (n,) array, m
    frame, run, marker : (n,) int arrays
    """

    error_px: Floats
    range_m: Floats
    frame: Indices
    run: Indices
    marker: Indices

    def __len__(self) -> int:
        return len(self.error_px)


@dataclass(frozen=True)
class Centroids:
    """Centroid errors summed up, px, [u, v].

    Attributes
    ----------
    mean, std : list of 2 floats
        Bias and standard deviation (n - 1) over all markers and frames: Table 13 of the paper.
    temporal_std : list of 2 floats or None
        What is left when each marker's mean over the runs is taken off, frame by frame: the
        detector's noise alone. None for a single run.
    count : int
    """

    mean: list[float] | None
    std: list[float] | None
    temporal_std: list[float] | None
    count: int


@dataclass(frozen=True)
class CentroidNoise:
    """Centroid errors near one range, px, [u, v].

    Attributes
    ----------
    bias_px, sigma_px : (2,) arrays
        NaN where there are fewer than two errors.
    count : int
        Errors pooled.
    """

    bias_px: Floats
    sigma_px: Floats
    count: int


def temporal_std(errors: CentroidErrors) -> list[float] | None:
    """Return the noise about each marker's own mean over the runs, frame by frame; px, [u, v]."""
    keys = np.stack([errors.frame, errors.marker], axis=1)
    _, group, sizes = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    dof = int((sizes - 1).sum())
    if dof < 1:
        return None
    std = []
    for column in errors.error_px.T:
        mean = np.bincount(group, weights=column) / sizes
        std.append(float(np.sqrt(((column - mean[group]) ** 2).sum() / dof)))
    return std


def summarise(errors: CentroidErrors) -> Centroids:
    """Sum up centroid errors."""
    if len(errors) < 2:
        return Centroids(None, None, None, len(errors))
    ordered = np.sort(errors.error_px, axis=0)  # sums do not depend on the order of frames
    return Centroids(
        mean=[float(x) for x in ordered.mean(axis=0)],
        std=[float(x) for x in ordered.std(axis=0, ddof=1)],
        temporal_std=temporal_std(errors),
        count=len(errors),
    )


def noise_at(range_m: float, errors: CentroidErrors) -> CentroidNoise:
    """Measure the centroid noise near a range; see the module's text."""
    if len(errors) < 2:
        return CentroidNoise(np.full(2, np.nan), np.full(2, np.nan), len(errors))
    away = np.abs(np.log(errors.range_m / range_m))
    wanted = min(MIN_SAMPLES, len(errors)) - 1
    window = max(np.log1p(RANGE_WINDOW), float(np.partition(away, wanted)[wanted]))
    near = np.sort(errors.error_px[away <= window], axis=0)
    return CentroidNoise(near.mean(axis=0), near.std(axis=0, ddof=1), len(near))

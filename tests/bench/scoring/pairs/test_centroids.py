"""Noise and bias put in come out again."""

import numpy as np
import pytest

from bench.scoring.pairs.centroids import CentroidErrors, noise_at, summarise, temporal_std

SIGMA_PX = np.array([0.05, 0.08])
BIAS_PX = np.array([0.01, -0.02])
# Relative sd of a standard deviation from n values is 1 / sqrt(2 n): with 4000, 1.1 %.
FOUR_SIGMA_OF_4000 = 0.045


def drawn(frames: int, runs: int, markers: int, repeating_px: float = 0.0) -> CentroidErrors:
    """Draw errors at 6.7 to 1.8 m: bias, detector noise, and a part that repeats in every run."""
    rng = np.random.default_rng(8)
    frame, run, marker = (
        grid.ravel() for grid in np.indices((frames, runs, markers), dtype=np.int64)
    )
    own = rng.normal(0.0, repeating_px, (frames, 1, markers, 2))
    common = np.broadcast_to(own, (frames, runs, markers, 2)).reshape(-1, 2)
    error_px = BIAS_PX + rng.normal(size=(len(frame), 2)) * SIGMA_PX + common
    return CentroidErrors(error_px, np.linspace(6.7, 1.8, frames)[frame], frame, run, marker)


def test_mean_and_std():
    summary = summarise(drawn(400, 1, 10))
    assert summary.mean == pytest.approx(BIAS_PX, abs=4 * 0.08 / np.sqrt(4000))
    assert summary.std == pytest.approx(SIGMA_PX, rel=FOUR_SIGMA_OF_4000)
    assert summary.temporal_std is None


def test_temporal_noise_leaves_out_what_repeats():
    summary = summarise(drawn(40, 20, 10, repeating_px=0.1))
    assert summary.temporal_std == pytest.approx(SIGMA_PX, rel=FOUR_SIGMA_OF_4000)
    assert summary.std == pytest.approx(np.hypot(SIGMA_PX, 0.1), rel=0.15)  # 400 that repeat: 3.5 %


def test_noise_is_measured_at_the_range():
    """Twice the noise beyond 4 m: far and near each get their own."""
    errors = drawn(400, 1, 10)
    far = errors.range_m > 4.0
    doubled = CentroidErrors(
        np.where(far[:, None], 2.0, 1.0) * (errors.error_px - BIAS_PX) + BIAS_PX,
        errors.range_m,
        errors.frame,
        errors.run,
        errors.marker,
    )
    assert noise_at(2.5, doubled).sigma_px == pytest.approx(SIGMA_PX, rel=0.12)
    assert noise_at(6.0, doubled).sigma_px == pytest.approx(2.0 * SIGMA_PX, rel=0.12)
    assert noise_at(6.0, doubled).bias_px == pytest.approx(BIAS_PX, abs=0.03)


def test_a_shared_shift_is_bias_not_noise():
    errors = drawn(100, 1, 10)
    shifted = CentroidErrors(
        errors.error_px + 5.0, errors.range_m, errors.frame, errors.run, errors.marker
    )
    assert noise_at(3.0, shifted).sigma_px == pytest.approx(noise_at(3.0, errors).sigma_px)


def test_sparse_frames_are_pooled_with_their_neighbours():
    noise = noise_at(6.7, drawn(8, 1, 10))
    assert noise.count == 60


def test_too_few_errors_have_no_noise():
    nothing = drawn(0, 1, 10)
    assert summarise(nothing).mean is None
    assert temporal_std(nothing) is None
    assert np.isnan(noise_at(3.0, nothing).sigma_px).all()


def test_order_changes_no_bit():
    errors = drawn(30, 2, 10)
    order = np.random.default_rng(1).permutation(len(errors))
    mixed = CentroidErrors(*(getattr(errors, name)[order] for name in vars(errors)))
    assert summarise(errors).std == summarise(mixed).std
    assert noise_at(3.0, errors).sigma_px.tolist() == noise_at(3.0, mixed).sigma_px.tolist()

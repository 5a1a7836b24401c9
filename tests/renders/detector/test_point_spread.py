"""The point spread against what defines it: its second moment, its energy, and a true edge."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import gaussian_filter1d
from scipy.special import ive, ndtr

from models.arrays import Floats
from renders.detector.point_spread import TAIL, blur, discrete_normal, point_spread

MOMENT = 1e-4  # relative; what a tail of 1e-6 may lack of the variance at 3 px, and rounding
ENERGY = 1e-12  # of the light: additions in double precision
SIGMAS_PX = (0.2, 0.25, 0.35, 0.5, 0.7, 1.0, 1.7, 3.0)
PHASES = np.linspace(-0.5, 0.5, 21)  # where within a pixel a point or an edge lies


def second_moment(image: Floats, axis: int, about: float) -> float:
    places = np.arange(image.shape[axis]) - about
    return float(image.sum(axis=1 - axis) @ places**2 / image.sum())


@given(sigma=st.floats(0.02, 6.0))
def test_the_kernel_has_the_variance_asked_for_and_is_a_blur(sigma: float) -> None:
    taps = point_spread(sigma)
    places = np.arange(len(taps)) - len(taps) // 2
    assert taps.sum() == pytest.approx(1.0, abs=ENERGY)
    assert taps @ places**2 == pytest.approx(sigma**2, rel=MOMENT)
    assert (taps > 0.0).all()
    np.testing.assert_allclose(taps, taps[::-1])
    assert (np.diff(taps[: len(taps) // 2 + 1]) > 0.0).all()  # it rises to its middle


@pytest.mark.parametrize("sigma", SIGMAS_PX)
def test_a_point_is_spread_by_sigma_along_rows_and_columns(sigma: float) -> None:
    rate = np.zeros((64, 80), dtype=np.float32)
    rate[30, 41] = 3e4
    image = blur(rate, sigma)
    assert image.sum() == pytest.approx(3e4, rel=ENERGY)
    for axis, about in ((0, 30.0), (1, 41.0)):
        assert second_moment(image, axis, about) == pytest.approx(sigma**2, rel=MOMENT)


@pytest.mark.parametrize("sigma", SIGMAS_PX)
def test_a_spot_that_pixels_share_has_sigma_and_the_pixels_twelfth(sigma: float) -> None:
    """Averaged over where in its pixel a point lies, the pixel's square adds 1/12 px^2 in all."""
    found = []
    for phase in PHASES[:-1] + 0.5 * (PHASES[1] - PHASES[0]):  # middles of equal shares
        rate = np.zeros((64, 64))
        rate[32, 32] = 1.0
        found.append(second_moment(blur(rate, sigma), 1, 32.0 + phase))
    steps = len(PHASES) - 1
    twelfth = (1.0 - steps**-2) / 12.0  # of the middles of so many shares
    assert np.mean(found) == pytest.approx(sigma**2 + twelfth, rel=MOMENT)


@given(
    sigma=st.floats(0.1, 4.0),
    row=st.integers(0, 23),
    column=st.integers(0, 31),
)
def test_nothing_is_gained_or_lost_even_at_the_border(sigma: float, row: int, column: int) -> None:
    rate = np.zeros((24, 32))
    rate[row, column] = 1.0
    image = blur(rate, sigma)
    assert image.sum() == pytest.approx(1.0, abs=ENERGY)
    assert image.min() >= 0.0


@pytest.mark.parametrize("sigma", SIGMAS_PX)
def test_an_even_field_stays_even_up_to_its_border(sigma: float) -> None:
    np.testing.assert_allclose(blur(np.full((40, 50), 7.0, np.float32), sigma), 7.0, rtol=ENERGY)


def test_no_blur_is_a_copy() -> None:
    rate = np.random.default_rng(1).random((8, 9))
    image = blur(rate, 0.0)
    np.testing.assert_array_equal(image, rate)
    assert not np.shares_memory(image, rate)


@pytest.mark.parametrize("sigma", [1.0, 2.0, 3.0])
def test_where_it_is_wide_it_is_the_sampled_gaussian(sigma: float) -> None:
    """Against scipy, cut at six sigma; below that its own second moment is off."""
    signal = np.zeros(101)
    signal[50] = 1.0
    theirs = gaussian_filter1d(signal, sigma, truncate=6.0)
    ours = blur(np.tile(signal, (3, 1)), sigma)[1]
    np.testing.assert_allclose(ours, theirs, atol=TAIL)


def edge_error(taps: Floats, sigma: float) -> float:
    """Return the rms error, summed over an edge, of taps against the edge truly blurred.

    The truth is a half plane blurred by a Gaussian and averaged over each pixel, which has a closed
    form; the edge lies anywhere within its pixel.
    """

    def integral(x: Floats) -> Floats:
        return np.asarray(
            x * ndtr(x / sigma) + sigma * np.exp(-0.5 * (x / sigma) ** 2) / np.sqrt(2 * np.pi)
        )

    pixels = np.arange(-40, 41)
    squares = []
    for phase in PHASES:
        sharp = np.clip(pixels + 0.5 - phase, 0.0, 1.0)
        blurred = np.convolve(sharp, taps, mode="same")[20:-20]
        inner = pixels[20:-20]
        truth = integral(inner + 0.5 - phase) - integral(inner - 0.5 - phase)
        squares.append(((blurred - truth) ** 2).sum())
    return float(np.sqrt(np.mean(squares)))


@pytest.mark.parametrize("sigma", [0.15, 0.25, 0.35, 0.5, 0.7, 1.0, 1.5])
def test_an_edge_is_nearer_the_truth_than_by_either_textbook_kernel(sigma: float) -> None:
    """Than a Gaussian sampled at pixel centres, and than Lindeberg's (1990) of Bessel functions."""
    places = np.arange(-16, 17)
    sampled = np.exp(-0.5 * (places / sigma) ** 2)
    bessel = ive(np.abs(places), sigma**2)
    ours = edge_error(discrete_normal(sigma**2), sigma)
    same = 1.001  # from 0.8 px up it is the sampled Gaussian
    assert ours <= same * edge_error(sampled / sampled.sum(), sigma)
    assert ours < edge_error(bessel / bessel.sum(), sigma)


def test_a_variance_that_is_none_gives_one_tap() -> None:
    assert discrete_normal(0.0).tolist() == [1.0]
    assert point_spread(1e-9).tolist() == [1.0]

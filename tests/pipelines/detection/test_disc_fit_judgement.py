"""What a disc's fit says of itself, from residuals made up so that the answer is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Floats
from models.sensors.camera_chip import Detector
from pipelines.detection import disc_fit
from pipelines.detection.disc_fit import ExpectedBlur, fit_disc, uneven_covariance
from pipelines.detection.disc_model import DiscParameters, EvenDisc, disc_model
from pipelines.detection.disc_window import DiscWindow, cut_window

DETECTOR = Detector()
RADIUS = 6.0
BLUR = ExpectedBlur(psf_sigma_px=0.5, tolerance_px=0.25, start_px=0.5)
DISC = EvenDisc(np.eye(2) / RADIUS**2, RADIUS)
TRUE = DiscParameters(np.array([0.3, -0.2]), 1.02, 0.55, 0.01, 900.0, np.array([3.0, -2.0]), 20.0)
SIZE = (24, 26)


def window(difference: Floats) -> DiscWindow:
    height, width = difference.shape
    return DiscWindow(
        np.arange(-1.0, width + 1)[None] - 0.5 * (width - 1),
        np.arange(-1.0, height + 1)[:, None] - 0.5 * (height - 1),
        np.full(difference.shape, 200.0),
        difference,
        np.ones(difference.shape, dtype=bool),
    )


def accepted(
    seed: int, sigma: float = 1.0, truth: DiscParameters = TRUE
) -> tuple[disc_fit._Accepted, DiscWindow, Floats]:
    """Residuals of the noise that weights tell, times ``sigma``, at the true parameters."""
    rng = np.random.default_rng(seed)
    own = window(np.zeros(SIZE))
    model, design = disc_model(own.x, own.y, DISC.shape_inverse, RADIUS, truth)
    deviation = 10.0 + 0.01 * model
    weight = deviation**-2.0
    weighted = design.reshape(9, -1) * weight.reshape(-1)
    covariance = np.linalg.inv(weighted @ design.reshape(9, -1).T + 1e-9 * np.eye(9))
    residual = sigma * deviation * rng.standard_normal(SIZE)
    influence = covariance[:2] @ weighted
    last = disc_fit._Accepted(truth, np.zeros(9), weight, residual, influence, covariance, 0.0)
    return last, own, covariance


def test_what_is_known_is_an_observation_of_its_sigma() -> None:
    """5 % of size, the lens's blur, 0.1 of crosstalk, ramps: inverse variances on the diagonal."""
    prior = disc_fit._Prior(BLUR, 4.0, DISC)
    np.testing.assert_allclose(prior.weight, [400.0, 16.0, 100.0, 1.0 / 16.0, 1.0 / 16.0])
    np.testing.assert_allclose(prior.residual(TRUE), [-0.02, -0.05, -0.01, -3.0, 2.0])
    cost = 400.0 * 0.02**2 + 16.0 * 0.05**2 + 100.0 * 0.01**2 + 13.0 / 16.0
    assert prior.cost(TRUE) == pytest.approx(cost)
    normal, right = np.zeros((9, 9)), np.zeros(9)
    prior.add_to(normal, right, TRUE)
    np.testing.assert_allclose(np.diag(normal), [0, 0, 400.0, 16.0, 100.0, 0, 1 / 16, 1 / 16, 0])
    assert np.count_nonzero(normal) == 5
    np.testing.assert_allclose(right, [0, 0, -8.0, -0.8, -1.0, 0, -3 / 16, 2 / 16, 0])


def test_chi_square_of_noise_as_told_is_one_and_no_misfit() -> None:
    found = [disc_fit._misfit(accepted(seed)[0], np.ones(SIZE, bool)) for seed in range(20)]
    chi2, misfit = np.array(found).T
    freedom = SIZE[0] * SIZE[1] - 9
    # Nine of 624 are not taken off by a fit here.
    assert chi2.mean() == pytest.approx(624 / freedom, abs=4.0 * np.sqrt(2.0 / freedom / 20))
    assert chi2.std() == pytest.approx(np.sqrt(2.0 / freedom), rel=0.5)
    assert (misfit == 0.0).all()


def test_what_noise_does_not_explain_is_a_misfit_over_the_height() -> None:
    """Twice the noise told: of its square a quarter is noise, three quarters are misfit."""
    last, _, _ = accepted(1, sigma=2.0)
    usable = np.ones(SIZE, bool)
    usable[:4] = False
    chi2, misfit = disc_fit._misfit(last, usable)
    left = last.residual[usable]
    assert chi2 == pytest.approx((last.weight[usable] * left**2).sum() / (usable.sum() - 9))
    expected = np.sqrt((left**2).mean() * (1.0 - 1.0 / chi2)) / 900.0
    assert misfit == pytest.approx(expected)
    assert chi2 == pytest.approx(4.0, rel=0.15)


def test_a_misfit_counts_from_four_sigmas_of_chi_square() -> None:
    last, _, _ = accepted(2)
    usable = np.ones(SIZE, bool)
    freedom = SIZE[0] * SIZE[1] - 9
    chi2, _ = disc_fit._misfit(last, usable)
    limit = 1.0 + 4.0 * np.sqrt(2.0 / freedom)
    for beyond, told in ((0.998, False), (1.002, True)):
        scaled = replace(last, residual=last.residual * np.sqrt(beyond * limit / chi2))
        assert (disc_fit._misfit(scaled, usable)[1] > 0.0) == told


def test_a_cut_pulls_and_an_edge_without_blur_bends() -> None:
    """2.8 px and 18 px^3 / r^2 a misfit of one, beyond 0.2 %; 0.02 px^3 / r^2 at no softness."""
    sharp = replace(TRUE, blur_px=0.0, crosstalk=0.0)
    for misfit, parameters, expected in (
        (0.0, replace(TRUE, blur_px=0.4), 0.0),
        (0.002, replace(TRUE, blur_px=0.4), 0.0),
        (0.05, replace(TRUE, blur_px=0.4), np.sqrt(0.05**2 - 0.002**2) * (2.8 + 18.0 / 36.0)),
        (0.0, sharp, 0.02 / 36.0),
        (0.0, replace(sharp, blur_px=0.175), 0.01 / 36.0),
        (0.0, replace(sharp, crosstalk=0.5 * 0.175**2), 0.01 / 36.0),
    ):
        found = disc_fit._pull_px2(parameters, misfit, RADIUS)
        np.testing.assert_allclose(found, expected**2 * np.eye(2), rtol=1e-9, atol=1e-15)


def test_misfits_alike_on_opposite_sides_do_not_move_the_centre() -> None:
    """An even residual about the centre, however large, against an odd one of the same size."""
    level = replace(TRUE, centre_px=np.zeros(2), ramp_dn_px=np.zeros(2))
    last, own, _ = accepted(3, sigma=0.0, truth=level)
    ring = np.abs(np.hypot(own.x[:, 1:-1], own.y[1:-1]) - RADIUS) < 1.0
    even = uneven_covariance(replace(last, residual=400.0 * ring), own)
    odd = uneven_covariance(replace(last, residual=400.0 * ring * np.sign(own.x[:, 1:-1])), own)
    assert odd[0, 0] > 1e4 * even[0, 0]


def test_sectors_scatter_is_the_sandwich_by_hand() -> None:
    """Sectors of 22.5 deg with their opposites; more of a cut is hidden, the more it shows."""
    last, own, _ = accepted(4, sigma=6.0)
    turn = np.arctan2(
        own.y[1:-1] - TRUE.centre_px[1] + 0.0 * own.x[:, 1:-1],
        own.x[:, 1:-1] - TRUE.centre_px[0] + 0.0 * own.y[1:-1],
    )
    sector = (np.floor((turn % np.pi) / (np.pi / 8)).astype(int) % 8).reshape(-1)
    pulls = np.zeros((8, 2))
    foreseen = np.zeros((8, 2))
    for k in range(sector.size):
        own_pull = last.influence[:, k] * last.residual.reshape(-1)[k]
        pulls[sector[k]] += own_pull
        foreseen[sector[k]] += last.influence[:, k] ** 2 / last.weight.reshape(-1)[k]
    excess = (pulls**2).sum() / foreseen.sum()
    assert excess > 1.0 + 4.0 / np.sqrt(8)
    hidden = 1.0 + 8.0 / (1.0 + (20.0 / excess) ** 2)
    expected = hidden * 8.0 / 7.0 * pulls.T @ pulls
    np.testing.assert_allclose(uneven_covariance(last, own), expected, rtol=1e-9)


def test_sectors_of_noise_as_told_add_nothing() -> None:
    silent = [uneven_covariance(*accepted(seed)[:2]) for seed in range(10)]
    assert np.mean([(each == 0.0).all() for each in silent]) >= 0.8
    last, own, _ = accepted(5)
    unweighted = replace(last, weight=np.where(own.x[:, 1:-1] < 0.0, last.weight, 0.0))
    assert np.isfinite(uneven_covariance(unweighted, own)).all()


def test_a_drawn_disc_comes_back_with_all_that_shaped_it() -> None:
    """Without noise, and from a window that is cut two pixels off: nine parameters."""
    own = window(np.zeros(SIZE))
    model, _ = disc_model(own.x, own.y, DISC.shape_inverse, RADIUS, TRUE)
    found = disc_fit.fit_appearance(replace(own, difference=model), DISC, DETECTOR, BLUR)
    assert found is not None
    np.testing.assert_allclose(found.parameters.centre_px, TRUE.centre_px, atol=2e-3)
    assert found.parameters.size == pytest.approx(1.02, abs=5e-3)
    assert found.parameters.height_dn == pytest.approx(900.0, rel=0.01)
    assert found.parameters.background_dn == pytest.approx(20.0, abs=1.0)
    assert found.shape_misfit == 0.0
    design = disc_model(own.x, own.y, DISC.shape_inverse, RADIUS, found.parameters)[1]
    variance = own.variance(model, found.parameters.background_dn, DETECTOR)
    flat = design.reshape(9, -1)
    normal = flat / variance.reshape(-1) @ flat.T
    disc_fit._Prior(BLUR, 0.03 * 900.0 / RADIUS, DISC).add_to(normal, np.zeros(9), TRUE)
    covariance = np.linalg.inv(normal)
    # It has its weights from one step before, and its ramp's tolerance from where it began.
    np.testing.assert_allclose(np.diag(found.covariance_px2), np.diag(covariance)[:2], rtol=0.02)
    assert found.height_sigma_dn == pytest.approx(np.sqrt(covariance[5, 5]), rel=0.02)
    assert found.misfit_chi2 < 1e-3
    far = replace(own, x=own.x + 2.0, difference=model)
    shifted = disc_fit.fit_appearance(far, DISC, DETECTOR, BLUR)
    assert shifted is not None
    np.testing.assert_allclose(
        shifted.parameters.centre_px, TRUE.centre_px + np.array([2.0, 0.0]), atol=0.01
    )


def test_the_start_is_the_medians_of_disc_and_surround() -> None:
    own = window(np.zeros(SIZE))
    inside = np.hypot(own.x[:, 1:-1], own.y[1:-1]) < RADIUS
    drawn = np.where(inside, 700.0, 30.0)
    drawn[0, 0] = 1e5
    begun = disc_fit._start(replace(own, difference=drawn), DISC, BLUR)
    assert (begun.height_dn, begun.background_dn) == (670.0, 30.0)
    assert (begun.size, begun.blur_px, begun.crosstalk) == (1.0, 0.5, 0.0)
    np.testing.assert_array_equal(begun.linear, [670.0, 0.0, 0.0, 30.0])
    np.testing.assert_array_equal(begun.centre_px, 0.0)
    nothing = replace(own, difference=drawn, usable=inside & False)
    assert disc_fit._start(nothing, DISC, BLUR).height_dn == 1.0
    assert disc_fit.fit_appearance(nothing, DISC, DETECTOR, BLUR) is None


def test_a_window_reaches_three_pixels_beyond_the_disc_and_no_further_than_the_image() -> None:
    before, after = (np.full((60, 80), level, np.uint16) for level in (200, 260))
    before[20, 30] = 4095
    after[22, 33] = 4095
    cut = cut_window(before, after, np.array([31.4, 21.6]), np.array([5.2, 3.1]), 4000.0)
    assert cut is not None
    columns, rows = cut.x[0, 1:-1] + 31.4, cut.y[1:-1, 0] + 21.6
    np.testing.assert_allclose(columns, np.arange(23, 41))  # 31.4 -+ 8.2
    np.testing.assert_allclose(rows, np.arange(15, 29))  # 21.6 -+ 6.1
    assert cut.difference[0, 0] == 60.0
    dark = {(int(rows[i]), int(columns[j])) for i, j in np.argwhere(~cut.usable)}
    assert dark == {(22, 33)} | {(20 + i, 30 + j) for i in (-1, 0, 1) for j in (-1, 0, 1)}
    corner = cut_window(before, after, np.array([-4.0, 1.0]), np.array([5.2, 3.1]), 4000.0)
    assert corner is not None
    assert (corner.x[0, 1] - 4.0, corner.y[1, 0] + 1.0) == (0.0, 0.0)
    narrow = cut_window(before, after, np.array([-7.0, 20.0]), np.array([5.2, 3.1]), 4000.0)
    assert narrow is not None
    assert narrow.difference.shape[1] == 3
    assert cut_window(before, after, np.array([-7.3, 20.0]), np.array([5.2, 3.1]), 4000.0) is None
    assert cut_window(before, after, np.array([20.0, 67.0]), np.array([5.2, 3.1]), 4000.0) is None


def test_the_differences_variance_is_both_images_and_the_pixels_response() -> None:
    own = window(np.full(SIZE, 50.0))
    model = np.full(SIZE, 400.0)
    found = own.variance(model, 100.0, DETECTOR)
    before, after = DETECTOR.noise_dn(np.array([200.0, 600.0])) ** 2
    np.testing.assert_allclose(found, before + after + (DETECTOR.prnu * 300.0) ** 2)
    below = own.variance(np.full(SIZE, -50.0), 100.0, DETECTOR)
    np.testing.assert_allclose(below, 2.0 * before)


def test_a_disc_darker_than_its_surround_is_none() -> None:
    own = window(np.zeros(SIZE))
    model, _ = disc_model(own.x, own.y, DISC.shape_inverse, RADIUS, TRUE)
    flat = np.full((40, 40), 500, np.uint16)
    assert disc_fit.fit_appearance(replace(own, difference=-model), DISC, DETECTOR, BLUR) is None
    outside = np.array([-30.0, 10.0])
    assert fit_disc(flat, flat, outside, 36.0 * np.eye(2), DETECTOR, 4000.0, BLUR) is None


def test_a_ramp_is_known_to_three_percent_over_a_radius_before_it_is_seen() -> None:
    """In noise of 200 DN a ramp of 10 % over the radius is mostly taken for noise."""
    own = window(np.zeros(SIZE))
    ramp = np.array([0.1 * 900.0 / RADIUS, 0.0])
    steep = replace(TRUE, centre_px=np.zeros(2), ramp_dn_px=ramp)
    model, _ = disc_model(own.x, own.y, DISC.shape_inverse, RADIUS, steep)
    seen = replace(own, difference=model)
    for read_noise_e, low, high in ((26.0, 0.9, 1.05), (26.0 * 140.0, 0.1, 0.6)):
        detector = replace(DETECTOR, read_noise_e=read_noise_e)
        found = disc_fit.fit_appearance(seen, DISC, detector, BLUR)
        assert found is not None
        assert low < found.parameters.ramp_dn_px[0] / ramp[0] < high

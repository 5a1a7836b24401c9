"""The judge of images, judged: quiet when nothing is wrong, and loud for each planted fault.

The frame is a lit disc in a dark that itself spans two decades, as space frames are: eight seeds
of 64 samples a pixel, each sample as noisy as 0.8 of its mean.
"""

import numpy as np
import pytest
from scipy import stats

from models.arrays import Floats
from tests.support.image_statistics import Mean, SameImage, difference, same_image, sidak

SIZE, SEEDS, SAMPLES = 64, 8, 64
TRIALS = 150
LIT = 0.2
DARK_BLOCK = np.s_[0:8, 0:8]


def disc(shift_px: float = 0.0) -> Floats:
    """Return the noise-free frame: a disc with an antialiased rim, and a faint gradient."""
    v, u = np.mgrid[0:SIZE, 0:SIZE].astype(np.float64)
    rim = np.clip(20.0 - np.hypot(u - 31.3 - shift_px, v - 30.8) + 0.5, 0.0, 1.0)
    dark = 10.0 ** np.linspace(-6.0, -4.0, SIZE)[None, :] * np.ones((SIZE, 1))
    return np.asarray(LIT * rim + dark * (1.0 - rim))


def renderings(truth: Floats, rng: np.random.Generator, seeds: int = SEEDS) -> Floats:
    noise = 0.8 / np.sqrt(SAMPLES) * rng.standard_normal((seeds, *truth.shape))
    return np.asarray(truth * (1.0 + noise))


def verdicts(truth: Floats, trials: int, seed: int) -> list[SameImage]:
    rng = np.random.default_rng(seed)
    return [same_image(renderings(disc(), rng), renderings(truth, rng)) for _ in range(trials)]


def at_most(chance: float, trials: int) -> int:
    """Return how many alarms a right test may raise: one suite in a thousand sees more."""
    return int(stats.binom.ppf(0.999, trials, chance))


def test_false_alarms_are_as_rare_as_it_says() -> None:
    """It would have caught a statistic that divides by a variance, or by sqrt(n) twice."""
    found = verdicts(disc(), TRIALS, seed=1)
    assert sum(not verdict.pixels for verdict in found) <= at_most(0.01, TRIALS)
    assert sum(not verdict.blocks for verdict in found) <= at_most(0.01, TRIALS)
    assert sum(not verdict.whole for verdict in found) <= at_most(1e-4, TRIALS)


@pytest.mark.parametrize(("few", "many"), [(2, 2), (4, 4), (4, 16), (8, 8)])
@pytest.mark.parametrize("ratio", [1.0, 5.0, 50.0])
def test_pixels_are_never_called_odd_too_often(few: int, many: int, ratio: float) -> None:
    """However few the seeds and however unlike the noise of the two sides."""
    rng = np.random.default_rng(2)
    first = Mean.of_pixels(rng.standard_normal((few, 100, 200)), 0.0)
    second = Mean.of_pixels(ratio * rng.standard_normal((many, 100, 200)), 0.0)
    p, _ = difference(first, second)
    for bound in (0.5, 0.05, 0.005, 0.0005):
        assert (p < bound).sum() <= stats.binom.ppf(0.9999, p.size, bound)


def test_scores_are_standard_where_the_variance_is_well_known() -> None:
    rng = np.random.default_rng(3)
    p, z = difference(
        Mean.of_pixels(rng.standard_normal((64, 80, 80)), 0.0).blocks(8, 8),
        Mean.of_pixels(3.0 * rng.standard_normal((64, 80, 80)), 0.0).blocks(8, 8),
    )
    assert stats.kstest(z.ravel(), "norm").pvalue > 1e-3
    np.testing.assert_allclose(2.0 * stats.norm.sf(np.abs(z)), p, rtol=1e-9)


@pytest.mark.parametrize(
    ("fault", "seen_by"),
    [
        ("gain of 1 %", "whole"),
        ("shift of 0.1 px", "pixels"),
        ("shift of 0.1 px", "blocks"),
        ("one dark block doubled", "blocks"),
        ("dark side black", "blocks"),
    ],
)
def test_planted_faults_are_seen(fault: str, seen_by: str) -> None:
    truth = {
        "gain of 1 %": 1.01 * disc(),
        "shift of 0.1 px": disc(shift_px=0.1),
        "one dark block doubled": disc(),
        "dark side black": disc() * (disc() > 0.5 * LIT),
    }[fault]
    if fault == "one dark block doubled":
        truth[DARK_BLOCK[0], SIZE - 8 : SIZE] *= 2.0
    found = verdicts(truth, 30, seed=3)
    assert sum(not getattr(verdict, seen_by) for verdict in found) >= 29
    assert sum(bool(verdict) for verdict in found) <= 1


def test_each_verdict_earns_its_place() -> None:
    """No verdict sees what another does: a gain hides in pixels, a dark block in the mean."""
    gain, block = disc() * 1.01, disc()
    block[DARK_BLOCK[0], SIZE - 8 : SIZE] *= 2.0
    gained, doubled = verdicts(gain, 30, seed=4), verdicts(block, 40, seed=5)
    assert sum(not verdict.pixels for verdict in gained) <= at_most(0.01, 30)
    assert sum(not verdict.whole for verdict in doubled) <= at_most(1e-3, 30)


def test_the_floor_is_relative_to_the_frame() -> None:
    """The same frame in other units gets the same verdict, and darkness below the floor none."""
    rng = np.random.default_rng(6)
    first, second = renderings(disc(), rng), renderings(1.01 * disc(), rng)
    bright, dim = same_image(first, second), same_image(1e-6 * first, 1e-6 * second)
    np.testing.assert_allclose(dim.block_z, bright.block_z, atol=1e-6)
    almost_black = renderings(disc(), rng)
    almost_black[:, DARK_BLOCK[0], DARK_BLOCK[1]] += 1e-6 * LIT
    assert same_image(first, almost_black)


def test_heavy_tails_need_the_allowance_and_get_no_more() -> None:
    """Fireflies on one side in 1 % of the pixels pass with 2 % allowed, not with none."""
    rng = np.random.default_rng(7)
    first, second = renderings(disc(), rng), renderings(disc(), rng)
    row, column = rng.integers(0, SIZE, (2, 41))
    second[:, row, column] += LIT
    strict, lenient = same_image(first, second), same_image(first, second, allowed=0.02)
    assert not strict.pixels
    assert lenient.pixels
    assert 0.005 < strict.odd_pixels < 0.015


def test_identical_and_black_stacks_are_the_same() -> None:
    stack = renderings(disc(), np.random.default_rng(8))
    assert same_image(stack, stack)
    assert same_image(0.0 * stack, 0.0 * stack)
    assert not same_image(0.0 * stack, 0.0 * stack + 1.0)


def test_it_says_where_it_differs() -> None:
    truth = disc()
    truth[16:24, 40:48] *= 1.5
    (verdict,) = verdicts(truth, 1, seed=9)
    assert "blocks DIFFER: the worst at row 16, column 40 px" in str(verdict)
    assert "pixels" in str(verdict)


def test_shapes_that_do_not_fit_are_refused() -> None:
    stack = np.zeros((3, 16, 16))
    with pytest.raises(ValueError, match="two stacks of two images or more"):
        same_image(stack, stack[:1])
    with pytest.raises(ValueError, match="of one size"):
        same_image(stack, np.zeros((3, 16, 24)))
    with pytest.raises(ValueError, match="divisible by 8, got 12 x 16"):
        same_image(np.zeros((2, 16, 12)), np.zeros((2, 16, 12)))


def test_sidak_keeps_the_familywise_chance() -> None:
    assert 1.0 - (1.0 - sidak(0.01, 4096)) ** 4096 == pytest.approx(0.01)
    assert sidak(0.01, 1) == pytest.approx(0.01)

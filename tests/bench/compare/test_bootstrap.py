"""The intervals cover what they say: the statistics are tested for false alarms and misses."""

import numpy as np
import pytest

from bench.compare.bootstrap import FEWEST_BLOCKS, Resampling, interval, mean, median, resampled
from bench.compare.leaderboard import leaderboard

TRIALS, FRAMES = 300, 60
FEWEST, MOST = 0.88, 0.99  # of 95 %: three sigma of 300 trials, and few frames cost some cover


def covered(draw, how: Resampling, truth: float) -> float:
    """Return how often the interval of a mean holds the true one."""
    inside = 0
    for trial in range(TRIALS):
        low, high = interval(resampled(draw(np.random.default_rng(trial)), mean, how))
        inside += low <= truth <= high
    return inside / TRIALS


def test_independent_frames_are_covered():
    def draw(rng):
        return rng.exponential(1.0, FRAMES)

    assert FEWEST <= covered(draw, Resampling(resamples=400), 1.0) <= MOST


def test_errors_that_last_are_covered_by_blocks_and_not_without():
    """An autoregression of 0.7: a view lasts for a few frames."""

    def draw(rng):
        noise = rng.normal(size=FRAMES + 50)
        lasting = np.zeros_like(noise)
        for place in range(1, len(noise)):
            lasting[place] = 0.7 * lasting[place - 1] + noise[place]
        return lasting[50:]

    alone = covered(draw, Resampling(resamples=400, block_frames=1), 0.0)
    blocks = covered(draw, Resampling(resamples=400, block_frames=10), 0.0)
    assert alone < 0.75
    assert blocks > alone + 0.1


def test_the_same_seed_gives_the_same_interval_and_another_another():
    values = np.random.default_rng(0).normal(size=40)
    one, again, other = (
        interval(resampled(values, mean, Resampling(seed=seed))) for seed in (1, 1, 2)
    )
    assert one == again != other


def test_methods_are_drawn_alike_so_that_differences_are_paired():
    """A constant difference has no width, whatever the frames do."""
    values = np.random.default_rng(0).normal(size=40)
    how = Resampling()
    apart = resampled(values + 0.5, mean, how) - resampled(values, mean, how)
    assert interval(apart) == pytest.approx((0.5, 0.5), abs=1e-12)


def test_a_median_of_lost_frames_is_infinite_beyond_half():
    half, more = np.array([[1.0, 2.0, np.inf, np.inf]]), np.array([[1.0, np.inf, np.inf]])
    assert median(half)[0] == 2.0
    whole = np.random.default_rng(0).normal(size=(3, 8))
    assert median(whole) == pytest.approx(np.median(whole, axis=1))
    assert median(more)[0] == np.inf
    low, high = interval(resampled(more[0], median, Resampling()))
    assert (low, high) == (1.0, np.inf)


def test_large_datasets_are_drawn_a_part_at_a_time(monkeypatch):
    import bench.compare.bootstrap as module

    values = np.random.default_rng(0).normal(size=50)
    whole = resampled(values, mean, Resampling(resamples=100))
    monkeypatch.setattr(module, "MOST_AT_ONCE", 500)
    parts = resampled(values, mean, Resampling(resamples=100))
    assert len(parts) == len(whole) == 100
    assert parts.mean() == pytest.approx(whole.mean(), abs=0.1)


def told_apart(frames: int, block_frames: int, rng) -> bool:
    """Return whether one method is told from another whose errors are drawn alike."""
    values = {name: {"speed": rng.normal(size=frames)} for name in ("one", "other")}
    how = Resampling(resamples=200, block_frames=block_frames)
    return leaderboard(values, "speed", [], how).pairs[0].told_apart


@pytest.mark.parametrize("block_frames", [1, 4])
def test_few_blocks_tell_no_two_apart_and_as_many_as_decide_seldom_do_by_chance(block_frames):
    """A sign test of n blocks calls alike methods different in 2 of 2^n: under 5 % from six on."""
    rng = np.random.default_rng(3)
    few = (FEWEST_BLOCKS - 1) * block_frames
    assert 2.0 / 2 ** (FEWEST_BLOCKS - 1) > 0.05 > 2.0 / 2**FEWEST_BLOCKS
    assert not any(told_apart(few, block_frames, rng) for _ in range(100))
    how = Resampling(resamples=200, block_frames=block_frames)
    values = {"one": {"speed": np.zeros(few + block_frames)}}
    values["other"] = {"speed": np.ones(few + block_frames)}
    assert leaderboard(values, "speed", [], how).pairs[0].told_apart


def test_why_two_methods_are_not_told_apart_is_said():
    rng = np.random.default_rng(5)
    for frames, said in ((5, "no: 2 blocks, 6 needed"), (40, "no: the interval holds 0")):
        draws = {name: {"speed": rng.uniform(1.0, 2.0, frames)} for name in ("one", "other")}
        assert leaderboard(draws, "speed", [], Resampling()).pairs[0].verdict == said
    far = {"near": {"speed": rng.uniform(1, 2, 40)}, "far": {"speed": rng.uniform(8, 9, 40)}}
    assert leaderboard(far, "speed", [], Resampling()).pairs[0].verdict == "yes"

"""Noise measures: one over samples, blind to a few fireflies, and what equal noise costs."""

from __future__ import annotations

import numpy as np
import pytest

from bench.cycles.jobs import Effort
from bench.cycles.noise import Cost, cost_of, relative_mse, whole_frame_mse

SIZE = 400
CHANCE = 0.03  # five sigma of a variance from 160 000 pixels, trimming included


def scene():
    rows, columns = np.mgrid[:SIZE, :SIZE] / SIZE
    return (0.1 + 5.0 * columns * rows).astype(np.float32)


def render(samples, seed):
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal((SIZE, SIZE)) / np.sqrt(samples)
    return (scene() * (1.0 + 0.4 * noise)).astype(np.float32)


@pytest.mark.parametrize("measure", [relative_mse, whole_frame_mse])
def test_error_falls_as_one_over_samples(measure):
    few, many = measure(render(4, 1), scene()), measure(render(64, 2), scene())
    assert few / many == pytest.approx(16.0, rel=CHANCE)


def test_the_size_of_the_error_is_that_of_the_noise():
    trimmed = 0.4**2 / 16 * (1.0 - 0.0121)  # the upper 0.1 % of chi squared hold 1.2 % of it
    assert relative_mse(render(16, 3), scene()) == pytest.approx(trimmed, rel=CHANCE)


@pytest.mark.parametrize("measure", [relative_mse, whole_frame_mse])
def test_a_few_fireflies_decide_nothing(measure):
    clean = render(16, 4)
    spoilt = clean.copy()
    spoilt.reshape(-1)[np.random.default_rng(0).choice(SIZE**2, 100, replace=False)] = 1e4
    assert measure(spoilt, scene()) == pytest.approx(measure(clean, scene()), rel=0.02)


def test_a_black_reference_has_a_finite_error():
    dark = np.zeros((SIZE, SIZE), dtype=np.float32)
    dark[0, 0] = 1.0
    assert np.isfinite(relative_mse(dark, dark))


def test_only_light_grows_with_the_samples():
    cost = Cost(6.0, 2.0, light_processor_s=9.0, rest_processor_s=1.0, peak_mib=100.0)
    assert cost.whole_s == 8.0
    assert cost.at_noise(own=3.0, wanted=1.0) == 20.0
    assert cost.at_noise(own=1.0, wanted=1.0) == cost.whole_s
    assert cost.processor_at_noise(own=3.0, wanted=1.0) == 28.0
    assert cost.processor_at_noise(own=1.0, wanted=1.0) == cost.processor_s
    assert cost.times(3.0) == Cost(18.0, 2.0, 27.0, 1.0, 100.0)


def test_what_a_process_did_besides_light_counts():
    effort = Effort(10.0, 1.0, 2.0, (3.0, 1.5), 15.0, (6.0, 2.0), 300.0)
    assert cost_of(effort) == Cost(4.5, 5.5, 8.0, 7.0, 300.0)

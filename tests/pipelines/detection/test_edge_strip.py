from __future__ import annotations

import numpy as np
import pytest

from pipelines.detection.edge_strip import EdgePixels, find_strip
from pipelines.detection.pixel_edge import edge_signal

NORMAL = np.array([0.96, 0.28])
NOISE = (4.0, 0.04, 0.005)  # variance of a level: of reading, of charge, of response
BLUR_PX = 0.3
BOARD, BRIGHT = 140.0, 1600.0
SIGMAS = 4.0


def edge_with_strip(width_px: float, strip: float, seed: int) -> EdgePixels:
    """Draw an edge whose largest step is at 0 and whose board ends a strip's width inside it.

    What lies outside differs from section to section by a fifth.
    """
    rng = np.random.default_rng(seed)
    inside, along = rng.uniform(-4.0, 8.0, 500), rng.uniform(-1.0, 1.0, 500)
    section = np.minimum(((along + 1.0) * 5.0).astype(np.int64), 9)
    bright = BRIGHT * rng.uniform(0.8, 1.2, 10)[section]
    board = edge_signal(inside - width_px, NORMAL[0], NORMAL[1], 1e6, BLUR_PX).value
    whole = edge_signal(inside, NORMAL[0], NORMAL[1], 1e6, BLUR_PX).value
    level = BOARD * board + strip * (whole - board) + bright * (1.0 - whole)
    a, b, c = NOISE
    level = level + np.sqrt(a + b * level + (c * level) ** 2) * rng.standard_normal(500)
    return EdgePixels(inside, along, section, NORMAL, level)


@pytest.mark.parametrize("width_px", [1.5, 3.0, 5.0])
def test_the_board_ends_before_its_shadow(width_px: float) -> None:
    for seed in range(5):
        strip = find_strip(edge_with_strip(width_px, 20.0, seed), BLUR_PX, NOISE)
        assert strip is not None
        sigma_px = float(np.sqrt(strip.covariance_px2[0, 0]))
        assert sigma_px < 0.2
        assert abs(strip.offset_px + width_px) < SIGMAS * sigma_px
        assert abs(strip.width_px - width_px) < 0.3


def test_without_a_shadow_there_is_no_strip() -> None:
    for seed in range(10):
        assert find_strip(edge_with_strip(0.0, BOARD, seed), BLUR_PX, NOISE) is None


def test_what_is_brighter_than_the_board_is_no_shadow() -> None:
    assert find_strip(edge_with_strip(3.0, 400.0, 0), BLUR_PX, NOISE) is None


def test_a_few_pixels_tell_nothing() -> None:
    few = edge_with_strip(3.0, 20.0, 0)
    cut = slice(0, 12)
    pixels = EdgePixels(
        few.inside_px[cut], few.along[cut], few.section[cut], few.normal, few.level[cut]
    )
    assert find_strip(pixels, BLUR_PX, NOISE) is None

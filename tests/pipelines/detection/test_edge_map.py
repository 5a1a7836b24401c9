"""Edges of images whose edges are known."""

from __future__ import annotations

import numpy as np
import pytest

from pipelines.detection.edge_map import EdgeMap, find_edges
from pipelines.detection.target_region import find_target

SIZE_PX = 120
BLUR_PX = 0.8
DIRECTION_RAD = np.deg2rad(1.5)  # Scharr's operator is within a degree, noise comes to it
SKY_DN, BRIGHT_DN, NOISE_DN = 100.0, 900.0, 3.0


def half_plane(angle_rad: float) -> EdgeMap:
    """Return the edges of a bright half disc, its gradient along ``angle_rad``, x to y."""
    rng = np.random.default_rng(3)
    y, x = np.mgrid[0:SIZE_PX, 0:SIZE_PX] - 0.5 * SIZE_PX
    distance = x * np.cos(angle_rad) + y * np.sin(angle_rad)
    disc = 1.0 / (1.0 + np.exp((np.hypot(x, y) - 0.4 * SIZE_PX) / BLUR_PX))
    image = SKY_DN + (BRIGHT_DN - SKY_DN) / (1.0 + np.exp(-distance / BLUR_PX)) * disc
    noisy = image + NOISE_DN * rng.standard_normal(image.shape)
    return find_edges(find_target(noisy.round().astype(np.uint16)))


@pytest.mark.parametrize("angle_deg", [0.0, 20.0, 70.0, 90.0, 110.0, 160.0])
def test_the_angle_is_that_of_the_gradient(angle_deg: float) -> None:
    edges = half_plane(np.deg2rad(angle_deg))
    y, x = np.mgrid[0:SIZE_PX, 0:SIZE_PX] - 0.5 * SIZE_PX
    along = x * np.cos(np.deg2rad(angle_deg)) + y * np.sin(np.deg2rad(angle_deg))
    straight = edges.edges & (np.abs(along) < 2.0) & (np.hypot(x, y) < 0.25 * SIZE_PX)
    assert straight.sum() > 0.3 * SIZE_PX
    away = edges.angle_rad[straight] - np.deg2rad(angle_deg)
    away = (away + 0.5 * np.pi) % np.pi - 0.5 * np.pi
    assert abs(float(np.median(away))) < DIRECTION_RAD


def test_it_smooths_both_ways_alike() -> None:
    """An edge along the rows is as soft, and as steep, as one along the columns."""
    across, down = half_plane(0.0), half_plane(0.5 * np.pi)
    steep = [
        float(np.abs(np.diff(edges.smooth, axis=axis)).max())
        for edges, axis in ((across, 1), (down, 0))
    ]
    assert steep[0] == pytest.approx(steep[1], rel=0.1)

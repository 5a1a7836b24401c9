"""A surface as seen along an axis: bright by its slope, the nearer before the farther."""

import numpy as np
import pytest

from bench.report.unknown.surface_figure import DARKEST, shaded, surface_figure

SIDE_M = 2.0
LOW, HIGH = np.full(3, -1.5), np.full(3, 1.5)
SLOPE_DEG = 60.0


def plate(slope_deg: float = 0.0, height_m: float = 0.0, side_m: float = SIDE_M) -> np.ndarray:
    """Return a plate about the z axis, raised along x by a slope."""
    half = side_m / 2.0
    corners = np.array([[-half, -half], [half, -half], [half, half], [-half, half]])
    z = height_m + np.tan(np.deg2rad(slope_deg)) * corners[:, 0]
    return np.column_stack([corners, z])[[[0, 1, 2], [0, 2, 3]]]


def test_a_plate_is_as_bright_as_it_faces_and_covers_its_share():
    for slope_deg in (0.0, SLOPE_DEG):
        image = shaded(plate(slope_deg), (0, 1, 2), LOW, HIGH)
        bright = DARKEST + (1.0 - DARKEST) * np.cos(np.deg2rad(slope_deg))
        middle = image[image.shape[0] // 2, image.shape[1] // 2]
        assert middle == pytest.approx(bright)
        covered = np.mean(image > 0.0) * 9.0
        assert covered == pytest.approx(SIDE_M**2, rel=0.03)  # a cell at its border, 1.25 cm


def test_the_nearer_plate_hides_the_farther_whichever_comes_first():
    near, far = plate(0.0, 0.5, 1.0), plate(SLOPE_DEG, -4.0)
    for both in (np.concatenate([near, far]), np.concatenate([far, near])):
        image = shaded(both, (0, 1, 2), LOW, HIGH)
        assert image[image.shape[0] // 2, image.shape[1] // 2] == pytest.approx(1.0)


def test_the_figure_is_drawn_with_both_named():
    drawn = surface_figure(plate(), plate(SLOPE_DEG))
    assert "carved" in drawn
    assert "true" in drawn

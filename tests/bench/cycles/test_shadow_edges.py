"""Shadow edges: a known shift is found to a few hundredths of a pixel; shading is no edge."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import erf

from bench.cycles.shadow_edges import TOLERANCE_PX, edge_shifts, find_edges

SIZE = 48
FOUND_WITHIN_PX = 0.03  # an oblique edge's profile crosses pixels that are square
SUBPIXELS = 8


def shadow(angle_rad: float, offset_px: float, penumbra_px: float = 0.3):
    """Return a half-plane's shadow, integrated over pixels, with its normal at an angle."""
    steps = (np.arange(SIZE * SUBPIXELS) + 0.5) / SUBPIXELS - 0.5 - SIZE / 2
    x, y = np.meshgrid(steps, steps)
    distance = x * np.cos(angle_rad) + y * np.sin(angle_rad) - offset_px
    fine = 0.1 + 0.45 * (1.0 + erf(distance / penumbra_px))
    return fine.reshape(SIZE, SUBPIXELS, SIZE, SUBPIXELS).mean(axis=(1, 3))


def surroundings(angle_rad: float):
    columns, rows = np.meshgrid(np.arange(SIZE) - SIZE / 2, np.arange(SIZE) - SIZE / 2)
    lit = columns * np.cos(angle_rad) + rows * np.sin(angle_rad) > 0.0
    labels = np.ones((SIZE, SIZE), dtype=np.uint8)
    normals = np.tile([0.0, 0.0, 1.0], (SIZE, SIZE, 1))
    return labels, normals, np.ones((SIZE, SIZE), dtype=bool), lit


@settings(max_examples=40)
@given(st.floats(0.0, 2.0 * np.pi), st.floats(-0.9, 0.9))
def test_a_known_shift_is_found(angle, shift):
    edges = find_edges(*surroundings(angle))
    found = edge_shifts(shadow(angle, shift), shadow(angle, 0.0), edges)
    assert found.edges > SIZE / 3
    assert abs(found.mean_px - shift) < FOUND_WITHIN_PX
    assert abs(found.median_abs_px - abs(shift)) < FOUND_WITHIN_PX
    if abs(abs(shift) - TOLERANCE_PX) > 0.1:
        assert found.agrees is (abs(shift) < TOLERANCE_PX)


def test_brightness_moves_no_edge():
    edges = find_edges(*surroundings(0.4))
    found = edge_shifts(3.0 * shadow(0.4, 0.0), shadow(0.4, 0.0), edges)
    assert found.worst_of_95_percent_px < 1e-9


@pytest.mark.parametrize("what", ["another label", "a crease", "away from the Sun"])
def test_what_is_no_shadow_on_one_smooth_piece_is_left_out(what):
    labels, normals, facing, lit = surroundings(0.0)
    half = np.s_[:, SIZE // 2 + 1 :]
    if what == "another label":
        labels[half] = 2
    elif what == "a crease":
        normals[half] = [np.sin(0.2), 0.0, np.cos(0.2)]
    else:
        facing[:, : SIZE // 2 + 1] = False
    assert len(find_edges(labels, normals, facing, lit).points_px) == 0


def test_no_clear_edge_is_no_agreement():
    edges = find_edges(*surroundings(0.0))
    flat = np.ones((SIZE, SIZE))
    found = edge_shifts(flat, flat, edges)
    assert found.edges == 0
    assert not found.agrees

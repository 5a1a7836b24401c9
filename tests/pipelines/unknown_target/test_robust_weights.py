"""How wide errors are, and what counts of them: against Gaussian draws of a known sigma."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi

from pipelines.unknown_target.robust_weights import MEDIANS, of_most, of_tracks, spread, weights

GATE = 3.0
PRINTED = 5e-5  # half of the last digit


def test_the_median_of_a_length_is_chis() -> None:
    """Of one number the normal's quartile, of two Rayleigh's root of 2 ln 2."""
    for numbers, median in MEDIANS.items():
        assert median == pytest.approx(chi.ppf(0.5, numbers), abs=PRINTED)


@pytest.mark.parametrize("numbers", [1, 2])
@pytest.mark.parametrize("sigma", [0.3, 1.0, 4.0])
def test_errors_are_as_wide_as_they_were_drawn_and_one_sigma_at_least(
    numbers: int, sigma: float
) -> None:
    draws = sigma * np.random.default_rng(4).standard_normal((20_000, numbers))
    sizes = np.append(np.linalg.norm(draws, axis=1), [np.inf, np.inf])
    assert spread(sizes, numbers) == pytest.approx(max(1.0, sigma), rel=0.03)


def test_nothing_to_go_by_is_one_sigma() -> None:
    assert spread(np.array([]), 2) == 1.0
    assert spread(np.array([np.inf]), 2) == 1.0


def test_beyond_the_gate_weights_fall_with_the_fourth_power() -> None:
    found = weights(np.array([0.0, GATE, 2.0 * GATE, np.inf]), GATE)
    np.testing.assert_allclose(found, [1.0, 1.0, 1.0 / 16.0, 0.0])


def test_where_most_are_far_off_none_is_left_out_and_all_count_for_less() -> None:
    """Ten times as wide as told, gates opened to twice: as if sigma had been ten times as large."""
    sizes = np.abs(10.0 * np.random.default_rng(5).standard_normal(2000))
    wide = spread(sizes, 1)
    inside = sizes < GATE * wide
    found = of_most(sizes, 1, GATE, 2.0)
    np.testing.assert_allclose(found[inside], 1.0 / wide**2)
    usual = of_most(0.1 * sizes, 1, GATE, 2.0)
    assert usual[0.1 * sizes < GATE].min() == 1.0


def whole_lives(sliding: bool, count: int, rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """Return errors in sigmas of tracks on a tube of 1 m at 25 m, each held as one fixed point.

    A highlight on a ring lies where the surface halves the angle between Sun and camera; a place
    that is drawn on the ring stays. Forty images, 40 deg of turn, 0.2 px of noise, 550 px of focal
    length; orthographic, and the motion is known.
    """
    frames, sigma_px, px_per_m = 40, 0.2, 550.0 / 25.0
    turns = Rotation.from_rotvec(
        np.deg2rad(np.arange(frames))[:, None] * np.array([0.5, 0.6, 0.62])
    ).as_matrix()
    sun, camera = np.array([0.8, 0.1, -0.6]), np.array([0.0, 0.0, -1.0])
    errors = []
    for _ in range(count):
        height, angle = rng.uniform(-3.0, 3.0), rng.uniform(0.0, 2.0 * np.pi)
        normal = np.tile([np.cos(angle), np.sin(angle), 0.0], (frames, 1))
        if sliding:
            normal = np.einsum("fji,j->fi", turns, sun + camera) * [1.0, 1.0, 0.0]
            normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        places = normal + np.array([0.0, 0.0, height])
        seen = px_per_m * np.einsum("fij,fj->fi", turns, places)[:, :2]
        seen += sigma_px * rng.standard_normal(seen.shape)
        rows = px_per_m * turns[:, :2].reshape(-1, 3)
        fixed, *_ = np.linalg.lstsq(rows, seen.ravel(), rcond=None)
        left = (seen.ravel() - rows @ fixed).reshape(-1, 2)
        errors.append(np.linalg.norm(left, axis=1) / sigma_px)
    return tuple(errors)


def test_a_sliding_highlight_is_told_by_its_whole_life():
    """Of 60 drawn places and 20 highlights each is told: nearly full weight, or next to none."""
    rng = np.random.default_rng(8)
    lives = [*whole_lives(False, 60, rng), *whole_lives(True, 20, rng)]
    who = np.repeat(np.arange(len(lives)), [len(each) for each in lives])
    own = of_tracks(np.concatenate(lives), who, 2.0)
    by_track = np.array([own[who == track].mean() for track in range(len(lives))])
    assert (by_track[:60] > 0.5).mean() > 0.95
    assert (by_track[60:] < 0.1).mean() > 0.95


def test_one_false_sighting_does_not_condemn_a_track():
    sizes = np.full(30, 1.2)
    sizes[4] = np.inf
    assert of_tracks(sizes, np.zeros(30, dtype=np.int64), 2.0).min() > 0.2


def test_without_a_gate_all_tracks_count():
    assert (of_tracks(np.array([0.1, 50.0]), np.array([0, 1]), np.inf) == 1.0).all()

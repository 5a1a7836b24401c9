"""Navigation satellites where their documents have them."""

import numpy as np
import pytest

from models.gnss.constellation import GALILEO_AXIS_M, GPS_AXIS_M, gps_and_galileo

SIDEREAL_DAY_S = 86_164.1


def test_there_are_as_many_as_there_should_be():
    assert len(gps_and_galileo()) == 54
    assert len(gps_and_galileo(True)) == 60
    assert len(set(gps_and_galileo(True).names)) == 60


def test_gps_comes_round_twice_in_a_sidereal_day():
    states = gps_and_galileo().states(np.array([0.0, 0.5 * SIDEREAL_DAY_S]))
    moved = np.linalg.norm(states[1, :30, :3] - states[0, :30, :3], axis=1)
    assert moved.max() < 0.01 * GPS_AXIS_M


def test_galileo_repeats_after_seventeen_turns_in_ten_days():
    states = gps_and_galileo().states(np.array([0.0, 10.0 * SIDEREAL_DAY_S]))
    moved = np.linalg.norm(states[1, 30:, :3] - states[0, 30:, :3], axis=1)
    assert moved.max() < 0.02 * GALILEO_AXIS_M


def test_velocities_are_the_slope_of_the_places():
    states = gps_and_galileo().states(np.array([499.5, 500.0, 500.5]))
    slope = states[2, :, :3] - states[0, :, :3]
    assert slope == pytest.approx(states[1, :, 3:], abs=1e-4)
    assert np.abs(np.sum(states[1, :, :3] * states[1, :, 3:], axis=1)).max() < 1.0  # circles


def test_planes_are_tilted_and_satellites_apart():
    states = gps_and_galileo(True).states(np.zeros(1))[0]
    normals = np.cross(states[:, :3], states[:, 3:])
    tilt_deg = np.rad2deg(np.arccos(normals[:, 2] / np.linalg.norm(normals, axis=1)))
    assert tilt_deg[:30] == pytest.approx(55.0)
    assert tilt_deg[30:] == pytest.approx(56.0)
    apart = np.linalg.norm(states[:, None, :3] - states[None, :, :3], axis=-1)
    assert apart[np.triu_indices(60, 1)].min() > 1e5


def test_planes_of_gps_are_twins_in_pairs():
    """The standard's 24 slots, whose gaps two planes share, and one more midway in the widest."""
    constellation = gps_and_galileo()
    gps = np.array([name.startswith("G") for name in constellation.names])
    node, argument = constellation.node_rad[gps], constellation.argument_rad[gps]
    gaps_deg = []
    for plane in np.unique(node.round(6)):
        slots = np.sort(argument[np.abs(node - plane) < 1e-5] % (2.0 * np.pi))
        gaps_deg.append(np.sort(np.rad2deg(np.diff(slots, append=slots[0] + 2.0 * np.pi))))
    gaps_deg.sort(key=tuple)
    assert len(gaps_deg) == 6
    for one, twin in zip(gaps_deg[::2], gaps_deg[1::2], strict=True):
        np.testing.assert_allclose(one, twin, atol=0.05)
        assert one[0] == pytest.approx(31.0, abs=1.5)
        assert one[1] == pytest.approx(one[2])
        assert one[-1] == pytest.approx(103.0, abs=4.0)


def test_everywhere_on_the_ground_there_are_at_least_five():
    """The promise of the GPS standard: 24 slots, five degrees of elevation."""
    rng = np.random.default_rng(1)
    ups = rng.standard_normal((200, 3))
    ups /= np.linalg.norm(ups, axis=1, keepdims=True)
    gps = gps_and_galileo().states(np.arange(0.0, 43_000.0, 3600.0))[:, :30, :3]
    way = gps[:, None] - 6.371e6 * ups[None, :, None, :]
    sine = np.sum(way * ups[None, :, None, :], axis=-1) / np.linalg.norm(way, axis=-1)
    assert (sine > np.sin(np.deg2rad(5.0))).sum(axis=-1).min() >= 5

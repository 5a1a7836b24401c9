"""A direction survives its 32 bits."""

import numpy as np
import pytest

from tests.support.small_scenes import needs_jit

STEP_DEG = 0.005  # half a step of either coordinate, where the map is widest


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    needs_jit()


def test_directions_come_back_to_half_a_step() -> None:
    import mitsuba as mi

    from renders.tracing.light_paths.packed_direction import packed, unpacked

    rng = np.random.default_rng(1)
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    directions = np.concatenate([axes, rng.normal(size=(20_000, 3))])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    back = np.array(unpacked(packed(mi.Vector3f(*directions.T.astype(np.float32))))).T
    off = np.linalg.norm(np.cross(directions, back), axis=1)
    assert np.rad2deg(off).max() < STEP_DEG
    assert (np.einsum("nd,nd->n", directions, back) > 0.0).all()
    assert np.linalg.norm(back, axis=1) == pytest.approx(1.0, abs=1e-6)

"""Mottling and tiles: faint, of mean nothing, gone where not resolved, none on a chaser."""

from __future__ import annotations

import numpy as np
import pytest

from models.materials import MATERIALS
from models.surface_detail import DETAIL, SurfaceDetail
from renders.tracing.fine_detail import WIDEST_M, shade

NORMAL = (np.zeros(1), np.zeros(1), np.ones(1))


def places(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    x, y, z = np.random.default_rng(4).uniform(-8.0, 8.0, (3, count))
    return x, y, z


@pytest.mark.parametrize("width_m", [1e-3, 0.05])
def test_mottling_has_mean_nothing_and_stays_within_its_share(width_m: float) -> None:
    found = shade(np, places(50_000), NORMAL, np.full(50_000, width_m), 0.05, 0.0) - 1.0
    assert abs(found.mean()) < 2e-4
    assert 0.02 < np.abs(found).max() <= 0.05


def test_nothing_is_left_where_nothing_is_resolved() -> None:
    found = shade(np, places(1000), NORMAL, np.full(1000, WIDEST_M), 0.05, 0.05)
    np.testing.assert_array_equal(found, 1.0)


def test_tiles_differ_by_their_tilt_and_a_flat_plate_does_not() -> None:
    tilt = np.random.default_rng(5).normal(scale=np.deg2rad(0.2), size=(2, 20_000))
    normals = (tilt[0], tilt[1], np.sqrt(1.0 - (tilt**2).sum(axis=0)))
    width = np.full(20_000, 1e-3)
    found = shade(np, places(20_000), normals, width, 0.0, 0.04) - 1.0
    assert abs(found.mean()) < 1e-3
    assert found.std() == pytest.approx(0.04 / 3.0**0.5, rel=0.05)
    for axis in np.eye(3):
        flat = tuple(np.full(1, each) for each in axis)
        assert shade(np, places(1), flat, width[:1], 0.0, 0.04) == pytest.approx(1.0, abs=1e-9)


def test_every_detail_belongs_to_a_material() -> None:
    assert set(DETAIL) <= set(MATERIALS)
    assert all(MATERIALS[name].detail == detail for name, detail in DETAIL.items())


def test_a_detail_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match=r"mottling = 0\.9"):
        SurfaceDetail(mottling=0.9)


def test_what_moves_with_the_chaser_is_plain() -> None:
    """Detail stands still in the target's frame; over what moves in it, it would swim."""
    from models.spacecraft.retroreflector_optics import RetroreflectorOptics
    from renders.tracing.scene import build_geometry
    from tests.support.small_scenes import activate_best, plate

    activate_best()
    geometry = build_geometry(plate("mli_gold"), plate("mli_gold"), RetroreflectorOptics())
    varied = {key: each.detail.is_varied for key, each in geometry.surface_of_shape.items()}
    assert varied == {"target_000": True, "chaser_000": False}

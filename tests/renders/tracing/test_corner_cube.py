"""A cube's face: the light of the effective disc, about its middle, in the shape of an aperture."""

from __future__ import annotations

import numpy as np
import pytest

from models.arrays import Floats
from models.spacecraft.corner_cube import EDGE
from renders.tracing.corner_cube import SOFT, UNRESOLVED, CubeView, aperture_share
from renders.tracing.retroreflector import active_aperture

INDEX = 1.4525
POINTS = 600
TOTAL = 1e-2
"""Of the disc's light: edges are blurred over a curved strip, at 35 degrees and a pixel of a fifth
of the radius by 0.8 %."""


def face(incidence_deg: float, azimuth_deg: float, pixel: float) -> tuple[Floats, ...]:
    """Return x, y and share over the disc, for light that returns to where the viewer is."""
    side = (np.arange(POINTS) + 0.5) / (0.5 * POINTS) - 1.0
    x, y = (each.ravel() for each in np.meshgrid(side, side))
    inside = x * x + y * y < 1.0
    x, y = x[inside], y[inside]
    sine, turn = np.sin(np.deg2rad(incidence_deg)), np.deg2rad(azimuth_deg)
    effective = float(active_aperture(float(np.sqrt(1.0 - sine**2)), INDEX))
    view = CubeView(x, y, np.full(len(x), pixel), 0.0)
    share = aperture_share(np, view, sine * np.cos(turn), sine * np.sin(turn), INDEX, effective)
    return x, y, share, np.array(effective)


@pytest.mark.parametrize("incidence_deg", [0.0, 15.0, 25.0, 35.0])
@pytest.mark.parametrize("azimuth_deg", [0.0, 20.0])
@pytest.mark.parametrize("pixel", [0.03, 0.1, 0.4, 0.8, 4.0])
def test_the_disc_returns_as_much_as_before_from_the_same_middle(
    incidence_deg: float, azimuth_deg: float, pixel: float
) -> None:
    x, y, share, effective = face(incidence_deg, azimuth_deg, pixel)
    assert share.mean() == pytest.approx(float(effective), rel=TOTAL)
    hundredth_of_a_grid_step = 1e-5
    assert abs((x * share).mean()) < hundredth_of_a_grid_step
    assert abs((y * share).mean()) < hundredth_of_a_grid_step


def test_six_lines_are_dark_and_all_else_is_even() -> None:
    x, y, share, _ = face(0.0, 0.0, 1e-3)
    ring = np.abs(np.hypot(x, y) - 0.7) < 0.004
    around = share[ring][np.argsort(np.arctan2(y[ring], x[ring]))]
    dark = around < 0.5 * around.max()
    assert (np.diff(np.concatenate([dark, dark[:1]]).astype(int)) == 1).sum() == 6
    lines = 6.0 * 2.0 * EDGE / (2.0 * np.pi * 0.7)
    assert dark.mean() == pytest.approx(lines, rel=0.3)  # of the grid's few points on a ring
    lit = np.sort(around)[len(around) // 5 :]  # the darker fifth is lines and their borders
    assert np.ptp(lit) < 1e-9


def test_the_aperture_is_where_a_ray_goes_in_and_comes_out() -> None:
    """Followed as a ray: refracted, mirrored by three planes at right angles, refracted again."""
    incidence_deg, azimuth_deg = 20.0, 33.0
    x, y, share, _ = face(incidence_deg, azimuth_deg, 0.03)
    sine, turn = np.sin(np.deg2rad(incidence_deg)), np.deg2rad(azimuth_deg)
    flat = sine / INDEX
    inwards = -np.array([flat * np.cos(turn), flat * np.sin(turn), np.sqrt(1.0 - flat**2)])
    apex = np.array([0.0, 0.0, -np.sqrt(2.0)])  # under a face of radius 1
    seen_at = apex - inwards / inwards[2] * apex[2]  # on the face: the marker's own point
    some = np.random.default_rng(1).choice(len(x), 6000, replace=False)
    some = some[np.hypot(x[some] + seen_at[0], y[some] + seen_at[1]) < 0.999]  # those that go in
    enter = np.stack([x[some], y[some], np.zeros(len(some))], axis=1) + seen_at
    normals = np.array(
        [
            [np.sqrt(2.0 / 3.0) * np.cos(a), np.sqrt(2.0 / 3.0) * np.sin(a), np.sqrt(1.0 / 3.0)]
            for a in np.deg2rad((0.0, 120.0, 240.0))
        ]
    )
    place, along = enter - apex, np.repeat(inwards[None], len(some), axis=0)
    for _ in range(3):
        fall = along @ normals.T
        reach = np.where(fall < -1e-12, -(place @ normals.T) / np.minimum(fall, -1e-12), np.inf)
        reach = np.where(reach > 1e-9, reach, np.inf)
        which = reach.argmin(axis=1)
        place = place + reach[np.arange(len(some)), which, None] * along
        along = along - 2.0 * (along * normals[which]).sum(axis=1)[:, None] * normals[which]
    leave = place + apex
    leave = leave - along / along[:, 2:] * leave[:, 2:]
    open_there = np.hypot(*leave.T[:2]) < 1.0
    lines = 0.08  # of the places are dark as edges, which rays as thin as these do not meet
    assert (open_there == (share[some] > 0.0)).mean() > 1.0 - lines
    assert not (share[some] > 0.0)[~open_there].any()


def test_an_unresolved_cube_is_an_even_disc() -> None:
    _, _, share, effective = face(20.0, 10.0, UNRESOLVED / SOFT)
    np.testing.assert_allclose(share, float(effective))


def test_from_nearby_the_middle_stands_still_too() -> None:
    """Each place sees the viewer in another direction; the aperture is that of the middle's."""
    side = (np.arange(POINTS) + 0.5) / (0.5 * POINTS) - 1.0
    x, y = (each.ravel() for each in np.meshgrid(side, side))
    inside = x * x + y * y < 1.0
    x, y = x[inside], y[inside]
    sine, cosine = np.sin(np.deg2rad(20.0)), np.cos(np.deg2rad(20.0))
    viewer = 1.8 / 0.0127 * np.array([sine, 0.0, cosine])
    off = viewer - np.stack([x, y, np.zeros(len(x))], axis=1)
    distance = np.linalg.norm(off, axis=1)
    half = off / distance[:, None]
    effective = float(active_aperture(cosine, INDEX))
    view = CubeView(x, y, np.full(len(x), 0.07), 1.0 / distance)
    share = aperture_share(np, view, half[:, 0], half[:, 1], INDEX, np.array(effective))
    hundredth_of_a_grid_step = 1e-5  # 4e-4 were the aperture drawn for each place's own distance
    assert abs((x * share).mean()) < hundredth_of_a_grid_step

"""The beginning from images: what is thought of distance and size, and which two are taken."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.camera import Camera
from pipelines.unknown_target import image_start
from pipelines.unknown_target.image_start import ImageStart, Started
from pipelines.unknown_target.tracked_frame import TrackedFrame
from pipelines.unknown_target.two_view_start import BARELY, WELL, Demand, TwoViews

CAMERA = Camera(width=400, height=400, fx=500.0, fy=500.0, cx=200.0, cy=200.0)
MOTION_RAD_S = 1e-3
OMEGA = np.array([0.01, -0.02, 0.005])
TRACKS = np.array([3, 5, 8, 13])
POINTS_PX = np.array([[150.0, 210.0], [250.0, 230.0], [190.0, 260.0], [230.0, 240.0]])
ATTITUDE = Rotation.from_euler("xyz", [10.0, 20.0, -30.0], degrees=True).as_matrix()


def frame(number: int, range_m: float | None = None) -> TrackedFrame:
    return TrackedFrame(
        number, float(number), ATTITUDE, TRACKS, POINTS_PX, np.full(4, 0.3), range_m, 0.02
    )


class Asked:
    """Stands for ``two_views``: what it was asked, and its answer from some number on."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, answers: bool = True) -> None:
        self.asked: list[tuple[int, int, Demand]] = []
        self.answers = answers
        monkeypatch.setattr(image_start, "two_views", self)

    def __call__(
        self, camera: Camera, motion: float, first: TrackedFrame, last: TrackedFrame, demand: Demand
    ) -> TwoViews | None:
        assert (camera, motion) == (CAMERA, MOTION_RAD_S)
        self.asked.append((first.index, last.index, demand))
        return TwoViews(OMEGA, 0.004, np.array([5, 21])) if self.answers else None


def started(
    monkeypatch: pytest.MonkeyPatch,
    ranges_m: list[float | None],
    known_m: tuple[float, float] | None = None,
) -> Started:
    """Begin from eleven images, which two views suffice for."""
    Asked(monkeypatch)
    start = ImageStart(CAMERA, MOTION_RAD_S, known_m)
    for number in range(10):
        assert start.take(frame(number, ranges_m[number])) is None
    found = start.take(frame(10, ranges_m[10]))
    assert found is not None
    assert found.guess.omega_in_target is OMEGA
    assert found.guess.sigma_rad_s == 0.004
    assert found.guess.sigma_m_s == 0.02
    return found


def test_images_are_compared_with_those_ten_to_thirty_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As well as they should be; after sixty images, barely will do. The oldest are let go."""
    views = Asked(monkeypatch, answers=False)
    start = ImageStart(CAMERA, MOTION_RAD_S, None)
    for number in range(100):
        views.asked.clear()
        assert start.take(frame(number)) is None
        befores = [apart for apart in (10, 15, 20, 30) if apart <= number]
        demands = [WELL, BARELY] if number >= 59 else [WELL]
        expected = [(number - apart, number, demand) for demand in demands for apart in befores]
        assert views.asked == expected
        assert len(start) == min(number + 1, 90)


def test_what_was_read_is_the_near_side_and_the_centre_lies_behind(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """100 px of 500 at 10 m are 2 m: half of that is the size, 0.4 of it lie before the centre."""
    found = started(monkeypatch, [None, 9.0, 30.0, 10.0, *[None] * 7])
    depth_m = 10.0 + 0.4
    ray = np.array([(190.0 + 230.0) / 2.0 - 200.0, (230.0 + 240.0) / 2.0 - 200.0, 500.0]) / 500.0
    np.testing.assert_allclose(found.guess.rho_in_lvlh, -ATTITUDE.T @ ray * depth_m, rtol=1e-12)
    assert found.guess.sigma_m == pytest.approx(0.8)
    assert found.guess.size_m == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("known_m", "depth_m", "sigma_m"), [((10.0, 40.0), 25.0, 15.0), (None, 20.0, 10.0)]
)
def test_without_a_range_what_is_known_of_it_counts(
    monkeypatch: pytest.MonkeyPatch,
    known_m: tuple[float, float] | None,
    depth_m: float,
    sigma_m: float,
) -> None:
    found = started(monkeypatch, [None] * 11, known_m)
    in_cam = -ATTITUDE @ found.guess.rho_in_lvlh
    assert in_cam[2] == pytest.approx(depth_m)
    assert found.guess.sigma_m == pytest.approx(sigma_m)
    assert found.guess.size_m == pytest.approx(10.0 * 0.1 * depth_m)


def test_tracks_that_move_otherwise_are_left_out_of_every_image_between(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = started(monkeypatch, [None] * 11)
    assert [each.index for each in found.frames] == list(range(11))
    for each in found.frames:
        assert list(each.tracks) == [3, 8, 13]
        np.testing.assert_array_equal(each.points_px, POINTS_PX[[0, 2, 3]])
        assert len(each.sigma_px) == 3

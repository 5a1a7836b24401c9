"""What the pipeline for an uncooperative target takes of a frame and of what is on board."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.errors import DatasetError
from models.frame import CHASER_ORBIT, IMAGE, POINTS, Frame, TableReading
from models.lights.earth import EARTH_RADIUS_KM
from models.motion.relative_state import CHASER_ORBIT_COLUMNS, ChaserState
from models.motion.tumble import CAM_FROM_LVLH
from pipelines.uncooperative.knowledge import (
    ImageFrame,
    PointFrame,
    UncooperativeKnowledge,
    image_frame,
    points_frame,
    seen,
)
from tests.support.public_halves import IMAGES_ON_BOARD, PAIRS_ON_BOARD

CHASER = ChaserState(0.9, np.array([7.1e6, 1 / 3, -2.0]), np.array([0.1, 7500.0, 1e-17]))
IMAGE_DN = np.arange(24, dtype=np.uint16).reshape(4, 6)
HALF_BY_A_ROUND_LIMB = 5e-3
POINTS_PX = np.array([[1.5, 2.5], [1 / 3, -4.0], [700.0, 7.0]])


def assert_same_chaser(one: ChaserState, other: ChaserState) -> None:
    assert one.time_s == other.time_s
    np.testing.assert_array_equal(one.position_in_inertial, other.position_in_inertial)
    np.testing.assert_array_equal(one.velocity_in_inertial, other.velocity_in_inertial)


def test_an_image_goes_into_a_frame_and_out_again() -> None:
    frame = image_frame(3, 1.0, IMAGE_DN, 4.0, CHASER)
    assert set(frame.readings) == {IMAGE, CHASER_ORBIT}
    assert (frame.image(IMAGE).time_s, frame.image(IMAGE).exposure_ms) == (1.0, 4.0)
    back = seen(frame)
    assert isinstance(back, ImageFrame)
    assert (back.index, back.time_s) == (3, 1.0)
    np.testing.assert_array_equal(back.image, IMAGE_DN)
    assert_same_chaser(back.chaser, CHASER)


@pytest.mark.parametrize("count", [0, 1, 3])
def test_points_go_into_a_frame_and_out_again(count: int) -> None:
    back = seen(points_frame(3, 1.0, POINTS_PX[:count], CHASER))
    assert isinstance(back, PointFrame)
    np.testing.assert_array_equal(back.points_px, POINTS_PX[:count])
    assert_same_chaser(back.chaser, CHASER)


def test_points_come_before_an_image_and_the_last_orbit_counts() -> None:
    frame = points_frame(3, 1.0, POINTS_PX, CHASER)
    later = replace(CHASER, time_s=0.95, position_in_inertial=np.ones(3)).reading()
    both = TableReading(
        CHASER_ORBIT_COLUMNS,
        np.concatenate([CHASER.reading().time_s, later.time_s]),
        np.concatenate([CHASER.reading().rows, later.rows]),
    )
    image = image_frame(3, 1.0, IMAGE_DN, 4.0, CHASER).image(IMAGE)
    back = seen(Frame(3, 1.0, {**frame.readings, IMAGE: image, CHASER_ORBIT: both}))
    assert isinstance(back, PointFrame)
    assert back.chaser.time_s == 0.95
    assert back.chaser.position_in_inertial.tolist() == [1.0, 1.0, 1.0]


NO_ROWS = TableReading(CHASER_ORBIT_COLUMNS, np.zeros(0), np.zeros((0, 6)))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({CHASER_ORBIT: None}, "frame 3: expected a table of the stream 'chaser_orbit'"),
        ({CHASER_ORBIT: NO_ROWS}, "frame 3: expected a row of chaser_orbit, got none"),
        ({IMAGE: None}, "frame 3: expected an image of the stream 'image'"),
        ({POINTS: replace(NO_ROWS, columns=("a",) * 6)}, "expected a column 'u_px'"),
    ],
)
def test_a_frame_that_lacks_something_says_what(changes, said: str) -> None:
    readings = {**image_frame(3, 1.0, IMAGE_DN, 4.0, CHASER).readings, **changes}
    kept = {name: reading for name, reading in readings.items() if reading is not None}
    with pytest.raises(DatasetError, match=said):
        seen(Frame(3, 1.0, kept))


def test_it_takes_what_it_needs_of_what_is_on_board() -> None:
    known = UncooperativeKnowledge.of(IMAGES_ON_BOARD)
    told = IMAGES_ON_BOARD.expectations
    assert told is not None
    assert known.camera is IMAGES_ON_BOARD.camera
    assert known.detector is IMAGES_ON_BOARD.detector
    assert known.target is IMAGES_ON_BOARD.wireframe
    for name in ("cam_from_lvlh", "sigma_px", "range_m", "inertia_kg_m2"):
        assert getattr(known, name) is getattr(told, name)
    assert (known.chaser_sigma_m, known.chaser_sigma_m_s) == (10.0, 0.1)
    for missing, file in (("wireframe", "wireframe"), ("expectations", "knowledge")):
        with pytest.raises(DatasetError, match=rf"expected {file}\.\w+ for the pipeline uncoop"):
            UncooperativeKnowledge.of(replace(IMAGES_ON_BOARD, **{missing: None}))
    with pytest.raises(DatasetError, match="for the pipeline uncooperative"):
        UncooperativeKnowledge.of(PAIRS_ON_BOARD)


def test_the_sun_over_the_chaser_is_at_the_top_of_the_image() -> None:
    """The camera looks along the track, image down is nadir: radially outward is image up."""
    known = UncooperativeKnowledge.of(IMAGES_ON_BOARD)
    chaser = ChaserState(0.0, np.array([4.2e7, 0.0, 0.0]), np.array([0.0, 3.07e3, 0.0]))
    above = replace(known, cam_from_lvlh=CAM_FROM_LVLH, sun_dir_in_inertial=np.array([1.0, 0, 0]))
    ahead = replace(above, sun_dir_in_inertial=np.array([0.0, 1.0, 0.0]))
    for known, expected in ((above, [0.0, -1.0, 0.0]), (ahead, [0.0, 0.0, 1.0])):
        light = known.daylight(chaser, 2.0)
        assert light is not None
        np.testing.assert_allclose(light.sun_in_cam, expected, atol=1e-12)
        assert light.earth_in_cam is None
        assert light.white_dn is None
    assert replace(above, sun_dir_in_inertial=None).daylight(chaser, 2.0) is None


def test_the_earth_below_is_at_the_foot_of_the_image_and_exposure_scales_white() -> None:
    known = UncooperativeKnowledge.of(IMAGES_ON_BOARD)
    chaser = ChaserState(0.0, np.array([4.2e7, 0.0, 0.0]), np.array([0.0, 3.07e3, 0.0]))
    told = replace(
        known,
        cam_from_lvlh=CAM_FROM_LVLH,
        sun_dir_in_inertial=np.array([0.0, 1.0, 0.0]),
        earth_dir_in_inertial=np.array([-1.0, 0.0, 0.0]),
        white_dn_ms=1000.0,
    )
    light = told.daylight(chaser, 2.5)
    assert light is not None
    np.testing.assert_allclose(light.earth_in_cam, [0.0, 1.0, 0.0], atol=1e-12)
    assert light.white_dn == 2500.0
    unknown = told.daylight(chaser, None)
    assert unknown is not None
    assert unknown.white_dn is None


def test_the_earth_shines_from_where_the_orbit_has_it_and_as_near() -> None:
    """A quarter of a turn later it stands a quarter of a turn further, at the foot of the image."""
    known = UncooperativeKnowledge.of(IMAGES_ON_BOARD)
    sun = np.array([0.0, 0.0, 1.0])
    told = replace(known, cam_from_lvlh=CAM_FROM_LVLH, sun_dir_in_inertial=sun, earth_shines=True)
    out, along = np.array([7.0e6, 0.0, 0.0]), np.array([0.0, 7.5e3, 0.0])
    for place, velocity in ((out, along), (np.roll(out, 1), -np.roll(along, 2))):
        light = told.daylight(ChaserState(0.0, place, velocity), 2.5)
        assert light is not None
        np.testing.assert_allclose(light.earth_in_cam, [0.0, 1.0, 0.0], atol=1e-12)
        assert light.orbit_radius_km == 7000.0
    ahead = replace(told, earth_dir_in_inertial=np.array([0.0, 1.0, 0.0]))
    light = ahead.daylight(ChaserState(0.0, out, along), 2.5)
    assert light is not None
    np.testing.assert_allclose(light.earth_in_cam, [0.0, 0.0, 1.0], atol=1e-12)


def test_the_share_of_the_sun_follows_from_the_orbit_where_the_earth_may_hide_it() -> None:
    """Full before the Earth, half where its limb halves the Sun, none behind; by default full."""
    known = UncooperativeKnowledge.of(IMAGES_ON_BOARD)
    sun, radius_m = np.array([1.0, 0.0, 0.0]), 7.0e6
    told = replace(known, sun_dir_in_inertial=sun, white_dn_ms=1000.0, earth_hides_sun=True)
    limb = np.arcsin(EARTH_RADIUS_KM / 7000.0)

    def at(off_rad: float) -> ChaserState:
        """Stand so far off the line behind the Earth."""
        place = radius_m * np.array([-np.cos(off_rad), np.sin(off_rad), 0.0])
        return ChaserState(0.0, place, np.array([0.0, 0.0, 7.5e3]))

    assert told.sunlit_share(at(np.pi)) == 1.0
    assert told.sunlit_share(at(0.5 * limb)) == 0.0
    assert abs(told.sunlit_share(at(limb)) - 0.5) < HALF_BY_A_ROUND_LIMB
    assert told.daylight(at(0.5 * limb), 2.0) is None
    dim = told.daylight(at(limb), 2.0)
    assert dim is not None
    assert dim.sunlit_share == told.sunlit_share(at(limb))
    assert dim.white_dn == 2000.0  # white is of the whole Sun
    for without in (replace(told, earth_hides_sun=False), replace(known, earth_hides_sun=True)):
        assert without.sunlit_share(at(0.5 * limb)) == 1.0

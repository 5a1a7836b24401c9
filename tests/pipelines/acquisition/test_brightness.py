"""What shines by Sun and Earth on told surfaces, and poses that only their materials tell apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.lights.earth import GEO_RADIUS_KM, facing_share
from models.pose import RigidTransform
from models.wireframe.finish import Finish
from models.wireframe.wireframe import Wireframe
from pipelines.acquisition.brightness_search import BrightnessSearch
from pipelines.acquisition.daylight import Daylight, PredictedLight, predicted_light
from pipelines.acquisition.image_part import cut_out
from pipelines.acquisition.surface_cloud import surface_cloud
from tests.support.drawn_targets import CAMERA, DETECTOR, SUNLIT_DN, drawn

SQUARE_M = 4.0
RANGE_M = 12.0
TOWARDS_CAMERA = np.array([0.0, 0.0, -1.0])
CLOUD_SHARE = 0.02  # of what a cell shows: its point is not in its middle, nor the ray parallel
RADIUS_PX = 70.0
FULL_DN = 3700.0
LEAD = 0.05  # of the share: 1.8 of log-likelihood, by the weight it has among candidates


def plate(diffuse: tuple[float, float], mirror: float = 0.0, roughness: float = 0.3) -> Wireframe:
    """Return a square sheet that faces -z with its triangles' normals, one finish a side."""
    half = 0.5 * SQUARE_M
    corners = half * np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    faces = corners[np.array([[0, 2, 1], [0, 3, 2]])]
    both = np.tile(np.array(diffuse), (2, 1))
    of = np.ones((2, 2))
    return Wireframe(
        "plate",
        ("a", "b", "c", "d"),
        corners,
        np.zeros(4, dtype=bool),
        np.array([[0, 1], [1, 2], [2, 3], [3, 0]]),
        faces,
        finish=Finish(both, mirror * of, roughness * of, 0.0 * of),
    )


def predicted(
    wireframe: Wireframe, light: Daylight, rotation: Floats | None = None
) -> PredictedLight:
    pose = RigidTransform(np.eye(3) if rotation is None else rotation, np.array([0, 0, RANGE_M]))
    assert wireframe.finish is not None
    cloud = surface_cloud(wireframe)
    return predicted_light(
        cloud, wireframe.finish.table, CAMERA, pose, light, 4.0, np.array([-0.5, -0.5])
    )


def middle(told: PredictedLight) -> float:
    """Return the median over the cells that are whole."""
    return float(np.median(told.direct[told.covered]))


@pytest.mark.parametrize("tilt_deg", [0.0, 30.0, 60.0])
def test_a_matt_face_shines_by_its_reflectance_and_the_cosine(tilt_deg: float) -> None:
    """Lambert: whatever the camera's place."""
    tilt = np.deg2rad(tilt_deg)
    sun = np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    for reflects in (0.2, 0.8):
        told = predicted(plate((reflects, 0.5)), Daylight(sun))
        assert middle(told) == pytest.approx(reflects * np.cos(tilt), rel=CLOUD_SHARE)


def test_the_side_that_is_seen_has_its_own_finish() -> None:
    sheet = plate((0.7, 0.1))
    turned = np.diag([-1.0, 1.0, -1.0])
    light = Daylight(TOWARDS_CAMERA)
    assert middle(predicted(sheet, light)) == pytest.approx(0.7, rel=CLOUD_SHARE)
    assert middle(predicted(sheet, light, turned)) == pytest.approx(0.1, rel=CLOUD_SHARE)


def test_a_sheet_lit_from_behind_is_dark_but_for_the_earth() -> None:
    behind, earth = -TOWARDS_CAMERA, np.array([0.6, 0.0, -0.8])
    assert middle(predicted(plate((0.7, 0.1)), Daylight(behind))) == 0.0
    told = middle(predicted(plate((0.7, 0.1)), Daylight(behind, earth)))
    assert told == pytest.approx(
        0.7 * 0.8 * facing_share(float(-earth @ behind), GEO_RADIUS_KM), rel=CLOUD_SHARE
    )


def test_an_earth_nearer_by_is_a_brighter_light() -> None:
    behind, earth = -TOWARDS_CAMERA, np.array([0.6, 0.0, -0.8])
    for radius_km in (7000.0, GEO_RADIUS_KM):
        light = Daylight(behind, earth, orbit_radius_km=radius_km)
        share = facing_share(float(-earth @ behind), radius_km)
        seen = middle(predicted(plate((0.7, 0.1)), light))
        assert seen == pytest.approx(0.7 * 0.8 * share, rel=CLOUD_SHARE)


def test_a_mirror_shines_where_it_reflects_the_sun_and_nowhere_else() -> None:
    glossy = plate((0.0, 0.0), mirror=0.8, roughness=0.1)
    glint = middle(predicted(glossy, Daylight(TOWARDS_CAMERA)))
    aside = middle(predicted(glossy, Daylight(np.array([0.8, 0.0, -0.6]))))
    assert glint > 5.0  # far brighter than white
    assert aside < 0.01 * glint


def box(shares: tuple[float, ...]) -> tuple[Wireframe, Floats]:
    """Return a box that half a turn about z carries onto itself, and what its faces reflect."""
    low, high = np.array([-1.0, -0.7, -0.5]), np.array([1.0, 0.7, 0.5])
    corners = np.array([[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)])
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    faces = [f for a, b, c, d in quads for f in ((a, b, c), (a, c, d))]
    reflects = np.repeat(np.array(shares), 2)
    both = np.stack([reflects, reflects], axis=1)
    pairs = [(a, b) for a in range(8) for b in range(a) if (a ^ b).bit_count() == 1]
    finish = Finish(both, 0.0 * both, 0.3 + 0.0 * both, 0.0 * both)
    names = tuple(f"corner_{k}" for k in range(8))
    flags = np.zeros(8, dtype=bool)
    return Wireframe(
        "box", names, corners, flags, np.array(pairs), corners[np.array(faces)], finish=finish
    ), reflects


@pytest.mark.parametrize("run", [0, 1, 2])
def test_twins_are_told_apart_by_what_their_faces_are_made_of(run: int) -> None:
    """A box of which the sides -x and +x are dark and bright: half a turn swaps them."""
    wireframe, reflects = box((0.5, 0.5, 0.3, 0.3, 0.06, 0.8))
    turn = Rotation.from_euler("yxz", [40.0 - 65.0 * run, 20.0, 15.0 * run], degrees=True)
    pose = RigidTransform(turn.as_matrix(), np.array([0.1, -0.1, 8.0]))
    light = Daylight(np.array([0.2, -0.3, -0.93]), white_dn=SUNLIT_DN)
    image = drawn(
        wireframe, pose, sun_in_cam=tuple(light.sun_in_cam), unlit_dn=0.0, reflects=reflects
    )
    cut = cut_out(image, CAMERA, DETECTOR, 1024)
    twin = RigidTransform(pose.rotation @ np.diag([-1.0, -1.0, 1.0]), pose.translation)

    def lead(known: Wireframe) -> float:
        search = BrightnessSearch(cut, FULL_DN, known, surface_cloud(known), light, RADIUS_PX)
        return search.share(pose) - search.share(twin)

    grey = replace(wireframe, finish=Finish.of(np.tile([0.4, 0.0, 0.3, 0.0], (12, 2, 1))))
    assert lead(wireframe) > LEAD
    assert lead(wireframe) > lead(grey) + LEAD


def test_a_pose_that_is_off_is_moved_to_where_the_brightness_is_likelier() -> None:
    wireframe, reflects = box((0.5, 0.5, 0.3, 0.3, 0.06, 0.8))
    turn = Rotation.from_euler("yx", [40.0, 20.0], degrees=True)
    pose = RigidTransform(turn.as_matrix(), np.array([0.1, -0.1, 8.0]))
    light = Daylight(np.array([0.2, -0.3, -0.93]), white_dn=SUNLIT_DN)
    image = drawn(
        wireframe, pose, sun_in_cam=tuple(light.sun_in_cam), unlit_dn=0.0, reflects=reflects
    )
    cut = cut_out(image, CAMERA, DETECTOR, 1024)
    search = BrightnessSearch(cut, FULL_DN, wireframe, surface_cloud(wireframe), light, RADIUS_PX)
    start = pose.perturbed(np.array([0.0, 0.12, 0.0]), np.array([0.0, 0.0, 0.3]))
    found = search.polished(start)
    start_m, found_m = (each.translation[2] - pose.translation[2] for each in (start, found))
    assert abs(found_m) < 0.5 * abs(start_m)
    first, last, true = (search.share(each) for each in (start, found, pose))
    assert true > first + LEAD
    assert last - first > 0.5 * (true - first)


def test_a_finish_that_gives_more_than_it_gets_is_refused() -> None:
    of = np.ones((3, 2))
    with pytest.raises(ValueError, match="no more than 1"):
        Finish(0.7 * of, 0.5 * of, 0.3 * of, 0.0 * of)
    with pytest.raises(ValueError, match="between 0 and 1"):
        Finish(1.2 * of, 0.0 * of, 0.3 * of, 0.0 * of)

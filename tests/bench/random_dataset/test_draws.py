"""What is drawn is spread as it says, by tests that would see if it were not."""

from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import kstest

from bench.random_dataset.draws import (
    BEHIND,
    CUT,
    ECLIPSED,
    INSIDE,
    OUT,
    DrawnPose,
    draw_exposure_ms,
    draw_pose,
    draw_sun,
)
from models.arrays import Floats
from models.camera import Camera
from models.errors import ScenarioError
from models.lights.earth import EARTH_RADIUS_KM, GEO_RADIUS_KM
from tests.support.random_specs import FAR_M, NEAR_M, aim_at_box, spec_of

COUNT = 1200  # poses: enough that each planted fault below is seen
LEAST_P = 1e-3  # one in a thousand right draws would fail; the seed is fixed
CAMERA = Camera.from_fov(64, 64, 40.0)


def drawn(count: int = COUNT, **changed: object) -> list[DrawnPose]:
    spec = spec_of(**changed)
    return [draw_pose(spec, aim_at_box(), CAMERA, n, Counter()) for n in range(count)]


def p_of_log_uniform(ranges_m: Floats) -> float:
    """Return how likely ranges are whose logarithms are uniform (Kolmogorov and Smirnov)."""
    share = np.log(ranges_m / NEAR_M) / np.log(FAR_M / NEAR_M)
    return float(kstest(share, "uniform").pvalue)


def p_of_so3(turns: Floats) -> float:
    """Return how likely (n, 3, 3) rotations are that are uniform on SO(3).

    Each column is then uniform on the sphere, so that its components are uniform from -1 to 1
    (Archimedes); and the angle has the density (1 - cos) / pi.
    """
    angles = Rotation.from_matrix(turns).magnitude()
    parts = [kstest(0.5 * (turns[:, i, j] + 1.0), "uniform").pvalue for i in (0, 2) for j in (0, 2)]
    whole = kstest(angles, lambda x: (x - np.sin(x)) / np.pi).pvalue
    return float(min([*parts, whole]) * (len(parts) + 1))  # Bonferroni


def p_of_phase(cosines: Floats, low_deg: float, high_deg: float) -> float:
    """Return how likely angles are that are uniform between two."""
    angles = np.rad2deg(np.arccos(cosines))
    return float(kstest((angles - low_deg) / (high_deg - low_deg), "uniform").pvalue)


@pytest.fixture(scope="module")
def poses() -> list[DrawnPose]:
    return drawn()


def test_attitudes_are_uniform_on_so3(poses: list[DrawnPose]) -> None:
    assert p_of_so3(np.stack([pose.cam_from_target.rotation for pose in poses])) > LEAST_P


@pytest.mark.parametrize(
    "biased",
    [
        lambda rng, n: Rotation.from_euler("zyx", rng.uniform(-np.pi, np.pi, (n, 3))),
        lambda rng, n: Rotation.from_rotvec(
            rng.uniform(0.0, np.pi, (n, 1)) * unit(rng.standard_normal((n, 3)))
        ),
        lambda rng, n: Rotation.from_euler("z", rng.uniform(-np.pi, np.pi, (n, 1))),
    ],
    ids=["angles", "angle about an axis", "one axis"],
)
def test_the_test_sees_attitudes_that_are_not(
    biased: Callable[[np.random.Generator, int], Rotation],
) -> None:
    assert p_of_so3(biased(np.random.default_rng(1), COUNT).as_matrix()) < LEAST_P


def test_the_test_raises_no_false_alarm() -> None:
    rng = np.random.default_rng(2)
    alarms = [p_of_so3(Rotation.random(COUNT, rng=rng).as_matrix()) < 0.05 for _ in range(60)]
    assert np.mean(alarms) < 0.15  # 0.05 in the mean, at most


def test_ranges_are_log_uniform(poses: list[DrawnPose]) -> None:
    ranges_m = np.array([pose.range_m for pose in poses])
    assert p_of_log_uniform(ranges_m) > LEAST_P
    assert p_of_log_uniform(np.random.default_rng(1).uniform(NEAR_M, FAR_M, COUNT)) < LEAST_P


def test_a_range_is_from_the_camera_to_the_aim(poses: list[DrawnPose]) -> None:
    for pose in poses[:50]:
        lens = pose.cam_from_target.inverse().translation
        way = lens - np.array([1.0, 0.0, 0.0])
        assert np.linalg.norm(way) == pytest.approx(pose.range_m)
        np.testing.assert_allclose(way / pose.range_m, pose.to_camera, atol=1e-12)


def test_the_aim_lies_evenly_over_the_middle_of_the_image(poses: list[DrawnPose]) -> None:
    points = np.stack([pose.cam_from_target @ np.array([1.0, 0.0, 0.0]) for pose in poses])
    shares = (CAMERA.project(points) - 31.5) / 32.0 / 0.5  # off_axis is 0.5 unless typed
    assert np.abs(shares).max() <= 1.0 + 1e-9
    for side in shares.T:
        assert kstest(0.5 * (side + 1.0), "uniform").pvalue > LEAST_P


def test_an_approach_fills_its_cone_evenly_and_rolls_no_further() -> None:
    table = {"attitude": "approach", "axis": [0.0, 1.0, 1.0], "cone_deg": 30.0, "roll_deg": 15.0}
    found = drawn(400, pose={**table, "range_m": [NEAR_M, FAR_M]})
    axis = np.array([0.0, 1.0, 1.0]) / np.sqrt(2.0)
    cosines = np.array([pose.to_camera @ axis for pose in found])
    share = (1.0 - cosines) / (1.0 - np.cos(np.deg2rad(30.0)))
    assert kstest(share, "uniform").pvalue > LEAST_P
    # The image's +x stays near the target's: within roll, cone and the way to the image's edge.
    across = np.array([pose.cam_from_target.rotation[0, 0] for pose in found])
    assert np.rad2deg(np.arccos(across.min())) < 15.0 + 30.0 + 15.0
    free = drawn(400, pose={**table, "roll_deg": 180.0, "range_m": [NEAR_M, FAR_M]})
    assert min(pose.cam_from_target.rotation[0, 0] for pose in free) < -0.9


def test_phase_angles_are_uniform_between_two(poses: list[DrawnPose]) -> None:
    spec = spec_of(sun={"phase_deg": [20.0, 110.0]})
    suns = [draw_sun(spec, pose, n, 0, Counter()) for n, pose in enumerate(poses)]
    cosines = np.array([sun @ pose.to_camera for sun, pose in zip(suns, poses, strict=True)])
    assert p_of_phase(cosines, 20.0, 110.0) > LEAST_P
    by_solid_angle = np.random.default_rng(1).uniform(*np.cos(np.deg2rad([110.0, 20.0])), COUNT)
    assert p_of_phase(by_solid_angle, 20.0, 110.0) < LEAST_P


def test_suns_by_direction_are_uniform_on_the_sphere(poses: list[DrawnPose]) -> None:
    spec = spec_of(sun={"by": "direction"})
    suns = np.stack([draw_sun(spec, pose, n, 0, Counter()) for n, pose in enumerate(poses)])
    for part in suns.T:
        assert kstest(0.5 * (part + 1.0), "uniform").pvalue > LEAST_P


def test_exposures_are_log_uniform_and_each_frame_has_its_own() -> None:
    spec = spec_of(exposure={"exposure_ms": [0.5, 20.0]})
    times = np.array([draw_exposure_ms(spec, n, k) for n in range(200) for k in range(3)])
    share = np.log(times / 0.5) / np.log(40.0)
    assert kstest(share, "uniform").pvalue > LEAST_P
    assert len(set(times)) == len(times)


def test_backgrounds_come_in_their_shares_and_the_earth_is_in_the_image() -> None:
    found = drawn(600, background={"space": 1.0, "stars": 1.0, "earth": 2.0})
    counts = Counter(pose.background for pose in found)
    assert counts["earth"] == pytest.approx(300, abs=50)  # four sigma
    assert counts["stars"] == pytest.approx(150, abs=43)
    radius = np.arcsin(EARTH_RADIUS_KM / GEO_RADIUS_KM)
    for pose in found:
        if pose.background == "earth":
            off = np.arccos(pose.cam_from_target.rotation[2] @ pose.earth_dir_in_target)
            assert off < radius + np.deg2rad(20.0)
        else:
            assert not pose.earth_dir_in_target.any()


def test_no_sun_is_drawn_that_the_earth_hides() -> None:
    spec = spec_of(background={"space": 0.0, "earth": 1.0}, sun={"by": "direction"})
    refused: Counter[str] = Counter()
    radius = np.arcsin(EARTH_RADIUS_KM / GEO_RADIUS_KM)
    for number in range(300):
        pose = draw_pose(spec, aim_at_box(), CAMERA, number, Counter())
        sun = draw_sun(spec, pose, number, 0, refused)
        assert sun @ pose.earth_dir_in_target <= np.cos(radius)
    share = 0.5 * (1.0 - np.cos(radius))  # of the sphere
    assert 0 < refused[ECLIPSED] < 300 * share + 12


@pytest.mark.parametrize(
    ("pose", "reason"),
    [
        ({"off_axis": 3.0}, OUT),
        ({"off_axis": 1.0, "in_view": "whole"}, CUT),
        ({"off_axis": 0.0}, INSIDE),
    ],
)
def test_what_is_refused_is_counted_and_told(pose: dict[str, object], reason: str) -> None:
    spec = spec_of(pose={**pose, "range_m": [NEAR_M, FAR_M]})
    aim = aim_at_box(0.5, 4.0) if reason == INSIDE else aim_at_box()
    refused: Counter[str] = Counter()
    for number in range(100):
        draw_pose(spec, aim, CAMERA, number, refused)
    assert refused[reason] > 5


def test_a_target_whose_frame_is_behind_the_camera_is_refused() -> None:
    refused: Counter[str] = Counter()
    for number in range(60):
        draw_pose(spec_of(), aim_at_box(0.9, 1.5), CAMERA, number, refused)
    assert set(refused) <= {BEHIND, INSIDE}
    assert refused[BEHIND] > 0


def test_what_cannot_be_drawn_is_an_error_that_says_why() -> None:
    spec = spec_of(pose={"in_view": "whole", "range_m": [NEAR_M, FAR_M]})
    with pytest.raises(ScenarioError, match=r"none was taken \(target cut off.*pose\.in_view"):
        draw_pose(spec, aim_at_box(1.6, 1.7), CAMERA, 0, Counter())


def test_a_draw_depends_on_its_own_number_alone() -> None:
    spec = spec_of(pose={"off_axis": 2.0, "range_m": [NEAR_M, FAR_M]})
    alone = draw_pose(spec, aim_at_box(), CAMERA, 17, Counter())
    for number in range(18):
        last = draw_pose(spec, aim_at_box(), CAMERA, number, Counter())
    np.testing.assert_array_equal(last.cam_from_target.matrix(), alone.cam_from_target.matrix())
    other = draw_pose(spec_of(seed=2), aim_at_box(), CAMERA, 17, Counter())
    assert (other.cam_from_target.matrix() != alone.cam_from_target.matrix()).any()


def unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))

"""Markers in a plane: the second pose is found, and never believed when it is the wrong one."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from models.markers import MarkerPattern
from models.pose import RigidTransform, pose_error
from pipelines.chaser_fixed.options import options_for
from pipelines.pnp import robust_pose
from pipelines.pnp.match import Match, Solution
from pipelines.pnp.mirrored_pose import mirrored_pose, rival_of
from pipelines.pnp.predicted_pose import PredictedPose
from pipelines.pnp.robust_pose import solve_match
from tests.support.synthetic_pair import CAMERA_2048, PATTERN, facing_pose

SIGMA_PX = 0.077  # Opromolla et al. 2022, Table 13: of a centroid
DRAWS = 60
WORST_NEES = 37.0  # chi-square of six: one in 500,000 for a covariance that is right
NEARLY_IPPE_DEG = 1.0  # IPPE minimises in the plane, we in the image: the same minimum, nearly
BEST = options_for("best")
FACE = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])


def square(half_m: float) -> MarkerPattern:
    return MarkerPattern(
        ("a", "b", "c", "d"), half_m * FACE, np.tile([0.0, 0.0, 1.0], (4, 1)), 0.0127
    )


def seen(markers: MarkerPattern, truth: RigidTransform, rng: np.random.Generator) -> Match:
    exact = CAMERA_2048.project(truth @ markers.points_in_target)
    return Match(
        exact + SIGMA_PX * rng.standard_normal(exact.shape),
        np.tile(SIGMA_PX**2 * np.eye(2), (len(markers), 1, 1)),
        np.arange(len(markers)),
    )


def mirrored(pose: RigidTransform, markers: MarkerPattern) -> RigidTransform:
    found = mirrored_pose(pose, markers.points_in_target)
    assert found is not None
    return found


def solved(
    markers: MarkerPattern,
    match: Match,
    start: RigidTransform,
    predicted: PredictedPose | None = None,
) -> Solution | str:
    radius_px = CAMERA_2048.fx * markers.radius_m / start.translation[2]
    return solve_match(CAMERA_2048, markers, match, start, radius_px, BEST, predicted)


def nees(solution: Solution, truth: RigidTransform) -> float:
    error = pose_error(solution.pose, truth)
    vector = np.concatenate([np.deg2rad(error.rotation_vector_deg), error.position_m])
    return float(vector @ np.linalg.solve(solution.covariance, vector))


def drawn_truths(range_m: float, tilt_deg: float) -> list[RigidTransform]:
    rng = np.random.default_rng(7)
    return [
        facing_pose(
            range_m, (180.0 + tilt_deg + rng.normal(0.0, 2.0), rng.normal(0.0, 2.0), 0.0),
            aim=np.zeros(3),
        )
        for _ in range(DRAWS)
    ]  # fmt: skip


def outcomes(
    half_m: float, range_m: float, tilt_deg: float
) -> list[tuple[Solution | str, RigidTransform]]:
    """Start each draw at the mirrored tilt of its truth."""
    markers, rng = square(half_m), np.random.default_rng(8)
    return [
        (solved(markers, seen(markers, truth, rng), mirrored(truth, markers)), truth)
        for truth in drawn_truths(range_m, tilt_deg)
    ]


def test_the_mirrored_pose_is_a_reflection_that_keeps_middle_and_distances() -> None:
    pose = facing_pose(8.0, (195.0, -7.0, 20.0))
    points = square(0.5).points_in_target + np.array([0.3, -0.2, 0.1])
    other = mirrored_pose(pose, points)
    assert other is not None
    middle = points.mean(axis=0)
    sight = (pose @ middle) / np.linalg.norm(pose @ middle)
    np.testing.assert_allclose(other @ middle, pose @ middle, atol=1e-12)
    away, mirrored_away = pose @ points - pose @ middle, other @ points - other @ middle
    np.testing.assert_allclose(mirrored_away @ sight, -(away @ sight), atol=1e-12)
    across = np.eye(3) - np.outer(sight, sight)
    np.testing.assert_allclose(mirrored_away @ across, away @ across, atol=1e-12)
    again = mirrored_pose(other, points)
    assert again is not None
    np.testing.assert_allclose(again.matrix(), pose.matrix(), atol=1e-12)


def test_it_starts_in_the_basin_of_ippes_second_pose() -> None:
    """Collins and Bartoli 2014, in OpenCV: both poses of a plane, in closed form."""
    markers, rng = square(0.3), np.random.default_rng(1)
    truth = facing_pose(15.0, (190.0, 4.0, 0.0), aim=np.zeros(3))
    match = seen(markers, truth, rng)
    _, turns, shifts, _ = cv2.solvePnPGeneric(
        markers.points_in_target, match.points_px, CAMERA_2048.matrix, None,
        flags=cv2.SOLVEPNP_IPPE,
    )  # fmt: skip
    theirs = [
        RigidTransform(cv2.Rodrigues(turn)[0], shift[:, 0])
        for turn, shift in zip(turns, shifts, strict=True)
    ]
    assert len(theirs) == 2
    ours = [truth, mirrored(truth, markers)]
    refined = []
    for start in ours:
        found = robust_pose._solved_from(CAMERA_2048, markers, match, start, 1.9, BEST)
        assert isinstance(found, Solution)
        refined.append(found.pose)
    for pose in refined:
        assert min(pose_error(pose, peer).attitude_deg for peer in theirs) < NEARLY_IPPE_DEG
    assert pose_error(refined[0], refined[1]).attitude_deg > 10.0


def test_relief_leaves_no_second_pose() -> None:
    assert mirrored_pose(facing_pose(6.7), PATTERN.points_in_target) is None
    assert mirrored_pose(facing_pose(6.7), PATTERN.points_in_target[:9]) is not None


@pytest.mark.parametrize("range_m", [15.0, 8.0, 5.0])
def test_where_the_two_differ_the_right_one_is_found_from_the_wrong_one(range_m: float) -> None:
    """0.6 m apart and tilted by 10 deg: 58, 27 and none of 60 ended in the wrong pose."""
    found = outcomes(0.3, range_m, 10.0)
    accepted = [(solution, truth) for solution, truth in found if isinstance(solution, Solution)]
    assert len(accepted) >= 0.95 * DRAWS
    assert max(nees(solution, truth) for solution, truth in accepted) < WORST_NEES


@pytest.mark.parametrize("range_m", [15.0, 8.0, 5.0])
def test_where_they_fit_alike_no_wrong_pose_is_accepted(range_m: float) -> None:
    """0.2 m apart: all 60 ended in the wrong pose, at a median NEES of 2700, 920 and 340."""
    found = outcomes(0.1, range_m, 15.0)
    accepted = [(solution, truth) for solution, truth in found if isinstance(solution, Solution)]
    assert all(nees(solution, truth) < WORST_NEES for solution, truth in accepted)
    refused = [reason for reason, _ in found if isinstance(reason, str)]
    assert all("the pose is ambiguous" in reason for reason in refused)
    assert all("deg apart fit them alike" in reason for reason in refused)
    if range_m == 15.0:
        assert len(refused) > 0.9 * DRAWS  # nothing in the image tells them apart there
    if range_m == 5.0:
        assert len(accepted) > 0.9 * DRAWS


@pytest.mark.parametrize("towards", ["the truth", "the mirrored pose"])
def test_the_prediction_decides_where_the_image_cannot(towards: str) -> None:
    markers, rng = square(0.1), np.random.default_rng(4)
    truth = facing_pose(15.0, (195.0, 3.0, 0.0), aim=np.zeros(3))
    match, other = seen(markers, truth, rng), mirrored(truth, markers)
    expected = truth if towards == "the truth" else other
    sure = PredictedPose(expected, np.diag([*3 * [np.deg2rad(2.0) ** 2], *3 * [0.1**2]]), 0)
    unsure = PredictedPose(expected, np.diag([*3 * [1.0], *3 * [1.0]]), 0)
    for start in (truth, other):
        found = solved(markers, match, start, sure)
        assert isinstance(found, Solution)
        assert pose_error(found.pose, expected).attitude_deg < 10.0
        assert "ambiguous" in str(solved(markers, match, start, unsure))


def test_the_image_overrules_a_wrong_prediction_where_it_can() -> None:
    markers, rng = square(0.3), np.random.default_rng(4)
    truth = facing_pose(5.0, (190.0, 0.0, 0.0), aim=np.zeros(3))
    match, other = seen(markers, truth, rng), mirrored(truth, markers)
    wrong = PredictedPose(other, np.diag([*3 * [np.deg2rad(1.0) ** 2], *3 * [0.05**2]]), 0)
    found = solved(markers, match, other, wrong)
    assert isinstance(found, Solution)
    assert nees(found, truth) < WORST_NEES


def test_ten_markers_in_relief_are_solved_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The ordinary pattern costs and changes nothing."""
    calls: list[RigidTransform] = []
    real = robust_pose._solved_from

    def counted(*arguments: object) -> Solution | str:
        calls.append(arguments[3])  # type: ignore[arg-type]
        return real(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(robust_pose, "_solved_from", counted)
    truth = facing_pose(4.0, (179.0, 1.0, -1.0))
    match = seen(PATTERN, truth, np.random.default_rng(2))
    found = solved(PATTERN, match, truth)
    assert isinstance(found, Solution)
    assert len(calls) == 1


def test_a_pose_is_no_rival_of_itself() -> None:
    truth = facing_pose(4.0, (179.0, 1.0, -1.0))
    found = solved(PATTERN, seen(PATTERN, truth, np.random.default_rng(2)), truth)
    assert isinstance(found, Solution)
    assert rival_of(found, found) is None


@pytest.mark.parametrize("variant", ["paper", "best"])
@pytest.mark.parametrize(
    "start",
    [
        RigidTransform(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, -3.0])),
        RigidTransform(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 0.1])),  # one marker behind
        RigidTransform(np.eye(3), np.zeros(3)),
    ],
)
def test_a_start_with_a_marker_behind_the_camera_gives_its_reason(
    variant: str, start: RigidTransform
) -> None:
    truth = facing_pose(4.0, (179.0, 1.0, -1.0))
    match = seen(PATTERN, truth, np.random.default_rng(2))
    found = solve_match(CAMERA_2048, PATTERN, match, start, 7.0, options_for(variant))
    assert found == "the solver put markers behind the camera"

"""Edges cut into samples, faces' edges, outlines and covariances: counted and computed by hand."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment
from scipy.spatial.transform import Rotation

from models.camera import Camera
from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe
from pipelines.detection.edge_map import find_edges
from pipelines.detection.target_region import TargetRegion
from pipelines.tracking import from_image, model_edges, point_fit, pose_check, softposit
from pipelines.tracking.edge_fit import EdgeFit, EdgeImage, EdgeSteps, normal_jacobian
from pipelines.tracking.model_edges import EdgeSamples, ModelEdges
from pipelines.tracking.pose_check import PoseCheck

CAMERA = Camera.from_fov(200, 160, 40.0)
POSE = RigidTransform(
    Rotation.from_rotvec([0.5, -0.8, 0.3]).as_matrix(), np.array([0.2, -0.1, 12.0])
)
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
TRIANGLES = CORNERS[
    np.array([[a, b, c] for a, b, c, _ in FACES] + [[a, c, d] for a, _, c, d in FACES])
]


def wireframe(edges: list[tuple[int, int]], triangles=TRIANGLES, points=CORNERS) -> Wireframe:
    names = tuple(f"c{k}" for k in range(len(points)))
    return Wireframe("cube", names, points, np.zeros(len(points), bool), np.array(edges), triangles)


CUBE = ModelEdges(wireframe([(0, 4), (0, 1)]), samples=120)


def test_a_cube_has_twelve_edges_and_no_diagonals_and_a_sheet_has_open_ones() -> None:
    ends, sides = model_edges._mesh_edges(TRIANGLES)
    assert len(ends) == 12
    np.testing.assert_allclose(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), 2.0)
    normals = np.cross(TRIANGLES[:, 1] - TRIANGLES[:, 0], TRIANGLES[:, 2] - TRIANGLES[:, 0])
    assert (np.abs((normals[sides[:, 0]] * normals[sides[:, 1]]).sum(axis=1)) < 1e-9).all()
    sheet, open_sides = model_edges._mesh_edges(TRIANGLES[[0, 6]])
    assert len(sheet) == 4
    assert sorted(open_sides[:, 1].tolist()) == [-1, -1, -1, -1]
    assert model_edges._mesh_edges(np.zeros((0, 3, 3)))[0].shape == (0, 2, 3)


def test_corners_of_faces_within_a_tenth_of_a_millimetre_are_one() -> None:
    rng = np.random.default_rng(1)
    for apart_m, edges in ((2e-5, 12), (4e-3, 36)):  # every triangle alone: 36
        moved = TRIANGLES + apart_m * rng.uniform(-1.0, 1.0, TRIANGLES.shape)
        assert len(model_edges._mesh_edges(moved)[0]) == edges


def test_segments_on_others_are_told_by_both_ends() -> None:
    others = np.array([[[0.0, 0, 0], [4.0, 0, 0]], [[0.0, 0, 0], [0.0, 3.0, 0]]])
    on = np.array(
        [
            [[1.0, 0.019, 0], [3.0, 0, 0.019]], [[1.0, 0.021, 0], [3.0, 0, 0]],
            [[1.0, 0, 0], [4.1, 0, 0]], [[1.0, 0, 0], [4.015, 0, 0]], [[-0.1, 0, 0], [1.0, 0, 0]],
            [[1.0, 0, 0], [0.0, 1.0, 0]],
        ]
    )  # fmt: skip
    assert model_edges._on_segments(on, others, 0.02).tolist() == [1, 0, 0, 1, 0, 0]
    assert model_edges._on_segments(on, others[:0], 0.02).tolist() == [0] * 6


def test_samples_stand_evenly_in_the_middles_of_their_shares() -> None:
    """Twelve edges of 2 m, ten samples each: at 0.1, 0.3 ... 1.9 m from an end, along it."""
    assert len(CUBE.points) == 120
    assert np.bincount(CUBE.edge).tolist() == [10] * 12
    first = CUBE.points[CUBE.edge == 0]  # from corner 0 to corner 4
    np.testing.assert_allclose(first[:, 0], np.arange(-0.9, 1.0, 0.2))
    np.testing.assert_allclose(first[:, 1:], -1.0)
    np.testing.assert_allclose(CUBE.directions[CUBE.edge == 0], np.tile([1.0, 0, 0], (10, 1)))
    np.testing.assert_allclose(np.linalg.norm(CUBE.directions, axis=1), 1.0)
    coarse = ModelEdges(wireframe([(0, 4), (0, 1)]), samples=3)
    assert np.bincount(coarse.edge).tolist() == [1] * 12


def test_outlines_are_edges_between_a_face_that_looks_and_one_that_does_not() -> None:
    """Face on: the four round the near face; corner on: six; wires show always."""
    for eye, outlines in (([0.0, 0.0, 9.0], 4), ([9.0, 8.0, 7.0], 6), ([0.0, 9.0, 8.0], 6)):
        shown = np.unique(CUBE.edge[CUBE._facing(np.array(eye))])
        middles = np.array([CUBE.points[CUBE.edge == k].mean(axis=0) for k in range(12)])
        on = np.abs(np.abs(middles) - 1.0) < 1e-9  # of a middle, the two faces that meet there
        looking = (on & (np.sign(middles) * np.array(eye) > 1.0)).sum(axis=1)
        assert set(shown.tolist()) == {0, 1} | set(np.flatnonzero(looking == 1).tolist())
        assert (looking == 1).sum() == outlines


@pytest.mark.parametrize("turn_deg", [0.0, 60.0, 90.0, 200.0, 330.0])
def test_normals_of_an_outline_point_to_empty_space(turn_deg: float) -> None:
    """Covered on one side of a line: 2.5 px on either side are looked at."""
    turn = np.deg2rad(turn_deg)
    normal = np.array([np.cos(turn), np.sin(turn)])
    v, u = np.mgrid[:160, :200]
    along = (u - 100) * normal[0] + (v - 80) * normal[1]
    own = EdgeSamples(
        np.zeros((2, 3)), np.array([[100.0, 80.0], [100.0, 80.0]]), np.stack([normal, -normal]),
        np.zeros(2, dtype=np.int64), np.zeros(2, bool),
    )  # fmt: skip
    half = model_edges._with_outline(own, along < 0.0)
    np.testing.assert_allclose(half.normals_px, np.stack([normal, normal]))
    assert half.outline.all()
    inside = model_edges._with_outline(own, along < 50.0)
    np.testing.assert_allclose(inside.normals_px, own.normals_px)
    assert not inside.outline.any()
    assert model_edges._with_outline(own, np.abs(along) < 2.0).outline.all()
    assert not model_edges._with_outline(own, np.abs(along) < 3.5).outline.any()


def test_normals_are_square_to_their_edges_in_the_image() -> None:
    shown = CUBE.shown(CAMERA, POSE)
    for edge in np.unique(shown.edge):
        own = shown.subset(shown.edge == edge)
        if len(own) > 2:
            chord = own.points_px[-1] - own.points_px[0]
            square = own.normals_px @ chord / np.linalg.norm(chord)
            np.testing.assert_allclose(square, 0.0, atol=5e-3)
        np.testing.assert_allclose(np.linalg.norm(own.normals_px, axis=1), 1.0)
    np.testing.assert_allclose(shown.points_px, CAMERA.project(POSE @ shown.points_in_target))


def test_samples_are_shown_two_pixels_inside_the_image_and_not_end_on() -> None:
    wide = wireframe([(0, 1)], np.zeros((0, 3, 3)), np.array([[-9.0, 0, 0], [9.0, 0, 0]]))
    pose = RigidTransform(np.eye(3), np.array([0.0, 0.0, 12.0]))
    shown = ModelEdges(wide, samples=900).shown(CAMERA, pose)
    assert shown.points_px[:, 0].min() == pytest.approx(1.5, abs=0.5)
    assert shown.points_px[:, 0].max() == pytest.approx(197.5, abs=0.5)
    for off_deg, seen in ((8.0, False), (10.0, True)):  # a sine of 0.15 is 8.6 deg
        turn = np.deg2rad(off_deg)
        end = 0.3 * np.array([np.sin(turn), 0.0, np.cos(turn)])
        one = wireframe([(0, 1)], np.zeros((0, 3, 3)), np.stack([-end, end]))
        assert bool(len(ModelEdges(one, samples=9).shown(CAMERA, pose))) == seen


def test_the_spread_of_a_prediction_is_that_of_its_draws() -> None:
    """Rms over corners and both axes; a tenth of a degree and 3 cm, drawn 2000 times."""
    rng = np.random.default_rng(3)
    root = np.diag([2e-3, 1e-3, 4e-3, 0.02, 0.01, 0.03]) @ rng.uniform(-1.0, 1.0, (6, 6))
    still = CAMERA.project(POSE @ CORNERS)
    moved = [
        CAMERA.project(POSE.perturbed(step[:3], step[3:]) @ CORNERS) - still
        for step in rng.standard_normal((2000, 6)) @ root.T
    ]
    found = from_image.spread_px(CAMERA, CUBE, POSE, root @ root.T)
    assert found == pytest.approx(np.sqrt(np.mean(np.square(moved))), rel=0.05)


def made_fit(weights: np.ndarray, rms_px: float) -> EdgeFit:
    shown = CUBE.shown(CAMERA, POSE)
    own = shown.subset(np.arange(len(weights)) % len(shown))
    steps = EdgeSteps(np.zeros(len(own)), np.zeros(len(own), bool))
    return EdgeFit(POSE, own, steps, weights, np.eye(6), rms_px)


OF_HALVES_PX, OF_OUTLINES_PX, OF_ALL_PX = 0.35, 0.2, 0.05
DRAWN = 40_000
DRAWN_APART = 0.03  # of the largest: four standard errors of a covariance of so many draws


@pytest.mark.parametrize(
    ("rms_px", "outside", "unseen", "times"),
    [
        (0.2, 0.0, 0.0, 1.0),
        (1.0, 0.0, 0.0, 0.85 / 0.35),
        (0.2, 0.06, 0.0, 2.0),
        (0.2, 0.0, 0.4, 3.0),
    ],
)
def test_a_covariance_is_that_of_fits_whose_edges_err_by_halves(
    rms_px: float, outside: float, unseen: float, times: float
) -> None:
    """Errors drawn alike along half an edge, outwards for all outlines, and sideways for all."""
    rng = np.random.default_rng(4)
    fit = made_fit(rng.uniform(0.2, 1.0, 90), rms_px)
    found = from_image.fit_covariance(fit, CAMERA, PoseCheck(1.0, outside, 0.0, unseen))
    shown = fit.samples
    halves = [
        part
        for edge in np.unique(shown.edge)
        for part in in_two(np.flatnonzero(shown.edge == edge))
    ]
    errors = np.zeros((DRAWN, len(shown)))
    for part in halves:
        errors[:, part] += OF_HALVES_PX * times * rng.standard_normal((DRAWN, 1))
    errors += OF_OUTLINES_PX * rng.standard_normal((DRAWN, 1)) * shown.outline
    errors += OF_ALL_PX * rng.standard_normal((DRAWN, 2)) @ shown.normals_px.T
    root = np.sqrt(fit.weights)
    jacobian = normal_jacobian(CAMERA, POSE, shown)
    moved = np.linalg.lstsq(root[:, None] * jacobian, root[:, None] * errors.T, rcond=None)[0]
    drawn = np.cov(moved)
    assert found is not None
    scale = np.sqrt(np.diag(drawn))
    apart = (found - drawn) / np.outer(scale, scale)
    np.testing.assert_allclose(apart, 0.0, atol=DRAWN_APART)
    np.testing.assert_array_equal(found, found.T)


def in_two(places: np.ndarray) -> list[np.ndarray]:
    """Return the two halves of an edge's samples; the first is the larger."""
    return np.split(places, [-(-len(places) // 2)])


def test_edges_all_along_one_direction_fix_no_pose() -> None:
    fit = made_fit(np.zeros(40), 0.5)
    assert from_image.fit_covariance(fit, CAMERA, PoseCheck(1.0, 0.0, 0.0, 0.0)) is None


def test_retries_are_draws_of_the_prediction_from_a_wider_search() -> None:
    options = from_image.ImageTrackingOptions(retries=400)
    covariance = np.diag([0.02, 0.03, 0.01, 0.1, 0.2, 0.3]) ** 2
    starts = from_image._starts(POSE, covariance, 10.0, options)
    assert [reach for _, reach in starts] == [10.0] + 401 * [24.0]
    assert starts[0][0] is starts[1][0] is POSE
    assert len(from_image._starts(POSE, covariance, 24.0, options)) == 401
    turns = np.array(
        [Rotation.from_matrix(p.rotation @ POSE.rotation.T).as_rotvec() for p, _ in starts[2:]]
    )
    shifts = np.array([p.translation - POSE.translation for p, _ in starts[2:]])
    drawn = np.concatenate([turns, shifts], axis=1).std(axis=0)
    np.testing.assert_allclose(drawn, 1.5 * np.sqrt(np.diag(covariance)), rtol=0.15)
    wild = from_image._starts(POSE, 100.0 * covariance, 10.0, options)
    sizes = [Rotation.from_matrix(p.rotation @ POSE.rotation.T).magnitude() for p, _ in wild[2:]]
    assert max(sizes) == pytest.approx(0.3, abs=1e-9)


@pytest.mark.parametrize(("supported", "outside", "dark", "believed"), [
    (0.7, 0.0, 0.0, True), (0.699, 0.0, 0.0, False),
    (1.0, 0.329, 0.0, True), (1.0, 0.330, 0.0, False),  # 0.67 squared is 0.449
    (0.8, 0.0, 0.833, True), (0.8, 0.0, 0.834, False),  # 0.8 x 0.75^2 is 0.45
])  # fmt: skip
def test_a_pose_is_believed_for_its_score_and_its_edges(supported, outside, dark, believed) -> None:
    """Supported times the square of light inside and of three tenths of what is not dark."""
    check = PoseCheck(supported, outside, dark, 0.0)
    expected = supported * ((1.0 - outside) * (1.0 - 0.3 * dark)) ** 2
    assert check.score == pytest.approx(expected)
    assert (from_image._doubt(check, from_image.ImageTrackingOptions()) == "") == believed


@pytest.mark.parametrize("crowded", [False, True])
def test_points_match_one_to_one_at_the_least_distance_within_the_gate(crowded: bool) -> None:
    """Against SciPy's assignment of the squares, where leaving one out costs a gate's square."""
    for seed in range(10):
        rng = np.random.default_rng([5, seed])
        landmarks = rng.uniform(-1.0, 1.0, (9, 2))
        points = landmarks[rng.permutation(9)[:6]] + 0.02 * rng.standard_normal((6, 2))
        gate = 0.9 if crowded else 0.05
        squared = ((points[:, None] - landmarks) ** 2).sum(axis=-1)
        cost = np.hstack([np.minimum(squared, 9.0 * gate**2), np.full((6, 6), gate**2)])
        cost[:, :9][squared >= gate**2] = 1e3
        _, chosen = linear_sum_assignment(cost)
        expected = np.where(chosen < 9, chosen, -1)
        np.testing.assert_array_equal(point_fit._matches(landmarks, points, gate, None), expected)
        shown = np.array([7, 2, 3, 5])
        few = point_fit._matches(landmarks, points, 0.05, shown)
        assert set(few.tolist()) <= {-1, 7, 2, 3, 5}
        close = squared.argmin(axis=1)
        near = squared.min(axis=1) < 0.05**2
        kept = near & np.isin(close, shown)
        np.testing.assert_array_equal(few, np.where(kept, close, -1))


def test_a_bound_is_the_informations_inverse_and_none_where_there_is_none() -> None:
    rng = np.random.default_rng(6)
    whitened = rng.standard_normal((6, 20)) * np.array([1, 1e3, 1, 1e-3, 1, 10.0])[:, None]
    found = point_fit._bound(whitened)
    assert found is not None
    np.testing.assert_allclose(found, np.linalg.inv(whitened @ whitened.T), rtol=1e-7)
    np.testing.assert_array_equal(found, found.T)
    for broken in (0.0, np.nan, np.inf):
        bad = whitened.copy()
        bad[2] = broken
        assert point_fit._bound(bad) is None
    alike = whitened.copy()
    alike[3] = 2.0 * alike[1]
    assert point_fit._bound(alike) is None


def test_rounding_is_taken_off_a_rotation() -> None:
    rough = POSE.rotation + 1e-5 * np.random.default_rng(7).standard_normal((3, 3))
    smooth = point_fit._orthonormal(rough)
    u, _, v = np.linalg.svd(rough)
    np.testing.assert_allclose(smooth, u @ v, atol=1e-9)


def test_softposits_rotation_is_the_polar_factor_by_singular_values() -> None:
    """Nearest rows to the scaled ones, the third from both, and the scale their mean."""
    rng = np.random.default_rng(8)
    for _ in range(10):
        scaled = rng.standard_normal((2, 4))
        rotation, translation = softposit._rotation_of(scaled)
        u, s, v = np.linalg.svd(scaled[:, :3], full_matrices=False)
        rows = u @ v
        assert rotation is not None
        np.testing.assert_allclose(rotation[:2], rows, atol=1e-9)
        np.testing.assert_allclose(rotation[2], np.cross(*rows), atol=1e-9)
        depth = 2.0 / s.sum()
        np.testing.assert_allclose(translation, [*(scaled[:, 3] * depth), depth])
    flat = np.array([[1.0, 2.0, 3.0, 0.0], [2.0, 4.0, 6.0, 0.0]])
    assert softposit._rotation_of(0.0 * flat)[0] is None


def test_first_beta_is_held_between_its_bounds() -> None:
    assert [softposit.first_beta(s) for s in (0.0, 5.0, 20.0, 1e4, 1e7)] == pytest.approx(
        [0.1, 0.1, 0.05, 1e-4, 1e-5]
    )


def lit_cube(change) -> tuple[PoseCheck, np.ndarray]:
    """Hold the true pose against a flat drawing of the cube whose lit pixels were changed."""
    silhouette = CUBE.silhouette(CAMERA, POSE)
    lit = silhouette.copy()
    change(lit)
    signal = cv2.GaussianBlur((60.0 * lit).astype(np.float32), (0, 0), 0.7)
    target = TargetRegion(signal, np.arcsinh(signal / 6.0), lit, 1.5, 6.0, 0.0)
    image = EdgeImage(target, find_edges(target), CAMERA)
    return pose_check.check_pose(image, CUBE, POSE), silhouette


def test_a_pose_that_is_right_finds_its_outline_and_no_light_elsewhere() -> None:
    check, _ = lit_cube(lambda lit: None)
    shown = CUBE.shown(CAMERA, POSE)
    # A flat drawing shows outlines and no edges within them.
    assert check.supported == pytest.approx(shown.outline.mean(), abs=0.05)
    assert (check.outside, check.dark, check.unseen) == (0.0, 0.0, 0.0)


def test_light_outside_and_darkness_inside_are_shares_of_pixels() -> None:
    """Two pixels round the silhouette are nobody's; so is its own rim of one."""

    def added(lit: np.ndarray) -> None:
        lit[5:25, 5:15] = True

    def taken(lit: np.ndarray) -> None:
        lit[76:84, 98:108] = False

    check, silhouette = lit_cube(added)
    assert check.outside == pytest.approx(200.0 / (silhouette.sum() + 200.0))
    check, silhouette = lit_cube(taken)
    assert silhouette[76:84, 98:108].all()
    inner = cv2.erode(silhouette.astype(np.uint8), np.ones((3, 3), np.uint8)).sum()
    assert check.dark == pytest.approx(80.0 / inner)
    for pixels, outside in ((2, False), (3, True)):
        grown = (
            cv2.dilate(silhouette.astype(np.uint8), np.ones((2 * pixels + 1,) * 2, np.uint8)) > 0
        )
        check, _ = lit_cube(lambda lit, more=grown: np.logical_or(lit, more, out=lit))
        assert (check.outside > 0.0) == outside


def test_what_has_no_light_on_its_edges_fits_nothing() -> None:
    def half(lit: np.ndarray) -> None:
        lit[:, :100] = False

    check, _ = lit_cube(half)
    shown = CUBE.shown(CAMERA, POSE)
    assert check.unseen == pytest.approx((shown.points_px[:, 0] < 100.0).mean(), abs=0.12)
    assert check.supported < 1.0
    nothing, _ = lit_cube(lambda lit: lit.fill(False))
    assert nothing is pose_check.NO_FIT
    assert nothing.score == 0.0


@pytest.mark.parametrize(("size", "off_m", "edges"), [
    (1.0, 0.016, 12), (1.0, 0.0185, 13), (10.0, 0.019, 12), (10.0, 0.021, 13),
])  # fmt: skip
def test_an_outline_beside_a_wire_is_that_wire(size: float, off_m: float, edges: int) -> None:
    """Within 2 cm, or, of a small target, a hundredth of its radius: 1.7 cm of this cube's."""
    points = size * CORNERS
    points[[0, 1], 0] -= off_m
    frame = wireframe([(0, 1)], size * TRIANGLES, points)
    assert size * np.sqrt(3.0) <= frame.radius_m < 1.02 * size * np.sqrt(3.0)
    assert len(np.unique(ModelEdges(frame, samples=60).edge)) == edges

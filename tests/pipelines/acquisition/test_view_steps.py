"""The steps of the search over views, and of the refinement of many poses, each by itself."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.camera import Camera
from models.pose import RigidTransform
from pipelines.acquisition import pose_refinement, view_search, view_sphere
from pipelines.acquisition.view_search import MOSTLY_LIT, PARTLY_LIT, Spread
from pipelines.acquisition.view_sphere import CELLS, REACH, View, ViewSphere
from pipelines.tracking.model_edges import EdgeSamples, ModelEdges
from tests.support.drawn_targets import target

CAMERA = Camera.from_fov(256, 256, 40.0)
NONE = EdgeSamples(
    np.zeros((0, 3)), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, int), np.zeros(0, bool)
)


@pytest.mark.parametrize("direction", [[0, 0, 1.0], [0.6, 0, -0.8], [-0.48, 0.6, 0.64]])
def test_a_camera_looks_back_from_where_it_stands(direction) -> None:
    pose = view_sphere.look_from(np.array(direction), 9.0)
    np.testing.assert_allclose(pose @ np.zeros(3), [0.0, 0.0, 9.0])
    np.testing.assert_allclose(pose.inverse().translation, 9.0 * np.array(direction), atol=1e-12)


def test_a_masks_shape_is_its_centroid_and_its_radius_of_gyration() -> None:
    """Of w by h pixels: sqrt((w^2 - 1 + h^2 - 1) / 12)."""
    mask = np.zeros((40, 60), bool)
    mask[10:17, 20:41] = True
    centroid, gyration = view_sphere.shape_of(mask)
    np.testing.assert_allclose(centroid, [30.0, 13.0])
    assert gyration == pytest.approx(np.sqrt((21**2 - 1 + 7**2 - 1) / 12.0))
    cells = view_sphere.cell_of(np.array([[30.0, 13.0], [30.0 + REACH * 5.0, 13.0]]), centroid, 5.0)
    np.testing.assert_allclose(cells, [[17.5, 17.5], [17.5 + 18.0, 17.5]])


@pytest.mark.parametrize("angle_deg", [0.0, 22.5, 45.0, 80.0, 135.0, 170.0, 200.0, 350.0])
def test_an_edge_is_drawn_in_the_two_directions_next_to_its_own(angle_deg: float) -> None:
    """Four directions 45 deg apart, to half turns; the roots of the shares, blurred alike."""
    cells, angles = np.array([[[10.2, 20.4]]]), np.deg2rad([[angle_deg]])
    pictures = view_sphere.edge_pictures(cells, angles)[0].reshape(4, CELLS, CELLS)
    mass = (pictures.astype(float) ** 2).sum(axis=(1, 2))
    away = np.abs(
        (np.deg2rad(angle_deg) - np.arange(4) * np.pi / 4 + np.pi / 2) % np.pi - np.pi / 2
    )
    expected = np.maximum(1.0 - away / (np.pi / 4), 0.0)
    np.testing.assert_allclose(mass / mass.sum(), expected, atol=1e-6)
    assert np.linalg.norm(pictures) == pytest.approx(1.0, rel=1e-5)
    strongest = pictures[int(expected.argmax())]
    assert np.unravel_index(strongest.argmax(), strongest.shape) == (20, 10)


def test_edges_beyond_the_picture_are_left_out_and_rolls_do_not_mix() -> None:
    cells = np.array([[[-0.6, 5.0], [35.6, 5.0], [5.0, -0.6], [5.0, 35.6]], 4 * [[3.0, 7.0]]])
    pictures = view_sphere.edge_pictures(cells, np.zeros((2, 4)))
    assert not pictures[0].any()
    kept = view_sphere.edge_pictures(np.array([[[-0.4, 35.4]], [[35.4, -0.4]]]), np.zeros((2, 1)))
    assert kept[0].reshape(4, CELLS, CELLS)[0, 35, 0] == kept[0].max() > 0.0
    assert kept[1].reshape(4, CELLS, CELLS)[0, 0, 35] == kept[1].max() > 0.0
    flat = view_sphere.centred(np.random.default_rng(1).uniform(size=(3, 50)).astype(np.float32))
    np.testing.assert_allclose(flat.mean(axis=1), 0.0, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(flat, axis=1), 1.0, rtol=1e-5)


@pytest.mark.parametrize("roll_deg", [0.0, 70.0, 200.0])
def test_a_view_laid_into_the_image_is_there_as_large_and_as_turned(roll_deg: float) -> None:
    """A far target's silhouette has the asked centroid, size and roll, at any place."""
    edges = ModelEdges(target())
    seen_from = view_sphere.look_from(np.array([0.48, 0.6, 0.64]), 12.0)
    mask = edges.silhouette(CAMERA, seen_from)
    centroid, gyration = view_sphere.shape_of(mask)
    view = View(seen_from, CAMERA.normalise(centroid[None])[0], gyration / CAMERA.fx, NONE)
    wanted, size = np.array([0.13, -0.11]), 0.7 * gyration / CAMERA.fx
    pose = view_sphere.pose_from_view(view, np.deg2rad(roll_deg), wanted, size)
    found, extent = view_sphere.shape_of(edges.silhouette(CAMERA, pose))
    np.testing.assert_allclose(CAMERA.normalise(found[None])[0], wanted, atol=0.006)
    assert extent / CAMERA.fx == pytest.approx(size, rel=0.06)
    assert np.linalg.norm(pose.translation) == pytest.approx(12.0 / 0.7)
    middle = view_sphere.pose_from_view(
        View(seen_from, np.zeros(2), 0.1, NONE), np.deg2rad(roll_deg), np.zeros(2), 0.1
    )
    roll = Rotation.from_euler("z", roll_deg, degrees=True).as_matrix()
    np.testing.assert_allclose(middle.rotation, roll @ seen_from.rotation, atol=1e-12)


def test_likeness_is_greatest_at_the_view_and_roll_that_an_image_shows() -> None:
    """For a view of the library drawn into an image, rolled and moved: its own, both ways."""
    sphere = view_sphere.view_sphere(target(), 12.0, 60)
    edges = ModelEdges(target())
    rolls = 2.0 * np.pi * np.arange(12) / 12
    for number, turn in ((7, 2), (31, 9)):
        pose = view_sphere.pose_from_view(
            sphere.views[number], float(rolls[turn]), np.array([0.05, -0.08]), 0.09
        )
        lit = edges.silhouette(CAMERA, pose)
        centre, size = view_sphere.shape_of(lit)
        shown = edges.shown(CAMERA, pose)
        angle = np.arctan2(shown.normals_px[:, 1], shown.normals_px[:, 0])
        likeness = view_search._likeness(
            lit.astype(np.float32), shown.points_px, angle, centre, size, rolls, sphere
        )
        assert np.unravel_index(likeness.argmax(), likeness.shape) == (turn, number)
        assert likeness.max() > 1.4  # of two
        assert np.median(likeness) < 0.6 * likeness.max()


def test_the_best_are_apart_and_each_is_laid_by_its_own_setting() -> None:
    """Of rolls 4 deg apart one is taken; setting, roll and view are those of the score."""
    poses = [
        view_sphere.look_from(np.array(d), 10.0) for d in ([0, 0, 1.0], [1.0, 0, 0], [0, 1.0, 0])
    ]
    views = tuple(View(pose, np.zeros(2), 0.1, NONE) for pose in poses)
    sphere = ViewSphere(10.0, views, np.zeros((3, 1)), np.zeros((3, 1)))
    rolls = np.deg2rad([0.0, 4.0, 90.0])
    settings = [(20.0, np.array([127.5, 127.5])), (40.0, np.array([100.0, 150.0]))]
    scores = np.zeros((2, 3, 3))
    scores[0, 2, 1], scores[1, 0, 0], scores[0, 1, 0] = 0.9, 0.8, 0.7
    scores[1, 2, 1] = 0.1
    found = view_search._best(scores, settings, rolls, sphere, CAMERA, 3)
    assert [hypothesis.view for hypothesis in found[:2]] == [1, 0]
    assert [hypothesis.likeness for hypothesis in found[:2]] == [0.9, 0.8]
    focal = 0.5 * (CAMERA.fx + CAMERA.fy)
    for hypothesis, setting, roll in ((found[0], 0, 2), (found[1], 1, 0)):
        size, centre = settings[setting]
        expected = view_sphere.pose_from_view(
            views[hypothesis.view],
            float(rolls[roll]),
            CAMERA.normalise(centre[None])[0],
            size / focal,
        )
        np.testing.assert_allclose(hypothesis.cam_from_target.matrix(), expected.matrix())
    rotations = np.array([each.cam_from_target.rotation for each in found])
    for a in range(len(found)):
        for b in range(a):
            turn = Rotation.from_matrix(rotations[a] @ rotations[b].T).magnitude()
            assert np.rad2deg(turn) > 6.0
    assert len(view_search._best(scores, settings, rolls, sphere, CAMERA, 1)) == 1


def test_sizes_and_places_are_varied_evenly_about_what_is_lit() -> None:
    """Both ways round the centroid, to its corners; in the dark to its sides too, and larger."""
    for spread, shifts in ((MOSTLY_LIT, 5), (PARTLY_LIT, 9)):
        assert isinstance(spread, Spread)
        moved = np.array(spread.shifts)
        assert len(np.unique(moved, axis=0)) == shifts
        np.testing.assert_allclose(moved.sum(axis=0), 0.0, atol=1e-12)
        np.testing.assert_allclose((moved**2).sum(axis=0)[0], (moved**2).sum(axis=0)[1])
        assert min(spread.scales) < 1.0 < max(spread.scales)
    assert max(PARTLY_LIT.scales) > 1.5 * max(MOSTLY_LIT.scales)


def test_matches_are_those_nearest_both_ways_within_the_gate() -> None:
    rng = np.random.default_rng(2)
    predicted, away = rng.uniform(size=(4, 2, 6)), rng.uniform(size=(2, 9))
    point, squared = pose_refinement.mutual_matches(predicted, away, 0.3)
    for pose in range(4):
        gaps = np.linalg.norm(predicted[pose].T[:, None] - away.T, axis=2)
        np.testing.assert_allclose(squared[pose], gaps.min(axis=1) ** 2)
        for landmark in range(6):
            nearest = int(gaps[landmark].argmin())
            mutual = int(gaps[:, nearest].argmin()) == landmark and gaps[landmark, nearest] < 0.3
            assert point[pose, landmark] == (nearest if mutual else -1)


def test_rough_poses_come_to_the_truth_and_their_likelihood_is_that_of_their_matches() -> None:
    """Each match gains log(A / 2 pi sigma^2) - d^2 / 2 sigma^2 over points strewn over a box A."""
    rng = np.random.default_rng(3)
    known = rng.uniform(-3.0, 3.0, (10, 3))
    truth = RigidTransform(
        Rotation.from_rotvec([0.3, 2.8, -0.2]).as_matrix(), np.array([0.3, -0.2, 25.0])
    )
    sigma = 1e-4
    in_cam = truth @ known
    exact = in_cam[:, :2] / in_cam[:, 2:]
    points = np.concatenate(
        [exact[:8] + sigma * rng.standard_normal((8, 2)), [[0.11, 0.1], [-0.1, 0.09]]]
    )
    starts = [
        truth.perturbed(2e-3 * rng.standard_normal(3), 0.02 * rng.standard_normal(3))
        for _ in range(5)
    ]
    behind = RigidTransform(truth.rotation, -truth.translation)
    rotations = np.array([start.rotation for start in [*starts, behind]])
    translations = np.array([start.translation for start in [*starts, behind]])
    found = pose_refinement.refined_poses(rotations, translations, known, points, sigma, 5.0)
    for k in range(5):
        pose = RigidTransform(found.rotations[k], found.translations[k])
        np.testing.assert_allclose(pose.translation, truth.translation, atol=0.05)
        assert found.point[k, :8].tolist() == list(range(8))
        seen = pose @ known
        gaps = seen[:, :2] / seen[:, 2:] - points[np.maximum(found.point[k], 0)]
        box = np.prod(np.ptp(points, axis=0))
        gain = np.log(box / (2.0 * np.pi * sigma**2)) - 0.5 * (gaps**2).sum(axis=1) / sigma**2
        assert found.log_likelihood[k] == pytest.approx(gain[found.point[k] >= 0].sum())
    assert (found.matches[:5] == 8).all()
    assert found.log_likelihood[5] == -1e18

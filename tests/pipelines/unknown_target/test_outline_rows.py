"""Outlines of a body with known corners: nothing to say by the truth, a straight slope off it."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from models.camera import Camera
from pipelines.unknown_target import robust_weights
from pipelines.unknown_target.free_tumble import FreeTumble
from pipelines.unknown_target.observation_rows import Epochs, Placed, placed
from pipelines.unknown_target.outline_rows import (
    Outlines,
    doubted_outlines,
    outline_rows,
    pairs_of,
)
from pipelines.unknown_target.unknowns import CHART, OMEGA, PLACE, SHARED, Unknowns

CAMERA = Camera(width=512, height=512, fx=549.0, fy=549.0, cx=255.5, cy=255.5)
PIXEL = 1.0 / CAMERA.fx
ORBIT_RATE, STEP_S, VIEWS = 1e-3, 6.0, 30
FIRST = Rotation.from_rotvec([0.3, -0.4, 0.2]).as_matrix()  # the camera in the local frame
TRUTH = np.array(
    [*(-FIRST.T @ [0.2, -0.3, 25.0]), 1e-3, 0.0, 2e-3, *np.deg2rad([0.5, -0.8, 1.1]),
     0.1, -0.1, 0.05, 0.02, -0.03]
)  # fmt: skip
STEPS = np.repeat([1e-3, 1e-5, 1e-6, 1e-4], [3, 3, 3, 5])  # of numerical derivatives


def corners_of(seed: int = 0) -> np.ndarray:
    """Return corners of a body 2 by 4 by 6 m, its own hull."""
    places = np.random.default_rng(seed).normal(size=(60, 3))
    return places / np.linalg.norm(places, axis=1)[:, None] * [1.0, 2.0, 3.0]


def views(shared: np.ndarray) -> Placed:
    epochs = [Epochs.of(k * STEP_S, FIRST, ORBIT_RATE) for k in range(VIEWS)]
    whole = epochs[0]
    for each in epochs[1:]:
        whole = whole.followed_by(each)
    start = whole.R_cam_from_start[0].T
    tumble = FreeTumble(shared[OMEGA], shared[CHART], start, ORBIT_RATE, VIEWS * STEP_S)
    return placed(Unknowns(shared, np.zeros((0, 3))), tumble, whole)


def outlined(seen: Placed, sigma_px: float = 0.0, seed: int = 1) -> Outlines:
    """Return outlines with borders that err by so much, corner by corner."""
    rng, found = np.random.default_rng(seed), Outlines(CAMERA)
    for place, (turn, origin) in enumerate(
        zip(seen.R_cam_from_target, seen.t_cam_from_target, strict=True)
    ):
        in_cam = corners_of() @ turn.T + origin
        rays = in_cam[:, :2] / in_cam[:, 2:]
        rays = rays[ConvexHull(rays).vertices]
        found.frames.append(place)
        found.corners.append(rays + sigma_px * PIXEL * rng.normal(size=rays.shape))
        found.inside.append(np.ones(len(rays), dtype=bool))
    return found


@pytest.fixture(scope="module")
def watched():
    seen = views(TRUTH)
    return seen, outlined(seen), pairs_of(seen)


def test_by_the_truth_outlines_agree(watched):
    """What touches is one corner, seen by both."""
    rows = outline_rows(*watched, PIXEL)
    assert len(rows.error) == 2 * len(watched[2]) > 200
    assert np.abs(rows.error).max() < 1e-9


def test_slopes_are_those_of_the_errors(watched):
    """Median over all rows: where another corner begins to touch, a difference has a kink."""
    seen, outlines, pairs = watched
    by_shared = outline_rows(seen, outlines, pairs, PIXEL).by_shared[:, 0]
    for number, step in enumerate(STEPS):
        change = np.zeros(SHARED)
        change[number] = step
        more, less = (
            outline_rows(views(TRUTH + sign * change), outlines, pairs, PIXEL).error[:, 0]
            for sign in (1.0, -1.0)
        )
        slope = -(more - less) / (2.0 * step)
        size = np.median(np.abs(slope))
        assert np.median(np.abs(slope - by_shared[:, number])) < 1e-3 * size


def test_the_scale_is_not_told(watched):
    """An outline twice as far of a body twice as large is the same outline."""
    _, outlines, pairs = watched
    larger = TRUTH.copy()
    larger[PLACE] *= 1.3
    assert np.abs(outline_rows(views(larger), outlines, pairs, PIXEL).error).max() < 1e-9


def test_a_wrong_rate_is_found_from_outlines_alone(watched):
    """Half a degree of axis and 2 % of rate off, borders off by 0.3 px: a third is left at most."""
    seen, _, pairs = watched
    outlines = outlined(seen, 0.3)
    at = TRUTH.copy()
    at[OMEGA] = Rotation.from_rotvec([0.006, 0.006, 0.0]).apply(1.02 * at[OMEGA])
    before = np.linalg.norm(at[OMEGA] - TRUTH[OMEGA])
    prior = np.diag(np.repeat([1e6, 1e6, 0.0, 1e2], [3, 3, 3, 5]))
    for _ in range(6):
        rows = outline_rows(views(at), outlines, pairs, 0.3 * PIXEL)
        by_shared, error = rows.by_shared[:, 0], rows.error[:, 0]
        information = by_shared.T @ by_shared + prior
        at = at + np.linalg.solve(information, by_shared.T @ error + prior @ (TRUTH - at))
    assert np.linalg.norm(at[OMEGA] - TRUTH[OMEGA]) < before / 3.0


def test_an_outline_that_lacks_a_part_is_refused_and_harms_nobody(watched):
    """A wing in shadow: the rows of that outline are gated, those of others keep their weight."""
    seen, _, pairs = watched
    torn = outlined(seen, 0.3)
    middle = torn.corners[9].mean(axis=0)
    torn.corners[9] = middle + 0.5 * (torn.corners[9] - middle)
    rows = outline_rows(seen, torn, pairs, 0.7 * PIXEL)
    weights = robust_weights.of_most(rows.sizes, 1, 3.0, 1.0)
    has = np.tile((pairs == 9).any(axis=1), 2)
    assert np.median(weights[has]) < 0.01
    assert np.median(weights[~has]) == 1.0
    assert doubted_outlines(torn, pairs, rows, 3.0) == {9}


def test_what_ends_at_the_images_border_says_nothing():
    outlines = Outlines(CAMERA)
    covered = np.zeros((512, 512), dtype=bool)
    covered[200:300, 400:] = True
    outlines.add(0, covered)
    right = CAMERA.project(np.column_stack([outlines.corners[0], np.ones(4)]))[:, 0] > 500.0
    np.testing.assert_array_equal(outlines.inside[0], ~right)


def test_an_empty_image_has_no_outline():
    outlines = Outlines(CAMERA)
    outlines.add(0, np.zeros((512, 512), dtype=bool))
    assert len(outlines) == 0


def test_views_from_one_side_or_from_behind_are_not_compared(watched):
    seen, _, pairs = watched
    along = seen.R_cam_from_target[:, 2]
    apart = np.rad2deg(np.arccos(np.sum(along[pairs[:, 0]] * along[pairs[:, 1]], axis=1)))
    assert apart.min() >= 10.0
    assert apart.max() <= 130.0

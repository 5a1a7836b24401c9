from __future__ import annotations

import numpy as np
import pytest

from models.arrays import Floats, Image
from models.pose import RigidTransform
from models.spacecraft.grasp_markers import GRASP_MARKERS
from pipelines.detection.disc_outline import DiscOutlines, disc_outlines
from pipelines.detection.image_difference import saturation_level_dn
from pipelines.detection.lit_disc import (
    CENTRE_FLOOR_PX,
    CENTRE_FLOOR_SHARE,
    KnownDisc,
    LitDisc,
    fit_lit_disc,
)
from tests.support.synthetic_dots import (
    CAMERA,
    DETECTOR,
    DotScene,
    facing,
    mean_image,
    raw_image,
    shadow_from,
    with_noise,
)

LEVEL = saturation_level_dn(DETECTOR)
CLEAR_PX = 0.005  # the issue's own bound on what the perspective of a circle may leave
DRAWN_PX = 0.003  # of drawing 64 points a pixel
KNOWN = KnownDisc(0.01)
LEFT_DOT = GRASP_MARKERS.points_in_target[0]


def outlines_of(pose: RigidTransform) -> DiscOutlines:
    return disc_outlines(CAMERA, pose, GRASP_MARKERS)


def fitted(
    raw: Image,
    outlines: DiscOutlines,
    index: int,
    offset: Floats | tuple[float, float] = (0, 0),
    known: KnownDisc = KNOWN,
) -> LitDisc | str:
    centre = outlines.area_centres_px[index] + np.array(offset)
    return fit_lit_disc(raw, DETECTOR, LEVEL, centre, outlines.shapes_px2[index], 0.5, known)


def test_the_perspective_of_a_circle_is_taken_off() -> None:
    pose = facing(0.4, [12.0, -25.0, 5.0])
    raw, outlines = np.rint(mean_image(DotScene(pose))).astype(np.uint16), outlines_of(pose)
    bias_px = np.linalg.norm(outlines.area_centres_px - outlines.centres_px, axis=1)
    assert bias_px.min() > 0.1  # what a centroid of the blob would be off by
    for index in range(3):
        disc = fitted(raw, outlines, index)
        assert isinstance(disc, LitDisc)
        # The shift is from the outline's middle, so the centre is off by as much.
        assert np.abs(disc.shift_px).max() < CLEAR_PX


def test_finds_a_disc_that_is_not_where_it_was_thought() -> None:
    pose = facing(0.8, [5.0, 8.0, 20.0])
    raw, outlines = raw_image(DotScene(pose)), outlines_of(pose)
    disc = fitted(raw, outlines, 1, offset=(1.7, -1.2), known=KnownDisc(0.01, capture_px=2.0))
    assert isinstance(disc, LitDisc)
    assert disc.shift_px == pytest.approx([-1.7, 1.2], abs=0.05)  # refitted from there it is exact
    assert disc.rim == 1.0


@pytest.mark.parametrize("through_m", [-0.004, 0.0, 0.003])
def test_a_dot_that_a_shadow_cuts_is_found_by_its_lit_part(through_m: float) -> None:
    pose = facing(0.5, [4.0, -6.0, 10.0])
    across = (np.cos(0.4), np.sin(0.4))
    edge = (LEFT_DOT[0] + through_m * across[0], LEFT_DOT[1] + through_m * across[1])
    scene = DotScene(pose, lit=shadow_from(across, edge))
    mean, outlines = mean_image(scene), outlines_of(pose)
    errors, squares = [], []
    for seed in range(12):
        disc = fitted(with_noise(mean, DETECTOR, seed), outlines, 0, offset=(0.4, 0.3))
        assert isinstance(disc, LitDisc)
        assert disc.rim < 0.95
        error = disc.shift_px + np.array([0.4, 0.3])
        errors.append(error)
        squares.append(error @ np.linalg.solve(disc.covariance_px2, error))
    assert np.abs(np.mean(errors, axis=0)).max() < 0.02  # the blob's centroid is 5 to 15 px off
    assert (
        np.mean(squares) < 2.0 * 2.5
    )  # two degrees of freedom, honest to a factor of 1.6 in sigma


def test_a_dot_of_which_hardly_any_rim_is_lit_is_refused_with_a_reason() -> None:
    pose = facing(0.5, [4.0, -6.0, 10.0])
    shadow = shadow_from((1.0, 0.0), (LEFT_DOT[0] - 0.0085, 0.0))
    # Black: where the shadow has a hundredth of the light, what lies in it is found.
    scene = DotScene(pose, lit=lambda points: np.where(shadow(points) < 1.0, 0.0, 1.0))
    told = fitted(raw_image(scene), outlines_of(pose), 0)
    assert isinstance(told, str)
    assert "of its rim" in told


def test_a_dot_in_even_shadow_is_found_less_surely() -> None:
    pose = facing(0.5, [4.0, -6.0, 10.0])
    outlines = outlines_of(pose)
    bright = fitted(raw_image(DotScene(pose)), outlines, 0)
    shadow = DotScene(pose, lit=lambda points: np.full(len(points), 0.01))
    dark = fitted(raw_image(shadow), outlines, 0)
    assert isinstance(bright, LitDisc)
    assert isinstance(dark, LitDisc)
    assert np.trace(dark.covariance_px2) > 1.1 * np.trace(bright.covariance_px2)
    assert np.abs(dark.shift_px).max() < 4.0 * np.sqrt(np.trace(dark.covariance_px2))


def test_nothing_on_black_is_no_dot() -> None:
    pose = facing(0.5, [0.0, 0.0, 0.0])
    told = fitted(raw_image(DotScene(pose, hidden=(0,))), outlines_of(pose), 0)
    assert isinstance(told, str)


def test_learns_the_blur_of_the_lens() -> None:
    pose = facing(0.5, [4.0, -6.0, 10.0])
    disc = fitted(raw_image(DotScene(pose, blur_px=1.2)), outlines_of(pose), 1)
    assert isinstance(disc, LitDisc)
    assert disc.blur_px == pytest.approx(1.2, abs=0.05)
    assert np.abs(disc.shift_px).max() < 4.0 * DRAWN_PX


def test_the_covariance_is_what_the_noise_makes_of_it() -> None:
    pose = facing(0.8, [4.0, -6.0, 10.0])
    # Faint, so that the pixels' noise is larger than what taking each section as even leaves.
    faint = DotScene(pose, lit=lambda points: np.full(len(points), 0.01))
    mean, outlines = mean_image(faint), outlines_of(pose)
    fits = [fitted(with_noise(mean, DETECTOR, seed), outlines, 2) for seed in range(60)]
    shifts = np.array([disc.shift_px for disc in fits if isinstance(disc, LitDisc)])
    stated = np.mean(
        [np.diag(disc.covariance_px2) for disc in fits if isinstance(disc, LitDisc)], axis=0
    )
    radius = float(outlines.radii_px[2])
    stated -= CENTRE_FLOOR_PX**2 + (CENTRE_FLOOR_SHARE * radius) ** 2
    assert len(shifts) == 60
    ratio = shifts.var(axis=0, ddof=1) / stated
    # Chi-square of 59 over 59 is within 0.6 and 1.6 in 99.8 of 100.
    assert (ratio < 1.6).all()
    assert (ratio > 0.6).all()


SMALL_M = 2.7  # from where a dot is 4.6 px in radius, its rim 29 px long
SMALL_BLUR_PX = (
    0.125  # of a chip whose pixels are four times as large as the lens's blur is made for
)
WITHIN_SIGMAS = 3.5  # of 36 numbers


def test_a_small_disc_is_found_in_fewer_sections_and_its_sigma_holds() -> None:
    pulls = []
    for turn in range(6):
        pose = facing(SMALL_M, [3.0 * turn, 8.0, 15.0 * turn], (0.003 * turn, 0.0))
        raw = raw_image(DotScene(pose, blur_px=SMALL_BLUR_PX))
        outlines = outlines_of(pose)
        assert outlines.radii_px.max() < 5.0
        for index in range(3):
            disc = fitted(raw, outlines, index)
            assert isinstance(disc, LitDisc), disc
            pulls.append(disc.shift_px / np.sqrt(np.diag(disc.covariance_px2)))
            assert np.sqrt(np.trace(disc.covariance_px2)) < 0.2
    assert np.abs(pulls).max() < WITHIN_SIGMAS

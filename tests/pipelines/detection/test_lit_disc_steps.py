"""The steps by which a painted disc is found, each against its closed form or made-up edges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Floats
from models.sensors.bayer_mosaic import RGGB
from models.sensors.camera_chip import Detector
from pipelines.detection import edge_band, lit_disc
from pipelines.detection.edge_band import EdgeBand, FoundEdge, find_edge
from pipelines.detection.lit_disc import KnownDisc, LitDisc
from pipelines.detection.pixel_edge import edge_signal

DETECTOR = Detector(mosaic="rggb")
SHAPE = np.array([[400.0, 90.0], [90.0, 225.0]])  # a leaning ellipse, some 17 px
RADIUS = float(np.linalg.det(SHAPE) ** 0.25)
TURNS = 2.0 * np.pi * (np.arange(24) + 0.5) / 24
NOISE = (4.0, 0.3, 0.01)


def test_noise_terms_are_the_detectors_noise() -> None:
    a, b, c = lit_disc.noise_terms(DETECTOR)
    level = np.array([0.0, 10.0, 400.0, 3000.0])
    response = DETECTOR.prnu * level
    drawn = DETECTOR.noise_dn(level + DETECTOR.bias_dn) ** 2
    np.testing.assert_allclose(a + b * level + (c * level) ** 2, drawn + response**2, rtol=1e-9)


def test_sections_face_outward_and_grow_by_the_ellipses_support() -> None:
    """The support of an ellipse d' S^-1 d = 1 along a unit normal n is sqrt(n' S n)."""
    ways = lit_disc._ways(SHAPE, TURNS)
    np.testing.assert_allclose(np.linalg.norm(ways.normals, axis=1), 1.0)
    support = np.sqrt(np.einsum("ni,ij,nj->n", ways.normals, SHAPE, ways.normals))
    np.testing.assert_allclose(ways.growth_px, support)
    root = np.linalg.cholesky(SHAPE)
    place = np.stack([np.cos(TURNS), np.sin(TURNS)], axis=1) @ root.T
    beside = np.stack([np.cos(TURNS + 1e-5), np.sin(TURNS + 1e-5)], axis=1) @ root.T
    along = beside - place
    np.testing.assert_allclose((along * ways.normals).sum(axis=1), 0.0, atol=1e-7)
    assert ((ways.normals * place).sum(axis=1) > 0.0).all()


@pytest.mark.parametrize(
    ("radius_px", "sections"),
    [(3.0, 8), (7.5, 10), (12.0, 16), (20.0, 16), (25.0, 20), (40.0, 31), (70.0, 48)],
)
def test_a_rim_has_a_section_every_eight_pixels_and_a_small_one_fewer(
    radius_px: float, sections: int
) -> None:
    """16 at a radius of 12 px and in proportion below, 8 at least; 2 pi r / 8 above, to 48."""
    assert lit_disc._section_count(radius_px) == sections


def test_a_pixel_belongs_to_the_section_of_its_angle() -> None:
    """By the angle on the circle that the ellipse was, counted from +x towards +y."""
    root = np.linalg.cholesky(SHAPE)
    for share in (0.4, 1.3):
        place = share * np.stack([np.cos(TURNS), np.sin(TURNS)], axis=1) @ root.T
        found = lit_disc._sections(SHAPE, place[:, 0], place[:, 1], 24)
        assert found.tolist() == list(range(24))
    just_below = lit_disc._sections(np.eye(2), np.array([1.0]), np.array([-1e-17]), 24)
    assert just_below.max() <= 23


@pytest.mark.parametrize("low", [(0, 0), (1, 0), (0, 1), (3, 5)])
def test_white_balance_makes_a_face_of_one_level_wherever_it_is_cut_out(
    low: tuple[int, int],
) -> None:
    """Each of the mosaic's colours is told by its absolute row and column."""
    rows, columns = np.mgrid[low[1] : low[1] + 12, low[0] : low[0] + 14]
    colour = np.array(RGGB)[rows % 2, columns % 2]
    level = np.array([600.0, 900.0, 300.0])[colour]
    gain = lit_disc._balance(level, np.ones(level.shape, bool), np.array(low), DETECTOR)
    np.testing.assert_allclose(level * gain, 900.0)
    assert lit_disc._balance(level, np.zeros(level.shape, bool), np.array(low), DETECTOR) is None
    assert lit_disc._balance(1e-3 * level, level > 0, np.array(low), DETECTOR) is None
    grey = replace(DETECTOR, mosaic="none")
    np.testing.assert_array_equal(lit_disc._balance(level, level > 0, np.array(low), grey), 1.0)


def test_the_band_is_the_pixels_within_its_width_of_the_rim() -> None:
    """Depth to first order of the ellipse's equation, positive inside; full pixels are left out."""
    centre = np.array([40.3, 33.8])
    raw = np.full((70, 80), 1000, dtype=np.uint16)
    raw[34, 57] = 4000  # inside the rim to the right
    grey = replace(DETECTOR, mosaic="none", bias_dn=100.0)
    band = lit_disc._band(raw, grey, 3900.0, centre, SHAPE, RADIUS, 2.5)
    assert isinstance(band, EdgeBand)
    v, u = np.mgrid[:70, :80]
    away = np.stack([u, v], axis=-1) - centre
    ellipse = np.sqrt(np.einsum("...i,ij,...j->...", away, np.linalg.inv(SHAPE), away))
    slope = np.linalg.norm(away @ np.linalg.inv(SHAPE), axis=-1) / ellipse
    depth = (1.0 - ellipse) / slope
    inside = (np.abs(depth) <= 2.5) & (raw < 3900)
    assert len(band.depth_px) == inside.sum()
    np.testing.assert_allclose(band.depth_px, depth[inside])
    np.testing.assert_allclose(band.level, 900.0)
    np.testing.assert_allclose(band.gain, 1.0)
    outward = (band.normals * away[inside]).sum(axis=1)
    assert (outward > 0.0).all()
    np.testing.assert_allclose(np.linalg.norm(band.normals, axis=1), 1.0)
    assert band.sections == lit_disc._section_count(RADIUS)
    assert band.section.min() == 0
    assert band.section.max() == band.sections - 1
    strip = lit_disc._band(raw, grey, 3900.0, np.array([-21.0, 33.0]), SHAPE, RADIUS, 2.5)
    assert strip == "it lies outside the image"  # three columns of it are inside
    outside = lit_disc._band(raw, grey, 3900.0, centre - 100.0, SHAPE, RADIUS, 2.5)
    assert outside == "it lies outside the image"
    at_edge = lit_disc._band(raw, grey, 3900.0, np.array([2.0, 3.0]), SHAPE, RADIUS, 2.5)
    assert isinstance(at_edge, EdgeBand)
    assert lit_disc._band(raw, grey, 900.0, centre, SHAPE, RADIUS, 2.5) != at_edge


def test_the_band_of_a_mosaic_is_balanced() -> None:
    colour = np.array(RGGB)[np.arange(70)[:, None] % 2, np.arange(80) % 2]
    raw = (np.array([600.0, 900.0, 300.0])[colour] + DETECTOR.bias_dn).astype(np.uint16)
    band = lit_disc._band(raw, DETECTOR, 3900.0, np.array([40.3, 33.8]), SHAPE, RADIUS, 2.5)
    assert isinstance(band, EdgeBand)
    np.testing.assert_allclose(band.level, 900.0)
    assert set(np.round(band.gain, 6)) == {1.5, 1.0, 3.0}


def made_edge(offset: Floats, **changes: Floats) -> FoundEdge:
    count = len(offset)
    edge = FoundEdge(
        offset, np.full(count, 0.02), np.full(count, 900.0), np.full(count, 3.0),
        np.full(count, 0.01), 0.6,
    )  # fmt: skip
    return replace(edge, **changes)


WAYS = lit_disc._ways(SHAPE, TURNS)
KNOWN = KnownDisc(0.05)
DESIGN = np.column_stack([WAYS.normals, WAYS.growth_px])


def centre_of(found: FoundEdge, known: KnownDisc = KNOWN) -> LitDisc | str:
    return lit_disc._centre(found, WAYS, known, RADIUS, 5.0)


def test_sections_that_agree_give_the_shift_and_the_size() -> None:
    disc = centre_of(made_edge(DESIGN @ [0.6, -0.4, 0.01]), KnownDisc(1e6))
    assert isinstance(disc, LitDisc)
    np.testing.assert_allclose(disc.shift_px, [0.6, -0.4], atol=1e-9)
    assert disc.size == pytest.approx(1.01, abs=1e-9)
    assert disc.rim == 1.0
    assert disc.misfit_chi2 == pytest.approx(0.0, abs=1e-12)
    assert (disc.blur_px, disc.level_dn) == (0.6, 900.0)


def test_the_covariance_is_that_of_weighted_least_squares_and_two_floors() -> None:
    """A prior on the size, a floor a section, one of the disc's other tilt, and one of light."""
    disc = centre_of(made_edge(DESIGN @ [0.1, 0.2, 0.0]), KnownDisc(0.05, shape_sigma=0.002))
    variance = 0.02**2 + 0.004**2 + (0.002 * RADIUS) ** 2
    normal = DESIGN.T @ DESIGN / variance + np.diag([0.0, 0.0, 0.05**-2])
    floor = 0.003**2 + (7e-4 * RADIUS) ** 2
    expected = np.linalg.inv(normal)[:2, :2] + floor * np.eye(2)
    assert isinstance(disc, LitDisc)
    np.testing.assert_allclose(disc.covariance_px2, expected, rtol=1e-9)


def test_scatter_beyond_their_noise_widens_it_by_chi_square() -> None:
    rng = np.random.default_rng(3)
    rough = 0.05 * rng.choice([-1.0, 1.0], 24)
    disc = centre_of(made_edge(DESIGN @ [0.1, 0.2, 0.0] + rough), KnownDisc(1e6))
    assert isinstance(disc, LitDisc)
    variance = 0.02**2 + 0.004**2
    left = rough - DESIGN @ np.linalg.lstsq(DESIGN, rough, rcond=None)[0]
    chi2 = float(left @ left) / variance / (24 - 3)
    assert disc.rim == 1.0
    assert disc.misfit_chi2 == pytest.approx(chi2, rel=1e-6)
    floor = 0.003**2 + (7e-4 * RADIUS) ** 2
    bare = np.linalg.inv(DESIGN.T @ DESIGN / variance)[:2, :2]
    np.testing.assert_allclose(disc.covariance_px2, chi2 * bare + floor * np.eye(2), rtol=1e-6)


def test_sections_that_lie_off_the_others_are_left_out() -> None:
    offset = DESIGN @ [0.3, -0.2, 0.0]
    offset[[4, 5, 6]] += [1.0, -1.2, 0.9]
    disc = centre_of(made_edge(offset))
    assert isinstance(disc, LitDisc)
    np.testing.assert_allclose(disc.shift_px, [0.3, -0.2], atol=1e-6)
    assert disc.rim == pytest.approx(21 / 24)


@pytest.mark.parametrize("what", ["sigma_px", "step_dim", "misfit", "outside", "inside"])
def test_a_section_that_does_not_show_its_edge_clearly_says_nothing(what: str) -> None:
    """No sigma, a step below eight of its own sigmas, a misfit of 6 %, an edge at the band's rim.

    One that misfits takes its two neighbours along: a shadow's border crosses them, too.
    """
    offset = DESIGN @ [0.3, -0.2, 0.0]
    changes: dict[str, Floats] = {}
    if what == "sigma_px":
        changes["sigma_px"] = np.where(np.arange(24) == 7, np.inf, 0.02)
    elif what == "step_dim":
        changes["step"] = np.where(np.arange(24) == 7, 23.9, 900.0)
    elif what == "misfit":
        changes["misfit"] = np.where(np.arange(24) == 7, 0.061, 0.059)
    else:
        offset[7] = 4.01 if what == "outside" else -4.01
    left_out = 3 if what == "misfit" else 1
    disc = centre_of(made_edge(offset, **changes))
    assert isinstance(disc, LitDisc)
    assert disc.rim == pytest.approx((24 - left_out) / 24)
    np.testing.assert_allclose(disc.shift_px, [0.3, -0.2], atol=1e-6)


def test_of_a_row_of_sections_that_misfit_both_ends_take_a_neighbour_along() -> None:
    misfit = np.full(24, 0.01)
    misfit[[22, 23, 0]] = 0.5
    disc = centre_of(made_edge(np.zeros(24), misfit=misfit))
    assert isinstance(disc, LitDisc)
    assert disc.rim == pytest.approx(19 / 24)


def test_a_rim_of_which_too_little_shows_is_refused_in_words() -> None:
    for shown, enough in ((8, False), (9, True)):  # 0.35 of 24 is 8.4
        step = np.where(np.arange(24) < shown, 900.0, 1.0)
        told = centre_of(made_edge(np.zeros(24), step=step))
        assert isinstance(told, LitDisc) == enough
        assert enough or told == "only 33 % of its rim shows, lit evenly"
    nothing = centre_of(made_edge(np.zeros(24), step=np.zeros(24)))
    assert nothing == "nothing shows of its rim"


def test_small_discs_may_misfit_more() -> None:
    """Below a radius of 12 px in proportion: at 6 px twice the 6 %."""
    for misfit, enough in ((0.119, True), (0.121, False)):
        found = made_edge(np.zeros(24), misfit=np.full(24, misfit))
        told = lit_disc._centre(found, WAYS, KNOWN, 6.0, 5.0)
        assert isinstance(told, LitDisc) == enough


def drawn_band(
    offset: Floats, step: Floats, outside: Floats, blur: float
) -> tuple[EdgeBand, Floats]:
    """Draw sections of an edge as the model has them, 60 pixels each, without noise."""
    rng = np.random.default_rng(4)
    count, own = len(offset), 60
    place = np.repeat(np.arange(count), own)
    depth = rng.uniform(-5.0, 5.0, count * own)
    turn = rng.uniform(0.0, 2.0 * np.pi, count * own)
    normals = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    edge = edge_signal(depth + offset[place], normals[:, 0], normals[:, 1], 30.0, blur)
    level = outside[place] + step[place] * edge.value
    return EdgeBand(place, depth, normals, level, np.ones(len(depth)), count), level


def test_an_edge_drawn_is_the_edge_found() -> None:
    """Each section with its own place and levels, all with one blur."""
    offset = np.array([0.0, 0.7, -0.9, 0.3, -0.2, 0.5])
    step = np.array([900.0, 300.0, 600.0, 1500.0, 800.0, 700.0])
    outside = np.array([50.0, 20.0, 200.0, 0.0, 90.0, 10.0])
    band, _ = drawn_band(offset, step, outside, 0.8)
    found = find_edge(band, 5.0, 30.0, 0.8, NOISE)
    np.testing.assert_allclose(found.offset_px, offset, atol=6e-3)  # four steps from the start
    np.testing.assert_allclose(found.step, step, rtol=3e-3)
    assert found.blur_px == pytest.approx(0.8, abs=0.01)
    assert (found.misfit < 0.01).all()
    told_wrong = find_edge(band, 5.0, 30.0, 0.6, NOISE)
    assert told_wrong.blur_px == pytest.approx(0.8, abs=0.03)


def test_the_sigma_of_an_edge_is_least_squares_own() -> None:
    """By the Jacobian of the model, numerically, and the variance of every pixel's level."""
    offset, step, outside = np.array([0.2]), np.array([700.0]), np.array([60.0])
    band, level = drawn_band(offset, step, outside, 0.8)
    found = find_edge(band, 5.0, 30.0, 0.8, NOISE)
    columns = []
    for number, start in enumerate((outside, step, offset)):
        ends = []
        for sign in (1.0, -1.0):
            moved = [outside.copy(), step.copy(), offset.copy()]
            moved[number] = start + sign * 1e-4
            ends.append(drawn_band(moved[2], moved[1], moved[0], 0.8)[1])
        columns.append((ends[0] - ends[1]) / 2e-4)
    jacobian = np.stack(columns, axis=1)
    a, b, c = NOISE
    weight = 1.0 / (a + b * level + (c * level) ** 2)
    covariance = np.linalg.inv((jacobian * weight[:, None]).T @ jacobian)
    assert found.sigma_px[0] == pytest.approx(np.sqrt(covariance[2, 2]), rel=0.01)
    assert found.step_sigma[0] == pytest.approx(np.sqrt(covariance[1, 1]), rel=0.01)


def test_noise_beyond_what_was_told_widens_the_sigma_and_less_does_not_narrow_it() -> None:
    band, level = drawn_band(np.array([0.1]), np.array([600.0]), np.array([30.0]), 0.8)
    rough = replace(band, level=level + 5.0 * np.where(np.arange(len(level)) % 2 == 0, 1.0, -1.0))
    as_told, half_told = (
        find_edge(rough, 5.0, 30.0, 0.8, (variance, 0.0, 0.0)) for variance in (1e4, 6.25)
    )
    chi2 = 25.0 / 6.25 * 60 / 57
    assert half_told.sigma_px[0] / as_told.sigma_px[0] == pytest.approx(
        np.sqrt(chi2 * 6.25 / 1e4), rel=0.05
    )
    assert as_told.misfit[0] == 0.0


def test_the_blur_is_a_compromise_of_what_was_told_and_what_is_seen() -> None:
    """Told 0.6 to half of it, drawn 0.9: what is told counts the more, the less is seen."""
    band, _ = drawn_band(np.zeros(1), np.array([600.0]), np.array([30.0]), 0.9)
    seen = [
        find_edge(band, 5.0, 30.0, 0.6, (variance, 0.0, 0.0)).blur_px
        for variance in (1.0, 3e4, 1e5, 1e9)
    ]
    assert seen[0] == pytest.approx(0.9, abs=0.02)
    assert seen[3] == pytest.approx(0.6, abs=0.005)
    assert seen[0] > seen[1] > seen[2] > seen[3]


def test_what_no_edge_explains_is_a_misfit_over_the_step() -> None:
    """A chequer of 30 DN on a step of 600 is one of 5 %; few pixels tell nothing."""
    band, level = drawn_band(np.array([0.1]), np.array([600.0]), np.array([30.0]), 0.8)
    chequer = 30.0 * np.where(np.arange(len(level)) % 2 == 0, 1.0, -1.0)
    found = find_edge(replace(band, level=level + chequer), 5.0, 30.0, 0.8, (1.0, 0.0, 0.0))
    assert found.misfit[0] == pytest.approx(0.05, rel=0.1)
    few = np.arange(7)
    short = EdgeBand(
        band.section[few], band.depth_px[few], band.normals[few], level[few], np.ones(7), 1
    )
    assert find_edge(short, 5.0, 30.0, 0.8, NOISE).sigma_px[0] == np.inf
    nowhere = replace(band, section=np.ones(len(level), dtype=np.int64), sections=2)
    assert find_edge(nowhere, 5.0, 30.0, 0.8, NOISE).sigma_px[0] == np.inf


def test_the_search_begins_at_the_share_of_the_band_that_is_bright() -> None:
    """Half of it: no offset; three quarters: half the width outward."""
    depth = np.linspace(-4.0, 4.0, 801)
    for bright_from, expected in ((0.0, 0.0), (-2.0, 2.0), (1.0, -1.0), (-3.9, 3.0)):
        level = np.where(depth > bright_from, 500.0, 100.0)
        band = EdgeBand(
            np.zeros(801, dtype=np.int64), depth, np.tile([1.0, 0.0], (801, 1)), level,
            np.ones(801), 1,
        )  # fmt: skip
        outside, step, offset = edge_band._start(band, 4.0)
        if abs(bright_from) < 2.4:
            assert outside[0] == 100.0
            assert step[0] == 400.0
            assert offset[0] == pytest.approx(expected, abs=0.02)
        assert abs(offset[0]) <= 3.0


def test_a_levels_variance_is_of_the_charge_before_it_was_multiplied() -> None:
    """A gain g turns a variance v of charge into g^2 v: reading g^2, charge g, response 1."""
    level, gain = np.array([0.0, 200.0, 1000.0]), np.array([1.0, 1.5, 0.8])
    own = level / gain
    expected = gain**2 * (NOISE[0] + NOISE[1] * own + (NOISE[2] * own) ** 2)
    np.testing.assert_allclose(edge_band._variance(level, gain, NOISE), expected)
    assert edge_band._variance(np.zeros(1), np.zeros(1), NOISE)[0] == 1e-6

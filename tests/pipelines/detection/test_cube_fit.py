"""A corner cube's centre: cubes are made by following rays through glass, not by our formula."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from models.arrays import Floats
from models.camera import Camera
from models.markers import CornerCubes, MarkerPattern
from models.spacecraft.retroreflector_optics import cubes_behind
from pipelines.detection.cube_model import CubeFace
from pipelines.detection.cube_template import CubeTemplate, cube_template
from pipelines.detection.disc_fit import DiscFit, ExpectedBlur, fit_appearance
from pipelines.detection.disc_model import DiscParameters
from pipelines.detection.disc_outline import disc_outlines
from pipelines.detection.disc_window import cut_window
from pipelines.detection.image_difference import saturation_level_dn
from pipelines.detection.image_pair import image_pair
from tests.support.synthetic_pair import Scene, expected_pair, facing_pose

SMALL = Camera.from_fov(80, 80, 3.0)
NORMAL = np.array([[0.0, 0.0, 1.0]])
KNOWN = cubes_behind(NORMAL)
ONE = MarkerPattern(("1",), np.zeros((1, 3)), NORMAL, 0.0127, cubes=KNOWN)
BLUR = ExpectedBlur(psf_sigma_px=0.5, tolerance_px=0.25, start_px=0.5)
VIEWS = ((4.2, 8.0), (15.5, 20.0))  # radius in px, incidence in deg: at 6.7 m and at 1.8 m
RUNS = 8
SCATTER_PX = 0.004  # at either end; the noise alone is 0.002 and 0.001
FLOOR_PX = 0.0015  # what the pipeline adds, for what is left of pixels


def told(**changes: object) -> MarkerPattern:
    """Return the pattern with other cubes."""
    values = {
        "refractive_index": KNOWN.refractive_index,
        "edge_share": KNOWN.edge_share,
        "edges_in_target": KNOWN.edges_in_target,
    }
    return replace(ONE, cubes=CornerCubes(**(values | changes)))  # type: ignore[arg-type]


def template_of(markers: MarkerPattern, radius_px: float, tilt_deg: float) -> CubeTemplate:
    """Return the template of a cube in the image's middle."""
    range_m = SMALL.fx * ONE.radius_m / radius_px
    pose = facing_pose(range_m, (180.0 - tilt_deg, 0.0, 0.0), np.zeros(3))
    outlines = disc_outlines(SMALL, pose, markers)
    half_extent = np.sqrt(np.diag(outlines.shapes_px2[0]))
    made = cube_template(SMALL, pose, markers, 0, outlines.centres_px[0], half_extent)
    assert made is not None
    return made


def fits(
    radius_px: float,
    tilt_deg: float,
    markers: MarkerPattern = ONE,
    runs: int = RUNS,
    **scene: object,
) -> tuple[Floats, list[DiscFit]]:
    """Return errors (n, 2) px and fits of a cube at all phases and turns, seen with noise."""
    rng = np.random.default_rng(3)
    range_m = SMALL.fx * ONE.radius_m / radius_px
    errors, found = [], []
    for run in range(runs):
        offset = rng.uniform(-1.0, 1.0, 2) * range_m / SMALL.fx
        turn = (180.0 - tilt_deg, 0.0, rng.uniform(-40.0, 40.0))
        pose = facing_pose(range_m, turn, np.zeros(3), (offset[0], offset[1]))
        seen = Scene(
            camera=SMALL,
            markers=ONE,
            **({"cubes": KNOWN, "supersampling": 10, "prnu": 0.005} | scene),  # type: ignore[arg-type]
        )
        pair = image_pair(expected_pair(seen, pose).exposed(run))
        guess = rng.uniform(-0.3, 0.3, 2)
        outlines = disc_outlines(SMALL, pose, markers)
        centre, shape = outlines.centres_px[0] + guess, outlines.shapes_px2[0]
        half_extent = np.sqrt(np.diag(shape))
        template = cube_template(SMALL, pose, markers, 0, centre, half_extent)
        level = saturation_level_dn(seen.detector)
        window = cut_window(pair.image_800, pair.image_850, centre, half_extent, level)
        assert template is not None
        assert window is not None
        face = CubeFace(template, np.linalg.inv(shape), float(outlines.radii_px[0]))
        fit = fit_appearance(window, face, seen.detector, BLUR)
        assert fit is not None
        errors.append(fit.parameters.centre_px + guess)
        found.append(fit)
    return np.array(errors), found


def nees(errors: Floats, found: list[DiscFit]) -> float:
    """Return the mean squared error over its stated variance, per axis."""
    variances = [np.diag(fit.covariance_px2) + FLOOR_PX**2 for fit in found]
    return float(np.mean(errors**2 / np.array(variances)))


def test_the_templates_aperture_is_the_closed_forms() -> None:
    """Arnold 1979: ``(2/pi) (asin mu - mu sqrt(2) tan t)``, the overlap of two circles."""
    for tilt_deg in (0.0, 10.0, 25.0):
        template = template_of(told(edge_share=0.0), 15.5, tilt_deg)
        tangent = np.tan(np.arcsin(np.sin(np.deg2rad(tilt_deg)) / KNOWN.refractive_index))
        mu = np.sqrt(1.0 - 2.0 * tangent**2)
        share = 2.0 / np.pi * (np.arcsin(mu) - mu * np.sqrt(2.0) * tangent)
        grid = 2e-3  # cells of a sixtieth of the radius
        assert template.aperture_share == pytest.approx(share, abs=grid)


def test_edges_take_their_light_from_the_aperture() -> None:
    """At normal incidence: seams on both sides of the middle, over a round aperture."""
    whole = template_of(told(edge_share=0.0), 15.5, 0.0)
    seamed = template_of(told(edges_in_target=None), 15.5, 0.0)
    taken = seamed.edges.sum() / seamed.face.sum()
    assert 0.0 < taken < 0.5 * whole.aperture_share
    assert seamed.aperture_share == pytest.approx(whole.aperture_share - taken, abs=2e-3)


def test_edges_that_nobody_knows_the_turn_of_take_as_much_light() -> None:
    """In the mean over all turns, at normal incidence and aslant."""
    for tilt_deg in (0.0, 20.0):
        edges = [
            np.array([[np.cos(turn), np.sin(turn), 0.0]])
            for turn in np.deg2rad(np.arange(0.0, 60.0, 5.0))
        ]
        known = [template_of(told(edges_in_target=edge), 15.5, tilt_deg) for edge in edges]
        unknown = template_of(told(edges_in_target=None), 15.5, tilt_deg)
        mean = np.mean([template.edges.sum() for template in known])
        few_turns = 0.03
        assert unknown.edges.sum() == pytest.approx(mean, rel=few_turns)


def test_the_design_is_the_models_derivative() -> None:
    template = template_of(ONE, 4.2, 12.0)
    face = CubeFace(template, np.eye(2) / 4.2**2, 4.2)
    x, y = np.arange(-9.0, 10.0)[None, :] + 0.2, np.arange(-9.0, 10.0)[:, None] - 0.1
    at = DiscParameters(
        np.array([0.1, -0.2]),
        1.02,
        0.4,
        0.03,
        2000.0,
        np.array([8.0, -5.0]),
        12.0,
        np.array([0.3, 0.8]),
    )
    _, design = face.model(x, y, at)
    for index in range(len(design)):
        step = np.zeros(len(design))
        step[index] = 1e-5
        after, before = (face.model(x, y, at.moved(sign * step))[0] for sign in (1.0, -1.0))
        numeric = (after - before) / 2e-5
        rounding = 1e-5 * float(np.abs(numeric).max())
        np.testing.assert_allclose(design[index], numeric, atol=rounding)


@pytest.mark.parametrize(("radius_px", "tilt_deg"), VIEWS)
def test_a_cube_is_found_as_well_as_its_noise_allows_and_says_so(
    radius_px: float, tilt_deg: float
) -> None:
    errors, found = fits(radius_px, tilt_deg)
    assert np.sqrt(np.mean(errors**2)) < SCATTER_PX
    assert nees(errors, found) < chi2.ppf(0.9995, errors.size) / errors.size
    assert np.median([fit.misfit_chi2 for fit in found]) < 1.5
    # What was simulated comes out: size, blur, and no even light.
    assert np.median([fit.parameters.size for fit in found]) == pytest.approx(1.0, abs=0.01)
    assert np.median([fit.parameters.blur_px for fit in found]) == pytest.approx(0.5, abs=0.03)
    assert np.median([fit.parameters.shares[0] for fit in found]) == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize(
    ("markers", "sight"),
    [
        (replace(ONE, radius_m=1.02 * ONE.radius_m), {}),
        (told(edges_in_target=None), {}),
        (told(edges_in_target=np.array([[np.cos(0.26), np.sin(0.26), 0.0]])), {}),
        (told(refractive_index=1.5), {}),
        (ONE, {"even_share": 1.0}),
        (ONE, {"even_share": 0.3}),
        (ONE, {"gradient": 0.04, "gradient_deg": 30.0}),
    ],
    ids=["2 % too large", "no turn told", "15 deg off", "glass", "even", "half even", "ramp"],
)
def test_a_cube_known_wrongly_is_found_no_worse_and_nobody_is_misled(
    markers: MarkerPattern, sight: dict[str, object]
) -> None:
    """What differs alike on both sides of the centre does not pull it, nor widen it much."""
    errors, found = fits(8.0, 15.0, markers, runs=6, **sight)
    assert np.sqrt(np.mean(errors**2)) < SCATTER_PX
    assert nees(errors, found) < chi2.ppf(0.9995, errors.size) / errors.size
    stated = np.sqrt(np.mean([np.trace(fit.covariance_px2) / 2.0 for fit in found]))
    assert stated < 2.0 * SCATTER_PX


@pytest.mark.parametrize("radius_px", [4.2, 8.0])
@pytest.mark.parametrize("share", [0.05, 0.1, 0.15])
def test_a_cut_cube_says_so(radius_px: float, share: float) -> None:
    errors, found = fits(radius_px, 12.0, runs=3, cut={0: share})
    for error, fit in zip(errors, found, strict=True):
        assert error @ np.linalg.solve(fit.covariance_px2, error) < chi2.ppf(0.999, 2)

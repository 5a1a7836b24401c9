"""Defocus: the circle of a thin lens, discs that are as wide as they say, and no light lost."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arrays import Floats
from models.camera import Camera, camera_preset
from models.errors import ScenarioError
from models.sensors.camera_chip import Detector, Optics
from renders.batches.replay import exposed_frames
from renders.detector.defocus import circle_of_confusion_px, defocused, disc
from renders.detector.expose import mean_electrons
from tests.renders.conftest import TinyDataset
from tests.support.frame_images import at_800, at_850, stored_frames

CAMERA = camera_preset("chaser_fixed")
DETECTOR = Detector()
FOCAL_M = CAMERA.fx * 13.5e-6
ROUNDING = 1e-9


def circle(depth_m: float, optics: Optics, camera: Camera = CAMERA) -> float:
    return float(circle_of_confusion_px(np.array([[depth_m]]), optics, camera, DETECTOR)[0, 0])


@given(
    depth=st.floats(0.5, 50.0),
    focus=st.floats(0.3, 20.0),
    f_number=st.floats(1.4, 22.0),
)
def test_the_circle_is_the_thin_lenss(depth: float, focus: float, f_number: float) -> None:
    """By the lens equation: the chip stands where the focus is imaged, and cuts the cone there."""
    chip_m = 1.0 / (1.0 / FOCAL_M - 1.0 / focus)
    image_m = 1.0 / (1.0 / FOCAL_M - 1.0 / depth)
    cone_m = FOCAL_M / f_number * abs(chip_m - image_m) / image_m
    found = circle(depth, Optics(f_number=f_number, focus_m=focus))
    assert found == pytest.approx(cone_m / 13.5e-6, rel=1e-9, abs=1e-9)


def test_at_the_hyperfocal_distance_space_and_half_of_it_are_one_circle() -> None:
    """f/16 and a pixel for a circle: 4.1 m, from 2.05 m to the stars."""
    hyperfocal_m = FOCAL_M**2 / (16.0 * 13.5e-6) + FOCAL_M
    assert hyperfocal_m == pytest.approx(4.1, abs=0.02)
    optics = Optics(focus_m=hyperfocal_m)
    assert circle(0.0, optics) == pytest.approx(1.0)  # space
    assert circle(1e9, optics) == pytest.approx(1.0)
    assert circle(0.5 * hyperfocal_m, optics) == pytest.approx(1.0)
    assert circle(hyperfocal_m, optics) == 0.0


def test_the_circle_on_the_chip_does_not_know_how_it_is_sampled() -> None:
    """Half the columns, pixels twice as wide: the same micrometres."""
    optics = Optics(focus_m=2.0, f_number=4.0)
    half = CAMERA.resized(1024)
    coarse = circle_of_confusion_px(
        np.array([[5.0]]), optics, half, replace(DETECTOR, pixel_pitch_um=27.0)
    )
    assert coarse[0, 0] == pytest.approx(0.5 * circle(5.0, optics))


def moments(image: Floats, row: float, column: float) -> tuple[float, float]:
    v, u = np.mgrid[0 : image.shape[0], 0 : image.shape[1]]
    total = image.sum()
    return (
        float((image * (v - row) ** 2).sum() / total),
        float((image * (u - column) ** 2).sum() / total),
    )


@given(diameter=st.floats(0.05, 30.0))
def test_a_point_is_spread_by_the_variance_of_its_disc(diameter: float) -> None:
    """An even disc has c^2 / 16 along each axis; at any size, down to a part of a pixel."""
    image = np.zeros((61, 65))
    image[30, 31] = 5e4
    found = defocused(image, np.full(image.shape, diameter))
    assert found.sum() == pytest.approx(5e4, rel=ROUNDING)
    for variance in moments(found, 30.0, 31.0):
        assert variance == pytest.approx(diameter**2 / 16.0, rel=1e-6)


@pytest.mark.parametrize("radius", [1.0, 2.0, 3.5, 9.0, 20.0])
def test_a_disc_is_even_within_and_ends(radius: float) -> None:
    kernel = disc(radius)
    middle = len(kernel) // 2
    v, u = np.mgrid[-middle : middle + 1, -middle : middle + 1]
    away = np.hypot(u, v)
    assert kernel.min() >= 0.0
    assert kernel.sum() == pytest.approx(1.0, rel=ROUNDING)
    assert (kernel[away > radius + 0.75] == 0.0).all()
    inner = kernel[(away > 0.0) & (away < radius - 0.8)]
    np.testing.assert_allclose(inner, 1.0 / (np.pi * radius**2), rtol=0.25 / radius)


def test_in_focus_nothing_changes() -> None:
    image = np.random.default_rng(0).random((20, 30))
    np.testing.assert_array_equal(defocused(image, np.zeros_like(image)), image)


@given(seed=st.integers(0, 10_000))
def test_no_light_is_gained_or_lost_whatever_the_depths(seed: int) -> None:
    rng = np.random.default_rng(seed)
    image = rng.random((30, 40)) * 1e4
    circles = rng.choice([0.0, 0.3, 1.9, 5.0, 12.0], size=image.shape) * rng.random()
    found = defocused(image, circles)
    assert found.sum() == pytest.approx(image.sum(), rel=ROUNDING)
    assert found.min() >= 0.0


def test_an_even_field_at_one_depth_stays_even() -> None:
    found = defocused(np.full((40, 50), 7.0), np.full((40, 50), 6.3))
    np.testing.assert_allclose(found, 7.0, rtol=ROUNDING)


def test_what_is_in_focus_stays_sharp_beside_what_is_not() -> None:
    image, circles = np.zeros((40, 80)), np.zeros((40, 80))
    image[20, 15] = image[20, 60] = 1.0
    circles[:, 40:] = 8.0
    found = defocused(image, circles)
    assert found[20, 15] == pytest.approx(1.0, rel=ROUNDING)
    assert found[20, 60] == pytest.approx(1.0 / (16.0 * np.pi), rel=0.1)
    rim = 0.4  # pixels that the disc touches in part, of those it covers
    assert (found[:, 40:] > ROUNDING).sum() == pytest.approx(16.0 * np.pi, rel=rim)


# In the chain


def test_a_lens_with_a_focus_needs_depth_and_one_without_does_not() -> None:
    camera = Camera.from_fov(64, 64, 50.0)
    rate = np.zeros((64, 64), np.float32)
    rate[32, 32] = 1e6
    focused = Optics(psf_sigma_px=0.5, vignetting=False, focus_m=0.5, f_number=2.0)
    detector = replace(DETECTOR, prnu=0.0, dark_current_e_s=0.0)
    with pytest.raises(ScenarioError, match="needs, got light alone"):
        mean_electrons(rate, 1.0, camera, focused, detector)
    far = np.full((64, 64), 1e3, np.float32)
    charge = mean_electrons(rate, 1000.0, camera, focused, detector, far)
    diameter = circle_of_confusion_px(far, focused, camera, detector)[0, 0]
    single_precision = 1e-4
    for variance in moments(charge, 32.0, 32.0):  # two blurs, one after the other
        expected = diameter**2 / 16.0 + 0.25
        assert variance == pytest.approx(expected, rel=single_precision)
    assert Optics().focus_m == 0.0


def test_a_dataset_with_a_focus_is_blurred_and_replayed_to_the_same_bits(
    rendered_once: TinyDataset, tmp_path: Path
) -> None:
    """The light of ``tiny`` through a fast lens focused far before the target."""
    scenario = rendered_once.world.scenario
    case = tmp_path / "defocused.toml"
    update = {"focus_m": 0.5, "f_number": 1.0}
    optics = scenario.optics.model_copy(update=update)
    case.write_text(scenario.model_copy(update={"optics": optics}).to_toml())
    shutil.copytree(rendered_once.store.folder, tmp_path / "store")
    request = replace(
        rendered_once.request, case=str(case), out=tmp_path / "out", store=tmp_path / "store"
    )
    dataset = TinyDataset(replace(request, end_s=240.0))
    dataset.render()
    ours = list(exposed_frames(dataset.folder, run=0)[1])
    theirs = stored_frames(dataset.folder)
    assert len(ours) == len(theirs) == 1
    np.testing.assert_array_equal(at_800(ours[0]), at_800(theirs[0]))
    np.testing.assert_array_equal(at_850(ours[0]), at_850(theirs[0]))
    sharp = stored_frames(rendered_once.folder)[0]
    steepest = [np.abs(np.diff(at_850(f).astype(int))).max() for f in (theirs[0], sharp)]
    assert steepest[0] < 0.5 * steepest[1]

"""Materials as Mitsuba carries them: what is reflected adds up to what the data say, per band."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from models.materials import BLACK, MATERIALS, BandReflectance, Material
from tests.support.small_scenes import needs_jit

MATT = Material("matt", BandReflectance(0.5, 0.4, 0.3), BLACK, 1.0, "test")
MIRROR = Material("mirror", BLACK, BandReflectance(0.9, 0.8, 0.7), 0.2, "test")
BOTH = Material("both", MATT.diffuse, BandReflectance(0.3, 0.2, 0.4), 0.2, "test")


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    needs_jit()


def loaded(material: Material, two_sided: bool = True) -> Any:
    import mitsuba as mi

    from renders.tracing.surfaces import bsdf_dict, surface_of

    return mi.load_dict(bsdf_dict(replace(surface_of(material), two_sided=two_sided)))


def seen_from(angle_deg: float, below: bool = False) -> Any:
    import mitsuba as mi

    angle = np.deg2rad(angle_deg)
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(float(np.sin(angle)), 0.0, float(np.cos(angle)) * (-1 if below else 1))
    si.wavelengths = []
    return si


def reflected(material: Material, angle_deg: float, below: bool = False) -> np.ndarray:
    """Return the hemispherical reflectance of each band, by quadrature of f cos."""
    import mitsuba as mi

    cosine = (np.arange(400) + 0.5) / 400
    phi = (np.arange(800) + 0.5) / 800 * 2.0 * np.pi
    z, turn = (part.ravel() for part in np.meshgrid(cosine, phi, indexing="ij"))
    sine = np.sqrt(1.0 - z**2)
    sign = -1.0 if below else 1.0
    wo = mi.Vector3f(np.stack([sine * np.cos(turn), sine * np.sin(turn), sign * z]))
    value = loaded(material).eval(mi.BSDFContext(), seen_from(angle_deg, below), wo, True)
    return np.asarray(value).reshape(3, -1).mean(axis=1) * 2.0 * np.pi


@pytest.mark.parametrize("angle_deg", [0.0, 40.0, 75.0])
@pytest.mark.parametrize("below", [False, True])
def test_a_matt_surface_reflects_what_its_data_say_from_both_sides(
    angle_deg: float, below: bool
) -> None:
    np.testing.assert_allclose(reflected(MATT, angle_deg, below), MATT.diffuse.bands, rtol=1e-3)


def test_a_one_sided_surface_is_black_from_behind() -> None:
    import mitsuba as mi

    bsdf = loaded(MATT, two_sided=False)
    down = mi.Vector3f(0.0, 0.0, -1.0)
    assert np.array(bsdf.eval(mi.BSDFContext(), seen_from(0.0, below=True), down, True)).max() == 0


@pytest.mark.parametrize("roughness", [0.1, 0.2, 0.5])
def test_a_rough_mirror_is_the_textbooks_ggx(roughness: float) -> None:
    """Walter et al. 2007: half angles by ``tan^2 / (alpha^2 + tan^2)``, shadowed as Smith says.

    One bounce is counted, so what would leave by several is lost: 5 % at a roughness of 0.2.
    """
    drawn = (np.arange(100_000) + 0.5) / 100_000
    half = np.arctan(roughness * np.sqrt(drawn / (1.0 - drawn)))
    up = half < 0.25 * np.pi
    smith = 2.0 / (1.0 + np.sqrt(1.0 + roughness**2 * np.tan(2.0 * half[up]) ** 2))
    expected = smith.sum() / len(drawn)
    share = reflected(replace(MIRROR, roughness=roughness), 0.0) / MIRROR.specular.bands
    np.testing.assert_allclose(share, expected, rtol=2e-3)


@pytest.mark.parametrize("angle_deg", [0.0, 40.0, 75.0])
def test_two_parts_add_up_band_by_band(angle_deg: float) -> None:
    """The blend's weights cancel: matt part and mirror part each give what they give alone."""
    alone = Material("alone", BLACK, BOTH.specular, BOTH.roughness, "test")
    expected = reflected(MATT, angle_deg) + reflected(alone, angle_deg)
    np.testing.assert_allclose(reflected(BOTH, angle_deg), expected, rtol=1e-3)


@pytest.mark.parametrize("angle_deg", [0.0, 40.0, 75.0])
def test_a_matt_part_under_glass_stays_what_it_is(angle_deg: float) -> None:
    face = BandReflectance(0.04, 0.03, 0.02)
    glass = Material("glass", BLACK, face, 0.2, "test", is_dielectric=True)
    coated = Material("coated", MATT.diffuse, face, 0.2, "test", is_dielectric=True)
    bare = replace(glass, specular=BandReflectance(0.08, 0.06, 0.04))  # of the half that is left
    expected = 0.5 * reflected(bare, angle_deg) + MATT.diffuse.bands
    np.testing.assert_allclose(reflected(coated, angle_deg), expected, rtol=2e-3)


def test_glass_glints_at_grazing_incidence_and_metal_does_not() -> None:
    cell, foil = MATERIALS["solar_cell"], MATERIALS["mli_aluminium"]
    rise = reflected(cell, 75.0) / reflected(cell, 0.0)
    assert (rise > 2.5).all()  # bare glass of that index reflects 0.26 there, and 0.06 at 0
    assert (reflected(foil, 75.0) / reflected(foil, 0.0) < 1.0).all()


def test_a_blend_is_drawn_as_it_says() -> None:
    """Mitsuba's own chi-square: directions follow the density that weighs them."""
    import drjit as dr
    import mitsuba as mi

    bsdf = loaded(BOTH)

    def sample(square: Any) -> tuple[Any, Any]:
        rest = mi.sample_tea_float32(dr.arange(mi.UInt32, dr.width(square)), 7)
        drawn, weight = bsdf.sample(mi.BSDFContext(), seen_from(30.0), rest, square, True)
        return drawn.wo, dr.select(dr.any(weight > 0.0), 1.0, 0.0)

    test = mi.chi2.ChiSquareTest(
        domain=mi.chi2.SphericalDomain(),
        sample_func=sample,
        pdf_func=lambda wo: bsdf.pdf(mi.BSDFContext(), seen_from(30.0), wo, True),
        sample_dim=2,
        sample_count=500_000,
        res=101,
    )
    assert test.run(), test.messages

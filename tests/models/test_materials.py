"""Surfaces keep energy, name their source, and agree with the optical constants they cite."""

from __future__ import annotations

import re

import numpy as np
import pytest

from models.materials import MATERIALS, BandReflectance, Material

NAMES = sorted(MATERIALS)
# Reflectances are given to three digits, two of them estimates where the source says so.
ROUNDING = 0.0006


@pytest.mark.parametrize("name", NAMES)
def test_never_reflects_more_than_it_receives(name: str) -> None:
    material = MATERIALS[name]
    total = np.array(material.diffuse.bands) + np.array(material.specular.bands)
    assert (total > 0.0).all()
    assert (total < 1.0).all()
    assert material.name == name


@pytest.mark.parametrize("name", NAMES)
def test_differs_between_the_lamps_but_little(name: str) -> None:
    # The pipeline subtracts the 800 nm image from the 850 nm one: real surfaces leave a few per
    # cent, never nothing and never a marker's worth.
    material = MATERIALS[name]
    total_800 = material.diffuse.nir800 + material.specular.nir800
    total_850 = material.diffuse.nir850 + material.specular.nir850
    assert 0.0 < abs(total_850 - total_800) / total_850 < 0.12


@pytest.mark.parametrize("name", NAMES)
def test_names_a_dated_source(name: str) -> None:
    assert re.search(r"\b(19|20)\d\d\b", MATERIALS[name].source)


def test_passband_mean_of_aluminium_lies_below_both_lamps() -> None:
    # The interband absorption near 825 nm sits in the middle of the band (Rakic et al. 1998).
    specular = MATERIALS["mli_aluminium"].specular
    assert specular.sunlight < min(specular.nir800, specular.nir850)


def _fused_silica_index(wavelength_um: float) -> float:
    """Sellmeier equation of Malitson 1965, JOSA 55, 1205."""
    square = wavelength_um**2
    strengths = np.array([0.6961663, 0.4079426, 0.8974794])
    resonances = np.array([0.0684043, 0.1162414, 9.896161])
    return float(np.sqrt(1.0 + (strengths * square / (square - resonances**2)).sum()))


@pytest.mark.parametrize(("band", "wavelength_um"), [("nir800", 0.800), ("nir850", 0.850)])
def test_front_face_of_a_cube_is_bare_fused_silica(band: str, wavelength_um: float) -> None:
    index = _fused_silica_index(wavelength_um)
    fresnel = ((index - 1.0) / (index + 1.0)) ** 2
    assert getattr(MATERIALS["corner_cube_face"].specular, band) == pytest.approx(
        fresnel, abs=ROUNDING
    )


def test_order_of_brightness_is_that_of_the_surfaces() -> None:
    def total(name: str) -> float:
        return MATERIALS[name].diffuse.sunlight + MATERIALS[name].specular.sunlight

    assert total("black_paint") < total("carbon_fibre") < total("titanium_nozzle")
    assert total("titanium_nozzle") < total("bare_aluminium") < total("mli_aluminium")
    assert total("mli_gold") < total("mli_aluminium") < total("optical_solar_reflector")


def test_refuses_a_surface_that_makes_light() -> None:
    most, half = BandReflectance(0.8, 0.8, 0.8), BandReflectance(0.5, 0.5, 0.5)
    with pytest.raises(ValueError, match="sum to at most 1"):
        Material("impossible", most, half, 0.2, "none")
    with pytest.raises(ValueError, match="expected a roughness"):
        Material("firefly", half, half, 0.01, "none")
    with pytest.raises(ValueError, match="between 0 and 1"):
        BandReflectance(0.1, -0.1, 0.1)

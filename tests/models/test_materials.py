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


# Refractive index and extinction at 800 and 850 nm, between the tabulated wavelengths of the cited
# papers: aluminium Rakic 1995, Appl. Opt. 34, 4755; silver Johnson and Christy 1972, Phys. Rev. B
# 6, 4370; titanium Johnson and Christy 1974, Phys. Rev. B 9, 5056.
OPTICAL_CONSTANTS = {
    "aluminium": ((2.767, 8.354), (2.588, 8.169)),
    "silver": ((0.037, 5.56), (0.040, 5.96)),
    "titanium": ((3.142, 4.010), (3.237, 3.990)),
}
POLYIMIDE, SILICA = 1.7, 1.453
INTERPOLATED = 0.002  # of a reflectance: the tables are 20 to 70 nm apart


def _metal(name: str, under: float = 1.0) -> np.ndarray:
    """Fresnel's reflectance at normal incidence, at 800 and 850 nm."""
    index, extinction = np.array(OPTICAL_CONSTANTS[name]).T
    return ((index - under) ** 2 + extinction**2) / ((index + under) ** 2 + extinction**2)


def _total(name: str) -> np.ndarray:
    material = MATERIALS[name]
    return np.add(material.diffuse.bands, material.specular.bands)[1:]


def test_foil_with_its_metal_outward_is_aluminium() -> None:
    np.testing.assert_allclose(_total("mli_aluminium"), _metal("aluminium"), atol=INTERPOLATED)


def test_foil_with_its_film_outward_is_aluminium_under_polyimide() -> None:
    under = _metal("aluminium", POLYIMIDE)
    front = ((POLYIMIDE - 1.0) / (POLYIMIDE + 1.0)) ** 2
    through = under * 0.98**2 * (1.0 - front) ** 2 / (1.0 - front * under * 0.98**2) + front
    np.testing.assert_allclose(_total("mli_gold"), through, atol=0.02)
    assert (_total("mli_gold") < _metal("aluminium")).all()


@pytest.mark.parametrize(
    ("name", "metal", "under", "most_lost"),
    [
        ("bare_aluminium", "aluminium", 1.0, 0.09),
        ("solar_interconnect", "silver", 1.0, 0.07),
        ("optical_solar_reflector", "silver", SILICA, 0.03),
        ("titanium_nozzle", "titanium", 1.0, 0.31),
    ],
)
def test_a_used_metal_reflects_less_than_the_clean_one_by_what_is_told(
    name: str, metal: str, under: float, most_lost: float
) -> None:
    lost = _metal(metal, under) - _total(name)
    assert (lost > 0.0).all()
    assert (lost < most_lost).all()


# Solar absorptances: Fortescue et al. 2011, Table 11.3; Gilmore 2002, appendix A. They are averages
# over the whole spectrum, of which our band is 7 %: a check on gross error, not more.
@pytest.mark.parametrize(
    ("name", "least", "most"),
    [
        ("black_paint", 0.93, 0.97),
        ("white_paint", 0.12, 0.17),
        ("solar_cell", 0.88, 0.94),
        ("optical_solar_reflector", 0.02, 0.08),
        ("mli_aluminium", 0.12, 0.15),
        ("mli_gold", 0.20, 0.40),
        ("solar_substrate", 0.91, 0.95),
    ],
)
def test_absorbs_about_what_thermal_tables_say(name: str, least: float, most: float) -> None:
    assert (least <= 1.0 - _total(name)).all()
    assert (1.0 - _total(name) <= most).all()


def test_glass_rises_to_a_mirror_at_grazing_incidence_in_every_band() -> None:
    for material in MATERIALS.values():
        if material.is_dielectric:
            index = np.array(material.refractive_indices)
            face = (1.0 - material.matt_share) * ((index - 1.0) / (index + 1.0)) ** 2
            np.testing.assert_allclose(face, material.specular.bands, rtol=1e-12)
            assert (index > 1.2).all()
            assert (index < 1.75).all()


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
    with pytest.raises(ValueError, match="expected a dielectric's face"):
        Material("diamond mirror", half, BandReflectance(0.21, 0.2, 0.2), 0.1, "none", True)
    with pytest.raises(ValueError, match="between 0 and 1"):
        BandReflectance(0.1, -0.1, 0.1)

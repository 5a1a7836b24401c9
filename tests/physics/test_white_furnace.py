"""The white furnace: in light of radiance 1 from everywhere, no surface sends back more than 1.

By reciprocity the radiance that leaves towards a direction is the share of light from there that
comes back at all: the directional albedo. It is found twice, from the weights with which the
renderer draws directions and from a quadrature of ``f cos``, and held against an integral of the
microfacet model that shares no code with the renderer (Walter et al. 2007). That model counts one
bounce, so rough mirrors lose light: what they lose is measured here, not hidden.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from models.arrays import Floats
from models.materials import MATERIALS, BandReflectance, Material
from models.spacecraft.mli_blanket import Blanket
from models.surface_detail import PLAIN
from renders.tracing.surfaces import Surface, surface_of
from tests.support.small_scenes import needs_jit
from tests.support.surfaces import chi_square, drawn, value

NAMES = sorted(MATERIALS)
INCIDENCE_DEG = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0)
SAMPLES = 200_000
THREE_SIGMA = 3.0
# Fourteen materials, seven angles and three bands: one in 300 beyond 4 sigma if all is well is
# 0.02 expected, of values that are largely the same random numbers.
FOUR_SIGMA = 4.5
QUADRATURE = 4e-3  # 400 rings about the mirror direction, their widths growing by 2.5 % each
MICROFACETS = 4e-3  # 600 x 600 midpoints over the facets, whose weight has a kink at the horizon
FLOAT32 = 2e-3  # of a value of f: half vectors at grazing incidence lose digits


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    needs_jit()


@dataclass(frozen=True)
class Loaded:
    """A surface as the one-pass kernel has it, asked about local directions."""

    surface: Surface

    @staticmethod
    def of(material: Material) -> Loaded:
        return Loaded(surface_of(material))

    def drawn(self, incidence_deg: float, seed: int = 1) -> tuple[Floats, Floats]:
        """Return sampled directions, (3, n), and their weights, (3, n)."""
        square = np.random.default_rng(seed).random((2, SAMPLES))
        return drawn(self.surface, direction(incidence_deg), square)

    def value(self, wi: Floats, wo: Floats) -> Floats:
        """Return ``f cos``, (3, n), for pairs of directions, (3, n) or (3, 1)."""
        return value(self.surface, wi, wo)


def direction(incidence_deg: float) -> Floats:
    angle = np.deg2rad(incidence_deg)
    return np.array([[np.sin(angle)], [0.0], [np.cos(angle)]])


def rings_about(centre: Floats) -> tuple[Floats, Floats]:
    """Return directions, (3, n), and solid angles, (n,), in rings dense about ``centre``."""
    edges = np.concatenate([[0.0], np.geomspace(2e-4, np.pi, 400)])
    middle, width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    turn = (np.arange(180) + 0.5) / 180 * 2.0 * np.pi
    theta, phi = np.meshgrid(middle, turn, indexing="ij")
    local = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    x, _, z = centre.ravel()
    axes = np.array([[z, 0.0, x], [0.0, 1.0, 0.0], [-x, 0.0, z]])
    solid = np.sin(theta) * width[:, None] * (2.0 * np.pi / 180)
    return (axes @ local.reshape(3, -1)), solid.ravel()


def albedo_by_quadrature(loaded: Loaded, incidence_deg: float) -> Floats:
    wo, solid = rings_about(direction(-incidence_deg))
    return np.asarray((loaded.value(direction(incidence_deg), wo) * solid).sum(axis=1))


def facet_integral(material: Material, incidence_deg: float) -> Floats:
    """Return the mirror part's albedo in each band by the microfacet model, in plain NumPy.

    Facets are spread over GGX's distribution as Walter et al. 2007, equations 35 and 36, draw
    them; each reflects with the weight of their equation 41 if it sends light up at all.
    """
    alpha = material.roughness
    first, second = ((np.arange(600) + 0.5) / 600 for _ in range(2))
    u, turn = np.meshgrid(first, 2.0 * np.pi * second, indexing="ij")
    polar = np.arctan(alpha * np.sqrt(u / (1.0 - u)))
    facet = np.stack(
        [np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)]
    ).reshape(3, -1)
    wi = direction(incidence_deg)
    along = (wi * facet).sum(axis=0)
    wo = 2.0 * along * facet - wi
    up = (along > 0.0) & (wo[2] > 0.0)
    weight = np.where(up, along / (wi[2] * facet[2]), 0.0)
    weight *= smith(wi[2], alpha) * smith(np.where(up, wo[2], 1.0), alpha)
    if not material.is_dielectric:
        return weight.mean() * np.array(material.specular.bands)
    rest = 1.0 - max(material.diffuse.bands)
    fresnel = [glass(np.abs(along), index) for index in material.refractive_indices]
    return np.array([rest * (weight * share).mean() for share in fresnel])


def smith(cosine: Floats, alpha: float) -> Floats:
    """Smith's shadowing for GGX (Walter et al. 2007, equation 34)."""
    tangent2 = np.maximum(1.0 - cosine**2, 0.0) / cosine**2
    return np.asarray(2.0 / (1.0 + np.sqrt(1.0 + alpha**2 * tangent2)))


def glass(cosine: Floats, index: float) -> Floats:
    """Fresnel's reflectance of unpolarised light by a dielectric."""
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / index**2)
    across = (cosine - index * inside) / (cosine + index * inside)
    parallel = (index * cosine - inside) / (index * cosine + inside)
    return np.asarray(0.5 * (across**2 + parallel**2))


@pytest.mark.parametrize("name", NAMES)
def test_sends_back_no_more_than_it_gets_and_what_it_says(name: str) -> None:
    material, loaded = MATERIALS[name], Loaded.of(MATERIALS[name])
    for incidence_deg in INCIDENCE_DEG:
        wo, weight = loaded.drawn(incidence_deg)
        assert (wo[2][weight.any(axis=0)] > 0.0).all()  # nothing is drawn through the surface
        by_samples, sigma = weight.mean(axis=1), weight.std(axis=1) / np.sqrt(SAMPLES)
        assert (by_samples <= 1.0 + THREE_SIGMA * sigma).all()
        by_quadrature = albedo_by_quadrature(loaded, incidence_deg)
        expected = facet_integral(material, incidence_deg) + np.array(material.diffuse.bands)
        np.testing.assert_allclose(by_quadrature, expected, rtol=QUADRATURE + MICROFACETS)
        slack = FOUR_SIGMA * sigma + MICROFACETS * expected
        assert (np.abs(by_samples - expected) <= slack).all(), incidence_deg


@pytest.mark.parametrize("name", NAMES)
def test_the_way_back_is_the_way_there(name: str) -> None:
    loaded, rng = Loaded.of(MATERIALS[name]), np.random.default_rng(4)
    cosine, turn = rng.uniform(0.05, 1.0, (2, 4000)), rng.uniform(0.0, 2.0 * np.pi, (2, 4000))
    sine = np.sqrt(1.0 - cosine**2)
    first, second = np.moveaxis(np.stack([sine * np.cos(turn), sine * np.sin(turn), cosine]), 1, 0)
    there = loaded.value(first, second) / second[2]
    back = loaded.value(second, first) / first[2]
    np.testing.assert_allclose(there, back, rtol=FLOAT32)


@pytest.mark.parametrize("name", NAMES)
def test_both_faces_are_alike(name: str) -> None:
    loaded = Loaded.of(MATERIALS[name])
    wi, wo = direction(35.0), np.array([[-0.5], [0.2], [0.8426]])
    flip = np.array([[1.0], [1.0], [-1.0]])
    np.testing.assert_allclose(
        loaded.value(wi, wo), loaded.value(flip * wi, flip * wo), rtol=FLOAT32
    )
    assert (loaded.value(wi, flip * wo) == 0.0).all()


# Roughness, and what one bounce alone loses of a perfect mirror at 0 and at 75 degrees: measured by
# the integral above, and what ``models.materials.Material`` tells of it.
LOST = [(0.05, 0.003, 0.024), (0.1, 0.012, 0.076), (0.2, 0.052, 0.150), (0.3, 0.123, 0.191)]
TOLD_TO = 0.001


@pytest.mark.parametrize(("roughness", "lost_at_0", "lost_at_75"), LOST)
def test_a_rough_mirror_loses_what_takes_two_bounces(
    roughness: float, lost_at_0: float, lost_at_75: float
) -> None:
    mirror = replace(MATERIALS["mli_aluminium"], roughness=roughness, detail=PLAIN)
    for incidence_deg, lost in ((0.0, lost_at_0), (75.0, lost_at_75)):
        kept = facet_integral(mirror, incidence_deg) / mirror.specular.bands
        np.testing.assert_allclose(1.0 - kept, lost, atol=TOLD_TO)
    # Facets that lean by more than 45 degrees send light from above below the horizon.
    kept = facet_integral(mirror, 0.0) / mirror.specular.bands
    assert (1.0 - kept > roughness**2 / (1.0 + roughness**2)).all()


FAMILIES = {
    "metal": "mli_gold",
    "glass": "solar_cell",
    "resin": "carbon_fibre",
    "matt": "white_paint",
}


@pytest.mark.parametrize("family", sorted(FAMILIES))
@pytest.mark.parametrize("incidence_deg", [20.0, 70.0])
def test_directions_are_drawn_with_the_density_that_weighs_them(
    family: str, incidence_deg: float
) -> None:
    """Mitsuba's own chi-square, in the hemisphere above the surface."""
    surface = surface_of(MATERIALS[FAMILIES[family]])
    test = chi_square(surface, direction(incidence_deg), 400_000, res=101, ires=16)
    assert test.run(), test.messages


def test_creased_foil_makes_no_light_of_its_smooth_shading() -> None:
    """Perfectly white foil in a white furnace: interpolated normals are not the triangles' own.

    What they add or lose of the light is second order in how far they lean from the triangles.
    """
    import mitsuba as mi

    from renders.tracing.scene import mitsuba_mesh

    foil = Blanket((-0.3, -0.3), (0.3, 0.3), 0.013, 5).foil()
    white = mi.load_dict(
        {
            "type": "twosided",
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 1.0}},
        }
    )
    scene = mi.load_dict(
        {
            "type": "scene",
            "foil": mitsuba_mesh("foil", foil, white, smooth=True),
            "furnace": {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}},
            "sensor": {
                "type": "orthographic",
                "to_world": mi.ScalarTransform4f().look_at([0.1, 0.1, 1], [0, 0, 0], [0, 1, 0])
                @ mi.ScalarTransform4f().scale([0.2, 0.2, 1.0]),
                "film": {"type": "hdrfilm", "width": 48, "height": 48, "rfilter": {"type": "box"}},
            },
        }
    )
    integrator = mi.load_dict({"type": "path", "max_depth": 32, "rr_depth": 1000})
    image = np.array(mi.render(scene, integrator=integrator, spp=256, seed=3))[..., 0]
    blocks = image.reshape(6, 8, 6, 8).mean(axis=(1, 3))
    assert blocks.max() <= 1.01
    assert image.mean() == pytest.approx(1.0, abs=0.01)


def test_glass_that_makes_no_room_for_its_reflections_would_be_caught() -> None:
    """A bright matt part plus a full Fresnel face returns more than it gets."""
    plain = replace(MATERIALS["solar_cell"], detail=PLAIN)
    pearl = replace(plain, diffuse=BandReflectance(0.9, 0.9, 0.9), roughness=0.05)
    pearl = replace(pearl, specular=BandReflectance(0.01, 0.01, 0.01))
    surface = surface_of(pearl)
    honest = albedo_by_quadrature(Loaded(surface), 85.0)
    assert (honest <= 1.0).all()
    bare = replace(surface, matt=(0.0, 0.0, 0.0), mirror=(1.0, 1.0, 1.0))
    naive = honest + 0.9 * albedo_by_quadrature(Loaded(bare), 85.0)
    assert (naive > 1.0 + FOUR_SIGMA * QUADRATURE).all()


def test_families_cover_both_kinds_of_face() -> None:
    kinds = {MATERIALS[name].is_dielectric for name in FAMILIES.values()}
    assert kinds == {False, True}

"""Surfaces as data: how much each reflects, in each band, with its source."""

from __future__ import annotations

from dataclasses import dataclass

from models.surface_detail import DETAIL, MOST_CREASED, PLAIN, SurfaceDetail


@dataclass(frozen=True)
class BandReflectance:
    """Reflectance in the three bands that one rendering carries.

    A camera of colours has red, green and blue in their places (``models.spacecraft.in_colour``).

    Attributes
    ----------
    sunlight : float
        Averaged over the camera's 790 to 860 nm passband.
    nir800, nir850 : float
        At the lamps' wavelengths.
    """

    sunlight: float
    nir800: float
    nir850: float

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not 0.0 <= value <= 1.0:
                raise ValueError(f"expected a reflectance between 0 and 1, got {name} = {value}")

    @property
    def bands(self) -> tuple[float, float, float]:
        """(sunlight, nir800, nir850): the renderer's three channels."""
        return (self.sunlight, self.nir800, self.nir850)


MOST_OF_A_FACE = 0.2  # of a dielectric, at normal incidence: an index of 2.6
BLACK = BandReflectance(0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Material:
    """A Lambertian part plus a GGX-rough mirror part.

    The mirror part reflects once at each microfacet (Walter et al. 2007): what would leave by
    several is lost. At normal incidence that is 0.3 % of a metal's mirror part at a roughness of
    0.05, 1.2 % at 0.1, 5 % at 0.2 and 12 % at 0.3; at 75 degrees 2, 8, 15 and 19 %.

    Attributes
    ----------
    name : str
    diffuse : BandReflectance
        Hemispherical reflectance of the Lambertian part.
    specular : BandReflectance
        Reflectance of the mirror part; of a dielectric's, that at normal incidence.
    roughness : float
        GGX alpha of the mirror part; at least 0.05, below which a path tracer makes fireflies.
    source : str
        Where the numbers come from.
    is_dielectric : bool
        Whether the mirror part is the face of glass, resin or film, which reflects ever more
        towards grazing incidence by Fresnel's law; that of a metal stays as it is.
    detail : SurfaceDetail
        How it differs from place to place, where a pixel resolves that; all else is its mean.
    """

    name: str
    diffuse: BandReflectance
    specular: BandReflectance
    roughness: float
    source: str
    is_dielectric: bool = False
    detail: SurfaceDetail = PLAIN

    def __post_init__(self) -> None:
        if not 0.05 <= self.roughness <= 1.0:
            raise ValueError(
                f"{self.name}: expected a roughness from 0.05 to 1, got {self.roughness}"
            )
        for diffuse, specular in zip(self.diffuse.bands, self.specular.bands, strict=True):
            if diffuse + specular > 1.0:
                raise ValueError(
                    f"{self.name}: expected diffuse and specular to sum to at most 1, "
                    f"got {diffuse} + {specular}"
                )
        most = max(d + s for d, s in zip(self.diffuse.bands, self.specular.bands, strict=True))
        if most * (1.0 + self.detail.mottling) * (1.0 + self.detail.tile_spread) > 1.0:
            raise ValueError(
                f"{self.name}: expected at most 1 where its detail is brightest, got {most} with "
                f"a mottling of {self.detail.mottling} and tiles' {self.detail.tile_spread}"
            )
        if self.detail.crease_slope > MOST_CREASED * self.roughness:
            raise ValueError(
                f"{self.name}: expected a crease slope up to {MOST_CREASED} of the roughness, "
                f"got {self.detail.crease_slope} with {self.roughness}"
            )
        if self.is_dielectric and not max(self.specular.bands) <= MOST_OF_A_FACE:
            raise ValueError(
                f"{self.name}: expected a dielectric's face to reflect at most {MOST_OF_A_FACE} "
                f"at normal incidence, got {max(self.specular.bands)}"
            )

    @property
    def matt_share(self) -> float:
        """What the Lambertian part takes of the light before a dielectric's face gets the rest."""
        return max(self.diffuse.bands)

    @property
    def refractive_indices(self) -> tuple[float, ...]:
        """Index of the bare surface that reflects at normal incidence as ``specular`` says.

        For a dielectric alone: a coated stack is stood for by the surface of one index, so that
        the reflectance rises to 1 at grazing incidence. Bands as in ``BandReflectance.bands``.
        """
        rest = 1.0 - self.matt_share
        roots = [(value / rest) ** 0.5 for value in self.specular.bands]
        return tuple((1.0 + root) / (1.0 - root) for root in roots)


def _material(
    name: str,
    diffuse: tuple[float, float, float],
    specular: tuple[float, float, float],
    roughness: float,
    source: str,
    is_dielectric: bool = False,
) -> Material:
    bands = BandReflectance(*diffuse), BandReflectance(*specular)
    detail = DETAIL.get(name, PLAIN)
    return Material(name, *bands, roughness, source, is_dielectric, detail)


# Each pair of triples is (sunlight, 800 nm, 850 nm). Reflectances of metals follow from the cited
# optical constants by Fresnel's law at normal incidence, averaged over 790 to 860 nm for sunlight.
# How a total splits into a diffuse and a mirror part, and every roughness, is our estimate.
MATERIALS: dict[str, Material] = {
    material.name: material
    for material in (
        _material(
            "mli_gold",
            (0.060, 0.060, 0.060),
            (0.697, 0.694, 0.705),
            0.10,
            "Aluminised Kapton, film outward. Aluminium seen through polyimide (n = 1.7): 0.790 "
            "at 800 nm and 0.793 at 850 nm (Rakic et al. 1998, Appl. Opt. 37, 5271), with the "
            "film's front face and 2 % loss each way added: 0.75 to 0.77 in all, our estimate; "
            "solar absorptance 0.40 over the whole spectrum (Fortescue et al. 2011, Table 11.3)",
        ),
        _material(
            "mli_aluminium",
            (0.060, 0.060, 0.060),
            (0.808, 0.809, 0.810),
            0.10,
            "Aluminised film, metal outward: total 0.868 over the band, 0.869 at 800 nm, 0.865 "
            "at the 825 nm interband dip, 0.870 at 850 nm (Rakic et al. 1998, Appl. Opt. 37, "
            "5271); solar absorptance 0.14 (Fortescue et al. 2011, Table 11.3)",
        ),
        _material(
            "mli_black",
            (0.045, 0.044, 0.046),
            (0.030, 0.030, 0.030),
            0.15,
            "Black, carbon-loaded Kapton, film outward: solar absorptance near 0.93 (Gilmore "
            "2002, Spacecraft Thermal Control Handbook, chapter 4); a bare film of n = 1.7 would "
            "reflect 0.067, of which its filler roughens half. "
            "Split, slope and roughness are our estimate",
            is_dielectric=True,
        ),
        _material(
            "bare_aluminium",
            (0.320, 0.322, 0.324),
            (0.470, 0.472, 0.474),
            0.25,
            "Machined alloy: the optical constants of Rakic et al. 1998 (total 0.868 over the "
            "band) less 0.08 for oxide and tool marks, our estimate, near the solar absorptance "
            "of 0.21 to 0.24 of aluminium tape and polished sheet (Fortescue et al. 2011, 11.3)",
        ),
        _material(
            "anodised_aluminium",
            (0.380, 0.381, 0.386),
            (0.190, 0.191, 0.193),
            0.30,
            "Anodised alloy: solar absorptance 0.27 (clear) to 0.44 (chromic) by Henninger 1984, "
            "NASA RP-1121; shape of the band from the aluminium below (Rakic et al. 1998), "
            "levels are our estimate",
        ),
        _material(
            "solar_cell",
            (0.012, 0.012, 0.012),
            (0.060, 0.056, 0.064),
            0.05,
            "Triple-junction cell under coated coverglass: solar absorptance 0.88 to 0.92 "
            "(Fortescue et al. 2011, Table 11.3; Gilmore 2002, appendix A). Bare GaAs reflects "
            "0.328 at 800 and 0.324 at 850 nm (Jellison 1992); what its coatings leave, with "
            "the glass's 2 to 3 % and the rise towards the band edge, is our estimate",
            is_dielectric=True,
        ),
        _material(
            "solar_substrate",
            (0.055, 0.054, 0.056),
            (0.015, 0.015, 0.015),
            0.30,
            "Black, carbon-loaded Kapton on a carbon face sheet: solar absorptance near 0.93 "
            "(Gilmore 2002, Spacecraft Thermal Control Handbook, chapter 4); nearly grey in the "
            "band, our estimate",
            is_dielectric=True,
        ),
        _material(
            "solar_interconnect",
            (0.190, 0.190, 0.190),
            (0.740, 0.739, 0.742),
            0.20,
            "Silver tabs: 0.990 to 0.995 when polished (Johnson and Christy 1972, Phys. Rev. B "
            "6, 4370; Yang et al. 2015), 6 % lost to tarnish and welds, our estimate",
        ),
        _material(
            "optical_solar_reflector",
            (0.010, 0.010, 0.010),
            (0.960, 0.959, 0.961),
            0.05,
            "Second-surface silvered fused silica: solar absorptance 0.07 (Gilmore 2002, "
            "appendix A; Fortescue et al. 2011, Table 11.3), most of it in the ultraviolet; silver "
            "under silica reflects 0.994 in the band (Johnson and Christy 1972), 2 % of it lost to "
            "dust, haze and chipped edges, our estimate",
        ),
        _material(
            "white_paint",
            (0.858, 0.862, 0.853),
            (0.010, 0.010, 0.010),
            0.60,
            "Z93 zinc oxide in silicate: solar absorptance 0.16 to 0.17 (Gilmore 2002, appendix "
            "A), nearly Lambertian (Bradley et al. 2020, Spectroscopy 35 S3, 6); slow fall from "
            "800 to 850 nm is our estimate",
        ),
        _material(
            "black_paint",
            (0.040, 0.039, 0.041),
            (0.006, 0.006, 0.006),
            0.40,
            "Aeroglaze Z306 polyurethane: solar absorptance 0.95 (Gilmore 2002, appendix A; "
            "Fortescue et al. 2011, Table 11.3: 0.95); split and slope are our estimate",
        ),
        _material(
            "marker_black",
            (0.030, 0.030, 0.031),
            (0.012, 0.012, 0.012),
            0.30,
            "Black polyurethane (Aeroglaze Z306) behind white dots: solar absorptance 0.95 "
            "(Gilmore 2002, appendix A), so 0.04 to 0.05 in all at normal incidence; ever glossier "
            "towards grazing. Split and roughness are our estimate",
            is_dielectric=True,
        ),
        _material(
            "carbon_fibre",
            (0.050, 0.049, 0.051),
            (0.060, 0.058, 0.061),
            0.20,
            "Carbon fibre in epoxy: graphite under a resin of n = 1.5 reflects 0.24 (Djurisic "
            "and Li 1999, J. Appl. Phys. 85, 7404), rough and broken by the weave: solar "
            "absorptance 0.88 to 0.93 for bare laminate, our estimate",
            is_dielectric=True,
        ),
        _material(
            "titanium_nozzle",
            (0.120, 0.119, 0.121),
            (0.200, 0.203, 0.198),
            0.25,
            "Fired nozzle metal: clean titanium reflects 0.622 at 800 and 0.618 at 850 nm "
            "(Johnson and Christy 1974, Phys. Rev. B 9, 5056), polished parts 0.40 over the "
            "solar spectrum (Fortescue et al. 2011, Table 11.3); 0.32 after firing is our estimate",
        ),
        _material(
            "corner_cube_face",
            (0.010, 0.010, 0.010),
            (0.0341, 0.0341, 0.0340),
            0.05,
            "Front face of a solid cube, fused silica, n = 1.4533 at 800 nm and 1.4525 at 850 nm "
            "(Malitson 1965, JOSA 55, 1205), so 0.034 unless coated; the diffuse part, dust and "
            "scratches, is our estimate. The returned light is told in retroreflector_optics",
            is_dielectric=True,
        ),
    )
}

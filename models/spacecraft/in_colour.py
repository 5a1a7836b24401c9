"""A spacecraft as a camera of colours sees it: its materials' bands are red, green and blue.

A rendering carries three bands at once. For the near infrared they are those of
``models.materials``; here they are those of ``models.sensors.bayer_mosaic``. A material of which no
colour is known keeps its near-infrared reflectances and so is grey.
"""

from __future__ import annotations

from dataclasses import replace

from models.materials import MATERIALS, BandReflectance, Material
from models.spacecraft.part import Spacecraft

Rgb = tuple[float, float, float]

# (red, green, blue) of the diffuse and of the mirror part. Metals follow from the optical constants
# that models.materials cites; how much film, oxide, dye and pigment take is our estimate. Solar
# absorptances there hold over these bands, too: most of the Sun's power lies in them.
COLOURS: dict[str, tuple[Rgb, Rgb]] = {
    "mli_gold": ((0.055, 0.045, 0.020), (0.640, 0.430, 0.110)),  # polyimide is amber
    "mli_aluminium": ((0.060, 0.060, 0.060), (0.835, 0.845, 0.850)),
    "mli_black": ((0.040, 0.040, 0.040), (0.030, 0.030, 0.030)),
    "bare_aluminium": ((0.330, 0.335, 0.340), (0.480, 0.485, 0.490)),
    "anodised_aluminium": ((0.370, 0.375, 0.375), (0.185, 0.190, 0.190)),
    "solar_cell": ((0.008, 0.008, 0.014), (0.040, 0.045, 0.080)),
    "solar_substrate": ((0.050, 0.050, 0.050), (0.015, 0.015, 0.015)),
    "solar_interconnect": ((0.185, 0.185, 0.180), (0.735, 0.730, 0.710)),
    "optical_solar_reflector": ((0.010, 0.010, 0.010), (0.955, 0.950, 0.935)),
    "white_paint": ((0.870, 0.865, 0.815), (0.010, 0.010, 0.010)),  # zinc oxide falls in the blue
    "black_paint": ((0.040, 0.040, 0.040), (0.006, 0.006, 0.006)),
    "marker_black": ((0.030, 0.030, 0.031), (0.012, 0.012, 0.012)),
    "carbon_fibre": ((0.045, 0.045, 0.045), (0.055, 0.055, 0.055)),
    "titanium_nozzle": ((0.110, 0.100, 0.085), (0.185, 0.165, 0.140)),
    "corner_cube_face": ((0.010, 0.010, 0.010), (0.0345, 0.0350, 0.0357)),
}


def in_colour(spacecraft: Spacecraft) -> Spacecraft:
    """Return a spacecraft whose materials' three bands are red, green and blue."""
    known = {**MATERIALS, **spacecraft.materials}
    coloured = {name: _coloured(known[name], *COLOURS[name]) for name in COLOURS if name in known}
    return replace(spacecraft, materials={**spacecraft.materials, **coloured})


def _coloured(material: Material, diffuse: Rgb, specular: Rgb) -> Material:
    return replace(material, diffuse=BandReflectance(*diffuse), specular=BandReflectance(*specular))

"""What a retroreflector returns, as data; see ``renders.tracing.retroreflector``."""

from __future__ import annotations

from dataclasses import dataclass

from models.materials import MATERIALS, BandReflectance, Material

RETURNED = BandReflectance(sunlight=0.0, nir800=0.002, nir850=0.6)
FACE = MATERIALS["corner_cube_face"]


@dataclass(frozen=True)
class RetroreflectorOptics:
    """An effective retroreflective disc.

    Attributes
    ----------
    half_angle_deg : float, deg
        psi, half-angle of the flat-top return lobe; 2 to 3 deg hold both lens and lamps.
    returned : BandReflectance
        rho of the lobe: 850 nm passes the cover filter, 800 nm does not, and sunlight goes back
        to the Sun.
    refractive_index : float
        Of the cube's glass; fused silica at 850 nm (Malitson 1965: 1.4525).
    face : Material
        Front face of the cube's filter.
    """

    half_angle_deg: float = 2.0
    returned: BandReflectance = RETURNED
    refractive_index: float = 1.4525
    face: Material = FACE

"""What a retroreflector returns, as data; see ``renders.tracing.retroreflector``."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.markers import CornerCubes
from models.materials import MATERIALS, BandReflectance, Material
from models.spacecraft.corner_cube import EDGE, face_axes

RETURNED = BandReflectance(sunlight=0.0, nir800=0.002, nir850=0.6)
FUSED_SILICA = 1.4525  # at 850 nm (Malitson 1965)
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
        Of the cube's glass.
    face : Material
        Front face of the cube's filter.
    """

    half_angle_deg: float = 2.0
    returned: BandReflectance = RETURNED
    refractive_index: float = FUSED_SILICA
    face: Material = FACE


def cubes_behind(normals_in_target: Floats, refractive_index: float = FUSED_SILICA) -> CornerCubes:
    """Return what is known of cubes as they are drawn where nobody says otherwise.

    Parameters
    ----------
    normals_in_target : (n, 3) array
        Of their faces.
    refractive_index : float
    """
    edges = np.array([face_axes(normal)[0] for normal in normals_in_target]).reshape(-1, 3)
    return CornerCubes(refractive_index, EDGE, edges)

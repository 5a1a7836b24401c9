"""The corner-cube retroreflector as an *effective retroreflective disc*.

A real cube returns light along the line it came, displaced by at most its own diameter: 2.5 cm
here, less than the distance from LED to lens, so a camera beside its lamps would see nothing of a
perfect cube. Flight cubes are spoiled on purpose (dihedral offsets of arc minutes) or carry a
diffusing cover. What the camera sees is a disc that sends light back within a small cone, and that
is what we model:

* a flat-top return lobe about the incident direction, half-angle psi, with
  ``f_r = rho A(theta) / (pi sin^2 psi)`` inside it and zero outside;
* the solid cube's active aperture A(theta), which falls with incidence as the entrance face and
  its image slide apart (Arnold 1979): 0.68 at 15 deg, 0.47 at 25 deg for fused silica;
* a band filter over the cube: 850 nm returned, 800 nm absorbed. Sunlight is not returned to the
  camera, because a cube returns it to the Sun, within arc minutes: its rho is zero in that band;
* the front face: a weak mirror and a weak Lambertian part in every band, which sunlight does light.

theta is taken at the half vector of the two directions, so the lobe is reciprocal. Energy:
within the cone the projected solid angle is pi sin^2 psi cos theta, hence the lobe returns
rho A(theta) cos(theta) of what it receives, less than rho.
"""

from __future__ import annotations

from typing import Any

import drjit as dr
import numpy as np


def active_aperture(cosine: Any, refractive_index: Any) -> Any:
    """Return A(theta) of a solid circular corner cube, on Dr.Jit or plain floats.

    ``A = (2/pi) (asin mu - mu sqrt(2) tan t')``, ``mu = sqrt(1 - 2 tan^2 t')``, with t' the
    refracted angle (Arnold 1979, Method of calculating retroreflector-array transfer functions;
    Degnan 1993, equation 6.2.4, prints it without the second mu, which is not the overlap of two
    circles: 1 % less at 15 deg, 6 % at 25). Zero where the face and its image no longer overlap.
    """
    sine2 = dr.maximum(1.0 - cosine * cosine, 0.0) / refractive_index**2
    tangent2 = sine2 / (1.0 - sine2)
    mu = dr.sqrt(dr.maximum(1.0 - 2.0 * tangent2, 0.0))
    aperture = (2.0 / np.pi) * (dr.asin(mu) - mu * dr.sqrt(2.0 * tangent2))
    return dr.maximum(aperture, 0.0)

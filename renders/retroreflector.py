"""The corner-cube retroreflector as an *effective retroreflective disc*.

A real cube returns light along the line it came, displaced by at most its own diameter: 2.5 cm
here, less than the distance from LED to lens, so a camera beside its lamps would see nothing of a
perfect cube. Flight cubes are spoiled on purpose (dihedral offsets of arc minutes) or carry a
diffusing cover. What the camera sees is a disc that sends light back within a small cone, and that
is what we model:

* a flat-top return lobe about the incident direction, half-angle psi, with
  ``f_r = rho A(theta) / (pi sin^2 psi)`` inside it and zero outside;
* the solid cube's active aperture A(theta), which falls with incidence as the entrance face and
  its image slide apart (Arnold 1979): 0.67 at 15 deg, 0.44 at 25 deg for fused silica;
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
import mitsuba as mi
import numpy as np

from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.surfaces import bsdf_dict

_registered: set[str] = set()


def active_aperture(cosine: Any, refractive_index: float) -> Any:
    """Return A(theta) of a solid circular corner cube, on Dr.Jit or plain floats.

    ``A = (2/pi) (asin mu - sqrt(2) tan t')``, ``mu = sqrt(1 - 2 tan^2 t')``, with t' the refracted
    angle (Arnold 1979, Method of calculating retroreflector-array transfer functions, as in
    Degnan 1993, equation 6.2.4). Zero where the face and its image no longer overlap.
    """
    sine2 = dr.maximum(1.0 - cosine * cosine, 0.0) / refractive_index**2
    tangent2 = sine2 / (1.0 - sine2)
    mu = dr.sqrt(dr.maximum(1.0 - 2.0 * tangent2, 0.0))
    aperture = (2.0 / np.pi) * (dr.asin(mu) - dr.sqrt(2.0 * tangent2))
    return dr.maximum(aperture, 0.0)


def retroreflector_dict(optics: RetroreflectorOptics) -> dict[str, Any]:
    """Return the retroreflector for ``mi.load_dict``."""
    register_retroreflector()
    return {
        "type": "retroreflector",
        "half_angle_deg": optics.half_angle_deg,
        "refractive_index": optics.refractive_index,
        "rho_sunlight": optics.returned.sunlight,
        "rho_nir800": optics.returned.nir800,
        "rho_nir850": optics.returned.nir850,
        "face": bsdf_dict(optics.face, two_sided=False),
    }


def register_retroreflector() -> None:
    """Make the BSDF plugin known to Mitsuba, once per process."""
    if "retroreflector" in _registered:
        return

    class Retroreflector(mi.BSDF):  # type: ignore[misc]
        """See the module. Constants are Python floats: a numpy scalar would break the JIT."""

        def __init__(self, props: Any) -> None:
            super().__init__(props)
            self.sine = float(np.sin(np.deg2rad(props["half_angle_deg"])))
            self.cosine = float(np.cos(np.deg2rad(props["half_angle_deg"])))
            self.index = float(props["refractive_index"])
            self.rho = [float(props[f"rho_{band}"]) for band in ("sunlight", "nir800", "nir850")]
            self.face = props["face"]
            self.lobe_share = 0.5 if max(self.rho) > 0.0 else 0.0
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            self.m_components = [flags]
            self.m_flags = flags

        def lobe(self, wi: Any, wo: Any) -> tuple[Any, Any]:
            """Return (f_r per unit rho, whether wo lies in the return cone)."""
            half = dr.normalize(wi + wo)
            inside = dr.dot(wi, wo) >= self.cosine
            aperture = active_aperture(half.z, self.index)
            return aperture / (np.pi * self.sine**2), inside

        def cone_density(self) -> float:
            """Probability density of the uniform cone about the incident direction."""
            return float(1.0 / (2.0 * np.pi * (1.0 - self.cosine)))

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any) -> Any:
            to_lobe = sample1 < self.lobe_share
            to_face = sample1 >= self.lobe_share
            face_sample, _ = self.face.sample(
                ctx,
                si,
                dr.clip((sample1 - self.lobe_share) / (1.0 - self.lobe_share), 0.0, 1.0),
                sample2,
                active & to_face,
            )
            cone = mi.warp.square_to_uniform_cone(sample2, self.cosine)
            in_cone = mi.Frame3f(si.wi).to_world(cone)
            bs = mi.BSDFSample3f()
            bs.wo = dr.select(to_lobe, in_cone, face_sample.wo)
            bs.eta = 1.0
            bs.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            bs.sampled_component = mi.UInt32(0)
            bs.pdf = self.pdf(ctx, si, bs.wo, active)
            good = active & (bs.pdf > 0.0)
            value = self.eval(ctx, si, bs.wo, good)
            weight = value / dr.select(good, bs.pdf, 1.0)
            return bs, mi.Color3f(dr.select(good, weight, mi.Color3f(0.0)))

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any) -> Any:
            front = active & (si.wi.z > 0.0) & (wo.z > 0.0)
            strength, inside = self.lobe(si.wi, wo)
            strength = dr.select(front & inside, strength * wo.z, 0.0)
            returned = mi.Color3f(*(rho * strength for rho in self.rho))
            return returned + dr.select(front, self.face.eval(ctx, si, wo, front), mi.Color3f(0.0))

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any) -> Any:
            front = active & (si.wi.z > 0.0) & (wo.z > 0.0)
            inside = dr.dot(si.wi, wo) >= self.cosine
            lobe_pdf = dr.select(inside, self.cone_density(), 0.0)
            face_pdf = self.face.pdf(ctx, si, wo, front)
            total = self.lobe_share * lobe_pdf + (1.0 - self.lobe_share) * face_pdf
            return dr.select(front, total, 0.0)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any) -> Any:
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def traverse(self, cb: Any) -> None:
            cb.put("face", self.face, mi.ParamFlags.Differentiable)

        def to_string(self) -> str:
            return f"Retroreflector[cosine={self.cosine}, rho={self.rho}]"

    mi.register_bsdf("retroreflector", Retroreflector)
    _registered.add("retroreflector")

"""Tiny scenes for physics: one spacecraft part, one camera, light groups; seconds to render."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from models.arrays import Floats, Radiance
from models.camera import Camera
from models.markers import MarkerPattern
from models.materials import BLACK, MATERIALS, BandReflectance, Material
from models.pose import RigidTransform
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.tracing.light_groups import LightGroup
from renders.variant.choice import activate, choose_variant
from tests.support.patience import HANGS_S

LAMBERT = "lambertian_grey"  # a material for closed forms, known to tests alone
MATERIALS[LAMBERT] = Material(
    LAMBERT, BandReflectance(0.5, 0.48, 0.52), BLACK, 1.0, "none: a closed form (Nicodemus 1977)"
)

FACING = np.diag([1.0, -1.0, -1.0])  # camera over the target, looking down -z


def activate_best() -> str:
    """Set the fastest variant of this machine for the whole test process."""
    variant = choose_variant("auto")
    activate(variant)
    return variant


def needs_jit() -> None:
    """Skip where only scalar_rgb renders: what is tested is the one-pass integrator."""
    if activate_best().startswith("scalar"):
        pytest.skip("no JIT variant renders on this machine")


def camera_at(place: Floats, rotation: Floats = FACING) -> RigidTransform:
    """Return ``cam_from_target`` of a camera at ``place``, target frame, m."""
    return RigidTransform(rotation, -rotation @ np.asarray(place, dtype=np.float64))


def plate(material: str, size_m: float = 4.0, markers: MarkerPattern | None = None) -> Spacecraft:
    """Return a square plate with its top in the plane z = 0."""
    mesh = trimesh.creation.box((size_m, size_m, 0.02)).apply_translation([0.0, 0.0, -0.01])
    return Spacecraft("plate", (Part("plate", mesh, material),), markers, np.zeros(3))


def discs(points: Floats, radius_m: float) -> MarkerPattern:
    """Return discs that face +z."""
    points = np.atleast_2d(np.asarray(points, dtype=np.float64))
    return MarkerPattern(
        names=tuple(str(number + 1) for number in range(len(points))),
        points_in_target=points,
        normals_in_target=np.tile([0.0, 0.0, 1.0], (len(points), 1)),
        radius_m=radius_m,
    )


def rendered(
    target: Spacecraft,
    camera: Camera,
    cam_from_target: RigidTransform,
    groups: list[LightGroup],
    samples: int,
    max_depth: int = 1,
    chaser: Spacecraft | None = None,
    optics: RetroreflectorOptics | None = None,
    marker_samples: int | None = None,
) -> dict[str, Radiance]:
    """Render light groups of a small scene, W m-2 sr-1."""
    from renders.tracing.radiance import Sampling, render_radiance
    from renders.tracing.scene import build_geometry, place_chaser

    geometry = build_geometry(target, chaser, optics or RetroreflectorOptics())
    scene = geometry.scene()
    place_chaser(scene, geometry, cam_from_target)
    markers = target.markers if marker_samples is not None else None
    sampling = Sampling(samples, marker_samples or samples, max_depth, seed=3)
    return render_radiance(scene, geometry, camera, cam_from_target, groups, markers, sampling)


def run_python(program: str, cwd: Path, **environment: str) -> Any:
    """Run a program in a process of its own, for what one process cannot do: two variants."""
    import os
    import subprocess
    import sys

    return subprocess.run(
        [sys.executable, "-P", "-c", program],
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2]), **environment},
        capture_output=True,
        text=True,
        timeout=HANGS_S,
        check=False,
    )

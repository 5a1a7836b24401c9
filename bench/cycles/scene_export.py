"""From the house's spacecraft to the neutral scene: the same meshes, materials in simple form."""

from __future__ import annotations

import numpy as np
import trimesh

from bench.cycles.neutral_scene import NeutralMaterial, NeutralMesh, NeutralScene, NeutralSun
from models.arrays import Floats
from models.camera import Camera
from models.lights.sun import ANGULAR_DIAMETER_DEG, PASSBAND_IRRADIANCE_W_M2
from models.markers import MarkerPattern
from models.materials import MATERIALS
from models.motion.approach import Approach
from models.pose import RigidTransform
from models.spacecraft.catalogue import spacecraft_by_name
from models.spacecraft.part import Part, Spacecraft

MARKER_MATERIAL = "corner_cube_face"  # the faces' own mirror lobe; no renderer shares the return
DISC_CORNERS = 64
DISC_LIFT_M = 2e-4  # above the support: the two never share a plane


def neutral_material(name: str) -> NeutralMaterial:
    """Return a material's simple form in the sunlight band: no relief, no texture, no Fresnel."""
    material = MATERIALS[name]
    return NeutralMaterial(
        material.diffuse.sunlight, material.specular.sunlight, material.roughness
    )


def neutral_sun(name: str, direction: Floats) -> NeutralSun:
    """Return the Sun that the house's scenarios have.

    Parameters
    ----------
    name : str
    direction : (3,) array
        Unit, towards it, target frame.
    """
    towards = (float(direction[0]), float(direction[1]), float(direction[2]))
    return NeutralSun(name, towards, PASSBAND_IRRADIANCE_W_M2, ANGULAR_DIAMETER_DEG)


def marker_discs(markers: MarkerPattern) -> trimesh.Trimesh:
    """Return the markers' faces as fans of triangles."""
    angle = 2.0 * np.pi * np.arange(DISC_CORNERS) / DISC_CORNERS
    fan = np.stack([np.roll(np.arange(DISC_CORNERS), 1), np.arange(DISC_CORNERS)], axis=1)
    faces = np.concatenate([np.full((DISC_CORNERS, 1), DISC_CORNERS), fan], axis=1)
    discs = []
    for point, normal in zip(markers.points_in_target, markers.normals_in_target, strict=True):
        first = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        rim = np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second
        centre = point + DISC_LIFT_M * normal
        corners = np.concatenate([centre + markers.radius_m * rim, [centre]])
        discs.append(trimesh.Trimesh(corners, faces, process=False))
    return trimesh.util.concatenate(discs)


def neutral_meshes(parts: tuple[Part, ...], target_from_body: RigidTransform) -> list[NeutralMesh]:
    """Return the meshes of parts, joined where label, material and shading agree."""
    joined: dict[tuple[str, str, bool], list[trimesh.Trimesh]] = {}
    for part in parts:
        joined.setdefault((part.name, part.material, part.smooth), []).append(part.mesh)
    meshes = []
    for (label, material, smooth), pieces in joined.items():
        mesh = pieces[0] if len(pieces) == 1 else trimesh.util.concatenate(pieces)
        meshes.append(
            NeutralMesh(
                label=label,
                material=material,
                vertices=np.asarray(target_from_body @ mesh.vertices, dtype=np.float32),
                faces=np.asarray(mesh.faces, dtype=np.int32),
                normals=np.asarray(target_from_body.rotate(mesh.vertex_normals), dtype=np.float32)
                if smooth
                else None,
            )
        )
    return meshes


def neutral_scene(
    target: Spacecraft,
    chaser: Spacecraft | None,
    camera: Camera,
    cam_from_target: RigidTransform,
    suns: tuple[NeutralSun, ...],
) -> NeutralScene:
    """Return a scene for both renderers; the markers' discs lose their retroreflection.

    Parameters
    ----------
    target : Spacecraft
    chaser : Spacecraft or None
    camera : Camera
    cam_from_target : RigidTransform
    suns : tuple of NeutralSun
    """
    here = RigidTransform(np.eye(3), np.zeros(3))
    parts = target.parts
    if target.markers is not None:
        discs = marker_discs(target.markers)
        parts = (*parts, Part("retroreflectors", discs, MARKER_MATERIAL))
    meshes = neutral_meshes(parts, here)
    if chaser is not None:
        meshes += neutral_meshes(chaser.parts, cam_from_target.inverse())
    names = sorted({mesh.material for mesh in meshes})
    return NeutralScene(
        camera, cam_from_target, suns, {n: neutral_material(n) for n in names}, tuple(meshes)
    )


def maxar_scene(
    size_px: int,
    suns: tuple[NeutralSun, ...],
    time_s: float = 0.0,
    *,
    with_chaser: bool = True,
) -> NeutralScene:
    """Return the Maxar target before the chaser of the papers' approach, ``time_s`` into it.

    Parameters
    ----------
    size_px : int, px
        Width and height.
    suns : tuple of NeutralSun
    time_s : float, s
    with_chaser : bool
        Whether it stands behind the camera and takes part in the light.
    """
    approach = Approach(pointing_accuracy_deg=0.0)
    return neutral_scene(
        spacecraft_by_name("maxar1300"),
        spacecraft_by_name("chaser") if with_chaser else None,
        Camera.from_fov(size_px, size_px, 50.0),
        approach.cam_from_target(time_s),
        suns,
    )

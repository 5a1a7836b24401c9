"""A scene that any renderer can build: meshes, simple materials, a pinhole camera and Suns.

On disk it is a folder: ``scene.json`` for the numbers, ``meshes.npz`` for vertices, faces and, on
smooth meshes, vertex normals. All in the target frame, m. ``blender_side`` reads it without us.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import AnyArray, Floats
from models.camera import Camera
from models.pose import RigidTransform


@dataclass(frozen=True)
class NeutralMaterial:
    """A Lambertian part plus a single-scattering GGX mirror part without Fresnel, in one band.

    Attributes
    ----------
    diffuse, specular : float
        Reflectances; they add up to at most 1.
    alpha : float
        GGX width. Cycles' roughness r means ``alpha = r**2``, so it gets ``sqrt(alpha)``.
    """

    diffuse: float
    specular: float
    alpha: float


@dataclass(frozen=True)
class NeutralSun:
    """A Sun disc at infinity: unit vector towards it in the target frame, and its irradiance."""

    name: str
    direction_in_target: tuple[float, float, float]
    irradiance_w_m2: float
    angular_diameter_deg: float


@dataclass(frozen=True, eq=False)
class NeutralMesh:
    """Triangles of one label and material.

    Attributes
    ----------
    label, material : str
    vertices : (n, 3) float32 array, m
    faces : (m, 3) int32 array
    normals : (n, 3) float32 array or None
        At the vertices where shading is smooth; None where it is flat.
    """

    label: str
    material: str
    vertices: AnyArray
    faces: AnyArray
    normals: AnyArray | None

    @property
    def region(self) -> str:
        """What is compared as one: a label's share of one material."""
        return f"{self.label}, {self.material}"


@dataclass(frozen=True, eq=False)
class NeutralScene:
    """What both renderers build.

    Attributes
    ----------
    camera : Camera
        Without distortion and with square pixels.
    cam_from_target : RigidTransform
    suns : tuple of NeutralSun
    materials : dict of NeutralMaterial, by name
    meshes : tuple of NeutralMesh
    """

    camera: Camera
    cam_from_target: RigidTransform
    suns: tuple[NeutralSun, ...]
    materials: dict[str, NeutralMaterial]
    meshes: tuple[NeutralMesh, ...]

    @property
    def regions(self) -> tuple[str, ...]:
        """Names of the regions in order of first use; pixels of region k are labelled k + 1."""
        return tuple(dict.fromkeys(mesh.region for mesh in self.meshes))

    def lit_by(self, suns: tuple[NeutralSun, ...]) -> NeutralScene:
        """Return the same scene under other Suns."""
        return replace(self, suns=suns)

    def write(self, folder: Path) -> None:
        """Write the scene into a folder, which is made.

        Raises
        ------
        ValueError
            If the camera is distorted or its pixels are not square.
        """
        if self.camera.distorted or self.camera.fx != self.camera.fy:
            raise ValueError("expected a pinhole camera with square pixels, got a distorted one")
        folder.mkdir(parents=True, exist_ok=True)
        arrays: dict[str, AnyArray] = {}
        for number, mesh in enumerate(self.meshes):
            arrays[f"vertices_{number}"] = mesh.vertices.astype(np.float32)
            arrays[f"faces_{number}"] = mesh.faces.astype(np.int32)
            if mesh.normals is not None:
                arrays[f"normals_{number}"] = mesh.normals.astype(np.float32)
        np.savez(folder / "meshes.npz", **arrays)  # type: ignore[arg-type]
        target_from_cam = self.cam_from_target.inverse()
        table = {
            "camera": {
                name: getattr(self.camera, name) for name in ("width", "height", "fx", "cx", "cy")
            },
            "target_from_cam": {
                "rotation": target_from_cam.rotation.tolist(),
                "translation": target_from_cam.translation.tolist(),
            },
            "suns": [asdict(sun) for sun in self.suns],
            "materials": {name: asdict(material) for name, material in self.materials.items()},
            "meshes": [
                {"label": mesh.label, "material": mesh.material, "smooth": mesh.normals is not None}
                for mesh in self.meshes
            ],
        }
        (folder / "scene.json").write_text(json.dumps(table, indent=1))


def read_pose(pose: dict[str, Any]) -> RigidTransform:
    """Return ``cam_from_target`` of a camera's place in the target frame, as a file has it."""
    rotation: Floats = np.array(pose["rotation"])
    return RigidTransform(rotation, np.array(pose["translation"])).inverse()


def read_scene(folder: Path) -> NeutralScene:
    """Read a scene that ``NeutralScene.write`` wrote."""
    table = json.loads((folder / "scene.json").read_text())
    camera = table["camera"]
    with np.load(folder / "meshes.npz") as arrays:
        meshes = tuple(
            NeutralMesh(
                entry["label"],
                entry["material"],
                arrays[f"vertices_{number}"],
                arrays[f"faces_{number}"],
                arrays[f"normals_{number}"] if entry["smooth"] else None,
            )
            for number, entry in enumerate(table["meshes"])
        )
    return NeutralScene(
        camera=Camera(
            camera["width"],
            camera["height"],
            camera["fx"],
            camera["fx"],
            camera["cx"],
            camera["cy"],
        ),
        cam_from_target=read_pose(table["target_from_cam"]),
        suns=tuple(
            NeutralSun(**{**sun, "direction_in_target": tuple(sun["direction_in_target"])})
            for sun in table["suns"]
        ),
        materials={name: NeutralMaterial(**m) for name, m in table["materials"].items()},
        meshes=meshes,
    )

"""Our half of the check: a neutral scene through ``render_radiance``, or through bare Mitsuba.

Usage: ``python -m bench.cycles.our_side JOB.json``; ``bench.cycles.jobs`` tells what a job is.
"""

from __future__ import annotations

import json
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

from bench.cycles.neutral_scene import (
    NeutralMaterial,
    NeutralScene,
    NeutralSun,
    read_pose,
    read_scene,
)
from models.arrays import AnyArray, Radiance
from models.pose import RigidTransform
from renders.tracing.light_groups import SUNLIGHT, SunGroup
from renders.tracing.surfaces import Surface, bsdf_dict
from renders.variant.choice import activate, choose_variant

CLEARANCE_M = 2e-4  # shadow rays of the truth start this far above the surface
FAR_M = 1e3  # beyond anything in the scene


def surface_of(material: NeutralMaterial) -> Surface:
    """Return a neutral material's lobes: its two parts add up, grey."""
    matt, mirror = (material.diffuse,) * 3, (material.specular,) * 3
    return Surface(matt, mirror, material.alpha)


def geometry_of(scene: NeutralScene) -> Any:
    """Return the scene's ``renders.tracing.scene.SceneGeometry``."""
    import mitsuba as mi

    from renders.tracing.scene import SceneGeometry

    surfaces = {name: surface_of(material) for name, material in scene.materials.items()}
    bsdfs = {name: mi.load_dict(bsdf_dict(surface)) for name, surface in surfaces.items()}
    shapes, label_of_shape, surface_of_shape = {}, {}, {}
    for number, mesh in enumerate(scene.meshes):
        key = f"mesh_{number:03d}"
        props = mi.Properties()
        props["mesh_bsdf"] = bsdfs[mesh.material]
        smooth = mesh.normals is not None
        if not smooth:
            props["face_normals"] = True
        shape = mi.Mesh(key, len(mesh.vertices), len(mesh.faces), props, smooth, False)
        params = mi.traverse(shape)
        params["vertex_positions"] = np.ravel(mesh.vertices).astype(np.float32)
        params["faces"] = np.ravel(mesh.faces).astype(np.uint32)
        if mesh.normals is not None:
            params["vertex_normals"] = np.ravel(mesh.normals).astype(np.float32)
        params.update()
        shapes[key] = shape
        label_of_shape[key] = scene.regions.index(mesh.region) + 1
        surface_of_shape[key] = surfaces[mesh.material]
    return SceneGeometry(shapes, scene.regions, label_of_shape, surface_of_shape)


def sun_group(sun: NeutralSun) -> SunGroup:
    """Return a Sun as our renderer's light group."""
    return SunGroup(
        sun.name, sun.direction_in_target, sun.irradiance_w_m2, sun.angular_diameter_deg
    )


def write_exr(path: Path, images: dict[str, Radiance]) -> None:
    """Write radiance as float32 channels, uncompressed, as the other side does.

    Parameters
    ----------
    path : Path
    images : dict of str to (height, width) arrays, W m-2 sr-1
        By channel's name.
    """
    header = {"compression": OpenEXR.NO_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, images) as file:
        file.write(str(path))


class OurRenderer:
    """A scene ready to be rendered by ``render_radiance``."""

    def __init__(self, neutral: NeutralScene, max_depth: int) -> None:
        self.neutral, self.max_depth = neutral, max_depth
        self.geometry = geometry_of(neutral)
        self.scene = self.geometry.scene()

    def look(self, cam_from_target: RigidTransform) -> None:
        """Move the camera; the scene stays."""
        self.neutral = replace(self.neutral, cam_from_target=cam_from_target)

    def render(self, suns: list[NeutralSun], samples: int, seed: int) -> dict[str, Radiance]:
        """Render the Suns, all in one pass.

        Parameters
        ----------
        suns : list of NeutralSun
        samples : int
            Per pixel.
        seed : int

        Returns
        -------
        dict of str to (height, width) arrays, W m-2 sr-1
            By Sun.
        """
        from renders.tracing.radiance import Sampling, render_radiance
        from renders.tracing.silhouette import pixels_in_view

        sampling = Sampling(samples, samples, self.max_depth, seed)
        camera, cam_from_target = self.neutral.camera, self.neutral.cam_from_target
        groups = [sun_group(sun) for sun in suns]
        pieces = (mesh.vertices for mesh in self.neutral.meshes)
        in_view = pixels_in_view(pieces, camera, cam_from_target)
        return render_radiance(
            self.scene, self.geometry, camera, cam_from_target, groups, None, sampling, in_view
        )

    def truth(self) -> dict[str, AnyArray]:
        """Return what each pixel's centre shows, and which Suns it faces and sees.

        Returns
        -------
        dict of (height, width) arrays
            ``labels``; ``normals`` (with three components, in the target frame, facing the
            camera); ``facing_NAME`` and ``lit_NAME`` for each Sun.
        """
        from renders.truth.pixel_truth import pixel_truth, unoccluded

        camera, cam_from_target = self.neutral.camera, self.neutral.cam_from_target
        truth = pixel_truth(self.scene, self.geometry, camera, cam_from_target)
        rows, columns = np.nonzero(truth.labels)
        normals = truth.normals_in_target.astype(np.float64)
        rays = camera.rays(np.stack([columns, rows], axis=1))
        in_cam = rays * (truth.depth_m[rows, columns] / rays[:, 2])[:, None]
        target_from_cam = cam_from_target.inverse()
        there = normals[rows, columns]
        there *= -np.sign((there * target_from_cam.rotate(rays)).sum(axis=1))[:, None]
        normals[rows, columns] = there
        points = target_from_cam @ in_cam + CLEARANCE_M * there
        arrays: dict[str, AnyArray] = {"labels": truth.labels, "normals": normals}
        for sun in self.neutral.suns:
            towards = np.array(sun.direction_in_target)
            facing, lit = np.zeros((2, *truth.labels.shape), dtype=bool)
            facing[rows, columns] = there @ towards > 0.0
            lit[rows, columns] = unoccluded(self.scene, points, points + FAR_M * towards)
            arrays |= {f"facing_{sun.name}": facing, f"lit_{sun.name}": lit & facing}
        return arrays


class BareMitsuba:
    """The same scene rendered by Mitsuba's own ``path`` integrator and ``directional`` light."""

    def __init__(self, neutral: NeutralScene, max_depth: int) -> None:
        import mitsuba as mi

        from renders.tracing.camera_plugin import sensor_dict

        (sun,) = neutral.suns
        towards = np.array(sun.direction_in_target)
        up = np.eye(3)[int(np.argmin(np.abs(towards)))]
        light = {
            "type": "directional",
            "to_world": mi.ScalarTransform4f().look_at(
                origin=[0.0, 0.0, 0.0], target=(-towards).tolist(), up=up.tolist()
            ),
            "irradiance": {"type": "rgb", "value": [sun.irradiance_w_m2] * 3},
        }
        film = {
            "type": "hdrfilm",
            "width": neutral.camera.width,
            "height": neutral.camera.height,
            "rfilter": {"type": "box"},
            "pixel_format": "rgb",
            "component_format": "float32",
        }
        self.scene = geometry_of(neutral).scene(sun=light)
        self.sensor = sensor_dict(neutral.camera, neutral.cam_from_target, film)
        # In Mitsuba's count a light is a vertex too; Russian roulette is off, as in ours.
        path = {"type": "path", "max_depth": max_depth + 1, "rr_depth": 10_000}
        self.integrator = mi.load_dict(path)

    def render(self, suns: list[NeutralSun], samples: int, seed: int) -> dict[str, Radiance]:
        """Render the one Sun that the scene has.

        Parameters
        ----------
        suns : list of NeutralSun
            One.
        samples : int
            Per pixel.
        seed : int

        Returns
        -------
        dict of str to (height, width) arrays, W m-2 sr-1
            By Sun.
        """
        import mitsuba as mi

        sampler = {"type": "stratified", "sample_count": samples}
        sensor = mi.load_dict(self.sensor | {"sampler": sampler})
        image = mi.render(
            self.scene, sensor=sensor, integrator=self.integrator, spp=samples, seed=seed
        )
        return {suns[0].name: np.array(image)[..., SUNLIGHT]}


def now(event: str) -> tuple[str, float, float]:
    """Return an event with the time of day and the processor's time, all threads', s."""
    return event, time.time(), time.process_time()


def main(job_file: Path) -> None:
    """Do a job and write the clock's readings beside it."""
    job = json.loads(job_file.read_text())
    clock = [now("imported")]
    activate(choose_variant(job["variant"]))
    neutral = read_scene(Path(job["scene"]))
    by_name = {sun.name: sun for sun in neutral.suns}
    if job["integrator"] == "path":
        renderer: OurRenderer | BareMitsuba = BareMitsuba(neutral, job["max_depth"])
    else:
        renderer = OurRenderer(neutral, job["max_depth"])
    clock.append(now("ready"))
    for task in job["renders"]:
        suns = [by_name[name] for name in task["suns"]]
        if task["target_from_cam"] and isinstance(renderer, OurRenderer):
            renderer.look(read_pose(task["target_from_cam"]))
        images = renderer.render(suns, task["samples"], task["seed"])
        clock.append(now("rendered"))
        write_exr(Path(task["out"]), images)
        clock.append(now("written"))
    if job["truth"] and isinstance(renderer, OurRenderer):
        np.savez(job["truth"], **renderer.truth())  # type: ignore[arg-type]
    job_file.with_suffix(".clock.json").write_text(json.dumps(clock))


if __name__ == "__main__":
    main(Path(sys.argv[1]))

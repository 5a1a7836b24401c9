"""Blender Cycles' half of the check: a neutral scene through ``bpy``, in an environment of its own.

Usage: ``python blender_side.py JOB.json``; ``bench.cycles.jobs`` tells what a job is. It imports
nothing of the house: numpy and bpy are all that its environment has.

Cycles is set to solve the same problem as our side: single-scattering GGX (its roughness r means
alpha = r**2), the same number of bounces, a box filter one pixel wide, linear 32-bit EXR; no
denoising, no clamping, no adaptive sampling, no path guiding, no softened caustics.
"""

from __future__ import annotations

import json
import math
import sys
import time
from pathlib import Path
from typing import Any

import bpy
import mathutils
import numpy as np

BLENDER_FROM_CAM = np.diag([1.0, -1.0, -1.0])  # Blender's camera looks along -z, +y up
SENSOR_MM = 36.0


def matrix(rotation: Any, translation: Any) -> Any:
    """Return a 4 x 4 Blender matrix."""
    whole = np.eye(4)
    whole[:3, :3] = rotation
    whole[:3, 3] = translation
    return mathutils.Matrix(whole.tolist())


def make_material(name: str, table: dict[str, float]) -> Any:
    """Return a diffuse and a glossy closure added up."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (*[table["diffuse"]] * 3, 1.0)
    diffuse.inputs["Roughness"].default_value = 0.0
    glossy = tree.nodes.new("ShaderNodeBsdfAnisotropic")
    glossy.distribution = "GGX"
    glossy.inputs["Color"].default_value = (*[table["specular"]] * 3, 1.0)
    glossy.inputs["Roughness"].default_value = math.sqrt(table["alpha"])
    glossy.inputs["Anisotropy"].default_value = 0.0
    both = tree.nodes.new("ShaderNodeAddShader")
    out = tree.nodes.new("ShaderNodeOutputMaterial")
    surface = both.outputs[0]
    if table["specular"] == 0.0 or table["diffuse"] == 0.0:
        surface = (diffuse if table["specular"] == 0.0 else glossy).outputs[0]
    else:
        tree.links.new(diffuse.outputs[0], both.inputs[0])
        tree.links.new(glossy.outputs[0], both.inputs[1])
    tree.links.new(surface, out.inputs["Surface"])
    return material


def make_mesh(name: str, vertices: Any, faces: Any, normals: Any, material: Any) -> Any:
    """Return an object of triangles, flat or with vertex normals.

    Parameters
    ----------
    name : str
    vertices : (n, 3) array, m
    faces : (f, 3) array of int
    normals : (n, 3) array, or None
        None is flat.
    material : bpy material
    """
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.ravel())
    mesh.loops.add(3 * len(faces))
    mesh.loops.foreach_set("vertex_index", faces.ravel())
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * len(faces), 3, dtype=np.int32))
    mesh.materials.append(material)
    mesh.update(calc_edges=True)
    mesh.polygons.foreach_set("use_smooth", np.full(len(faces), normals is not None))
    if normals is not None:
        mesh.normals_split_custom_set_from_vertices(normals.tolist())
    mesh.update()
    thing = bpy.data.objects.new(name, mesh)
    thing.cycles.shadow_terminator_geometry_offset = 0.0  # moves shadow rays: ours stay
    thing.cycles.shadow_terminator_offset = 0.0
    bpy.context.scene.collection.objects.link(thing)
    return thing


def make_sun(table: dict[str, Any]) -> Any:
    """Return a Sun lamp; Cycles' strength is the irradiance of a surface that faces it."""
    light = bpy.data.lights.new(table["name"], "SUN")
    light.energy = table["irradiance_w_m2"]
    light.angle = math.radians(table["angular_diameter_deg"])
    light.color = (1.0, 1.0, 1.0)
    lamp = bpy.data.objects.new(table["name"], light)
    towards = mathutils.Vector(table["direction_in_target"])
    lamp.matrix_world = towards.to_track_quat("Z", "Y").to_matrix().to_4x4()
    bpy.context.scene.collection.objects.link(lamp)
    return lamp


def place_camera(pose: dict[str, Any]) -> None:
    """Put the camera where it is in the target frame."""
    rotation = np.array(pose["rotation"]) @ BLENDER_FROM_CAM
    bpy.context.scene.camera.matrix_world = matrix(rotation, pose["translation"])


def make_camera(table: dict[str, Any], pose: dict[str, Any]) -> None:
    """Put the camera in its place; its principal point is a shift in units of the width."""
    width, height = table["width"], table["height"]
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "HORIZONTAL"
    data.sensor_width = SENSOR_MM
    data.lens = table["fx"] / width * SENSOR_MM
    data.shift_x = (0.5 * (width - 1) - table["cx"]) / width
    data.shift_y = (table["cy"] - 0.5 * (height - 1)) / width
    data.clip_start, data.clip_end = 1e-3, 1e4
    camera = bpy.data.objects.new("camera", data)
    scene = bpy.context.scene
    scene.collection.objects.link(camera)
    scene.camera = camera
    place_camera(pose)
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100


def set_up_cycles(job: dict[str, Any]) -> None:
    """Choose Cycles on the CPU, and turn off all that trades truth for smoothness."""
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.threads_mode, render.threads = "FIXED", job["threads"]
    render.use_persistent_data = job["persistent"]
    render.film_transparent = False
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_guiding = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    bounces = job["max_depth"] - 1  # beyond the first surface
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = bounces
    cycles.transmission_bounces = cycles.volume_bounces = 0
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.use_auto_tile = False
    cycles.film_exposure = 1.0
    cycles.sampling_pattern = "BLUE_NOISE"  # at 16 samples a tenth less noise than tabulated Sobol
    cycles.light_sampling_threshold = 0.0
    for key, value in job["cycles"].items():
        setattr(cycles, key, value)
    world = bpy.data.worlds.new("space")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    scene.world = world
    scene.view_settings.view_transform = "Raw"
    scene.view_settings.look = "None"


def write_as(kind: str, media: str) -> None:
    """Choose 32-bit EXR without compression, of one layer or of many."""
    settings = bpy.context.scene.render.image_settings
    if hasattr(settings, "media_type"):  # Blender 5.0 and later
        settings.media_type = media
    settings.file_format = kind
    settings.color_depth = "32"
    settings.exr_codec = "NONE"
    if media == "IMAGE":
        settings.color_mode = "RGB"


def light_groups(lamps: dict[str, Any], names: list[str]) -> None:
    """Give each Sun of a render its own light group; one Sun alone needs none."""
    layer = bpy.context.view_layer
    while len(layer.lightgroups):
        layer.lightgroups.remove(layer.lightgroups[0])
    if len(names) == 1:
        write_as("OPEN_EXR", "IMAGE")
        return
    write_as("OPEN_EXR_MULTILAYER", "MULTI_LAYER_IMAGE")
    for name in names:
        layer.lightgroups.add(name=name)
        lamps[name].lightgroup = name


def build(table: dict[str, Any], arrays: Any) -> dict[str, Any]:
    """Build the neutral scene; return its Sun lamps by name."""
    materials = {name: make_material(name, entry) for name, entry in table["materials"].items()}
    for number, entry in enumerate(table["meshes"]):
        make_mesh(
            f"mesh_{number:03d}",
            arrays[f"vertices_{number}"],
            arrays[f"faces_{number}"],
            arrays[f"normals_{number}"] if entry["smooth"] else None,
            materials[entry["material"]],
        )
    make_camera(table["camera"], table["target_from_cam"])
    return {sun["name"]: make_sun(sun) for sun in table["suns"]}


def now(event: str) -> tuple[str, float, float]:
    """Return an event with the time of day and the processor's time, all threads', s."""
    return event, time.time(), time.process_time()


def main(job_file: Path) -> None:
    """Do a job and write the clock's readings beside it."""
    clock = [now("imported")]
    job = json.loads(job_file.read_text())
    folder = Path(job["scene"])
    bpy.ops.wm.read_factory_settings(use_empty=True)
    set_up_cycles(job)
    with np.load(folder / "meshes.npz") as arrays:
        lamps = build(json.loads((folder / "scene.json").read_text()), arrays)
    clock.append(now("ready"))
    scene = bpy.context.scene
    # Cycles renders and writes in one call: what it reports by these is when its light was done.
    bpy.app.handlers.render_post.append(lambda *_: clock.append(now("rendered")))
    for task in job["renders"]:
        for name, lamp in lamps.items():
            lamp.hide_render = name not in task["suns"]
        light_groups(lamps, task["suns"])
        if task["target_from_cam"]:
            place_camera(task["target_from_cam"])
        scene.cycles.samples = task["samples"]
        scene.cycles.seed = task["seed"]
        scene.render.filepath = task["out"]
        bpy.ops.render.render(write_still=True)
        clock.append(now("written"))
    job_file.with_suffix(".clock.json").write_text(json.dumps(clock))


if __name__ == "__main__":
    main(Path(sys.argv[1]))

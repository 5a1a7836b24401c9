"""Small spacecraft of one's own: a boxy satellite with a texture, as STL in mm, and broken."""

from __future__ import annotations

import io
import json
import struct
from pathlib import Path

import numpy as np
import trimesh
from PIL import Image

BUS_M = (1.2, 0.9, 1.5)
PANEL_M = (2.4, 0.8, 0.03)
BOOM_M = (0.1, 0.1, 1.1)
TEXTURE_RED = (230, 20)  # sRGB of its left and right half


def boxes():
    """Return the satellite's parts, m: a bus, one panel on +x, a boom on top; without symmetry."""
    bus = trimesh.creation.box(BUS_M)
    panel = trimesh.creation.box(PANEL_M)
    panel.apply_translation([0.5 * BUS_M[0] + 0.1 + 0.5 * PANEL_M[0], 0.1, 0.3])
    boom = trimesh.creation.box(BOOM_M)
    boom.apply_translation([-0.3, 0.2, 0.5 * (BUS_M[2] + BOOM_M[2])])
    return {"bus": bus, "panel": panel, "boom": boom}


def textured_glb(path: Path, *, scale: float = 1.0) -> Path:
    """Write the satellite as GLB: a metal bus, a panel with a texture, a boom without a look."""
    parts = boxes()
    for mesh in parts.values():
        mesh.apply_scale(scale)
    parts["bus"].visual = trimesh.visual.TextureVisuals(
        material=trimesh.visual.material.PBRMaterial(
            name="foil",
            baseColorFactor=[0.8, 0.6, 0.2, 1.0],
            metallicFactor=1.0,
            roughnessFactor=0.5,
        )
    )
    image = np.zeros((8, 8, 3), dtype=np.uint8)
    image[:, :4], image[:, 4:] = (TEXTURE_RED[0], 90, 90), (TEXTURE_RED[1], 20, 90)
    panel = parts["panel"]
    flat = panel.triangles.reshape(-1, 3)
    uv = np.full((len(flat), 2), 0.25)
    uv[np.repeat(panel.face_normals[:, 2] > 0.5, 3)] = [0.75, 0.5]
    parts["panel"] = trimesh.Trimesh(
        flat,
        np.arange(len(flat)).reshape(-1, 3),
        process=False,
        visual=trimesh.visual.TextureVisuals(
            uv=uv,
            material=trimesh.visual.material.PBRMaterial(
                name="cells",
                baseColorTexture=Image.fromarray(image),
                metallicFactor=0.0,
                roughnessFactor=0.4,
            ),
        ),
    )
    scene = trimesh.Scene()
    for name, mesh in parts.items():
        scene.add_geometry(mesh, node_name=name, geom_name=name)
    path.write_bytes(scene.export(file_type="glb"))
    return path


def millimetre_stl(path: Path) -> Path:
    """Write the satellite as binary STL in mm, all parts in one."""
    mesh = trimesh.util.concatenate([*boxes().values()])
    mesh.apply_scale(1000.0)
    path.write_bytes(mesh.export(file_type="stl"))
    return path


def broken_ply(path: Path) -> Path:
    """Write the satellite with a hole, a body inside out, a face twice and one without area."""
    parts = boxes()
    parts["boom"].invert()
    mesh = trimesh.util.concatenate([*parts.values()])
    faces = np.asarray(mesh.faces)
    a = faces[5]
    faces = np.concatenate([faces[1:], faces[3:4], [[a[0], a[0], a[1]]]])
    path.write_bytes(trimesh.Trimesh(mesh.vertices, faces, process=False).export(file_type="ply"))
    return path


def toml_of(mesh: Path, *more: str, name: str = "boxsat") -> Path:
    """Write the TOML beside a mesh, with lines of one's own."""
    path = mesh.with_suffix(".toml")
    path.write_text("\n".join([f'name = "{name}"', f'mesh = "{mesh.name}"', *more]) + "\n")
    return path


def gltf_tree(**changes):
    """Return the JSON of a glTF of one triangle with its bytes in a file ``data.bin``."""
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data.bin"}],
    }
    return {**tree, **changes}


TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4").tobytes()


def write_gltf(path: Path, tree, data: bytes = TRIANGLE) -> Path:
    """Write a glTF and its bytes beside it."""
    path.write_text(json.dumps(tree))
    (path.parent / "data.bin").write_bytes(data)
    return path


def glb_bytes(tree, data: bytes = TRIANGLE) -> bytes:
    """Return a GLB of that JSON and those bytes."""
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    out = io.BytesIO()
    total = 12 + 8 + len(text) + 8 + len(data)
    out.write(struct.pack("<4sII", b"glTF", 2, total))
    out.write(struct.pack("<II", len(text), 0x4E4F534A) + text)
    out.write(struct.pack("<II", len(data), 0x004E4942) + data)
    return out.getvalue()

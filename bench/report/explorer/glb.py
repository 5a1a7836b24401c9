"""Triangles as binary glTF 2.0, for a page's scene; the same bytes for the same triangles."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from models.arrays import Floats, Indices

MAGIC, VERSION = b"glTF", 2
JSON_CHUNK, BINARY_CHUNK = b"JSON", b"BIN\0"
FLOAT32, UINT32 = 5126, 5125  # the format's numbers
VERTICES, INDICES = 34962, 34963


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles of one shade.

    Attributes
    ----------
    name : str
    vertices : (v, 3) array, m
    faces : (f, 3) array of int
    shade : (float, float, float)
        Red, green and blue, linear, 0 to 1.
    """

    name: str
    vertices: Floats
    faces: Indices
    shade: tuple[float, float, float]


def glb_bytes(surfaces: Sequence[Surface]) -> bytes:
    """Return a GLB of some surfaces, each a mesh and a node of its own, without normals.

    Parameters
    ----------
    surfaces : sequence of Surface

    Raises
    ------
    ValueError
        If a surface has no triangle.
    """
    binary = bytearray()
    views: list[dict[str, Any]] = []
    accessors: list[dict[str, Any]] = []

    def view(data: bytes, target: int) -> int:
        views.append(
            {"buffer": 0, "byteOffset": len(binary), "byteLength": len(data), "target": target}
        )
        binary.extend(data)
        return len(views) - 1

    meshes: list[dict[str, Any]] = []
    for number, surface in enumerate(surfaces):
        if not len(surface.faces):
            raise ValueError(f"{surface.name}: expected triangles, got none")
        vertices = np.ascontiguousarray(surface.vertices, dtype="<f4")
        faces = np.ascontiguousarray(surface.faces, dtype="<u4")
        first = len(accessors)
        accessors += [
            {
                "bufferView": view(vertices.tobytes(), VERTICES),
                "componentType": FLOAT32,
                "count": len(vertices),
                "type": "VEC3",
                "min": [float(x) for x in vertices.min(axis=0)],
                "max": [float(x) for x in vertices.max(axis=0)],
            },
            {
                "bufferView": view(faces.tobytes(), INDICES),
                "componentType": UINT32,
                "count": faces.size,
                "type": "SCALAR",
            },
        ]
        primitive = {"attributes": {"POSITION": first}, "indices": first + 1, "material": number}
        meshes.append({"name": surface.name, "primitives": [primitive]})
    tree = {
        "asset": {"version": f"{VERSION}.0", "generator": "rvbench"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(meshes)))}],
        "nodes": [{"mesh": number, "name": s.name} for number, s in enumerate(surfaces)],
        "meshes": meshes,
        "materials": [
            {
                "name": surface.name,
                "doubleSided": True,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [*surface.shade, 1.0],
                    "metallicFactor": 0.0,
                },
            }
            for surface in surfaces
        ],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
    }
    text = json.dumps(tree, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = _chunk(JSON_CHUNK, text) + _chunk(BINARY_CHUNK, bytes(binary))
    return MAGIC + struct.pack("<II", VERSION, 12 + len(chunks)) + chunks


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack("<I", len(data)) + kind + data

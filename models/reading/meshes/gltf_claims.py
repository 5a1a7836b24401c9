"""glTF and GLB: every length, count and index held against the bytes that are there.

Khronos Group, glTF 2.0 Specification (2021), sections 3.5 to 3.9 and 4.4. A parser that trusts
``"count": 1000000000`` asks for twelve gigabytes before it sees that there are none.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from models.errors import DatasetError, UnreadableError
from models.reading.fields import Fields
from models.reading.json_file import parse_json_table
from models.reading.meshes.bounds import (
    MOST_FACES,
    MOST_IMAGES,
    MOST_MESH_BYTES,
    MOST_NODES,
    MOST_TEXT_MESH_BYTES,
    MOST_VERTICES,
)
from models.reading.meshes.neighbours import Neighbours
from models.reading.regular_file import MEGABYTE
from models.reading.shown import shown

MAGIC, JSON_CHUNK = b"glTF", 0x4E4F534A
MOST_JSON_BYTES = 32 * MEGABYTE
COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
MOST_DEPTH = 200  # of nodes in nodes
MOST_URI = 2 * MOST_MESH_BYTES
KNOWN_EXTENSIONS = ("KHR_materials_", "KHR_texture_transform", "KHR_mesh_quantization")
DATA = "data:"


@dataclass(frozen=True)
class View:
    """A stretch of a buffer.

    Attributes
    ----------
    length : int, bytes
    stride : int, bytes
        From one element to the next; 0 where they follow each other.
    """

    length: int
    stride: int

    @classmethod
    def of(cls, row: Fields, buffers: list[int]) -> View:
        """Read a view; all of it lies within its buffer.

        Parameters
        ----------
        row : Fields
        buffers : list of int
            Their lengths.
        """
        size = buffers[row.whole("buffer", 0, len(buffers) - 1)]
        start = _whole(row, "byteOffset", 0, size, 0)
        length = row.whole("byteLength", 1, max(size - start, 1))
        return cls(length, _whole(row, "byteStride", 4, 252, 0))


def glb_tree(path: Path, data: bytes) -> tuple[dict[str, Any], int]:
    """Return the JSON of a GLB file and the length of its binary chunk.

    Raises
    ------
    UnreadableError
        If it is no GLB of version 2, or its lengths are not those of the file.
    """
    if len(data) < 20 or data[:4] != MAGIC:
        raise UnreadableError(path, "expected a GLB file, which begins with 'glTF'")
    version, length, json_bytes, kind = struct.unpack_from("<4I", data, 4)
    if version != 2:
        raise UnreadableError(path, f"expected GLB version 2, got {version}; export it anew")
    if length != len(data):
        raise UnreadableError(
            path, f"expected a file of {length} bytes, as it says, got {len(data)}; is it whole?"
        )
    if kind != JSON_CHUNK or json_bytes > min(len(data) - 20, MOST_JSON_BYTES):
        raise UnreadableError(path, "expected its first chunk to be JSON, and to lie within it")
    rest = len(data) - 20 - json_bytes
    binary = struct.unpack_from("<I", data, 20 + json_bytes)[0] if rest >= 8 else 0
    if binary > max(rest - 8, 0):
        raise UnreadableError(
            path, f"expected a binary chunk of {binary} bytes, as it says, got {rest - 8}"
        )
    return _tree(path, data[20 : 20 + json_bytes]), binary


def gltf_tree(path: Path, data: bytes) -> dict[str, Any]:
    """Return the JSON of a glTF file.

    Raises
    ------
    UnreadableError
        If it is none.
    """
    return _tree(path, data)


def check_gltf(tree: dict[str, Any], binary: int, neighbours: Neighbours) -> None:
    """Hold everything that a glTF's JSON claims against what is there.

    Parameters
    ----------
    tree : dict
    binary : int
        Bytes of the GLB's own chunk; 0 in a .gltf.
    neighbours : Neighbours

    Raises
    ------
    DatasetError
        The message names file and key.
    """
    path = neighbours.mesh
    fields = Fields(tree, path)
    _check_extensions(fields)
    buffers = [
        _buffer(row, k, binary, neighbours) for k, row in enumerate(_rows(fields, "buffers"))
    ]
    views = [View.of(row, buffers) for row in _rows(fields, "bufferViews")]
    accessors = _rows(fields, "accessors")
    counts = [_accessor(row, views) for row in accessors]
    sizes = [_mesh(row, accessors, counts) for row in _rows(fields, "meshes")]
    _check_images(fields, views, neighbours)
    _check_nodes(fields, sizes)


def _tree(path: Path, data: bytes) -> dict[str, Any]:
    if len(data) > MOST_TEXT_MESH_BYTES:
        raise UnreadableError(path, f"more than {MOST_TEXT_MESH_BYTES / MEGABYTE:g} MB of JSON")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UnreadableError(path, "expected its JSON as UTF-8") from error
    tree = parse_json_table(path, text)
    asset = Fields(tree, path).table("asset")
    if not str(asset.value("version")).startswith("2."):
        raise UnreadableError(
            path, f"expected glTF version 2, got {shown(asset.value('version'))}; export it anew"
        )
    return tree


def _rows(fields: Fields, key: str) -> list[Fields]:
    return fields.tables(key, MOST_VERTICES) if key in fields else []


def _whole(row: Fields, key: str, low: int, high: int, default: int) -> int:
    return row.whole(key, low, high) if key in row else default


def _check_extensions(fields: Fields) -> None:
    if "extensionsRequired" not in fields:
        return
    strange = [
        name
        for name in fields.texts("extensionsRequired", 100)
        if not name.startswith(KNOWN_EXTENSIONS)
    ]
    if strange:
        raise fields.refusal(
            "extensionsRequired",
            "to be of materials alone; export it again without compression",
            ", ".join(strange),
        )


def _buffer(row: Fields, number: int, binary: int, neighbours: Neighbours) -> int:
    """Return how many bytes a buffer has; what it claims lies within them."""
    claimed = row.whole("byteLength", 1, MOST_MESH_BYTES)
    if "uri" not in row:
        there = binary if number == 0 else 0
    else:
        uri = _uri(row)
        if uri.startswith(DATA):
            there = 3 * (len(uri) - uri.find(",") - 1) // 4
        else:
            data = neighbours.get(uri)
            if data is None:
                raise row.refusal("uri", "to name a file beside it", f"{shown(uri)}, which is not")
            there = len(data)
    if claimed > there:
        raise row.refusal("byteLength", f"of at most the {there} bytes that are there", claimed)
    return claimed


def _uri(row: Fields) -> str:
    uri = row.value("uri")
    if not isinstance(uri, str) or len(uri) > MOST_URI:
        raise row.refusal("uri", "to be text", shown(uri))
    return uri


def _accessor(row: Fields, views: list[View]) -> int:
    """Return how many elements an accessor has, all within its view."""
    count = row.whole("count", 1, 3 * MOST_VERTICES)
    if row.value("componentType") not in COMPONENT_BYTES:
        expected = f"among {', '.join(map(str, COMPONENT_BYTES))}"
        raise row.refusal("componentType", expected, shown(row.value("componentType")))
    each = COMPONENT_BYTES[row.value("componentType")] * COMPONENTS[row.choice("type", COMPONENTS)]
    if "bufferView" not in row and "sparse" not in row:
        raise row.refusal("bufferView", "to tell where its data are", "none")
    if "sparse" in row:
        sparse = row.table("sparse")
        sparse.whole("count", 1, count)
        for part in ("indices", "values"):
            sparse.table(part).whole("bufferView", 0, len(views) - 1)
    if "bufferView" in row:
        view = views[row.whole("bufferView", 0, len(views) - 1)]
        start = _whole(row, "byteOffset", 0, view.length, 0)
        if start + (count - 1) * (view.stride or each) + each > view.length:
            raise row.refusal(
                "count",
                f"of elements that lie in its view of {view.length} bytes",
                f"{count} of {each}",
            )
    return count


def _mesh(row: Fields, accessors: list[Fields], counts: list[int]) -> int:
    """Return how many corners of faces a mesh has at most."""
    corners = 0
    for primitive in row.tables("primitives", MOST_NODES):
        attributes = primitive.table("attributes")
        for name in attributes:
            attributes.whole(name, 0, len(counts) - 1)
        if "POSITION" not in attributes:
            raise attributes.refusal("POSITION", "for every primitive", "none")
        place = attributes.whole("POSITION", 0, len(counts) - 1)
        if accessors[place].value("type") != "VEC3":
            raise attributes.refusal("POSITION", "as VEC3", shown(accessors[place].value("type")))
        if counts[place] > MOST_VERTICES:
            raise attributes.refusal("POSITION", f"of at most {MOST_VERTICES}", counts[place])
        index = _whole(primitive, "indices", 0, len(counts) - 1, place)
        corners += counts[index] * (3 if _whole(primitive, "mode", 0, 6, 4) in (5, 6) else 1)
    return corners


def _check_images(fields: Fields, views: list[View], neighbours: Neighbours) -> None:
    images = _rows(fields, "images")
    if len(images) > MOST_IMAGES:
        raise fields.refusal("images", f"of at most {MOST_IMAGES}", len(images))
    for row in images:
        if "bufferView" in row:
            row.whole("bufferView", 0, len(views) - 1)
        elif "uri" in row and not (uri := _uri(row)).startswith(DATA):
            neighbours.get(uri)


def _check_nodes(fields: Fields, sizes: list[int]) -> None:
    """Refuse nodes in a circle, and copies of meshes that would fill the memory."""
    nodes = _rows(fields, "nodes")
    if len(nodes) > MOST_NODES:
        raise fields.refusal("nodes", f"of at most {MOST_NODES}", f"{len(nodes)}")
    children = [
        row.wholes("children", 0, len(nodes) - 1) if "children" in row else () for row in nodes
    ]
    parents = [0] * len(nodes)
    for below in children:
        for child in below:
            parents[child] += 1
    if any(count > 1 for count in parents):
        raise fields.refusal("nodes", "with one parent each", "a node with two")
    layer = [k for k, count in enumerate(parents) if count == 0]
    reached, depth = 0, 0
    while layer:
        reached, depth = reached + len(layer), depth + 1
        layer = [child for k in layer for child in children[k]]
    if reached < len(nodes) or depth > MOST_DEPTH:
        what = "a circle" if reached < len(nodes) else f"{depth} levels"
        raise fields.refusal("nodes", f"as trees of at most {MOST_DEPTH} levels", what)
    corners = sum(sizes[row.whole("mesh", 0, len(sizes) - 1)] for row in nodes if "mesh" in row)
    if corners > 3 * MOST_FACES:
        raise DatasetError(
            f"{fields.where}: expected at most {MOST_FACES} faces with all copies of its meshes, "
            f"got some {corners // 3}; export a coarser mesh"
        )

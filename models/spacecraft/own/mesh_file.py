"""A mesh file, read through its door: pieces of triangles with their looks, and nothing executed.

trimesh parses; before it is handed the bytes, everything that they claim has been held against what
is there, and it can open no file but those that lie beside the mesh.
"""

from __future__ import annotations

import hashlib
import io
import logging
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import Floats, Indices
from models.errors import UnreadableError
from models.reading.meshes.bounds import (
    MOST_FACES,
    MOST_IMAGE_SIDE_PX,
    MOST_IMAGES_PX,
    MOST_MESH_BYTES,
)
from models.reading.meshes.gltf_claims import check_gltf, glb_tree, gltf_tree
from models.reading.meshes.header_claims import check_obj, check_ply, check_stl
from models.reading.meshes.neighbours import Neighbours
from models.reading.regular_file import MEGABYTE, read_bytes
from models.reading.shown import shown_line
from models.spacecraft.own.looks import Look, look_of

SUFFIXES = (".glb", ".gltf", ".obj", ".stl", ".ply")
IN_METRES = (".glb", ".gltf")  # by their standard; the others say nothing of it
MOST_COORDINATE = 1e9  # in whatever unit
MOST_NAME = 64


@dataclass(frozen=True, eq=False)
class Piece:
    """One mesh of a file, in its place.

    Attributes
    ----------
    name : str
        As the file has it; several pieces may share one.
    vertices : (n, 3) array
        In the file's axes and unit.
    faces : (f, 3) array of int
    look : Look
    """

    name: str
    vertices: Floats
    faces: Indices
    look: Look

    @property
    def triangles(self) -> Floats:
        """(f, 3, 3) array: corners of the faces, in the file's axes and unit."""
        return np.asarray(self.vertices[self.faces])


@dataclass(frozen=True, eq=False)
class MeshFile:
    """What a mesh file holds.

    Attributes
    ----------
    path : Path
    pieces : tuple of Piece
    missing : tuple of str
        Files that it names and that are not there: textures, materials.
    notes : tuple of str
        What it holds beside, and is left out.
    sha256 : str
        Of its bytes, and of those of the files that it names.
    files : tuple of Path
        It, and those that it names, whether they are there or not.
    """

    path: Path
    pieces: tuple[Piece, ...]
    missing: tuple[str, ...]
    notes: tuple[str, ...]
    sha256: str
    files: tuple[Path, ...]

    @property
    def vertices(self) -> Floats:
        """(n, 3) array: those of all pieces, in the file's axes and unit."""
        return np.concatenate([piece.vertices for piece in self.pieces])


def read_mesh_file(path: Path) -> MeshFile:
    """Read a GLB, glTF, OBJ, STL or PLY file.

    Raises
    ------
    UnreadableError
        If it is none, too large, names files out of its folder, or has vertices that are no
        numbers.
    DatasetError
        If it claims what it does not hold; the message names the key.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise UnreadableError(
            path, f"expected a mesh file, {', '.join(SUFFIXES)}, got {suffix or 'no suffix'}"
        )
    data, neighbours = _read(path), Neighbours(path)
    notes, has_textures = _check(suffix, data, neighbours)
    pieces = tuple(_pieces(path, _scene(suffix, data, neighbours)))
    if has_textures and not any(piece.look.said == "texture" for piece in pieces):
        notes += ("textures: none could be read, and base colours stand; export them as PNG",)
    if not pieces:
        raise UnreadableError(path, "expected at least one face, got none")
    digest = hashlib.sha256(data)
    for name in sorted(neighbours.read):
        digest.update(neighbours.read[name])
    beside = (neighbours.place(name) for name in (*neighbours.read, *neighbours.missing))
    missing = tuple(neighbours.missing)
    return MeshFile(path, pieces, missing, notes, digest.hexdigest(), (path, *beside))


def _read(path: Path) -> bytes:
    if path.is_file() and path.stat().st_size > MOST_MESH_BYTES:
        raise UnreadableError(
            path,
            f"more than {MOST_MESH_BYTES / MEGABYTE:g} MB, the most that a mesh may have; export "
            "a coarser one",
        )
    return read_bytes(path, MOST_MESH_BYTES)


def _check(suffix: str, data: bytes, neighbours: Neighbours) -> tuple[tuple[str, ...], bool]:
    """Hold a file's claims against its bytes; tell what is left out, and whether it has images."""
    if suffix == ".glb":
        tree, binary = glb_tree(neighbours.mesh, data)
        check_gltf(tree, binary, neighbours)
        return _left_out(tree), bool(tree.get("images"))
    if suffix == ".gltf":
        tree = gltf_tree(neighbours.mesh, data)
        check_gltf(tree, 0, neighbours)
        return _left_out(tree), bool(tree.get("images"))
    {".obj": check_obj, ".stl": check_stl, ".ply": check_ply}[suffix](neighbours.mesh, data)
    return (), False


def _left_out(tree: dict[str, Any]) -> tuple[str, ...]:
    words = {
        "animations": "animations: the mesh stands as it rests",
        "skins": "skins: the mesh stands as it rests",
        "cameras": "cameras",
    }
    return tuple(said for key, said in words.items() if tree.get(key))


def _scene(suffix: str, data: bytes, neighbours: Neighbours) -> Any:
    import trimesh

    refusals: list[UnreadableError] = []

    class Resolver(trimesh.resolvers.Resolver):  # type: ignore[misc]
        """Gives trimesh what lies beside the mesh, and nothing else."""

        def __init__(self) -> None:
            self.file_name = neighbours.mesh.stem

        def get(self, name: str) -> bytes:
            try:
                found = neighbours.get(str(name))
            except UnreadableError as error:
                refusals.append(error)
                raise
            if found is None:
                raise FileNotFoundError(name)
            return found

        def write(self, name: str, data: Any) -> None:
            raise PermissionError(name)

        def namespaced(self, namespace: str) -> Any:
            return self

        def keys(self) -> list[str]:
            return []

    options = {"split_objects": True, "group_material": True} if suffix == ".obj" else {}
    logging.getLogger("trimesh").setLevel(logging.CRITICAL)  # it says more than anyone can mend
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            scene = trimesh.load_scene(
                io.BytesIO(data),
                file_type=suffix[1:],
                resolver=Resolver(),
                process=False,
                **options,
            )
    except Exception as error:  # trimesh raises whatever numpy does
        if refusals:
            raise refusals[0] from error
        raise UnreadableError(
            neighbours.mesh,
            f"expected a mesh that trimesh can read, got: {type(error).__name__} "
            f"{shown_line(str(error))}",
        ) from error
    if refusals:
        raise refusals[0]
    return scene


def _pieces(path: Path, scene: Any) -> Iterator[Piece]:
    """Yield the meshes of a scene, each where the scene has it."""
    looks: dict[str, Look] = {}
    texture_px = 0
    order = {name: number for number, name in enumerate(scene.geometry)}
    with np.errstate(all="ignore"):
        nodes = [(*scene.graph[node], str(node)) for node in scene.graph.nodes_geometry]
    for place, name, _ in sorted(nodes, key=lambda node: (order[node[1]], len(node[2]), node[2])):
        mesh = scene.geometry[name]
        faces = np.asarray(getattr(mesh, "faces", np.zeros((0, 3))), dtype=np.int64)
        if not len(faces):
            continue  # points and lines show nothing
        vertices = np.asarray(mesh.vertices, dtype=np.float64)
        if vertices.ndim != 2 or vertices.shape[1] != 3:
            raise UnreadableError(
                path, "expected three numbers for every vertex, got fewer; export the mesh anew"
            )
        with np.errstate(all="ignore"):
            vertices = vertices @ np.asarray(place)[:3, :3].T + np.asarray(place)[:3, 3]
        if not (np.abs(vertices) <= MOST_COORDINATE).all():
            bad = int(np.argmin((np.abs(vertices) <= MOST_COORDINATE).all(axis=1)))
            raise UnreadableError(
                path,
                f"expected vertices as finite numbers below {MOST_COORDINATE:g}, got "
                f"{vertices[bad].tolist()} as vertex "
                f"{bad} of {shown_line(str(name))!r}; export the mesh anew",
            )
        if faces.min() < 0 or faces.max() >= len(vertices) or len(faces) > MOST_FACES:
            raise UnreadableError(
                path, f"expected faces between its {len(vertices)} vertices, got others"
            )
        if np.linalg.det(np.asarray(place)[:3, :3]) < 0.0:
            faces = faces[:, ::-1]
        if name not in looks:
            texture_px += _texture_px(path, mesh)
            if texture_px > MOST_IMAGES_PX:
                raise UnreadableError(
                    path, f"expected textures of at most {MOST_IMAGES_PX} px in all, got more"
                )
            looks[name] = _look(path, mesh)
        yield Piece(_plain(str(name)), vertices, faces, looks[name])


def _look(path: Path, mesh: Any) -> Look:
    try:
        return look_of(mesh)
    except Exception as error:  # whatever Pillow raises on bytes that are no picture
        raise UnreadableError(
            path,
            f"expected textures that Pillow can read, got: {type(error).__name__} "
            f"{shown_line(str(error))}; export them as PNG or JPEG",
        ) from error


def _texture_px(path: Path, mesh: Any) -> int:
    """Return how many pixels a mesh's textures have, which are not decoded for it."""
    material = getattr(mesh.visual, "material", None)
    total = 0
    for key in ("baseColorTexture", "metallicRoughnessTexture", "image"):
        size = getattr(getattr(material, key, None), "size", None)
        if size is None:
            continue
        if max(size) > MOST_IMAGE_SIDE_PX:
            raise UnreadableError(
                path, f"expected textures of at most {MOST_IMAGE_SIDE_PX} px a side, got {size}"
            )
        total += int(size[0]) * int(size[1])
    return total


def _plain(name: str) -> str:
    """Return a name that can be typed as a key of TOML and printed on one line."""
    plain = "".join(c if c.isprintable() and c not in "\"'\\" else "_" for c in name).strip()
    return (plain or "part")[:MOST_NAME]

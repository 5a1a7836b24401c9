"""STL, PLY and OBJ: how many faces and vertices a file claims, against how long it is."""

from __future__ import annotations

import re
import struct
from pathlib import Path

from models.errors import UnreadableError
from models.reading.meshes.bounds import MOST_FACES, MOST_TEXT_MESH_BYTES, MOST_VERTICES
from models.reading.regular_file import MEGABYTE
from models.reading.shown import shown

STL_HEAD, STL_FACE = 84, 50  # bytes
MOST_PLY_HEAD, MOST_PLY_LINES = 65_536, 200
PLY_BYTES = {
    "char": 1, "uchar": 1, "int8": 1, "uint8": 1, "short": 2, "ushort": 2, "int16": 2,
    "uint16": 2, "int": 4, "uint": 4, "float": 4, "int32": 4, "uint32": 4, "float32": 4,
    "double": 8, "float64": 8,
}  # fmt: skip
PLY_FORMATS = ("ascii", "binary_little_endian", "binary_big_endian")
WHOLE = re.compile(rb"[0-9]{1,15}")


def check_stl(path: Path, data: bytes) -> None:
    """Refuse an STL file whose length is not that of the faces it claims.

    Raises
    ------
    UnreadableError
    """
    claimed = struct.unpack_from("<I", data, 80)[0] if len(data) >= STL_HEAD else 0
    if len(data) >= STL_HEAD and len(data) == STL_HEAD + STL_FACE * claimed:
        _check_counts(path, 3 * claimed, claimed)
        return
    if data[:5].lower() == b"solid" and b"\0" not in data[:1000]:
        _check_text(path, data)
        faces = data.count(b"endfacet")
        if not faces:
            raise UnreadableError(path, "expected faces, 'facet' to 'endfacet', got none")
        _check_counts(path, 3 * faces, faces)
        return
    raise UnreadableError(
        path,
        f"expected an STL file: of {STL_HEAD + STL_FACE * claimed} bytes for the {claimed} faces "
        f"that it claims, or text that begins with 'solid'; got {len(data)} bytes; is it whole?",
    )


def check_obj(path: Path, data: bytes) -> None:
    """Refuse an OBJ file that is no text, or has too many vertices or faces.

    Raises
    ------
    UnreadableError
    """
    _check_text(path, data)
    if b"\0" in data:
        raise UnreadableError(path, "expected an OBJ file as text, got zero bytes in it")
    text = b"\n" + data
    vertices, faces = text.count(b"\nv "), text.count(b"\nf ")
    if not vertices or not faces:
        raise UnreadableError(
            path, f"expected vertices and faces, got {vertices} lines 'v' and {faces} lines 'f'"
        )
    _check_counts(path, vertices, faces)


def check_ply(path: Path, data: bytes) -> None:
    """Refuse a PLY file that is too short for what its head claims.

    Raises
    ------
    UnreadableError
    """
    if data[:3] != b"ply":
        raise UnreadableError(path, "expected a PLY file, which begins with 'ply'")
    end = data.find(b"end_header", 0, MOST_PLY_HEAD)
    lines = data[: max(end, 0)].splitlines()
    if end < 0 or len(lines) > MOST_PLY_LINES:
        raise UnreadableError(path, f"expected 'end_header' within {MOST_PLY_LINES} lines")
    is_text, counts, least = _ply_head(path, lines)
    if is_text:
        _check_text(path, data)
    there = len(data) - end
    if least > there:
        raise UnreadableError(
            path,
            f"expected at least {least} bytes for what its head claims "
            f"({', '.join(f'{count} of {name}' for name, count in counts.items())}), "
            f"got {there}; is it whole?",
        )
    if not counts.get("vertex") or not counts.get("face"):
        raise UnreadableError(path, f"expected elements 'vertex' and 'face', got {list(counts)}")
    _check_counts(path, counts["vertex"], counts["face"])


def _ply_head(path: Path, lines: list[bytes]) -> tuple[bool, dict[str, int], int]:
    """Return whether it is text, how many of each element, and the fewest bytes they take."""
    is_text, counts, least, count = False, {}, 0, 0
    for line in lines:
        words = line.split()
        if not words or words[0] in (b"comment", b"obj_info", b"ply"):
            continue
        plain = [word.decode("ascii", "replace") for word in words]
        if words[0] == b"format" and plain[1:2] and plain[1] in PLY_FORMATS:
            is_text = plain[1] == "ascii"
        elif words[0] == b"element" and len(words) == 3 and WHOLE.fullmatch(words[2]):
            count = counts[plain[1]] = int(words[2])
        elif words[0] == b"property" and plain[1] == "list" and len(words) == 5:
            least += count * (2 if is_text else PLY_BYTES.get(plain[2], 1))
        elif words[0] == b"property" and len(words) == 3 and plain[1] in PLY_BYTES:
            least += count * (2 if is_text else PLY_BYTES[plain[1]])
        else:
            raise UnreadableError(path, f"expected a line of a PLY's head, got {shown(line)}")
    return is_text, counts, least


def _check_text(path: Path, data: bytes) -> None:
    if len(data) > MOST_TEXT_MESH_BYTES:
        raise UnreadableError(
            path,
            f"more than {MOST_TEXT_MESH_BYTES / MEGABYTE:g} MB of text, the most that a mesh may "
            "have; export it as GLB",
        )


def _check_counts(path: Path, vertices: int, faces: int) -> None:
    if vertices > 3 * MOST_VERTICES or faces > MOST_FACES:
        raise UnreadableError(
            path, f"expected at most {MOST_FACES} faces, got {faces}; export a coarser mesh"
        )

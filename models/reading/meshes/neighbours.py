"""Files that a mesh names: they lie in its folder or below, or are refused."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote

from models.errors import UnreadableError
from models.reading.meshes.bounds import MOST_MESH_BYTES
from models.reading.regular_file import MEGABYTE, read_bytes
from models.reading.shown import shown

MOST_NAME = 500  # characters


@dataclass(eq=False)
class Neighbours:
    """The files beside a mesh, each read once.

    Attributes
    ----------
    mesh : Path
        Whose neighbours they are.
    read : dict of str to bytes
        What was asked for and is there, by the name that the mesh has for it.
    missing : list of str
        What was asked for and is not there.
    """

    mesh: Path
    read: dict[str, bytes] = field(default_factory=dict)
    missing: list[str] = field(default_factory=list)

    def place(self, name: str) -> Path:
        r"""Return where a named file lies.

        Raises
        ------
        UnreadableError
            If the name leads out of the mesh's folder: by ``..``, from the root, by a link, to
            another machine, or in disguise (``%2e%2e``, ``..\``).
        """
        plain = unquote(name).replace("\\", "/").strip()
        parts = plain.split("/")
        here = self.mesh.parent.resolve()
        leads_out = (
            not plain
            or len(plain) > MOST_NAME
            or "\0" in plain
            or plain.startswith(("/", "~"))
            or ":" in parts[0]
            or ".." in parts
        )
        if leads_out or not _end_of(here / plain).is_relative_to(here):
            raise UnreadableError(
                self.mesh,
                "expected the files that it names in its own folder or below, got "
                f"{shown(name)}; copy the file beside the mesh, and name it by its name alone",
            )
        return here / plain

    def get(self, name: str) -> bytes | None:
        """Return a file's bytes, or None if there is none.

        Raises
        ------
        UnreadableError
            As ``place``; and if it is no regular file, or with the others too large.
        """
        if name in self.read:
            return self.read[name]
        place = self.place(name)
        if not place.exists():
            if name not in self.missing:
                self.missing.append(name)
            return None
        data = read_bytes(place, MOST_MESH_BYTES)
        if sum(map(len, self.read.values())) + len(data) > MOST_MESH_BYTES:
            raise UnreadableError(
                self.mesh,
                f"the files that it names have more than {MOST_MESH_BYTES / MEGABYTE:g} MB, the "
                "most that those of a mesh may have",
            )
        self.read[name] = data
        return data


def _end_of(path: Path) -> Path:
    """Return where a path leads; where links lead in a ring, itself: reading it says so."""
    try:
        return path.resolve()
    except (OSError, RuntimeError):  # before Python 3.13 a ring is a RuntimeError
        return path

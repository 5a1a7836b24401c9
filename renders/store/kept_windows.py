"""The windows of the markers, cut out of each light group: what is kept of every frame's light.

One EXR file for each exposure, one part for each marker in the image. A part is named as its
marker, its data window is where it lies in the image, and its channels are the light groups, in
the half floats of the store.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenEXR

from models.arrays import AnyArray, Radiance
from models.atomic_file import write_bytes
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from renders.store.radiance_store import as_half
from renders.store.sealed_exr import OPEN, SEAL, flat_header, sealed, whole_bytes

NO_MARKER = "no marker in the image"  # a file must hold something: one pixel of the corner


@dataclass(frozen=True, eq=False)
class KeptWindow:
    """One marker's window.

    Attributes
    ----------
    left, top : int, px
        Where its first pixel lies in the image.
    groups : dict of (height, width) float32 arrays, W m-2 sr-1, by group name
    """

    left: int
    top: int
    groups: dict[str, Radiance]


def windows_by_marker(
    markers: MarkerPattern, camera: Camera, cam_from_target: RigidTransform
) -> dict[str, tuple[int, int, int, int]]:
    """Return the window (left, top, width, height), px, of each marker that is in the image.

    Parameters
    ----------
    markers : MarkerPattern
    camera : Camera
    cam_from_target : RigidTransform
    """
    from renders.tracing.radiance import marker_windows  # it loads Mitsuba

    found = {}
    for number, name in enumerate(markers.names):
        one = MarkerPattern(
            (name,),
            markers.points_in_target[number : number + 1],
            markers.normals_in_target[number : number + 1],
            markers.radius_m,
        )
        for window in marker_windows(one, camera, cam_from_target):
            found[name] = window
    return found


def write_windows(
    path: Path,
    windows: Mapping[str, tuple[int, int, int, int]],
    groups: Mapping[str, Radiance],
) -> None:
    """Write the windows of whole groups, by marker name; atomically and under seal.

    Parameters
    ----------
    path : Path
    windows : mapping of str to (left, top, width, height), px
        By marker; empty where none is in the image.
    groups : mapping of str to (height, width) arrays, W m-2 sr-1
        Whole images, by light group.

    Raises
    ------
    StorageError
        If the disk is full or read-only.
    """
    height, width = next(iter(groups.values())).shape
    display = _box(0, 0, width, height)
    parts: list[OpenEXR.Part] = []
    for name, (left, top, columns, rows) in (windows or {NO_MARKER: (0, 0, 1, 1)}).items():
        cut = np.s_[top : top + rows, left : left + columns]
        channels = {group: as_half(np.ascontiguousarray(r[cut])) for group, r in groups.items()}
        header = {
            **flat_header(),
            "displayWindow": display,
            "dataWindow": _box(left, top, columns, rows),
            **({} if parts else {SEAL: OPEN.decode()}),
        }
        parts.append(OpenEXR.Part(header, channels, name))
    with OpenEXR.File(parts) as file:
        write_bytes(path, sealed(file))


def read_windows(path: Path) -> dict[str, KeptWindow] | None:
    """Read an exposure's windows by marker name, or None if the file is absent or damaged."""
    data = whole_bytes(path)
    if data is None:
        return None
    windows = {}
    with OpenEXR.File(io.BytesIO(data), separate_channels=True) as file:
        for part in file.parts:
            left, top = (int(number) for number in part.header["dataWindow"][0])
            groups = {
                name: np.array(channel.pixels, dtype=np.float32)
                for name, channel in part.channels.items()
            }
            windows[part.name()] = KeptWindow(left, top, groups)
    windows.pop(NO_MARKER, None)
    return windows


def _box(left: int, top: int, columns: int, rows: int) -> tuple[AnyArray, AnyArray]:
    corner = np.array([left, top], dtype=np.int32)
    return corner, corner + np.array([columns - 1, rows - 1], dtype=np.int32)

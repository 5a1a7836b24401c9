"""The surface and the cloud of an unknown target, written beside a run's estimates.

It reads the public half of a dataset and the estimates of run 0, and writes::

    DIR/estimates/shape/best/surface.glb   what silhouettes carve, m
                             surface.ply   the same
                             cloud.ply     points, each with its sigma_m
                             shape.json    what both were made of, inertia included

All are in the estimated target's own axes, from its centre of mass.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from bench.estimating.runs import estimates_path, read_run
from bench.progress import frame_progress
from models.arrays import Floats
from models.atomic_file import sweep_beside, write_bytes, write_text
from models.dataset.dataset import Dataset
from models.errors import DatasetError, UnreadableError
from models.estimate import Estimate
from models.plain_console import plain_console
from models.reading.json_file import read_json_table
from pipelines.registry import registered_pipeline
from pipelines.unknown_target.carved_surface import CarvedSurface, NoSurface, carve
from pipelines.unknown_target.cleaned_cloud import Cloud, cleaned_cloud
from pipelines.unknown_target.knowledge import NAME, UnknownTargetKnowledge
from pipelines.unknown_target.pipeline import INERTIA
from pipelines.unknown_target.views_of_run import views_of_run

FORMAT, VERSION = "rvbench-shape", 1
MOST_VIEWS = 200
SURFACE_GLB, SURFACE_PLY, CLOUD_PLY, SHAPE_JSON = (
    "surface.glb", "surface.ply", "cloud.ply", "shape.json",
)  # fmt: skip
GREY = [160, 160, 160, 255]


@dataclass(frozen=True, eq=False)
class ShapeFound:
    """What one run knows of a shape.

    Attributes
    ----------
    surface : CarvedSurface or None
    cloud : Cloud
    views : int
        Silhouettes that carved.
    frame : int
        The last with a pose.
    inertia : (3, 3) array or None
        Of trace 1.
    reason : str
        Why there is no surface; empty where there is one.
    """

    surface: CarvedSurface | None
    cloud: Cloud
    views: int
    frame: int
    inertia: Floats | None
    reason: str


def shape_folder(folder: Path, label: str) -> Path:
    """Return where the shape that a pipeline found in a dataset lies."""
    return folder / "estimates" / "shape" / label


def make_shapes(dataset: Dataset, workers: int = 1) -> list[Path]:
    """Write the shape that run 0 found, unless it is there; say on stderr why there is none.

    Parameters
    ----------
    dataset : Dataset
        Its truth half is not read.
    workers : int
        Not used: it takes seconds.

    Returns
    -------
    list of Path
        The files written, or there already.

    Raises
    ------
    DatasetError
        If frames or estimates cannot be read.
    """
    registered, files = registered_pipeline(NAME), []
    for variant in registered.variants:
        label = registered.labelled(variant)
        if not estimates_path(dataset.folder, 0, label).is_file():
            continue
        home, made_of = shape_folder(dataset.folder, label), fingerprint(dataset, label)
        if _made_of(home) != made_of:
            found = find_shape(dataset, label)
            if found is None:
                _say(f"{label}: no shape: no frame has a pose yet")
                continue
            if found.reason:
                _say(f"{label}: no surface, only the cloud: {found.reason}")
            write_shape(home, found, made_of)
        files += [home / name for name in (SURFACE_GLB, SURFACE_PLY, CLOUD_PLY, SHAPE_JSON)]
    return [path for path in files if path.is_file()]


def find_shape(dataset: Dataset, label: str) -> ShapeFound | None:
    """Return what the estimates of run 0 and the images tell of the shape; None without a pose.

    Parameters
    ----------
    dataset : Dataset
    label : str
        Of the pipeline.
    """
    posed = [each for each in read_run(dataset, 0, label).estimates.values() if each.pose]
    if not posed:
        return None
    last = max(posed, key=lambda each: each.time_s)
    indices = [entry.index for entry in dataset.entries if entry.time_s <= last.time_s]
    some = np.unique(np.linspace(0, len(indices) - 1, MOST_VIEWS).round().astype(int))
    chosen = [indices[place] for place in some]
    knowledge = UnknownTargetKnowledge.of(dataset.onboard)
    with frame_progress("silhouettes", len(chosen)) as went_on:
        frames = (dataset.frame(index) for index in chosen)
        views = views_of_run(last, frames, knowledge, went_on)
    cloud, surface, reason = Cloud.of(last), None, ""
    with frame_progress("carving", 2 * len(views)) as carved:
        try:
            surface = carve(knowledge.camera, views, cloud.points, carved)
        except NoSurface as error:
            reason = str(error)
    return ShapeFound(
        surface,
        cloud if surface is None else cleaned_cloud(cloud, surface),
        len(views),
        last.frame,
        _inertia(last),
        reason,
    )


def write_shape(home: Path, found: ShapeFound, made_of: str) -> None:
    """Write the files of a shape; what was there before goes.

    Parameters
    ----------
    home : Path
        A folder, made if need be.
    found : ShapeFound
    made_of : str
        Hash of frames and estimates.
    """
    for name in (SHAPE_JSON, SURFACE_GLB, SURFACE_PLY, CLOUD_PLY):
        sweep_beside(home / name)
        (home / name).unlink(missing_ok=True)
    told: dict[str, Any] = {"format": FORMAT, "version": VERSION, "made_of": made_of}
    told |= {"frame": found.frame, "silhouettes": found.views, "points": len(found.cloud.points)}
    told["inertia_of_trace_1"] = None if found.inertia is None else found.inertia.tolist()
    told["no_surface"] = found.reason
    if found.surface is not None:
        mesh = trimesh.Trimesh(found.surface.vertices, found.surface.faces, process=False)
        told |= {"step_m": found.surface.step_m, "triangles": len(mesh.faces)}
        write_bytes(home / SURFACE_PLY, _bytes(mesh.export(file_type="ply")))
        mesh.visual = trimesh.visual.TextureVisuals(
            material=trimesh.visual.material.PBRMaterial(
                name="carved", baseColorFactor=GREY, metallicFactor=0.0, roughnessFactor=0.9
            )
        )
        write_bytes(home / SURFACE_GLB, _bytes(mesh.export(file_type="glb")))
    write_bytes(home / CLOUD_PLY, cloud_ply(found.cloud))
    write_text(home / SHAPE_JSON, json.dumps(told, indent=2) + "\n")


def cloud_ply(cloud: Cloud) -> bytes:
    """Return a cloud as a binary PLY, of vertices with x, y, z and sigma_m."""
    columns = ("x", "y", "z", "sigma_m")
    head = ["ply", "format binary_little_endian 1.0", "comment metres, the target's own axes"]
    head += [f"element vertex {len(cloud.points)}", *(f"property float {one}" for one in columns)]
    rows = np.column_stack([cloud.points, cloud.sigma_m]).astype("<f4")
    return "\n".join([*head, "end_header\n"]).encode() + rows.tobytes()


def fingerprint(dataset: Dataset, label: str) -> str:
    """Return what a shape is made of, as a hash: frames, and estimates of run 0."""
    said = estimates_path(dataset.folder, 0, label).read_bytes()
    return hashlib.sha256(said + dataset.content_fingerprint().encode()).hexdigest()


def read_surface(dataset: Dataset, label: str) -> Floats | None:
    """Return the triangles of a surface in the estimates' axes, (f, 3, 3) m.

    None where there is none, or only one of other estimates.

    Raises
    ------
    UnreadableError
        If the file is no surface.
    """
    home = shape_folder(dataset.folder, label)
    path = home / SURFACE_PLY
    if not path.is_file() or _made_of(home) != fingerprint(dataset, label):
        return None
    try:
        mesh = trimesh.load_mesh(path, process=False)
        return np.asarray(mesh.vertices, dtype=np.float64)[mesh.faces]
    except (OSError, ValueError, KeyError, AttributeError, IndexError) as error:
        raise UnreadableError(
            path, f"expected a surface as PLY, got: {error}; estimate again"
        ) from error


def _made_of(home: Path) -> str | None:
    try:
        return str(read_json_table(home / SHAPE_JSON).get("made_of"))
    except (DatasetError, UnreadableError):
        return None


def _inertia(said: Estimate) -> Floats | None:
    values = said.states[INERTIA].values if INERTIA in said.states else {}
    return values.get("inertia_of_trace_1")


def _bytes(data: bytes | str) -> bytes:
    return data.encode() if isinstance(data, str) else data


def _say(text: str) -> None:
    plain_console(stderr=True).print(text, soft_wrap=True, highlight=False)

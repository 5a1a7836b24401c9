"""A dataset to be exported, opened: both halves of it, and the target as it truly is.

What a label says is true: its camera is the one that rendered, not the one as calibrated, and its
target the one that stood there. Where a dataset has no scenario behind the wall, as one made by
hand has not, the knowledge on board stands in, and the card says so.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from bench.export.keypoints import KeypointModel, keypoint_model
from bench.export.truth_lines import TruthLines, find_truth_lines
from models.arrays import Floats, Indices
from models.camera import Camera
from models.dataset.dataset import Dataset, open_dataset
from models.dataset.split_file import read_splits
from models.markers import MarkerPattern
from models.spacecraft.catalogue import SPACECRAFT, spacecraft_by_name
from models.spacecraft.part import Spacecraft
from models.wireframe.wireframe import Wireframe
from renders.scenario.scenario import read_scenario
from renders.truth.exposure_truth import read_part_names
from renders.truth.part_names import CHASER_LABEL
from renders.world.build import world_of

DISC_CORNERS = 64


@dataclass(frozen=True, eq=False)
class TargetModel:
    """A target as labels need it.

    Attributes
    ----------
    name : str
    craft : Spacecraft
        With the markers as installed.
    wireframe : Wireframe or None
    """

    name: str
    craft: Spacecraft
    wireframe: Wireframe | None

    @cached_property
    def vertices(self) -> Floats:
        """(v, 3) array, m: of all parts and the markers' faces, in the target frame."""
        return np.concatenate([vertices for vertices, _ in self._pieces])

    @cached_property
    def faces(self) -> Indices:
        """(f, 3) array of int."""
        starts = np.cumsum([0] + [len(vertices) for vertices, _ in self._pieces[:-1]])
        return np.concatenate(
            [faces + start for (_, faces), start in zip(self._pieces, starts, strict=True)]
        )

    @cached_property
    def radius_m(self) -> float:
        """Distance of its outermost corner from the origin, m."""
        return float(np.linalg.norm(self.vertices, axis=1).max())

    @cached_property
    def keypoints(self) -> KeypointModel:
        """Its landmarks and its markers."""
        return keypoint_model(self.wireframe, self.craft.markers)

    @cached_property
    def _pieces(self) -> list[tuple[Floats, Indices]]:
        pieces = [
            (
                np.asarray(part.mesh.vertices, dtype=np.float64),
                np.asarray(part.mesh.faces, dtype=np.int64),
            )
            for part in self.craft.parts
        ]
        return pieces + ([] if self.craft.markers is None else _discs(self.craft.markers))


@dataclass(frozen=True, eq=False)
class Source:
    """One of the datasets of an export.

    Attributes
    ----------
    number : int
        From 1, as they were given.
    dataset : Dataset
    truth : TruthLines
    camera : Camera or None
        That took the images.
    camera_is_true : bool
        Whether it is known as simulated, or only as calibrated.
    target : TargetModel or None
        None where its shape is not known.
    part_names : tuple of str
        Of the labels of the truth half; empty where there are none.
    """

    number: int
    dataset: Dataset
    truth: TruthLines
    camera: Camera | None
    camera_is_true: bool
    target: TargetModel | None
    part_names: tuple[str, ...]

    @property
    def folder(self) -> Path:
        """Where it lies."""
        return self.dataset.folder

    @cached_property
    def splits(self) -> dict[int, str] | None:
        """What each frame is for, where the dataset brings its own splits."""
        return read_splits(self.folder)

    @cached_property
    def fingerprint(self) -> str:
        """Hash of its public half, images and all."""
        return self.dataset.content_fingerprint()

    @cached_property
    def target_labels(self) -> tuple[int, ...]:
        """The labels that are of the target; 0 is space, and the chaser is none of it."""
        return tuple(
            number + 1 for number, name in enumerate(self.part_names) if name != CHASER_LABEL
        )


def open_source(number: int, folder: Path) -> Source:
    """Open a dataset with all that its truth half tells.

    Parameters
    ----------
    number : int
    folder : Path

    Raises
    ------
    DatasetError, ScenarioError
        If it is no dataset, not whole, or a file of it cannot be read.
    """
    dataset = open_dataset(folder)
    dataset.check_images()
    scenario = folder / "truth" / "scenario.toml"
    parts = folder / "truth" / "parts.json"
    target: TargetModel | None = None
    camera = dataset.onboard.camera
    is_true = scenario.is_file()
    if is_true:
        world = world_of(read_scenario(scenario))
        camera = world.camera
        target = TargetModel(world.target.name, world.target, world.before_flight.wireframe)
    elif dataset.info.target in SPACECRAFT:
        craft = spacecraft_by_name(dataset.info.target)
        target = TargetModel(craft.name, craft, dataset.onboard.wireframe)
    return Source(
        number=number,
        dataset=dataset,
        truth=find_truth_lines(folder),
        camera=camera,
        camera_is_true=is_true,
        target=target,
        part_names=read_part_names(folder) if parts.is_file() else (),
    )


def _discs(markers: MarkerPattern) -> list[tuple[Floats, Indices]]:
    """Return each marker's face as a fan of triangles."""
    angle = 2.0 * np.pi * np.arange(DISC_CORNERS) / DISC_CORNERS
    number = np.arange(DISC_CORNERS)
    fan = np.stack([np.zeros_like(number), number + 1, (number + 1) % DISC_CORNERS + 1], axis=1)
    faces = []
    for point, normal in zip(markers.points_in_target, markers.normals_in_target, strict=True):
        first = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        rim = np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second
        faces.append((np.vstack([point, point + markers.radius_m * rim]), fan.astype(np.int64)))
    return faces

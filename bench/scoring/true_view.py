"""What really was, as every method's poses are measured against it: pose, Sun, shape, depth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from bench.chains.catalogue import chain_named
from bench.chains.chain import Chain, PosedFrameTruth
from bench.scoring.depth_image import PixelGrid, depth_image, grid_within
from bench.scoring.target_shape import TargetShape, target_shape
from models.arrays import Floats
from models.camera import Camera
from models.dataset.dataset import Dataset
from models.errors import DatasetError
from models.onboard import needed
from models.pose import RigidTransform
from renders.scenario.scenario import read_scenario
from renders.store.sealed_exr import read_exr
from renders.world.exposure import exposure_name

OWN_DEPTH = "the target alone: the dataset keeps no depth"
SCENE_DEPTH = "truth/geometry"


@dataclass(frozen=True, eq=False)
class TrueView:
    """The truth of a dataset that methods are compared on.

    Attributes
    ----------
    dataset : Dataset
    chain : Chain
    judged_by : object
        What ``chain.judge`` takes.
    truths : mapping of int to PosedFrameTruth
        By frame.
    vsd_px : int
        Pixels along the image's longer side that VSD looks at; 0 leaves it out.
    """

    dataset: Dataset
    chain: Chain
    judged_by: Any
    truths: Mapping[int, PosedFrameTruth]
    vsd_px: int

    @cached_property
    def shape(self) -> TargetShape | None:
        """The target's shape; None where it is not known."""
        return target_shape(self.dataset)

    @cached_property
    def camera(self) -> Camera:
        """The camera as simulated; where no scenario tells of it, as calibrated."""
        scenario = self.dataset.folder / "truth" / "scenario.toml"
        if scenario.is_file():
            return read_scenario(scenario).simulated_camera
        return needed(self.dataset.onboard.camera, "camera.toml", "the measures in pixels")

    @cached_property
    def grid(self) -> PixelGrid | None:
        """The pixels that VSD looks at; None where it is left out."""
        return grid_within(self.camera, self.vsd_px) if self.vsd_px and self.shape else None

    @cached_property
    def scene_depth_source(self) -> str:
        """Where the depth of the scene is from."""
        first = self.dataset.indices[0]
        return SCENE_DEPTH if self._scene_depth(first) is not None else OWN_DEPTH

    def distances(self, cam_from_target: RigidTransform) -> Floats:
        """Return how far the target alone would be along each ray, (height, width), m; 0: not."""
        assert self.shape is not None
        assert self.grid is not None
        depth = depth_image(self.shape.vertices, self.shape.faces, self.grid, cam_from_target)
        return depth * self.grid.stretch

    def scene_distances(self, frame: int, alone: Floats) -> Floats:
        """Return how far whatever stood there was along each ray.

        Parameters
        ----------
        frame : int
        alone : (height, width) array, m
            Of the target alone, which stands for the scene where no depth was kept.

        Returns
        -------
        (height, width) array, m
            0 where nothing is met.

        Raises
        ------
        DatasetError
            If a depth is there and cannot be read.
        """
        assert self.grid is not None
        depth = self._scene_depth(frame)
        return alone if depth is None else depth * self.grid.stretch

    def _scene_depth(self, frame: int) -> Floats | None:
        truth = self.truths[frame]
        name = exposure_name(frame, getattr(truth, "band", 0))
        path = self.dataset.folder / "truth" / "geometry" / f"{name}.exr"
        if not path.is_file():
            return None
        assert self.grid is not None
        channels = read_exr(path)
        if channels is None or "Z" not in channels:
            raise DatasetError(
                f"{path}: expected depth as it was written, got a file that was changed or cut "
                "short; render again: only what is missing is rendered"
            )
        stride, size = self.grid.stride, (self.camera.height, self.camera.width)
        if channels["Z"].shape != size:
            raise DatasetError(
                f"{path}: expected a depth of {size[1]} x {size[0]} px, as the camera has, got "
                f"{channels['Z'].shape[1]} x {channels['Z'].shape[0]}"
            )
        return channels["Z"][::stride, ::stride].astype(np.float64)


def true_view(dataset: Dataset, vsd_px: int = 0) -> TrueView:
    """Read the truth of a dataset.

    Parameters
    ----------
    dataset : Dataset
    vsd_px : int
        See ``TrueView``.

    Raises
    ------
    DatasetError
        If the truth half is missing, cannot be read, or tells no pose of some frame.
    """
    chain = chain_named(dataset.info.chain)
    judged_by = chain.truth(dataset)
    truths = chain.truths(dataset)
    for index in dataset.indices:
        if getattr(truths.get(index), "cam_from_target", None) is None:
            raise DatasetError(
                f"{dataset.folder}: expected a truth that tells the target's pose in every frame, "
                f"got none of frame {index} ({chain.name}); poses cannot be compared on it"
            )
    return TrueView(dataset, chain, judged_by, truths, vsd_px)

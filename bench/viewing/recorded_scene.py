"""Target, cameras, frames and orbit of a dataset, as entities of Rerun's.

The world is the target's frame: ``target`` (mesh, edges, markers, Sun, the points that a pipeline
ends with), ``camera/true`` with the images and their marks, and ``camera/LABEL`` of each pipeline.
``orbit`` is in the inertial frame. A camera is drawn as a pinhole: its distortion is in the images,
not in its frustum.
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import replace
from itertools import cycle
from typing import Any

import cv2
import numpy as np

from bench.chains.chain import EstimatesByPipeline
from bench.pictures.frame_record import FrameRecord, FrameRecords
from bench.pictures.marks import Layer
from bench.pictures.stretch import stretch
from bench.report.explorer.scene import scene_data, turned
from bench.report.scene_addition import OrbitScene, SceneAddition
from models.arrays import Floats
from models.gravity.disturbances import EARTH_RADIUS_M
from models.pose import RigidTransform

CAMERA, EARTH, HEARD, ORBIT, TARGET, TRUE = (
    "camera", "earth", "heard", "orbit", "target", "true",
)  # fmt: skip
Colour = tuple[int, int, int]
TRUE_COLOUR, MARKER_COLOUR, EDGE_COLOUR = (70, 214, 255), (255, 77, 64), (143, 163, 179)
SUN_COLOUR, EARTH_COLOUR = (217, 169, 22), (63, 110, 163)
SAID_COLOURS = ((74, 222, 96), (240, 160, 75), (205, 149, 230), (240, 121, 142))
MARK_COLOURS = {"detections": MARKER_COLOUR, "truth": TRUE_COLOUR}
QUALITY = 92
HALF_PX = 0.5  # our pixel centres are integers, Rerun's lie half a pixel further


class RecordedScene:
    """What stands in the viewer's scenes and pictures.

    Parameters
    ----------
    rerun : module
        Rerun's SDK.
    stream : RecordingStream
    records : FrameRecords
    estimates : mapping of str to mapping of int to Estimate
        Of run 0, by pipeline.
    leading : str
        The pipeline whose marks the pictures have.
    """

    def __init__(
        self,
        rerun: Any,
        stream: Any,
        records: FrameRecords,
        estimates: EstimatesByPipeline,
        leading: str,
    ) -> None:
        self.rerun, self.stream, self.records = rerun, stream, records
        self.estimates, self.leading, self.chain = estimates, leading, records.chain
        self.camera, self.detector = records.onboard.camera, records.onboard.detector
        self.addition = (
            SceneAddition() if self.chain.scene is None else self.chain.scene(records, estimates)
        )
        self.colours = dict(zip(estimates, cycle(SAID_COLOURS), strict=False))

    @property
    def has_target(self) -> bool:
        """Whether there is a camera, and so something that it looks at."""
        return self.camera is not None

    @property
    def has_pictures(self) -> bool:
        """Whether the chain has images."""
        return self.chain.signals is not None and self.detector is not None

    @property
    def has_orbit(self) -> bool:
        """Whether the chain tells of an orbit."""
        return self.addition.orbit is not None

    def write_still(self) -> None:
        """Write what does not move."""
        rerun = self.rerun
        if self.has_orbit:
            ball = rerun.Ellipsoids3D(half_sizes=[[EARTH_RADIUS_M] * 3], colors=[EARTH_COLOUR])
            self._log([ORBIT, EARTH], ball, static=True)
        data = scene_data(self.records, [], self.addition)
        if data is None:
            return
        if data["glb"]:
            mesh = base64.b64decode(data["glb"])
            self._log(
                [TARGET, "mesh"],
                rerun.Asset3D(contents=mesh, media_type="model/gltf-binary"),
                static=True,
            )
        if data["edges"]:
            edges = rerun.LineStrips3D(np.asarray(data["edges"]), colors=[EDGE_COLOUR])
            self._log([TARGET, "edges"], edges, static=True)
        if data["markers"]:
            names = data["marker_names"]
            markers = rerun.Points3D(data["markers"], labels=names, colors=[MARKER_COLOUR])
            self._log([TARGET, "markers"], markers, static=True)
        for label, points in data["clouds"].items():
            cloud = rerun.Points3D(points, colors=[self.colours[label]])
            self._log([TARGET, "points", label], cloud, static=True)

    def write_frame(self, record: FrameRecord, place: int) -> None:
        """Write a frame at the instant that the stream has been told.

        Parameters
        ----------
        record : FrameRecord
        place : int
            Among the dataset's frames.
        """
        self._pose(TRUE, record.true_pose, TRUE_COLOUR)
        for label, own in self.estimates.items():
            said = replace(record, variant=label, estimate=own.get(record.frame.index))
            pose = turned(said.estimated_pose, self.addition.true_from_own.get(label))
            self._pose(label, pose, self.colours[label])
            if label == self.leading and self.chain.signals is not None:
                for stream, signal_dn in self.chain.signals(record).items():
                    self._picture(stream, signal_dn)
                for layer in [] if self.chain.layers is None else self.chain.layers(said):
                    self._log([CAMERA, TRUE, "marks", layer.name], self._marks(layer))
        sun = getattr(record.truth, "sun_dir_in_target", None)
        if sun is not None:
            arrow = self.rerun.Arrows3D(vectors=[sun], colors=[SUN_COLOUR], labels=["Sun"])
            self._log([TARGET, "Sun"], arrow)
        if self.addition.orbit is not None:
            self._places(self.addition.orbit, place)

    def _log(self, entity: Sequence[str], *shown: Any, static: bool = False) -> None:
        self.stream.log(list(entity), *shown, static=static)

    def _pose(self, name: str, cam_from_target: RigidTransform | None, colour: Colour) -> None:
        if self.camera is None:
            return
        if cam_from_target is None:
            self._log([CAMERA, name], self.rerun.Clear(recursive=False))
            return
        target_from_cam = cam_from_target.inverse()
        matrix = self.camera.matrix.copy()
        matrix[:2, 2] += HALF_PX
        self._log(
            [CAMERA, name],
            self.rerun.Transform3D(
                translation=target_from_cam.translation, mat3x3=target_from_cam.rotation
            ),
            self.rerun.Pinhole(
                image_from_camera=matrix,
                resolution=[self.camera.width, self.camera.height],
                image_plane_distance=0.4 * float(np.linalg.norm(cam_from_target.translation)),
                color=colour,
            ),
        )

    def _picture(self, name: str, signal_dn: Floats) -> None:
        if self.detector is None:
            return
        levels = np.rint(255.0 * stretch(signal_dn, self.detector)).astype(np.uint8)
        told = levels if levels.ndim == 2 else levels[:, :, ::-1]
        _, data = cv2.imencode(".jpg", told, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
        image = self.rerun.EncodedImage(contents=data.tobytes(), media_type="image/jpeg")
        self._log([CAMERA, TRUE, name], image)

    def _marks(self, layer: Layer) -> Any:
        places = [np.asarray(each, dtype=np.float64) + HALF_PX for each in layer.places_px]
        colours = [MARK_COLOURS.get(layer.name, SAID_COLOURS[0])]
        if layer.sign == "lines":
            strips = [each.reshape(-1, 2) for each in places]
            return self.rerun.LineStrips2D(strips, colors=colours)
        points = np.reshape(places, (-1, 2))
        return self.rerun.Points2D(points, labels=list(layer.labels) or None, colors=colours)

    def _places(self, orbit: OrbitScene, place: int) -> None:
        self._place(TRUE, orbit.true_m[place], TRUE_COLOUR)
        for label, said_m in orbit.said_m.items():
            self._place(label, said_m[place], self.colours[label])
        heard = orbit.senders_m[place]
        if heard is not None:
            self._log([ORBIT, HEARD], self.rerun.Points3D(heard, colors=[SUN_COLOUR]))

    def _place(self, name: str, place_m: Floats | None, colour: Colour) -> None:
        there = [] if place_m is None else [place_m]
        self._log([ORBIT, name], self.rerun.Points3D(there, colors=[colour]))

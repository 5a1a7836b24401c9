"""A package with one pipeline to start from: its module, and what makes the bench find it."""

from __future__ import annotations

import keyword
import sys
from importlib.util import find_spec

from models.errors import ScenarioError
from pipelines.registry import GROUP, NAME, pipeline_names

PROJECT = """\
[build-system]
requires = ["setuptools>=77"]
build-backend = "setuptools.build_meta"

[project]
name = "rvbench-{name}"
version = "0.1.0"
description = "An rvbench pipeline in a package of its own"
requires-python = ">=3.11"
dependencies = ["numpy"]   # rvbench itself comes from its clone

[project.entry-points."{group}"]   # by this the bench finds it
{name} = "{module}:PIPELINE"

[tool.setuptools]
py-modules = ["{module}"]
"""
MODULE = '''\
"""A pipeline of my own: what it finds in an image pair, and the pose that follows."""

from models.estimate import Estimate  # and PoseEstimate, for a pose
from models.frame import IMAGE_800, IMAGE_850, Frame
from models.onboard import OnboardKnowledge, needed
from pipelines.pipeline import RegisteredPipeline

NAME = "{name}"


class Pipeline:
    """One run: made before the first frame, it keeps what it needs from frame to frame."""

    def __init__(self, onboard: OnboardKnowledge, variant: str) -> None:
        # All that is known in flight: as calibrated, surveyed and drawn, never as simulated.
        self.camera = needed(onboard.camera, "camera.toml", NAME)  # project, normalise, rays
        self.markers = needed(onboard.markers, "markers.toml", NAME)  # points_in_target, m
        prior = needed(onboard.prior, "prior.toml", NAME)
        self.cam_from_target = prior.cam_from_target  # the first pose, with prior.sigma_m, ...

    def process(self, frame: Frame) -> Estimate:
        """Return the pose of a frame, or why there is none."""
        lit = frame.image(IMAGE_850).image  # (height, width) uint16, DN: the markers return it
        dark = frame.image(IMAGE_800).image  # the same scene 33 ms before: they do not
        difference = lit.astype("float32") - dark

        # Here is the work: find the markers in `difference`, pair them with
        # self.camera.project(self.cam_from_target @ self.markers.points_in_target), and solve for
        # cam_from_target, a models.pose.RigidTransform (x right, y down, z forward; m). Then:
        #
        # self.cam_from_target = solved
        # return Estimate(frame.index, frame.time_s, pose=PoseEstimate(solved, covariance))
        #
        # covariance: (6, 6), rad and m; None if it is not known. A frame without a pose has a
        # reason; it counts against the score, as a wrong pose does.
        reason = f"nothing is looked for yet; the largest difference is {{difference.max():.0f}} DN"
        return Estimate(frame.index, frame.time_s, reason=reason)


# The streams that every frame must have: image pairs. Of single images it is models.frame.IMAGE.
# Several sets of settings: variants=("fast", "fine"), handed on as `variant`.
PIPELINE = RegisteredPipeline(NAME, Pipeline, streams=(IMAGE_800, IMAGE_850))
'''
TEST = '''\
"""The pipeline on frames made by hand: `pytest`, where rvbench is installed."""

import numpy as np
from {module} import PIPELINE

from models.camera import camera_preset
from models.frame import IMAGE_800, IMAGE_850, Frame, ImageReading
from models.onboard import OnboardKnowledge, PosePrior
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.spacecraft.retroreflector_layout import RETROREFLECTORS

AHEAD = RigidTransform(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 6.7]))
CAMERA = camera_preset("chaser_fixed").resized(256)


def made():
    prior = PosePrior(AHEAD, sigma_m=np.full(3, 0.02), sigma_deg=np.ones(3))
    onboard = OnboardKnowledge(CAMERA, Detector(), markers=RETROREFLECTORS, prior=prior)
    return PIPELINE.make(onboard, PIPELINE.variants[0])


def test_a_dark_frame_has_no_pose_and_a_reason():
    dark = np.zeros((CAMERA.height, CAMERA.width), dtype=np.uint16)
    pair = {{name: ImageReading(dark, 0.0, 1.0) for name in (IMAGE_800, IMAGE_850)}}
    said = made().process(Frame(0, 0.0, pair))
    assert said.pose is None
    assert said.reason


# Then a frame with markers drawn into it, and a pose that you know: is it found?
'''


def pipeline_files(name: str) -> dict[str, str]:
    """Return the texts of a pipeline's files, by name.

    Parameters
    ----------
    name : str
        Small letters, digits, ``_`` and ``-``; of no pipeline that there is.

    Raises
    ------
    ScenarioError
        If it can be no pipeline's name, or would be the name of another module.
    """
    if not NAME.fullmatch(name):
        raise ScenarioError(
            "expected a pipeline's name of small letters, digits, _ and -, beginning with a "
            f"letter, got {name!r}"
        )
    if name in pipeline_names():
        raise ScenarioError(
            f"expected a name of its own, there is a pipeline {name!r}; choose another name"
        )
    module = name.replace("-", "_")
    taken = module in sys.stdlib_module_names or keyword.iskeyword(module)
    if taken or find_spec(module) is not None:
        raise ScenarioError(
            f"expected a name that no Python module has, got {name!r}; choose another, such as "
            f"{name}-pipeline"
        )
    words = {"name": name, "module": module, "group": GROUP}
    return {
        "pyproject.toml": PROJECT.format(**words),
        f"{module}.py": MODULE.format(**words),
        f"test_{module}.py": TEST.format(**words),
    }

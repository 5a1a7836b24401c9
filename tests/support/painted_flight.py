"""Frames of the fiducial-marker suite without a renderer: discs painted into light groups."""

from __future__ import annotations

import numpy as np

from bench.suites.opromolla2022.cases import APPROACH
from bench.suites.opromolla2022.frame_file import OnceExposed, frame_path, write_frame
from bench.suites.opromolla2022.frame_making import marker_places, under
from bench.suites.opromolla2022.plan import Plan
from models.arrays import Radiance
from models.pose import RigidTransform
from renders.detector.compose import compose
from renders.detector.expose import electrons_per_radiance
from renders.detector.marker_windows import cut_windows
from renders.truth.exposure_truth import ExposureTruth
from renders.world.build import world_of
from renders.world.world import World
from tests.support.synthetic_pair import Scene, markers_signal

FULL = 0.5  # of the full well


def paint_approach(plan: Plan, sun: str) -> None:
    """Write the frames of the approach under a Sun that lights nothing."""
    world = world_of(under(plan.scenario(APPROACH), sun))
    markers = world.target.markers
    assert markers is not None
    entries = world.frame_entries(world.onboard(0).prior)
    for index, entry in enumerate(entries):
        images, windows = {}, {}
        pose = world.trajectory.cam_from_target(entry.time_s)
        for exposure in [e for e in world.exposures if e.frame == index]:
            pose = world.trajectory.cam_from_target(exposure.time_s)
            groups = {
                group: _discs(world, pose, entry.exposure_ms)
                if group == world.lamps(850)
                else np.zeros((world.camera.height, world.camera.width), dtype=np.float32)
                for group in world.lit_by(exposure)
            }
            images[exposure.band] = compose(world, groups, exposure, entry.exposure_ms, 0)
            places = marker_places(world.camera, markers, pose)
            windows[exposure.band] = cut_windows(world, groups, exposure, *places)
        centres = world.camera.project(pose @ markers.points_in_target)
        inside = np.array([float(world.camera.contains(place)) for place in centres])
        truth = ExposureTruth(
            index, 850, entry.time_s, pose, np.array([0.0, 0.0, 1.0]), centres, centres, inside,
            inside, np.zeros(len(markers)),
        )  # fmt: skip
        frame = OnceExposed(index, entry.time_s, entry.exposure_ms, images, windows, truth)
        write_frame(frame_path(plan.folder(APPROACH), sun, index), frame)


def _discs(world: World, pose: RigidTransform, exposure_ms: float) -> Radiance:
    """Return radiance of discs that fill half of the full well, unblurred."""
    detector, optics = world.scenario.simulated_detector, world.scenario.simulated_optics
    markers = world.target.markers
    assert markers is not None
    scene = Scene(world.camera, detector, markers, level=1.0, psf_sigma_px=0.0)
    each = FULL * detector.full_well_e / (1e-3 * exposure_ms)
    radiance = each / electrons_per_radiance(optics, detector, 850.0)
    return (radiance * markers_signal(scene, pose)).astype(np.float32)

"""Which fitted cubes are believed: all that are seen whole, however wrongly they are told of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import rotation_from_euler_321
from models.spacecraft.retroreflector_optics import cubes_behind
from pipelines.chaser_fixed.options import options_for
from pipelines.chaser_fixed.refinement import fit_markers
from pipelines.detection.disc_fit import ExpectedBlur
from pipelines.detection.image_pair import image_pair
from tests.support.synthetic_pair import Scene, expected_pair, facing_pose

SMALL = Camera.from_fov(80, 80, 3.0)
NORMAL = np.array([[0.0, 0.0, 1.0]])
KNOWN = cubes_behind(NORMAL)
ONE = MarkerPattern(("1",), np.zeros((1, 3)), NORMAL, 0.0127, cubes=KNOWN)
RADIUS_PX = 4.2  # at 6.7 m, where the face is least resolved
RUNS = 24


def believed(tilt_sigma_deg: float, psf_sigma_px: float, cut: dict[int, float]) -> int:
    """Count cubes that are believed, of many told with a normal and a blur that are not so."""
    rng = np.random.default_rng(5)
    range_m = SMALL.fx * ONE.radius_m / RADIUS_PX
    scene = Scene(camera=SMALL, markers=ONE, cubes=KNOWN, supersampling=10, prnu=0.005, cut=cut)
    kept = 0
    for run in range(RUNS):
        offset = rng.uniform(-0.5, 0.5, 2) * range_m / SMALL.fx
        turn = (172.0, 0.0, float(rng.uniform(-40.0, 40.0)))
        pose = facing_pose(range_m, turn, np.zeros(3), (offset[0], offset[1]))
        away = rotation_from_euler_321(np.append(tilt_sigma_deg * rng.standard_normal(2), 0.0))
        assert KNOWN.edges_in_target is not None
        told = replace(
            ONE,
            normals_in_target=NORMAL @ away.T,
            cubes=replace(KNOWN, edges_in_target=KNOWN.edges_in_target @ away.T),
        )
        pair = image_pair(expected_pair(scene, pose).exposed(run))
        blur = ExpectedBlur(psf_sigma_px, 0.25, psf_sigma_px)
        fitted = fit_markers(
            pair, SMALL, scene.detector, told, pose, pose, blur, options_for("best")
        )
        kept += len(fitted.match)
    return kept


def test_no_cube_is_refused_for_what_is_told_of_it() -> None:
    assert believed(2.0, 0.4, cut={}) == RUNS


def test_a_cube_that_is_cut_by_two_fifths_is_refused() -> None:
    assert believed(0.0, 0.5, cut={0: 0.4}) <= RUNS // 4

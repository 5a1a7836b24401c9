"""Edges as polylines are the pieces that a picture draws, in far fewer points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bench.pictures.wireframe_overlay import PIECES, edge_lines_px
from models.camera import Camera
from models.pose import RigidTransform, rotation_from_euler_321
from models.spacecraft.wireframes import wireframe_by_name
from models.wireframe.visibility import visible_edge_pieces

CAMERA = Camera.from_fov(width=640, height=640, fov_deg=40.0)
TURN = rotation_from_euler_321([20.0, 35.0, -50.0])
CAM_FROM_TARGET = RigidTransform(TURN, np.array([0.0, 0.0, 40.0]))
ROUNDING_PX = 1e-6
SAG_PX = 0.1  # of an eighth of an edge, by this lens


def lengths(lines) -> float:
    return sum(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in lines)


@pytest.mark.parametrize(("camera", "within_px"), [
    (CAMERA, ROUNDING_PX), (replace(CAMERA, k1=-0.1), SAG_PX),
])  # fmt: skip
def test_polylines_are_the_seen_pieces(camera, within_px):
    target = wireframe_by_name("xmm")
    pieces = visible_edge_pieces(target, CAM_FROM_TARGET, PIECES)
    flat = CAM_FROM_TARGET @ pieces.points_in_target.reshape(-1, 3)
    pixels = camera.project(flat).reshape(*pieces.visible.shape, 2)
    both = pieces.visible[:, 1:] & pieces.visible[:, :-1]
    drawn = list(np.stack([pixels[:, :-1], pixels[:, 1:]], axis=2)[both])
    lines = list(edge_lines_px(camera, target, CAM_FROM_TARGET))
    assert lengths(lines) == pytest.approx(lengths(drawn), abs=within_px * len(lines))
    places = pixels.reshape(-1, 2)
    for line in lines:
        assert len(line) <= 6
        for point in line:
            assert np.linalg.norm(places - point, axis=1).min() < ROUNDING_PX

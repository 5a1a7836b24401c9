"""The library of views against edges that are found in its own silhouettes."""

from __future__ import annotations

import cv2
import numpy as np

from models.camera import Camera
from pipelines.acquisition.view_sphere import (
    VIEW_PX,
    cell_of,
    edge_pictures,
    shape_of,
    view_sphere,
)
from pipelines.tracking.model_edges import ModelEdges
from tests.support.drawn_targets import target

RANGE_M = 12.0
VIEWS = 40
MOST = 0.8  # of the views: an outline along both axes looks the same, swapped


def test_edges_lie_along_the_outline_not_across() -> None:
    """Most of a view's edges are its outline, whose direction the silhouette's gradient gives."""
    wireframe = target()
    sphere = view_sphere(wireframe, RANGE_M, VIEWS)
    half = 1.02 * wireframe.radius_m / np.sqrt(RANGE_M**2 - wireframe.radius_m**2)
    focal, middle = 0.5 * VIEW_PX / half, 0.5 * (VIEW_PX - 1)
    camera, edges = Camera(VIEW_PX, VIEW_PX, focal, focal, middle, middle), ModelEdges(wireframe)
    own, mirrored, swapped = [], [], []
    for view, drawn in zip(sphere.views, sphere.edges, strict=True):
        mask = edges.silhouette(camera, view.cam_from_target)
        soft = cv2.GaussianBlur(mask.astype(np.float32), (0, 0), 1.5)
        gx, gy = cv2.Scharr(soft, cv2.CV_32F, 1, 0), cv2.Scharr(soft, cv2.CV_32F, 0, 1)
        row, column = np.nonzero((soft > 0.35) & (soft < 0.65))
        angle = np.arctan2(gy[row, column], gx[row, column]).astype(np.float64)
        cells = cell_of(np.stack([column, row], axis=1).astype(np.float64), *shape_of(mask))
        for kept, seen in ((own, angle), (mirrored, -angle), (swapped, 0.5 * np.pi - angle)):
            kept.append(float(edge_pictures(cells[None], seen[None])[0] @ drawn))
    assert np.median(own) > 0.7
    for other in (mirrored, swapped):
        assert np.mean(np.array(own) > np.array(other)) > MOST

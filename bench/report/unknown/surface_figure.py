"""A surface beside the true one, each as seen along three axes, brighter where it faces them."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from bench.report.plot import drawn_svg
from bench.report.unknown.figures import VIEWS
from bench.scoring.target_shape import spread_points
from models.arrays import Floats

SPREAD = 200_000  # places that are drawn of a surface
CELLS = 240  # along the longest side
MARGIN_M = 0.5
DARKEST = 0.25  # of a face that is seen along it
ALONG = (2, 1, 0)  # of the views, the axis along which is looked


def surface_figure(own: Floats, true: Floats) -> str:
    """Draw a surface above the true one, as SVG.

    Parameters
    ----------
    own, true : (f, 3, 3) and (g, 3, 3) arrays, m
        Triangles, true axes.
    """
    low = np.minimum(own.min(axis=(0, 1)), true.min(axis=(0, 1))) - MARGIN_M
    high = np.maximum(own.max(axis=(0, 1)), true.max(axis=(0, 1))) + MARGIN_M

    def draw(figure: Figure) -> None:
        panels = figure.subplots(2, 3)
        for line, (title, triangles) in zip(panels, (("carved", own), ("true", true)), strict=True):
            for panel, (across, up, right, top), along in zip(line, VIEWS, ALONG, strict=True):
                image = shaded(triangles, (across, up, along), low, high)
                extent = (low[across], high[across], low[up], high[up])
                panel.imshow(image, origin="lower", extent=extent, cmap="gray", vmin=0.0, vmax=1.0)
                panel.grid(visible=False)
                panel.set_title(title)
                panel.set_xlabel(right)
                panel.set_ylabel(top)

    return drawn_svg(draw, (11.0, 6.4))


def shaded(triangles: Floats, axes: tuple[int, int, int], low: Floats, high: Floats) -> Floats:
    """Return a surface as seen along an axis, (rows, columns), from 0 (none) to 1 (face on).

    Parameters
    ----------
    triangles : (f, 3, 3) array, m
    axes : (int, int, int)
        To the right, upwards, and towards the viewer.
    low, high : (3,) arrays, m
        What is drawn.
    """
    across, up, along = axes
    sides = triangles[:, 1:] - triangles[:, :1]
    normal = np.cross(sides[:, 0], sides[:, 1])
    length = np.linalg.norm(normal, axis=1)
    facing = np.abs(normal[:, along]) / np.maximum(length, 1e-12)
    ends = np.cumsum(length)
    whose = np.searchsorted(ends, (np.arange(SPREAD) + 0.5) / SPREAD * ends[-1])
    places = spread_points(triangles, SPREAD)
    cell = float((high - low).max()) / CELLS
    columns, rows = (((places[:, axis] - low[axis]) / cell).astype(int) for axis in (across, up))
    size = [int((high[axis] - low[axis]) / cell) + 1 for axis in (up, across)]
    image = np.zeros(size)
    nearest_last = np.argsort(places[:, along], kind="stable")
    bright = DARKEST + (1.0 - DARKEST) * facing[whose]
    image[rows[nearest_last], columns[nearest_last]] = bright[nearest_last]
    return image

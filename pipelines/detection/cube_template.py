"""What a solid corner cube should look like at a predicted pose, on a fine grid round its centre.

The camera's rays are followed to the cube's face, so perspective and distortion are in it; on the
face the aperture and the dark edges lie where ``models.spacecraft.corner_cube`` has them for light
that returns to where it came from: the lamps stand close round the lens, and half their angle from
it, refracted, moves the aperture's rim by hundredths of the radius in opposite ways.

Three pictures make the template, each from 0 to 1: the aperture, what the edges take out of it,
and the whole face evenly, for covers that spread light and for lenses that resolve less than they
promised. All three are their own images about the centre, but for perspective.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.arrays import Floats
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from models.spacecraft.corner_cube import ROOT2, dark_lines, face_axes, refracted_tangent

FINEST_PX, COARSEST_PX = 0.1, 0.25  # steps of the grid
STEPS_A_RADIUS = 48.0
MARGIN_PX = 1.0  # of the grid round the predicted outline
CONTROL_POINTS = 5  # along a side, by which rays are interpolated: second order, to 1e-6


@dataclass(frozen=True, eq=False)
class CubeTemplate:
    """One cube, expected.

    Attributes
    ----------
    x, y : (n,) and (m,) arrays, px
        Columns and rows of the grid, from the projected centre.
    step_px : float, px
        Between them.
    aperture, edges, face : (m, n) arrays
        Where light returns were there no edges; what of it the edges take; the whole disc.
    """

    x: Floats
    y: Floats
    step_px: float
    aperture: Floats
    edges: Floats
    face: Floats

    @cached_property
    def even(self) -> Floats:
        """(m, n) array: as much light from the whole face evenly."""
        return self.aperture_share * self.face

    @cached_property
    def aperture_share(self) -> float:
        """Area that returns light, edges taken off, over the face's."""
        return float((self.aperture - self.edges).sum() / max(self.face.sum(), 1e-9))


@dataclass(frozen=True, eq=False)
class _Face:
    """Places on a face over a grid, in units of the radius, and how they move by a pixel."""

    x: Floats
    y: Floats
    by_u: Floats
    by_v: Floats

    def width(self, along_x: Floats, along_y: Floats, step_px: float) -> Floats:
        """Return what a grid cell covers along a unit vector in the face."""
        across = self.by_u[0] * along_x + self.by_u[1] * along_y
        down = self.by_v[0] * along_x + self.by_v[1] * along_y
        return np.asarray(step_px * np.hypot(across, down))

    def widest(self, step_px: float) -> float:
        """Return the most that a grid cell covers along any unit vector."""
        slopes = np.concatenate([self.by_u, self.by_v])
        return float(step_px * np.linalg.norm(slopes))


def cube_template(
    camera: Camera,
    cam_from_target: RigidTransform,
    markers: MarkerPattern,
    index: int,
    centre_px: Floats,
    half_extent_px: Floats,
) -> CubeTemplate | None:
    """Return a marker's template; None where no cube is known of, or the lens has no ray.

    Parameters
    ----------
    camera : Camera
    cam_from_target : RigidTransform
    markers : MarkerPattern
    index : int
        Of the marker, which faces the camera.
    centre_px : (2,) array, px
        Projection of its centre.
    half_extent_px : (2,) array, px
        Half width and half height of its outline.
    """
    cubes = markers.cubes
    if cubes is None:
        return None
    normal = markers.normals_in_target[index]
    along, across = face_axes(normal)
    if cubes.edges_in_target is not None:
        along = cubes.edges_in_target[index]
        across = np.cross(normal, along)
    axes = cam_from_target.rotate(np.stack([along, across, normal]))
    centre = cam_from_target @ markers.points_in_target[index]
    # Perspective shifts the outline off the projected centre by less than the margin.
    reach = half_extent_px + MARGIN_PX
    step = float(np.clip(half_extent_px.max() / STEPS_A_RADIUS, FINEST_PX, COARSEST_PX))
    x, y = (step * np.arange(-np.ceil(r / step), np.ceil(r / step) + 1.0) for r in reach)
    face = _face(camera, centre, axes, markers.radius_m, centre_px, reach, x, y)
    if face is None:
        return None
    towards = -centre / np.linalg.norm(centre)
    tx, ty = refracted_tangent(
        np, float(towards @ axes[0]), float(towards @ axes[1]), cubes.refractive_index
    )
    disc = _inside(face, 0.0, 0.0, step)
    middles = (ROOT2 * tx, ROOT2 * ty), (-ROOT2 * tx, -ROOT2 * ty)
    aperture = np.minimum(*(_inside(face, *middle, step) for middle in middles))
    if cubes.edges_in_target is None:
        dark = _lines_turned_anyhow(face, cubes.edge_share)
    else:
        dark = _lines(face, dark_lines(tx, ty), cubes.edge_share, step)
    return CubeTemplate(x, y, step, aperture, aperture * dark, disc)


def _face(
    camera: Camera,
    centre: Floats,
    axes: Floats,
    radius_m: float,
    centre_px: Floats,
    reach: Floats,
    x: Floats,
    y: Floats,
) -> _Face | None:
    """Follow rays to the face's plane; None where there are none."""
    ticks = np.linspace(-1.0, 1.0, CONTROL_POINTS)
    u, v = (each.ravel() for each in np.meshgrid(ticks * reach[0], ticks * reach[1]))
    rays = camera.rays(centre_px + np.stack([u, v], axis=1))
    falling = rays @ axes[2]
    if not np.isfinite(falling).all() or (np.abs(falling) < 1e-9).any():
        return None
    met = rays * ((centre @ axes[2]) / falling)[:, None] - centre
    places = met @ axes[:2].T / radius_m
    terms = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=1)
    c = np.linalg.lstsq(terms, places, rcond=None)[0]
    c[0] = 0.0  # the centre's own ray meets the centre
    u, v = x[None, :], y[:, None]
    place = [
        c[1, k] * u + c[2, k] * v + c[3, k] * u * u + c[4, k] * u * v + c[5, k] * v * v
        for k in (0, 1)
    ]
    return _Face(place[0], place[1], c[1], c[2])


def _inside(face: _Face, x: float, y: float, step_px: float) -> Floats:
    """Return the share of each grid cell inside a circle of radius 1 about a place."""
    away_x, away_y = face.x - x, face.y - y
    distance = np.sqrt(away_x * away_x + away_y * away_y) + 1e-12
    share = (distance < 1.0).astype(np.float64)
    rim = np.abs(distance - 1.0) < face.widest(step_px)
    away_x, away_y, distance = away_x[rim], away_y[rim], distance[rim]
    width = face.width(away_x / distance, away_y / distance, step_px)
    share[rim] = np.clip(0.5 + (1.0 - distance) / (width + 1e-12), 0.0, 1.0)
    return share


def _lines(face: _Face, lines: list[tuple[float, float]], half: float, step_px: float) -> Floats:
    """Return the share of each grid cell that dark lines cover."""
    light = np.ones_like(face.x)
    for line_x, line_y in lines:
        length = np.hypot(line_x, line_y)
        square_x, square_y = -line_y / length, line_x / length
        width = face.width(square_x, square_y, step_px)
        off = np.abs(square_x * face.x + square_y * face.y)
        covered = np.minimum(off + 0.5 * width, half) - np.maximum(off - 0.5 * width, -half)
        light *= 1.0 - np.clip(covered / (width + 1e-12), 0.0, 1.0)
    return 1.0 - light


def _lines_turned_anyhow(face: _Face, half: float) -> Floats:
    """Return what six lines from the centre cover in the mean over all turns of the cube."""
    distance = np.hypot(face.x, face.y)
    ratio = half / np.maximum(distance, half)
    return np.asarray(np.minimum(6.0 / np.pi * np.arcsin(ratio), 1.0))

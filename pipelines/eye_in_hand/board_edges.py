"""Where the edges of the board are in an image, section by section, and the shadow along them.

Each edge is cut into sections that look along their normals for the step from black to what lies
beyond (``detection.edge_band``). Where the board's own shadow lies along an edge the largest step
is the shadow's border, so the strip between is looked for, too (``detection.edge_strip``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from models.arrays import Floats, Image, Indices, Mask
from models.camera import Camera
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.wireframe.wireframe import Wireframe
from pipelines.detection.edge_band import EdgeBand, FoundEdge, find_edge
from pipelines.detection.edge_strip import EdgePixels, find_strip
from pipelines.detection.image_difference import saturation_level_dn
from pipelines.detection.lit_disc import noise_terms

SECTIONS_PER_EDGE = 14
SECTION_SHARE = 0.6  # of the way from one section to the next that it covers
LEAST_STEP_SIGMAS, MOST_MISFIT = 8.0, 0.35
STRAIGHT_PX = 1e6
SECTION_FLOOR_PX = 0.05
LEAST_IN_LINE, IN_LINE_PX = 4, 1.0


@dataclass(frozen=True, eq=False)
class BoardEdges:
    """Sections of edges as a pose sees them, n of them, and what was found there.

    Attributes
    ----------
    points_in_target : (n, 3) array, m
        Their middles.
    normals_px : (n, 2) array
        Of the edges in the image, outward.
    edge : (n,) int array
        To which of the board's edges each belongs.
    offset_px : (n,) array, px
        How far outside of where the pose has it an edge was found.
    variance_px2 : (n,) array, px^2
    lever_px_m : (n,) array, px/m
        How far a section moves as its edge does, across.
    shadowed : (k,) array of bool
        Whether a strip lies along each of the board's k edges.
    """

    points_in_target: Floats
    normals_px: Floats
    edge: Indices
    offset_px: Floats
    variance_px2: Floats
    lever_px_m: Floats
    shadowed: Mask

    def __len__(self) -> int:
        return len(self.edge)

    def but_for(self, wide: BoardEdges) -> BoardEdges:
        """Return these, and from a wider band those edges along which it shows a shadow.

        Parameters
        ----------
        wide : BoardEdges
            As seen from the same pose.
        """
        own, other = ~wide.shadowed[self.edge], wide.shadowed[wide.edge]

        def joined(name: str) -> Any:
            return np.concatenate([getattr(self, name)[own], getattr(wide, name)[other]])

        return BoardEdges(
            joined("points_in_target"),
            joined("normals_px"),
            joined("edge"),
            joined("offset_px"),
            joined("variance_px2"),
            joined("lever_px_m"),
            self.shadowed | wide.shadowed,
        )


def find_board_edges(
    raw: Image,
    camera: Camera,
    detector: Detector,
    board: Wireframe,
    pose: RigidTransform,
    width: float,
    blur_px: float,
) -> BoardEdges:
    """Look for the edges of a board within a band round where a pose has them.

    Parameters
    ----------
    raw : (height, width) uint16 array, DN
    camera, detector
    board : Wireframe
        Its edges.
    pose : RigidTransform
        ``cam_from_target``.
    width : float, px
        Half the band's width.
    blur_px : float, px
        Expected 1-sigma of the lens's blur.
    """
    corners = board.points_in_target[board.edges]
    shares = (np.arange(SECTIONS_PER_EDGE) + 0.5) / SECTIONS_PER_EDGE
    places = corners[:, :1] + shares[None, :, None] * (corners[:, 1:] - corners[:, :1])
    half = SECTION_SHARE * 0.5 / SECTIONS_PER_EDGE * (corners[:, 1:] - corners[:, :1])
    middle = board.points_in_target.mean(axis=0)
    edge = np.repeat(np.arange(len(corners)), SECTIONS_PER_EDGE)
    points = places.reshape(-1, 3)
    start = camera.project(pose @ (places - half).reshape(-1, 3))
    end = camera.project(pose @ (places + half).reshape(-1, 3))
    centre, inside = camera.project(pose @ points), camera.project(pose @ middle)
    along = end - start
    length = np.linalg.norm(along, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = np.stack([along[:, 1], -along[:, 0]], axis=1) / length[:, None]
    normals *= np.where(((centre - inside) * normals).sum(axis=1) > 0.0, 1.0, -1.0)[:, None]
    seen = np.isfinite(centre).all(axis=1) & np.isfinite(normals).all(axis=1)
    seen &= camera.contains(np.nan_to_num(centre, nan=-1e9), width + 2.0)
    chosen = np.flatnonzero(seen)
    band = _pixels(raw, detector, centre[chosen], normals[chosen], length[chosen], width)
    found = find_edge(band, width, STRAIGHT_PX, blur_px, noise_terms(detector))
    ways = corners[:, 1] - corners[:, 0]
    ways = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    outwards = corners.mean(axis=1) - middle
    outwards = outwards - (outwards * ways).sum(axis=1, keepdims=True) * ways
    outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
    moved = camera.project(pose @ (points + 1e-4 * outwards[edge]))
    lever = ((moved - centre) * normals).sum(axis=1) / 1e-4
    with np.errstate(invalid="ignore"):
        clear = (
            np.isfinite(found.sigma_px)
            & (np.abs(found.step) > LEAST_STEP_SIGMAS * found.step_sigma)
            & (found.misfit < MOST_MISFIT)
            & (np.abs(found.offset_px) < width - 1.5)
        )
    kept = chosen[clear]
    edges = BoardEdges(
        points[kept],
        normals[kept],
        edge[kept],
        found.offset_px[clear],
        found.sigma_px[clear] ** 2 + SECTION_FLOOR_PX**2,
        lever[kept],
        np.zeros(len(corners), dtype=np.bool_),
    )
    return _without_strips(edges, band, found, np.flatnonzero(clear), kept, detector)


def _without_strips(
    edges: BoardEdges,
    band: EdgeBand,
    found: FoundEdge,
    sections: Indices,
    places: Indices,
    detector: Detector,
) -> BoardEdges:
    """Move each edge that has a strip along it to where the board ends."""
    offset, variance = edges.offset_px.copy(), edges.variance_px2.copy()
    shadowed = edges.shadowed.copy()
    middle = 0.5 * (SECTIONS_PER_EDGE - 1)
    along: Floats = (places % SECTIONS_PER_EDGE - middle).astype(np.float64) / middle
    for number in range(len(shadowed)):
        part = np.flatnonzero(edges.edge == number)
        line = _line(along[part], offset[part])
        if line is None:
            continue
        own, start, turn = part[line[0]], line[1], line[2]
        where = np.full(band.sections, -1)
        where[sections[own]] = np.arange(len(own))
        held = where[band.section] >= 0
        place = where[band.section[held]]
        strip = find_strip(
            EdgePixels(
                band.depth_px[held] + start + turn * along[own][place],
                along[own][place],
                place,
                edges.normals_px[own].mean(axis=0),
                band.level[held],
            ),
            found.blur_px,
            noise_terms(detector),
        )
        if strip is None:
            continue
        shadowed[number] = True
        offset[part] = np.where(np.isin(part, own), start + turn * along[part], np.nan)
        offset[part] += strip.offset_px + strip.turn_px * along[part]
        place_variance, turn_variance = np.diag(strip.covariance_px2)
        variance[part] = len(own) * max(place_variance, turn_variance / 3.0) + SECTION_FLOOR_PX**2
    told = np.isfinite(offset)
    return BoardEdges(
        edges.points_in_target[told],
        edges.normals_px[told],
        edges.edge[told],
        offset[told],
        variance[told],
        edges.lever_px_m[told],
        shadowed,
    )


def _line(along: Floats, offset: Floats) -> tuple[Indices, float, float] | None:
    """Return which offsets lie in a line, its middle and its turn; None where too few do."""
    if len(offset) < LEAST_IN_LINE:
        return None
    near = np.abs(offset - np.median(offset)) < 2.0 * IN_LINE_PX
    for _ in range(3):
        if near.sum() < LEAST_IN_LINE or np.ptp(along[near]) < 0.5:
            return None
        turn, start = np.polyfit(along[near], offset[near], 1)
        near = np.abs(offset - start - turn * along) < IN_LINE_PX
    if near.sum() < LEAST_IN_LINE:
        return None
    return np.flatnonzero(near), float(start), float(turn)


def _pixels(
    raw: Image, detector: Detector, centre: Floats, normals: Floats, length: Floats, width: float
) -> EdgeBand:
    """Take the pixels of each section's rectangle; only green ones, which are half of all."""
    reach = int(np.ceil(width + 0.5 * float(length.max(initial=1.0)))) + 1
    offsets = np.arange(-reach, reach + 1)
    dv, du = (grid.ravel() for grid in np.meshgrid(offsets, offsets, indexing="ij"))
    whole = np.rint(centre).astype(np.int64)
    columns, rows = whole[:, :1] + du, whole[:, 1:] + dv
    x, y = columns - centre[:, :1], rows - centre[:, 1:]
    depth = -(x * normals[:, :1] + y * normals[:, 1:])
    along = -x * normals[:, 1:] + y * normals[:, :1]
    inside = (np.abs(depth) <= width) & (np.abs(along) <= 0.5 * length[:, None])
    inside &= (columns >= 0) & (rows >= 0) & (columns < raw.shape[1]) & (rows < raw.shape[0])
    if detector.mosaic != "none":
        inside &= (columns + rows) % 2 == 1
    section, place = np.nonzero(inside)
    level = raw[rows[section, place], columns[section, place]].astype(np.float64)
    usable = level < saturation_level_dn(detector)
    section, place, level = section[usable], place[usable], level[usable]
    return EdgeBand(
        section,
        depth[section, place],
        normals[section],
        level - detector.bias_dn,
        np.ones_like(level),
        len(centre),
    )

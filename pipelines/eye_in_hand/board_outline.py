"""The board's outline, where dots fail: dots that are left and straight edges, one pose of both.

Each edge of the board is cut into sections that look along their normals for the step from black to
what lies beyond (``detection.edge_band``). All that is found is brought to one pose by Gauss-Newton
with robust weights; an edge's own survey error is common to its sections.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Image, Indices
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.wireframe.wireframe import Wireframe
from pipelines.detection.edge_band import EdgeBand, find_edge
from pipelines.detection.image_difference import saturation_level_dn
from pipelines.detection.lit_disc import noise_terms
from pipelines.pnp.match import Match
from pipelines.pnp.projection_jacobian import jacobian_by_turn

SECTIONS_PER_EDGE = 14
SECTION_SHARE = 0.6  # of the way from one section to the next that it covers
BANDS_PX = (12.0, 6.0, 5.0)
LEAST_STEP_SIGMAS, MOST_MISFIT = 8.0, 0.35
STRAIGHT_PX = 1e6
SECTION_FLOOR_PX = 0.05
TUKEY = 4.685
LEAST_SECTIONS = 8
SINGULAR = 1e-12
STEPS = 4


@dataclass(frozen=True, eq=False)
class OutlinePose:
    """A pose from dots and outline.

    Attributes
    ----------
    pose : RigidTransform
        ``cam_from_target``.
    covariance : (6, 6) array, rad and m
    sections : int
        Of edges, that were used.
    residual_rms_px : float, px
    """

    pose: RigidTransform
    covariance: Floats
    sections: int
    residual_rms_px: float


@dataclass(frozen=True, eq=False)
class _Sections:
    """Sections of edges as a pose sees them, and what was found there."""

    points_in_target: Floats
    normals_px: Floats
    edge: Indices
    offset_px: Floats
    variance_px2: Floats
    lever_px_m: Floats  # how far a section moves as its edge does, across


def pose_from_outline(
    raw: Image,
    camera: Camera,
    detector: Detector,
    markers: MarkerPattern,
    board: Wireframe,
    match: Match,
    start: RigidTransform,
    prior_covariance: Floats,
    blur_px: float,
    edge_sigma_m: float,
) -> OutlinePose | str:
    """Solve for the pose that dots and outline make together.

    Parameters
    ----------
    raw : (height, width) uint16 array, DN
    camera, detector, markers
    board : Wireframe
        Its edges.
    match : Match
        The dots that are left, none to two.
    start : RigidTransform
        Guess of ``cam_from_target``.
    prior_covariance : (6, 6) array, rad and m
        Of the guess: it leads the way to the edges, and is no part of the answer.
    blur_px : float, px
    edge_sigma_m : float, m
        1-sigma of an edge's place as surveyed.

    Returns
    -------
    OutlinePose or str
        In words, why there is none.
    """
    information: Floats = np.linalg.inv(prior_covariance + 1e-12 * np.eye(6)).astype(np.float64)
    pose = _drawn_to_dots(camera, markers, match, start, information)
    sought = sections = None
    for width in BANDS_PX:
        sought = pose
        sections = _found(raw, camera, detector, board, pose, width, blur_px)
        if len(sections.edge) < LEAST_SECTIONS:
            return "and too little of the board's outline shows"
        prior = information if width == BANDS_PX[0] else 0.0 * information
        solved = _solved(camera, markers, match, pose, sections, prior)
        if solved is None:
            return _unobservable(match, sections)
        pose = solved[0]
    assert sections is not None
    assert sought is not None
    left = _left_of_sections(camera, sought, pose, sections)
    return _summary(camera, markers, match, pose, sections, left, edge_sigma_m)


def _unobservable(match: Match, sections: _Sections) -> str:
    edges = len(np.unique(sections.edge))
    return f"and {len(match)} dots with {edges} edges of the board do not determine a pose"


def _dot_equations(
    camera: Camera, markers: MarkerPattern, match: Match, pose: RigidTransform
) -> tuple[Floats, Floats]:
    """Return the dots' whitened rows, (2 k, 6), and what is left of them, (2 k,)."""
    if len(match) == 0:
        return np.zeros((0, 6)), np.zeros(0)
    points = markers.points_in_target[match.marker]
    focal = np.array([[camera.fx], [camera.fy]])
    jacobian = focal * jacobian_by_turn(pose.rotation, pose.translation, points)
    left = match.points_px - camera.project(pose @ points)
    whitening = np.linalg.inv(np.linalg.cholesky(match.covariance_px2))
    rows = (whitening @ jacobian).reshape(-1, 6)
    return rows, np.einsum("nij,nj->ni", whitening, left).reshape(-1)


def _drawn_to_dots(
    camera: Camera, markers: MarkerPattern, match: Match, pose: RigidTransform, prior: Floats
) -> RigidTransform:
    """Move the guess to the dots that are there, no further than it allows."""
    start = pose
    for _ in range(STEPS if len(match) else 0):
        rows, left = _dot_equations(camera, markers, match, pose)
        if not np.isfinite(left).all():
            return start
        turn = start.rotation @ pose.rotation.T
        away = np.array([turn[2, 1], turn[0, 2], turn[1, 0]])  # of so small a turn
        back = np.concatenate([away, start.translation - pose.translation])
        step = np.linalg.solve(rows.T @ rows + prior, rows.T @ left + prior @ back)
        pose = pose.perturbed(step[:3], step[3:])
    return pose


def _found(
    raw: Image,
    camera: Camera,
    detector: Detector,
    board: Wireframe,
    pose: RigidTransform,
    width: float,
    blur_px: float,
) -> _Sections:
    """Look for the edges of the board within a band round where a pose has them."""
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
    return _Sections(
        points[kept],
        normals[kept],
        edge[kept],
        found.offset_px[clear],
        found.sigma_px[clear] ** 2 + SECTION_FLOOR_PX**2,
        lever[kept],
    )


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


def _edge_rows(camera: Camera, pose: RigidTransform, sections: _Sections) -> Floats:
    by_pose = jacobian_by_turn(pose.rotation, pose.translation, sections.points_in_target)
    by_pose = by_pose * np.array([camera.fx, camera.fy])[:, None]
    return np.asarray(np.einsum("ni,nij->nj", sections.normals_px, by_pose))


def _left_of_sections(
    camera: Camera, start: RigidTransform, pose: RigidTransform, sections: _Sections
) -> Floats:
    """Return how far the found edges lie outside those of a pose, having been sought at another."""
    moved = camera.project(pose @ sections.points_in_target)
    moved = moved - camera.project(start @ sections.points_in_target)
    return np.asarray(sections.offset_px - (moved * sections.normals_px).sum(axis=1))


def _weights(left: Floats, variance: Floats) -> Floats:
    spread = 1.4826 * float(np.median(np.abs(left)))
    ratio = left / (TUKEY * np.hypot(max(spread, 0.1), np.sqrt(variance)))
    return np.where(np.abs(ratio) < 1.0, (1.0 - ratio**2) ** 2, 0.0) / variance


def _solved(
    camera: Camera,
    markers: MarkerPattern,
    match: Match,
    start: RigidTransform,
    sections: _Sections,
    prior: Floats,
) -> tuple[RigidTransform, Floats] | None:
    """Take some Gauss-Newton steps from where the edges were sought."""
    pose, normal = start, prior
    for _ in range(STEPS):
        rows, residual = _dot_equations(camera, markers, match, pose)
        edges = _edge_rows(camera, pose, sections)
        left = _left_of_sections(camera, start, pose, sections)
        if not (np.isfinite(residual).all() and np.isfinite(left).all()):
            return None
        weighted = edges * _weights(left, sections.variance_px2)[:, None]
        normal = rows.T @ rows + weighted.T @ edges + prior
        if not _determined(normal):
            return None
        turn = start.rotation @ pose.rotation.T
        away = np.array([turn[2, 1], turn[0, 2], turn[1, 0]])
        back = np.concatenate([away, start.translation - pose.translation])
        step = np.linalg.solve(normal, rows.T @ residual + weighted.T @ left + prior @ back)
        if np.abs(step[:3]).max() > 0.3:
            return None
        pose = pose.perturbed(step[:3], step[3:])
    return pose, normal


def _determined(normal: Floats) -> bool:
    scale = np.sqrt(np.diag(normal))
    if not (np.isfinite(scale).all() and scale.min() > 0.0):
        return False
    values = np.linalg.eigvalsh(normal / np.outer(scale, scale))
    return bool(values[0] > SINGULAR * values[-1])


def _summary(
    camera: Camera,
    markers: MarkerPattern,
    match: Match,
    pose: RigidTransform,
    sections: _Sections,
    left: Floats,
    edge_sigma_m: float,
) -> OutlinePose | str:
    """State the covariance, by dots and outline alone: each edge's survey error is common to it."""
    rows, residual = _dot_equations(camera, markers, match, pose)
    edges = _edge_rows(camera, pose, sections)
    weights = _weights(left, sections.variance_px2)
    used = weights > 0.0
    weighted = edges * weights[:, None]
    normal = rows.T @ rows + weighted.T @ edges
    if used.sum() < LEAST_SECTIONS or not _determined(normal):
        return _unobservable(match, sections)
    own = np.linalg.inv(normal)
    chi2 = float((weights * left**2).sum()) / max(int(used.sum()) + len(residual) - 6, 1)
    covariance = max(chi2, 1.0) * own
    for number in np.unique(sections.edge):
        part = sections.edge == number
        pull = own @ (weighted[part].T @ sections.lever_px_m[part])
        covariance = covariance + edge_sigma_m**2 * np.outer(pull, pull)
    rms = float(np.sqrt((weights * left**2).sum() / weights.sum()))
    return OutlinePose(pose, 0.5 * (covariance + covariance.T), int(used.sum()), rms)

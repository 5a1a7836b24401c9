"""The board's outline, where dots fail: dots that are left and straight edges, one pose of both.

All sections of edges that are found (``board_edges``) are brought to one pose by Gauss-Newton
with robust weights. What moves an edge as a whole, its survey and what of a shadow along it is too
narrow to be seen, is common to its sections. An edge that the others and the dots speak against, as
fault detection in navigation has it (Parkinson and Axelrad 1988), is freed of its place and keeps
its direction; where two edges could be the one, there is no pose.
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
from pipelines.eye_in_hand.board_edges import BoardEdges, find_board_edges
from pipelines.pnp.match import Match
from pipelines.pnp.projection_jacobian import jacobian_by_turn

BANDS_PX = (12.0, 6.0, 5.0)
TUKEY = 4.685
LEAST_SECTIONS = 8
SINGULAR = 1e-12
STEPS = 4
BLIND_PX, PENUMBRA_M = 0.25, 4e-4  # 1-sigma of an edge's place beyond its survey
FREE_PX = 1e3  # the same of an edge that is not believed
MOST_FREED = 2
CONTRADICTED_CHI2 = 12.0  # by which freeing an edge betters the fit
RIVAL_CHI2 = 9.0  # by which the freed edge must better it more than any other would
SAME_CHI2 = 9.0  # of two poses that are one
NONE: frozenset[int] = frozenset()


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
class _Solved:
    """What Gauss-Newton came to: the pose, the equations there and what is left."""

    pose: RigidTransform
    normal: Floats
    weights: Floats
    left: Floats
    chi2: float


@dataclass(frozen=True, eq=False)
class _Problem:
    """Dots and sections of edges, as sought from a pose."""

    camera: Camera
    markers: MarkerPattern
    match: Match
    start: RigidTransform
    edges: BoardEdges
    edge_sigma_m: float

    def solved(self, prior: Floats, freed: frozenset[int]) -> _Solved | None:
        """Take some Gauss-Newton steps; some edges are free to lie elsewhere."""
        pose, last = self.start, None
        for step_number in range(STEPS + 1):
            rows, residual = dot_equations(self.camera, self.markers, self.match, pose)
            by_pose, left = self._edge_rows(pose), self._left(pose)
            if not (np.isfinite(residual).all() and np.isfinite(left).all()):
                return None
            robust = _weights(left, self.edges.variance_px2, self.edges.edge)
            whole = self._information(robust, freed)
            weighted = whole @ by_pose
            normal = rows.T @ rows + weighted.T @ by_pose + prior
            chi2 = float(residual @ residual + left @ whole @ left)
            last = _Solved(pose, normal - prior, robust, left, chi2)
            if not _determined(normal):
                return None
            if step_number == STEPS:
                break
            back = _away(self.start, pose)
            step = np.linalg.solve(normal, rows.T @ residual + weighted.T @ left + prior @ back)
            if np.abs(step[:3]).max() > 0.3:
                return None
            pose = pose.perturbed(step[:3], step[3:])
        return last

    def _information(self, robust: Floats, freed: frozenset[int]) -> Floats:
        """Return the sections' information, (n, n): those of an edge have an error in common."""
        information = np.diag(robust)
        for number in np.unique(self.edges.edge):
            part = np.flatnonzero(self.edges.edge == number)
            blind = FREE_PX if int(number) in freed else BLIND_PX
            known_m = float(np.hypot(self.edge_sigma_m, PENUMBRA_M))
            common = np.hypot(known_m * self.edges.lever_px_m[part], blind)
            pulled = robust[part] * common
            block = np.outer(pulled, pulled) / (1.0 + float(pulled @ common))
            information[np.ix_(part, part)] -= block
        return information

    def _edge_rows(self, pose: RigidTransform) -> Floats:
        camera = self.camera
        by_pose = jacobian_by_turn(pose.rotation, pose.translation, self.edges.points_in_target)
        by_pose = by_pose * np.array([camera.fx, camera.fy])[:, None]
        return np.asarray(np.einsum("ni,nij->nj", self.edges.normals_px, by_pose))

    def _left(self, pose: RigidTransform) -> Floats:
        """Return how far the found edges lie outside those of a pose."""
        points = self.edges.points_in_target
        moved = self.camera.project(pose @ points) - self.camera.project(self.start @ points)
        return np.asarray(self.edges.offset_px - (moved * self.edges.normals_px).sum(axis=1))


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
    problem = None
    for width in BANDS_PX:
        edges = _edges_within(raw, camera, detector, board, pose, width, blur_px)
        if len(edges) < LEAST_SECTIONS:
            return "and too little of the board's outline shows"
        problem = _Problem(camera, markers, match, pose, edges, edge_sigma_m)
        solved = problem.solved(information if width == BANDS_PX[0] else 0.0 * information, NONE)
        if solved is None:
            return _unobservable(match, edges)
        pose = solved.pose
    assert problem is not None
    return _summary(problem)


def _edges_within(
    raw: Image,
    camera: Camera,
    detector: Detector,
    board: Wireframe,
    pose: RigidTransform,
    width: float,
    blur_px: float,
) -> BoardEdges:
    """Look for edges within a band; where a shadow lies along one, in the widest."""
    wide = find_board_edges(raw, camera, detector, board, pose, BANDS_PX[0], blur_px)
    if width >= BANDS_PX[0]:
        return wide
    return find_board_edges(raw, camera, detector, board, pose, width, blur_px).but_for(wide)


def _unobservable(match: Match, edges: BoardEdges) -> str:
    count = len(np.unique(edges.edge))
    return f"and {len(match)} dots with {count} edges of the board do not determine a pose"


def dot_equations(
    camera: Camera, markers: MarkerPattern, match: Match, pose: RigidTransform
) -> tuple[Floats, Floats]:
    """Return the dots' whitened rows, (2 k, 6), and what is left of them, (2 k,).

    Parameters
    ----------
    camera, markers
    match : Match
        k dots.
    pose : RigidTransform
        ``cam_from_target``.
    """
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
        rows, left = dot_equations(camera, markers, match, pose)
        if not np.isfinite(left).all():
            return start
        back = _away(start, pose)
        step = np.linalg.solve(rows.T @ rows + prior, rows.T @ left + prior @ back)
        pose = pose.perturbed(step[:3], step[3:])
    return pose


def _away(start: RigidTransform, pose: RigidTransform) -> Floats:
    turn = start.rotation @ pose.rotation.T
    small = np.array([turn[2, 1], turn[0, 2], turn[1, 0]])
    return np.concatenate([small, start.translation - pose.translation])


def _weights(left: Floats, variance: Floats, edge: Indices) -> Floats:
    """Return robust weights, about each edge's own middle: an edge may lie elsewhere as a whole."""
    weights = np.zeros_like(left)
    for number in np.unique(edge):
        part = edge == number
        own = left[part] - np.median(left[part])
        spread = 1.4826 * float(np.median(np.abs(own)))
        ratio = own / (TUKEY * np.hypot(max(spread, 0.1), np.sqrt(variance[part])))
        kept = np.where(np.abs(ratio) < 1.0, (1.0 - ratio**2) ** 2, 0.0)
        weights[part] = kept / np.maximum(variance[part], spread**2)
    return weights


def _determined(normal: Floats) -> bool:
    scale = np.sqrt(np.diag(normal))
    if not (np.isfinite(scale).all() and scale.min() > 0.0):
        return False
    values = np.linalg.eigvalsh(normal / np.outer(scale, scale))
    return bool(values[0] > SINGULAR * values[-1])


def _summary(problem: _Problem) -> OutlinePose | str:
    """Free edges that are spoken against, and state what dots and outline alone tell."""
    nothing = np.zeros((6, 6))
    freed, solved = NONE, problem.solved(nothing, NONE)
    if solved is None:
        return _unobservable(problem.match, problem.edges)
    for _ in range(MOST_FREED + 1):
        others = {
            int(number): problem.solved(nothing, freed | {int(number)})
            for number in np.unique(problem.edges.edge)
            if int(number) not in freed
        }
        gains = {n: solved.chi2 - each.chi2 for n, each in others.items() if each is not None}
        worst = max(gains, key=lambda n: gains[n], default=None)
        if worst is None or gains[worst] < CONTRADICTED_CHI2:
            return _stated(problem, solved)
        better = others[worst]
        assert better is not None
        for number, gain in gains.items():
            rival = others[number]
            if number == worst or gain < gains[worst] - RIVAL_CHI2 or rival is None:
                continue
            if not _one(better, rival):
                return "and the edges of the board contradict each other"
        freed, solved = freed | {worst}, better
    return "and the edges of the board contradict each other"


def _one(first: _Solved, second: _Solved) -> bool:
    """Tell whether two poses are one, by what both are known to."""
    away = _away(first.pose, second.pose)
    both = np.linalg.inv(first.normal) + np.linalg.inv(second.normal)
    return bool(away @ np.linalg.solve(both, away) < SAME_CHI2)


def _stated(problem: _Problem, solved: _Solved) -> OutlinePose | str:
    used = solved.weights > 0.0
    if used.sum() < LEAST_SECTIONS or not _determined(solved.normal):
        return _unobservable(problem.match, problem.edges)
    freedom = max(int(used.sum()) + 2 * len(problem.match) - 6, 1)
    covariance = max(solved.chi2 / freedom, 1.0) * np.linalg.inv(solved.normal)
    weights = solved.weights
    rms = float(np.sqrt((weights * solved.left**2).sum() / weights.sum()))
    return OutlinePose(solved.pose, 0.5 * (covariance + covariance.T), int(used.sum()), rms)

"""Straight edges of a target in an image, and the corners where two of them meet.

OpenCV's line segment detector is used at its own scale: reduced, as by default, its segments lie
half a pixel of the difference off. Pieces of one line are merged, and two lines that end near each
other at an angle meet in a corner, which the lines fix better than the few pixels around it.

Source: von Gioi, Jakubowicz, Morel and Randall 2010, IEEE PAMI 32, "LSD".
"""

from __future__ import annotations

import cv2
import numpy as np

from models.arrays import Floats
from pipelines.detection.corners import Corners
from pipelines.detection.target_region import TargetRegion

SHORTEST_PX = 8.0
LEVELS = 255.0
SAME_ANGLE_RAD = 0.05
SAME_LINE_PX = 1.5
LARGEST_GAP_PX = 8.0
ALONG = 24  # places on a segment where it is laid on the light
MEETING_PX = 6.0  # from the lines' ends to where they meet
LEAST_ANGLE_RAD = 0.35
LINE_SIGMA_PX = 0.15  # across, of a segment's ends


def find_segments(target: TargetRegion) -> Floats:
    """Return straight edges, (n, 4) px: x, y of one end and of the other; longest first.

    Parameters
    ----------
    target : TargetRegion
    """
    if not target:
        return np.zeros((0, 4))
    row, column = np.nonzero(target.lit)
    top, left = max(int(row.min()) - 10, 0), max(int(column.min()) - 10, 0)
    part = target.stretched[top : int(row.max()) + 11, left : int(column.max()) + 11]
    levels = np.clip(part, 0.0, None) * (LEVELS / max(float(part.max()), 1e-6))
    detector = cv2.createLineSegmentDetector(cv2.LSD_REFINE_STD, scale=1.0)
    found = detector.detect(levels.astype(np.uint8))[0]
    if found is None:
        return np.zeros((0, 4))
    segments = found.reshape(-1, 4).astype(np.float64) + np.array([left, top, left, top])
    length = np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1])
    order = np.argsort(length)[::-1]
    lines = merged(segments[order[length[order] >= SHORTEST_PX]])
    return _on_the_light(lines, target)


def _on_the_light(segments: Floats, target: TargetRegion) -> Floats:
    """Move segments across to where the light itself is steepest; its logarithm is so outside."""
    if len(segments) == 0:
        return segments
    starts, ends = segments[:, None, :2], segments[:, None, 2:]
    along = (ends - starts)[:, 0]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    across /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    share = np.linspace(0.1, 0.9, ALONG)[None, :, None]
    offsets = 0.5 * np.arange(-6, 7)
    middle = starts + share * (ends - starts)
    places = middle[:, :, None] + offsets[None, None, :, None] * across[:, None, None]
    x, y = places.reshape(-1, len(offsets), 2).astype(np.float32).transpose(2, 0, 1)
    light = cv2.remap(target.signal, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    slope = np.abs(light[:, 2:] - light[:, :-2]).astype(np.float64)
    weight = np.maximum(slope - 0.5 * slope.max(axis=1, keepdims=True), 0.0)
    total = weight.sum(axis=1)
    shift = ((weight @ offsets[1:-1]) / np.maximum(total, 1e-9)).reshape(len(segments), ALONG)
    # A straight line through the shifts, less moved by the few that saw something else.
    centre = np.median(shift, axis=1, keepdims=True)
    shift = np.clip(shift, centre - 0.5, centre + 0.5)
    lever = share[0, :, 0] - 0.5
    slope_of = (shift @ lever) / (lever @ lever)
    level = shift.mean(axis=1)
    first = segments[:, :2] + (level - 0.5 * slope_of)[:, None] * across
    last = segments[:, 2:] + (level + 0.5 * slope_of)[:, None] * across
    return np.concatenate([first, last], axis=1)


def merged(segments: Floats) -> Floats:
    """Join segments (n, 4) of one line with no more than a small gap between them."""
    left = [tuple(one) for one in segments.tolist()]
    out: list[Floats] = []
    while left:
        line = np.array(left.pop(0))
        grown = True
        while grown:
            grown = False
            for k, other in enumerate(left):
                joined = _joined(line, np.array(other))
                if joined is not None:
                    line, grown = joined, True
                    left.pop(k)
                    break
        out.append(line)
    return np.array(out).reshape(-1, 4)


def _joined(line: Floats, other: Floats) -> Floats | None:
    start, along = line[:2], line[2:] - line[:2]
    length = float(np.linalg.norm(along))
    along = along / length
    across = np.array([-along[1], along[0]])
    ends = other.reshape(2, 2) - start
    turn = other[2:] - other[:2]
    sine = abs(float(along[0] * turn[1] - along[1] * turn[0])) / max(
        float(np.linalg.norm(turn)), 1e-9
    )
    if sine > SAME_ANGLE_RAD or np.abs(ends @ across).max() > SAME_LINE_PX:
        return None
    places = ends @ along
    if places.min() > length + LARGEST_GAP_PX or places.max() < -LARGEST_GAP_PX:
        return None
    points = np.concatenate([line.reshape(2, 2), other.reshape(2, 2)])
    along_all = (points - start) @ along
    first, last = points[int(along_all.argmin())], points[int(along_all.argmax())]
    return np.concatenate([first, last])


def line_corners(segments: Floats) -> Corners:
    """Return the corners where two segments (n, 4) end at an angle to each other."""
    if len(segments) < 2:
        return Corners.none()
    starts, ends = segments[:, :2], segments[:, 2:]
    length = np.maximum(np.linalg.norm(ends - starts, axis=1), 1e-9)
    along = (ends - starts) / length[:, None]
    first, second = np.triu_indices(len(segments), 1)
    a, b = along[first], along[second]
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    keep = np.abs(cross) > np.sin(LEAST_ANGLE_RAD)
    first, second, a, b, cross = first[keep], second[keep], a[keep], b[keep], cross[keep]
    gap = starts[second] - starts[first]
    t = (gap[:, 0] * b[:, 1] - gap[:, 1] * b[:, 0]) / cross
    u = (gap[:, 0] * a[:, 1] - gap[:, 1] * a[:, 0]) / cross
    beyond_first = np.minimum(np.abs(t), np.abs(t - length[first]))
    beyond_second = np.minimum(np.abs(u), np.abs(u - length[second]))
    meets = (beyond_first < MEETING_PX) & (beyond_second < MEETING_PX)
    points = (starts[first] + t[:, None] * a)[meets]
    # Two lines of equal sigma meet with a variance per axis that grows as they come to agree.
    sigma = LINE_SIGMA_PX / np.abs(cross[meets])
    kept: list[int] = []
    for k in np.argsort(sigma).tolist():
        if all(np.linalg.norm(points[k] - points[j]) > 2.0 for j in kept):
            kept.append(k)
    return Corners(points[kept].reshape(-1, 2), np.stack([sigma[kept]] * 2, axis=1).reshape(-1, 2))

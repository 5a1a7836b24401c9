"""The straight sharp edges of a mesh, and the corners where they end.

An edge is sharp where its two faces meet at more than an angle, or where there is but one face.
Pieces that go on in a line are one edge. A corner is where three such lines meet, or two at an
angle; the rim of a round hole, of many short pieces each a little off the last, has none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices, Mask
from models.spacecraft.own.welded import Welded

STRAIGHT_DEG = 6.0  # pieces that turn by less go on in a line
CORNER_DEG = 25.0  # two lines that turn by less are a bend, and make no corner,
BEND_DEG = 8.0  # unless both are long, and they turn by more than this
LONG_SHARE = 0.1  # of the mesh's size


@dataclass(frozen=True, eq=False)
class SharpEdges:
    """Lines between points of a mesh.

    Attributes
    ----------
    ends : (e, 2) array of int
        Points of the mesh.
    lengths_m : (e,) array, m
    """

    ends: Indices
    lengths_m: Floats


def sharp_edges(body: Welded, sharp_deg: float) -> SharpEdges:
    """Find the sharp edges of a mesh, pieces in a line joined.

    Parameters
    ----------
    body : Welded
        In m.
    sharp_deg : float, deg
    """
    pieces = body.edges.ends[_sharp(body, sharp_deg)]
    lines = _joined(body.points, pieces)
    lengths = np.linalg.norm(body.points[lines[:, 1]] - body.points[lines[:, 0]], axis=1)
    return SharpEdges(lines, lengths)


def corners_of(points: Floats, lines: SharpEdges) -> tuple[Indices, Floats]:
    """Return the points that are corners, and how large each is.

    Parameters
    ----------
    points : (n, 3) array, m
        Of the mesh.
    lines : SharpEdges

    Returns
    -------
    corners : (k,) array of int
    sizes_m : (k,) array, m
        Length of the three longest lines that end there, each counted once.
    """
    ways: dict[int, list[Floats]] = {}
    for a, b in lines.ends.tolist():
        ways.setdefault(a, []).append(points[b] - points[a])
        ways.setdefault(b, []).append(points[a] - points[b])
    long_m = LONG_SHARE * float(np.ptp(points, axis=0).max())
    corners, sizes = [], []
    for point, leaving in sorted(ways.items()):
        lengths = np.linalg.norm(leaving, axis=1)
        if len(leaving) >= 3 or (len(leaving) == 2 and _turns(leaving, lengths, long_m)):
            corners.append(point)
            sizes.append(float(np.sort(lengths)[-3:].sum()))
    return np.array(corners, dtype=np.int64), np.array(sizes)


def _sharp(body: Welded, sharp_deg: float) -> Mask:
    edges, normals = body.edges, body.normals
    cosine = np.einsum("ei,ei->e", normals[edges.first], normals[edges.second])
    cosine = np.where(edges.against, cosine, -cosine)  # one of the two looks inwards
    return np.asarray((edges.count != 2) | (cosine < np.cos(np.deg2rad(sharp_deg))))


def _turns(leaving: list[Floats], lengths: Floats, long_m: float) -> bool:
    least_deg = BEND_DEG if lengths.min() > long_m else CORNER_DEG
    cosine = float(leaving[0] @ leaving[1]) / float(lengths[0] * lengths[1])
    return -cosine < float(np.cos(np.deg2rad(least_deg)))


def _joined(points: Floats, pieces: Indices) -> Indices:
    """Join pieces that go on in a line, two by two, at every point where just two of them do."""
    at: dict[int, list[int]] = {}
    for number, (a, b) in enumerate(pieces.tolist()):
        at.setdefault(a, []).append(number)
        at.setdefault(b, []).append(number)
    goes_on: dict[tuple[int, int], int] = {}  # (piece, point) to the next piece
    least = np.cos(np.deg2rad(STRAIGHT_DEG))
    for point, numbers in at.items():
        ways = np.array([points[_other(pieces, n, point)] - points[point] for n in numbers])
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        straight = -(ways @ ways.T)
        for i, number in enumerate(numbers):
            j = int(np.argmax(straight[i]))
            if straight[i, j] > least and int(np.argmax(straight[j])) == i:
                goes_on[(number, point)] = numbers[j]
    used = np.zeros(len(pieces), dtype=bool)
    lines: list[tuple[int, int]] = []
    for start, (a, b) in enumerate(pieces.tolist()):
        if used[start]:
            continue
        used[start] = True
        tips = [_walk(points, pieces, goes_on, used, start, point) for point in (a, b)]
        if tips[0] != tips[1]:
            lines.append((tips[0], tips[1]))
    return np.array(lines, dtype=np.int64).reshape(-1, 2)


def _walk(
    points: Floats,
    pieces: Indices,
    goes_on: dict[tuple[int, int], int],
    used: Mask,
    start: int,
    point: int,
) -> int:
    """Follow a line from a piece over one of its ends; it ends where it has turned too far."""
    way = points[point] - points[_other(pieces, start, point)]
    way = way / np.linalg.norm(way)
    piece, least = start, np.cos(np.deg2rad(STRAIGHT_DEG))
    while (after := goes_on.get((piece, point))) is not None and not used[after]:
        ahead = _other(pieces, after, point)
        step = points[ahead] - points[point]
        if step @ way < least * np.linalg.norm(step):
            break
        used[after] = True
        piece, point = after, ahead
    return point


def _other(pieces: Indices, number: int, point: int) -> int:
    a, b = pieces[number]
    return int(b if a == point else a)

"""A wireframe found on a mesh: its large corners, the straight edges between them, what hides them.

Corners and edges that no camera ever sees, such as those of a bracket inside a body, are left out.
Where a bevel or a thickness makes two corners of one, the landmark lies between them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import ConvexHull, QhullError, cKDTree

from models.arrays import Floats, Indices, Mask
from models.pose import RigidTransform
from models.spacecraft.hull import is_appendage
from models.spacecraft.own.description import WireframeWish
from models.spacecraft.own.sharp_edges import corners_of, sharp_edges
from models.spacecraft.own.simplify import simplified
from models.spacecraft.own.symmetry import symmetries_of
from models.spacecraft.own.welded import welded
from models.wireframe.visibility import CLEAR_M, visible_points
from models.wireframe.wireframe import Wireframe

MOST_TRIED = 400  # corners that are looked at from all around
DIRECTIONS = 64  # from which
FINE_FACES = 3000  # of the surface that hides them then
SEEN_FROM = 0.08  # of them, at least, to be worth knowing
APART_SHARE = 0.03  # of the radius: a corner nearer than this to a typed one is that one
MERGED_SHARE = 0.02  # of the radius: corners nearer than this are one, between them,
MERGED_M = 2.0 * CLEAR_M  # or nearer than this: so it is seen from both sides of a sheet
LEAST_CORNER_SHARE = 0.1  # of the radius: what edges a corner must have at least, all in all
LEAST_EDGE_SHARE = 0.06  # of the radius: an edge shorter than this is no edge to look for
ENOUGH_CORNERS, ENOUGH_EDGES = 8, 8  # as a box has, about
LEAST_CORNERS = 4  # with fewer,
BLUNT_DEG = 5.0  # of a ball, any edge of its coarse form will do
COARSE_FACES = (200, 100, 60)
FAR = 20.0  # radii: from where it is looked at


@dataclass(frozen=True, eq=False)
class FoundShape:
    """What was found on a mesh.

    Attributes
    ----------
    points : (m, 3) array, m
        Corners, the largest first.
    sizes_m : (m,) array, m
        Of each: the length of the three longest edges that end there.
    edges : (e, 2) array of int
        Between corners, the longest first.
    rounded : bool
        Whether they are those of its coarse form.
    """

    points: Floats
    sizes_m: Floats
    edges: Indices
    rounded: bool = False


def find_shape(triangles: Floats, fine: Floats, hiding: Floats, wish: WireframeWish) -> FoundShape:
    """Find corners and edges on a mesh; where all are rounded, those of its coarse form.

    A fillet of many small steps has no sharp edge. With few faces left it is a bevel or an edge,
    within the fillet's radius of where one would draw it.

    Parameters
    ----------
    triangles : (f, 3, 3) array, m
        In the target frame.
    fine, hiding : (g, 3, 3) arrays, m
        The same surface with fewer faces, and with few.
    wish : WireframeWish
    """
    shape = _sharp_shape(triangles, fine, wish)
    for faces in COARSE_FACES:
        if len(shape.edges) >= ENOUGH_EDGES and len(shape.points) >= ENOUGH_CORNERS:
            break
        deg = wish.sharp_deg if len(shape.points) >= LEAST_CORNERS else BLUNT_DEG
        coarse = _sharp_shape(simplified(hiding, faces), hiding, replace(wish, sharp_deg=deg))
        if len(coarse.edges) > len(shape.edges):
            shape = replace(coarse, rounded=True)
    if len(shape.points) >= LEAST_CORNERS and len(shape.edges):
        return shape
    return replace(_of_hull(hiding, wish), rounded=True)


def _of_hull(hiding: Floats, wish: WireframeWish) -> FoundShape:
    """Find corners and edges of a swarm of small things: those of the hull about it."""
    corners = hiding.reshape(-1, 3)
    try:
        hull = corners[ConvexHull(corners).simplices]
    except QhullError:  # flat
        return FoundShape(np.zeros((0, 3)), np.zeros(0), np.zeros((0, 2), dtype=np.int64))
    outward = np.einsum("fi,fi->f", np.cross(hull[:, 1] - hull[:, 0], hull[:, 2] - hull[:, 0]),
                        hull.mean(axis=1) - corners.mean(axis=0))  # fmt: skip
    hull = np.where(outward[:, None, None] < 0.0, hull[:, ::-1], hull)
    coarse = simplified(hull, COARSE_FACES[-1])
    return _sharp_shape(coarse, coarse, replace(wish, sharp_deg=BLUNT_DEG))


def _sharp_shape(triangles: Floats, hiding: Floats, wish: WireframeWish) -> FoundShape:
    body = welded(triangles)
    lines = sharp_edges(body, wish.sharp_deg)
    corners, sizes = corners_of(body.points, lines)
    radius = float(np.linalg.norm(triangles.reshape(-1, 3), axis=1).max())
    large = sizes >= LEAST_CORNER_SHARE * radius
    corners, sizes = corners[large], sizes[large]
    order = np.lexsort((corners, -sizes))[:MOST_TRIED]
    corners, sizes = corners[order], sizes[order]
    seen = _seen(body.points[corners], hiding)
    corners, sizes = corners[seen], sizes[seen]
    apart_m = min(MERGED_SHARE * radius, MERGED_M)
    stands_for = _merged(body.points[corners], apart_m, wish.most_landmarks)
    number = {int(c): int(k) for c, k in zip(corners, stands_for, strict=True) if k >= 0}
    kept = np.flatnonzero(stands_for == np.arange(len(corners)))
    place = {int(old): new for new, old in enumerate(kept)}
    pairs: dict[tuple[int, int], float] = {}
    for (a, b), length in zip(lines.ends.tolist(), lines.lengths_m.tolist(), strict=True):
        if a in number and b in number and number[a] != number[b]:
            one, two = sorted((place[number[a]], place[number[b]]))
            pairs[(one, two)] = max(pairs.get((one, two), 0.0), length)
    longest = sorted(pairs.items(), key=lambda item: (-item[1], item[0]))
    edges = [ends for ends, length in longest if length >= LEAST_EDGE_SHARE * radius]
    points = np.array([body.points[corners[stands_for == k]].mean(axis=0) for k in kept])
    points = points.reshape(-1, 3)
    chosen = np.array(edges, dtype=np.int64).reshape(-1, 2)
    if len(chosen):
        chosen = chosen[_seen(points[chosen].mean(axis=1), hiding)]
    return FoundShape(points, sizes[kept], chosen[: wish.most_edges])


def found_wireframe(
    name: str,
    triangles: Floats,
    part_of_triangle: Indices,
    part_names: tuple[str, ...],
    wish: WireframeWish,
) -> Wireframe:
    """Return the wireframe of a mesh, as wished.

    Parameters
    ----------
    name : str
        Of the spacecraft.
    triangles : (f, 3, 3) array, m
        In the target frame.
    part_of_triangle : (f,) array of int
    part_names : tuple of str
    wish : WireframeWish
        Not of a file.

    Raises
    ------
    ValueError
        If fewer than four corners, or no edge, come of it.
    """
    fine = simplified(triangles, max(FINE_FACES, wish.most_triangles))
    hiding = simplified(fine, wish.most_triangles)
    typed = np.array([*wish.landmarks.values()], dtype=np.float64).reshape(-1, 3)
    names, points = list(wish.landmarks), typed
    edges = [(names.index(a), names.index(b)) for a, b in wish.edges]
    if wish.find:
        shape = find_shape(triangles, fine, hiding, wish)
        radius = float(np.linalg.norm(triangles.reshape(-1, 3), axis=1).max())
        place: dict[int, int] = {}
        near = shape.points[:, None] - typed
        for k, point in enumerate(shape.points):
            away = np.linalg.norm(near[k], axis=1)
            if len(typed) and away.min() < APART_SHARE * radius:
                place[k] = int(away.argmin())
                continue
            place[k] = len(names)
            names.append(_free(f"corner_{k + 1:02d}", names))
            points = np.concatenate([points, point[None]])
        found = ((place[a], place[b]) for a, b in shape.edges.tolist())
        edges += [pair for pair in found if pair[0] != pair[1]]
    if len(names) < LEAST_CORNERS or not edges:
        raise ValueError(
            f"expected a wireframe of at least four corners and an edge, found {len(names)} and "
            f"{len(edges)}: give a smaller wireframe.sharp_deg (now {wish.sharp_deg:g}), or "
            "wireframe.landmarks and edges of your own"
        )
    bare = Wireframe(
        name=name,
        landmark_names=tuple(names),
        points_in_target=points,
        appendage=_appendage(points, triangles, part_of_triangle, part_names),
        edges=np.unique(np.sort(np.array(edges, dtype=np.int64), axis=1), axis=0),
        triangles_in_target=hiding,
    )
    if not wish.symmetries:
        return bare
    return Wireframe(**{**vars(bare), "symmetries": symmetries_of(bare)})


def _seen(points: Floats, hiding: Floats) -> Mask:
    """Tell which points a camera sees from enough of all directions."""
    from models.spacecraft.own.all_around import poses_all_around

    if not len(points):
        return np.zeros(0, dtype=bool)
    radius = float(np.linalg.norm(hiding.reshape(-1, 3), axis=1).max())
    frame = _only_faces(hiding)
    poses: list[RigidTransform] = poses_all_around(DIRECTIONS, FAR * radius)
    count = sum(visible_points(frame, points, pose).astype(int) for pose in poses)
    return np.asarray(count >= SEEN_FROM * DIRECTIONS)


def _only_faces(hiding: Floats) -> Wireframe:
    none = np.zeros((0, 3))
    return Wireframe("", (), none, np.zeros(0, bool), np.zeros((0, 2), np.int64), hiding)


def _merged(points: Floats, apart_m: float, most: int) -> Indices:
    """Return which corner stands for each, (k,); -1 for those beyond the number wished for.

    Parameters
    ----------
    points : (k, 3) array, m
        The largest first.
    apart_m : float, m
    most : int
    """
    stands_for = np.full(len(points), -1, dtype=np.int64)
    kept: list[int] = []
    for k, point in enumerate(points):
        away = np.linalg.norm(points[kept] - point, axis=1) if kept else np.zeros(0)
        if len(away) and away.min() < apart_m:
            stands_for[k] = kept[int(away.argmin())]
        elif len(kept) < most:
            stands_for[k] = k
            kept.append(k)
    return stands_for


def _appendage(
    points: Floats, triangles: Floats, part_of_triangle: Indices, part_names: tuple[str, ...]
) -> Mask:
    """Tell which landmarks lie on parts apart; of a mesh of one part, those that lie far out."""
    _, nearest = cKDTree(triangles.reshape(-1, 3)).query(points)
    components = [part_names[part_of_triangle[k // 3]] for k in np.asarray(nearest).tolist()]
    apart = is_appendage(points, components)
    if apart.any() and not apart.all():
        return apart
    distance = np.linalg.norm(points, axis=1)
    return np.asarray(distance > distance.mean())


def _free(name: str, taken: list[str]) -> str:
    while name in taken:
        name += "_"
    return name

"""Which points the Sun reaches, against every ray tried with every triangle."""

import numpy as np
import trimesh

from bench.export.sunlight import CLEAR_M, sunlit

DIRECTIONS = 12
POINTS = 60


def meets(starts: np.ndarray, way: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Tell which rays meet a triangle (Moeller and Trumbore 1997, equation 6)."""
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    across = np.cross(way, second)
    scale = (first * across).sum(axis=1)
    scale = np.where(np.abs(scale) < 1e-14, np.nan, scale)
    apart = starts[:, None] - triangles[None, :, 0]
    u = (apart * across).sum(axis=2) / scale
    over = np.cross(apart, first)
    v, length = (over @ way) / scale, (over * second).sum(axis=2) / scale
    return ((u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (length > 0.0)).any(axis=1)


def test_as_rays_towards_the_sun_have_it():
    """Boxes and balls at random; the points lie between them, on none of them."""
    rng = np.random.default_rng(4)
    pieces = [
        (trimesh.creation.box if number % 2 else trimesh.creation.icosphere)().apply_transform(
            trimesh.transformations.scale_and_translate(0.4, rng.uniform(-2.0, 2.0, 3))
        )
        for number in range(14)
    ]
    mesh = trimesh.util.concatenate(pieces)
    points = rng.uniform(-2.0, 2.0, (POINTS, 3))
    some_lit = some_dark = False
    for way in rng.normal(size=(DIRECTIONS, 3)):
        sun = way / np.linalg.norm(way)
        starts = points + CLEAR_M * sun
        theirs = ~meets(starts, sun, mesh.triangles)
        ours = sunlit(points, mesh.vertices, mesh.faces, sun)
        np.testing.assert_array_equal(ours, theirs)
        some_lit, some_dark = some_lit or ours.any(), some_dark or not ours.all()
    assert some_lit
    assert some_dark

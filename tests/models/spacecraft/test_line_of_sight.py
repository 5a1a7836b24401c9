"""Whether a spacecraft hides the Sun: against a sphere's closed form and signed volumes."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from models.spacecraft.line_of_sight import is_hidden
from models.spacecraft.part import Part, Spacecraft

DISTANCE_M = 10.0


def craft(mesh: trimesh.Trimesh) -> Spacecraft:
    return Spacecraft("ball", (Part("ball", mesh, "mli"),), None, np.zeros(3))


@pytest.mark.parametrize("off_axis_deg", [0.0, 5.0, 5.6, 5.9, 8.0, 90.0, 180.0])
def test_a_ball_hides_what_is_within_its_angular_radius(off_axis_deg: float) -> None:
    """A ball of 1 m at 10 m: asin(0.1) is 5.74 deg; 5 subdivisions stay within 0.05 deg of it."""
    ball = craft(trimesh.creation.icosphere(subdivisions=5, radius=1.0))
    angle = np.deg2rad(off_axis_deg)
    towards = np.array([np.sin(angle), 0.0, -np.cos(angle)])
    assert is_hidden(ball, np.array([0.0, 0.0, DISTANCE_M]), towards) == (off_axis_deg < 5.74)


def test_what_lies_behind_hides_nothing() -> None:
    ball = craft(trimesh.creation.icosphere(subdivisions=2, radius=1.0))
    assert not is_hidden(ball, np.array([0.0, 0.0, DISTANCE_M]), np.array([0.0, 0.0, 1.0]))
    assert is_hidden(ball, np.zeros(3), np.array([0.0, 0.6, 0.8]))  # from within


def test_it_is_what_signed_volumes_say() -> None:
    """A ray meets a triangle if it passes all its edges on the same side (Plücker coordinates).

    Rays from beside a ring with a plate in it, into all directions.
    """
    ring = trimesh.creation.torus(major_radius=1.0, minor_radius=0.2)
    plate = trimesh.creation.box(extents=(0.5, 0.8, 0.02))
    parts = tuple(Part(name, mesh, "mli") for name, mesh in (("ring", ring), ("plate", plate)))
    lens = np.array([0.4, -0.3, 0.9])
    triangles = np.concatenate([part.mesh.triangles for part in parts]) - lens
    a, b, c = triangles.transpose(1, 0, 2)
    moments = [np.cross(*edge) for edge in ((a, b), (b, c), (c, a))]

    def meets(way: np.ndarray) -> bool:
        sides = np.array([moment @ way for moment in moments])
        ahead = np.einsum("ij,ij->i", a, np.cross(b - a, c - a)) * sides.sum(axis=0) > 0.0
        return bool((ahead & ((sides >= 0.0).all(axis=0) | (sides <= 0.0).all(axis=0))).any())

    towards = np.random.default_rng(3).standard_normal((400, 3))
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    craft = Spacecraft("ring and plate", parts, None, np.zeros(3))
    ours = [is_hidden(craft, lens, way) for way in towards]
    assert ours == [meets(way) for way in towards]
    assert 40 < sum(ours) < 360

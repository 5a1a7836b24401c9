"""The chaser lies behind its own camera and lamps, and is as wide as the shadow it must cast."""

from __future__ import annotations

import numpy as np

from models.lights.led_beam import LAMPS_800, LAMPS_850
from models.materials import MATERIALS
from models.spacecraft.chaser import FRONT_Z_M, chaser

SHEETS = {"mli_gold", "solar_cell"}


def test_nothing_reaches_the_plane_of_the_lens_and_lamps() -> None:
    assert chaser().bounds[1, 2] <= FRONT_Z_M < 0.0
    lamps = np.concatenate([LAMPS_800.points_in_cam, LAMPS_850.points_in_cam])
    assert (lamps[:, 2] > chaser().bounds[1, 2]).all()


def test_body_is_1_2_m_wide_and_1_5_m_long() -> None:
    body = np.concatenate(
        [
            np.asarray(p.mesh.vertices)
            for p in chaser().parts
            if p.name in ("chaser_body", "chaser_blanket")
        ]
    )
    size = body.max(axis=0) - body.min(axis=0)
    assert np.allclose(size, [1.2, 1.2, 1.5], atol=0.03)
    assert np.allclose(0.5 * (body.max(axis=0) + body.min(axis=0))[:2], 0.0, atol=0.01)


def test_centre_of_mass_lies_behind_the_camera_as_in_the_paper() -> None:
    assert chaser().centre_of_mass.tolist() == [0.0, 0.0, -1.5]
    assert chaser().markers is None


def test_bodies_are_closed_and_face_outward() -> None:
    for part in chaser().parts:
        assert part.material in MATERIALS
        if part.material in SHEETS:
            continue
        whole = part.mesh.copy()
        whole.merge_vertices(digits_vertex=8)
        for body in whole.split(only_watertight=False):
            assert body.is_watertight, part.name
            assert body.volume > 0.0, part.name


def test_front_faces_forward() -> None:
    (foil,) = [part.mesh for part in chaser().parts if part.name == "chaser_blanket"]
    ahead = np.abs(foil.triangles_center[:, :2]).max(axis=1) < 0.57
    assert (foil.face_normals[ahead, 2] > 0.0).all()
    outward = foil.triangles_center * [1.0, 1.0, 0.0]
    sides = foil.triangles_center[:, 2] < -0.1
    assert ((foil.face_normals * outward).sum(axis=1)[sides] > 0.0).all()

"""Finishes of a wireframe's triangles are those of what is met first from outside."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.errors import DatasetError
from models.materials import MATERIALS
from models.spacecraft.finishes import face_shares, finish_of
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.solids import box
from models.wireframe.wireframe import Wireframe
from models.wireframe.wireframe_file import read_wireframe, wireframe_to_json

HALF_M = 1.0


def sheet() -> Wireframe:
    """Return a square in z = 0 whose triangles' normals point along +z."""
    corners = HALF_M * np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    return Wireframe(
        "sheet",
        ("a", "b", "c", "d"),
        corners,
        np.zeros(4, dtype=bool),
        np.array([[0, 1], [1, 2], [2, 3], [3, 0]]),
        corners[np.array([[0, 1, 2], [0, 2, 3]])],
    )


def craft(*layers: tuple[float, str]) -> Spacecraft:
    """Return slabs of a centimetre at heights z, by material."""
    size = (2.0 * HALF_M, 2.0 * HALF_M, 0.01)
    parts = tuple(
        Part(f"layer_{k}", box(size, (0.0, 0.0, z)), material)
        for k, (z, material) in enumerate(layers)
    )
    return Spacecraft("layers", parts, None, np.zeros(3))


def finished(wireframe: Wireframe, spacecraft: Spacecraft) -> Wireframe:
    return replace(wireframe, finish=finish_of(face_shares(wireframe, spacecraft), spacecraft))


def test_each_side_is_of_what_is_outermost_there() -> None:
    """Paint over foil over paint: from above and from below the film between is never met."""
    made = craft((0.05, "white_paint"), (0.0, "mli_gold"), (-0.05, "black_paint"))
    finish = finished(sheet(), made).finish
    assert finish is not None
    for side, name in enumerate(("white_paint", "black_paint")):
        material = MATERIALS[name]
        assert finish.diffuse[:, side] == pytest.approx(material.diffuse.sunlight)
        assert finish.mirror[:, side] == pytest.approx(material.specular.sunlight)
        assert finish.roughness[:, side] == pytest.approx(material.roughness)


def test_a_face_half_of_one_and_half_of_another_has_their_mean() -> None:
    half = (HALF_M, 2.0 * HALF_M, 0.01)
    parts = tuple(
        Part(name, box(half, (0.5 * sign * HALF_M, 0.0, 0.0)), name)
        for sign, name in ((1.0, "white_paint"), (-1.0, "black_paint"))
    )
    finish = finished(sheet(), Spacecraft("halves", parts, None, np.zeros(3))).finish
    assert finish is not None
    mean = np.mean([MATERIALS[name].diffuse.sunlight for name in ("white_paint", "black_paint")])
    # The two triangles together are half and half; places on each are spread, not weighed.
    assert finish.diffuse[:, 0].mean() == pytest.approx(mean, abs=0.05)


def test_creases_and_slopes_widen_the_lobe() -> None:
    foil = finished(sheet(), craft((0.0, "mli_gold"))).finish
    assert foil is not None
    material = MATERIALS["mli_gold"]
    expected = np.hypot(material.roughness, np.sqrt(2.0) * material.detail.crease_slope)
    assert foil.roughness == pytest.approx(np.full((2, 2), expected))


def test_a_wrong_reflectance_is_told_and_stays_below_one() -> None:
    made = craft((0.0, "white_paint"))
    met = face_shares(sheet(), made)
    dim = finish_of(met, made, {"white_paint": 0.5})
    assert dim.diffuse == pytest.approx(np.full((2, 2), 0.5 * 0.858))
    bright = finish_of(met, made, {"white_paint": 2.0})
    assert (bright.diffuse + bright.mirror < 1.0).all()


def test_finishes_come_back_from_their_file_and_too_few_are_refused(tmp_path: Path) -> None:
    known = finished(sheet(), craft((0.0, "mli_gold")))
    path = tmp_path / "wireframe.json"
    path.write_text(wireframe_to_json(known))
    back = read_wireframe(path).finish
    assert back is not None
    assert known.finish is not None
    assert back.table.tobytes() == known.finish.table.tobytes()
    path.write_text(wireframe_to_json(sheet()))
    assert read_wireframe(path).finish is None
    fewer = replace(known, triangles_in_target=known.triangles_in_target[:1], finish=None)
    text = wireframe_to_json(fewer)[:-3] + ', "finishes": ' + str(known.finish.table.tolist()) + "}"
    path.write_text(text)
    with pytest.raises(DatasetError, match="a finish for each of 1"):
        read_wireframe(path)

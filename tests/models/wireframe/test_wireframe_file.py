"""A wireframe goes to a file and back to the last bit; what is none is refused by name."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.errors import DatasetError
from models.wireframe.wireframe import Wireframe
from models.wireframe.wireframe_file import read_wireframe, wireframe_to_json

HALF_TURN = np.diag([-1.0, -1.0, 1.0])
WIREFRAME = Wireframe(
    name="plate",
    landmark_names=("one", "two", "three"),
    points_in_target=np.array([[1 / 3, 0.0, 1e-17], [0.0, 2.0, 0.0], [-5.5, 0.0, np.pi]]),
    appendage=np.array([True, False, True]),
    edges=np.array([[0, 1], [2, 1]]),
    triangles_in_target=np.arange(18.0).reshape(2, 3, 3) / 7.0,
    symmetries=(HALF_TURN,),
)
PLAIN = Wireframe(
    "point", ("only",), np.zeros((1, 3)), np.array([False]), np.empty((0, 2), int),
    np.empty((0, 3, 3)),
)  # fmt: skip


@pytest.mark.parametrize("wireframe", [WIREFRAME, PLAIN], ids=["plate", "point"])
def test_a_wireframe_comes_back_to_the_last_bit(wireframe: Wireframe, tmp_path: Path) -> None:
    path = tmp_path / "wireframe.json"
    path.write_text(wireframe_to_json(wireframe))
    back = read_wireframe(path)
    assert (back.name, back.landmark_names) == (wireframe.name, wireframe.landmark_names)
    for name in ("points_in_target", "appendage", "edges", "triangles_in_target"):
        np.testing.assert_array_equal(getattr(back, name), getattr(wireframe, name))
        assert getattr(back, name).dtype == getattr(wireframe, name).dtype
    np.testing.assert_array_equal(back.symmetries, wireframe.symmetries)
    assert wireframe_to_json(back) == wireframe_to_json(wireframe)


def spoilt(spoil: str) -> Any:
    table = json.loads(wireframe_to_json(WIREFRAME))
    if spoil == "an edge to nowhere":
        table["edges"][0][1] = "four"
    elif spoil == "a flat point":
        table["landmarks"][1]["point_in_target_m"] = [1.0, 2.0]
    elif spoil == "a symmetry that stretches":
        table["symmetries"] = [[[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]]
    elif spoil == "no symmetries":
        del table["symmetries"]
    elif spoil == "a symmetry that mirrors":
        table["symmetries"] = [[[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]]
    elif spoil == "a flag as text":
        table["landmarks"][1]["appendage"] = "false"
    elif spoil == "a name as a number":
        table["landmarks"][1]["name"] = 2
    elif spoil == "an edge of three":
        table["edges"][0].append(table["edges"][0][0])
    elif spoil == "an edge of lists":
        table["edges"][0] = [[1], [2]]
    elif spoil == "a key more":
        table["colour"] = "red"
    elif spoil == "a triangle beyond all":
        table["triangles_in_target_m"] = [[[1e300, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]]
    elif spoil == "no table":
        table = [1, 2]
    return table


@pytest.mark.parametrize(
    "spoil",
    [
        "an edge to nowhere",
        "a flat point",
        "a symmetry that stretches",
        "a symmetry that mirrors",
        "a flag as text",
        "a name as a number",
        "an edge of three",
        "an edge of lists",
        "a key more",
        "a triangle beyond all",
        "no symmetries",
        "no table",
    ],
)
def test_what_is_no_wireframe_is_refused_by_its_path(spoil: str, tmp_path: Path) -> None:
    path = tmp_path / "wireframe.json"
    path.write_text(json.dumps(spoilt(spoil)))
    with pytest.raises(DatasetError, match=r"expected a wireframe at .*wireframe\.json"):
        read_wireframe(path)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"plate"', '"pl\\u001bate"'),
        ("2.0", "1e999"),
        ("2.0", "NaN"),
        ("2.0", '"2.0"'),
        ("2.0", "1e12"),
        ("true", "1"),
        ("true", '"true"'),
        ('"two"', "2"),
        ('"name": "plate"', '"name": "plate", "name": "plate"'),
        ('"edges": [', '"edges": [' + 5000 * "["),
    ],
    ids=lambda text: text[:20],
)
def test_a_value_that_cannot_be_is_refused(old: str, new: str, tmp_path: Path) -> None:
    path = tmp_path / "wireframe.json"
    text = wireframe_to_json(WIREFRAME)
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(DatasetError, match=r"expected a wireframe at .*wireframe\.json"):
        read_wireframe(path)


def test_a_wireframe_may_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "wireframe.json"
    path.write_text("\ufeff" + wireframe_to_json(WIREFRAME))
    assert read_wireframe(path).name == "plate"


def test_an_absent_or_cut_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="No such file"):
        read_wireframe(tmp_path / "none.json")
    os.mkfifo(tmp_path / "pipe.json")  # whose reader would wait for ever
    with pytest.raises(DatasetError, match=r"expected a wireframe at .*a pipe"):
        read_wireframe(tmp_path / "pipe.json")
    (tmp_path / "cut.json").write_text(wireframe_to_json(WIREFRAME)[:100])
    with pytest.raises(DatasetError, match="expected a wireframe at"):
        read_wireframe(tmp_path / "cut.json")

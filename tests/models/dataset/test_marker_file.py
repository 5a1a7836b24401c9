from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.arrays import Floats
from models.dataset.marker_file import markers_to_toml, read_markers
from models.errors import DatasetError
from models.markers import MarkerPattern
from models.spacecraft.grasp_markers import GRASP_MARKERS
from models.spacecraft.retroreflector_layout import RETROREFLECTORS


def test_markers_come_back(tmp_path: Path) -> None:
    path = tmp_path / "markers.toml"
    path.write_text(markers_to_toml(RETROREFLECTORS))
    back = read_markers(path)
    assert (back.names, back.radius_m) == (RETROREFLECTORS.names, RETROREFLECTORS.radius_m)
    np.testing.assert_array_equal(back.points_in_target, RETROREFLECTORS.points_in_target)
    np.testing.assert_array_equal(back.normals_in_target, RETROREFLECTORS.normals_in_target)
    assert markers_to_toml(back) == path.read_text()


def test_white_dots_come_back_as_dots(tmp_path: Path) -> None:
    path = tmp_path / "markers.toml"
    path.write_text(markers_to_toml(GRASP_MARKERS))
    assert read_markers(path).paint == GRASP_MARKERS.paint
    path.write_text(path.read_text().replace('kind = "white_dot"', 'kind = "retroreflector"', 1))
    with pytest.raises(DatasetError, match="expected marker of one kind"):
        read_markers(path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("radius_m = 0.0127\n", "", "missing: radius_m"),
        ("radius_m = 0.0127", "radius_m = -0.0127", "radius_m above 0"),
        ("radius_m = 0.0127", "radius_m = 1e300", "radius_m above 0 and at most 10"),
        ("[[marker]]", "[[markers]]", "missing: marker"),
        ('name = "2"', 'name = "1"', "each marker's name once"),
        ('name = "2"', 'nom = "2"', r"in marker\.1; unknown: nom; missing: name"),
        ('name = "2"', "name = 2", r"marker\.1\.name to be text, got 2"),
        ('name = "2"', 'name = "\\u001b"', r"marker\.1\.name to be printable text"),
        ("    1.1,\n", "", r"marker\.\d\.point_in_target_m as lists of 3 numbers"),
        ("    1.1,\n", "    nan,\n", r"point_in_target_m as numbers of at least .*, got nan"),
        ("    1.1,\n", '    "1.1",\n', r"point_in_target_m as numbers of at least .*, got '1\.1'"),
    ],
)
def test_markers_that_cannot_be_are_refused(tmp_path: Path, old: str, new: str, said: str) -> None:
    text = markers_to_toml(RETROREFLECTORS)
    assert old in text
    path = tmp_path / "markers.toml"
    path.write_text(text.replace(old, new))
    with pytest.raises(DatasetError, match=rf"markers\.toml: expected .*{said}"):
        read_markers(path)


LINE = np.outer(np.linspace(-1.0, 2.0, 4), [0.3, -0.2, 0.9]) + np.array([1.0, 2.0, 0.5])


def pattern(points: Floats) -> MarkerPattern:
    names = tuple(str(number) for number in range(len(points)))
    return MarkerPattern(names, points, np.tile([0.0, 0.0, 1.0], (len(points), 1)), 0.0127)


@pytest.mark.parametrize(
    ("markers", "said"),
    [
        (pattern(LINE[:2]), "at least 3, apart and not on one line; got 2"),
        (pattern(np.ones((4, 3))), "two are 0 m apart, less than their radius"),
        (pattern(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0.01]])), "two are 0.01 m apar"),
        (pattern(LINE), "all lie within .* m of one line"),
        (pattern(LINE + 1e-3 * np.eye(4, 3)), "all lie within .* m of one line"),
        (
            replace(RETROREFLECTORS, points_in_target=RETROREFLECTORS.points_in_target * 0.0),
            "two are 0 m apart",
        ),
    ],
)
def test_markers_from_which_no_pose_follows_are_refused(
    tmp_path: Path, markers: MarkerPattern, said: str
) -> None:
    path = tmp_path / "markers.toml"
    path.write_text(markers_to_toml(markers))
    with pytest.raises(
        DatasetError, match=rf"markers\.toml: expected markers from which a pose .*{said}"
    ):
        read_markers(path)


@pytest.mark.parametrize("turn", range(3))
def test_three_markers_apart_will_do(tmp_path: Path, turn: int) -> None:
    """The hint may not refuse the least that serves: a corner of 10 cm, whichever way it lies."""
    points = np.roll(0.1 * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), turn, 1)
    path = tmp_path / "markers.toml"
    path.write_text(markers_to_toml(pattern(points)))
    assert len(read_markers(path)) == 3


def test_cubes_come_back_as_they_were_told(tmp_path: Path) -> None:
    path = tmp_path / "markers.toml"
    for edges in (True, False):
        cubes = RETROREFLECTORS.cubes
        assert cubes is not None
        told = replace(cubes, edges_in_target=cubes.edges_in_target if edges else None)
        path.write_text(markers_to_toml(replace(RETROREFLECTORS, cubes=told)))
        back = read_markers(path).cubes
        assert back is not None
        assert (back.refractive_index, back.edge_share) == (1.4525, 0.012)
        assert (back.edges_in_target is not None) == edges
        if back.edges_in_target is not None:
            np.testing.assert_array_equal(back.edges_in_target, cubes.edges_in_target)


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("edge_in_target = [\n    1.0,", "edge_in_target = [\n    0.5,", "length one"),
        ("edge_share = 0.012", "edge_share = 0.7", "edge_share"),
        ("refractive_index = 1.4525", "refractive_index = 0.9", "refractive_index"),
        ("edge_in_target = [\n    1.0,\n    0.0,\n    0.0,\n]\n", "", "every marker or none"),
        ("[cubes]\nrefractive_index = 1.4525\nedge_share = 0.012\n", "", "cubes"),
    ],
)
def test_cubes_that_cannot_be_are_refused(
    tmp_path: Path, before: str, after: str, message: str
) -> None:
    text = markers_to_toml(RETROREFLECTORS)
    assert before in text
    path = tmp_path / "markers.toml"
    path.write_text(text.replace(before, after, 1))
    with pytest.raises(DatasetError, match=message):
        read_markers(path)

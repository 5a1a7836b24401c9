"""``rvbench inspect``: what it says of good and broken meshes, what it writes, what it refuses."""

from __future__ import annotations

import re
import tomllib
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import trimesh

from bench.cli import main
from bench.inspecting.inspection import inspect_file, start_name
from bench.inspecting.start_text import start_text, target_text
from models.errors import DatasetError
from models.spacecraft.own.build import read_own_target
from models.spacecraft.own.description import description_of
from models.spacecraft.own.faults import guessed_unit
from models.spacecraft.own.mesh_file import read_mesh_file
from tests.support.half_written import left_half_written
from tests.support.own_meshes import (
    broken_ply,
    gltf_tree,
    millimetre_stl,
    textured_glb,
    toml_of,
    write_gltf,
)


def said(path: Path) -> list[tuple[str, str]]:
    return [(fault.kind, fault.what) for fault in inspect_file(path, path.parent).faults]


def test_a_good_mesh_has_no_faults(tmp_path: Path) -> None:
    assert said(textured_glb(tmp_path / "boxsat.glb")) == []


def test_an_stl_has_no_unit_and_a_guess(tmp_path: Path) -> None:
    found = inspect_file(millimetre_stl(tmp_path / "a.stl"), tmp_path)
    assert found.unit_is_guessed
    assert found.target.description.unit_m == 0.001
    assert [fault.kind for fault in found.faults] == ["mend"]
    assert "no unit" in found.faults[0].what


def test_what_is_broken_is_counted(tmp_path: Path) -> None:
    found = inspect_file(broken_ply(tmp_path / "a.ply"), tmp_path)
    surface = found.surface
    assert (surface.bodies, surface.open_bodies, surface.rims) == (3, 1, 3)
    assert (surface.twice, surface.degenerate, surface.inside_out) == (1, 1, 1)
    words = " ".join(fault.what for fault in found.faults)
    for word in ("open", "inverted", "duplicate", "degenerate", "no unit"):
        assert word in words


def test_a_missing_texture_and_an_absurd_size_are_told(tmp_path: Path) -> None:
    tree = gltf_tree(images=[{"uri": "gone.png"}], scenes=[{"nodes": [0]}])
    tree["nodes"] = [{"mesh": 0, "scale": [500.0, 500.0, 500.0]}]
    words = said(write_gltf(tmp_path / "a.gltf", tree))
    assert ("mend", "missing: gone.png, which the mesh names") in words
    assert any(kind == "mend" and "absurd size" in what for kind, what in words)


def test_a_centre_of_mass_outside_is_told(tmp_path: Path) -> None:
    toml = toml_of(textured_glb(tmp_path / "a.glb"), "centre_of_mass_in_mesh_m = [2.5, 0.3, -0.6]")
    assert any("centre of mass outside" in what for _, what in said(toml))
    inside = toml_of(tmp_path / "a.glb", "centre_of_mass_in_mesh_m = [0.1, 0.0, 0.1]")
    assert said(inside) == []


def test_it_writes_a_toml_that_can_be_used_and_a_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mesh = textured_glb(tmp_path / "boxsat.glb")
    names = ("boxsat.toml", "boxsat.inspect.png")
    half = [left_half_written(tmp_path / name) for name in names]
    assert main(["inspect", str(mesh)]) == 0
    assert not any(each.exists() for each in half)
    out = capsys.readouterr().out
    assert "bus" in out
    assert "linear red" in out
    built = read_own_target(tmp_path / "boxsat.toml")
    assert built.spacecraft.name == "boxsat"
    picture = cv2.imread(str(tmp_path / "boxsat.inspect.png"))
    assert picture is not None
    assert picture.shape[0] > 800
    red = (picture[..., 2] > 180) & (picture[..., 1] < 80)
    assert red.sum() > 500  # its wireframe
    assert main(["inspect", str(mesh)]) == 2  # the TOML is there
    assert "nothing was changed" in capsys.readouterr().err
    assert main(["inspect", str(tmp_path / "boxsat.toml")]) == 0


def test_another_folder_names_the_mesh_from_there(tmp_path: Path) -> None:
    mesh = millimetre_stl(tmp_path / "meshes.stl")
    out = tmp_path / "mine"
    found = inspect_file(mesh, out)
    assert found.target.description.mesh == "../meshes.stl"


def test_what_is_no_mesh_is_one_message(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.step").write_text("ISO-10303-21;")
    assert main(["inspect", str(tmp_path / "a.step")]) == 2
    said = capsys.readouterr().err.strip()
    assert said.startswith("rvbench: expected a mesh file")
    assert len(said.splitlines()) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["a.step"]


def test_a_preset_s_name_is_not_taken() -> None:
    assert start_name(Path("xmm.glb")) == "own-xmm"
    assert start_name(Path("my probe (1).glb")) == "my-probe-1"


@pytest.mark.parametrize("uncommented", [False, True])
def test_a_new_target_reads_with_and_without_its_comments(uncommented: bool) -> None:
    text = target_text("probe")
    lines = text.splitlines()
    if uncommented:
        lines = [
            line[1:] if line[:1] == "#" and line[1:2] not in ("", " ") else line for line in lines
        ]
    described = description_of(tuple(lines), "probe.toml", Path())
    assert described.mesh == "probe.glb"
    if uncommented:
        assert set(tomllib.loads("\n".join(lines))) >= {"axes", "parts", "materials", "wireframe"}
        assert described.part_materials["bus"] == "mli_gold"
        np.testing.assert_array_equal(described.rotation, np.eye(3))


@pytest.mark.parametrize(("scale", "unit"), [(1.0, "m"), (1e3, "mm"), (100.0, "mm"), (0.02, "m")])
def test_a_unit_is_guessed_from_the_size(tmp_path: Path, scale: float, unit: str) -> None:
    mesh = millimetre_stl(tmp_path / "a.stl")
    whole = trimesh.load(mesh)
    whole.apply_scale(1e-3 * scale)
    whole.export(mesh)
    assert guessed_unit(read_mesh_file(mesh)) == unit


def test_what_rounding_leaves_of_a_zero_is_written_as_zero(tmp_path: Path) -> None:
    """A box has no products of inertia; of its triangles some 1e-15 of them are left."""
    trimesh.creation.box((2.0, 1.1, 0.7)).export(tmp_path / "plate.glb")
    found = inspect_file(tmp_path / "plate.glb", tmp_path)
    products = found.placed.inertia_kg_m2[~np.eye(3, dtype=bool)]
    placed = replace(found.placed, inertia_kg_m2=found.placed.inertia_kg_m2 + 1e-14)
    text = start_text(found.target.description, found.mesh, placed, "plate.toml", False)
    assert np.abs(products).max() < 1e-9
    assert "inertia_kg_m2 = [[" in text
    assert not re.search(r"\de-", text)


def test_a_missing_target_is_told_with_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"expected the TOML of a spacecraft.*rvbench inspect"):
        read_own_target(tmp_path / "nosat.toml")

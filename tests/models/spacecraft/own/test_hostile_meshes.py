"""Mesh files that lie, lead astray or would fill the memory: refused for little work, in a line."""

import io
import os
import struct

import numpy as np
import pytest
from PIL import Image

from models.errors import DatasetError
from models.reading.meshes import bounds
from models.spacecraft.own.mesh_file import read_mesh_file
from tests.support.own_meshes import TRIANGLE, glb_bytes, gltf_tree, textured_glb, write_gltf
from tests.support.work_done import little_work


def refused(path) -> str:
    with little_work(), pytest.raises(DatasetError) as caught:
        read_mesh_file(path)
    said = str(caught.value)
    assert path.name in said
    assert "\n" not in said
    return said


def tree_with(key, value):
    return gltf_tree(**{key: value})


OUTSIDE = ["../secret.bin", "/etc/passwd", "..\\secret.bin", "%2e%2e/secret.bin", "file:///etc/passwd",
           "http://example.org/x.bin", "~/x.bin", "a/../../secret.bin", "C:/x.bin"]  # fmt: skip


@pytest.mark.parametrize("name", OUTSIDE)
def test_a_buffer_out_of_the_folder_is_refused(tmp_path, name):
    folder = tmp_path / "craft"
    folder.mkdir()
    (tmp_path / "secret.bin").write_bytes(TRIANGLE)
    tree = tree_with("buffers", [{"byteLength": 36, "uri": name}])
    assert "own folder" in refused(write_gltf(folder / "a.gltf", tree))


@pytest.mark.parametrize("name", OUTSIDE)
def test_a_texture_out_of_the_folder_is_refused(tmp_path, name):
    folder = tmp_path / "craft"
    folder.mkdir()
    tree = tree_with("images", [{"uri": name}])
    assert "own folder" in refused(write_gltf(folder / "a.gltf", tree))


def test_a_link_out_of_the_folder_is_refused(tmp_path):
    folder = tmp_path / "craft"
    folder.mkdir()
    (tmp_path / "secret.bin").write_bytes(TRIANGLE)
    path = write_gltf(folder / "a.gltf", gltf_tree())
    (folder / "data.bin").unlink()
    (folder / "data.bin").symlink_to(tmp_path / "secret.bin")
    assert "own folder" in refused(path)


@pytest.mark.parametrize("where", ["mtllib ../secret.mtl", "mtllib /etc/passwd"])
def test_a_material_file_out_of_the_folder_is_refused(tmp_path, where):
    path = tmp_path / "a.obj"
    path.write_text(f"{where}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n")
    assert "own folder" in refused(path)


def test_an_objs_texture_out_of_the_folder_is_refused(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n")
    (tmp_path / "a.mtl").write_text("newmtl a\nKd 1 1 1\nmap_Kd ../../secret.png\n")
    assert "own folder" in refused(path)


def test_a_billion_claimed_vertices_are_refused(tmp_path):
    accessor = {"bufferView": 0, "componentType": 5126, "count": 1_000_000_000, "type": "VEC3"}
    tree = gltf_tree(accessors=[accessor], buffers=[{"byteLength": 36}])
    path = tmp_path / "a.glb"
    path.write_bytes(glb_bytes(tree))
    assert "accessors.0.count" in refused(path)
    del accessor["bufferView"]
    accessor["count"] = 1_000_000
    path.write_bytes(glb_bytes(gltf_tree(accessors=[accessor], buffers=[{"byteLength": 36}])))
    assert "where its data are" in refused(path)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}]},
         "count"),
        ({"accessors": [{"bufferView": 9, "componentType": 5126, "count": 3, "type": "VEC3"}]},
         "bufferView"),
        ({"accessors": [{"bufferView": 0, "componentType": 1, "count": 3, "type": "VEC3"}]},
         "componentType"),
        ({"accessors": [{"bufferView": 0, "componentType": 5126, "count": -3, "type": "VEC3"}]},
         "count"),
        ({"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "SCALAR"}]},
         "POSITION"),
        ({"bufferViews": [{"buffer": 0, "byteLength": 36, "byteOffset": 30}]}, "byteLength"),
        ({"bufferViews": [{"buffer": 3, "byteLength": 36}]}, "buffer"),
        ({"buffers": [{"byteLength": 10**12, "uri": "data.bin"}]}, "byteLength"),
        ({"buffers": [{"byteLength": 36, "uri": "gone.bin"}]}, "gone.bin"),
        ({"meshes": [{"primitives": [{"attributes": {"POSITION": 7}}]}]}, "POSITION"),
        ({"nodes": [{"mesh": 0, "children": [1]}, {"children": [2]}, {"children": [1]}]}, "nodes"),
        ({"nodes": [{"mesh": 0}, {"children": [2]}, {"children": [1]}]}, "nodes"),
        ({"nodes": [{"mesh": 5}]}, "mesh"),
        ({"extensionsRequired": ["KHR_draco_mesh_compression"]}, "compression"),
        ({"asset": {"version": "1.0"}}, "version 2"),
    ],
)  # fmt: skip
def test_what_is_claimed_must_be_there(tmp_path, changes, said):
    assert said in refused(write_gltf(tmp_path / "a.gltf", gltf_tree(**changes)))


def test_a_million_copies_of_a_mesh_are_refused(tmp_path):
    nodes = [{"mesh": 0} for _ in range(19_000)]
    accessor = {"bufferView": 0, "componentType": 5126, "count": 3000, "type": "VEC3"}
    tree = gltf_tree(
        nodes=nodes,
        scenes=[{"nodes": [*range(19_000)]}],
        accessors=[accessor],
        bufferViews=[{"buffer": 0, "byteLength": 36_000}],
        buffers=[{"byteLength": 36_000, "uri": "data.bin"}],
    )
    assert "copies" in refused(write_gltf(tmp_path / "a.gltf", tree, bytes(36_000)))


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e30])
def test_vertices_that_are_no_numbers_are_refused(tmp_path, value):
    corners = np.array([[0, 0, 0], [1, value, 0], [0, 1, 0]], dtype="<f4")
    path = write_gltf(tmp_path / "a.gltf", gltf_tree(), corners.tobytes())
    assert "finite" in refused(path)
    stl = tmp_path / "a.stl"
    stl.write_bytes(bytes(80) + struct.pack("<I", 1) + bytes(12) + corners.tobytes() + bytes(2))
    assert "finite" in refused(stl)


@pytest.mark.parametrize(
    "text", ["[" * 100_000, '{"a":' * 5000 + "1" + "}" * 5000, "{}", "[]", "1"]
)
def test_json_bombs_are_refused(tmp_path, text):
    path = tmp_path / "a.gltf"
    path.write_text(text)
    refused(path)


def test_a_glb_must_be_as_long_as_it_says(tmp_path):
    path = tmp_path / "a.glb"
    whole = glb_bytes(gltf_tree(buffers=[{"byteLength": 36}]))
    for data in (whole[:-4], whole + b"more", b"", b"glTF", whole[:12] + b"\xff" * 8 + whole[20:]):
        path.write_bytes(data)
        refused(path)


def test_a_file_of_a_terabyte_is_not_read(tmp_path):
    path = tmp_path / "a.stl"
    with path.open("wb") as file:
        file.truncate(10**12)
    assert "MB" in refused(path)


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.stl", bytes(80) + struct.pack("<I", 4_000_000_000) + bytes(50)),
        ("a.stl", b"solid nothing\nendsolid\n"),
        ("a.stl", b""),
        ("a.obj", b"v 0 0 0\n"),
        ("a.obj", b"\0" * 100 + b"\nv 0 0 0\nf 1 1 1\n"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999\n"),
        ("a.obj", b"v x y z\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 1000000000\nproperty float x\n"
                  b"element face 1\nproperty list uchar int i\nend_header\n1\n"),
        ("a.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 999999999999999999999\n"
                  b"property float x\nend_header\n"),
        ("a.ply", b"ply\n" + b"comment x\n" * 10_000),
        ("a.ply", b"not a ply"),
        ("a.step", b"ISO-10303-21;"),
        ("a.pkl", b"cos\nsystem\n(S'touch /tmp/x'\ntR."),
    ],
)  # fmt: skip
def test_other_formats_must_hold_what_they_claim(tmp_path, name, data):
    path = tmp_path / name
    path.write_bytes(data)
    refused(path)


def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "a.stl")
    assert "pipe" in refused(tmp_path / "a.stl")


def test_a_decompression_bomb_of_a_texture_is_not_decoded(tmp_path, monkeypatch):
    path = textured_glb(tmp_path / "a.glb")
    monkeypatch.setattr("models.spacecraft.own.mesh_file.MOST_IMAGE_SIDE_PX", 4)
    assert "px a side" in refused(path)
    assert bounds.MOST_IMAGES_PX <= 200_000_000


def test_a_texture_that_is_cut_off_is_one_message(tmp_path):
    out = io.BytesIO()
    noise = np.random.default_rng(1).integers(0, 255, (64, 64, 3), dtype=np.uint8)
    Image.fromarray(noise).save(out, "PNG")
    (tmp_path / "a.png").write_bytes(out.getvalue()[:2000])
    (tmp_path / "a.mtl").write_text("newmtl a\nKd 1 1 1\nmap_Kd a.png\n")
    path = tmp_path / "a.obj"
    path.write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n")
    assert "Pillow" in refused(path)


def test_textures_of_another_kind_are_told_to_be_left_out(tmp_path):
    (tmp_path / "a.png").write_bytes(b"no picture at all")
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
    tree = gltf_tree(
        images=[{"uri": "a.png"}],
        textures=[{"source": 0}],
        materials=[material],
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
    )
    mesh = read_mesh_file(write_gltf(tmp_path / "a.gltf", tree))
    assert any("textures" in note for note in mesh.notes)


def test_a_material_that_is_gone_says_nothing(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n")
    mesh = read_mesh_file(path)
    assert mesh.missing == ("a.mtl",)
    assert mesh.pieces[0].look.said == ""


def test_a_vertex_of_two_numbers_is_refused(tmp_path):
    path = tmp_path / "flat.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1\nf 1 2 3\n")
    assert "vert" in refused(path)


def test_a_buffer_that_is_a_ring_of_links_is_refused(tmp_path):
    (tmp_path / "a.bin").symlink_to("a.bin")
    tree = tree_with("buffers", [{"byteLength": 36, "uri": "a.bin"}])
    assert "a.bin" in refused(write_gltf(tmp_path / "probe.gltf", tree))

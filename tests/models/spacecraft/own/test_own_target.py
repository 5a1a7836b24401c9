"""A user's own spacecraft, from its mesh and TOML to the parts and bands that are rendered."""

import numpy as np
import pytest
import trimesh

from models.errors import DatasetError, ScenarioError
from models.materials import MATERIALS
from models.spacecraft.own.build import materials_used, own_target, read_own_target
from models.spacecraft.own.looks import linear, material_from_look, shades
from models.spacecraft.own.skin import skin_of
from tests.support.own_meshes import (
    BUS_M,
    TEXTURE_RED,
    boxes,
    broken_ply,
    millimetre_stl,
    textured_glb,
    toml_of,
)


def test_a_textured_glb_needs_two_lines(tmp_path):
    built = read_own_target(toml_of(textured_glb(tmp_path / "boxsat.glb")))
    assert built.spacecraft.part_names == ("bus", "panel", "boom")
    assert np.abs(built.spacecraft.centre_of_mass).max() < 1e-9
    whole = trimesh.util.concatenate([*boxes().values()])
    size = built.spacecraft.bounds[1] - built.spacecraft.bounds[0]
    np.testing.assert_allclose(size, whole.extents, rtol=1e-6)
    used = materials_used(built.spacecraft)
    assert used["boom"] == ("white_paint",)
    assert len(used["panel"]) == 2  # its texture has two shades, one of them on one face


def test_bands_follow_from_the_red_of_texture_and_colour(tmp_path):
    craft = read_own_target(toml_of(textured_glb(tmp_path / "boxsat.glb"))).spacecraft
    foil = next(craft.material_of(part) for part in craft.parts if part.name == "bus")
    assert foil.specular.bands == pytest.approx([0.8] * 3, abs=0.01)
    assert foil.diffuse.bands == (0.0, 0.0, 0.0)
    assert foil.roughness == pytest.approx(0.25)
    reds = sorted(
        craft.material_of(part).diffuse.sunlight for part in craft.parts if part.name == "panel"
    )
    expected = sorted(0.96 * linear(np.array(red / 255.0)) for red in TEXTURE_RED)
    np.testing.assert_allclose(reds, expected, atol=1e-3)
    cells = [p for p in craft.parts if p.name == "panel"]
    dark = min(cells, key=lambda part: craft.material_of(part).diffuse.sunlight)
    np.testing.assert_allclose(dark.mesh.face_normals, [[0, 0, 1]] * 2, atol=1e-9)


@pytest.mark.parametrize("metallic", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("red", [0.0, 0.2, 1.0])
@pytest.mark.parametrize("roughness", [0.0, 1.0])
def test_every_look_is_a_material(red, metallic, roughness):
    material = material_from_look("x", red, metallic, roughness)
    assert material.diffuse.sunlight + material.specular.sunlight <= 1.0
    if material.is_dielectric:
        assert max(material.refractive_indices) < 2.0


def test_shades_are_few_and_near():
    rng = np.random.default_rng(3)
    red = rng.uniform(0.0, 1.0, 5000)
    values, shade = shades(red, np.ones(5000))
    assert len(values) <= 12
    assert np.abs(values[shade] - red).max() < 0.1


def test_the_toml_gives_materials_by_name_by_pattern_and_of_ones_own(tmp_path):
    toml = toml_of(
        textured_glb(tmp_path / "boxsat.glb"),
        "[parts]",
        'bus = "mli_gold"',
        '"p*l" = "mine"',
        "[materials.mine]",
        "diffuse = [0.5, 0.4, 0.3]",
        "specular = 0.02",
        "roughness = 0.2",
    )
    craft = read_own_target(toml).spacecraft
    of = {part.name: craft.material_of(part) for part in craft.parts}
    assert of["bus"] is MATERIALS["mli_gold"]
    assert of["panel"].diffuse.bands == (0.5, 0.4, 0.3)
    assert of["panel"].specular.bands == (0.02, 0.02, 0.02)
    assert "mine" not in MATERIALS


def test_an_stl_in_millimetres_is_of_the_same_size_and_inertia(tmp_path):
    glb = read_own_target(toml_of(textured_glb(tmp_path / "a.glb")))
    stl = read_own_target(toml_of(millimetre_stl(tmp_path / "b.stl"), 'unit = "mm"'))
    np.testing.assert_allclose(stl.spacecraft.bounds, glb.spacecraft.bounds, atol=1e-6)
    np.testing.assert_allclose(stl.inertia_kg_m2, glb.inertia_kg_m2, rtol=1e-5, atol=1e-4)
    assert stl.spacecraft.part_names == ("body",)


def test_axes_origin_and_centre_of_mass_are_as_told(tmp_path):
    told = ['origin = "mesh"', "centre_of_mass_in_mesh_m = [0.1, 0.2, 0.3]"]
    axes = ["[axes]", 'x = "+z"', 'y = "+x"', 'z = "+y"']
    built = read_own_target(toml_of(textured_glb(tmp_path / "a.glb"), *told, *axes))
    np.testing.assert_allclose(built.spacecraft.centre_of_mass, [0.3, 0.1, 0.2])
    low, high = built.spacecraft.bounds
    whole = trimesh.util.concatenate([*boxes().values()])
    np.testing.assert_allclose(high - low, np.roll(whole.extents, 1), rtol=1e-6)


def test_the_inertia_of_a_skin_is_that_of_a_thin_shell():
    radius = 2.0
    ball = trimesh.creation.icosphere(5, radius)
    skin = skin_of(np.asarray(ball.triangles))
    np.testing.assert_allclose(skin.inertia_per_kg, 2 / 3 * radius**2 * np.eye(3), atol=5e-3)
    box = trimesh.creation.box((1.0, 1.0, 1.0))
    np.testing.assert_allclose(
        skin_of(np.asarray(box.triangles)).inertia_per_kg, 5 / 18 * np.eye(3), atol=1e-12
    )


def test_a_body_inside_out_is_turned(tmp_path):
    built = read_own_target(toml_of(broken_ply(tmp_path / "a.ply"), 'unit = "m"'))
    boom = built.spacecraft.parts[0].mesh
    bodies = boom.split(only_watertight=False)
    assert len(bodies) == 3
    assert all(body.volume > 0.0 for body in bodies)


def test_curved_surfaces_are_smooth_and_boxes_are_not(tmp_path):
    ball = trimesh.creation.icosphere(3, 1.0)
    ball.export(tmp_path / "ball.stl")
    built = read_own_target(toml_of(tmp_path / "ball.stl", 'unit = "m"', name="ball"))
    part = built.spacecraft.parts[0]
    assert part.smooth
    radial = part.mesh.vertices / np.linalg.norm(part.mesh.vertices, axis=1, keepdims=True)
    assert (np.einsum("ij,ij->i", radial, part.mesh.vertex_normals) > 0.999).all()
    flat = read_own_target(toml_of(millimetre_stl(tmp_path / "b.stl"), 'unit = "mm"'))
    assert not flat.spacecraft.parts[0].smooth


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ((), "unit"),
        (('unit = "parsec"',), "unit"),
        (('unit = "mm"', 'colour = "red"'), "colour"),
        (('unit = "mm"', "[parts]", 'wing = "mli_gold"'), "wing"),
        (('unit = "mm"', "[parts]", 'body = "cheese"'), "cheese"),
        (('unit = "mm"', "[materials.mli_gold]", "diffuse = 0.1"), "mli_gold"),
        (('unit = "mm"', "[materials.a]", "diffuse = 0.8", "specular = 0.8"), "sum"),
        (('unit = "mm"', "[axes]", 'x = "+x"', 'y = "+z"', 'z = "+y"'), "right-handed"),
        (('unit = "km"',), "is its unit right"),
        (('unit = "mm"', "inertia_kg_m2 = [[1, 0, 0], [0, 1, 0], [0, 0, 9]]"), "inertia_kg_m2"),
        (('unit = "mm"', "[wireframe]", "find = false"), "landmarks"),
        (('unit = "mm"', "[wireframe]", "[wireframe.landmarks]", "a = [0, 0]"), "a"),
        (('unit = "mm"', 'markers = "/etc/passwd"'), "markers"),
    ],
)
def test_a_toml_that_cannot_be_is_refused_with_its_key(tmp_path, lines, said):
    toml = toml_of(millimetre_stl(tmp_path / "a.stl"), *lines)
    with pytest.raises((DatasetError, ScenarioError)) as caught:
        read_own_target(toml)
    assert said in str(caught.value)
    assert "a.toml" in str(caught.value)


def test_a_presets_name_is_taken(tmp_path):
    toml = toml_of(textured_glb(tmp_path / "a.glb"), name="xmm")
    with pytest.raises(DatasetError, match="preset"):
        read_own_target(toml)


def test_markers_of_ones_own_lie_on_it(tmp_path):
    top = 0.5 * BUS_M[2]
    rows = "".join(
        f'[[markers.marker]]\nname = "{k}"\npoint_in_target_m = [{x}, {y}, {top + 0.001}]\n'
        "normal_in_target = [0.0, 0.0, 1.0]\n"
        for k, (x, y) in enumerate([(0.3, 0.3), (0.3, -0.3), (-0.1, -0.3)])
    )
    toml = toml_of(
        textured_glb(tmp_path / "a.glb"), 'origin = "mesh"', "[markers]", "radius_m = 0.01", rows
    )
    markers = read_own_target(toml).spacecraft.markers
    assert markers is not None
    assert len(markers) == 3


@pytest.mark.slow
def test_thousands_of_parts_become_few(tmp_path):
    scene = trimesh.Scene()
    for k in range(1500):
        box = trimesh.creation.box((0.01, 0.01, 0.01))
        box.apply_translation([0.02 * (k % 10), 0.03 * (k // 10 % 10), 0.04 * (k // 100)])
        scene.add_geometry(box, node_name=f"bolt_{k}", geom_name=f"bolt_{k}")
    path = tmp_path / "a.glb"
    path.write_bytes(scene.export(file_type="glb"))
    assert read_own_target(toml_of(path)).spacecraft.part_names == ("bolt",)


def test_it_is_built_once(tmp_path):
    toml = toml_of(textured_glb(tmp_path / "a.glb"))
    lines = tuple(toml.read_text().splitlines())
    assert own_target(lines, "x", tmp_path) is own_target(lines, "x", tmp_path)


def test_a_part_without_area_is_left_out(tmp_path):
    scene = trimesh.Scene()
    flat = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]], process=False)
    for name, part in (("bus", trimesh.creation.box((1.0, 1.0, 1.0))), ("line", flat)):
        scene.add_geometry(part, node_name=name, geom_name=name)
    (tmp_path / "two.glb").write_bytes(scene.export(file_type="glb"))
    built = read_own_target(toml_of(tmp_path / "two.glb"))
    assert built.spacecraft.part_names == ("bus",)

"""Surfaces of a scenario that differ from the house's, as one specimen from another."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import ScenarioError
from models.materials import MATERIALS, Material
from models.spacecraft.catalogue import spacecraft_by_name
from renders.scenario.scenario import read_scenario
from renders.scenario.surface_tables import SurfaceTable, materials_of, varied, with_surfaces
from renders.store.light_keys import spacecraft_hash
from renders.world.build import world_of

CASE = """\
name = "mine"
target = "hispasat"
[frame]
kind = "single"
[motion]
file = "poses.csv"
[exposure]
mode = "fixed"
"""
POSES = """\
time_s,t_cam_from_target_x_m,t_cam_from_target_y_m,t_cam_from_target_z_m,q_cam_from_target_w,\
q_cam_from_target_x,q_cam_from_target_y,q_cam_from_target_z
0,0,0,30,1,0,0,0
"""
FACTORS = st.floats(0.0, 10.0)


@given(st.sampled_from(list(MATERIALS.values())), FACTORS, FACTORS, st.floats(0.05, 20.0))
def test_what_is_varied_is_a_material_still(
    material: Material, diffuse: float, specular: float, roughness: float
) -> None:
    table = SurfaceTable(
        material=material.name, diffuse=diffuse, specular=specular, roughness=roughness
    )
    other = varied(material, table)  # itself refuses more than 1, or a roughness out of range
    for before, after in zip(material.diffuse.bands, other.diffuse.bands, strict=True):
        assert after <= diffuse * before + 1e-12


def test_small_factors_are_taken_as_they_are() -> None:
    table = SurfaceTable(material="carbon_fibre", diffuse=1.2, specular=0.5, roughness=2.0)
    before, after = MATERIALS["carbon_fibre"], varied(MATERIALS["carbon_fibre"], table)
    np.testing.assert_allclose(after.diffuse.bands, 1.2 * np.array(before.diffuse.bands))
    np.testing.assert_allclose(after.specular.bands, 0.5 * np.array(before.specular.bands))
    assert after.roughness == 2.0 * before.roughness
    assert varied(before, SurfaceTable(material="carbon_fibre")).diffuse == before.diffuse


def test_a_scenarios_surfaces_are_those_of_its_world(tmp_path: Path) -> None:
    name = sorted(materials_of(spacecraft_by_name("hispasat")))[0]
    (tmp_path / "poses.csv").write_text(POSES)
    (tmp_path / "case.toml").write_text(CASE)
    plain = world_of(read_scenario(tmp_path / "case.toml"))
    text = f'{CASE}[[surface]]\nmaterial = "{name}"\ndiffuse = 0.5\n'
    (tmp_path / "case.toml").write_text(text)
    scenario = read_scenario(tmp_path / "case.toml")
    world = world_of(scenario)
    there, varied_there = materials_of(plain.target), materials_of(world.target)
    assert varied_there[name].diffuse.sunlight == 0.5 * there[name].diffuse.sunlight
    assert all(varied_there[key] == there[key] for key in there if key != name)
    assert spacecraft_hash(world.target) != spacecraft_hash(plain.target)
    assert scenario.fingerprint() != plain.scenario.fingerprint()
    (tmp_path / "again.toml").write_text(scenario.to_toml())
    assert read_scenario(tmp_path / "again.toml") == scenario


@pytest.mark.parametrize(
    ("names", "told"),
    [
        (["white_pain"], "perhaps you meant white_paint"),
        (["corner_cube_face"], "expected surface.material as one of hispasat's"),
        (["white_paint", "white_paint"], "each surface.material once, got 'white_paint' 2 times"),
    ],
)
def test_a_surface_that_is_none_is_refused(names: list[str], told: str) -> None:
    tables = [SurfaceTable(material=name) for name in names]
    with pytest.raises(ScenarioError, match=told):
        with_surfaces(spacecraft_by_name("hispasat"), tables, "here")

"""A scenario's target of one's own: read from beside it, kept in it, known by its mesh's hash."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from models.dataset.onboard_files import onboard_texts
from models.errors import ScenarioError
from models.spacecraft.own.build import read_own_target
from renders.scenario.scenario import Scenario, read_scenario
from renders.store.light_keys import LightKeys, spacecraft_hash
from renders.world.build import world_of
from tests.support.own_meshes import millimetre_stl, textured_glb, toml_of
from tests.support.tumble_scenario import TUMBLE, tumble_table


def case_of(folder: Path, **changes: Any) -> Path:
    tumble = {key: value for key, value in TUMBLE.items() if key != "inertia_kg_m2"}
    table = tumble_table(target="craft/boxsat.toml", tumble=tumble, **changes)
    path = folder / "case.toml"
    path.write_text(tomli_w.dumps(table))
    return path


@pytest.fixture
def case(tmp_path: Path) -> Path:
    (tmp_path / "craft").mkdir()
    toml_of(textured_glb(tmp_path / "craft" / "boxsat.glb"))
    return case_of(tmp_path)


def test_it_is_read_from_beside_the_scenario(case: Path) -> None:
    scenario = read_scenario(case)
    own = read_own_target(case.parent / "craft" / "boxsat.toml")
    assert scenario.target == "boxsat"
    assert scenario.tumble is not None
    np.testing.assert_allclose(scenario.tumble.inertia_kg_m2, own.inertia_kg_m2)
    world = world_of(scenario)
    assert world.target.part_names == own.spacecraft.part_names
    world.check_poses()


def test_what_is_known_on_board_needs_no_mesh(case: Path) -> None:
    texts = onboard_texts(world_of(read_scenario(case)).onboard(0))
    assert "corner_01" in texts["wireframe.json"]
    assert "inertia_kg_m2" in texts["knowledge.toml"]


def test_a_resolved_scenario_is_the_same_and_moves_with_its_mesh(case: Path) -> None:
    scenario = read_scenario(case)
    elsewhere = case.parent / "resolved" / "scenario.toml"
    elsewhere.parent.mkdir()
    elsewhere.write_text(scenario.to_toml())
    assert read_scenario(elsewhere) == scenario
    moved = case.parent.parent / "moved"
    shutil.copytree(case.parent, moved)
    again = read_scenario(moved / case.name)
    assert again != scenario
    assert again.fingerprint() == scenario.fingerprint()


def test_a_resolved_scenario_is_read_without_its_mesh(case: Path) -> None:
    resolved = case.parent / "resolved.toml"
    resolved.write_text(read_scenario(case).to_toml())
    shutil.rmtree(case.parent / "craft")
    scenario = read_scenario(resolved)
    assert scenario.frame_kind == "single"
    with pytest.raises(ScenarioError, match=r"boxsat\.glb"):
        world_of(scenario)


def test_another_mesh_is_other_light_and_no_old_dataset(case: Path) -> None:
    scenario = read_scenario(case)
    textured_glb(case.parent / "craft" / "boxsat.glb", scale=1.01)
    with pytest.raises(ScenarioError, match="as it was"):
        world_of(scenario)
    assert read_scenario(case).fingerprint() != scenario.fingerprint()


def test_own_materials_are_in_the_keys_of_light(case: Path) -> None:
    toml = case.parent / "craft" / "boxsat.toml"
    plain = spacecraft_hash(read_own_target(toml).spacecraft)
    hashes = {plain}
    for diffuse in (0.5, 0.6):
        toml_of(
            case.parent / "craft" / "boxsat.glb",
            '[parts]\nbus = "mine"\n[materials.mine]',
            f"diffuse = {diffuse}",
        )
        hashes.add(spacecraft_hash(read_own_target(toml).spacecraft))
    assert len(hashes) == 3
    world = world_of(read_scenario(case))
    exposure = world.exposures[0]
    pose = world.trajectory.cam_from_target(exposure.time_s)
    assert len(LightKeys(world, "jit").group(exposure, pose, world.sun)) > 10


def test_inertia_typed_in_the_scenario_goes_before(case: Path) -> None:
    table = tumble_table(target="craft/boxsat.toml")
    case.write_text(tomli_w.dumps(table))
    tumble = read_scenario(case).tumble
    assert tumble is not None
    assert tumble.inertia_kg_m2[1][1] == 129129.0


@pytest.mark.parametrize(
    ("target", "said"),
    [
        ("craft/boxsat.glb", "rvbench inspect"),
        ("craft/gone.toml", "gone.toml"),
        ("craft/broken.toml", "unit"),
        ("boxsat", "got 'boxsat'"),
    ],
)
def test_what_cannot_be_a_target_is_refused(case: Path, target: str, said: str) -> None:
    toml_of(millimetre_stl(case.parent / "craft" / "broken.stl"))
    case.write_text(tomli_w.dumps(tumble_table(target=target)))
    with pytest.raises(ScenarioError, match=said):
        world_of(read_scenario(case))


def test_a_target_is_told_once(case: Path) -> None:
    scenario = read_scenario(case)
    own = scenario.own_target
    assert own is not None
    table = tumble_table(target="craft/boxsat.toml", own_target=own.model_dump(mode="json"))
    case.write_text(tomli_w.dumps(table))
    with pytest.raises(ScenarioError, match="both"):
        read_scenario(case)


def test_a_file_beside_a_preset_changes_nothing() -> None:
    assert Scenario(**tumble_table()).own_target is None
    assert "own_target" not in Scenario(**tumble_table()).to_toml()


def test_a_file_of_markers_is_known_by_its_hash_too(case: Path) -> None:
    row = "[[marker]]\nname = '{}'\npoint_in_target_m = {}\nnormal_in_target = [0.0, 0.0, 1.0]\n"
    places = ([0.5, 0.3, 0.9], [0.5, -0.3, 0.9], [-0.1, 0.0, 0.9])
    rows = "".join(row.format(k, place) for k, place in enumerate(places))
    markers = case.parent / "craft" / "markers.toml"
    markers.write_text("radius_m = 0.01\n" + rows)
    mesh = case.parent / "craft" / "boxsat.glb"
    toml_of(mesh, 'origin = "mesh"', 'markers = "markers.toml"')
    plain = tumble_table(target="craft/boxsat.toml", tumble=None)
    plain = {key: value for key, value in plain.items() if key not in ("tumble", "motion")}
    plain |= {"exposure": {"mode": "fixed", "exposure_ms": 4.0}, "camera": {"width": 64}}
    case.write_text(tomli_w.dumps(plain))
    before = read_scenario(case)
    assert world_of(before).target.markers is not None
    markers.write_text("radius_m = 0.02\n" + rows)
    assert read_scenario(case).fingerprint() != before.fingerprint()
    shutil.rmtree(case.parent / "craft")
    assert before.own_target is not None
    assert before.own_target.has_markers()
